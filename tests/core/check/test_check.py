"""Each rule is kept by good runs and broken by a run that is spoilt on purpose."""

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from railjoule.core import Bound, CheckError, Energy, Trajectory, check_run, load_scenario, solve
from railjoule.core.scenario import Scenario, preset_document, scenario_from_document
from railjoule.core.strategies import STRATEGIES
from tests.any_scenarios import any_full_document
from tests.builders import COPPER_LOSS, HILLS, INDUCTION, LOSS_POLYNOMIAL, plain_scenario

SYNCHRONOUS = preset_document("vehicles", "metro-5-car-synchronous")["drive"] | {"gear_ratio": 4.0}
EFFICIENCIES = [[0, 0, 0], [0, 150, 0], [0, 300, 0], [700, 0, 0], [700, 150, 0.9], [700, 300, 0.92], [1400, 0, 0],
                [1400, 150, 0.88], [1400, 300, 0.93]]  # fmt: skip
MAP = {"model": "efficiency_map", "motors": 6, "gear_ratio": 4.0, "wheel_diameter_m": 0.8, "gear_loss_share": 0.02,
       "points": EFFICIENCIES, "recuperation_factor": 0.6}  # fmt: skip
DRIVES: dict[str, dict[str, Any]] = {
    "constant_efficiency": {"model": "constant_efficiency", "traction_efficiency": 0.85, "recuperation_factor": 0.5},
    "copper_loss": COPPER_LOSS,
    "loss_polynomial": LOSS_POLYNOMIAL,
    "efficiency_map": MAP,
    "induction": INDUCTION | {"motors": 20},
    "synchronous": SYNCHRONOUS,
}
EVERYTHING = {
    "line.sections": [HILLS[0], HILLS[1], HILLS[2], HILLS[3] | {"tunnel_factor": 2.0}, HILLS[4]],
    "line.stations": [{"position_m": 900.0, "dwell_s": 20.0}],
    "line.reverse": True,
    "vehicle.length_m": 90.0,
    "vehicle.car_count": 5,
    "vehicle.resistance.curve_constant_m_n_per_kn": 700.0,
    "vehicle.auxiliary_power_kw": 20.0,
    "vehicle.braking.max_power_kw": 1200.0,
    "vehicle.braking.friction_effort_kn": 40.0,
    "vehicle.braking.max_deceleration_ms2": 0.9,
    "vehicle.traction.max_acceleration_ms2": 1.0,
    "vehicle.traction.curve": [[0, 100], [40, 90], [100, 40]],
    "timetable.travel_time_s": 230.0,
}
"""Hills, a tunnel and a curve, driven backwards by a train of cars, with a stop, both brakes and all limits."""


def scenario_of(drive: str, changes: Mapping[str, Any] | None = None) -> Scenario:
    return plain_scenario(EVERYTHING | {"vehicle.drive": DRIVES[drive]} | dict(changes or {}))


@pytest.fixture(scope="module")
def run() -> Trajectory:
    """Return a good run with a bound, a price of time, both brakes, a stop and a current."""
    return solve(scenario_of("copper_loss"))


@cache
def solve_drive(drive: str, strategy: str) -> Trajectory:
    return solve(scenario_of(drive), strategy, prove_seconds=0)


def broken(scenario: Scenario, run: Any) -> dict[str, Any]:
    return {check.name: check for check in check_run(scenario, run).broken}


@pytest.mark.parametrize("strategy", ["optimal", "fastest"])
@pytest.mark.parametrize("drive", DRIVES)
def test_good_runs_keep_every_rule(drive, strategy):
    run = solve_drive(drive, strategy)
    result = check_run(run.scenario, run)
    assert not result.broken
    assert result.ok
    assert len(result.checks) > 30


@pytest.mark.parametrize(
    "name", ["liashenko-ii", "ftorek-300s", "metro-10-stations", "tram-950m", "kharkiv-like-40kmh"]
)
def test_shipped_scenarios_keep_every_rule(name):
    assert solve(load_scenario(name), check=True).check.ok


@pytest.mark.parametrize("strategy", ["eoc", "enoc", "phases"])
def test_the_papers_strategies_keep_every_rule(strategy):
    """On the paper's own scenario, which all of them take."""
    result = solve(load_scenario("ftorek-300s"), strategy, check=True).check
    assert not result.broken


