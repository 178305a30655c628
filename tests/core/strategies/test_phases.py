"""Start, cruise, coast, brake: numbers of the findings, brute force, the trajectory's own account, refusals."""

import re

import numpy as np
import pytest
from builders import COPPER_LOSS, INDUCTION, plain_scenario
from hard_scenarios import COASTS_ALL_BUT_TO_A_STAND
from hypothesis import given, settings
from hypothesis import strategies as st

from railjoule.core import StrategyRefusedError, TimetableError, check_run, solve
from railjoule.core.drive import make_drive
from railjoule.core.errors import ScenarioError
from railjoule.core.phase_planning.planner import PhasePlanner
from railjoule.core.phase_planning.search import between
from railjoule.core.phase_planning.tables import PhaseModel
from railjoule.core.scenario import scenario_from_document
from railjoule.core.scenario.options import PhasesOptions
from railjoule.core.strategies import prepare_task, run_strategy
from tests.any_scenarios import any_task

KWH = 3.6e6
TRAM = {
    "vehicle.tare_kg": 22000.0,
    "vehicle.capacity_passengers": 0,
    "vehicle.rotating_mass_factor": 0.1529,
    "vehicle.resistance": {"constant_n": 1427.6, "quadratic_n_per_kmh2": 7.189 / 3.6**2},
    "vehicle.traction": {"max_speed_kmh": 72.0},
    "vehicle.braking": {},
    "line.sections": [{"length_m": 950.0}],
    "timetable.travel_time_s": 95.0,
}
"""The findings' tram, with `INDUCTION`."""


def tram(recuperation=0.0, **changes):
    own = INDUCTION | {"recuperation_factor": recuperation}
    return plain_scenario({**TRAM, "vehicle.drive": own, **{key.replace("__", "."): v for key, v in changes.items()}})


def planner(recuperation=0.0, holds_current=False, **options):
    vehicle = tram(recuperation).vehicle
    return PhasePlanner(
        PhaseModel(vehicle, make_drive(vehicle.drive), 0.0, 20.0, holds_current), PhasesOptions(**options)
    )


@settings(max_examples=15)
@given(
    distance=st.floats(200, 2000), share=st.floats(1.02, 2.5), recuperation=st.floats(0, 1), initial=st.floats(0, 14)
)
def test_no_other_cruise_is_better(distance, share, recuperation, initial):
    """Brute force over the cruising speed: for each the length of the cruise and the braking speed by bisection."""
    own = planner(round(recuperation, 3))
    time = share * own.fastest(distance, initial).running_time_s
    best = own.plan(distance, time, initial)
    model = own.model
    for v1 in np.linspace(0.3, 19, 60):
        for table in [model.table("start")] if v1 >= initial else [model.coasting, model.braking]:
            if v1 > table[0, -1]:
                continue
            t0, s0, e0 = between(table, min(initial, v1), max(initial, v1))
            low, high = 0.0, v1
            for _ in range(50):
                v2 = 0.5 * (low + high)
                t2, s2, _ = np.add(between(model.coasting, v2, v1), between(model.braking, 0.0, v2))
                cruise = distance - s0 - s2
                late = t0 + t2 + cruise / v1 > time
                low, high = (v2, high) if late else (low, v2)
            if cruise >= 0 and abs(t0 + t2 + cruise / v1 - time) < 1e-6:
                energy = e0 + own.cruise_power_w(v1) * cruise / v1 + between(model.braking, 0.0, v2)[2]
                assert best.energy_j <= energy + 1e-5 * abs(energy) + 1


@settings(max_examples=10)
@given(share=st.floats(1.05, 2.0), longer=st.floats(1.01, 1.3))
def test_more_time_never_costs_more(share, longer):
    own = planner(0.3)
    time = share * own.fastest(950.0).running_time_s
    assert own.plan(950.0, longer * time).energy_j < own.plan(950.0, time).energy_j


def test_parts_share_their_time_best():
    own = planner(1.0)
    plans = own.plan_parts([300.0, 650.0], 90.0)
    times = [plan.running_time_s for plan in plans]
    assert sum(times) == pytest.approx(90.0, abs=1e-9)
    least = sum(plan.energy_j for plan in plans)
    for shift in (-0.5, -0.05, 0.05, 0.5):
        assert own.plan(300.0, times[0] + shift).energy_j + own.plan(650.0, times[1] - shift).energy_j > least * (
            1 - 1e-7
        )
    # findings on Rawicki: the stop known beforehand, 2.1949 and 1.4066 with his start
    assert least / KWH == pytest.approx(1.4066, rel=5e-3)
    zero = sum(plan.energy_j for plan in planner(0.0, True).plan_parts([300.0, 650.0], 90.0))
    assert zero / KWH == pytest.approx(2.1949, rel=3e-3)


