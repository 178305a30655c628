"""The closed loop of control, machines and train, integrated with a fixed step by the rule of Runge and Kutta.

Energies are states like any other, so that both accounts come from the same stages. The step is fixed, as the
control's limits switch within it at instants that an adaptive step would search for again and again.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.line_power import line_power
from railjoule.core.simulation.field_oriented.control import (
    CurrentRequest,
    FluxRates,
    PositionRates,
    ReferencePoint,
    ReferenceSamples,
    VoltageCommand,
    assumed_machine,
    clock_rate,
    current_control,
    flux_control,
    position_control,
    reference_between,
    requested_currents,
    target_position_m,
)
from railjoule.core.simulation.field_oriented.plant import (
    Ground,
    MachineRates,
    Plant,
    Powers,
    Track,
    TrainForces,
    machine_rates,
    powers,
    train_forces,
)
from railjoule.core.simulation.field_oriented.states import (
    ASSUMED_FLUX,
    CLIMB,
    CLOCK,
    CURRENT_D,
    CURRENT_LIMITED,
    CURRENT_Q,
    CURVE,
    DRAWN,
    ELAPSED,
    FLUX_CURRENT_REDUCTION,
    FLUX_D,
    FLUX_Q,
    GEAR,
    INPUT,
    INTEGRAL_D,
    INTEGRAL_Q,
    IRON,
    LINE_POWER,
    MAGNETISING,
    MECHANICAL,
    OBSERVED_LOAD,
    OBSERVED_SPEED,
    OUTPUTS,
    POSITION,
    REFERENCE_ACCELERATION,
    REFERENCE_FLUX,
    REFERENCE_FLUX_RATE,
    REFERENCE_JERK,
    REFERENCE_POSITION,
    REFERENCE_SPEED,
    REQUESTED_ACCELERATION,
    RETURNED,
    ROTOR,
    RUNNING,
    SHAFT,
    SPEED,
    STATES,
    STATOR,
    TORQUE,
    VOLTAGE,
    VOLTAGE_LIMITED,
    State,
)  # fmt: skip

# Time between two independent errors of the measured speed, which goes straight from one to the next; assumed. A
# shorter one moves the noise to frequencies that the observer damps more. It is no step of the integration, so a finer
# step changes no noise.
NOISE_STEP_S = 0.001
# No machine and no train comes near these: beyond them the loop has left its stability, or the states are no numbers.
DIVERGED_A, DIVERGED_MS = 1e6, 1e4
# What counts as standing at the end, which the loop approaches without ever reaching it. Half of these cost about
# ln 2 / wp of magnetised waiting, 0.07 s at 10 rad/s; the second is the error of the stop that is left.
STANDING_MS, STANDING_M = 1e-3, 2e-3

DONE, TOO_LONG, UNSTABLE = range(3)


class Extremes(NamedTuple):
    """What all steps reached, kept samples or not.

    Parameters
    ----------
    current_a, max_torque_current_a, min_torque_current_a : float
        Largest current of a phase, extremes of its part across the flux [A].
    voltage_v : float
        Largest amplitude of the voltage of a phase [V].
    max_lag_m, min_lag_m : float
        How far the train was behind its plan at most and at least, negative ahead of it [m].
    """

    current_a: float
    max_torque_current_a: float
    min_torque_current_a: float
    voltage_v: float
    max_lag_m: float
    min_lag_m: float


class RunSettings(NamedTuple):
    """How far a run goes, and what is kept of it.

    Parameters
    ----------
    time_step_s : float
        Step of the integration [s].
    end_m, arrival_m : float
        Where the reference ends, and the position whose passing counts as the arrival [m].
    steps_per_sample : int
        Steps from one sample to the next.
    """

    time_step_s: float
    end_m: float
    arrival_m: float
    steps_per_sample: int


class Outcome(NamedTuple):
    """How a run ended.

    Parameters
    ----------
    ending : int
        DONE, TOO_LONG or UNSTABLE.
    sample_count : int
        How many samples are filled.
    extremes : Extremes
        Of all steps.
    arrival_s : float
        Time from the start to the arrival [s]; not a number where the train does not arrive.
    """

    ending: int
    sample_count: int
    extremes: Extremes
    arrival_s: float


class Changes(NamedTuple):
    """All that changes at one instant.

    Parameters
    ----------
    clock_rate : float
        How fast the clock of the reference goes, 0 to 1.
    request, voltage : CurrentRequest, VoltageCommand
        What the currents should be, and the voltage that makes them so.
    machine, train : MachineRates, TrainForces
        How machine and train answer.
    position, flux : PositionRates, FluxRates
        How the control's own states change.
    powers : Powers
        Where the power goes.
    """

    clock_rate: float
    request: CurrentRequest
    voltage: VoltageCommand
    machine: MachineRates
    train: TrainForces
    position: PositionRates
    flux: FluxRates
    powers: Powers


class Stages(NamedTuple):
    """Memory of one step: rates at a stage, their weighted sum so far, and the state where they are taken."""

    rates: FloatArray
    rate_sum: FloatArray
    states: FloatArray


# Only this kernel touches arrays. Those that it calls take and return numbers by name, which stay in registers once
# they are inlined; an array among their arguments would cost an atomic count of its references at each call, half as
# much time again.
@njit(cache=True, error_model="numpy")
def fill_rates(
    plant: Plant,
    track: Track,
    reference: ReferenceSamples,
    cell: int,
    noise_ms: float,
    states: FloatArray,
    rates: FloatArray,
    outputs: FloatArray,
) -> None:
    """Fill the rates of all states, of shape (STATES,), and the outputs, of shape (OUTPUTS,)."""
    state = State(
        position_m=states[POSITION],
        speed_ms=states[SPEED],
        current_d=states[CURRENT_D],
        current_q=states[CURRENT_Q],
        flux_d=states[FLUX_D],
        flux_q=states[FLUX_Q],
        assumed_flux_vs=states[ASSUMED_FLUX],
        integral_d=states[INTEGRAL_D],
        integral_q=states[INTEGRAL_Q],
        requested_acceleration_ms2=states[REQUESTED_ACCELERATION],
        observed_speed_ms=states[OBSERVED_SPEED],
        observed_load_n=states[OBSERVED_LOAD],
        clock_s=states[CLOCK],
        flux_current_reduction_a=states[FLUX_CURRENT_REDUCTION],
    )
    measured = state.speed_ms + noise_ms
    last = reference.samples.shape[0] - 1
    index = min(state.clock_s / reference.step_s, last + 0.0)
    # written so that a clock that is not a number reads as 0: `has_diverged` finds it, a wild index would crash before
    if not index > 0.0:
        index = 0.0
    k = int(index)
    sample = ReferencePoint(
        position_m=reference.samples[k, REFERENCE_POSITION],
        speed_ms=reference.samples[k, REFERENCE_SPEED],
        acceleration_ms2=reference.samples[k, REFERENCE_ACCELERATION],
        jerk_ms3=reference.samples[k, REFERENCE_JERK],
        flux_vs=reference.samples[k, REFERENCE_FLUX],
        flux_rate_v=reference.samples[k, REFERENCE_FLUX_RATE],
    )
    next_jerk = reference.samples[min(k + 1, last), REFERENCE_JERK]
    point = reference_between(sample, next_jerk, (index - k) * reference.step_s, reference.step_s)
    ground = Ground(
        gradient_force_n=track.gradient_force_n[cell],
        curve_force_n=track.curve_force_n[cell],
        resistance_quadratic=track.resistance_quadratic[cell],
    )
    change = changes(plant, point, ground, measured, state)

    rates[POSITION], rates[SPEED] = state.speed_ms, change.train.acceleration_ms2
    rates[CURRENT_D], rates[CURRENT_Q] = change.machine.current_d, change.machine.current_q
    rates[FLUX_D], rates[FLUX_Q] = change.machine.flux_d, change.machine.flux_q
    rates[ASSUMED_FLUX] = change.flux.assumed_flux
    rates[INTEGRAL_D], rates[INTEGRAL_Q] = change.voltage.integral_rate_d, change.voltage.integral_rate_q
    rates[REQUESTED_ACCELERATION] = change.position.requested_acceleration
    rates[OBSERVED_SPEED], rates[OBSERVED_LOAD] = change.position.observed_speed, change.position.observed_load
    rates[CLOCK], rates[ELAPSED] = change.clock_rate, 1.0
    rates[FLUX_CURRENT_REDUCTION] = change.flux.flux_current_reduction
    power = change.powers
    rates[INPUT], rates[SHAFT] = power.input_w, power.shaft_w
    rates[STATOR], rates[ROTOR] = power.stator_w, power.rotor_w
    rates[MAGNETISING], rates[IRON] = power.magnetising_w, power.iron_w
    # drawn and generated energy are integrated apart: the supply takes back only part of what is generated
    rates[DRAWN], rates[RETURNED] = max(power.input_w, 0.0), max(-power.input_w, 0.0)
    rates[MECHANICAL], rates[GEAR] = power.mechanical_w, power.gear_w
    rates[RUNNING], rates[CURVE], rates[CLIMB] = power.running_w, power.curve_w, power.climb_w

    request, voltage = change.request, change.voltage
    outputs[VOLTAGE] = math.hypot(voltage.voltage_d, voltage.voltage_q)
    outputs[TORQUE] = change.machine.torque_nm
    outputs[LINE_POWER] = line_power(power.input_w, plant.recuperation_factor)
    # a torque that stops at the pull-out current is limited by the voltage, though no voltage is cut off
    by_current = request.is_limited and abs(request.torque_current_a) < request.pull_out_current_a
    outputs[CURRENT_LIMITED] = 1.0 if by_current else 0.0
    outputs[VOLTAGE_LIMITED] = 1.0 if voltage.is_limited or (request.is_limited and not by_current) else 0.0


@njit(cache=True, error_model="numpy", forceinline=True)
def changes(plant: Plant, point: ReferencePoint, ground: Ground, measured_ms: float, state: State) -> Changes:
    """Return how control, machine and train change; the control sees a measured speed [m/s] alone."""
    clock = clock_rate(plant, point, state)
    target = target_position_m(plant, point, clock)
    assumed = assumed_machine(plant, state, measured_ms)
    request = requested_currents(plant, assumed, point, state)
    voltage = current_control(plant, assumed, request, state)
    u_d, u_q, frame = voltage.voltage_d, voltage.voltage_q, assumed.frame_rads
    machine = machine_rates(plant, state, u_d, u_q, frame)
    train = train_forces(plant, ground, state.speed_ms, machine.torque_nm)
    is_limited = request.is_limited or voltage.is_limited
    return Changes(
        clock_rate=clock,
        request=request,
        voltage=voltage,
        machine=machine,
        train=train,
        position=position_control(plant, assumed, is_limited, target, measured_ms, state),
        flux=flux_control(plant, assumed, voltage.excess, state),
        powers=powers(plant, state, (u_d, u_q), frame, machine.torque_nm, train),
    )


@njit(cache=True, error_model="numpy", nogil=True)
def run_plant(
    plant: Plant,
    track: Track,
    reference: ReferenceSamples,
    noise_ms: FloatArray,
    start: FloatArray,
    settings: RunSettings,
    states: FloatArray,
    outputs: FloatArray,
) -> Outcome:
    """Run until the train stands at its end.

    Parameters
    ----------
    plant : Plant
        Train, machines and control.
    track, reference : Track, ReferenceSamples
        What the train runs on, and what it follows.
    noise_ms : array
        Errors of the measured speed [m/s], one for each `NOISE_STEP_S`, repeated when they are used up.
    start : array of shape (STATES,)
        The states at the reference's first sample.
    settings : RunSettings
        Step, end and samples.
    states, outputs : array of shape (k, STATES), (k, OUTPUTS)
        Filled with the samples; limits at work are those of any step since the sample before.
    """
    now, output = start.copy(), np.empty(OUTPUTS)
    stages = Stages(np.empty(STATES), np.empty(STATES), np.empty(STATES))
    extremes = Extremes(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    arrival_s = math.nan
    limited_current = limited_voltage = 0.0
    cell, kept, step = 0, 0, 0
    h, reference_end_s = settings.time_step_s, (reference.samples.shape[0] - 1) * reference.step_s
    while True:
        # a product, not a sum of steps, which would drift by its rounding
        time = step * h
        if has_diverged(now[CURRENT_D], now[CURRENT_Q], now[SPEED]):
            return Outcome(UNSTABLE, kept, extremes, arrival_s)
        cell = cell_at(track.border_m, now[POSITION], cell)
        noise, noise_change = noise_at(noise_ms, time)
        fill_rates(plant, track, reference, cell, noise, now, stages.rate_sum, output)
        limited_current = max(limited_current, output[CURRENT_LIMITED])
        limited_voltage = max(limited_voltage, output[VOLTAGE_LIMITED])
        lag = planned_position_m(reference.planned_m, time / reference.step_s) - now[POSITION]
        extremes = with_step(extremes, now[CURRENT_D], now[CURRENT_Q], output[VOLTAGE], lag)
        # a nanosecond of rounding, in a clock that is the sum of all steps
        is_over = now[CLOCK] >= reference_end_s - 1e-9
        stands = is_over and has_stopped(now[POSITION], now[SPEED], settings.end_m)
        full = kept == states.shape[0] - 1
        if step % settings.steps_per_sample == 0 or stands or full:
            states[kept], outputs[kept] = now, output
            outputs[kept, CURRENT_LIMITED], outputs[kept, VOLTAGE_LIMITED] = limited_current, limited_voltage
            limited_current = limited_voltage = 0.0
            kept += 1
        if stands or full:
            return Outcome(DONE if stands else TOO_LONG, kept, extremes, arrival_s)
        before = now[POSITION]
        rk4_step(plant, track, reference, cell, (noise, noise_change), h, now, stages, output)
        step += 1
        # the first passing counts: a train that rolls back and comes again has arrived before
        if before < settings.arrival_m <= now[POSITION] and math.isnan(arrival_s):
            arrival_s = time + h * (settings.arrival_m - before) / (now[POSITION] - before)


@njit(cache=True, error_model="numpy", forceinline=True)
def rk4_step(
    plant: Plant,
    track: Track,
    reference: ReferenceSamples,
    cell: int,
    noise: tuple[float, float],
    h: float,
    now: FloatArray,
    stages: Stages,
    outputs: FloatArray,
) -> None:
    """Go on by one step of time, with the rates at its start in `stages.rate_sum`; the outputs are overwritten.

    The cell stays that of the start: forces that change within a step would cost the rule its order anyhow, and a
    step of a millisecond is a few centimetres.
    """
    rates, rate_sum, trial = stages
    noise_ms, noise_change_ms = noise
    half_way = noise_ms + 0.5 * h / NOISE_STEP_S * noise_change_ms
    afterwards = noise_ms + h / NOISE_STEP_S * noise_change_ms
    # loops, not expressions of arrays: those allocate, and are a third slower here
    for i in range(STATES):
        trial[i] = now[i] + 0.5 * h * rate_sum[i]
    fill_rates(plant, track, reference, cell, half_way, trial, rates, outputs)
    for i in range(STATES):
        trial[i] = now[i] + 0.5 * h * rates[i]
        rate_sum[i] += 2.0 * rates[i]
    fill_rates(plant, track, reference, cell, half_way, trial, rates, outputs)
    for i in range(STATES):
        trial[i] = now[i] + h * rates[i]
        rate_sum[i] += 2.0 * rates[i]
    fill_rates(plant, track, reference, cell, afterwards, trial, rates, outputs)
    for i in range(STATES):
        now[i] += h / 6.0 * (rate_sum[i] + rates[i])


@njit(cache=True, error_model="numpy", forceinline=True)
def has_diverged(current_d: float, current_q: float, speed_ms: float) -> bool:
    """Return whether currents [A] or speed [m/s] have left all bounds, or are not numbers."""
    # negated, as every comparison with what is not a number is false
    return not (math.hypot(current_d, current_q) < DIVERGED_A and abs(speed_ms) < DIVERGED_MS)


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
    """Return the error of the measured speed [m/s] at a time [s], and how much it changes over a `NOISE_STEP_S`."""
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
def with_step(extremes: Extremes, current_d: float, current_q: float, voltage_v: float, lag_m: float) -> Extremes:
    """Return extremes with one more step among them."""
    return Extremes(
        current_a=max(extremes.current_a, math.hypot(current_d, current_q)),
        max_torque_current_a=max(extremes.max_torque_current_a, current_q),
        min_torque_current_a=min(extremes.min_torque_current_a, current_q),
        voltage_v=max(extremes.voltage_v, voltage_v),
        max_lag_m=max(extremes.max_lag_m, lag_m),
        min_lag_m=min(extremes.min_lag_m, lag_m),
    )


@njit(cache=True, error_model="numpy", forceinline=True)
def has_stopped(position_m: float, speed_ms: float, end_m: float) -> bool:
    """Return whether a train whose reference is over stands: at its end, or beyond it, where it overran."""
    is_there = abs(speed_ms) < STANDING_MS and abs(position_m - end_m) < STANDING_M
    return is_there or (speed_ms <= 0.0 and position_m >= end_m)
