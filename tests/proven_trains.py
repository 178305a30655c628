"""Trains and lines whose proofs by chains are checked: each drive, each kind of limit."""

from itertools import product

import numpy as np

from railjoule.core.chain_proof.prices import node_prices
from railjoule.core.chain_proof.proof import ChainProof
from railjoule.core.interior_point.start import SLOWEST_SPEED2
from railjoule.core.physics.energy_balance import reference_energy
from tests.every_drive import train

IDLING = ("loss polynomial", "efficiency map", "induction", "induction with a standstill brake", "synchronous")
SMOOTH = ("constant efficiency", "copper loss")
FRICTION_KN, FACTORS = (0.0, 15.0), (0.37, 1.0)
LIMITED = {
    "vehicle.traction.max_acceleration_ms2": 0.7,
    "vehicle.braking.max_deceleration_ms2": 0.6,
    "vehicle.resistance.linear_n_per_kn_per_kmh": 0.02,
    "vehicle.traction.curve": [[0.0, 90.0], [20.0, 80.0], [70.0, 25.0], [100.0, 12.0]],
    "line.stations": [{"position_m": 500.0, "dwell_s": 20.0}],
    "vehicle.auxiliary_power_kw": 20.0,
}
CASES = [(*case, {}) for case in product(IDLING, FRICTION_KN, FACTORS)] + [
    (drive, 15.0, 0.5, LIMITED) for drive in (*IDLING, *SMOOTH)
]


def scenario_of(case):
    drive, friction_kn, factor, changes = case
    return train(drive, friction_kn, factor, **changes)


def name_of(case):
    return f"{case[0]}, {case[1]:g} kN, {case[2]:g}" + (", limited" if case[3] else "")


def proof_of(task, optimum, best_j, tolerance, around2=None):
    """Return a proof that aims below a run's energy [J] by a share; above it where that is negative."""
    data = task.mesh.data
    target = best_j - tolerance * reference_energy(data, best_j, task.running_time_s)
    slowest2 = np.minimum(SLOWEST_SPEED2, optimum.speed2)
    around2 = optimum.speed2 if around2 is None else around2
    given = data, task.running_time_s, task.fastest_speed2, slowest2, around2
    return ChainProof(*given, node_prices(data, optimum), optimum.price_of_time_w, target)
