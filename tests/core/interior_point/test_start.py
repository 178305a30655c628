"""The start of the method: inside the limits, however tight the timetable is."""

from dataclasses import replace

import numpy as np
import pytest
from builders import plain_scenario
from hypothesis import given
from hypothesis import strategies as st
from random_scenarios import random_run

from railjoule.core.interior_point.layout import allocate
from railjoule.core.interior_point.start import prepare, start_speeds
from railjoule.core.motion import running_time
from railjoule.core.strategies import prepare_task

seeds = st.integers(0, 10**6)
slacks = st.floats(-7, 0.5).map(lambda power: 10**power)


def with_slack(task, slack):
    return replace(task, running_time_s=task.shortest_time_s * (1 + slack))


def started(task):
    speed2 = np.empty(task.course.cell_count + 1)
    start_speeds(task.course.data, task.greatest_speed2, task.shortest_time_s, task.running_time_s, speed2)
    return speed2


@given(seeds, slacks)
def test_start_keeps_speeds_and_uses_about_as_much_slack_as_there_is(seed, slack):
    """At most nine tenths, and of those no less than half; beyond the shortest time again, slack is not used."""
    task = with_slack(random_run(seed, stops=seed % 2 == 1).task, slack)
    fixed, speed2 = task.course.data.fixed_speed2, started(task)
    free = fixed < 0
    assert np.all((speed2[free] > 0) & (speed2[free] < task.greatest_speed2[free]))
    assert np.array_equal(speed2[~free], fixed[~free])
    used = running_time(task.course.data.cell_length_m, speed2) - task.shortest_time_s
    assert 0.44 < used / min(task.running_time_s - task.shortest_time_s, task.shortest_time_s) < 0.9001


@given(st.floats(100, 5000), slacks)
def test_start_on_a_level_line_keeps_efforts(length_m, slack):
    """Strictly. A hill that the fastest run takes by run-up may ask a slower one for more than there is."""
    task = with_slack(prepare_task(plain_scenario({"line.sections": [{"length_m": length_m}]})), slack)
    data, speed2 = task.course.data, started(task)
    mean_speed = 0.5 * (np.sqrt(speed2[1:]) + np.sqrt(speed2[:-1]))
    force = task.course.net_force_n(speed2)
    assert np.all(force < data.traction.effort_n(mean_speed))
    assert np.all(-force < data.braking.effort_n(mean_speed))


@given(seeds, slacks)
def test_slacks_and_multipliers_are_positive_where_there_is_a_limit(seed, slack):
    task = with_slack(random_run(seed, stops=seed % 2 == 1).task, slack)
    data, work = task.course.data, allocate(task.course.cell_count, 0)
    limits = task.greatest_speed2, task.shortest_time_s, task.running_time_s
    time_slack, time_multiplier, weights = prepare(data, data.traction.constant_n, *limits, work)
    assert min(time_slack, time_multiplier) > 0
    for rows in (work.rows, work.bounds):
        used = rows.weight > 0
        assert np.all(rows.slack[used] > 0)
        assert np.all(rows.multiplier[used] > 0)
        assert np.all(rows.multiplier[~used] == 0)
    assert weights == pytest.approx(work.rows.weight.sum() + work.bounds.weight.sum() + 0.2 * task.course.length_m)
