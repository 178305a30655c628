"""The adhesion between wheels and rails, as the file format states it.

With `line.rail_condition`, the driven axles transmit at most mu(v) times their weight, in driving and in electric
braking, and all brakes together at most mu(v) times the weight of the braked axles. On dry rails (Curtius, Kniffler,
1944), with v in km/h, mu(v) = 7.5 / (v + 44) + 0.161; on wet rails it is `wet_share` of that.
"""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.scenario import Scenario
from railjoule.core.units import STANDARD_GRAVITY_MS2

KMH_PER_MS = 3.6


def adhesion_limits_n(scenario: Scenario, speed_ms: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the largest forces of the driven and of the braked axles [N] at speeds [m/s]; infinite without a limit."""
    vehicle, condition = scenario.vehicle, scenario.line.rail_condition
    if condition is None:
        unlimited = np.full(len(speed_ms), np.inf)
        return unlimited, unlimited
    adhesion = vehicle.adhesion
    assert adhesion.driven_mass_share is not None
    mass_kg = vehicle.tare_kg + vehicle.load_factor * vehicle.capacity_passengers * vehicle.passenger_mass_kg
    wet = adhesion.wet_share if condition == "wet" else 1.0
    force_n = wet * (7.5 / (KMH_PER_MS * speed_ms + 44) + 0.161) * mass_kg * STANDARD_GRAVITY_MS2
    return adhesion.driven_mass_share * force_n, adhesion.braked_mass_share * force_n
