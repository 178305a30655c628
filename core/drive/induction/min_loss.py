"""The input power of a machine at a torque and a speed, with the flux that loses least.

With kappa = Ix |Iy|, q = |Iy| / Ix, s = 1 driving or -1 generating, k_T = T / (Ix Iy) and g = R_W / L_W, the input
power is kappa phi(q, w),

    phi = s k_T w / p + (3/2) R_S (1/q + q) + k_T g q / p + [Ph' |w1| + Pe' w1^2] / q,      w1 = w + s g q.

It is convex in 1/q, so the best ratio is that of the free minimum, a square root, or the nearest one that keeps
Ix <= Imu and the voltage. All is closed but the root of a quartic where the voltage binds. At the change from one limit
to the other, first derivatives jump, and second ones wherever a limit begins to bind, as in the machine; a
solver that needs a smooth power takes that of `smooth_input_power`, which is never more.

Source: Rawicki, (33)-(43), whose search over the flux this replaces.
"""

import math

from railjoule.core.compiled import njit
from railjoule.core.drive.induction.machine import Machine, leakage_share, slip_rate, torque_constant
from railjoule.core.drive.induction.voltage import (
    pull_out_ratio,
    quartic_by_frequency,
    ratio_within_voltage,
    second_derivative,
    slope,
    value,
    voltage_quartic,
)
from railjoule.core.drive.kinds import PowerTerms

FREE, RATED_FLUX, FULL_VOLTAGE, BEYOND, STANDING_FIELD = range(5)
"""The reason for the flux: the losses, its rated value, the voltage, an impossible torque, or w1 = 0."""

# as a share of d2, half of D'' at no ratio: where D is hardly curved, the pull-out ratio changes without bound
NO_CURVATURE = 1e-3
# Width of the rounded corner between two limits of the ratio, by their logarithms. At most 2/27
# of it is taken off the greater one, 0.4 %, a third of the way from the corner and next to nothing at both ends; a
# narrower width takes off less, but second derivatives grow as its inverse and Newton's steps shrink.
ROUNDED_WIDTH = 0.05


@njit(cache=True)
def best_ratio(machine: Machine, sign: float, strength: float, rotor_rads: float) -> tuple[float, int]:
    """Return the ratio |Iy| / Ix of least loss and what decides it.

    A torque beyond what flux and voltage allow gets the ratio of the pull-out torque or, if that is larger, of the
    rated flux, as though the voltage sufficed: the power goes on rising with the torque.

    Parameters
    ----------
    machine : Machine
        Its numbers.
    sign : float
        1 driving, -1 generating.
    strength : float
        Product of both currents, without sign [A2].
    rotor_rads : float
        Electrical angular frequency of the rotor [rad/s].
    """
    # kappa = q Ix^2, so a flux of at most the rated one is a ratio of at least kappa / Imu^2
    ratio, decider = _free_ratio(machine, sign, rotor_rads)
    least = strength / (machine.magnetising_current_a * machine.magnetising_current_a)
    if ratio < least:
        ratio, decider = least, RATED_FLUX
    voltage2 = machine.max_phase_voltage_v * machine.max_phase_voltage_v
    quartic = voltage_quartic(machine, sign, rotor_rads)
    if strength * value(quartic, ratio) <= voltage2 * ratio:
        return ratio, decider
    bound = ratio_within_voltage(quartic, strength, voltage2, ratio)
    if bound >= least:
        return bound, FULL_VOLTAGE
    # no machine gives that torque: with less than this ratio its flux would exceed the rated one, and its losses fall
    pull_out = pull_out_ratio(quartic) if bound < 0.0 else 0.0
    return (pull_out, BEYOND) if pull_out >= least else (least, RATED_FLUX)


@njit(cache=True)
def _loss_weights(machine: Machine, sign: float, rotor_rads: float, turning: float) -> tuple[float, float, float]:
    """Return a, b, c of phi = s k_T w / p + a / q + b q + c; `turning` is the sign of w1."""
    g, flux2 = slip_rate(machine), machine.magnetising_current_a * machine.magnetising_current_a
    hysteresis, eddy = turning * machine.hysteresis_loss_ws / flux2, machine.eddy_loss_ws2 / flux2
    r = 1.5 * machine.stator_resistance_ohm
    return (
        r + (hysteresis + eddy * rotor_rads) * rotor_rads,
        r + torque_constant(machine) * g / machine.pole_pairs + eddy * g * g,
        sign * g * (hysteresis + 2.0 * eddy * rotor_rads),
    )