def test_from_a_moving_state():
    """Split anywhere in its start, a plan's rest is the best run from there."""
    own = planner(0.6)
    whole = own.plan(950.0, 95.0)
    time, distance, energy = between(own.model.table("start"), 0.0, 9.0)
    rest = own.plan(950.0 - distance, 95.0 - time, 9.0)
    assert rest.first == "start"
    assert energy + rest.energy_j == pytest.approx(whole.energy_j, rel=1e-7)
    assert rest.cruise_speed_ms == pytest.approx(whole.cruise_speed_ms, rel=1e-3)
    # and while it coasts, coasting goes on
    coasting = next(phase for phase in own.planned_phases(whole) if phase.phase == "coast")
    brake = between(own.model.braking, 0.0, whole.brake_speed_ms)
    late = own.plan(coasting.distance_m + brake[1], coasting.duration_s + brake[0], coasting.start_ms)
    assert late.energy_j == pytest.approx(brake[2], abs=1e-5 * KWH)


def test_too_much_time_in_motion_is_braked_off():
    plan = planner().plan(230.0, 60.0, 12.26)
    assert (plan.first, plan.energy_j) == ("brake", pytest.approx(0, abs=1))


def test_a_moving_end():
    run = solve(tram(), "phases", initial_speed_ms=5.0, final_speed_ms=4.0)
    assert run.speed_ms[[0, -1]] == pytest.approx([5, 4])
    assert run.travel_time_s == pytest.approx(95, abs=1e-6)
    assert abs(run.energy.imbalance) < 1e-6


@pytest.mark.parametrize("drive", [None, COPPER_LOSS | {"recuperation_factor": 0.3}])
def test_other_drives(drive):
    scenario = plain_scenario({} if drive is None else {"vehicle.drive": drive})
    run, best = solve(scenario, "phases"), solve(scenario, "optimal")
    assert run.travel_time_s == pytest.approx(150, abs=1e-6)
    assert abs(run.energy.imbalance) < 1e-6
    # the mesh of the bound is coarser than that of the phases
    assert best.energy.net_j * (1 - 2e-3) < run.energy.net_j < 1.1 * best.energy.net_j


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        (
            {"phases__starting_current_a": 300.0},
            "needs phases.starting_current_a = 300 to be at most the 201.05 A of the drive.",
        ),
        ({"phases__cruise": False, "timetable__travel_time_s": 5000.0}, "has no run of 5000.0 s with these phases."),
    ],
)
def test_what_it_cannot_honour(changes, sentence):
    with pytest.raises(StrategyRefusedError, match="^" + re.escape(sentence) + "$"):
        solve(tram(**changes), "phases")


def test_a_starting_current_needs_a_drive_that_knows_currents():
    with pytest.raises(StrategyRefusedError, match=r"^needs a drive with a motor current"):
        solve(plain_scenario({"phases.free_starting_current": True}), "phases")


def test_too_short_a_way_or_time():
    with pytest.raises(TimetableError):
        planner().plan(950.0, 60.0)
    words = r"^needs 60 m from the initial speed to the final one, but the distance is 50 m\.$"
    with pytest.raises(StrategyRefusedError, match=words):
        planner().plan(50.0, 60.0, 12.0)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"phases.cruise": False, "phases.coast": False}, "cruise and coast cannot both be false"),
        ({"phases.coast": False, "phases.cycles": 2}, "coast = false needs cycles = 1"),
        ({"phases.free_starting_current": True, "phases.starting_current_a": 90.0}, "excludes starting_current_a"),
    ],
)
def test_options_that_leave_no_run(options, words):
    with pytest.raises(ScenarioError, match=words):
        plain_scenario(options)


@pytest.mark.parametrize("seed", [25, 80, 89, 190])
def test_a_run_that_all_but_coasts_to_a_stand_can_be_told(seed):
    """From next to no speed, braking was a cell of next to no length."""
    run = run_strategy(any_task(seed), "phases")
    assert np.min(np.diff(run.nodes_m)) > 1e-6
    assert check_run(run.scenario, run).ok


def test_braking_from_next_to_nothing_makes_no_hole_in_the_numbers():
    scenario = scenario_from_document(COASTS_ALL_BUT_TO_A_STAND)
    run, optimum = solve(scenario, "phases", check=True), solve(scenario, "optimal")
    assert optimum.energy_kwh < run.energy_kwh < 1.2 * optimum.energy_kwh


