import pytest
from builders import ACCOUNT_CASES

from railjoule.core import solve
from railjoule.core.energy_along import energy_flow
from railjoule.core.scenario import Scenario


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
