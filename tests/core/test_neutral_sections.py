"""Sections without traction power, for every strategy, the check and the simulations."""

from dataclasses import replace

import numpy as np
import pytest
from builders import COPPER_LOSS, INDUCTION, LOSS_POLYNOMIAL, plain_scenario

from railjoule.core import load_scenario, solve
from railjoule.core.check import check_run
from railjoule.core.errors import InfeasibleLineError, ScenarioError, StrategyRefusedError
from railjoule.core.physics.mesh_data import tractive_limit_n
from railjoule.core.simulation.actual_run import actual_run
from railjoule.core.simulation.field_oriented import simulate_field_oriented
from railjoule.core.strategies import compare, prepare_task

NEUTRAL = {"line.neutral_sections": [{"from_m": 700.0, "to_m": 850.0}]}
FRICTION = {"vehicle.braking.friction_effort_kn": 60.0}
# of the largest effort: what a solver leaves of none, below what every check of an effort allows
NO_EFFORT = 1e-7


def neutral_cells(run, start_m=700.0, end_m=850.0):
    middle = 0.5 * (run.position_m[1:] + run.position_m[:-1])
    return (middle > start_m) & (middle < end_m)


def require_no_effort(run, **place):
    cells = neutral_cells(run, **place)
    assert cells.sum() > 5
    most = NO_EFFORT * run.max_effort_n.max()
    assert run.tractive_effort_n[cells].max() < most
    assert run.electric_braking_n[cells].max() < most
    np.testing.assert_allclose(run.supply_power_w[cells], run.scenario.vehicle.auxiliary_power_kw * 1e3, atol=1e-9)
    # Newton's second law in the check finds what the speeds need, whatever the run says of its efforts
    assert check_run(run.scenario, run).ok


@pytest.mark.parametrize(
    ("preset", "start_m"), [("metro-with-limit", 800.0), ("ftorek-300s", 400.0), ("liashenko-ii", 20.0)]
)
def test_the_optimum_is_proven_and_agrees_with_backward_induction(preset, start_m):
    scenario = load_scenario(preset)
    without = solve(scenario)
    changed = scenario.replace(**{"line.neutral_sections": [{"from_m": start_m, "to_m": start_m + 150.0}]})
    best, found = solve(changed), solve(changed, "bellman")
    require_no_effort(best, start_m=start_m, end_m=start_m + 150.0)
    # they lie where the train would else drive
    assert without.tractive_effort_n[neutral_cells(without, start_m, start_m + 150.0)].any()
    assert best.energy.net_j > without.energy.net_j * (1 + 1e-4)
    assert best.is_proven
    # not below what is proven, and no worse than elsewhere: of `ftorek-300s` alone it misses 4.4e-4 without them
    assert best.bound.energy_j < found.energy.net_j * (1 + 1e-9)
    assert found.energy.net_j < best.energy.net_j * (1 + 5e-4)


def test_a_drive_that_idles_is_off_in_them():
    scenario = load_scenario("tram-950m-recuperating", {"line.neutral_sections": [{"from_m": 60.0, "to_m": 120.0}]})
    run, without = solve(scenario, "optimal"), solve(load_scenario("tram-950m-recuperating"), "optimal")
    require_no_effort(run, start_m=60.0, end_m=120.0)
    assert run.energy.net_j > without.energy.net_j
    # a thousandth is what is asked of shipped scenarios with such drives
    assert 0 <= run.energy.net_j - run.bound.energy_j < 1e-3 * run.energy.net_j


def test_a_strong_train_with_few_motors_has_no_idle_losses_in_them():
    """A billionth of 200 kN is more than a ten millionth of the 100 N m of one motor, up to which a drive is off."""
    strong = {"vehicle.drive": LOSS_POLYNOMIAL | {"motors": 1}, "vehicle.traction.max_effort_kn": 200.0}
    for strategy in ("fastest", "optimal"):
        run = solve(plain_scenario({**NEUTRAL, **strong, "vehicle.traction.max_power_kw": 2000.0}), strategy)
        require_no_effort(run)
        # idle losses that no supply covers would open the energy balance
        assert abs(run.energy.imbalance) < 1e-9


