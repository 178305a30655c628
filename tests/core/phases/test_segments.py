"""Power that is used in short pulses, or is briefly less than full."""

import numpy as np
import pytest
from pieces import in_short, run_of

from railjoule.core.phases import find_phases


def saw(count, low_ms, high_ms, power_m=20.0, coast_m=60.0, share=0.5):
    """Return pieces of pulses: power up to one speed, coasting down to another."""
    return ((coast_m, low_ms, 0.0), (power_m, high_ms, share)) * count


def test_pulses_of_one_mean_speed_are_a_hold_by_turns():
    run = run_of((200, 12.5, 1.0), *saw(10, 12.2, 12.5), (500, 10, 0.0), start_ms=5.0)
    assert [phase.phase for phase in find_phases(run)] == ["full_power", "hold", "part_power", "coast"]
    hold, aimed = find_phases(run)[1:3]
    assert hold.effort_share == pytest.approx(0.5)
    assert 12.2 < hold.mean_speed_ms < 12.5
    # the last pulse's end is aimed at, from where at least five seconds are left
    assert (aimed.end_m, aimed.end_ms) == (1000, pytest.approx(12.5))
    assert 5 <= aimed.end_s - aimed.start_s < 13


def test_two_pulses_are_two():
    names = [phase.phase for phase in find_phases(run_of((200, 12.5, 1.0), *saw(2, 12.2, 12.5), (500, 10, 0.0)))]
    assert names.count("coast") == 3


def test_pulses_that_gain_speed_are_part_power():
    """Six pulses from 36 to 65 km/h are a steady gain of speed, each piece of it long enough for an instruction."""
    pieces = []
    for k in range(6):
        pieces += [(30.0, 9.8 + 1.6 * k, 0.0), (20.0, 11.4 + 1.6 * k, 0.9)]
    middle = find_phases(run_of((300, 10, 0.0), *pieces, (500, 15, 0.0)))[1:-1]
    assert {phase.phase for phase in middle} == {"part_power"}
    assert len(middle) < 6
    assert all(phase.end_s - phase.start_s >= 5 for phase in middle)
    assert middle[-1].end_ms == pytest.approx(11.4 + 8.0)


def test_pulses_that_a_limit_shapes_stay_pulses():
    """A hold at their mean of 45 km/h, or a steady change of speed, would pass the limit of 38 at each coast's end."""
    limit = np.full(300, np.inf)
    pieces = []
    for k in range(4):
        pieces += [(20.0, 14.0, 0.9), (60.0, 10.5, 0.0)]
        limit[10 + 40 * k + 35 : 10 + 40 * k + 40] = 10.6
    run = run_of((20, 10, 0.0), *pieces, (20, 14.0, 0.9), (500, 13, 0.0), cell_m=2.0)
    run = run._replace(limit_ms=limit[: len(run.effort_n)])
    names = [phase.phase for phase in find_phases(run)]
    assert names.count("coast") == 6
    assert "hold" not in names


def test_power_that_is_briefly_less_than_full_counts_as_full():
    run = run_of((100, 10, 1.0), (20, 10.6, 0.7), (100, 14, 1.0), (500, 12, 0.0), start_ms=2.0)
    assert in_short(find_phases(run)) == [("full_power", 0, 220), ("coast", 220, 720)]


def test_a_short_limit_between_full_power_is_kept():
    """Full power throughout would pass 40 km/h."""
    limit = np.append(np.full(12, 40.0), np.full(60, 80.0)) / 3.6
    pieces = ((100, 40 / 3.6, 1.0), (20, 40 / 3.6, 0.6), (100, 14, 1.0), (500, 12, 0.0))
    phases = find_phases(run_of(*pieces, start_ms=2.0, limit_ms=limit))
    assert in_short(phases)[:3] == [("full_power", 0, 100), ("hold", 100, 120), ("full_power", 120, 220)]


def test_short_coasting_at_the_speed_of_a_hold_is_held():
    run = run_of((200, 15, 1.0), (30, 14.9, 0.0), (500, 14.9, 0.1), (500, 13, 0.0), start_ms=5.0)
    assert in_short(find_phases(run)) == [("full_power", 0, 200), ("hold", 200, 730), ("coast", 730, 1230)]