def test_a_train_that_coasts_to_rest_does_not_turn_round():
    """On 90 per mille the train coasts down to the least speed to brake from; only the cruise is left to move."""
    changes = {
        "vehicle.tare_kg": 26000.0,
        "vehicle.traction": {"max_effort_kn": 30.7, "max_power_kw": 63.0, "max_speed_kmh": 18.3},
        "vehicle.braking": {"max_effort_kn": 11.7},
        "vehicle.drive": INDUCTION | {"motors": 3, "gear_ratio": 9.6},
        "line.sections": [{"length_m": 555.0, "gradient_permille": 90.0, "speed_limit_kmh": 14.6}],
        "timetable.travel_time_s": 232.0,
    }
    run = solve(plain_scenario(changes), "phases", check=True)
    assert run.travel_time_s == pytest.approx(232.0, rel=1e-9)
    assert run.speed_ms[1:-1].min() > 0
    assert run.notes[0].endswith(" and coasts almost to rest: it brakes from 0.036 km/h.")


def test_more_deceleration_than_is_allowed_is_refused():
    """40 per mille take 0.36 m/s2 of a train whose masses turn as well, and resistance 0.02 more."""
    changes = {"line.sections": [{"length_m": 2000.0, "gradient_permille": 40.0}], "timetable.travel_time_s": 200.0}
    limit = "vehicle.braking.max_deceleration_ms2"
    assert solve(plain_scenario(changes), "phases").energy_kwh > 0
    with pytest.raises(StrategyRefusedError, match=rf"^needs a line on which .* slows down by less than {limit} = 0.3"):
        solve(plain_scenario(changes | {limit: 0.3}), "phases")
    # at rest alone, resistance would allow it
    with pytest.raises(StrategyRefusedError, match=r"^slows down by 0\.3\d+ m/s2 at .* but the limit is 0\.38 m/s2"):
        solve(plain_scenario(changes | {limit: 0.38}), "phases")


def test_a_time_that_only_the_phases_cannot_keep():
    """They brake with the electric brake alone; the fastest run has friction beside it."""
    weak = {"vehicle.braking.max_effort_kn": 20.0, "vehicle.braking.friction_effort_kn": 80.0}
    shortest = prepare_task(plain_scenario(weak)).shortest_travel_time_s
    scenario = plain_scenario({**weak, "timetable.travel_time_s": shortest + 2})
    with pytest.raises(StrategyRefusedError) as refusal:
        solve(scenario, "phases")
    words = re.fullmatch(
        r"needs at least ([\d.]+) s with these phases; the fastest run needs ([\d.]+) s\.", str(refusal.value)
    )
    assert float(words[2]) == pytest.approx(shortest, abs=0.06)
    assert solve(scenario.replace(**{"timetable.travel_time_s": float(words[1])}), "phases").energy_kwh > 0


@pytest.mark.parametrize("steps", [[[0, 0.4]], [[0, 0.6], [40, 0.4]]], ids=["one", "two"])
def test_braking_keeps_to_the_braking_curve(steps):
    """One deceleration is driven all the way down; of two the least, which is under both."""
    scenario = plain_scenario(
        {"vehicle.braking.permitted_deceleration": steps, "timetable.travel_time_s": 160.0, "solver.mesh_m": 20.0}
    )
    run = solve(scenario, "phases")
    assert check_run(scenario, run).ok
    assert np.min(0.5 * np.diff(run.speed_ms**2) / np.diff(run.position_m)) == pytest.approx(-0.4, rel=2e-5)


def test_the_tables_error_does_not_pass_the_braking_curve():
    """Without a margin this run is above its curve by a millionth: 37.6921 km/h where 37.692 is permitted."""
    curve = {"vehicle.braking.permitted_deceleration": [[0, 0.26286569959590633]]}
    scenario = any_task(142).scenario.replace(**curve, timetable={"travel_time_s": 242.35587847209638})
    assert check_run(scenario, solve(scenario, "phases")).ok


def test_a_coasting_train_that_slows_down_faster_than_its_braking_curve_is_refused():
    changes = {"line.sections": [{"length_m": 2000.0, "gradient_permille": 40.0}], "timetable.travel_time_s": 300.0}
    curve = "vehicle.braking.permitted_deceleration"
    with pytest.raises(StrategyRefusedError, match=rf"^needs a line on which .* slows down by less than {curve} = 0.3"):
        solve(plain_scenario(changes | {curve: [[0, 0.3]]}), "phases")
