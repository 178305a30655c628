"""Position control, load observer and current control of induction machines under field orientation.

Primes are for what the control assumes or measures. It lets its frame turn with wc = p w' + Rr' iq / psi'.

Position control makes of the reference x* a requested acceleration ad with the closed loop (1 + s/wp)^-3,

    dad/dt = wp^3 (x* - x) - 3 wp^2 v' - 3 wp ad,

and an observer, which also smooths the measured speed, adds the force that the train needs beside its own inertia.
The pre-compensator cancels the lag of the loop: x* = x + (3/wp) v + (3/wp^2) a + (1/wp^3) j of the reference.

Currents have proportional-integral control with decoupling. A voltage beyond its limit keeps its direction, the
integrals do not grow by the part that is cut off, the current along the flux is reduced, and the request for the
current across it stays within the pull-out torque. The clock of the reference slows down when a limit holds the train
back, so that it goes on along its plan, later, and except for catching up the last metre no faster than planned.

Source: Ftorek et al. 2025, Figure 1; Vittek et al. 2017, "Position tracking systems for AC drives employing forced
dynamics control".
"""

import math
from typing import NamedTuple

from railjoule.core.compiled import njit
from railjoule.core.simulation.field_oriented.plant import Plant, State, shaft_torque_nm, wheel_force_n

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


class ReferencePoint(NamedTuple):
    """The reference at one instant.

    Parameters
    ----------
    position_m, speed_ms, acceleration_ms2, jerk_ms3 : float
        Position and its derivatives [m, m/s, m/s2, m/s3].
    flux_vs, flux_rate_v : float
        Flux linkage of the rotor and its rate [V s, V].
    """

    position_m: float
    speed_ms: float
    acceleration_ms2: float
    jerk_ms3: float
    flux_vs: float
    flux_rate_v: float


class AssumedMachine(NamedTuple):
    """The control's own model of a machine.

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


class Control(NamedTuple):
    """Outputs of the control and rates of its states.

    Parameters
    ----------
    voltage : complex
        Of a phase of each machine [V].
    frame_rads : float
        Electrical angular frequency of the frame [rad/s].
    clock_rate : float
        Rate of the reference's clock, 0 to 1.
    integral_rate : complex
        Of the current control [A/s2].
    acceleration_rate, speed_rate, load_rate : float
        Of requested acceleration, observed speed and observed load [m/s3, m/s2, N/s].
    flux_rate, reduction_rate : float
        Of the assumed flux and of the reduction of the current along it [V, A/s].
    is_current_limited, is_voltage_limited : bool
        Whether a limit of the inverter is active.
    """

    voltage: complex
    frame_rads: float
    clock_rate: float
    integral_rate: complex
    acceleration_rate: float
    speed_rate: float
    load_rate: float
    flux_rate: float
    reduction_rate: float
    is_current_limited: bool
    is_voltage_limited: bool


@njit(cache=True, error_model="numpy", forceinline=True)
def reference_between(sample: ReferencePoint, next_jerk_ms3: float, since_s: float, step_s: float) -> ReferencePoint:
    """Return the reference between two samples, a time [s] after the first one.

    Position and speed go on from the sample before with its jerk. Acceleration and jerk, which the pre-compensator
    uses, change linearly to the next sample: steps of theirs every few milliseconds would excite the currents.
    """
    v, a, j, since = sample.speed_ms, sample.acceleration_ms2, sample.jerk_ms3, since_s
    jerk = j + (next_jerk_ms3 - j) * since / step_s
    return ReferencePoint(
        position_m=sample.position_m + (v + (0.5 * a + j * since / 6.0) * since) * since,
        speed_ms=v + (a + 0.5 * j * since) * since,
        acceleration_ms2=a + 0.5 * (j + jerk) * since,
        jerk_ms3=jerk,
        flux_vs=sample.flux_vs,
        flux_rate_v=sample.flux_rate_v,
    )


@njit(cache=True, error_model="numpy", forceinline=True)
def target_position_m(plant: Plant, point: ReferencePoint, state: State) -> tuple[float, float]:
    """Return x* [m], and the rate of the reference's clock, 0 to 1: slower the farther the train is behind."""
    wp = plant.bandwidth_rads
    # without the pre-compensator the loop lags by 3 / wp by design, which is no reason to slow the clock
    own_lag = 0.0 if plant.precompensator else 3.0 / wp * state.speed_ms
    rate = 1.0 - (point.position_m - own_lag - state.position_m - ALLOWED_LAG_M) / STOPPING_LAG_M
    rate = min(max(rate, 0.0), 1.0)
    if not plant.precompensator:
        return point.position_m, rate
    # on a slowed clock d/dt is rate x d/dclock, so the n-th derivative is smaller by the n-th power of the rate
    v, a, j = rate * point.speed_ms, rate * rate * point.acceleration_ms2, rate * rate * rate * point.jerk_ms3
    return point.position_m + (3.0 / wp * v + 3.0 / (wp * wp) * a + j / (wp * wp * wp)), rate


