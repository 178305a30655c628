"""A task: the times of a run with and without its dwells, and what is refused before any strategy begins."""

from dataclasses import replace

import numpy as np
import pytest
from builders import plain_scenario

from railjoule.core import TimetableError, solve
from railjoule.core.lower_bound import LATE_SHARE
from railjoule.core.motion import running_time
from railjoule.core.strategies import prepare_task
from railjoule.core.task import MIN_SLACK

STOPS = {
    "line.stations": [
        {"position_m": 0.0},
        {"position_m": 600.0, "dwell_s": 20.0},
        {"position_m": 1300.0, "dwell_s": 12.5},
        {"position_m": 2000.0},
    ],
    "timetable.travel_time_s": 300.0,
}


def test_dwells_between_the_ends_count_in_the_travel_time_alone():
    task = prepare_task(plain_scenario(STOPS))
    assert (task.dwell_s, task.travel_time_s, task.running_time_s) == (32.5, 300, 267.5)
    assert task.shortest_travel_time_s == task.shortest_time_s + 32.5
    assert task.shortest_time_s == running_time(task.mesh.data.cell_length_m, task.fastest_speed2)


def test_ends_and_nodes_are_those_asked_for():
    nodes = np.linspace(0, 2000, 21)
    task = prepare_task(plain_scenario(), 1.0, 2.0, nodes)
    assert task.fastest_speed2[[0, -1]].tolist() == [1.0, 4.0]
    assert task.mesh.position_m.tolist() == nodes.tolist()


@pytest.mark.parametrize(("excess", "kept"), [(-1e-3, False), (0.0, False), (0.5, False), (2.0, True)])
def test_a_timetable_needs_slack(excess, kept):
    """In shares of the least slack that leaves an interior point its inside."""
    task = prepare_task(plain_scenario())
    task = replace(task, running_time_s=task.shortest_time_s * (1 + excess * MIN_SLACK))
    assert task.has_slack is kept
    if kept:
        task.require_timetable()
    else:
        with pytest.raises(TimetableError):
            task.require_timetable()


def test_a_timetable_that_cannot_be_kept_names_the_shortest_one():
    task = prepare_task(plain_scenario({**STOPS, "timetable.travel_time_s": 150.0}))
    with pytest.raises(TimetableError) as error:
        task.require_timetable()
    assert (error.value.travel_time_s, error.value.shortest_time_s) == (150, task.shortest_travel_time_s)
    words, named = str(error.value).removesuffix(" s.").rsplit(maxsplit=1)
    assert words == "timetable.travel_time_s = 150 s is shorter than the shortest possible"
    assert 0 < float(named) - task.shortest_travel_time_s <= 0.1


def test_the_time_that_a_refusal_names_can_be_kept():
    scenario = plain_scenario({"line.sections": [{"length_m": 1500.0}], "timetable.travel_time_s": 60.0})
    with pytest.raises(TimetableError) as error:
        solve(scenario)
    named = str(error.value).split("shortest possible ")[1].removesuffix(" s.")
    run = solve(scenario.replace(**{"timetable.travel_time_s": float(named)}))
    assert run.travel_time_s <= float(named) * (1 + LATE_SHARE)
