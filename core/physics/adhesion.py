"""Wheel-rail adhesion: the largest force that the wheels transmit to the rails, over speed and rail condition.

Source: Curtius, Kniffler: Neue Erkenntnisse über die Haftung zwischen Treibrad und Schiene, Elektrische Bahnen, 1944,
measured on dry rails; v in km/h:

    mu(v) = 7.5 / (v + 44) + 0.161

On wet rails it is multiplied by `vehicle.adhesion.wet_share`. Its default is 0.6: Koffman, Adhesion and Friction in
Rail Traction, Institution of Locomotive Engineers, paper 479, 1948.
"""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.physics.effort_limit import SLOWEST_MS, EffortLimit
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.line import RailCondition
from railjoule.core.units import MS_PER_KMH, N_PER_KN, STANDARD_GRAVITY_MS2

COMPARED_STEP_MS = 0.01
"""Widest step of speed between two comparisons of the electric brake with the adhesion."""


class AdhesiveWeight(NamedTuple):
    """Weights on the axles that transmit forces, times the share that the rail condition leaves of dry adhesion.

    Parameters
    ----------
    driven_n, braked_n : float
        Of the driven and of the braked axles [N]; infinite where adhesion sets no limit.
    """

    driven_n: float = np.inf
    braked_n: float = np.inf


def adhesive_weight(scenario: Scenario, condition: RailCondition | None) -> AdhesiveWeight:
    """Return the adhesive weights of a scenario's train with its load on rails of a condition."""
    adhesion = scenario.vehicle.adhesion
    if condition is None or adhesion.driven_mass_share is None:
        return AdhesiveWeight()
    weight_n = scenario.vehicle.total_mass_kg * STANDARD_GRAVITY_MS2
    if condition == "wet":
        weight_n *= adhesion.wet_share
    return AdhesiveWeight(adhesion.driven_mass_share * weight_n, adhesion.braked_mass_share * weight_n)


def adhesion_coefficient(speed_ms: FloatArray | float) -> FloatArray:
    """Return the adhesion coefficient of dry rails at speeds [m/s]; shape as the speeds'."""
    coefficient: FloatArray = 7.5 / (np.asarray(speed_ms, dtype=float) / MS_PER_KMH + 44.0) + 0.161
    return coefficient


def friction_limit_n(scenario: Scenario, electric: EffortLimit, condition: RailCondition | None) -> float:
    """Return the largest effort of the friction brakes [N] beside the full electric brake, the same at all speeds.

    The electric brake comes first. The friction brakes have their own limit, or where that is less, the least that the
    adhesion of the braked axles leaves beside the electric brake at any speed up to the vehicle's largest one.

    Parameters
    ----------
    scenario : Scenario
    electric : EffortLimit
        Of the electric brake, within the adhesion of the driven axles.
    condition : str or None
        Condition of the rails.
    """
    own_n = scenario.vehicle.braking.friction_effort_kn * N_PER_KN
    braked_n = adhesive_weight(scenario, condition).braked_n
    if own_n == 0 or np.isinf(braked_n):
        return own_n
    top_ms = scenario.vehicle.traction.max_speed_kmh * MS_PER_KMH
    steps = np.linspace(SLOWEST_MS, top_ms, int(np.ceil(top_ms / COMPARED_STEP_MS)) + 1)
    inside = electric.table[:, 0][(electric.table[:, 0] > SLOWEST_MS) & (electric.table[:, 0] < top_ms)]
    speed = np.union1d(steps, inside)
    effort = electric.effort_n(speed)
    # between two speeds the adhesion is at least that at the faster one, and the brake at most that at one of its ends
    left = braked_n * adhesion_coefficient(speed[1:]) - np.maximum(effort[:-1], effort[1:])
    return float(np.clip(left.min(), 0.0, own_n))
