"""Line power of all machines of a train at an effort and a speed: gear, mechanical loss, least-loss flux.

Driving, F = n x (T - T_m) eta; braking, F = n x (T - T_m) / eta with T < 0; x = gear ratio over wheel radius. Rawicki,
(3), (23)-(24), (33). Without effort the machines are off: no power, no drag. With the least effort they take what
`idle_power` returns, so power jumps at zero effort; a solver that needs a convex power lets the train switch between
driving and coasting and so spreads that jump.

An electric brake whose machines would have to draw power, near standstill or at less than their own friction, does not
brake: the standstill brake of the train does, where there is one. Else the draw counts in full.
"""

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.induction.least_loss import best_ratio, least_input_power, smooth_input_power
from railjoule.core.drive.induction.machine import (
    MACHINE_SIZE,
    MECHANICAL_LOSS,
    Machine,
    SteadyState,
    machine_of,
    steady_state,
    torque_constant,
)
from railjoule.core.drive.power_terms import PowerTerms, off_at_rounding

PARAMETERS = (
    *Machine._fields,
    *("motors", "turns_per_metre", "gear_efficiency", "standstill_brake", "negligible_effort_n"),
)
"""What the parameters of this kind of drive are, in order."""

MOTORS, TURNS, GEAR, STANDSTILL_BRAKE, NEGLIGIBLE = range(MACHINE_SIZE, len(PARAMETERS))


@njit(cache=True)
def driving_torque(parameters: FloatArray, effort: float) -> float:
    """Return the electromagnetic torque of one machine [N m] at a tractive effort of the train [N]."""
    torque: float = parameters[MECHANICAL_LOSS] + effort / (parameters[MOTORS] * parameters[TURNS] * parameters[GEAR])
    return torque


@njit(cache=True)
def braking_torque(parameters: FloatArray, effort: float) -> float:
    """Return the electromagnetic torque of one machine [N m] at an electric braking effort of the train [N].

    Negative where the machine generates; positive where its own friction brakes more than is asked for.
    """
    # in braking the gear stands between wheel and rotor: the rotor meets less than the wheels give
    per_motor: float = parameters[GEAR] / (parameters[MOTORS] * parameters[TURNS])
    torque: float = parameters[MECHANICAL_LOSS] - effort * per_motor
    return torque


@njit(cache=True)
def _train_power(
    parameters: FloatArray, torque: float, torque_by_effort: float, speed: float, smooth: bool
) -> PowerTerms:
    """Return the input power of all machines [W] at a torque of each, with derivatives by effort and speed."""
    machine, motors = machine_of(parameters), parameters[MOTORS]
    per_torque = 1.0 / torque_constant(machine)
    # kappa has no sign: torque and effort act on it through that of the torque, also in the chain rule below
    sign = 1.0 if torque >= 0.0 else -1.0
    turns = machine.pole_pairs * parameters[TURNS]
    if smooth:
        power = smooth_input_power(machine, sign, sign * torque * per_torque, turns * speed)
    else:
        power = least_input_power(machine, sign, sign * torque * per_torque, turns * speed)
    p, p_k, p_w, p_kk, p_kw, p_ww = power
    by_effort = sign * torque_by_effort * per_torque
    return (
        motors * p,
        motors * p_k * by_effort,
        motors * p_w * turns,
        motors * p_kk * by_effort * by_effort,
        motors * p_kw * by_effort * turns,
        motors * p_ww * turns * turns,
    )


