"""The flux of a machine: the rated one as long as the voltage carries it, or that of least loss.

Both are given by the current Ix that makes them in steady state. Without torque only the voltage bounds it.
"""

import math

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.induction.machine import Machine, torque_constant
from railjoule.core.drive.induction.min_loss import best_ratio
from railjoule.core.drive.induction.voltage import pull_out_ratio, ratio_within_voltage, value, voltage_quartic

# a torque below this share of that at Ix = Iy = Imu counts as none: kappa = 0 would leave the ratio, and the flux, open
MIN_STRENGTH_SHARE = 1e-6


@njit(cache=True)
def flux_current(machine: Machine, min_loss: bool, torque_nm: float, rotor_rads: float) -> float:
    """Return the Ix that a torque gets [A].

    Parameters
    ----------
    machine : Machine
    min_loss : bool
        Whether it is the one with which the torque loses least; else the largest one up to the rated one with which the
        voltage carries the torque, or that of the pull-out torque if none does.
    torque_nm : float
        Electromagnetic torque, negative where it generates [N m].
    rotor_rads : float
        Electrical angular frequency of the rotor [rad/s].
    """
    sign = 1.0 if torque_nm >= 0.0 else -1.0
    rated2 = machine.magnetising_current_a * machine.magnetising_current_a
    strength = max(sign * torque_nm / torque_constant(machine), MIN_STRENGTH_SHARE * rated2)
    if min_loss:
        best, _ = best_ratio(machine, sign, strength, rotor_rads)
        return min(math.sqrt(strength / best), machine.magnetising_current_a)
    quartic = voltage_quartic(machine, sign, rotor_rads)
    # at rated flux q = kappa / Imu^2, which the voltage carries where kappa D <= U_m^2 q, as `voltage` derives
    ratio, voltage2 = strength / rated2, machine.max_phase_voltage_v * machine.max_phase_voltage_v
    if strength * value(quartic, ratio) <= voltage2 * ratio:
        return machine.magnetising_current_a
    bound = ratio_within_voltage(quartic, strength, voltage2, ratio)
    if bound < 0.0:
        # U_m^2 = Ix^2 D(q)
        pull_out = pull_out_ratio(quartic)
        return min(machine.max_phase_voltage_v / math.sqrt(value(quartic, pull_out)), machine.magnetising_current_a)
    return math.sqrt(strength / bound)


@njit(cache=True, nogil=True)
def fill_flux_currents(
    machine: Machine, min_loss: bool, torque_nm: FloatArray, rotor_rads: FloatArray, flux_current_a: FloatArray
) -> None:
    """Fill the currents Ix [A] of `flux_current` for torques [N m] at frequencies [rad/s]; all of shape (n,)."""
    for i in range(torque_nm.shape[0]):
        flux_current_a[i] = flux_current(machine, min_loss, torque_nm[i], rotor_rads[i])