def test_friction_brakes_work_in_them():
    """A limit in the section that coasting cannot keep: friction brakes for it, and the electric brake before it."""
    limit = [{"from_m": 800.0, "to_m": 1000.0, "limit_kmh": 40.0}]
    run = solve(plain_scenario({**NEUTRAL, **FRICTION, "line.speed_limits": limit}), "fastest", check=True)
    cells = neutral_cells(run)
    assert run.friction_braking_n[cells].max() == pytest.approx(60e3, rel=1e-6)
    without = solve(plain_scenario({**NEUTRAL, "line.speed_limits": limit}), "fastest", check=True)
    assert not without.friction_braking_n[cells].any()
    assert without.travel_time_s > run.travel_time_s


def test_a_line_without_them_is_as_it_was():
    """Each limit is multiplied by exactly 1."""
    task, without = prepare_task(plain_scenario(NEUTRAL)), prepare_task(plain_scenario())
    assert without.mesh.data.supply_share.tolist() == [1.0] * without.mesh.cell_count
    # 150 m in cells of 10 m
    assert (task.mesh.data.supply_share < 1).sum() == 15
    speed = np.linspace(0.1, 25.0, without.mesh.cell_count)
    limit = without.mesh.data.traction.effort_n(speed)
    assert tractive_limit_n(without.mesh.data, speed).tolist() == limit.tolist()
    assert tractive_limit_n(task.mesh.data, speed)[task.mesh.data.supply_share < 1].max() < NO_EFFORT * limit.max()


def test_the_check_sees_a_drive_that_works_in_one():
    run = solve(plain_scenario(NEUTRAL))
    result = check_run(run.scenario.replace(**{"line.neutral_sections": [{"from_m": 100.0, "to_m": 150.0}]}), run)
    assert [check.name for check in result.broken] == ["neutral sections"]
    assert 100 < result.broken[0].at_m < 150
    # and the electric brake: the last 100 m before the stop
    result = check_run(run.scenario.replace(**{"line.neutral_sections": [{"from_m": 1900.0, "to_m": 2000.0}]}), run)
    assert "neutral sections" in {check.name for check in result.broken}
    # all of the braking by friction brakes that the scenario has not
    friction = replace(
        run, electric_braking_n=np.zeros(len(run.electric_braking_n)), friction_braking_n=run.electric_braking_n
    )
    assert "friction braking effort" in {check.name for check in check_run(run.scenario, friction).broken}


@pytest.mark.parametrize("strategy", ["eoc", "enoc", "phases", "speed_limits"])
def test_who_cannot_honour_them_says_so(strategy):
    with pytest.raises(StrategyRefusedError, match=r"needs a line without neutral sections"):
        solve(plain_scenario({**NEUTRAL, "vehicle.drive": COPPER_LOSS}), strategy)