@njit(cache=True)
def _free_ratio(machine: Machine, sign: float, rotor_rads: float) -> tuple[float, int]:
    """Return the ratio of least loss without limits: where a generator's field turns backwards, or stands, too."""
    # a / q + b q is least at q = sqrt(a / b); at the ratio w / g a generator's slip cancels the speed of its rotor
    a, b, _ = _loss_weights(machine, sign, rotor_rads, 1.0)
    ratio, still = math.sqrt(a / b), rotor_rads / slip_rate(machine)
    if sign > 0.0 or ratio <= still:
        return ratio, FREE
    # |w1| has a kink there: unless one of its sides has a least value of its own, the least is the kink
    a, b, _ = _loss_weights(machine, sign, rotor_rads, -1.0)
    ratio = math.sqrt(max(a, 0.0) / b)
    return (ratio, FREE) if ratio > still else (still, STANDING_FIELD)


@njit(cache=True)
def _ratio_derivatives(
    machine: Machine, sign: float, strength: float, rotor_rads: float, ratio: float, decider: int
) -> PowerTerms:
    """Return the best ratio and its derivatives by strength and frequency; not those of a free one, which cancel."""
    # The flux is rated where q = kappa / Imu^2, the field stands where q = w / g. The two others are roots of a
    # G(q, k, w), k = kappa; differentiating G = 0 once and twice with q(k, w) in it gives, for any x and y of k and w,
    #     q_x = -G_x / G_q        q_xy = -(G_xy + G_qx q_y + G_qy q_x + G_qq q_x q_y) / G_q,
    # where the voltage binds with G = k D(q, w) - U_m^2 q, at the pull-out with G = D - q dD/dq, without k.
    if decider == RATED_FLUX:
        per_strength = 1.0 / (machine.magnetising_current_a * machine.magnetising_current_a)
        return ratio, per_strength, 0.0, 0.0, 0.0, 0.0
    if decider == STANDING_FIELD:
        return ratio, 0.0, 1.0 / slip_rate(machine), 0.0, 0.0, 0.0
    d = voltage_quartic(machine, sign, rotor_rads)
    d_w = quartic_by_frequency(machine, sign, rotor_rads)
    # d2D/dw2 = 2 L_S^2 (1 + sigma^2 q^2)
    q, sigma = ratio, leakage_share(machine)
    d_ww0 = 2.0 * machine.stator_inductance_h * machine.stator_inductance_h
    d_ww2 = d_ww0 * sigma * sigma
    if decider == BEYOND:
        if second_derivative(d, q) <= NO_CURVATURE * d.d2:  # a generator without a pull-out: its ratio goes on as it is
            return q, 0.0, 0.0, 0.0, 0.0, 0.0
        # d(D - q D') = -q D'' dq: of the derivatives by q one term cancels each time
        by_q = -q * second_derivative(d, q)
        by_w = value(d_w, q) - q * slope(d_w, q)
        by_qq = -second_derivative(d, q) - q * (24.0 * d.d4 * q + 6.0 * d.d3)
        by_qw = -q * second_derivative(d_w, q)
        by_ww = d_ww0 - d_ww2 * q * q
        q_w = -by_w / by_q
        return q, 0.0, q_w, 0.0, 0.0, -(by_ww + 2.0 * by_qw * q_w + by_qq * q_w * q_w) / by_q
    # G is linear in k: no by_kk
    voltage2 = machine.max_phase_voltage_v * machine.max_phase_voltage_v
    by_q = strength * slope(d, q) - voltage2
    by_k, by_w = value(d, q), strength * value(d_w, q)
    by_qq, by_qk, by_qw = strength * second_derivative(d, q), slope(d, q), strength * slope(d_w, q)
    by_kw, by_ww = value(d_w, q), strength * (d_ww0 + d_ww2 * q * q)
    q_k, q_w = -by_k / by_q, -by_w / by_q
    return (
        q,
        q_k,
        q_w,
        -(2.0 * by_qk * q_k + by_qq * q_k * q_k) / by_q,
        -(by_kw + by_qk * q_w + by_qw * q_k + by_qq * q_k * q_w) / by_q,
        -(by_ww + 2.0 * by_qw * q_w + by_qq * q_w * q_w) / by_q,
    )


