"""A run in the words of a driver, by hand and over whole runs."""

import numpy as np
import pytest
from builders import plain_scenario
from hypothesis import given
from hypothesis import strategies as st
from random_scenarios import random_run

from railjoule.core import solve
from railjoule.core.phases import SHORTEST_SHARE, find_phases
from railjoule.core.strategies import run_strategy

LARGEST_N = 100e3


def phases_of(*pieces, start_ms=10.0):
    """Return the phases of pieces (length [m], speed at the end [m/s], effort share), each cut into cells of 10 m.

    A piece without length is a stand of 30 s.
    """
    position, speed, effort, duration = [0.0], [start_ms], [], []
    for length, end_ms, share in pieces:
        count = max(round(length / 10), 1)
        for speed2 in np.linspace(speed[-1] ** 2, end_ms**2, count + 1)[1:]:
            position.append(position[-1] + length / count)
            duration.append(2 * length / count / (speed[-1] + speed2**0.5) if length else 30.0)
            speed.append(speed2**0.5)
            effort.append(share * LARGEST_N)
    efforts, time = np.array(effort), np.append(0, np.cumsum(duration))
    taken = np.append(0, np.cumsum(np.maximum(efforts, 0) * np.diff(position)))
    largest = np.full(len(efforts), LARGEST_N)
    return find_phases(np.array(position), time, np.array(speed), efforts, largest, taken)


def in_short(phases):
    return [(phase.phase, phase.start_m, phase.end_m) for phase in phases]


@pytest.mark.parametrize(
    ("end_ms", "share", "name"),
    [
        (20.0, 1.0, "full_power"),
        (20.0, 0.98, "full_power"),
        (20.0, 0.9, "part_power"),
        (10.0, 0.1, "hold"),
        (9.9, 0.1, "hold"),
        (9.0, 0.0, "coast"),
        (11.0, 0.003, "coast"),
        (9.0, -0.003, "coast"),
        (5.0, -0.5, "brake"),
        (10.0, -0.2, "hold"),
    ],
)
def test_name_of_a_phase(end_ms, share, name):
    """Holding may take power uphill and brakes downhill; coasting depends on the effort alone."""
    assert in_short(phases_of((200, end_ms, share))) == [(name, 0, 200)]


def test_the_classical_run():
    phases = phases_of((100, 15, 1.0), (400, 15, 0.1), (300, 12, 0.0), (100, 0.0, -0.8), start_ms=0.0)
    assert in_short(phases) == [("full_power", 0, 100), ("hold", 100, 500), ("coast", 500, 800), ("brake", 800, 900)]
    first, second = phases[:2]
    assert (first.start_s, first.start_ms, first.end_ms) == (0, 0, pytest.approx(15))
    assert first.end_s == second.start_s == pytest.approx(100 / 7.5)
    assert [phase.energy_j for phase in phases] == pytest.approx([100e3 * 100, 10e3 * 400, 0, 0])


def test_what_is_too_short_belongs_to_its_longer_neighbour():
    """10 m are less than 0.004 of 3 km; the two coasting stretches beside it become one."""
    assert in_short(phases_of((2000, 9, 0.0), (10, 9, 0.1), (1000, 8, 0.0))) == [("coast", 0, 3010)]
    phases = phases_of((2000, 30, 1.0), (10, 30, 0.1), (990, 25, 0.0))
    assert in_short(phases) == [("full_power", 0, 2010), ("coast", 2010, 3000)]


def test_one_cell_of_part_power_between_phases_is_none():
    """Within it the effort changes from one to the next; here it is longer than the shortest phase."""
    phases = phases_of((200, 14, 1.0), (10, 14.2, 0.5), (500, 13, 0.0))
    assert in_short(phases) == [("full_power", 0, 200), ("coast", 200, 710)]


def test_a_stand_parts_phases_however_short_they_are():
    phases = phases_of((2000, 0.0, -0.5), (0, 0.0, 0.0), (5, 2.0, 1.0), (0, 0.0, 0.0), (2000, 10, 1.0))
    assert [phase.phase for phase in phases] == ["brake", "stand", "full_power", "stand", "full_power"]
    assert phases[1].end_s - phases[1].start_s == 30


@given(st.integers(0, 10**6), st.sampled_from(["optimal", "fastest"]))
def test_phases_cover_the_run(seed, strategy):
    run = run_strategy(random_run(seed, stops=seed % 2 == 1).task, strategy)
    first, last = run.phases[0], run.phases[-1]
    assert (first.start_m, first.start_s, first.start_ms) == (0, 0, run.speed_ms[0])
    assert (last.end_m, last.end_s, last.end_ms) == (run.position_m[-1], run.time_s[-1], run.speed_ms[-1])
    for one, other in zip(run.phases, run.phases[1:], strict=False):
        assert (one.end_m, one.end_s, one.end_ms) == (other.start_m, other.start_s, other.start_ms)
        assert one.phase != other.phase
    moving = [phase for phase in run.phases if phase.phase != "stand"]
    assert len(moving) == 1 or min(p.end_m - p.start_m for p in moving) >= SHORTEST_SHARE * run.distance_m
    assert sum(phase.energy_j for phase in run.phases) == pytest.approx(run.energy.net_j, rel=1e-9, abs=1.0)


@pytest.mark.parametrize(
    ("length_m", "names"),
    [(8000.0, ["full_power", "hold", "coast", "brake"]), (2000.0, ["full_power", "coast", "brake"])],
)
def test_the_optimum_without_recuperation_has_the_classical_phases(length_m, names):
    """Pontryagin's principle: on a level line with constant efficiency there are no others; short runs need no hold."""
    changes = {"line.sections": [{"length_m": length_m}], "timetable.travel_time_s": length_m / 15}
    run = solve(plain_scenario({"drive.recuperation_factor": 0.0, **changes}))
    assert [phase.phase for phase in run.phases] == names