def test_a_comparison_goes_on_with_the_others():
    found = compare(plain_scenario({**NEUTRAL, "vehicle.drive": COPPER_LOSS}))
    runs, refused = found.runs, found.refused
    assert {run.strategy for run in runs} == {"optimal", "bellman", "linear_reserve", "fastest"}
    assert set(refused) == {"eoc", "enoc", "phases", "speed_limits"}


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        (
            {"line.neutral_sections": [{"from_m": 0.0, "to_m": 50.0}]},
            "At 0 m, on a gradient of 0 per mille in the neutral section from 0 to 50 m (line.neutral_sections), the "
            "train stands and cannot start: it has no traction power there.",
        ),
        (
            {
                "line.neutral_sections": [{"from_m": 900.0, "to_m": 1100.0}],
                "line.stations": [{"position_m": 1000.0}],
                "timetable.travel_time_s": 200.0,
            },
            "At 1000 m, on a gradient of 0 per mille in the neutral section from 900 to 1100 m "
            "(line.neutral_sections), the train stands and cannot start: it has no traction power there.",
        ),
        (
            {
                "line.sections": [{"length_m": 100.0}, {"length_m": 1900.0, "gradient_permille": 30.0}],
                "line.neutral_sections": [{"from_m": 100.0, "to_m": 400.0}, {"from_m": 350.0, "to_m": 500.0}],
            },
            "in the neutral section from 100 to 500 m (line.neutral_sections), the train comes to a stand: it has no "
            "traction power there, and its momentum is not enough.",
        ),
        (
            {
                "line.sections": [{"length_m": 1700.0}, {"length_m": 300.0, "gradient_permille": -30.0}],
                "line.neutral_sections": [{"from_m": 1700.0, "to_m": 2000.0}],
            },
            "in the neutral section from 1700 to 2000 m (line.neutral_sections), friction brakes of at most 0 kN "
            "cannot slow the train down for what lies ahead.",
        ),
    ],
)
def test_a_train_that_cannot_get_through_is_told_why(changes, sentence):
    with pytest.raises(InfeasibleLineError) as refusal:
        solve(plain_scenario(changes))
    assert str(refusal.value).endswith(sentence)


def test_a_stop_in_one_is_left_downhill():
    changes = {
        "line.sections": [{"length_m": 950.0}, {"length_m": 1050.0, "gradient_permille": -8.0}],
        "line.neutral_sections": [{"from_m": 980.0, "to_m": 1080.0}],
        "line.stations": [{"position_m": 1000.0}],
        "timetable.travel_time_s": 260.0,
        **FRICTION,
    }
    for strategy in ("optimal", "bellman"):
        require_no_effort(solve(plain_scenario(changes), strategy), start_m=980.0, end_m=1080.0)


def test_the_actual_train_coasts_through_them_too():
    run = actual_run(plain_scenario({**NEUTRAL, "disturbance.actual_load_factor": 0.9}))
    require_no_effort(run.planned)
    cells = neutral_cells(run.actual)
    assert run.actual.tractive_effort_n[cells].max() < NO_EFFORT * run.actual.max_effort_n.max()
    assert run.actual.electric_braking_n[cells].max() < NO_EFFORT * run.actual.max_effort_n.max()


def test_the_closed_loop_refuses_them():
    scenario = plain_scenario({**NEUTRAL, "vehicle.drive": INDUCTION, "simulation.kind": "field_oriented"})
    with pytest.raises(ScenarioError, match=r"does not simulate line\.neutral_sections"):
        simulate_field_oriented(scenario)


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ([{"from_m": 700.0, "to_m": 700.0}], "to_m = 700 is not beyond from_m = 700"),
        ([{"from_m": 100.0, "to_m": 2000.5}], r"neutral_sections\[0\].to_m = 2000.5 lies beyond the end of the line"),
        ([{"from_m": -1.0, "to_m": 20.0}], "from_m = -1 must be at least 0"),
    ],
)
def test_what_cannot_be_is_told(sections, words):
    with pytest.raises(ScenarioError, match=words):
        plain_scenario({"line.neutral_sections": sections})


@pytest.mark.parametrize("strategy", ["optimal", "bellman"])
def test_short_ones_close_together_are_kept_each(strategy):
    sections = [{"from_m": 300.0, "to_m": 307.3}, {"from_m": 320.0, "to_m": 333.3}, {"from_m": 1500.0, "to_m": 1503.0}]
    run = solve(plain_scenario({"line.neutral_sections": sections}), strategy, check=True)
    for section in sections:
        cells = neutral_cells(run, section["from_m"], section["to_m"])
        assert cells.any()
        assert run.tractive_effort_n[cells].max() < NO_EFFORT * run.max_effort_n.max()