def test_the_spoilt_run_is_good_before(run):
    result = check_run(run.scenario, run)
    assert result.ok
    # the rules below are all held against it, motors and their limits aside
    assert {check.name for check in result.checks} >= {name for name, _ in SPOILT if not name.startswith("motors")}


def changed(run: Trajectory, name: str, index: int, factor: float = 1.0, shift: float = 0.0) -> Trajectory:
    """Return a run with one number of an array changed."""
    values = np.array(getattr(run, name))
    values[index] = values[index] * factor + shift
    return replace(run, **{name: values})


def moved_on(run: Trajectory, name: str, first: int, shift: float) -> Trajectory:
    """Return a run with an array shifted from a node on."""
    values = np.array(getattr(run, name))
    values[first:] += shift
    return replace(run, **{name: values})


def cut(run: Trajectory, cells: int) -> Trajectory:
    """Return a run without its last cells."""
    arrays = {field.name: getattr(run, field.name) for field in fields(run)}
    arrays = {name: value[:-cells] for name, value in arrays.items() if isinstance(value, np.ndarray)}
    return replace(run, **arrays)


def with_split_cell(run: Trajectory, cell: int, length_m: float) -> Trajectory:
    """Return a run with a node more, so close behind another that the cell between them is of such a length."""
    share = length_m / (run.position_m[cell + 1] - run.position_m[cell])
    speed2 = run.speed_ms[cell] ** 2 * (1 - share) + run.speed_ms[cell + 1] ** 2 * share
    node = {
        "position_m": run.position_m[cell] + length_m,
        "speed_ms": speed2**0.5,
        "time_s": run.time_s[cell] + 2 * length_m / (run.speed_ms[cell] + speed2**0.5),
        "supply_energy_j": run.supply_energy_j[cell],
    }
    arrays = {name: np.insert(getattr(run, name), cell + 1, value) for name, value in node.items()}
    for name in ("tractive_effort_n", "electric_braking_n", "friction_braking_n", "max_effort_n", "supply_power_w",
                 "current_a", "gradient_permille"):  # fmt: skip
        arrays[name] = np.insert(getattr(run, name), cell, getattr(run, name)[cell])
    return replace(run, **arrays)


def with_energy(run: Trajectory, **parts: Any) -> Trajectory:
    return replace(run, energy=replace(run.energy, **parts))


def with_loss(run: Trajectory, kind: str, factor: float, shift: float = 0.0) -> Trajectory:
    losses = dict(run.energy.losses_j)
    return with_energy(run, losses_j=losses | {kind: losses[kind] * factor + shift})


def bounded_by(run: Trajectory, energy_j: float) -> Trajectory:
    return replace(run, bound=Bound(energy_j, "", run.travel_time_s, energy_j))


def stop_node(run: Trajectory) -> int:
    """Return the number of the cell in which the run stands."""
    return int(np.flatnonzero(np.diff(run.position_m) == 0)[0])


def full_traction(run: Trajectory) -> int:
    return int(np.argmax(run.tractive_effort_n))


def both_brakes(run: Trajectory) -> int:
    """Return a cell with much electric braking at speed."""
    return int(np.argmax(run.electric_braking_n * run.speed_ms[:-1]))


