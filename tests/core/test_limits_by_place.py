"""Limits of effort, power, current, recuperation and adhesion by place, and limits of speed that begin early.

The right values are those of a pass forward and a pass backward in the square of speed, metre by metre, and of sums
over a run's speeds; both are written here and use nothing of the package.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from railjoule.core import InfeasibleLineError, ScenarioError, load_scenario, solve
from railjoule.core.check import check_run
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.motion import build_meshed_line
from railjoule.core.simulation.actual_run import actual_run
from railjoule.core.simulation.field_oriented import simulate_field_oriented
from railjoule.core.simulation.following import simulate_following
from railjoule.core.simulation.manual import require_drivable
from railjoule.core.strategies import prepare_task
from railjoule.core.studies.whole_line import whole_line
from tests.any_scenarios import any_placed_task
from tests.builders import HILLS, INDUCTION, LOSS_POLYNOMIAL, plain_scenario

G_MS2, MASS_KG, LENGTH_M = 9.81, 100e3, 2000
INERTIA_KG = 1.1 * MASS_KG
Effort = Callable[[float, float], float]
"""Largest effort [N] at a place [m] and a speed [m/s]."""


def place(start: float, end: float, **limits: Any) -> dict[str, Any]:
    return {"line.traction_limits": [{"from_m": start, "to_m": end, **limits}]}


def wet(start: float, end: float) -> dict[str, Any]:
    return {
        "line.rail_condition": "dry",
        "line.rail_conditions": [{"from_m": start, "to_m": end, "condition": "wet"}],
        "vehicle.adhesion": {"driven_mass_share": 0.3},
    }


def pulling(_place: float, speed: float) -> float:
    return min(100e3, 1e6 / speed)


def braking(_place: float, _speed: float) -> float:
    return 80e3


def resistance_n(speed: float) -> float:
    """Return the running resistance of the plain train [N]: 2 + 0.0005 v^2 N/kN, v in km/h."""
    return MASS_KG * G_MS2 / 1e3 * (2.0 + 5e-4 * (3.6 * speed) ** 2)


def adhesion_n(speed: float, wet_share: float = 1.0) -> float:
    """Return what 0.3 of the weight transmits [N], after Curtius and Kniffler."""
    return 0.3 * wet_share * (7.5 / (3.6 * speed + 44) + 0.161) * MASS_KG * G_MS2


def shortest_time_s(pull: Effort = pulling, brake: Effort = braking, limits: Any = ()) -> float:
    """Return the time of the fastest run: m v dv/ds = F - R forward, F + R backward, in steps of 0.25 m."""
    step, count = 0.25, 4 * LENGTH_M
    middle = (np.arange(count) + 0.5) * step
    top2 = np.full(count + 1, (100 / 3.6) ** 2)
    for start, end, kmh in limits:
        inside = (middle > start) & (middle < end)
        top2[:-1][inside] = np.minimum(top2[:-1][inside], (kmh / 3.6) ** 2)
        top2[1:][inside] = np.minimum(top2[1:][inside], (kmh / 3.6) ** 2)

    def driven(forward: bool) -> np.ndarray:
        square = np.zeros(count + 1)
        for k in range(count):
            where = middle[k] if forward else middle[-1 - k]
            ahead = square[k] + 1e-6
            for _ in range(20):
                # the force at the mean speed of the step
                speed = 0.5 * (np.sqrt(square[k]) + np.sqrt(ahead))
                effort = (
                    pull(where, speed) - resistance_n(speed) if forward else brake(where, speed) + resistance_n(speed)
                )
                ahead = max(square[k] + 2 * effort * step / INERTIA_KG, 1e-9)
            square[k + 1] = min(ahead, (top2 if forward else top2[::-1])[k + 1])
        return square

    speed = np.sqrt(np.minimum(driven(True), driven(False)[::-1]))
    return float(np.sum(2 * step / (speed[1:] + speed[:-1])))


def inside(start: float, end: float, where: float) -> bool:
    return start < where < end


CASES: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "nothing": ({}, {}),
    "effort": (
        place(0, 600, max_effort_kn=40),
        {"pull": lambda x, v: min(pulling(x, v), 40e3 if x < 600 else np.inf)},
    ),
    "factor": (
        place(0, 700, effort_factor=0.6),
        {"pull": lambda x, v: pulling(x, v) * (0.6 if x < 700 else 1)},
    ),
    "power": (
        place(100, 900, max_power_kw=400),
        {"pull": lambda x, v: min(pulling(x, v), 400e3 / v if inside(100, 900, x) else np.inf)},
    ),
    "two together": (
        {
            "line.traction_limits": [
                {"from_m": 0, "to_m": 500, "max_effort_kn": 60},
                {"from_m": 300, "to_m": 800, "max_power_kw": 500, "effort_factor": 0.9},
            ]
        },
        {
            "pull": lambda x, v: min(
                pulling(x, v) * (0.9 if inside(300, 800, x) else 1),
                60e3 if x < 500 else np.inf,
                500e3 / v if inside(300, 800, x) else np.inf,
            )
        },
    ),
    "current": (
        # 1000 A at 750 V less 50 kW of auxiliaries leave 700 kW, of which 0.85 come to the wheels
        place(100, 900, max_current_a=1000) | {"vehicle.line_voltage_v": 750, "vehicle.auxiliary_power_kw": 50},
        {"pull": lambda x, v: min(pulling(x, v), 0.85 * 700e3 / v if inside(100, 900, x) else np.inf)},
    ),
    "wet rails": (
        wet(100, 1900) | {"vehicle.braking.max_effort_kn": 100},
        {
            "pull": lambda x, v: min(pulling(x, v), adhesion_n(v, 0.6 if inside(100, 1900, x) else 1)),
            "brake": lambda x, v: min(100e3, adhesion_n(v, 0.6 if inside(100, 1900, x) else 1)),
        },
    ),
    "early limits": (
        {
            "line.sections": [{"length_m": 800}, {"length_m": 400, "speed_limit_kmh": 60}, {"length_m": 800}],
            "line.speed_limits": [{"from_m": 900, "to_m": 1000, "limit_kmh": 40}],
            "line.limit_margin_m": 80,
        },
        {"limits": [(720, 1200, 60), (820, 1000, 40)]},
    ),
    "early limits of a long train": (
        {
            "line.sections": [{"length_m": 800}, {"length_m": 100, "speed_limit_kmh": 60}, {"length_m": 1100}],
            "line.limits_hold_for": "whole_train",
            "line.limit_margin_m": 50,
            "vehicle.length_m": 250,
        },
        {"limits": [(750, 1150, 60)]},
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_the_fastest_run_is_that_of_two_passes(case):
    changes, own = CASES[case]
    run = solve(plain_scenario({"solver.mesh_m": 2.0, **changes}), "fastest", check=True)
    assert run.travel_time_s == pytest.approx(shortest_time_s(**own), rel=2e-4)
    if case != "nothing":
        assert run.travel_time_s > shortest_time_s() * (1 + 3e-3)


@pytest.mark.parametrize("case", CASES)
def test_the_reverse_of_a_mirrored_line_is_the_same_run(case):
    scenario = plain_scenario({"timetable.travel_time_s": 180.0, **CASES[case][0]})
    line = scenario.line.model_copy(update={"reverse": True}).in_running_order()
    mirrored = scenario.model_copy(update={"line": line.model_copy(update={"reverse": True})})
    runs = [solve(one, check=True) for one in (scenario, mirrored)]
    assert runs[1].energy_kwh == pytest.approx(runs[0].energy_kwh, rel=1e-9)


def test_recuperation_by_place_is_that_share_of_what_the_brakes_generate():
    """The sum over cells of r(s) x 0.85 x braking work, from the speeds only; a flat line."""
    changes = place(1700, 1850, recuperation_factor=0.2)
    changes["line.traction_limits"].append({"from_m": 1850, "to_m": 2000, "recuperation_factor": 0.0})
    run = solve(plain_scenario(changes), "fastest", check=True)
    speed, where, length = run.speed_ms, 0.5 * (run.position_m[1:] + run.position_m[:-1]), np.diff(run.position_m)
    mean_square = 0.5 * (speed[1:] ** 2 + speed[:-1] ** 2)
    resisting = MASS_KG * G_MS2 / 1e3 * (2.0 + 5e-4 * 3.6**2 * mean_square)
    work = 0.5 * INERTIA_KG * np.diff(speed**2) + resisting * length
    share = np.where(where > 1850, 0.0, np.where(where > 1700, 0.2, 0.5))
    generated = 0.85 * np.maximum(-work, 0.0)
    assert run.energy.recuperated_j == pytest.approx(float(share @ generated), rel=1e-9)
    assert run.energy.losses_j["brake_resistors"] == pytest.approx(float((1 - share) @ generated), rel=1e-9)
    assert run.energy.traction_j == pytest.approx(float(np.maximum(work, 0.0).sum()) / 0.85, rel=1e-9)
    assert abs(run.energy.imbalance) < 1e-9
    # no more than the drive itself feeds back
    more = solve(plain_scenario(place(0, 2000, recuperation_factor=0.9)), "fastest")
    assert more.energy_kwh == pytest.approx(solve(plain_scenario(), "fastest").energy_kwh, rel=1e-12)


HILLY = {"line.sections": HILLS, "timetable.travel_time_s": 170.0}
MANY: dict[str, Any] = {
    "line.traction_limits": [
        {"from_m": 0, "to_m": 250, "max_effort_kn": 60},
        {"from_m": 200, "to_m": 700, "max_power_kw": 350},
        {"from_m": 900, "to_m": 1300, "recuperation_factor": 0.1, "effort_factor": 0.5},
        {"from_m": 1700, "to_m": 2000, "recuperation_factor": 0.0},
    ],
    "line.limit_margin_m": 60.0,
}


@pytest.mark.parametrize("factor", [0.5, 1.0])
@pytest.mark.parametrize(
    "changes",
    [place(100, 700, max_power_kw=250), MANY, MANY | HILLY, wet(300, 1700) | HILLY],
    ids=["power", "many", "hills", "wet"],
)
def test_the_optimum_is_proven_and_agrees_with_backward_induction(changes, factor):
    scenario = plain_scenario({**changes, "vehicle.drive.recuperation_factor": factor})
    best, found = solve(scenario, check=True), solve(scenario, "bellman", check=True)
    assert best.is_proven
    assert 0 <= best.gap <= scenario.solver.tolerance
    assert best.bound.energy_j < found.energy.net_j * (1 + 1e-9)
    assert found.energy.net_j < best.energy.net_j * (1 + 1e-3)


@pytest.mark.parametrize("drive", [INDUCTION | {"motors": 40}, LOSS_POLYNOMIAL], ids=["induction", "loss_polynomial"])
def test_a_drive_with_idle_losses_keeps_the_limits(drive):
    run = solve(plain_scenario({**MANY, "vehicle.drive": drive, "timetable.travel_time_s": 170.0}), check=True)
    assert run.bound is not None
    assert 0 <= run.gap < 0.3
    assert abs(run.energy.imbalance) < 1e-6


@pytest.mark.parametrize("seed", range(0, 60, 5))
def test_no_random_run_undercuts_its_bound_or_exceeds_its_limits(seed):
    task = any_placed_task(seed)
    if task is None:
        pytest.skip("no run passes this line")
    try:
        run = solve(task.scenario)
    except StrategyRefusedError:
        return
    result = check_run(task.scenario, run)
    assert not result.broken, result.broken
    # what a bound may miss by rounding of a coarse mesh is as elsewhere
    assert not run.is_below_bound


@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        (place(0, 200, max_effort_kn=50), "tractive effort by place"),
        (place(0, 200, effort_factor=0.5), "tractive effort"),
        (place(100, 400, max_power_kw=300), "tractive power by place"),
        (place(100, 400, max_current_a=500), "current by place"),
        (place(1800, 2000, recuperation_factor=0.0), "line power"),
        ({"line.limit_margin_m": 100.0}, "speed limit"),
        (wet(0, 500) | {"line.rail_condition": None}, "adhesion of the driven axles"),
    ],
)
def test_the_check_finds_a_run_that_breaks_a_limit_by_place(changes, rule):
    limit = {"line.speed_limits": [{"from_m": 1000, "to_m": 1100, "limit_kmh": 50}], "vehicle.line_voltage_v": 750.0}
    scenario = plain_scenario({**limit, "vehicle.adhesion": {"driven_mass_share": 0.25}})
    run = solve(scenario, "fastest", check=True)
    changes = {key: value for key, value in changes.items() if key != "vehicle.adhesion"}
    assert rule in [check.name for check in check_run(scenario.replace(**changes), run).broken]
    # and passes the run that keeps it
    solve(scenario.replace(**changes), "fastest", check=True)


def test_the_current_of_the_supply_keeps_its_limit_with_auxiliaries():
    scenario = plain_scenario(CASES["current"][0] | {"vehicle.drive": LOSS_POLYNOMIAL, "solver.mesh_m": 5.0})
    run = solve(scenario, "fastest", check=True)
    middle = 0.5 * (run.position_m[1:] + run.position_m[:-1])
    assert 0.99e3 < run.supply_current_a[(middle > 100) & (middle < 900)].max() <= 1e3 * (1 + 1e-6)


@pytest.mark.parametrize("strategy", ["speed_limits", "bellman", "fastest"])
def test_other_strategies_keep_them(strategy):
    solve(plain_scenario(MANY | {"timetable.travel_time_s": 200.0}), strategy, check=True)


@pytest.mark.parametrize(
    ("strategy", "changes"),
    [("phases", {}), ("eoc", {}), ("enoc", {}), ("speed_limits", {"search.regulator": "literal"})],
)
def test_strategies_that_plan_for_one_train_refuse_them(strategy, changes):
    for limits, words in ((MANY, "traction limits"), (wet(0, 100), "rail conditions")):
        with pytest.raises(StrategyRefusedError, match=f"needs a line without {words}"):
            solve(plain_scenario({**limits, **changes}), strategy)


def test_simulations_keep_them_or_refuse():
    scenario = plain_scenario(MANY | {"timetable.travel_time_s": 170.0, "disturbance.resistance_factor": 1.1})
    run = simulate_following(scenario)
    assert np.max(run.actual.tractive_effort_n - run.actual.max_effort_n) < 1e-3
    event = {"disturbance.stops": [{"position_m": 800.0, "duration_s": 10.0, "noticed_at_m": 400.0}]}
    stopped = actual_run(scenario.replace(**event)).actual
    assert np.max(stopped.tractive_effort_n - stopped.max_effort_n) < 1e-3
    # a wet day is wet on all of the line
    partly = plain_scenario(wet(0, 100) | {"timetable.travel_time_s": 170.0})
    assert (
        actual_run(partly.replace(**{"disturbance.rail_condition": "wet"})).actual.scenario.line.rail_conditions == ()
    )
    with pytest.raises(ScenarioError, match=r"does not simulate line\.traction_limits"):
        simulate_field_oriented(load_scenario("ftorek-300s", place(0, 100, effort_factor=0.5)))
    with pytest.raises(ScenarioError, match=r"line\.traction_limits"):
        require_drivable(build_meshed_line(scenario))


def test_legs_have_the_limits_of_their_places():
    stations = {"line.stations": [{"name": "A", "position_m": 1000.0, "dwell_s": 20.0, "arrival_s": 110.0}]}
    scenario = plain_scenario({**MANY, **stations, "timetable.travel_time_s": 260.0})
    for run in (whole_line(scenario, "given").run, solve(scenario, check=True)):
        assert np.max(run.tractive_effort_n - run.max_effort_n) < 1e-3


def test_a_train_that_starts_where_it_may_not_pull_enough_is_refused_with_the_effort_of_that_place():
    steep = {"line.sections": [{"length_m": 2000.0, "gradient_permille": 20.0}]}
    with pytest.raises(InfeasibleLineError, match=r"its effort of at most 15 kN"):
        prepare_task(plain_scenario({**steep, **place(0, 100, max_effort_kn=15.0)}))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (place(0, 100), r"limits nothing: give max_effort_kn"),
        (place(0, 2100, effort_factor=0.5), r"traction_limits\[0\]\.to_m = 2100 lies beyond the end"),
        (place(0, 100, max_current_a=100), r"max_current_a = 100 needs vehicle\.line_voltage_v"),
        (
            place(0, 100, max_current_a=50) | {"vehicle.line_voltage_v": 750, "vehicle.auxiliary_power_kw": 50},
            r"max_current_a = 50 must be above 66\.667 A, the current of vehicle\.auxiliary_power_kw",
        ),
        (
            {"line.rail_conditions": [{"from_m": 0, "to_m": 10, "condition": "wet"}]},
            r"line\.rail_conditions\[0\]\.condition = 'wet' needs vehicle\.adhesion\.driven_mass_share",
        ),
    ],
)
def test_wrong_input_is_one_sentence(changes, words):
    with pytest.raises(ScenarioError, match=words):
        plain_scenario(changes)
