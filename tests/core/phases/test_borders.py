"""Borders of phases within cells, and straight pieces of part power and braking."""

import numpy as np
import pytest
from builders import plain_scenario
from pieces import INERTIA_KG, LARGEST_N, in_short, run_of

from railjoule.core import load_scenario, solve
from railjoule.core.arrays import frozen_array
from railjoule.core.phases import find_phases

RESISTANCE_N = 5e3


def with_one_effort_a_cell(switch_m, cell_m=10.0, length_m=400.0):
    """Return a run on the level that switches full power off within a cell, as its mesh of one effort a cell has it.

    Speeds at the nodes are those of the run that switches; the cell's effort is its mean.
    """
    position = np.arange(0.0, length_m + cell_m, cell_m)
    gained, lost = 2 * (LARGEST_N - RESISTANCE_N) / INERTIA_KG, 2 * RESISTANCE_N / INERTIA_KG
    speed = np.sqrt(25.0 + gained * np.minimum(position, switch_m) - lost * np.maximum(position - switch_m, 0.0))
    powered = np.clip(switch_m - position[:-1], 0, cell_m) / cell_m
    plain = run_of((length_m, 5.0, 0.0), start_ms=5.0, cell_m=cell_m)
    time = np.append(0, np.cumsum(2 * np.diff(position) / (speed[1:] + speed[:-1])))
    taken = np.append(0, np.cumsum(powered * LARGEST_N * cell_m))
    driven = {"speed_ms": frozen_array(speed), "time_s": frozen_array(time)}
    return plain._replace(**driven, effort_n=powered * LARGEST_N, energy_j=taken), speed


@pytest.mark.parametrize("switch_m", [50.0, 52.0, 57.5, 59.5])
def test_full_power_ends_within_its_cell(switch_m):
    run, _ = with_one_effort_a_cell(switch_m)
    full, coast = find_phases(run)
    assert (full.phase, coast.phase, full.end_m) == ("full_power", "coast", pytest.approx(switch_m, abs=1e-6))
    assert full.end_ms**2 == pytest.approx(25.0 + 2 * (LARGEST_N - RESISTANCE_N) / INERTIA_KG * switch_m)
    # the cell's energy is that of the power
    assert (full.energy_j, coast.energy_j) == (pytest.approx(LARGEST_N * switch_m), 0.0)


def test_a_cell_with_more_than_its_neighbours_is_no_border():
    """Power between a hold and coasting that is more than the hold's is not on its way to coasting."""
    phases = find_phases(run_of((300, 10, 0.1), (20, 11, 0.6), (300, 10, 0.0)))
    assert [phase.phase for phase in phases] == ["hold", "part_power", "coast"]


def test_short_power_between_coasting_is_full_power_for_a_part_of_it():
    """Half of the effort over 10 m is full power over 5 m; without resistance it gains 10 m2/s2 of speed squared."""
    faster = (100 + 2 * 0.5 * LARGEST_N * 10 / INERTIA_KG) ** 0.5
    phases = find_phases(run_of((300, 10, 0.0), (10, faster, 0.5), (300, faster, 0.0)))
    assert in_short(phases) == [("coast", 0, 300), ("full_power", 300, 305), ("coast", 305, 610)]
    assert phases[1].end_ms == pytest.approx(faster)


@pytest.mark.parametrize(
    ("before_m", "share", "names"),
    [
        # 20 kJ change 10 m/s by 0.02 m/s, less than 0.1 km/h, and from 300.3 m to 300.5 m there is no whole metre
        (300.3, 0.5, ["coast"]),
        # the same from 299.9 m to 300.1 m would begin at 300 m and end there; 40 kJ are 0.04 m/s
        (299.9, 0.5, ["coast"]),
        (299.9, 1.0, ["coast", "full_power", "coast"]),
    ],
)
def test_power_that_advice_cannot_tell_is_coasting(before_m, share, names):
    faster = (100 + 2 * share * LARGEST_N * 0.4 / INERTIA_KG) ** 0.5
    phases = find_phases(run_of((before_m, 10, 0.0), (0.4, faster, share), (300, faster, 0.0)))
    assert [phase.phase for phase in phases] == names
    assert sum(phase.energy_j for phase in phases) == pytest.approx(share * LARGEST_N * 0.4)


def test_a_brake_begins_within_its_first_cell():
    """A quarter of the brakes in a cell of 10 m is all of them in its last 2.5 m; nothing else resists."""
    slower = (400 - 2 * 0.25 * LARGEST_N * 10 / INERTIA_KG) ** 0.5
    end = (slower**2 - 2 * LARGEST_N * 50 / INERTIA_KG) ** 0.5
    phases = find_phases(run_of((300, 20, 0.0), (10, slower, -0.25), (50, end, -1.0), start_ms=20.0))
    assert in_short(phases) == [("coast", 0, pytest.approx(307.5)), ("brake", pytest.approx(307.5), 360)]
    assert (phases[1].start_ms, phases[1].effort_share) == (pytest.approx(20), pytest.approx(1))


def test_straight_pieces_stay_near_the_run_and_keep_its_time():
    """EOC's effort falls steadily, so its speed is a curve: every piece is within 0.5 km/h and 0.25 s of it."""
    run = solve(load_scenario("ftorek-300s"), "eoc")
    assert len(run.phases) < 20
    assert {phase.phase for phase in run.phases} <= {"part_power", "hold", "coast", "brake"}
    for phase in run.phases:
        inside = (run.position_m >= phase.start_m) & (run.position_m <= phase.end_m)
        place = run.position_m[inside]
        straight = np.sqrt(np.interp(place, (phase.start_m, phase.end_m), (phase.start_ms**2, phase.end_ms**2)))
        if phase.phase == "hold":
            straight = np.full(len(place), phase.mean_speed_ms)
        assert np.max(np.abs(straight - run.speed_ms[inside])) * 3.6 <= (1.0 if phase.phase == "hold" else 0.5)
        if phase.phase in {"part_power", "brake"}:
            spent = 2 * (phase.end_m - phase.start_m) / (phase.start_ms + phase.end_ms)
            assert abs(spent - (phase.end_s - phase.start_s)) <= 0.25


def test_full_braking_is_one_phase_whatever_the_brakes_have_at_each_speed():
    """Braking at constant power from 100 km/h is a curve of speed squared over distance, and yet all that there is."""
    changes = {"vehicle.braking": {"max_effort_kn": 80.0, "max_power_kw": 900.0}, "timetable.travel_time_s": 115.0}
    run = solve(plain_scenario(changes), "fastest")
    assert [phase.phase for phase in run.phases].count("brake") == 1
    assert run.phases[-1].effort_share == pytest.approx(1, abs=0.01)


def test_a_bound_of_deceleration_makes_gentle_braking_full():
    changes = {"vehicle.braking": {"max_effort_kn": 80.0, "max_deceleration_ms2": 0.4}}
    run = solve(plain_scenario(changes), "fastest")
    assert run.phases[-1].effort_share == pytest.approx(1, abs=0.01)
    assert np.max(-run.effort_n) < 0.8 * np.max(run.max_braking_n)