@njit(cache=True)
def input_power_of_shaft(machine: Machine, shaft_nm: float, rads: float, smooth: bool) -> PowerTerms:
    """Return the input power of a machine that is on [W], and its derivatives by torque and speed of the shaft.

    Parameters
    ----------
    machine : Machine
    shaft_nm, rads : float
        Torque, negative where it brakes [N m], and speed [rad/s].
    smooth : bool
        Whether to return `smooth_input_power` instead of the least power.
    """
    # friction takes its torque from the shaft in both directions
    torque = machine.mechanical_loss_torque_nm + shaft_nm
    # kappa has no sign: the torque acts on it through its own, also in the chain rule below
    sign = 1.0 if torque >= 0.0 else -1.0
    by_torque, poles = sign / torque_constant(machine), machine.pole_pairs
    if smooth:
        power = smooth_input_power(machine, sign, by_torque * torque, poles * rads)
    else:
        power = min_input_power(machine, sign, by_torque * torque, poles * rads)
    p, p_k, p_w, p_kk, p_kw, p_ww = power
    return p, p_k * by_torque, p_w * poles, p_kk * by_torque * by_torque, p_kw * by_torque * poles, p_ww * poles * poles


@njit(cache=True)
def min_input_power(machine: Machine, sign: float, strength: float, rotor_rads: float) -> PowerTerms:
    """Return the least input power [W] and its derivatives by strength and frequency.

    Parameters
    ----------
    machine : Machine
        Its numbers.
    sign : float
        1 driving, -1 generating; the power is then negative unless the losses exceed what the shaft gives.
    strength : float
        kappa, product of both currents, without sign: |T| / k_T [A2].
    rotor_rads : float
        w, electrical angular frequency of the rotor [rad/s].

    Returns
    -------
    tuple of float
        p, p_k, p_w, p_kk, p_kw, p_ww. Beyond what the voltage carries, the ratio of the pull-out torque goes on.
    """
    ratio, decider = best_ratio(machine, sign, strength, rotor_rads)
    change = 0.0, 0.0, 0.0, 0.0, 0.0
    if decider != FREE:
        _, q_k, q_w, q_kk, q_kw, q_ww = _ratio_derivatives(machine, sign, strength, rotor_rads, ratio, decider)
        change = q_k, q_w, q_kk, q_kw, q_ww
    return _input_power_at(machine, sign, strength, rotor_rads, ratio, decider, change)


@njit(cache=True)
def _input_power_at(
    machine: Machine,
    sign: float,
    strength: float,
    rotor_rads: float,
    ratio: float,
    decider: int,
    change: tuple[float, float, float, float, float],
) -> PowerTerms:
    """Return the input power at a ratio that changes by strength and frequency as given: q_k, q_w, q_kk, q_kw, q_ww."""
    q, k = ratio, strength
    frequency = rotor_rads + sign * slip_rate(machine) * q
    # the sign of w1 in the hysteresis loss; where the field is kept standing, neither side's
    turning = 1.0 if frequency > 0.0 else -1.0 if frequency < 0.0 else 0.0
    if decider == STANDING_FIELD:
        turning = 0.0
    a, b, c = _loss_weights(machine, sign, rotor_rads, turning)
    flux2 = machine.magnetising_current_a * machine.magnetising_current_a
    hysteresis, eddy = turning * machine.hysteresis_loss_ws / flux2, machine.eddy_loss_ws2 / flux2
    a_w, a_ww = hysteresis + 2.0 * eddy * rotor_rads, 2.0 * eddy
    shaft = sign * torque_constant(machine) / machine.pole_pairs
    phi = shaft * rotor_rads + a / q + b * q + c
    phi_w = shaft + a_w / q + 2.0 * sign * slip_rate(machine) * eddy
    phi_ww, phi_qw = a_ww / q, -a_w / (q * q)
    phi_q, phi_qq = b - a / (q * q), 2.0 * a / (q * q * q)
    # at a free minimum phi_q = 0: the ratio's change counts in second derivatives only, and phi_qw + phi_qq q_w = 0
    if decider == FREE:
        q_w = -phi_qw / phi_qq
        return k * phi, phi, k * phi_w, 0.0, phi_w, k * (phi_ww + phi_qw * q_w)
    q_k, q_w, q_kk, q_kw, q_ww = change
    return (
        k * phi,
        phi + k * phi_q * q_k,
        k * (phi_w + phi_q * q_w),
        2.0 * phi_q * q_k + k * (phi_qq * q_k * q_k + phi_q * q_kk),
        phi_w + phi_q * q_w + k * (phi_qw * q_k + phi_qq * q_k * q_w + phi_q * q_kw),
        k * (phi_ww + 2.0 * phi_qw * q_w + phi_qq * q_w * q_w + phi_q * q_ww),
    )


