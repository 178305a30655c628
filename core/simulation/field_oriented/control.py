"""Position control, load observer and current control of induction machines under field orientation.

Primes are for what the control assumes or measures. It lets its frame turn with wc = p w' + Rr' iq / psi'.

Position control makes of the reference x* a requested acceleration ad with the closed loop (1 + s/wp)^-3,

    dad/dt = wp^3 (x* - x) - 3 wp^2 v' - 3 wp ad,

and an observer, which also smooths the measured speed, adds the force that the train needs beside its own inertia.
The pre-compensator cancels the lag of the loop: x* = x + (3/wp) v + (3/wp^2) a + (1/wp^3) j of the reference.

Currents have proportional-integral control with decoupling. Where the voltage does not suffice, it keeps its
direction, the integrals do not grow by what is cut off, the current along the flux is reduced, and the request for the
current across it stays within the pull-out torque. Where a limit holds the train back, the clock of the reference is
slowed down, so that it goes on along its plan, later, and but for catching up the last metre no faster than planned.

Source: Ftorek et al. 2025, Figure 1; Vittek et al. 2017, "Position tracking systems for AC drives employing forced
dynamics control".
"""

import math
from typing import NamedTuple

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.simulation.field_oriented.plant import Plant, shaft_torque_nm, wheel_force_n
from railjoule.core.simulation.field_oriented.states import State

# The gains below are assumed, as the paper prints none of them: each is a time constant of its own loop, far enough
# from its neighbours' that the loops do not disturb one another.

# Currents follow with a time constant of 2 ms, about what an inverter that switches at 1 kHz reaches: a tenth of its
# frequency. It may not be much faster with steps of 1 to 2 ms: the rule of Runge and Kutta bears 2.8 over the step.
CURRENT_BANDWIDTH_RADS = 500.0
# The position loop takes torque for immediate. Its open loop wp^2 (3 s + wp) / (s^2 (s + 3 wp)) crosses 1 at wp with a
# phase margin of 53 degrees, of which currents that are 25 times faster take 2; with a ratio of 5 they would take 11.
CURRENT_BANDWIDTH_RATIO = 25.0
# The gain of the integral over the square of the bandwidth. Poles of s^2 + s + g are real below g = 0.25: 0.1 puts the
# slow one at 0.11 of the bandwidth, so a wrong resistance is corrected in about 20 ms and no current overshoots.
INTEGRAL_GAIN = 0.1
# Double pole of the load observer over that of the position loop. Slower, a change of gradient shows in the
# tracking error; faster, noise of the measured speed reaches the torque: its gain grows with the square.
OBSERVER_RATIO = 3.0
# How fast a requested acceleration beyond the limits is brought back to the feasible one, over the bandwidth of the
# position loop: well within the loop's own answer, else the train overshoots its plan once the limit is left.
UNWINDING_RATIO = 5.0
# Rate at which the current along the flux is reduced, in driving current limits a second where the control requests
# twice the voltage there is, and the time in which the reduction fades. In balance it is 20 x 0.2 = 4 current limits
# times the missing fraction of the voltage: 1 % too little takes 4 % of the limit. A higher rate takes more for the
# same lack; a longer time keeps the flux weak after the lack has passed.
WEAKENING_RATE, WEAKENING_TIME_S = 20.0, 0.2
# Lag behind the reference at which its clock becomes slower, and how much more of it stops the clock. Without limits
# at work the lag stays below half of the first, so the clock runs true; both together bound what a train that was
# held back has to catch up above its plan's speed.
ALLOWED_LAG_M, STOPPING_LAG_M = 0.1, 1.0
# Floor of the assumed flux over the rated one, against a division by zero before the machine is magnetised.
SMALLEST_FLUX_FRACTION = 0.01


class ReferenceSamples(NamedTuple):
    """The reference as arrays.

    Parameters
    ----------
    samples : array of shape (m, 6)
        Position, speed, acceleration and jerk of the reference, flux linkage and its rate [m, ..., V s, V].
    planned_m : array of shape (m,)
        The plan's own position at the same times [m].
    step_s : float
        Time between two samples of both [s].
    """

    samples: FloatArray
    planned_m: FloatArray
    step_s: float


