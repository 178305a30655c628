"""The largest efforts of the machines at a speed: full current at rated flux, then under the voltage with less flux.

Ix^2 = kappa / q is at most the least of Imu^2, I^2 / (1 + q^2) and U_m^2 / D(q), each of which makes kappa a function
of q with one maximum; so the greatest torque is found by one search over q. If more current than the
pull-out torque needs would only lower the torque, the machine takes less.

Source: Rawicki, (1)-(2), (14)-(28); the law above the speed at which the voltage no longer carries the full current is
railjoule's.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.geared import BRAKING_SHARE, DRIVING_SHARE, FRICTION, MOTORS, TURNS
from railjoule.core.drive.induction.machine import (
    Machine,
    leakage_share,
    make_machine,
    slip_rate,
    steady_state,
    torque_constant,
)
from railjoule.core.drive.induction.voltage import Quartic, value, voltage_quartic
from railjoule.core.golden_section import Bracket, inner_points, narrowed, next_point

# Iy / Ix of the search: far beyond both ends of what machines do, in the logarithm of which the torque has one maximum
MIN_RATIO, GREATEST_RATIO = 1e-3, 1e3
WIDENING = 1.02
# 50 cuts by 0.618 leave 5e-10 of the ratio, at a kink between two limits as much of the torque
NARROWINGS = 50


@njit(cache=True)
def _strength_at(machine: Machine, quartic: Quartic, current2: float, flux2: float, ratio: float) -> float:
    """Return the largest kappa [A2] at a ratio of the currents."""
    voltage2 = machine.max_phase_voltage_v * machine.max_phase_voltage_v
    by_current, by_voltage = current2 / (1.0 + ratio * ratio), voltage2 / value(quartic, ratio)
    return ratio * min(flux2, by_current, by_voltage)


@njit(cache=True)
def max_torque_nm(machine: Machine, sign: float, current_a: float, flux_current_a: float, rotor_rads: float) -> float:
    """Return the greatest electromagnetic torque [N m], without sign.

    Parameters
    ----------
    machine : Machine
        Its numbers.
    sign : float
        1 driving, -1 generating.
    current_a, flux_current_a : float
        Limits of the whole current and of its magnetising part [A].
    rotor_rads : float
        Electrical angular frequency of the rotor [rad/s].
    """
    quartic = voltage_quartic(machine, sign, rotor_rads)
    current2, flux2 = current_a * current_a, flux_current_a * flux_current_a
    low, high = math.log(MIN_RATIO), math.log(GREATEST_RATIO)
    left, right = inner_points(low, high)
    # the search is for the least value, so kappa comes into it negative
    at_left = -_strength_at(machine, quartic, current2, flux2, math.exp(left))
    at_right = -_strength_at(machine, quartic, current2, flux2, math.exp(right))
    bracket = Bracket(low, left, right, high, at_left, at_right)
    for _ in range(NARROWINGS):
        strength = _strength_at(machine, quartic, current2, flux2, math.exp(next_point(bracket)))
        bracket = narrowed(bracket, -strength)
    return -torque_constant(machine) * min(bracket.value_left, bracket.value_right)


@njit(cache=True, nogil=True)
def fill_efforts(
    parameters: FloatArray,
    braking: bool,
    current_a: float,
    rated_flux: bool,
    speed_ms: FloatArray,
    effort_n: FloatArray,
) -> None:
    """Fill `effort_n` [N] with the largest efforts of the train at speeds [m/s]; both of shape (n,).

    Parameters
    ----------
    parameters : array
        The drive's.
    braking : bool
        Whether the machines generate.
    current_a : float
        Largest current of one machine [A].
    rated_flux : bool
        Whether the flux is limited to its rated value; else only current and voltage count.
    speed_ms, effort_n : array of shape (n,)
        Speeds and efforts.
    """
    machine, sign = make_machine(parameters), -1.0 if braking else 1.0
    wheel = parameters[MOTORS] * parameters[TURNS] / parameters[BRAKING_SHARE if braking else DRIVING_SHARE]
    flux_current = machine.magnetising_current_a if rated_flux else np.inf
    for i in range(speed_ms.shape[0]):
        rotor_rads = machine.pole_pairs * parameters[TURNS] * speed_ms[i]
        torque = max_torque_nm(machine, sign, current_a, flux_current, rotor_rads)
        # friction of the machine helps to brake, and takes torque from driving
        effort_n[i] = max(wheel * (torque - sign * parameters[FRICTION]), 0.0)


@njit(cache=True)
def corner_speed(parameters: FloatArray, braking: bool, current_a: float) -> float:
    """Return the speed [m/s] up to which the voltage carries a current at rated flux, (15)-(17); 0 if it never does.

    Parameters
    ----------
    parameters : array
        The drive's.
    braking : bool
        Whether the machines generate.
    current_a : float
        Current of one machine [A], above that of the rated flux.
    """
    machine = make_machine(parameters)
    sign, flux_current = -1.0 if braking else 1.0, machine.magnetising_current_a
    # Of a current I the torque goes as Ix Iy = I^2 q / (1 + q^2), greatest at q = 1, where Ix = I / sqrt(2): so little
    # current gives its most at less than rated flux.
    if current_a <= math.sqrt(2.0) * flux_current:
        return 0.0
    q = math.sqrt(current_a * current_a / (flux_current * flux_current) - 1.0)
    # At a given ratio D of `voltage` is a quadratic in the stator's frequency w1,
    #     R_S^2 (1 + q^2) + 2 R_S L_S (1 - sigma) s q w1 + L_S^2 (1 + sigma^2 q^2) w1^2,
    # and with w1 = w + s g q one in that of the rotor, a w^2 + b w + c.
    r, ls, g, sigma = (
        machine.stator_resistance_ohm,
        machine.stator_inductance_h,
        slip_rate(machine),
        leakage_share(machine),
    )
    a = ls * ls * (1.0 + sigma * sigma * q * q)
    b = 2.0 * sign * q * (g * a + r * ls * (1.0 - sigma))
    c = r * r * (1.0 + q * q) + g * g * q * q * a + 2.0 * r * ls * (1.0 - sigma) * g * q * q
    voltage = machine.max_phase_voltage_v / flux_current
    # the voltage suffices between the roots: the upper one is the corner
    discriminant = b * b - 4.0 * a * (c - voltage * voltage)
    if discriminant <= 0.0:
        return 0.0
    rotor_rads = (-b + math.sqrt(discriminant)) / (2.0 * a)
    speed: float = max(rotor_rads, 0.0) / (machine.pole_pairs * parameters[TURNS])
    return speed


@njit(cache=True)
def _full_current_ratio(machine: Machine, quartic: Quartic, current_a: float) -> float:
    """Return the least ratio of the currents at which the voltage carries a current at no more than rated flux.

    Negative where the voltage does not carry the current at all.
    """
    current2 = current_a * current_a
    voltage2 = machine.max_phase_voltage_v * machine.max_phase_voltage_v
    # I^2 = Ix^2 (1 + q^2) with Ix <= Imu, and at q = 1 a current gives its most: below, less flux gives more
    q = math.sqrt(max(current2 / (machine.magnetising_current_a * machine.magnetising_current_a) - 1.0, 1.0))
    if current2 * value(quartic, q) <= voltage2 * (1.0 + q * q):
        return q
    low = q
    while current2 * value(quartic, q) > voltage2 * (1.0 + q * q):
        # small steps: the range of ratios at which the voltage carries the current may be narrow
        low, q = q, WIDENING * q
        if q > GREATEST_RATIO:
            return -1.0
    for _ in range(NARROWINGS):
        middle = 0.5 * (low + q)
        if current2 * value(quartic, middle) > voltage2 * (1.0 + middle * middle):
            low = middle
        else:
            q = middle
    return q


@njit(cache=True, nogil=True)
def fill_full_current(
    parameters: FloatArray, current_a: float, speed_ms: FloatArray, effort_n: FloatArray, power_w: FloatArray
) -> None:
    """Fill tractive effort [N] and line power [W] of machines that carry all of a current, as Rawicki's starts do.

    If the pull-out torque needs less, that wastes power; if the voltage does not carry it, both become negative.

    Parameters
    ----------
    parameters : array
        The drive's.
    current_a : float
        Current of one machine [A], above that of the rated flux.
    speed_ms, effort_n, power_w : array of shape (n,)
        Speeds, efforts and powers.
    """
    machine = make_machine(parameters)
    wheel = parameters[MOTORS] * parameters[TURNS] / parameters[DRIVING_SHARE]
    for i in range(speed_ms.shape[0]):
        rotor_rads = machine.pole_pairs * parameters[TURNS] * speed_ms[i]
        ratio = _full_current_ratio(machine, voltage_quartic(machine, 1.0, rotor_rads), current_a)
        if ratio < 0.0:
            effort_n[i], power_w[i] = -1.0, -1.0
            continue
        flux_current = current_a / math.sqrt(1.0 + ratio * ratio)
        state = steady_state(machine, flux_current, ratio * flux_current, rotor_rads)
        effort_n[i] = wheel * (state.torque_nm - machine.mechanical_loss_torque_nm)
        power_w[i] = parameters[MOTORS] * state.input_power_w
