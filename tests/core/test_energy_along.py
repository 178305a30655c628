import numpy as np
import pytest
from builders import ACCOUNT_CASES

from railjoule.core import solve
from railjoule.core.energy_along import energy_along, energy_flow, stretches
from railjoule.core.scenario import Scenario


@pytest.mark.parametrize("scenario", ACCOUNT_CASES.values(), ids=ACCOUNT_CASES.keys())
def test_the_energy_along_a_run_ends_at_its_account(scenario: Scenario) -> None:
    run = solve(scenario, "fastest")
    along, energy = energy_along(run), run.energy
    moved = energy.traction_j
    # the account has resistance and losses from their formulas, `energy_along` from what closes the balance
    ends = {
        "resistance_j": energy.running_resistance_j + energy.curve_resistance_j,
        "losses_j": sum(energy.losses_j.values()),
        "drawn_j": energy.traction_j,
        "returned_j": energy.recuperated_j,
        "height_j": energy.potential_j,
    }
    for name, joules in ends.items():
        assert getattr(along, name)[-1] == pytest.approx(joules, abs=1e-9 * moved), name
    assert along.motion_j[-1] - along.motion_j[0] == pytest.approx(energy.kinetic_j, abs=1e-9 * moved)


@pytest.mark.parametrize("scenario", ACCOUNT_CASES.values(), ids=ACCOUNT_CASES.keys())
def test_resistance_and_losses_never_come_back(scenario: Scenario) -> None:
    along = energy_along(solve(scenario, "fastest"))
    for name in ("resistance_j", "losses_j", "returned_j", "drawn_j"):
        assert np.diff(getattr(along, name)).min() >= -1e-9 * along.drawn_j[-1], name


def test_stretches_sum_to_the_account() -> None:
    run = solve(ACCOUNT_CASES["copper loss over hills"])
    parts, energy = stretches(run), run.energy
    assert [part.phase for part in parts] == list(run.phases)
    assert sum(part.drawn_j for part in parts) == pytest.approx(energy.traction_j, rel=1e-9)
    assert sum(part.losses_j for part in parts) == pytest.approx(sum(energy.losses_j.values()), rel=1e-9)


def test_coasting_draws_nothing_and_pays_the_resistance_with_motion_and_height() -> None:
    run = solve(ACCOUNT_CASES["copper loss over hills"])
    coasts = [part for part in stretches(run) if part.phase.phase == "coast"]
    assert coasts
    for part in coasts:
        # energy is conserved where no effort acts; up to what power or brakes do in a cell that ends or begins it
        assert part.resistance_j == pytest.approx(-part.motion_j - part.height_j, rel=2e-2)
        assert part.drawn_j == pytest.approx(0.0, abs=1e-2 * run.energy.traction_j)


@pytest.mark.parametrize("scenario", ACCOUNT_CASES.values(), ids=ACCOUNT_CASES.keys())
def test_what_passes_the_wheels_closes_the_account(scenario: Scenario) -> None:
    # an identity: line energy less wheel work is what the drive loses, both ways
    flow = energy_flow(solve(scenario, "fastest"))
    assert flow.imbalance == pytest.approx(0.0, abs=1e-9)
    energy = flow.energy
    arriving = flow.wheel_traction_j + max(-energy.potential_j, 0.0) + max(-energy.kinetic_j, 0.0)
    leaving = energy.running_resistance_j + energy.curve_resistance_j + flow.wheel_braking_j + flow.friction_brakes_j
    leaving += max(energy.potential_j, 0.0) + max(energy.kinetic_j, 0.0)
    assert leaving == pytest.approx(arriving, rel=1e-9)


def test_a_drive_of_constant_efficiency_loses_its_share_of_the_line_power() -> None:
    flow = energy_flow(solve(ACCOUNT_CASES["constant efficiency"], "fastest"))
    assert flow.driving_loss_j == pytest.approx(0.15 * flow.energy.traction_j, rel=1e-9)
    assert flow.braking_loss_j == pytest.approx(0.15 * flow.wheel_braking_j, rel=1e-9)