class ReferencePoint(NamedTuple):
    """The reference at one instant; all as in `ReferenceSamples`."""

    position_m: float
    speed_ms: float
    acceleration_ms2: float
    jerk_ms3: float
    flux_vs: float
    flux_rate_v: float


class AssumedMachine(NamedTuple):
    """A machine as its control sees it.

    Parameters
    ----------
    rotor_resistance_ohm, flux_vs : float
        Rr' and psi' [ohm, V s].
    rotor_rads, frame_rads : float
        Electrical angular frequencies of the rotor as measured, and of the frame [rad/s].
    torque_per_current_nm : float
        Torque of one ampere across the flux [N m/A].
    """

    rotor_resistance_ohm: float
    flux_vs: float
    rotor_rads: float
    frame_rads: float
    torque_per_current_nm: float


class CurrentRequest(NamedTuple):
    """What current control has to make.

    Parameters
    ----------
    flux_current_a, torque_current_a : float
        Currents along and across the assumed flux, within their limits [A].
    pull_out_current_a : float
        Where the voltage gives its largest torque [A].
    is_limited : bool
        Whether more torque was requested than the limits allow.
    """

    flux_current_a: float
    torque_current_a: float
    pull_out_current_a: float
    is_limited: bool


class VoltageCommand(NamedTuple):
    """What current control makes.

    Parameters
    ----------
    voltage_d, voltage_q : float
        Voltages along and across the assumed flux [V].
    integral_rate_d, integral_rate_q : float
        Rates of the integrals [A/s2].
    is_limited : bool
        Whether the control requested more than there is.
    excess : float
        By which fraction of the limit it requested more, at most 1.
    """

    voltage_d: float
    voltage_q: float
    integral_rate_d: float
    integral_rate_q: float
    is_limited: bool
    excess: float


class PositionRates(NamedTuple):
    """Rates of position control and load observer.

    Parameters
    ----------
    requested_acceleration, observed_speed, observed_load : float
        Rates of the states of these names [m/s3, m/s2, N/s].
    """

    requested_acceleration: float
    observed_speed: float
    observed_load: float


class FluxRates(NamedTuple):
    """Rates of the control's flux.

    Parameters
    ----------
    assumed_flux, flux_current_reduction : float
        Rates of the states of these names [V, A/s].
    """

    assumed_flux: float
    flux_current_reduction: float


@njit(cache=True, error_model="numpy", forceinline=True)
def reference_between(sample: ReferencePoint, next_jerk_ms3: float, since_s: float, step_s: float) -> ReferencePoint:
    """Return the reference between two samples, a time [s] after the first one.

    Position and speed go on from the sample before with its jerk. Acceleration and jerk, which the pre-compensator
    uses, change linearly to the next sample: steps of theirs every few milliseconds would excite the currents.
    """
    a, j, since = sample.acceleration_ms2, sample.jerk_ms3, since_s
    jerk = j + (next_jerk_ms3 - j) * since / step_s
    return ReferencePoint(
        position_m=sample.position_m + (sample.speed_ms + (0.5 * a + j * since / 6.0) * since) * since,
        speed_ms=sample.speed_ms + (a + 0.5 * j * since) * since,
        acceleration_ms2=a + 0.5 * (j + jerk) * since,
        jerk_ms3=jerk,
        flux_vs=sample.flux_vs,
        flux_rate_v=sample.flux_rate_v,
    )


@njit(cache=True, error_model="numpy", forceinline=True)
def clock_rate(plant: Plant, point: ReferencePoint, state: State) -> float:
    """Return how fast the clock of the reference goes, 0 to 1: slower the farther the train is behind."""
    # without the pre-compensator the loop lags by 3 / wp by design, which is no reason to slow the clock
    own_lag = 0.0 if plant.precompensator else 3.0 / plant.bandwidth_rads * state.speed_ms
    rate = 1.0 - (point.position_m - own_lag - state.position_m - ALLOWED_LAG_M) / STOPPING_LAG_M
    return min(max(rate, 0.0), 1.0)


