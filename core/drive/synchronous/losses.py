"""Losses of machine and inverter at a torque and a speed, by kind.

Copper 3/2 R I^2 with the resistance at the fundamental; iron (hysteresis w / w_r + eddy (w / w_r)^2) (psi / psi_r)^2;
mechanical T_m w + k w^3. Inverter: a phase always flows through one device of a threshold and a resistance, 3 (V0 2 I /
pi + r I^2 / 2), and each switching costs the energy of the data sheet in proportion to current and link voltage. In
six-step operation it switches once a period.

Harmonics of the inverter in the windings: spectrum of the voltage, resistance over frequency.

Space-vector modulation: a leg whose reference is u switches as a pulse of width pi (1 + u) of its carrier, so the n-th
harmonic of the carrier has the amplitude 4 sin(n pi (1 + u) / 2) / (n pi) of half the link voltage. Its Fourier series
over the angle of the fundamental gives the side bands; those whose order is a multiple of three are the same in all
phases and drive no current. Source: Holmes, Lipo: Pulse width modulation for power converters, 2003, chapters 3 and 6.

Resistance: Dowell: Effects of eddy currents in transformer windings, Proceedings of the IEE 113, 1966, for layers of
conductors of a height on one another in a slot.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.synchronous.machine import Machine, currents, max_torque, phase_voltages
from railjoule.core.units import VACUUM_PERMEABILITY_H_PER_M

# Truncation of the series, by the shipped motor: eight multiples of the carrier would add 3 to 16 % to the harmonic
# loss, most at the lowest voltage; twice the side bands 0.06 %, four times the angles or depths 0.1 %.
CARRIER_ORDERS, SIDE_BANDS = 4, 16
ANGLES = 96
DEPTHS = 49
# orders 5 to 49: those above would add 0.4 to 0.7 %
SIX_STEP_ORDERS = 8
COPPER_RESISTIVITY_OHM_M = 2.2e-8
"""At about 100 degrees Celsius."""
# Height of a conductor over the skin depth. Below the first Dowell's factor is 1 within 1e-7, and would soon divide
# rounding by rounding; the second, where it is held, no harmonic of a motor reaches: sinh overflows at 355.
THIN, THICK = 1e-2, 50.0
# amplitudes over half the link voltage that count as none
NEGLIGIBLE_AMPLITUDE = 1e-6
MAX_DEPTH = 2.0 / math.sqrt(3.0)
"""Of modulation by space vectors: amplitude of the fundamental over half the link voltage."""


class Winding(NamedTuple):
    """Resistance and inductance of a stator phase for harmonics.

    Parameters
    ----------
    stator_resistance_ohm : float
        For direct current [ohm].
    harmonic_inductance_h : float
        Inductance that limits a harmonic current [H].
    conductor_height_m : float
        Of one conductor in the slot [m].
    conductor_layers : float
        Conductors on one another in a slot.
    """

    stator_resistance_ohm: float
    harmonic_inductance_h: float
    conductor_height_m: float
    conductor_layers: float


@njit(cache=True)
def resistance_at(winding: Winding, rads: float) -> float:
    """Return the resistance of a phase [ohm] at an angular frequency [rad/s], by Dowell's formula."""
    depth = math.sqrt(2.0 * COPPER_RESISTIVITY_OHM_M / (max(rads, 1e-9) * VACUUM_PERMEABILITY_H_PER_M))
    x = winding.conductor_height_m / depth
    if x < THIN:
        return winding.stator_resistance_ohm
    x = min(x, THICK)
    skin = x * (math.sinh(2.0 * x) + math.sin(2.0 * x)) / (math.cosh(2.0 * x) - math.cos(2.0 * x))
    proximity = 2.0 * x * (math.sinh(x) - math.sin(x)) / (math.cosh(x) + math.cos(x))
    layers = winding.conductor_layers
    return winding.stator_resistance_ohm * (skin + (layers * layers - 1.0) / 3.0 * proximity)


def side_bands() -> FloatArray:
    """Return amplitudes of the phase voltage of space-vector modulation over half the link voltage.

    Returns
    -------
    array of shape (DEPTHS, CARRIER_ORDERS, 2 SIDE_BANDS + 1)
        At the frequency of n carriers and k - SIDE_BANDS fundamentals; depths of modulation rise from 0 to 2/sqrt(3).
    """
    angle = 2 * np.pi * np.arange(ANGLES) / ANGLES
    depth = np.linspace(0.0, MAX_DEPTH, DEPTHS)
    phases = depth[:, None, None] * np.cos(angle[None, :] - 2 * np.pi * np.arange(3)[:, None] / 3)
    # half the sum of the outer two is taken off all legs: the zero-sequence part, which the phases do not see
    leg = phases[:, 0] - 0.5 * (phases.max(axis=1) + phases.min(axis=1))
    order = np.arange(1, CARRIER_ORDERS + 1)[:, None]
    carrier = 4 / (order * np.pi) * np.sin(order * np.pi * (1 + leg[:, None, :]) / 2)
    band = np.arange(-SIDE_BANDS, SIDE_BANDS + 1)
    amplitudes = np.abs(np.fft.fft(carrier, axis=-1) / ANGLES)[..., band]
    # the same in all three phases: no current without a neutral wire
    amplitudes[..., band % 3 == 0] = 0.0
    return np.ascontiguousarray(amplitudes)


@njit(cache=True, error_model="numpy")
def space_vector_loss(
    winding: Winding,
    bands: FloatArray,
    link_voltage_v: float,
    carrier_rads: float,
    stator_rads: float,
    phase_voltage_v: float,
) -> float:
    """Return the loss of the harmonics of space-vector modulation in three windings [W].

    Parameters
    ----------
    winding : Winding
    bands : array
        As `side_bands` returns.
    link_voltage_v, phase_voltage_v : float
        Of the direct-current link, and amplitude of the fundamental [V].
    carrier_rads, stator_rads : float
        Angular frequencies of carrier and fundamental [rad/s].
    """
    last = bands.shape[0] - 1
    half = 0.5 * link_voltage_v
    place = min(phase_voltage_v / half / MAX_DEPTH, 1.0) * last
    i = min(int(place), last - 1)
    share = place - i
    # three phases carry 3/2 R I^2 of an amplitude I, which only the inductance limits: reactance far above resistance
    loss = 0.0
    for n in range(bands.shape[1]):
        for k in range(bands.shape[2]):
            amplitude = (1.0 - share) * bands[i, n, k] + share * bands[i + 1, n, k]
            rads = abs((n + 1) * carrier_rads + (k - SIDE_BANDS) * stator_rads)
            if amplitude > NEGLIGIBLE_AMPLITUDE and rads > stator_rads:
                current = amplitude * half / (rads * winding.harmonic_inductance_h)
                loss += 1.5 * resistance_at(winding, rads) * current * current
    return loss


@njit(cache=True, error_model="numpy")
def six_step_loss(winding: Winding, stator_rads: float, phase_voltage_v: float) -> float:
    """Return the loss of the harmonics of six-step operation in three windings [W]: orders 6 k -+ 1, 1/order each."""
    loss = 0.0
    for k in range(1, SIX_STEP_ORDERS + 1):
        for order in (6 * k - 1, 6 * k + 1):
            rads = order * stator_rads
            current = phase_voltage_v / (order * rads * winding.harmonic_inductance_h)
            loss += 1.5 * resistance_at(winding, rads) * current * current
    return loss


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
