"""For how long a drive stays as it is: stretches by hand, and the rule by brute force."""

import numpy as np
import pytest
from every_drive import train
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.physics.energy_balance import run_balance
from railjoule.core.physics.mesh_data import BRAKE, DRIVE, OFF
from railjoule.core.physics.stretches import (
    NEUTRAL_SECTION,
    NOTHING,
    STOP,
    actions_of_run,
    min_stretch_cells,
    stretch_durations_s,
)
from railjoule.core.strategies import prepare_task

NEVER = np.inf


def lasting(actions, durations=None, from_rest=(), cut=()):
    n = len(actions)
    interrupted_by = np.full(n, NOTHING)
    interrupted_by[list(from_rest)], interrupted_by[list(cut)] = STOP, NEUTRAL_SECTION
    return stretch_durations_s(np.array(actions), np.array(durations or [1.0] * n), interrupted_by).tolist()


def fastest_of(drive):
    task = prepare_task(train(drive, 15.0, 0.37, **{"timetable.travel_time_s": 150.0}))
    data = task.mesh.data
    return actions_of_run(data, task.fastest_speed2), run_balance(data, task.fastest_speed2)


def test_what_a_drive_does_is_told_by_its_account():
    done, account = fastest_of("synchronous")
    driven, braked = account.tractive_effort_n > 0, account.electric_braking_n > 0
    assert np.array_equal(done.mode == DRIVE, driven)
    assert np.array_equal(done.mode == BRAKE, braked)
    assert np.array_equal(done.action, np.where(driven, DRIVE, np.where(braked, BRAKE, OFF)))
    assert np.array_equal(done.duration_s, account.duration_s)
    assert done.interrupted_by.tolist() == [STOP] + [NOTHING] * (len(done.action) - 1)


def test_a_standstill_brake_lets_the_machines_be_off():
    """Before the stop the machines would draw: they brake with it, and do not without."""
    for drive, last in (("induction with a standstill brake", OFF), ("induction", BRAKE)):
        assert fastest_of(drive)[0].mode[-1] == last


def test_a_stretch_lasts_its_cells_and_half_of_the_longest():
    """Driving 1 s + 2 s and half of 2 s; what ends with the run is not switched."""
    assert lasting([DRIVE, DRIVE, OFF], [1.0, 2.0, 5.0], from_rest=[0]) == [4.0, 4.0, NEVER]


def test_a_stop_ends_a_stretch_that_nobody_switches():
    assert lasting([DRIVE, OFF, DRIVE, BRAKE, DRIVE, OFF], from_rest=[0, 4]) == [1.5, 1.5, 1.5, NEVER, 1.5, NEVER]


def test_a_neutral_section_cuts_what_nobody_switches():
    """It lies over cells 3 and 4; what is driven before it and behind it, and off within, was not ended by choice."""
    cut = lasting([DRIVE, OFF, DRIVE, OFF, OFF, DRIVE, OFF, DRIVE, OFF], from_rest=[0], cut=[3, 5])
    assert cut == [1.5, 1.5, NEVER, NEVER, NEVER, NEVER, 1.5, 1.5, NEVER]


def test_a_drive_passes_from_driving_to_braking_as_fast_as_it_likes():
    assert lasting([DRIVE, OFF, BRAKE, OFF, BRAKE], from_rest=[0]) == [1.5, NEVER, 1.5, 1.5, NEVER]


def test_a_moving_train_was_switched_before():
    assert lasting([DRIVE, OFF, DRIVE]) == [NEVER, 1.5, NEVER]


@pytest.mark.parametrize(("least", "cells"), [(0.0, 1), (1.4, 1), (1.5, 1), (1.6, 2), (2.5, 2), (2.6, 3), (99.0, 4)])
def test_stretches_count_to_the_nearest_cell(least, cells):
    """Of cells of 1 s, n last for up to n + 0.5 s; no more than there are."""
    assert min_stretch_cells(np.ones(4), least)[0] == cells


@given(st.lists(st.sampled_from([OFF, DRIVE, BRAKE]), min_size=1, max_size=12), st.floats(0.1, 6.0))
def test_what_lasts_so_many_cells_lasts_long_enough(actions, least):
    """Both sides count alike: a stretch of `min_stretch_cells` cells or more is never too short."""
    durations = [0.3 + 0.1 * k for k in range(len(actions))]
    counts, lasts = min_stretch_cells(np.array(durations), least), lasting(actions, durations, from_rest=[0])
    first = 0
    for i in range(1, len(actions)):
        if actions[i] != actions[i - 1]:
            if i - first >= counts[first]:
                assert lasts[first] >= least - 1e-12
            first = i