@njit(cache=True, error_model="numpy", forceinline=True)
def target_position_m(plant: Plant, point: ReferencePoint, rate: float) -> float:
    """Return x* [m], ahead of the reference by the lag of the loop, while its clock goes at a rate."""
    if not plant.precompensator:
        return point.position_m
    # on a slowed clock d/dt is rate x d/dclock, so the n-th derivative is smaller by the n-th power of the rate
    wp = plant.bandwidth_rads
    v, a, j = rate * point.speed_ms, rate * rate * point.acceleration_ms2, rate * rate * rate * point.jerk_ms3
    ahead: float = 3.0 / wp * v + 3.0 / (wp * wp) * a + j / (wp * wp * wp)
    return point.position_m + ahead


@njit(cache=True, error_model="numpy", forceinline=True)
def assumed_machine(plant: Plant, state: State, measured_ms: float) -> AssumedMachine:
    """Return what the control makes of its own model and a measured speed [m/s]."""
    resistance = plant.rotor_resistance_factor * plant.rotor_resistance_ohm
    flux = max(state.assumed_flux_vs, SMALLEST_FLUX_FRACTION * plant.rated_flux_vs)
    rotor = plant.pole_pairs * (plant.turns_per_metre * measured_ms)
    return AssumedMachine(
        rotor_resistance_ohm=resistance,
        flux_vs=flux,
        rotor_rads=rotor,
        frame_rads=rotor + resistance * state.current_q / flux,
        torque_per_current_nm=1.5 * plant.pole_pairs * flux,
    )


@njit(cache=True, error_model="numpy", forceinline=True)
def requested_currents(plant: Plant, machine: AssumedMachine, point: ReferencePoint, state: State) -> CurrentRequest:
    """Return the currents that flux and acceleration ask for, within the limits of current and voltage."""
    largest = plant.driving_current_a
    # the rotor equation in its own frame, dpsi/dt = Rr id - (Rr / Lm) psi, solved for the current that makes the flux
    flux_current = point.flux_vs / plant.magnetising_inductance_h + point.flux_rate_v / machine.rotor_resistance_ohm
    flux_current = min(max(flux_current, 0.0), largest) - state.flux_current_reduction_a
    # at most sqrt(1/2) of the limit demagnetises, so that as much is left for torque
    flux_current = max(flux_current, -math.sqrt(0.5) * largest)
    force = plant.assumed_inertia_kg * state.requested_acceleration_ms2 + state.observed_load_n
    requested = (shaft_torque_nm(plant, force) + plant.mechanical_loss_torque_nm) / machine.torque_per_current_nm
    # the flux has the first call on the current, torque gets what the circle leaves
    driving = math.sqrt(max(plant.driving_current_a**2 - flux_current**2, 0.0))
    braking = -math.sqrt(max(plant.braking_current_a**2 - flux_current**2, 0.0))
    # Pull-out. In steady state, without the drop in the stator's resistance, the voltage is wc times the stator's flux:
    # (U / wc)^2 = (Ls iq)^2 + (Ls id + psi)^2, and with psi = Lm id the torque goes with the product of the two
    # brackets. At a given sum of squares the product is largest where both are alike: Ls iq = sqrt(1/2) U / wc. More iq
    # costs more flux than it brings. Neglecting Rs makes the limit a little too high while driving, and matters at
    # low wc only, where the circle of current binds first.
    pull_out = (
        math.sqrt(0.5) * plant.max_phase_voltage_v / (max(abs(machine.frame_rads), 1e-6) * plant.leakage_inductance_h)
    )
    allowed = min(max(requested, braking, -pull_out), driving, pull_out)
    return CurrentRequest(flux_current, allowed, pull_out, requested != allowed)


@njit(cache=True, error_model="numpy", forceinline=True)
def current_bandwidth_rads(plant: Plant) -> float:
    """Return the bandwidth of the current control [rad/s]."""
    return max(CURRENT_BANDWIDTH_RADS, CURRENT_BANDWIDTH_RATIO * plant.bandwidth_rads)


