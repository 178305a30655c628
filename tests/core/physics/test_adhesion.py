"""Wheel-rail adhesion: every strategy keeps to mu(v) m g, which these tests compute by the formula itself."""

from dataclasses import replace

import numpy as np
import pytest

from railjoule.core import ScenarioError, Trajectory, load_scenario, solve
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.motion import build_meshed_line
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.actual_run import actual_run
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.studies.sweep import sweep
from tests.builders import COPPER_LOSS, INDUCTION, plain_scenario

WET = {"line.rail_condition": "wet"}
EMPTY = {"vehicle.load_factor": 0.0}
FRICTION = {"vehicle.braking.friction_effort_kn": 60.0}


def transmitted_n(scenario: Scenario, speed_ms: np.ndarray, mass_share: float) -> np.ndarray:
    """Return 0.6 (7.5 / (v + 44) + 0.161) m g: Curtius, Kniffler 1944, and Koffman 1948 for wet rails."""
    vehicle = scenario.vehicle
    mass_kg = vehicle.tare_kg + vehicle.load_factor * vehicle.capacity_passengers * vehicle.passenger_mass_kg
    return 0.6 * (7.5 / (3.6 * speed_ms + 44) + 0.161) * mass_share * mass_kg * 9.81


def used_share(run: Trajectory) -> float:
    """Return the largest effort of a run over what wet rails transmit."""
    length, duration = np.diff(run.position_m), np.diff(run.time_s)
    moves = length > 0
    speed = length[moves] / duration[moves]
    adhesion = run.scenario.vehicle.adhesion
    driven = transmitted_n(run.scenario, speed, adhesion.driven_mass_share)
    braked = transmitted_n(run.scenario, speed, adhesion.braked_mass_share)
    electric = run.electric_braking_n[moves]
    brakes = electric + run.friction_braking_n[moves]
    return float(max(np.max(run.tractive_effort_n[moves] / driven), np.max(electric / driven), np.max(brakes / braked)))


@pytest.mark.parametrize("strategy", ["optimal", "bellman", "speed_limits", "fastest"])
def test_a_metro_on_wet_rails_uses_no_more_than_their_adhesion(strategy):
    dry = load_scenario("liashenko-ii").replace(**EMPTY, **{"line.rail_condition": "dry"})
    runs = [solve(scenario, strategy, check=True) for scenario in (dry, dry.replace(**WET))]
    assert all(run.check.ok for run in runs)
    assert 0.999 < used_share(runs[1]) <= 1 + 1e-9
    # on dry rails the same metro pulls more than that
    assert used_share(runs[0]) > 1.02
    if strategy == "fastest":
        assert runs[1].travel_time_s > runs[0].travel_time_s + 1
    else:
        assert runs[1].energy.net_j > 1.001 * runs[0].energy.net_j


def test_phases_on_wet_rails_use_no_more_than_their_adhesion():
    """With each kind of corner: adhesion under a constant effort, a power, and an induction machine's own limits."""
    for drive in (COPPER_LOSS, INDUCTION | {"motors": 12}):
        dry = plain_scenario({"vehicle.drive": drive, "vehicle.adhesion.driven_mass_share": 0.5})
        runs = [solve(scenario, "phases", check=True, prove_seconds=0) for scenario in (dry, dry.replace(**WET))]
        assert all(run.check.ok for run in runs)
        assert 0.999 < used_share(runs[1]) <= 1 + 1e-9 < used_share(runs[0])
        assert runs[1].energy.net_j > runs[0].energy.net_j


@pytest.mark.parametrize("strategy", ["eoc", "enoc"])
def test_closed_formulas_refuse_what_wet_rails_do_not_transmit(strategy):
    scenario = load_scenario("ftorek-300s").replace(**WET)
    run = solve(scenario, strategy)
    assert used_share(run) < 1
    slippery = scenario.replace(**{"vehicle.adhesion.wet_share": 0.97 * 0.6 * used_share(run)})
    with pytest.raises(StrategyRefusedError, match="where at most"):
        solve(slippery, strategy)


