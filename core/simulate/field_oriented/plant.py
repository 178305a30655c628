"""A train, its induction machines and their control, integrated with a fixed step by the rule of Runge and Kutta.

The frame is that of the control: it turns with the rotor flux that the control believes in, so a wrong rotor
resistance leaves the true flux with a part along both axes. The machine is that of the inverse-gamma circuit,

    Ls di/dt   = u - (Rs + Rr) i - j wc Ls i + (a - j p w) psi          a = Rr / Lm
    dpsi/dt    = Rr i - (a + j (wc - p w)) psi
    torque     = (3/2) p Im(i conj(psi))

with the rotor flux psi, the speed of the frame wc = p w + Rr' iq / psi', primes for what the control believes. Energies
are states like any other, so that both accounts come from the same stages.

The loop. Position control makes of the reference x* a wanted acceleration ad with the closed loop (1 + s/wp)^-3,

    dad/dt = wp^3 (x* - x) - 3 wp^2 v' - 3 wp ad,

and an observer, which also smooths the measured speed, adds what the train needs beside its own inertia. The
pre-compensator cancels the lag of the loop: x* = x + (3/wp) v + (3/wp^2) a + (1/wp^3) j of the reference.

Currents have PI control with decoupling. Where the voltage does not suffice, it keeps its direction, the
integrals keep free of what is cut off, the current along the flux is taken back, and that along the torque never asks
for more than the pull-out torque. Where a limit holds the train back, the clock of the reference is slowed down, so
that it goes on along its plan, later, and but for catching up the last metre no faster than planned.

Source: Ftorek et al. 2025, Figure 1; Vittek et al. 2017, "Position tracking systems for AC drives employing forced
dynamics control".
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.line_power import line_power
from railjoule.core.physics.resistance import running_resistance

CURRENT_BANDWIDTH_RADS = 500.0
CURRENT_BANDWIDTH_SHARE = 25.0
"""The current loops' bandwidth, and how much faster than the position loop they are at least."""
INTEGRAL_SHARE = 0.1
"""Integral gain of the current control over the square of its bandwidth."""
OBSERVER_SHARE = 3.0
"""Bandwidth of the load observer over that of the position loop."""
UNWINDING_SHARE = 5.0
"""How fast a wanted acceleration beyond the limits is taken back, over the bandwidth of the position loop."""
WEAKENING_SHARE, WEAKENING_TIME_S = 20.0, 0.2
"""How fast a current along the flux that takes it back grows, in largest currents a second where the control wants
twice the voltage there is, and how long it lasts."""
ALLOWED_LAG_M, STOPPING_LAG_M = 0.1, 1.0
"""Lag behind the reference at which its clock becomes slower, and how much more of it stops the clock."""
CREEP_MS = 0.01
"""Below this speed running resistance fades out."""
NOISE_STEP_S = 0.001
"""Between two independent errors of the measured speed, which goes straight from one to the next."""
LEAST_FLUX_SHARE = 0.01
FAR_A, FAR_MS = 1e6, 1e4
STANDING_MS, STANDING_M = 1e-3, 2e-3

(
    X, V, ID, IQ, PSI_D, PSI_Q, BELIEVED_PSI, SUM_D, SUM_Q, WANTED, SEEN_SPEED, SEEN_LOAD, CLOCK, ELAPSED, WEAKENING,
    INPUT, SHAFT, STATOR, ROTOR, MAGNETISING, IRON, DRAWN, RETURNED, MECHANICAL, GEAR, RUNNING, CURVE, CLIMB, STATES,
) = range(29)  # fmt: skip
"""What the states are; from INPUT on energies of all machines and of the train [J]."""

VOLTAGE, TORQUE, LINE_POWER, CURRENT_HELD, VOLTAGE_HELD, EXTRAS = range(6)
"""What else a stage tells: amplitude of the voltage [V], torque of a machine [N m], power [W], limits at work."""

(
    MAX_CURRENT, MAX_TORQUE_CURRENT, MIN_TORQUE_CURRENT, MAX_VOLTAGE, MAX_LAG, MIN_LAG, ARRIVAL, PEAKS,
) = range(8)  # fmt: skip

DONE, TOO_LONG, UNSTABLE = range(3)


