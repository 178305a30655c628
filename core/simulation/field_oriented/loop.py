"""The closed loop of control, machines and train, integrated with a fixed step by the rule of Runge and Kutta.

Energies are states like any other, so that both balances come from the same stages. The step is fixed, as the
control's limits switch within it at instants that an adaptive step would search for again and again.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.line_power import line_power
from railjoule.core.simulation.field_oriented.control import ReferencePoint, control_at, reference_between
from railjoule.core.simulation.field_oriented.plant import (
    Plant,
    State,
    electric_powers,
    machine_rates,
    train_motion,
)
from railjoule.core.simulation.field_oriented.reference import Reference

(
    POSITION, SPEED, CURRENT_D, CURRENT_Q, FLUX_D, FLUX_Q,
    ASSUMED_FLUX, INTEGRAL_D, INTEGRAL_Q, REQUESTED_ACCELERATION, OBSERVED_SPEED, OBSERVED_LOAD,
    CLOCK, ELAPSED, FLUX_CURRENT_REDUCTION,
    INPUT, SHAFT, STATOR, ROTOR, MAGNETISING, IRON, DRAWN, RETURNED, MECHANICAL, GEAR, RUNNING, CURVE, CLIMB,
    STATES,
) = range(29)  # fmt: skip
"""Columns of the integrated states: train and one machine, the control's own, its clocks, and from INPUT on energies of
all machines and of the train [J]."""
VOLTAGE, TORQUE, LINE_POWER, CURRENT_LIMITED, VOLTAGE_LIMITED, OUTPUTS = range(6)
"""Columns of further samples: amplitude of the voltage [V], torque of a machine [N m], power [W], and 1 where a limit
was active, else 0."""
CURRENT_REACHED, TORQUE_CURRENT_REACHED, VOLTAGE_REACHED, LAG_REACHED = range(4)
"""Columns of the extremes: current of a phase and its part across the flux [A], voltage of a phase [V], distance behind
the plan [m]."""

# Time between two independent errors of the measured speed, which goes straight from one to the next; assumed. A
# shorter one moves the noise to frequencies that the observer damps more. It is no step of the integration, so a finer
# step changes no noise.
NOISE_STEP_S = 0.001
# No machine and no train comes near these: beyond them the loop has left its stability, or the states are no numbers.
DIVERGED_A, DIVERGED_MS = 1e6, 1e4
# Within these bounds a train stands at the end, which the loop approaches but never reaches. Half of these cost about
# ln 2 / wp of magnetised waiting, 0.07 s at 10 rad/s; the second is the error of the stop that is left.
STANDING_MS, STANDING_M = 1e-3, 2e-3

DONE, TOO_LONG, UNSTABLE = range(3)


# Only this kernel touches arrays. Those that it calls take and return numbers, which stay in registers once they are
# inlined; an array among their arguments would cost an atomic count of its references at each call, half as much time
# again.
@njit(cache=True, error_model="numpy")
def fill_rates(
    plant: Plant,
    ground: tuple[float, float, float],
    reference: Reference,
    noise_ms: float,
    states: FloatArray,
    rates: FloatArray,
    outputs: FloatArray,
) -> None:
    """Fill the rates of all states, of shape (STATES,), and the outputs, of shape (OUTPUTS,)."""
    state = State(
        position_m=states[POSITION],
        speed_ms=states[SPEED],
        current=complex(states[CURRENT_D], states[CURRENT_Q]),
        flux=complex(states[FLUX_D], states[FLUX_Q]),
        assumed_flux_vs=states[ASSUMED_FLUX],
        integral=complex(states[INTEGRAL_D], states[INTEGRAL_Q]),
        requested_acceleration_ms2=states[REQUESTED_ACCELERATION],
        observed_speed_ms=states[OBSERVED_SPEED],
        observed_load_n=states[OBSERVED_LOAD],
        flux_current_reduction_a=states[FLUX_CURRENT_REDUCTION],
    )
    samples, last = reference.samples, reference.samples.shape[0] - 1
    index = min(states[CLOCK] / reference.step_s, last + 0.0)
    # written so that a clock that is not a number reads as 0: a wild index would crash before stability is tested
    if not index > 0.0:
        index = 0.0
    k = int(index)
    sample = ReferencePoint(samples[k, 0], samples[k, 1], samples[k, 2], samples[k, 3], samples[k, 4], samples[k, 5])
    point = reference_between(sample, samples[min(k + 1, last), 3], (index - k) * reference.step_s, reference.step_s)
    control = control_at(plant, point, state.speed_ms + noise_ms, state)
    current, flux, torque = machine_rates(plant, state, control.voltage, control.frame_rads)
    acceleration, mechanical, gear, running, curve, climb = train_motion(plant, ground, state.speed_ms, torque)
    power, shaft, stator, rotor, magnetising, iron = electric_powers(
        plant, state, control.voltage, control.frame_rads, torque
    )

    rates[POSITION], rates[SPEED] = state.speed_ms, acceleration
    rates[CURRENT_D], rates[CURRENT_Q] = current.real, current.imag
    rates[FLUX_D], rates[FLUX_Q] = flux.real, flux.imag
    rates[ASSUMED_FLUX], rates[FLUX_CURRENT_REDUCTION] = control.flux_rate, control.reduction_rate
    rates[INTEGRAL_D], rates[INTEGRAL_Q] = control.integral_rate.real, control.integral_rate.imag
    rates[REQUESTED_ACCELERATION] = control.acceleration_rate
    rates[OBSERVED_SPEED], rates[OBSERVED_LOAD] = control.speed_rate, control.load_rate
    rates[CLOCK], rates[ELAPSED] = control.clock_rate, 1.0
    rates[INPUT], rates[SHAFT], rates[STATOR], rates[ROTOR] = power, shaft, stator, rotor
    rates[MAGNETISING], rates[IRON] = magnetising, iron
    # drawn and generated energy are integrated separately: the supply takes back only part of the latter
    rates[DRAWN], rates[RETURNED] = max(power, 0.0), max(-power, 0.0)
    rates[MECHANICAL], rates[GEAR] = mechanical, gear
    rates[RUNNING], rates[CURVE], rates[CLIMB] = running, curve, climb

    outputs[VOLTAGE] = math.hypot(control.voltage.real, control.voltage.imag)
    outputs[TORQUE] = torque
    outputs[LINE_POWER] = line_power(power, plant.recuperation_factor)
    outputs[CURRENT_LIMITED] = 1.0 if control.is_current_limited else 0.0
    outputs[VOLTAGE_LIMITED] = 1.0 if control.is_voltage_limited else 0.0


@njit(cache=True, error_model="numpy", nogil=True)
def run_plant(
    plant: Plant,
    border_m: FloatArray,
    ground: FloatArray,
    reference: Reference,
    noise_ms: FloatArray,
    start: FloatArray,
    h: float,
    end_m: float,
    arrival_m: float,
    steps_per_sample: int,
    states: FloatArray,
    outputs: FloatArray,
    extremes: FloatArray,
) -> tuple[int, int, float]:
    """Run until the train stands at its end.

    Parameters
    ----------
    plant : Plant
        Train, machines and control.
    border_m : array of shape (m + 1,)
        Borders of the cells of the line [m].
    ground : array of shape (m, 3)
        Gradient force, curve force and quadratic resistance of each cell [N, N, N s2/m2].
    reference : Reference
        The motion that the train follows.
    noise_ms : array
        Errors of the measured speed [m/s], one for each `NOISE_STEP_S`, repeated at the end.
    start : array of shape (STATES,)
        The states at the reference's first sample.
    h : float
        Step of the integration [s].
    end_m, arrival_m : float
        End of the reference, and the position whose passing counts as the arrival [m].
    steps_per_sample : int
        Steps from one sample to the next.
    states, outputs : array of shape (k, STATES), (k, OUTPUTS)
        Filled with the samples; limits are those of any step since the sample before.
    extremes : array of shape (2, 4)
        Least and greatest values of all steps, widened from its initial values.

    Returns
    -------
    ending : int
        DONE, TOO_LONG or UNSTABLE.
    sample_count : int
        How many samples are filled.
    arrival_s : float
        Time from the start to the arrival [s]; NaN where the train does not arrive.
    """
    now, output = start.copy(), np.empty(OUTPUTS)
    stages = np.empty(STATES), np.empty(STATES), np.empty(STATES)
    arrival_s = math.nan
    limited_current = limited_voltage = 0.0
    cell, kept, step = 0, 0, 0
    reference_end_s = (reference.samples.shape[0] - 1) * reference.step_s
    while True:
        # a product, not a sum of steps, which would drift by its rounding
        time = step * h
        current = math.hypot(now[CURRENT_D], now[CURRENT_Q])
        # negated, as every comparison with NaN is false
        if not (current < DIVERGED_A and abs(now[SPEED]) < DIVERGED_MS):
            return UNSTABLE, kept, arrival_s
        cell = cell_at(border_m, now[POSITION], cell)
        forces = ground[cell, 0], ground[cell, 1], ground[cell, 2]
        noise, noise_change = noise_at(noise_ms, time)
        fill_rates(plant, forces, reference, noise, now, stages[0], output)
        limited_current = max(limited_current, output[CURRENT_LIMITED])
        limited_voltage = max(limited_voltage, output[VOLTAGE_LIMITED])
        lag = planned_position_m(reference.planned_m, time / reference.step_s) - now[POSITION]
        widen(extremes, CURRENT_REACHED, current)
        widen(extremes, TORQUE_CURRENT_REACHED, now[CURRENT_Q])
        widen(extremes, VOLTAGE_REACHED, output[VOLTAGE])
        widen(extremes, LAG_REACHED, lag)
        # a nanosecond of rounding, in a clock that is the sum of all steps
        is_over = now[CLOCK] >= reference_end_s - 1e-9
        is_there = abs(now[SPEED]) < STANDING_MS and abs(now[POSITION] - end_m) < STANDING_M
        # at its end, or beyond it, where it overran
        stands = is_over and (is_there or (now[SPEED] <= 0.0 and now[POSITION] >= end_m))
        full = kept == states.shape[0] - 1
        if step % steps_per_sample == 0 or stands or full:
            states[kept], outputs[kept] = now, output
            outputs[kept, CURRENT_LIMITED], outputs[kept, VOLTAGE_LIMITED] = limited_current, limited_voltage
            limited_current = limited_voltage = 0.0
            kept += 1
        if stands or full:
            return DONE if stands else TOO_LONG, kept, arrival_s
        before = now[POSITION]
        rk4_step(plant, forces, reference, (noise, noise_change), h, now, stages, output)
        step += 1
        # the first passing counts: a train that rolls back and comes again has arrived before
        if before < arrival_m <= now[POSITION] and math.isnan(arrival_s):
            arrival_s = time + h * (arrival_m - before) / (now[POSITION] - before)


@njit(cache=True, error_model="numpy", forceinline=True)
def rk4_step(
    plant: Plant,
    ground: tuple[float, float, float],
    reference: Reference,
    noise: tuple[float, float],
    h: float,
    now: FloatArray,
    stages: tuple[FloatArray, FloatArray, FloatArray],
    outputs: FloatArray,
) -> None:
    """Advance `now` by one step of time, from the rates at its start in the first of the stages.

    The others are memory, and the outputs are overwritten. The ground stays that of the start: forces that change
    within a step would cost the rule its order anyhow, and a step of a millisecond is a few centimetres.
    """
    rate_sum, rates, trial = stages
    noise_ms, noise_change_ms = noise
    half_way = noise_ms + 0.5 * h / NOISE_STEP_S * noise_change_ms
    afterwards = noise_ms + h / NOISE_STEP_S * noise_change_ms
    # loops, not expressions of arrays: those allocate, and are a third slower here
    for i in range(STATES):
        trial[i] = now[i] + 0.5 * h * rate_sum[i]
    fill_rates(plant, ground, reference, half_way, trial, rates, outputs)
    for i in range(STATES):
        trial[i] = now[i] + 0.5 * h * rates[i]
        rate_sum[i] += 2.0 * rates[i]
    fill_rates(plant, ground, reference, half_way, trial, rates, outputs)
    for i in range(STATES):
        trial[i] = now[i] + h * rates[i]
        rate_sum[i] += 2.0 * rates[i]
    fill_rates(plant, ground, reference, afterwards, trial, rates, outputs)
    for i in range(STATES):
        now[i] += h / 6.0 * (rate_sum[i] + rates[i])


@njit(cache=True, error_model="numpy", forceinline=True)
def cell_at(border_m: FloatArray, position_m: float, cell: int) -> int:
    """Return the cell of a position [m], found from the last one: a step rarely passes more than one border."""
    last = border_m.shape[0] - 2
    while cell < last and position_m >= border_m[cell + 1]:
        cell += 1
    while cell > 0 and position_m < border_m[cell]:
        cell -= 1
    return cell


@njit(cache=True, error_model="numpy", forceinline=True)
def noise_at(noise_ms: FloatArray, time_s: float) -> tuple[float, float]:
    """Return the error of the measured speed [m/s] at a time [s], and its change over a `NOISE_STEP_S`."""
    instant = time_s / NOISE_STEP_S
    drawn = int(instant)
    first, second = noise_ms[drawn % noise_ms.shape[0]], noise_ms[(drawn + 1) % noise_ms.shape[0]]
    return first + (instant - drawn) * (second - first), second - first


@njit(cache=True, error_model="numpy", forceinline=True)
def planned_position_m(planned_m: FloatArray, instant: float) -> float:
    """Return the plan's own position [m] at a time in steps of its samples; at its end where it is over."""
    index = min(instant, planned_m.shape[0] - 1.0)
    k = min(int(index), planned_m.shape[0] - 2)
    position: float = planned_m[k] + (index - k) * (planned_m[k + 1] - planned_m[k])
    return position


@njit(cache=True, error_model="numpy", forceinline=True)
def widen(extremes: FloatArray, column: int, value: float) -> None:
    """Include a value in a column of least and greatest values."""
    extremes[0, column] = min(extremes[0, column], value)
    extremes[1, column] = max(extremes[1, column], value)