SPOILT: list[tuple[str, Callable[[Trajectory], Trajectory]]] = [
    ("finite numbers", lambda run: changed(run, "speed_ms", 5, np.nan)),
    ("finite numbers", lambda run: changed(run, "supply_power_w", 5, np.inf)),
    ("finite numbers", lambda run: with_energy(run, kinetic_j=np.nan)),
    ("finite numbers", lambda run: bounded_by(run, np.nan)),
    ("places, times and speeds rise from zero", lambda run: moved_on(run, "position_m", 5, -50.0)),
    ("places, times and speeds rise from zero", lambda run: moved_on(run, "time_s", 5, -50.0)),
    ("places, times and speeds rise from zero", lambda run: changed(run, "speed_ms", 5, -1.0)),
    ("whole line driven", lambda run: cut(run, 2)),
    ("whole line driven", lambda run: replace(run, position_m=run.position_m + 1.0)),
    ("speeds at the ends", lambda run: changed(run, "speed_ms", -1, shift=1.0)),
    ("speeds at the ends", lambda run: changed(run, "speed_ms", 0, shift=1.0)),
    ("cells long enough for their places", lambda run: with_split_cell(run, 30, 1e-9)),
    ("time of each cell", lambda run: moved_on(run, "time_s", 20, 0.01)),
    ("time of each cell", lambda run: replace(run, time_s=1.001 * run.time_s)),
    ("stands still where it stands", lambda run: changed(run, "speed_ms", stop_node(run), shift=0.1)),
    (
        "stops",
        lambda run: changed(
            changed(run, "speed_ms", stop_node(run), shift=1.0), "speed_ms", stop_node(run) + 1, shift=1.0
        ),
    ),
    ("standing times", lambda run: moved_on(run, "time_s", stop_node(run) + 1, 3.0)),
    ("late arrival", lambda run: moved_on(run, "time_s", -1, 1e-3)),
    ("early arrival", lambda run: replace(run, time_s=0.997 * run.time_s)),
    ("speed limit", lambda run: changed(run, "speed_ms", 40, shift=100.0)),
    ("gradient", lambda run: changed(run, "gradient_permille", 30, shift=1e-4)),
    ("balance of forces", lambda run: changed(run, "tractive_effort_n", full_traction(run), 1.0001)),
    ("balance of forces", lambda run: changed(run, "friction_braking_n", 30, shift=100.0)),
    ("drives or brakes, not both", lambda run: changed(run, "electric_braking_n", full_traction(run), shift=1e3)),
    ("drives or brakes, not both", lambda run: changed(run, "tractive_effort_n", 40, 0.0, -1e3)),
    ("tractive effort", lambda run: changed(run, "tractive_effort_n", full_traction(run), shift=1e4)),
    ("tractive power", lambda run: changed(run, "tractive_effort_n", int(np.argmax(run.speed_ms)), shift=2e5)),
    (
        "curve of tractive effort",
        lambda run: changed(run, "tractive_effort_n", int(np.argmax(run.speed_ms)), shift=9e4),
    ),
    ("electric braking effort", lambda run: changed(run, "electric_braking_n", both_brakes(run), shift=9e4)),
    ("electric braking power", lambda run: changed(run, "electric_braking_n", both_brakes(run), shift=2e5)),
    ("friction braking effort", lambda run: changed(run, "friction_braking_n", both_brakes(run), shift=5e4)),
    ("sharing of the brakes", lambda run: shared_otherwise(run, both_brakes(run))),
    ("line power", lambda run: changed(run, "supply_power_w", full_traction(run), 1.0001)),
    ("line power", lambda run: changed(run, "supply_power_w", stop_node(run), 1.1)),
    ("no power from nothing", lambda run: changed(run, "supply_power_w", full_traction(run), 0.1)),
    ("motor current", lambda run: changed(run, "current_a", full_traction(run), 1.0001)),
    ("energy so far", lambda run: moved_on(run, "supply_energy_j", 20, 1e4)),
    ("account: traction", lambda run: with_energy(run, traction_j=1.0001 * run.energy.traction_j)),
    ("account: recuperated", lambda run: with_energy(run, recuperated_j=1.0001 * run.energy.recuperated_j)),
    ("account: auxiliary", lambda run: with_energy(run, auxiliary_j=1.0001 * run.energy.auxiliary_j)),
    ("account: running resistance", lambda run: with_energy(run, running_resistance_j=0.0)),
    ("account: curve resistance", lambda run: with_energy(run, curve_resistance_j=0.0)),
    ("account: kinetic", lambda run: with_energy(run, kinetic_j=1e4)),
    ("account: potential", lambda run: with_energy(run, potential_j=1.0001 * run.energy.potential_j)),
    ("account: copper", lambda run: with_loss(run, "copper", 1.0001)),
    ("account: brake resistors", lambda run: with_loss(run, "brake_resistors", 1.0001)),
    ("account: friction brakes", lambda run: with_loss(run, "friction_brakes", 1.0, 1e4)),
    ("account: closes", lambda run: with_loss(run, "copper", 1.0001)),
    ("account: no negative loss", lambda run: with_loss(run, "copper", -1.0)),
    ("account: net energy", lambda run: with_energy(run, auxiliary_j=0.0)),
    ("bound below the energy", lambda run: bounded_by(run, 1.003 * run.energy.net_j)),
]