class Plant(NamedTuple):
    """The numbers of train, machines and control.

    Parameters
    ----------
    stator_resistance_ohm, rotor_resistance_ohm : float
        Of the inverse-gamma circuit [ohm].
    magnetising_inductance_h, leakage_inductance_h : float
        Of the same [H].
    pole_pairs, motors, turns_per_metre, gear_efficiency, mechanical_loss_torque_nm : float
        As in `railjoule.core.drive.induction`.
    hysteresis_loss_ws, eddy_loss_ws2, rated_flux_vs : float
        Iron losses at the rated flux, that of the inverse-gamma circuit [W s, W s2, V s].
    driving_current_a, braking_current_a, max_phase_voltage_v : float
        Limits of the inverter [A, V].
    recuperation_factor : float
        Share of the generated energy that the line takes back.
    inertia_kg, believed_inertia_kg : float
        Mass that resists acceleration, true and as the control knows it [kg].
    resistance_constant_n, resistance_linear : float
        Of the running resistance [N, N s/m].
    bandwidth_rads : float
        wp [rad/s].
    precompensator : bool
        Whether the lag is cancelled.
    rotor_resistance_factor : float
        Believed rotor resistance over the true one.
    """

    stator_resistance_ohm: float
    rotor_resistance_ohm: float
    magnetising_inductance_h: float
    leakage_inductance_h: float
    pole_pairs: float
    motors: float
    turns_per_metre: float
    gear_efficiency: float
    mechanical_loss_torque_nm: float
    hysteresis_loss_ws: float
    eddy_loss_ws2: float
    rated_flux_vs: float
    driving_current_a: float
    braking_current_a: float
    max_phase_voltage_v: float
    recuperation_factor: float
    inertia_kg: float
    believed_inertia_kg: float
    resistance_constant_n: float
    resistance_linear: float
    bandwidth_rads: float
    precompensator: bool
    rotor_resistance_factor: float


class Way(NamedTuple):
    """The line under the train, and the reference.

    Parameters
    ----------
    border_m : array of shape (n + 1,)
        Borders of the cells [m].
    gradient_force_n, curve_force_n, resistance_quadratic : array of shape (n,)
        What each cell holds against the train [N, N, N s2/m2].
    reference : array of shape (m, 6)
        Place, speed, acceleration and jerk of the reference, flux linkage and its rate [m, ..., V s, V].
    planned_m : array of shape (m,)
        The plan's own place at the same times [m].
    step_s : float
        Between two samples of both [s].
    """

    border_m: FloatArray
    gradient_force_n: FloatArray
    curve_force_n: FloatArray
    resistance_quadratic: FloatArray
    reference: FloatArray
    planned_m: FloatArray
    step_s: float


@njit(cache=True, error_model="numpy")
def wheel_force_n(plant: Plant, torque_nm: float) -> float:
    """Return the force of all machines at the wheels [N] at a torque of each shaft [N m]."""
    ideal = plant.motors * plant.turns_per_metre * torque_nm
    force: float = ideal * plant.gear_efficiency if torque_nm > 0.0 else ideal / plant.gear_efficiency
    return force


@njit(cache=True, error_model="numpy")
def shaft_torque_nm(plant: Plant, force_n: float) -> float:
    """Return the torque of each shaft [N m] that gives a force of the train at the wheels [N]."""
    ideal = force_n / (plant.motors * plant.turns_per_metre)
    torque: float = ideal / plant.gear_efficiency if force_n > 0.0 else ideal * plant.gear_efficiency
    return torque