@njit(cache=True)
def power_with_idle(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Return the line power of machines that are on [W] and its derivatives, without the jump at zero effort."""
    by_effort = 1.0 / (parameters[MOTORS] * parameters[TURNS] * parameters[GEAR])
    return _train_power(parameters, driving_torque(parameters, effort), by_effort, speed, False)


@njit(cache=True)
def shaft_force(parameters: FloatArray, effort: float) -> tuple[float, float]:
    """Return the work of all rotors over distance [N] at a signed effort [N], and how it grows with its size."""
    # torque over a distance: all motors, x radians a metre
    machines = parameters[MOTORS] * parameters[TURNS]
    if effort >= 0.0:
        return machines * driving_torque(parameters, effort), 1.0 / parameters[GEAR]
    return machines * braking_torque(parameters, -effort), -parameters[GEAR]


@njit(cache=True)
def smooth_power_with_idle(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Return a power with continuous first derivatives, for negative efforts as well; never more than the true one."""
    if effort >= 0.0:
        by_effort = 1.0 / (parameters[MOTORS] * parameters[TURNS] * parameters[GEAR])
        return _train_power(parameters, driving_torque(parameters, effort), by_effort, speed, True)
    by_effort = parameters[GEAR] / (parameters[MOTORS] * parameters[TURNS])
    return _train_power(parameters, braking_torque(parameters, -effort), by_effort, speed, True)


@njit(cache=True)
def idle_power(parameters: FloatArray, speed: float) -> tuple[float, float, float]:
    """Return what machines take that are on without effort [W], and its derivatives by speed: the jump at zero."""
    p, _, p_v, _, _, p_vv = power_with_idle(parameters, 0.0, speed)
    return p, p_v, p_vv


@njit(cache=True)
def driving_power(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Line power [W] at a tractive effort [N] and speed [m/s], and its derivatives.

    Returns (p, dp/df, dp/dv, d2p/df2, d2p/dfdv, d2p/dv2). Zero at an effort that is no more than rounding.
    """
    return off_at_rounding(power_with_idle(parameters, effort, speed), effort, parameters[NEGLIGIBLE])


@njit(cache=True)
def has_standstill_brake(parameters: FloatArray) -> bool:
    """Return whether another brake takes over where the machines would draw power to brake."""
    brake: bool = parameters[STANDSTILL_BRAKE] > 0.0
    return brake


@njit(cache=True)
def generated_with_idle(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Return the power that machines generate that are on [W] and its derivatives; negative where they draw."""
    by_effort = -parameters[GEAR] / (parameters[MOTORS] * parameters[TURNS])
    torque = braking_torque(parameters, effort)
    p, p_f, p_v, p_ff, p_fv, p_vv = _train_power(parameters, torque, by_effort, speed, False)
    return -p, -p_f, -p_v, -p_ff, -p_fv, -p_vv


@njit(cache=True)
def generated_power(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Electrical power [W] generated at an electric braking effort [N] and speed [m/s], and its derivatives.

    Not negative where the train has a standstill brake.
    """
    if effort <= parameters[NEGLIGIBLE]:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    # machines that draw to brake are better off: the standstill brake then does their part
    generated = generated_with_idle(parameters, effort, speed)
    if generated[0] < 0.0 and parameters[STANDSTILL_BRAKE] > 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return generated


@njit(cache=True)
def work_bounds(parameters: FloatArray) -> tuple[float, float]:
    """Return the least line energy per work of traction, and the most energy generated per work of braking."""
    # what the gear alone does; the machine's own losses and friction only add to that
    return 1.0 / parameters[GEAR], parameters[GEAR]


@njit(cache=True)
def operating_point(parameters: FloatArray, effort: float, speed: float) -> tuple[SteadyState, float, float, bool]:
    """Return what each machine does at a signed electric effort of the train [N] and a speed [m/s].

    Returns
    -------
    state : SteadyState
        Of one machine, with the flux that loses least.
    flux_current_a, torque_current_a : float
        Its currents Ix and Iy [A].
    on : bool
        Whether it is on; off, all its numbers are zero.
    """
    machine = machine_of(parameters)
    off = SteadyState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if abs(effort) <= parameters[NEGLIGIBLE]:
        return off, 0.0, 0.0, False
    torque = driving_torque(parameters, effort) if effort > 0.0 else braking_torque(parameters, -effort)
    sign = 1.0 if torque >= 0.0 else -1.0
    strength = sign * torque / torque_constant(machine)
    rotor_rads = machine.pole_pairs * parameters[TURNS] * speed
    ratio, _ = best_ratio(machine, sign, strength, rotor_rads)
    # kappa = Ix |Iy| = q Ix^2
    flux_current = (strength / ratio) ** 0.5
    state = steady_state(machine, flux_current, sign * ratio * flux_current, rotor_rads)
    if effort < 0.0 and state.input_power_w > 0.0 and parameters[STANDSTILL_BRAKE] > 0.0:
        return off, 0.0, 0.0, False
    return state, flux_current, sign * ratio * flux_current, True