def shared_otherwise(run: Trajectory, cell: int) -> Trajectory:
    """Return a run whose friction brakes do what the electric brake could."""
    half = 0.5 * run.electric_braking_n[cell]
    return changed(changed(run, "electric_braking_n", cell, 0.5), "friction_braking_n", cell, shift=half)


@pytest.mark.parametrize(("rule", "spoil"), SPOILT)
def test_a_spoilt_run_breaks_the_rule(run, rule, spoil):
    found = broken(run.scenario, spoil(run))
    assert rule in found
    assert found[rule].largest > found[rule].allowed


@pytest.mark.parametrize(
    ("name", "cell", "factor", "rule"),
    [
        ("tractive_effort_n", full_traction, 1.01, "balance of forces"),
        ("supply_power_w", both_brakes, 1.01, "line power"),
        ("gradient_permille", lambda run: 30, 1.01, "gradient"),
    ],
)
def test_it_tells_where(run, name, cell, factor, rule):
    number = cell(run)
    found = broken(run.scenario, changed(run, name, number, factor))[rule]
    assert run.position_m[number] < found.at_m < run.position_m[number + 1]


def test_the_size_of_a_deviation_is_a_share_of_what_it_says(run):
    """A thousandth too much of the force is a thousandth of the force, near enough."""
    number = full_traction(run)
    found = broken(run.scenario, changed(run, "tractive_effort_n", number, 1.001))["balance of forces"]
    assert found.share_of == "the force"
    assert found.largest == pytest.approx(1e-3, rel=0.02)


def test_a_run_with_numbers_that_are_not_finite_is_not_looked_at_further(run):
    result = check_run(run.scenario, changed(run, "speed_ms", 5, np.nan))
    assert [check.name for check in result.checks] == ["finite numbers"]
    assert result.checks[0].largest == 1
    assert result.checks[0].at_m == run.position_m[5]
    assert [rule.name for rule in result.not_checked] == ["all other rules"]


def test_a_reported_gap_that_is_another_is_found(run):
    values = {field.name: getattr(run, field.name) for field in fields(run)}
    values |= {"gap": run.gap + 1e-3}
    assert set(broken(run.scenario, SimpleNamespace(**values))) == {"gap"}


WET = {"line.rail_condition": "wet", "vehicle.adhesion": {"driven_mass_share": 0.3, "braked_mass_share": 0.3}}
STRICTER: list[tuple[str, dict[str, Any]]] = [
    ("late arrival", {"timetable.travel_time_s": 229.9}),
    ("early arrival", {"timetable.travel_time_s": 232.0}),
    ("speed limit", {"line.speed_limits": [{"from_m": 1200, "to_m": 1300, "limit_kmh": 20}]}),
    ("speed limit", {"vehicle.traction.max_speed_kmh": 40.0}),
    ("stops", {"line.stations": [{"position_m": 700.0}]}),
    ("standing times", {"line.stations": []}),
    ("standing times", {"line.stations": [{"position_m": 900.0, "dwell_s": 21.0}]}),
    ("acceleration", {"vehicle.traction.max_acceleration_ms2": 0.3}),
    ("deceleration", {"vehicle.braking.max_deceleration_ms2": 0.3}),
    ("balance of forces", {"vehicle.load_factor": 0.01}),
    ("balance of forces", {"vehicle.rotating_mass_factor": 0.101}),
    ("balance of forces", {"vehicle.resistance.constant_n_per_kn": 2.01}),
    ("balance of forces", {"vehicle.resistance.linear_n_per_kmh": 1.0}),
    ("balance of forces", {"vehicle.resistance.quadratic_n_per_kmh2": 0.01}),
    ("balance of forces", {"vehicle.resistance.curve_constant_m_n_per_kn": 701.0}),
    ("balance of forces", {"vehicle.car_count": 4}),
    ("balance of forces", {"vehicle.length_m": 91.0}),
    ("gradient", {"vehicle.car_count": None}),
    ("gradient", {"line.reverse": False}),
    ("tractive effort", {"vehicle.traction.max_effort_kn": 50.0}),
    ("tractive power", {"vehicle.traction.max_power_kw": 300.0}),
    ("curve of tractive effort", {"vehicle.traction.curve": [[0, 60], [100, 10]]}),
    ("electric braking effort", {"vehicle.braking.max_effort_kn": 30.0}),
    ("electric braking power", {"vehicle.braking.max_power_kw": 200.0}),
    ("breakdown of tractive effort", {"vehicle.traction.breakdown_speed_kmh": 20.0}),
    ("adhesion of the driven axles", WET),
    ("adhesion under the electric brake", WET),
    ("adhesion of the braked axles", WET),
    ("curve of electric braking effort", {"vehicle.braking.curve": [[0, 40], [100, 10]]}),
    ("breakdown of electric braking effort", {"vehicle.braking.breakdown_speed_kmh": 20.0}),
    ("braking curve", {"vehicle.braking.permitted_deceleration": [[0, 0.3]]}),
    ("braking curve", {"vehicle.braking.permitted_deceleration": [[0, 2.0], [36, 0.2]]}),
    ("line power", {"drive.recuperation_factor": 0.6}),
    ("line power", {"drive.resistance_ohm": 0.1001}),
    ("line power", {"vehicle.auxiliary_power_kw": 21.0}),
]
"""What another scenario than that of the run makes of it."""


