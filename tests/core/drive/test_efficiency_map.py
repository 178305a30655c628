"""Efficiency maps: what a file must hold, and what lies between its points."""

import numpy as np
import pytest
from builders import PLAIN, plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import ScenarioError
from railjoule.core.drive import make_drive
from railjoule.core.drive.loss_map import loss_at, loss_table
from railjoule.core.motion import build_meshed_line
from railjoule.core.scenario import scenario_from_document

TORQUE, SPEED = [0.0, 200.0, 800.0, 2000.0], [0.0, 50.0, 150.0, 400.0]
GEAR = {"motors": 4, "gear_ratio": 5.0, "wheel_diameter_m": 0.8, "gear_loss_share": 0.02}


def rows(change=None):
    """A good map as text, with one row changed."""
    lines = [
        f"{torque:g},{speed:g},{0.0 if torque * speed == 0 else 0.5 + 0.1 * i + 0.03 * j:g}"
        for i, torque in enumerate(TORQUE)
        for j, speed in enumerate(SPEED)
    ]
    if change:
        change(lines)
    return "torque_nm,speed_rads,efficiency\n" + "\n".join(lines) + "\n"


def with_map(folder, text, **changes):
    (folder / "map.csv").write_text(text, encoding="utf-8")
    drive = {"model": "efficiency_map", "file": "map.csv", **GEAR}
    document = {**PLAIN, "vehicle": {**PLAIN["vehicle"], "drive": drive}}
    return scenario_from_document(document, folder=folder).replace(**changes)


def test_points_come_back(tmp_path):
    drive = make_drive(with_map(tmp_path, rows()).vehicle.drive)
    turns = 5.0 / 0.4
    for i, torque in enumerate(TORQUE[1:], 1):
        for j, speed in enumerate(SPEED[1:], 1):
            efficiency = 0.5 + 0.1 * i + 0.03 * j
            shaft = 4 * torque * speed
            assert drive.electrical_power_w(4 * torque * turns / 1.02, speed / turns) == pytest.approx(
                shaft / efficiency, rel=1e-9
            )
            assert drive.electrical_power_w(-4 * torque * turns / 0.98, speed / turns) == pytest.approx(
                -shaft * efficiency, rel=1e-9
            )


def swap(lines):
    lines[3], lines[4] = lines[4], lines[3]


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda lines: lines.pop(6), r"drive.points has no value at torque_nm = 200, speed_rads = 150."),
        (swap, r"drive.points must rise in torque_nm and then in speed_rads, or the other way round."),
        (lambda lines: lines.__setitem__(6, "200,150,1.02"), r"drive.points\[6\]\[2\] = 1.02 must be at most 1."),
        (lambda lines: lines.__setitem__(6, "200,150,0"), r"has efficiency = 0 at torque_nm = 200, speed_rads = 150;"),
        (lambda lines: lines.__setitem__(6, "200,150,"), r"drive.file 'map.csv': point 7 has no efficiency."),
        (lambda lines: lines.__setitem__(6, "200,150,x"), r"row 8: efficiency = 'x' must be a number."),
        (lambda lines: lines.insert(6, lines[6]), r"drive.points has one point twice."),
        (lambda lines: lines.__delitem__(slice(0, 4)), r"must begin at torque_nm = 0 and speed_rads = 0"),
        (
            lambda lines: lines.__delitem__(slice(2, None)),
            r"drive.file 'map.csv' has 2 of at least 9 points.",
        ),
    ],
)
def test_bad_maps_are_refused_in_one_sentence(tmp_path, change, expected):
    with pytest.raises(ScenarioError, match=expected) as error:
        with_map(tmp_path, rows(change))
    assert str(error.value).count(". ") == 0


def test_both_file_and_points(tmp_path):
    scenario = with_map(tmp_path, rows())
    assert scenario.replace(**{"vehicle.load_factor": 0.5}).vehicle.drive == scenario.vehicle.drive
    drive = {"model": "efficiency_map", "file": "map.csv", "points": [[0.0, 0.0, 0.0]], **GEAR}
    document = {**PLAIN, "vehicle": {**PLAIN["vehicle"], "drive": drive}}
    with pytest.raises(ScenarioError, match=r"drive needs only one of file and points."):
        scenario_from_document(document, folder=tmp_path)


def test_beyond_the_map_nobody_guesses(tmp_path):
    scenario = with_map(tmp_path, rows())  # 400 rad/s are 115 km/h
    build_meshed_line(scenario)
    faster = with_map(tmp_path, rows(), **{"vehicle.traction.max_speed_kmh": 130.0})
    with pytest.raises(ScenarioError, match=r"map of the drive ends at 400 rad/s of the motor, below the 451.4 rad/s"):
        build_meshed_line(faster)
    drive = make_drive(scenario.vehicle.drive)
    with pytest.raises(ScenarioError, match=r"map of the drive ends at 98.04 kN to drive with, below 200 kN."):
        drive.electrical_power_w(2e5, 5.0)


def test_the_map_limits_the_effort(tmp_path):
    mesh = build_meshed_line(with_map(tmp_path, rows(), **{"vehicle.traction.max_effort_kn": 300.0}))
    assert mesh.data.traction.constant_n == pytest.approx(4 * 2000 * 12.5 / 1.02)


def losses(draw_rising):
    """Losses that rise both ways."""
    return np.cumsum(np.cumsum(np.abs(draw_rising), axis=0), axis=1) + 1.0


@given(seed=st.integers(0, 10_000), along=st.booleans(), line=st.integers(0, 5))
def test_monotone_along_each_line_of_the_grid(seed, along, line):
    """Between two points of a line a loss stays between their losses, in each direction."""
    random = np.random.default_rng(seed)
    torque, speed = np.cumsum(random.uniform(0.2, 3, 6)), np.cumsum(random.uniform(0.2, 3, 6))
    torque, speed = torque - torque[0], speed - speed[0]
    loss = losses(random.uniform(-1, 1, (6, 6)) ** 5)
    table = loss_table(torque, speed, loss)
    places = torque if along else speed
    for k in range(5):
        ends = (loss[k, line], loss[k + 1, line]) if along else (loss[line, k], loss[line, k + 1])
        for x in np.linspace(places[k], places[k + 1], 7)[1:-1]:
            value = loss_at(table, 0, x, speed[line])[0] if along else loss_at(table, 0, torque[line], x)[0]
            assert min(ends) * (1 - 1e-9) <= value <= max(ends) * (1 + 1e-9)


@given(effort=st.floats(1.0, 9.8e4), speed=st.floats(0.01, 31.9))
def test_efficiency_is_never_above_one(effort, speed):
    points = [
        [m, w, 0.0 if m * w == 0 else min(0.2 + 0.27 * i + 0.2 * j, 1.0)]
        for i, m in enumerate(TORQUE)
        for j, w in enumerate(SPEED)
    ]
    drive = make_drive(
        plain_scenario({"vehicle.drive": {"model": "efficiency_map", "points": points, **GEAR}}).vehicle.drive
    )
    assert float(drive.electrical_power_w(effort, speed)) >= effort * speed * (1 - 1e-12)
    assert float(drive.electrical_power_w(-effort, speed)) >= -effort * speed * (1 + 1e-12)
