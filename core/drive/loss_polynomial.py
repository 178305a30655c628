"""A drive of motors with their own inverters whose losses are a polynomial of torque and speed.

Loss of one motor that is on, with its inverter: p0 + k1 w + k2 w^2 + c1 M + c2 M^2, w its speed [rad/s], M its torque
[N m]. The gear loses a share g of the power at the wheels on its way from the motor or back: a shaft carries
F v (1 + g) / motors in driving and F v (1 - g) / motors in braking, and its torque likewise. Without effort the
inverters are off: no power, no drag. With the least effort they take what `idle_power` returns, so power jumps there.

Source: Shtompel, Khvorost 2025, (8)-(12), with the sign of the gear's loss in braking put right; the polynomial is
ours.
"""

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.power_terms import PowerTerms

PARAMETERS = (
    *("no_load_loss_w", "speed_loss_w_per_rads", "speed_loss_w_per_rads2", "torque_loss_w_per_nm"),
    *("torque_loss_w_per_nm2", "motors", "turns_per_metre", "gear_loss_share", "negligible_effort_n"),
)
"""What the parameters of this kind of drive are, in order."""

NO_LOAD, BY_SPEED, BY_SPEED2, BY_TORQUE, BY_TORQUE2, MOTORS, TURNS, GEAR_LOSS, NEGLIGIBLE = range(9)


@njit(cache=True)
def _train_loss(parameters: FloatArray, torque_by_effort: float, effort: float, speed: float) -> PowerTerms:
    """Return the losses of all motors and inverters that are on [W], and their derivatives by effort and speed."""
    motors, turns = parameters[MOTORS], parameters[TURNS]
    torque, rads = torque_by_effort * effort, turns * speed
    loss = parameters[NO_LOAD] + (parameters[BY_SPEED] + parameters[BY_SPEED2] * rads) * rads
    loss += (parameters[BY_TORQUE] + parameters[BY_TORQUE2] * torque) * torque
    return (
        motors * loss,
        motors * (parameters[BY_TORQUE] + 2.0 * parameters[BY_TORQUE2] * torque) * torque_by_effort,
        motors * (parameters[BY_SPEED] + 2.0 * parameters[BY_SPEED2] * rads) * turns,
        motors * 2.0 * parameters[BY_TORQUE2] * torque_by_effort * torque_by_effort,
        0.0,
        motors * 2.0 * parameters[BY_SPEED2] * turns * turns,
    )


@njit(cache=True)
def power_with_idle(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Return the line power of motors that are on [W] and its derivatives, without the jump at zero effort."""
    share = 1.0 + parameters[GEAR_LOSS]
    by_effort = share / (parameters[MOTORS] * parameters[TURNS])
    p, p_f, p_v, p_ff, _, p_vv = _train_loss(parameters, by_effort, effort, speed)
    return p + share * effort * speed, p_f + share * speed, p_v + share * effort, p_ff, share, p_vv


@njit(cache=True)
def generated_with_idle(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Return the power that motors generate that are on [W] and its derivatives; negative where they draw."""
    share = 1.0 - parameters[GEAR_LOSS]
    by_effort = share / (parameters[MOTORS] * parameters[TURNS])
    p, p_f, p_v, p_ff, _, p_vv = _train_loss(parameters, by_effort, effort, speed)
    return share * effort * speed - p, share * speed - p_f, share * effort - p_v, -p_ff, share, -p_vv


@njit(cache=True)
def idle_power(parameters: FloatArray, speed: float) -> tuple[float, float, float]:
    """Return what motors take that are on without effort [W], and its derivatives by speed: the jump at zero."""
    p, _, p_v, _, _, p_vv = power_with_idle(parameters, 0.0, speed)
    return p, p_v, p_vv


@njit(cache=True)
def driving_power(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Line power [W] at a tractive effort [N] and speed [m/s], and its derivatives.

    Returns (p, dp/df, dp/dv, d2p/df2, d2p/dfdv, d2p/dv2). Zero at an effort that is no more than rounding.
    """
    p, p_f, p_v, p_ff, p_fv, p_vv = power_with_idle(parameters, effort, speed)
    if effort <= parameters[NEGLIGIBLE]:
        return 0.0, p_f, 0.0, p_ff, p_fv, 0.0
    return p, p_f, p_v, p_ff, p_fv, p_vv


@njit(cache=True)
def generated_power(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Electrical power [W] generated at an electric braking effort [N] and speed [m/s], and its derivatives.

    Negative near standstill and at small efforts, where the motors lose more than the wheels give.
    """
    if effort <= parameters[NEGLIGIBLE]:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return generated_with_idle(parameters, effort, speed)


@njit(cache=True)
def work_bounds(parameters: FloatArray) -> tuple[float, float]:
    """Return the least line energy per work of traction, and the most energy generated per work of braking."""
    return 1.0 + parameters[GEAR_LOSS], 1.0 - parameters[GEAR_LOSS]
