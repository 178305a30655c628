"""The fastest run, and timetables around its time."""

import math

import numpy as np
import pytest
from builders import plain_scenario
from hypothesis import given
from hypothesis import strategies as st
from random_scenarios import random_run

from railjoule.core import TimetableError, solve
from railjoule.core.bounds import minimise
from railjoule.core.strategies import run_strategy
from railjoule.core.task import Task

seeds = st.integers(0, 10**6)


@given(st.floats(0, 20), st.floats(30, 100), st.floats(20, 100))
def test_closed_form_on_a_flat_line(resistance_n_per_kn, speed_kmh, braking_kn):
    """Full effort, the greatest speed, full braking, each at a constant force; nodes fall on the two changes."""
    mass, top, rolling = 100e3, speed_kmh / 3.6, resistance_n_per_kn * 981
    up, down = (100e3 - rolling) / mass, (1e3 * braking_kn + rolling) / mass
    run = solve(
        plain_scenario(
            {
                "vehicle.rotating_mass_factor": 0.0,
                "vehicle.resistance": {"constant_n_per_kn": resistance_n_per_kn},
                "vehicle.traction": {"max_effort_kn": 100.0, "max_speed_kmh": speed_kmh},
                "vehicle.braking.max_effort_kn": braking_kn,
                "line.sections": [{"length_m": way} for way in [0.5 * top**2 / up, 700.0, 0.5 * top**2 / down]],
            }
        ),
        "fastest",
    )
    assert run.travel_time_s == pytest.approx(top / up + 700 / top + top / down, rel=1e-9)
    assert run.max_speed_kmh == pytest.approx(speed_kmh)


def test_its_time_is_too_short_a_timetable_for_all_others():
    """It runs whatever the timetable says; a bound goes with it where there is one."""
    scenario = plain_scenario({"timetable.travel_time_s": 60.0})
    run = solve(scenario, "fastest")
    assert run.bound is None
    assert run.travel_time_s > 60
    below, above = (
        scenario.replace(**{"timetable.travel_time_s": run.travel_time_s * factor}) for factor in (1, 1 + 1e-6)
    )
    for strategy in ("optimal", "eoc", "enoc"):
        with pytest.raises(TimetableError):
            solve(below, strategy)
    assert solve(above, "fastest").gap > 0


@given(seeds)
def test_without_slack_the_optimum_is_the_fastest_run(seed):
    run = random_run(seed, stops=seed % 2 == 1)
    tight = Task(run.scenario, run.mesh, run.fastest_speed2, run.shortest_time_s, run.shortest_time_s * (1 + 1e-8))
    speed = np.sqrt(minimise(tight).optimum.speed2)
    # a speed lower by a share e over one cell costs at least that share of its time
    shortest_cell = run.mesh.data.cell_length_m.min() / speed.max() / run.shortest_time_s
    assert speed == pytest.approx(run_strategy(tight, "fastest").speed_ms, abs=speed.max() * 1e-8 / shortest_cell)
    assert math.isclose(run_strategy(tight, "fastest").travel_time_s, run.shortest_time_s)
