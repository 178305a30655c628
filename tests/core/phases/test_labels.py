"""The driver's action in each cell, and holds of the speed."""

import numpy as np
import pytest
from pieces import in_short, run_of

from railjoule.core.phases import find_phases


@pytest.mark.parametrize(
    ("end_ms", "share", "name"),
    [
        (20.0, 1.0, "full_power"),
        (20.0, 0.98, "full_power"),
        (20.0, 0.9, "part_power"),
        (10.0, 0.1, "hold"),
        (9.9, 0.1, "hold"),
        (9.0, 0.0, "coast"),
        (9.0, 0.00005, "coast"),
        (9.0, -0.00005, "coast"),
        (5.0, -0.5, "brake"),
        (10.0, -0.2, "hold"),
    ],
)
def test_name_of_a_phase(end_ms, share, name):
    """Holding may take power uphill and brakes downhill; coasting depends only on the effort."""
    assert {phase.phase for phase in find_phases(run_of((200, end_ms, share)))} == {name}


def test_a_hold_takes_power_and_brakes_and_short_coasting():
    """Over hills that power, gentle braking and 9 s of coasting meet, one speed is one hold; 30 s are coasting."""
    short = run_of((300, 20, 0.1), (300, 20, -0.1), (180, 20, 0.0), (300, 20, 0.1), start_ms=20.0)
    assert in_short(find_phases(short)) == [("hold", 0, 1080)]
    long = run_of((300, 20, 0.1), (600, 20, 0.0), (300, 20, 0.1), start_ms=20.0)
    assert [phase.phase for phase in find_phases(long)] == ["hold", "coast", "hold"]


def test_holds_of_two_limits_are_two():
    """56.6 and 56.1 km/h read the same, but the first breaks the second's limit."""
    limit = np.append(np.full(50, 56.6), np.full(50, 56.1)) / 3.6
    pieces = ((490, 56.6 / 3.6, 0.1), (10, 56.1 / 3.6, -0.3), (500, 56.1 / 3.6, 0.1))
    phases = find_phases(run_of(*pieces, start_ms=56.6 / 3.6, limit_ms=limit))
    assert in_short(phases) == [("hold", 0, 490), ("brake", 490, 500), ("hold", 500, 1000)]
    assert in_short(find_phases(run_of(*pieces, start_ms=56.6 / 3.6))) == [("hold", 0, 1000)]


def test_a_speed_that_drifts_is_not_held():
    """0.1 m/s2 over 30 s are 11 km/h."""
    assert {phase.phase for phase in find_phases(run_of((400, 20, 0.5), start_ms=17.9))} == {"part_power"}


def test_a_train_that_all_but_stands_stands():
    phases = find_phases(run_of((100, 0.01, -0.5), (0.01, 0.0, -0.001)))
    assert [phase.phase for phase in phases] == ["brake", "stand"]
