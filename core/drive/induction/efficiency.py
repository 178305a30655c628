"""Output over input power of one machine over torque and speed."""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.induction.flux import flux_current_of_least_loss, flux_current_within_voltage
from railjoule.core.drive.induction.machine import Machine, phase_voltage_v, steady_state, torque_constant

# a torque on the limit itself, which a search finds to 5e-10, counts as carried
ALLOWED_EXCESS = 1e-6


@njit(cache=True, nogil=True)
def fill_efficiency(
    machine: Machine,
    least_loss: bool,
    driving_current_a: float,
    braking_current_a: float,
    torque_nm: FloatArray,
    speed_rads: FloatArray,
    efficiency: FloatArray,
) -> None:
    """Fill efficiencies of shape (n, m) over n torques of the shaft [N m] and m speeds [rad/s].

    NaN where current or voltage do not carry a torque, 0 where nothing comes out.

    Parameters
    ----------
    machine : Machine
        Its numbers.
    least_loss : bool
        Whether the flux is that of least loss; else the rated one as long as the voltage carries it.
    driving_current_a, braking_current_a : float
        Largest currents [A].
    torque_nm, speed_rads, efficiency : array
        Torques, negative where it brakes, speeds, and what is filled.
    """
    for j in range(speed_rads.shape[0]):
        rotor_rads = machine.pole_pairs * speed_rads[j]
        for i in range(torque_nm.shape[0]):
            # friction takes its torque whichever way the shaft's acts
            torque = torque_nm[i] + machine.mechanical_loss_torque_nm
            if least_loss:
                flux_current = flux_current_of_least_loss(machine, torque, rotor_rads)
            else:
                flux_current = flux_current_within_voltage(machine, torque, rotor_rads)
            torque_current = torque / (torque_constant(machine) * flux_current)
            state = steady_state(machine, flux_current, torque_current, rotor_rads)
            current = math.hypot(flux_current, torque_current)
            largest = driving_current_a if torque >= 0.0 else braking_current_a
            shaft = torque_nm[i] * speed_rads[j]
            if current > largest * (1.0 + ALLOWED_EXCESS) or phase_voltage_v(state) > machine.max_phase_voltage_v * (
                1.0 + ALLOWED_EXCESS
            ):
                efficiency[i, j] = np.nan
            elif shaft > 0.0:
                efficiency[i, j] = shaft / state.input_power_w
            elif shaft < 0.0 and state.input_power_w < 0.0:
                efficiency[i, j] = state.input_power_w / shaft
            else:
                efficiency[i, j] = 0.0
