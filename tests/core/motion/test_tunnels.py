"""Tunnels raise the quadratic resistance of the cells under them, for every strategy alike."""

import numpy as np
import pytest
from builders import COPPER_LOSS, plain_scenario

from railjoule.core import StrategyRefusedError, load_scenario, solve
from railjoule.core.bounds import minimise
from railjoule.core.motion import build_meshed_line
from railjoule.core.motion.line_geometry import TrainExtent, car_crossings
from railjoule.core.scenario import Line
from railjoule.core.strategies import prepare_task

TUNNEL = [{"length_m": 800.0}, {"length_m": 400.0, "tunnel_factor": 3.0}, {"length_m": 800.0}]


def test_only_the_cells_in_the_tunnel():
    mesh = build_meshed_line(plain_scenario({"line.sections": TUNNEL}))
    middle = 0.5 * (mesh.position_m[1:] + mesh.position_m[:-1])
    inside = (middle > 800) & (middle < 1200)
    open_line = build_meshed_line(plain_scenario()).data.resistance_quadratic[0]
    assert mesh.data.resistance_quadratic[inside] == pytest.approx(3 * open_line)
    assert mesh.data.resistance_quadratic[~inside] == pytest.approx(open_line)


def test_a_long_train_is_in_it_bit_by_bit():
    """The mean over 100 m of train: half of it is inside when its front is 50 m in."""
    mesh = build_meshed_line(plain_scenario({"line.sections": TUNNEL, "vehicle.length_m": 100.0}))
    middle = 0.5 * (mesh.position_m[1:] + mesh.position_m[:-1])
    assert np.interp(850, middle, mesh.tunnel_factor) == pytest.approx(2.0)


@pytest.mark.parametrize("drive", [plain_scenario().vehicle.drive.model_dump(exclude_none=True), COPPER_LOSS])
def test_optimum_and_bellman_agree_and_the_proof_holds(drive):
    scenario = plain_scenario({"line.sections": TUNNEL, "vehicle.drive": drive})
    optimum, other = solve(scenario, "optimal"), solve(scenario, "bellman")
    assert optimum.is_proven
    # over one mesh, as an account over 10 m may lie below what is proven, by 3e-4 here
    min_j = minimise(prepare_task(scenario)).energy_j
    assert min_j * (1 - 1e-6) <= other.energy.net_j <= min_j * 1.002
    assert optimum.energy_kwh > solve(plain_scenario({"vehicle.drive": drive}), "optimal").energy_kwh * 1.001


def test_work_of_resistance_by_hand():
    """Steady 54 km/h under a limit; q v^2 over 2000 m of open line and twice more over 400 m of tunnel."""
    changes = {"line.sections": TUNNEL, "search.limits_kmh": [54.0], "search.boundaries_m": []}
    held = solve(plain_scenario({**changes, "search.limits_kmh": [54.0] * 3}), "speed_limits")
    free = solve(plain_scenario({"search.limits_kmh": [54.0]}), "speed_limits")
    quadratic = build_meshed_line(plain_scenario()).data.resistance_quadratic[0]
    more = held.energy.running_resistance_j - free.energy.running_resistance_j
    assert more == pytest.approx(2 * quadratic * 15**2 * 400, rel=1e-9)


@pytest.mark.parametrize("strategy", ["eoc", "enoc"])
def test_who_cannot_tunnels_says_so(strategy):
    scenario = plain_scenario({"line.sections": TUNNEL, "vehicle.drive": COPPER_LOSS})
    with pytest.raises(StrategyRefusedError, match="needs a line without tunnels"):
        solve(scenario, strategy)


def test_nodes_where_a_cars_centre_changes_its_section():
    line = Line.model_validate({"sections": [{"length_m": 500.0}, {"length_m": 500.0, "gradient_permille": 10.0}]})
    assert car_crossings(line, TrainExtent(100.0, 4).felt_behind_m) == pytest.approx([512.5, 537.5, 562.5, 587.5])
    mesh = build_meshed_line(
        plain_scenario(
            {"line.sections": line.model_dump()["sections"], "vehicle.length_m": 100.0, "vehicle.car_count": 4}
        )
    )
    assert np.isin([512.5, 537.5, 562.5, 587.5], mesh.position_m).all()
    # a quarter of the weight after another
    assert set(np.round(mesh.gradient_permille, 9)) == {0.0, 2.5, 5.0, 7.5, 10.0}


def test_the_metro_lies_in_a_tunnel():
    assert build_meshed_line(load_scenario("kharkiv-like-20kmh")).tunnel_factor == pytest.approx(1.5)


def test_cars_on_a_line_of_one_section():
    """No place where a car's centre would meet another gradient."""
    scenario = load_scenario("kharkiv-like-40kmh").replace(**{"line.sections": [{"length_m": 2400.0}]})
    assert build_meshed_line(scenario).cell_count >= 240


def test_a_place_that_several_cars_share_is_one_node():
    """Sections as long as a car, 14.65 m: the second car enters one where the first enters the next, but for rounding.

    A cell of 1e-12 m is what is left of both, over which the interior point found no optimum.
    """
    sections = [{"length_m": 100.1 if k == 0 else 14.65, "gradient_permille": float(k)} for k in range(12)]
    places = car_crossings(Line.model_validate({"sections": sections}), TrainExtent(58.6, 4).felt_behind_m)
    assert np.diff(places).min() > 1.0
