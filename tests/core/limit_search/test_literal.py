"""The printed regulator: its ramp, its chatter, its braking curve, and how it ends."""

import numpy as np
import pytest
from builders import plain_scenario
from set_speeds import drive_under_limits

from railjoule.core import StrategyRefusedError, load_scenario
from railjoule.core.limit_search.literal import (
    ARRIVED,
    OVERSHOOTS,
    Relay,
    literal_regulation,
    literal_trip,
)
from railjoule.core.task import prepare_task

METRO = load_scenario("kharkiv-like-40kmh")
RELAY = Relay(1 / 3.6, 5 / 3.6, 2.0, 0.5, 0.01)
BORDERS = np.array([1200.0])


def driven(mesh, relay=RELAY, limit_ms=10.0, data=None):
    """Return places [m], speeds [m/s], efforts [N], standing time [s], switches and end of a trip."""
    regulation, curve = literal_regulation(mesh, 0.8, relay.dead_zone_ms)
    position, speed2, *others = literal_trip(
        data or mesh.data, regulation, curve, BORDERS, np.full(2, limit_ms), relay, 59_999
    )
    return position, np.sqrt(speed2), *others


def test_what_it_needs_depends_on_its_step():
    """findings.md: about 1 % of energy between steps of 0.1 and 0.001 s, and up to 622 switches; here 2.5 %."""
    steps = (
        METRO.replace(**{"search.regulator": "literal", "search.time_step_s": s})
        for s in (0.1, 0.05, 0.02, 0.01, 0.005)
    )
    energies = [drive_under_limits(scenario, [42.2, 42.2]).energy_kwh for scenario in steps]
    assert 1e-2 < max(energies) / min(energies) - 1 < 5e-2


def test_the_finer_its_step_the_more_it_chatters():
    """A relay has no frequency of its own: around its mark its step decides."""
    mesh = prepare_task(plain_scenario()).mesh
    switches = [driven(mesh, RELAY._replace(time_step_s=step))[4] for step in (0.1, 0.05, 0.01)]
    assert 20 < switches[0] < switches[1] < switches[2]


def test_a_step_that_fails_is_told():
    """From 40 to 30 km/h at the head of a descent of 40 per mille: at any step the ramp is too slow."""
    steep = [{"length_m": 1000.0}, {"length_m": 1000.0, "gradient_permille": -40.0, "speed_limit_kmh": 30.0}]
    scenario = plain_scenario({"line.sections": steep, "search.boundaries_m": [1000.0]})
    changes = {"timetable.travel_time_s": 250.0, "search.regulator": "literal", "search.time_step_s": 1.0}
    with pytest.raises(StrategyRefusedError, match=r"passes the speed limit of 30 km/h by 2\."):
        drive_under_limits(scenario.replace(**changes), [50.0, 40.0])


def test_effort_changes_no_faster_than_its_rate():
    """Full effort, 100 kN, after 2 s below 5 km/h, half as fast above; it falls as fast as below."""
    _, speed, effort, standing, switches, status = driven(prepare_task(plain_scenario()).mesh)
    assert status == ARRIVED
    assert switches > 2
    # the first step that moves is not the first of the ramp
    change = np.diff(effort[1:-1])
    assert np.abs(change).max() <= 100e3 / 2 * 0.01 * (1 + 1e-9)
    rising = (change > 0) & (effort[1:-2] >= 0) & (speed[1:-2] > 5 / 3.6 + 0.05)
    assert change[rising].max() <= 0.5 * 100e3 / 2 * 0.01 * (1 + 1e-9)
    assert standing < 0.1


def test_brakes_that_are_weaker_than_the_curve_overshoot():
    """A fifth of the brakes of which the curve was made: too fast for the last step, whatever it is."""
    mesh = prepare_task(plain_scenario()).mesh
    *_, status = driven(mesh, data=mesh.data._replace(braking=mesh.data.braking._replace(constant_n=16e3)))
    assert status == OVERSHOOTS