@njit(cache=True, error_model="numpy", forceinline=True)
def assumed_machine(plant: Plant, state: State, measured_ms: float) -> AssumedMachine:
    """Return the control's own model at a measured speed [m/s]."""
    true, circuit = plant.machines.machine, plant.machines.circuit
    resistance = plant.rotor_resistance_factor * circuit.rotor_resistance_ohm
    rated_flux = circuit.magnetising_inductance_h * true.magnetising_current_a
    flux = max(state.assumed_flux_vs, SMALLEST_FLUX_FRACTION * rated_flux)
    rotor = true.pole_pairs * (plant.machines.turns_per_metre * measured_ms)
    frame = rotor + resistance * state.current.imag / flux
    return AssumedMachine(resistance, flux, rotor, frame, 1.5 * true.pole_pairs * flux)


@njit(cache=True, error_model="numpy", forceinline=True)
def requested_current(
    plant: Plant, machine: AssumedMachine, point: ReferencePoint, state: State
) -> tuple[complex, bool, bool]:
    """Return the current that flux and acceleration need within its limits [A], and which limit is active.

    The limits are those of the current and of the voltage, in this order.
    """
    machines, circuit, largest = plant.machines, plant.machines.circuit, plant.machines.driving_current_a
    # the rotor equation in its own frame, dpsi/dt = Rr id - (Rr / Lm) psi, solved for the current that makes the flux
    flux_current = point.flux_vs / circuit.magnetising_inductance_h + point.flux_rate_v / machine.rotor_resistance_ohm
    flux_current = min(max(flux_current, 0.0), largest) - state.flux_current_reduction_a
    # at most sqrt(1/2) of the limit demagnetises, so that as much is left for torque
    flux_current = max(flux_current, -math.sqrt(0.5) * largest)
    force = plant.assumed_inertia_kg * state.requested_acceleration_ms2 + state.observed_load_n
    torque = shaft_torque_nm(plant, force) + machines.machine.mechanical_loss_torque_nm
    requested = torque / machine.torque_per_current_nm
    # the flux has the first call on the current, torque gets the rest of the circle
    driving = math.sqrt(max(largest**2 - flux_current**2, 0.0))
    braking = -math.sqrt(max(machines.braking_current_a**2 - flux_current**2, 0.0))
    # Pull-out. In steady state, without the drop in the stator's resistance, the voltage is wc times the stator's flux:
    # (U / wc)^2 = (Ls iq)^2 + (Ls id + psi)^2, and with psi = Lm id the torque goes with the product of the two
    # brackets. At a given sum of squares the product is largest where both are alike: Ls iq = sqrt(1/2) U / wc. More iq
    # costs more flux than it brings. Neglecting Rs makes the limit a little too high while driving, and matters at
    # low wc only, where the circle of current binds first.
    slowest, max_v = max(abs(machine.frame_rads), 1e-6), machines.machine.max_phase_voltage_v
    pull_out = math.sqrt(0.5) * max_v / (slowest * circuit.leakage_inductance_h)
    allowed = min(max(requested, braking, -pull_out), driving, pull_out)
    # a torque that stops at the pull-out current is limited by the voltage, though no voltage is cut off
    is_limited, is_below = requested != allowed, abs(allowed) < pull_out
    return complex(flux_current, allowed), is_limited and is_below, is_limited and not is_below