@njit(cache=True, error_model="numpy", forceinline=True)
def current_control(plant: Plant, machine: AssumedMachine, request: CurrentRequest, state: State) -> VoltageCommand:
    """Return the voltage that brings the currents to their request, and the rates of its integrals.

    All terms of the circuit but Ls di/dt are added from the control's own model, so that each current follows
    di/dt = bandwidth x error + integral, without a coupling to the other.
    """
    i_d, i_q, frame = state.current_d, state.current_q, machine.frame_rads
    l_s, fast = plant.leakage_inductance_h, current_bandwidth_rads(plant)
    resistance = plant.stator_resistance_ohm + machine.rotor_resistance_ohm
    flux_decay = machine.rotor_resistance_ohm / plant.magnetising_inductance_h
    error_d, error_q = request.flux_current_a - i_d, request.torque_current_a - i_q
    requested_d = (
        l_s * (fast * error_d + state.integral_d) + resistance * i_d - frame * l_s * i_q - flux_decay * machine.flux_vs
    )
    requested_q = (
        l_s * (fast * error_q + state.integral_q)
        + resistance * i_q
        + frame * l_s * i_d
        + machine.rotor_rads * machine.flux_vs
    )
    limit, amplitude = plant.max_phase_voltage_v, math.hypot(requested_d, requested_q)
    scale = min(1.0, limit / max(amplitude, 1e-9))
    u_d, u_q = scale * requested_d, scale * requested_q
    # the second part takes back what the limit cut off, at the currents' own speed: without it the integrals wind up
    return VoltageCommand(
        voltage_d=u_d,
        voltage_q=u_q,
        integral_rate_d=INTEGRAL_GAIN * fast * fast * error_d + fast * (u_d - requested_d) / l_s,
        integral_rate_q=INTEGRAL_GAIN * fast * fast * error_q + fast * (u_q - requested_q) / l_s,
        is_limited=u_d != requested_d or u_q != requested_q,
        excess=min(max(amplitude / limit - 1.0, 0.0), 1.0),
    )


@njit(cache=True, error_model="numpy", forceinline=True)
def position_control(
    plant: Plant, machine: AssumedMachine, is_limited: bool, target_m: float, measured_ms: float, state: State
) -> PositionRates:
    """Return the rates of the requested acceleration and of the load observer.

    Parameters
    ----------
    plant, machine : Plant, AssumedMachine
        True numbers, and what the control makes of them.
    is_limited : bool
        Whether current or voltage keep the machines from doing what was requested.
    target_m, measured_ms : float
        x* and the measured speed [m, m/s].
    state : State
        Present states.
    """
    wp, wo, inertia = plant.bandwidth_rads, OBSERVER_RATIO * plant.bandwidth_rads, plant.assumed_inertia_kg
    # Friction counts against the motion as if the train ran forward always: at a stand it is part of the load
    # that the observer finds, which takes up every other difference between the assumed force and the true one too.
    torque = machine.torque_per_current_nm * state.current_q - plant.mechanical_loss_torque_nm
    feasible = (wheel_force_n(plant, torque) - state.observed_load_n) / inertia
    error = measured_ms - state.observed_speed_ms
    requested = state.requested_acceleration_ms2
    rate = wp * wp * (wp * (target_m - state.position_m) - 3.0 * state.observed_speed_ms) - 3.0 * wp * requested
    if is_limited:
        rate += UNWINDING_RATIO * wp * (feasible - requested)
    # error dynamics (s + wo)^2: the load is constant in the observer's model, so its estimate is the integral
    return PositionRates(
        requested_acceleration=rate,
        observed_speed=feasible + 2.0 * wo * error,
        observed_load=-inertia * wo * wo * error,
    )


@njit(cache=True, error_model="numpy", forceinline=True)
def flux_control(plant: Plant, machine: AssumedMachine, excess: float, state: State) -> FluxRates:
    """Return the rates of the assumed flux, and of its weakening under an excess of requested voltage.

    The assumed flux obeys the rotor equation in a frame that turns with it, where it has one part only; it is the
    state itself that decays here, not the value above its floor.
    """
    flux_decay = machine.rotor_resistance_ohm / plant.magnetising_inductance_h
    growth = WEAKENING_RATE * plant.driving_current_a * excess
    return FluxRates(
        assumed_flux=machine.rotor_resistance_ohm * state.current_d - flux_decay * state.assumed_flux_vs,
        flux_current_reduction=growth - state.flux_current_reduction_a / WEAKENING_TIME_S,
    )