@pytest.mark.parametrize(("rule", "changes"), STRICTER)
def test_a_run_of_another_scenario_breaks_the_rule(run, rule, changes):
    assert rule in broken(run.scenario.replace(**changes), run)


def test_a_braking_curve_is_held_against_the_distance_that_is_left():
    """From any speed 0.49 m/s2 take longer than 0.5 m/s2 by 1 - 0.49 / 0.5 of their own distance."""
    changes = {"vehicle.braking": {"max_effort_kn": 80.0, "permitted_deceleration": [[0, 0.5]]}}
    run = solve(plain_scenario(changes), "fastest")
    found = {rule.name: rule.largest for rule in check_run(run.scenario, run).checks}
    assert found["braking curve"] < 1e-9
    # the run along a curve of 0.5 m/s2, under one of 0.49
    stricter = run.scenario.replace(**{"vehicle.braking.permitted_deceleration": [[0, 0.49]]})
    breach = broken(stricter, run)["braking curve"]
    assert breach.largest == pytest.approx(1 - 0.49 / 0.5, rel=1e-6)


def test_a_tunnel_that_the_run_does_not_know_breaks_the_balance_of_forces(run):
    sections = [
        section.model_dump(exclude_none=True) | {"tunnel_factor": 1.0} for section in run.scenario.line.sections
    ]
    assert "balance of forces" in broken(run.scenario.replace(**{"line.sections": sections}), run)


@pytest.mark.parametrize(
    ("rule", "changes"),
    [
        ("motors while driving", {"drive.starting_current_a": 60.0}),
        ("motors while driving", {"drive.max_phase_voltage_v": 100.0}),
        ("motors while braking", {"drive.braking_current_a": 40.0}),
        ("motor current", {"drive.rotor_resistance_ohm": 0.13}),
        ("line power", {"drive.hysteresis_loss_w": 310.0}),
        ("line power", {"drive.eddy_loss_w": 310.0}),
        ("line power", {"drive.stator_resistance_ohm": 0.112}),
        ("line power", {"drive.mechanical_loss_torque_nm": 4.06}),
        ("line power", {"drive.gear_efficiency": 0.981}),
        ("account: iron", {"drive.eddy_loss_w": 310.0}),
    ],
)
def test_other_induction_machines_break_the_rule(rule, changes):
    run = solve_drive("induction", "fastest")
    assert rule in broken(run.scenario.replace(**changes), run)