@njit(cache=True)
def smooth_input_power(machine: Machine, sign: float, strength: float, rotor_rads: float) -> PowerTerms:
    """Return an input power with continuous first derivatives, never more than the least; arguments as there.

    If the limits of flux and of voltage both are near, the ratio is a little less than the greater of the two,
    though not at the corner itself, at which an optimum may lie.
    """
    free, _ = _free_ratio(machine, sign, rotor_rads)
    rated = strength / (machine.magnetising_current_a * machine.magnetising_current_a)
    low = math.exp(-ROUNDED_WIDTH) * rated
    voltage2 = machine.max_phase_voltage_v * machine.max_phase_voltage_v
    quartic = voltage_quartic(machine, sign, rotor_rads)
    # no corner: least loss needs less than the rated flux, or the voltage is kept even at a ratio much smaller than
    # that of the rated flux
    one_limit = free >= rated or strength * value(quartic, low) <= voltage2 * low
    bound = -1.0 if one_limit else ratio_within_voltage(quartic, strength, voltage2, low)
    if bound <= 0.0 or bound * math.exp(-ROUNDED_WIDTH) > rated:
        return min_input_power(machine, sign, strength, rotor_rads)
    # The greater of two logarithms r and v is their mean and half of |d|, d = r - v. With u = |d| / width the function
    # s = |d| u (2 - u) is never more than |d|, and equal to it, with its slope, at u = 1; at the corner, s = s' = 0.
    # Of the logarithm l = (r + v + s) / 2 of the ratio t, then,
    #     l_x = a r_x + b v_x,   a = (1 + s') / 2,  b = (1 - s') / 2,
    #     l_xy = a r_xy + b v_xy + s'' / 2 (r_x - v_x) (r_y - v_y),   and t_x = t l_x,  t_xy = t (l_xy + l_x l_y).
    # r is ln k and a constant, so r_k = 1 / k, r_kk = -1 / k^2 and r_w = 0; v_xy is bound_xy / bound - v_x v_y.
    apart = math.log(rated / bound)
    u = abs(apart) / ROUNDED_WIDTH
    total = math.sqrt(rated * bound) * math.exp(0.5 * abs(apart) * u * (2.0 - u))
    steepness = math.copysign(u * (4.0 - 3.0 * u), apart)
    a, b = 0.5 * (1.0 + steepness), 0.5 * (1.0 - steepness)
    _, v_k, v_w, v_kk, v_kw, v_ww = _ratio_derivatives(machine, sign, strength, rotor_rads, bound, FULL_VOLTAGE)
    r_k, v_k, v_w = 1.0 / strength, v_k / bound, v_w / bound
    l_k, l_w = a * r_k + b * v_k, b * v_w
    both = (2.0 - 3.0 * u) / ROUNDED_WIDTH
    l_kk = -a * r_k * r_k + b * (v_kk / bound - v_k * v_k) + both * (r_k - v_k) ** 2
    l_kw = b * (v_kw / bound - v_k * v_w) - both * (r_k - v_k) * v_w
    l_ww = b * (v_ww / bound - v_w * v_w) + both * v_w * v_w
    change = (
        total * l_k,
        total * l_w,
        total * (l_kk + l_k * l_k),
        total * (l_kw + l_k * l_w),
        total * (l_ww + l_w * l_w),
    )
    return _input_power_at(machine, sign, strength, rotor_rads, total, FULL_VOLTAGE, change)
