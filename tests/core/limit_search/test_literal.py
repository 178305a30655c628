"""The printed regulator: its ramp, its chatter, its braking curve, and how it ends."""

import numpy as np
import pytest
from builders import plain_scenario

from railjoule.core import load_scenario
from railjoule.core.limit_search.literal import (
    ARRIVED,
    BRAKE_RESERVE,
    OVERSHOOTS,
    STANDS,
    Relay,
    literal_regulation,
    literal_trip,
)
from railjoule.core.simulate.regulator import drive_under_limits, literal_spread
from railjoule.core.task import prepare_task

METRO = load_scenario("kharkiv-like-40kmh")
RELAY = Relay(1 / 3.6, 5 / 3.6, 2.0, 0.5, 0.01)
BORDERS = np.array([1200.0])
MASS_KG = 110e3


def driven(course, relay=RELAY, limit_ms=10.0, data=None):
    """Return places [m], speeds [m/s], efforts [N], standing time [s], switches and end of a trip."""
    regulation, curve = literal_regulation(course, 0.8, relay.dead_zone_ms)
    position, speed2, effort = np.empty((3, 60_000))
    nodes, standing, switches, status = literal_trip(
        data or course.data, regulation, curve, BORDERS, np.full(2, limit_ms), relay, position, speed2, effort
    )
    return position[:nodes], np.sqrt(speed2[:nodes]), effort[:nodes], standing, switches, status


@pytest.mark.parametrize("step", [0.1, 0.02])
def test_it_arrives_and_its_account_closes(step):
    scenario = METRO.with_(**{"search.regulator": "literal", "search.time_step_s": step})
    run = drive_under_limits(scenario, [40, 35], "literal")
    assert abs(run.energy.imbalance) < 1e-6
    assert run.speed_ms[-1] == 0
    assert run.position_m[-1] == 2400
    # dead zone, ramp and a curve of two seconds keep it near its limits
    assert run.speed_ms.max() * 3.6 < 40 + 1 + 2
    assert "The literal regulator switches" in run.notes[1]


def test_what_it_needs_depends_on_its_step():
    """findings.md: about 1 % of energy between steps of 0.1 and 0.001 s, and up to 622 switches; here 2.5 %."""
    runs = literal_spread(METRO, [42.2, 42.2], [0.1, 0.05, 0.02, 0.01, 0.005])
    assert not any(run.refusal for run in runs)
    energies = [run.energy_kwh for run in runs]
    assert 1e-2 < max(energies) / min(energies) - 1 < 5e-2


def test_the_finer_its_step_the_more_it_chatters():
    """A relay has no frequency of its own: around its mark its step decides."""
    course = prepare_task(plain_scenario()).course
    switches = [driven(course, RELAY._replace(time_step_s=step))[4] for step in (0.1, 0.05, 0.01)]
    assert 20 < switches[0] < switches[1] < switches[2]


def test_a_step_that_fails_is_told():
    """From 40 to 30 km/h at the head of a descent of 40 per mille: at any step the ramp is too slow."""
    steep = [{"length_m": 1000.0}, {"length_m": 1000.0, "gradient_permille": -40.0, "speed_limit_kmh": 30.0}]
    scenario = plain_scenario({"line.sections": steep, "search.boundaries_m": [1000.0]})
    (run,) = literal_spread(scenario.with_(**{"timetable.travel_time_s": 250.0}), [50.0, 40.0], [1.0])
    assert "passes the speed limit of 30 km/h by 2." in run.refusal
    assert np.isnan(run.energy_kwh)


def test_effort_changes_no_faster_than_its_rate():
    """Full effort, 100 kN, after 2 s below 5 km/h, half as fast above; it falls as fast as below."""
    _, speed, effort, standing, switches, status = driven(prepare_task(plain_scenario()).course)
    assert status == ARRIVED
    assert switches > 2
    # the first step that moves is not the first of the ramp
    change = np.diff(effort[1:-1])
    assert np.abs(change).max() <= 100e3 / 2 * 0.01 * (1 + 1e-9)
    rising = (change > 0) & (effort[1:-2] >= 0) & (speed[1:-2] > 5 / 3.6 + 0.05)
    assert change[rising].max() <= 0.5 * 100e3 / 2 * 0.01 * (1 + 1e-9)
    assert standing < 0.1


def test_it_stops_along_a_constant_deceleration():
    """v^2 = 2 d s: 80 kN of brakes less the reserve, and 2 kN/1000 kN of resistance, are less than 0.8 m/s2."""
    place, speed, _, _, _, status = driven(prepare_task(plain_scenario()).course)
    assert status == ARRIVED
    last = place > 1970
    remaining = 2000 - place[last][:-1]
    deceleration = speed[last][:-1] ** 2 / (2 * remaining)
    resistance = 2e-3 * 100e3 * 9.81
    assert deceleration == pytest.approx(((1 - BRAKE_RESERVE) * 80e3 + resistance) / MASS_KG, rel=0.02)


@pytest.mark.parametrize("step", [0.01, 0.1, 0.5])
def test_a_coarse_step_brakes_earlier_and_still_arrives(step):
    place, speed, *_, status = driven(prepare_task(plain_scenario()).course, RELAY._replace(time_step_s=step))
    assert status == ARRIVED
    assert place[-1] == 2000
    assert speed[-1] == 0


def test_brakes_that_are_weaker_than_the_curve_overshoot():
    """A fifth of the brakes of which the curve was made: too fast for the last step, whatever it is."""
    course = prepare_task(plain_scenario()).course
    weak = course.data._replace(braking=course.data.braking._replace(constant_n=16e3))
    *_, status = driven(course, data=weak)
    assert status == OVERSHOOTS


def test_a_train_without_enough_effort_stands():
    course = prepare_task(plain_scenario()).course
    *_, standing, _, status = driven(course, data=course.data._replace(line_force_n=np.full(course.cell_count, 150e3)))
    assert status == STANDS
    # full effort is reached after 2 s: more does not come
    assert standing <= 2.0


def test_no_mark_lies_within_a_dead_zone_of_the_lines_limit():
    course = prepare_task(plain_scenario({"line.sections": [{"length_m": 2000.0, "speed_limit_kmh": 30.0}]})).course
    _, speed, *_, status = driven(course, limit_ms=20.0)
    assert status == ARRIVED
    assert 28 / 3.6 < speed.max() <= 30 / 3.6