@njit(cache=True, error_model="numpy")
def fill_rates(
    plant: Plant, way: Way, cell: int, noise_ms: float, state: FloatArray, rates: FloatArray, extras: FloatArray
) -> None:
    """Fill the rates of all states, of shape (STATES,), and what else is told, of shape (EXTRAS,)."""
    v, i_d, i_q, psi_d, psi_q = state[V], state[ID], state[IQ], state[PSI_D], state[PSI_Q]
    r_s, r_r = plant.stator_resistance_ohm, plant.rotor_resistance_ohm
    l_m, l_s, p = plant.magnetising_inductance_h, plant.leakage_inductance_h, plant.pole_pairs
    turns, wp = plant.turns_per_metre, plant.bandwidth_rads
    believed_r = plant.rotor_resistance_factor * r_r
    believed_psi = max(state[BELIEVED_PSI], LEAST_FLUX_SHARE * plant.rated_flux_vs)
    measured = v + noise_ms

    # reference at its own clock, within a sample by its jerk
    samples = way.reference.shape[0]
    place = min(state[CLOCK] / way.step_s, samples - 1.0)
    if not place > 0.0:  # nor is what is no number
        place = 0.0
    k = int(place)
    d = (place - k) * way.step_s
    ref = way.reference[k]
    ref_a = ref[2] + ref[3] * d
    ref_v = ref[1] + (ref[2] + 0.5 * ref[3] * d) * d
    ref_x = ref[0] + (ref[1] + (0.5 * ref[2] + ref[3] * d / 6.0) * d) * d
    ref_j = ref[3]
    if k + 1 < samples:
        ref_j += (way.reference[k + 1, 3] - ref[3]) * d / way.step_s
        ref_a = ref[2] + 0.5 * (ref[3] + ref_j) * d
    own_lag = 0.0 if plant.precompensator else 3.0 / wp * v
    clock = 1.0 - (ref_x - own_lag - state[X] - ALLOWED_LAG_M) / STOPPING_LAG_M
    clock = min(max(clock, 0.0), 1.0)
    ref_v, ref_a, ref_j = clock * ref_v, clock * clock * ref_a, clock * clock * clock * ref_j
    aim = ref_x
    if plant.precompensator:
        aim += 3.0 / wp * ref_v + 3.0 / (wp * wp) * ref_a + ref_j / (wp * wp * wp)

    # speed of the frame, wanted currents and their limits
    w = turns * v
    believed_w = turns * measured
    frame = p * believed_w + believed_r * i_q / believed_psi
    torque_per_a = 1.5 * p * believed_psi
    largest_i = plant.driving_current_a
    wanted_i_d = ref[4] / l_m + ref[5] / believed_r
    wanted_i_d = min(max(wanted_i_d, 0.0), largest_i) - state[WEAKENING]
    wanted_i_d = max(wanted_i_d, -math.sqrt(0.5) * largest_i)
    wanted_force = plant.believed_inertia_kg * state[WANTED] + state[SEEN_LOAD]
    wanted_i_q = (shaft_torque_nm(plant, wanted_force) + plant.mechanical_loss_torque_nm) / torque_per_a
    pulling = math.sqrt(max(plant.driving_current_a**2 - wanted_i_d**2, 0.0))
    braking = -math.sqrt(max(plant.braking_current_a**2 - wanted_i_d**2, 0.0))
    # most torque for a voltage is where its parts along both axes are alike
    by_voltage = math.sqrt(0.5) * plant.max_phase_voltage_v / (max(abs(frame), 1e-6) * l_s)
    allowed_i_q = min(max(wanted_i_q, braking, -by_voltage), pulling, by_voltage)
    too_much = wanted_i_q != allowed_i_q

    # current control with decoupling
    fast = max(CURRENT_BANDWIDTH_RADS, CURRENT_BANDWIDTH_SHARE * wp)
    r_both, a_believed = r_s + believed_r, believed_r / l_m
    error_d, error_q = wanted_i_d - i_d, allowed_i_q - i_q
    wanted_u_d = l_s * (fast * error_d + state[SUM_D]) + r_both * i_d - frame * l_s * i_q - a_believed * believed_psi
    wanted_u_q = (
        l_s * (fast * error_q + state[SUM_Q]) + r_both * i_q + frame * l_s * i_d + p * believed_w * believed_psi
    )
    u_max = plant.max_phase_voltage_v
    scale = min(1.0, u_max / max(math.hypot(wanted_u_d, wanted_u_q), 1e-9))
    u_d, u_q = scale * wanted_u_d, scale * wanted_u_q
    held = u_d != wanted_u_d or u_q != wanted_u_q
    excess = min(max(math.hypot(wanted_u_d, wanted_u_q) / u_max - 1.0, 0.0), 1.0)

    # the machine
    slip = frame - p * w
    rate_i_d = (u_d - (r_s + r_r) * i_d + frame * l_s * i_q + r_r / l_m * psi_d + p * w * psi_q) / l_s
    rate_i_q = (u_q - (r_s + r_r) * i_q - frame * l_s * i_d + r_r / l_m * psi_q - p * w * psi_d) / l_s
    torque = 1.5 * p * (i_q * psi_d - i_d * psi_q)

    # the train
    moving = min(max(v / CREEP_MS, -1.0), 1.0)
    running = moving * running_resistance(
        plant.resistance_constant_n, plant.resistance_linear, way.resistance_quadratic[cell], abs(v), v * v
    )
    curve = way.curve_force_n[cell] * moving
    friction = plant.mechanical_loss_torque_nm * moving
    force = wheel_force_n(plant, torque - friction)
    rate_v = (force - running - curve - way.gradient_force_n[cell]) / plant.inertia_kg

    # what the control sees of its own torque
    seen_torque = torque_per_a * i_q - plant.mechanical_loss_torque_nm
    seen_force = wheel_force_n(plant, seen_torque)
    wo = OBSERVER_SHARE * wp
    miss = measured - state[SEEN_SPEED]
    rate_wanted = wp * wp * (wp * (aim - state[X]) - 3.0 * state[SEEN_SPEED]) - 3.0 * wp * state[WANTED]
    if too_much or held:
        possible = (seen_force - state[SEEN_LOAD]) / plant.believed_inertia_kg
        rate_wanted += UNWINDING_SHARE * wp * (possible - state[WANTED])

    rates[X] = v
    rates[V] = rate_v
    rates[ID] = rate_i_d
    rates[IQ] = rate_i_q
    rates[PSI_D] = r_r * i_d - r_r / l_m * psi_d + slip * psi_q
    rates[PSI_Q] = r_r * i_q - r_r / l_m * psi_q - slip * psi_d
    rates[BELIEVED_PSI] = believed_r * i_d - a_believed * state[BELIEVED_PSI]
    rates[SUM_D] = INTEGRAL_SHARE * fast * fast * error_d + fast * (u_d - wanted_u_d) / l_s
    rates[SUM_Q] = INTEGRAL_SHARE * fast * fast * error_q + fast * (u_q - wanted_u_q) / l_s
    rates[WANTED] = rate_wanted
    rates[SEEN_SPEED] = (seen_force - state[SEEN_LOAD]) / plant.believed_inertia_kg + 2.0 * wo * miss
    rates[SEEN_LOAD] = -plant.believed_inertia_kg * wo * wo * miss
    rates[CLOCK] = clock
    rates[ELAPSED] = 1.0
    rates[WEAKENING] = WEAKENING_SHARE * largest_i * excess - state[WEAKENING] / WEAKENING_TIME_S

    # where the energy goes
    flux2 = psi_d * psi_d + psi_q * psi_q
    along = (i_d * psi_d + i_q * psi_q) ** 2 / flux2 if flux2 > 0.0 else i_d * i_d + i_q * i_q
    whole = i_d * i_d + i_q * i_q
    rotor_d, rotor_q = i_d - psi_d / l_m, i_q - psi_q / l_m
    turning = abs(frame)
    iron = (plant.hysteresis_loss_ws + plant.eddy_loss_ws2 * turning) * turning * flux2 / plant.rated_flux_vs**2
    motors = plant.motors
    power = motors * (1.5 * (u_d * i_d + u_q * i_q) + iron)
    rates[INPUT] = power
    rates[SHAFT] = motors * torque * w
    rates[STATOR] = motors * 1.5 * r_s * (whole - along)
    rates[MAGNETISING] = motors * 1.5 * r_s * along
    rates[ROTOR] = motors * 1.5 * r_r * (rotor_d * rotor_d + rotor_q * rotor_q)
    rates[IRON] = motors * iron
    rates[DRAWN] = max(power, 0.0)
    rates[RETURNED] = max(-power, 0.0)
    rates[MECHANICAL] = motors * friction * w
    rates[GEAR] = motors * (torque - friction) * w - force * v
    rates[RUNNING] = running * v
    rates[CURVE] = curve * v
    rates[CLIMB] = way.gradient_force_n[cell] * v

    extras[VOLTAGE] = math.hypot(u_d, u_q)
    extras[TORQUE] = torque
    extras[LINE_POWER] = line_power(power, plant.recuperation_factor)
    by_current = too_much and abs(allowed_i_q) < by_voltage
    extras[CURRENT_HELD] = 1.0 if by_current else 0.0
    extras[VOLTAGE_HELD] = 1.0 if held or (too_much and not by_current) else 0.0