@njit(cache=True, error_model="numpy", forceinline=True)
def current_control(
    plant: Plant, machine: AssumedMachine, request: complex, state: State
) -> tuple[complex, complex, float]:
    """Return the voltage that brings the current to its request, the rate of its integral, and the lack of voltage.

    All terms of the circuit but Ls di/dt are added from the control's own model, so that each current follows
    di/dt = bandwidth x error + integral, without a coupling to the other. The lack is the missing fraction of the
    limit, at most 1.
    """
    circuit, fast = plant.machines.circuit, max(CURRENT_BANDWIDTH_RADS, CURRENT_BANDWIDTH_RATIO * plant.bandwidth_rads)
    l_s, decay = circuit.leakage_inductance_h, machine.rotor_resistance_ohm / circuit.magnetising_inductance_h
    impedance = complex(circuit.stator_resistance_ohm + machine.rotor_resistance_ohm, machine.frame_rads * l_s)
    error = request - state.current
    requested = (
        l_s * (fast * error + state.integral)
        + impedance * state.current
        + machine.flux_vs * complex(-decay, machine.rotor_rads)
    )
    limit, amplitude = plant.machines.machine.max_phase_voltage_v, math.hypot(requested.real, requested.imag)
    voltage = min(1.0, limit / max(amplitude, 1e-9)) * requested
    # the second part takes back the voltage that the limit cut off, at the currents' own speed: without it the
    # integrals wind up
    integral_rate = INTEGRAL_GAIN * fast * fast * error + (fast / l_s) * (voltage - requested)
    return voltage, integral_rate, min(max(amplitude / limit - 1.0, 0.0), 1.0)


@njit(cache=True, error_model="numpy", forceinline=True)
def position_control(
    plant: Plant, machine: AssumedMachine, is_limited: bool, target_m: float, measured_ms: float, state: State
) -> tuple[float, float, float]:
    """Return the rates of requested acceleration, observed speed and observed load [m/s3, m/s2, N/s].

    Parameters
    ----------
    plant, machine : Plant, AssumedMachine
        True numbers, and the control's own model.
    is_limited : bool
        Whether a limit of current or voltage is active.
    target_m, measured_ms : float
        x* and the measured speed [m, m/s].
    state : State
        Present states.
    """
    wp, wo, inertia = plant.bandwidth_rads, OBSERVER_RATIO * plant.bandwidth_rads, plant.assumed_inertia_kg
    # Friction counts against the motion as if the train ran forward always: at a stand it is part of the load
    # that the observer finds, which takes up every other difference between the assumed force and the true one too.
    torque = machine.torque_per_current_nm * state.current.imag - plant.machines.machine.mechanical_loss_torque_nm
    feasible = (wheel_force_n(plant, torque) - state.observed_load_n) / inertia
    error = measured_ms - state.observed_speed_ms
    requested = state.requested_acceleration_ms2
    rate = wp * wp * (wp * (target_m - state.position_m) - 3.0 * state.observed_speed_ms) - 3.0 * wp * requested
    if is_limited:
        rate += UNWINDING_RATIO * wp * (feasible - requested)
    # error dynamics (s + wo)^2: the load is constant in the observer's model, so its estimate is the integral
    return rate, feasible + 2.0 * wo * error, -inertia * wo * wo * error


@njit(cache=True, error_model="numpy", forceinline=True)
def control_at(plant: Plant, point: ReferencePoint, measured_ms: float, state: State) -> Control:
    """Return the control's answer to a reference and a measured speed [m/s].

    The assumed flux obeys the rotor equation in a frame that turns with it, where it has one part only; the state
    itself decays, not its value above the floor.
    """
    target, clock_rate = target_position_m(plant, point, state)
    machine = assumed_machine(plant, state, measured_ms)
    request, by_current, by_voltage = requested_current(plant, machine, point, state)
    voltage, integral_rate, lack = current_control(plant, machine, request, state)
    by_voltage = by_voltage or lack > 0.0
    acceleration_rate, speed_rate, load_rate = position_control(
        plant, machine, by_current or by_voltage, target, measured_ms, state
    )
    flux_decay = machine.rotor_resistance_ohm / plant.machines.circuit.magnetising_inductance_h
    growth = WEAKENING_RATE * plant.machines.driving_current_a * lack
    return Control(
        voltage=voltage,
        frame_rads=machine.frame_rads,
        clock_rate=clock_rate,
        integral_rate=integral_rate,
        acceleration_rate=acceleration_rate,
        speed_rate=speed_rate,
        load_rate=load_rate,
        flux_rate=machine.rotor_resistance_ohm * state.current.real - flux_decay * state.assumed_flux_vs,
        reduction_rate=growth - state.flux_current_reduction_a / WEAKENING_TIME_S,
        is_current_limited=by_current,
        is_voltage_limited=by_voltage,
    )