@pytest.mark.parametrize("drive", [None, COPPER_LOSS, INDUCTION | {"motors": 12}])
def test_the_table_of_the_solvers_lies_just_below_the_law(drive):
    changes = {**WET, **FRICTION, "vehicle.adhesion.driven_mass_share": 0.4, "vehicle.load_factor": 0.3}
    scenario = plain_scenario(changes if drive is None else {**changes, "vehicle.drive": drive})
    free = build_meshed_line(scenario.replace(**{"line.rail_condition": None})).data
    data, speed = build_meshed_line(scenario).data, np.linspace(1e-3, 100 / 3.6, 30_001)
    law = transmitted_n(scenario, speed, 0.4)
    for limit, without in ((data.traction, free.traction), (data.braking, free.braking)):
        assert np.all(limit.effort_n(speed) <= law * (1 + 1e-12))
        assert limit.effort_n(speed) == pytest.approx(np.minimum(without.effort_n(speed), law), rel=1e-4)
    assert np.any(data.traction.effort_n(speed) < 0.99 * free.traction.effort_n(speed))


def test_friction_brakes_have_what_adhesion_leaves_beside_the_electric_brake():
    scenario = plain_scenario({**WET, "vehicle.braking.friction_effort_kn": 150.0, **all_axles(0.5)})
    data, speed = build_meshed_line(scenario).data, np.linspace(0.1, 100 / 3.6, 5001)
    left = transmitted_n(scenario, speed, 1.0) - data.braking.effort_n(speed)
    assert data.friction_effort_n < 100e3
    assert np.min(left) == pytest.approx(data.friction_effort_n, rel=2e-4)
    assert data.friction_effort_n <= np.min(left)
    # nothing is taken from brakes that adhesion does not limit
    weak = scenario.replace(**FRICTION, **{"line.rail_condition": "dry"})
    assert build_meshed_line(weak).data.friction_effort_n == 60e3


def all_axles(driven_share: float) -> dict[str, float]:
    return {"vehicle.adhesion.driven_mass_share": driven_share, "vehicle.adhesion.braked_mass_share": 1.0}


def test_braking_from_60_kmh_on_wet_rails_takes_the_distance_of_the_law():
    """The distance is the integral of m v dv / (B + R) with the efforts of the law; no solver takes part."""
    scenario = plain_scenario({**WET, **all_axles(0.3), "timetable.travel_time_s": 300.0})
    lengths = []
    for each in (scenario.replace(**{"line.rail_condition": None}), scenario):
        run = solve(each, "fastest")
        slowing = run.position_m[np.argmax(run.speed_ms) :]
        lengths.append(2000.0 - float(np.interp(-60 / 3.6, -run.speed_ms[-len(slowing) :], slowing)))
    v = np.linspace(0, 60 / 3.6, 20_001)
    effort = np.minimum(80e3, transmitted_n(scenario, v, 0.3))
    resistance = 100 * 9.81 * (2.0 + 5e-4 * (3.6 * v) ** 2)
    assert lengths[1] == pytest.approx(np.trapezoid(110e3 * v / (effort + resistance), v), rel=2e-3)
    assert lengths[1] > 1.4 * lengths[0]


def test_a_plan_for_dry_rails_is_late_on_wet_ones():
    changes = {"line.rail_condition": "dry", "simulation.target_braking": False, "timetable.travel_time_s": 90.0}
    run = actual_run(load_scenario("liashenko-ii").replace(**EMPTY, **changes, **{"disturbance.rail_condition": "wet"}))
    assert [cause.name for cause in run.causes] == ["conditions"]
    assert run.actual.scenario.line.rail_condition == "wet"
    assert used_share(run.planned) > 1.001 > used_share(run.actual)
    assert run.delay_s > 0.05


def test_a_sweep_over_the_load_takes_the_adhesion_of_each_load():
    base = load_scenario("liashenko-ii").replace(**WET)
    table = sweep(base, {"vehicle.load_factor": (0.0, 0.5)}, 2, "grid")
    # a sweep keeps the mesh of the scenario
    tasks = [prepare_task(base.replace(**{"vehicle.load_factor": load})) for load in (0.0, 0.5)]
    single = [run_strategy(replace(task, can_be_remeshed=False), "optimal").energy_kwh for task in tasks]
    assert table.columns["energy_kwh"] == pytest.approx(single, rel=1e-7)


@pytest.mark.parametrize("table", ["line", "disturbance"])
def test_a_rail_condition_without_the_driven_mass_is_refused(table):
    with pytest.raises(ScenarioError, match=rf"{table}\.rail_condition = 'wet' needs vehicle.adhesion.driven_mass_sh"):
        plain_scenario({f"{table}.rail_condition": "wet"})


def test_more_driven_than_braked_mass_is_refused():
    shares = {"vehicle.adhesion": {"driven_mass_share": 0.8, "braked_mass_share": 0.5}}
    with pytest.raises(ScenarioError, match=r"driven_mass_share = 0.8 must be at most braked_mass_share = 0.5"):
        plain_scenario(shares)