@njit(cache=True, error_model="numpy", nogil=True)
def run_plant(
    plant: Plant,
    way: Way,
    noise_ms: FloatArray,
    start: FloatArray,
    time_step_s: float,
    end_m: float,
    arrival_m: float,
    keep_every: int,
    states: FloatArray,
    extras: FloatArray,
    peaks: FloatArray,
) -> tuple[int, int]:
    """Run until the train stands at its end, and return how it ended and how many samples are filled.

    Parameters
    ----------
    plant : Plant
        Train, machines and control.
    way : Way
        Line and reference.
    noise_ms : array
        What is added to the measured speed [m/s], one entry for each `NOISE_STEP_S`, again and again.
    start : array of shape (STATES,)
        The states at the reference's first sample.
    time_step_s : float
        Step of the integration [s].
    end_m, arrival_m : float
        Where the reference ends, and the place whose passing tells the arrival [m].
    keep_every : int
        Steps from one sample to the next.
    states, extras : array of shape (k, STATES), (k, EXTRAS)
        Filled with the samples; limits at work are those of any step since the sample before.
    peaks : array of shape (PEAKS,)
        Filled with the extremes of all steps; ARRIVAL is a time since the start [s], or NaN.
    """
    now, trial, extra = start.copy(), np.empty(STATES), np.empty(EXTRAS)
    k1, k2, k3, k4 = np.empty(STATES), np.empty(STATES), np.empty(STATES), np.empty(STATES)
    unused = np.empty(EXTRAS)
    cells, planned = way.border_m.shape[0] - 1, way.planned_m.shape[0]
    length_s = (way.reference.shape[0] - 1) * way.step_s
    peaks[:] = 0.0
    peaks[ARRIVAL] = np.nan
    held_current = held_voltage = 0.0
    cell, kept, step = 0, 0, 0
    h = time_step_s
    while True:
        time = step * h
        while cell < cells - 1 and now[X] >= way.border_m[cell + 1]:
            cell += 1
        while cell > 0 and now[X] < way.border_m[cell]:
            cell -= 1
        instant = time / NOISE_STEP_S
        drawn = int(instant)
        share = instant - drawn
        first, second = noise_ms[drawn % noise_ms.shape[0]], noise_ms[(drawn + 1) % noise_ms.shape[0]]
        if not (math.hypot(now[ID], now[IQ]) < FAR_A and abs(now[V]) < FAR_MS):
            return UNSTABLE, kept
        noise = first + share * (second - first)
        half_way = noise + 0.5 * h / NOISE_STEP_S * (second - first)
        afterwards = noise + h / NOISE_STEP_S * (second - first)
        fill_rates(plant, way, cell, noise, now, k1, extra)
        held_current, held_voltage = max(held_current, extra[CURRENT_HELD]), max(held_voltage, extra[VOLTAGE_HELD])
        current = math.hypot(now[ID], now[IQ])
        at = min(time / way.step_s, planned - 1.0)
        low = min(int(at), planned - 2)
        lag = way.planned_m[low] + (at - low) * (way.planned_m[low + 1] - way.planned_m[low]) - now[X]
        peaks[MAX_CURRENT] = max(peaks[MAX_CURRENT], current)
        peaks[MAX_TORQUE_CURRENT] = max(peaks[MAX_TORQUE_CURRENT], now[IQ])
        peaks[MIN_TORQUE_CURRENT] = min(peaks[MIN_TORQUE_CURRENT], now[IQ])
        peaks[MAX_VOLTAGE] = max(peaks[MAX_VOLTAGE], extra[VOLTAGE])
        peaks[MAX_LAG], peaks[MIN_LAG] = max(peaks[MAX_LAG], lag), min(peaks[MIN_LAG], lag)
        ended = now[CLOCK] >= length_s - 1e-9
        stands = ended and (
            (abs(now[V]) < STANDING_MS and abs(now[X] - end_m) < STANDING_M) or (now[V] <= 0.0 and now[X] >= end_m)
        )
        full = kept == states.shape[0] - 1
        if step % keep_every == 0 or stands or full:
            states[kept], extras[kept] = now, extra
            extras[kept, CURRENT_HELD], extras[kept, VOLTAGE_HELD] = held_current, held_voltage
            held_current = held_voltage = 0.0
            kept += 1
        if stands:
            return DONE, kept
        if full:
            return TOO_LONG, kept
        before = now[X]
        trial[:] = now + 0.5 * h * k1
        fill_rates(plant, way, cell, half_way, trial, k2, unused)
        trial[:] = now + 0.5 * h * k2
        fill_rates(plant, way, cell, half_way, trial, k3, unused)
        trial[:] = now + h * k3
        fill_rates(plant, way, cell, afterwards, trial, k4, unused)
        now += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        step += 1
        if before < arrival_m <= now[X] and math.isnan(peaks[ARRIVAL]):
            peaks[ARRIVAL] = time + h * (arrival_m - before) / (now[X] - before)
