"""The travel time that follows from the shortest running times and a reserve."""

import numpy as np
import pytest

from railjoule.core import ScenarioError
from railjoule.core.reserve import reserved_time
from railjoule.core.simulation.actual_vehicle import actual_vehicle
from railjoule.core.task import prepare_task
from tests.builders import plain_scenario

STATION = {"position_m": 1200.0, "dwell_s": 25.0}


def with_reserve(changes=None, **timetable):
    return plain_scenario({**(changes or {}), "timetable": timetable})


def shortest_by_hand(length_m, load=0.0):
    """Integrate the plain train of `tests.builders` forward and backward in v squared, at 0.25 m."""
    mass, weight_kn = 100e3 + load * 400 * 75.0, (100 + load * 30) * 9.81
    inertia, step = 1.1 * mass, 0.25
    count, top2 = int(length_m / step), (100 / 3.6) ** 2

    def resistance_n(w):
        return weight_kn * (2.0 + 5e-4 * 3.6**2 * w)

    forward, backward = np.zeros(count + 1), np.zeros(count + 1)
    for k in range(count):
        w = forward[k]
        effort = min(100e3, 1e6 / max(w, 1e-9) ** 0.5)
        forward[k + 1] = min(w + 2 * step * (effort - resistance_n(w)) / inertia, top2)
        w = backward[k]
        backward[k + 1] = min(w + 2 * step * (80e3 + resistance_n(w)) / inertia, top2)
    speed = np.sqrt(np.minimum(forward, backward[::-1]))
    return float(np.sum(2 * step / (speed[1:] + speed[:-1])))


@pytest.mark.parametrize("load", [0.0, 0.8])
def test_per_cent_of_the_shortest_time(load):
    """Row 27 of the field test: time = shortest time times 1.05, with the load on board."""
    scenario = with_reserve({"vehicle.load_factor": load}, reserve_percent=5.0)
    assert scenario.travel_time_s == pytest.approx(1.05 * shortest_by_hand(2000.0, load), rel=5e-4)
    assert scenario.travel_time_s == pytest.approx(1.05 * prepare_task(scenario).shortest_time_s, rel=1e-12)
    assert f"Travel time {scenario.travel_time_s:.1f} s: shortest running time" in scenario.time_note


def test_minutes_for_100_km():
    """The example of OSRD's documentation of margins: 42 km with 5 min/100 km take 2 min 6 s more."""
    scenario = with_reserve({"line.sections": [{"length_m": 42e3}], "solver.mesh_m": 500.0}, reserve_min_per_100km=5.0)
    assert scenario.travel_time_s - prepare_task(scenario).shortest_time_s == pytest.approx(126.0)


def test_dwells_have_no_reserve():
    scenario = with_reserve({"line.stations": [STATION]}, reserve_percent=10.0)
    assert scenario.travel_time_s == pytest.approx(25.0 + 1.1 * prepare_task(scenario).shortest_time_s)


@pytest.mark.parametrize("reverse", [False, True])
def test_parts_of_the_line(reverse):
    part = {"from_m": 1200.0, "to_m": 2000.0, "reserve_min_per_100km": 4.5}
    scenario = with_reserve(
        {"line.stations": [STATION], "line.reverse": reverse}, reserve_percent=10.0, reserve_parts=[part]
    )
    found = reserved_time(scenario)
    order = slice(None, None, -1) if reverse else slice(None)
    assert found.reserve_s[order] == pytest.approx([0.1 * found.shortest_s[order][0], 4.5 * 60 * 0.8 / 100])
    assert found.shortest_s[order] == pytest.approx([shortest_by_hand(1200.0), shortest_by_hand(800.0)], rel=1e-3)


def test_the_actual_load_changes_no_timetable():
    scenario = with_reserve({"disturbance.actual_load_factor": 1.0}, reserve_percent=10.0)
    assert actual_vehicle(scenario).travel_time_s == scenario.travel_time_s
    assert scenario.replace(**{"vehicle.load_factor": 1.0}).travel_time_s > scenario.travel_time_s + 1


@pytest.mark.parametrize(
    ("timetable", "words"),
    [
        ({"reserve_percent": 5.0, "travel_time_s": 150.0}, "needs exactly one of"),
        (
            {"travel_time_s": 150.0, "reserve_parts": [{"from_m": 0.0, "to_m": 9.0, "reserve_percent": 5.0}]},
            "no effect",
        ),
        ({"reserve_percent": 5.0, "reserve_parts": [{"from_m": 0.0, "to_m": 9.0}]}, "needs exactly one of"),
        (
            {"reserve_percent": 5.0, "reserve_parts": [{"from_m": 0.0, "to_m": 2100.0, "reserve_percent": 5.0}]},
            "beyond the end",
        ),
        ({"reserve_percent": 5.0, "deduct_train_length": True}, "no effect with reserve_percent"),
    ],
)
def test_contradictions_are_refused(timetable, words):
    with pytest.raises(ScenarioError, match=words):
        with_reserve(**timetable)


def test_a_change_replaces_the_other_way_to_give_the_time():
    timed = with_reserve(reserve_percent=5.0).replace(**{"timetable.travel_time_s": 150.0})
    assert timed.timetable.reserve_percent is None
    assert timed.replace(**{"timetable.reserve_min_per_100km": 5.0}).timetable.travel_time_s is None