@pytest.mark.parametrize(
    ("drive", "changes"),
    [
        ("constant_efficiency", {"drive.traction_efficiency": 0.851}),
        ("constant_efficiency", {"drive.braking_efficiency": 0.84}),
        ("loss_polynomial", {"drive.no_load_loss_w": 351.0}),
        ("loss_polynomial", {"drive.speed_loss_w_per_rads": 2.01}),
        ("loss_polynomial", {"drive.speed_loss_w_per_rads2": 0.031}),
        ("loss_polynomial", {"drive.torque_loss_w_per_nm": 0.56}),
        ("loss_polynomial", {"drive.torque_loss_w_per_nm2": 0.0047}),
        ("loss_polynomial", {"drive.gear_loss_share": 0.026}),
        ("efficiency_map", {"drive.points": [[*point[:2], 0.999 * point[2]] for point in EFFICIENCIES]}),
        ("synchronous", {"drive.gear_loss_share": 0.06}),
        ("synchronous", {"drive.stator_resistance_ohm": 0.06}),
    ],
)
def test_another_drive_breaks_the_line_power(drive, changes):
    run = solve_drive(drive, "fastest")
    assert "line power" in broken(run.scenario.replace(**changes), run)


def test_a_weaker_synchronous_motor_breaks_its_limit():
    run = solve_drive("synchronous", "fastest")
    assert "motors while driving" in broken(run.scenario.replace(**{"drive.max_current_a": 60.0}), run)


# ---- what is not checked, and the ends


def test_the_fastest_run_has_no_timetable():
    run = solve(scenario_of("copper_loss", {"timetable.travel_time_s": 60.0}), "fastest")
    result = check_run(run.scenario, run)
    assert result.ok
    reasons = {rule.name: rule.reason for rule in result.not_checked}
    assert reasons["late arrival"] == "the fastest run has no timetable to keep"
    assert "early arrival" in reasons


def test_limits_may_make_a_run_late_within_their_window():
    scenario = plain_scenario({"line.sections": HILLS, "timetable.travel_time_s": 150.0})
    run = solve(scenario, "speed_limits")
    assert run.travel_time_s > 150.5
    assert "late arrival" not in broken(scenario, run)
    assert "late arrival" in broken(scenario.replace(**{"search.time_window": 1e-4}), run)


def test_speeds_at_the_ends_are_those_that_are_asked_for():
    ends = {"initial_speed_ms": 8.0, "final_speed_ms": 5.0}
    run = solve(plain_scenario(), **ends)
    assert check_run(run.scenario, run, **ends).ok
    assert "speeds at the ends" in broken(run.scenario, run)
    assert solve(plain_scenario(), check=True, **ends).check.ok


# ---- solve(check=True)


def test_a_run_carries_its_check_if_asked():
    assert solve(plain_scenario()).check is None
    assert solve(plain_scenario(), check=True).check.ok


def test_solve_raises_what_its_check_finds(monkeypatch):
    good = STRATEGIES["optimal"]
    bad = replace(good, run=lambda task: with_energy(good.run(task), kinetic_j=1e7))
    monkeypatch.setitem(STRATEGIES, "optimal", bad)
    with pytest.raises(CheckError, match=r"^optimal: The run breaks 2 of \d+ rules, worst of all 'account: ") as caught:
        solve(plain_scenario(), check=True)
    assert isinstance(caught.value.run, Trajectory)
    assert {check.name for check in caught.value.run.check.broken} == {"account: closes", "account: kinetic"}


def test_every_part_of_the_account_is_held_against_its_sum(run):
    """No field of the account can be wrong unseen."""
    for field in fields(Energy):
        if field.name != "losses_j":
            assert broken(run.scenario, with_energy(run, **{field.name: getattr(run.energy, field.name) + 1e4}))
    for kind in run.energy.losses_j:
        assert broken(run.scenario, with_loss(run, kind, 1.0, 1e4))


def test_what_rounding_leaves_of_a_current_is_judged_by_that_of_an_effort_that_counts():
    """Down this hill the train only coasts: 1e-4 N and 9e-8 A are left, which were 90 times the largest current."""
    document = any_full_document(2377)
    document["timetable"] = {"travel_time_s": 266.0}
    run = solve(scenario_from_document(document), "optimal", prove_seconds=0)
    assert run.energy_kwh < 1e-6
    assert check_run(run.scenario, run).ok
