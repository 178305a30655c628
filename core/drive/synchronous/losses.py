"""Losses of machine and inverter at a torque and a speed, by kind.

Copper 3/2 R I^2 with the resistance at the fundamental; iron (hysteresis w / w_r + eddy (w / w_r)^2) (psi / psi_r)^2;
mechanical T_m w + k w^3. Inverter: a phase always flows through one device of a threshold and a resistance, 3 (V0 2 I /
pi + r I^2 / 2), and each switching costs the energy of the data sheet in proportion to current and link voltage. In
six-step operation it switches once a period.
"""

import math
from typing import NamedTuple

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.synchronous.harmonics import Winding, resistance_at, six_step_loss, space_vector_loss
from railjoule.core.drive.synchronous.machine import Machine, currents, max_torque, phase_voltages

COPPER, IRON, MECHANICAL, HARMONICS, CONDUCTION, SWITCHING = range(6)
KINDS = 6
# the first ones belong to the motor, the rest to its inverter
MOTOR_KINDS = HARMONICS + 1


class LossNumbers(NamedTuple):
    """Parameters of the losses of one machine and its inverter.

    Parameters
    ----------
    rated_rads, rated_flux_vs : float
        Electrical angular frequency [rad/s] and flux linkage [V s] at which iron losses are given.
    hysteresis_loss_w, eddy_loss_w : float
        Iron losses there [W].
    mechanical_loss_torque_nm, ventilation_loss_w_per_rads3 : float
        Torque of friction [N m], and power of ventilation over the cube of the shaft's speed [W s3/rad3].
    link_voltage_v, switching_frequency_hz : float
        Of the inverter [V, Hz].
    device_threshold_v, device_resistance_ohm : float
        Of one device that conducts [V, ohm].
    switching_energy_j_per_av : float
        Lost in one period of switching over current and link voltage [J/(A V)].
    """

    rated_rads: float
    rated_flux_vs: float
    hysteresis_loss_w: float
    eddy_loss_w: float
    mechanical_loss_torque_nm: float
    ventilation_loss_w_per_rads3: float
    link_voltage_v: float
    switching_frequency_hz: float
    device_threshold_v: float
    device_resistance_ohm: float
    switching_energy_j_per_av: float


@njit(cache=True)
def shaft_drag_nm(numbers: LossNumbers, rads: float) -> float:
    """Return the torque of friction and ventilation [N m] at a speed of the shaft [rad/s]."""
    return numbers.mechanical_loss_torque_nm + numbers.ventilation_loss_w_per_rads3 * rads * rads


@njit(cache=True, error_model="numpy")
def fill_losses(
    machine: Machine,
    numbers: LossNumbers,
    winding: Winding,
    bands: FloatArray,
    torque: float,
    rads: float,
    losses: FloatArray,
) -> bool:
    """Fill the losses by kind [W] at a shaft's torque, negative in braking, and speed; return whether they can be had.

    Parameters
    ----------
    machine, numbers, winding : Machine, LossNumbers and Winding
        Of one motor and its inverter.
    bands : array
        As `side_bands` returns.
    torque, rads : float
        Of the shaft [N m, rad/s].
    losses : array of shape (6,)
        By kind [W].
    """
    stator = machine.pole_pairs * rads
    drag = shaft_drag_nm(numbers, rads)
    # friction takes its torque whichever way the shaft's acts
    electromagnetic = torque + drag
    along, across, feasible = currents(machine, electromagnetic, stator)
    current = math.hypot(along, across)
    direct_flux = machine.magnet_flux_vs + machine.direct_inductance_h * along
    flux = math.hypot(direct_flux, machine.quadrature_inductance_h * across)
    voltage = math.hypot(*phase_voltages(machine, along, across, stator))
    speed_share, flux_share = stator / numbers.rated_rads, flux / numbers.rated_flux_vs
    losses[COPPER] = 1.5 * resistance_at(winding, stator) * current * current
    iron = (numbers.hysteresis_loss_w + numbers.eddy_loss_w * speed_share) * speed_share
    losses[IRON] = iron * flux_share * flux_share
    losses[MECHANICAL] = drag * rads
    # a phase's current is a sine: its mean size meets the threshold, its mean square the resistance
    mean_current = 2.0 / math.pi * current
    by_devices = numbers.device_threshold_v * mean_current + 0.5 * numbers.device_resistance_ohm * current * current
    losses[CONDUCTION] = 3.0 * by_devices
    frequency = numbers.switching_frequency_hz
    # what space vectors cannot give, whole blocks can
    if voltage > numbers.link_voltage_v / math.sqrt(3.0):
        frequency = stator / (2.0 * math.pi)
        losses[HARMONICS] = six_step_loss(winding, stator, voltage)
    else:
        carrier = 2.0 * math.pi * frequency
        losses[HARMONICS] = space_vector_loss(winding, bands, numbers.link_voltage_v, carrier, stator, voltage)
    energy = numbers.switching_energy_j_per_av * mean_current * numbers.link_voltage_v
    losses[SWITCHING] = 3.0 * frequency * energy
    return feasible


@njit(cache=True, nogil=True, error_model="numpy")
def fill_points(
    machine: Machine,
    numbers: LossNumbers,
    winding: Winding,
    bands: FloatArray,
    torque: FloatArray,
    speed: FloatArray,
    losses: FloatArray,
    feasible: BoolArray,
) -> None:
    """Fill `losses` [W] of shape (n, 6) at torques of the shaft [N m] and speeds [rad/s], and which are `feasible`."""
    for i in range(torque.shape[0]):
        feasible[i] = fill_losses(machine, numbers, winding, bands, torque[i], speed[i], losses[i])


@njit(cache=True, nogil=True)
def fill_envelope(
    machine: Machine, numbers: LossNumbers, sign: float, max_nm: float, speed: FloatArray, torque: FloatArray
) -> None:
    """Fill the greatest torques of the shaft [N m], without sign, at speeds [rad/s]; `sign` is -1 in braking."""
    for j in range(speed.shape[0]):
        drag = shaft_drag_nm(numbers, speed[j])
        # friction takes from the torque that drives, and adds to the one that brakes
        most = max_torque(machine, sign, machine.pole_pairs * speed[j], max_nm)
        torque[j] = max(most - sign * drag, 0.0)
