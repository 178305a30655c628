"""Line power of motors with inverters of their own whose losses are known, and with the loss of their gears.

The gear loses a share g of the power at the wheels from the motor or back: a shaft carries
F v (1 + g) / motors in driving and F v (1 - g) / motors in braking, and its torque likewise. Without effort the
inverters are off: no power, no drag. With the least effort they take what `idle_power` returns, so power jumps there.
Only the loss of a motor differs from kind to kind.

Source: Shtompel, Khvorost 2025, (8)-(12), with the sign of the gear's loss in braking put right.
"""

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive import loss_polynomial
from railjoule.core.drive.geared_parameters import GEAR_LOSS, MOTORS, NEGLIGIBLE, TURNS
from railjoule.core.drive.kinds import LOSS_MAP, LOSS_POLYNOMIAL
from railjoule.core.drive.loss_map import loss as loss_map
from railjoule.core.drive.power_terms import PowerTerms, off_at_rounding


@njit(cache=True)
def _motor_loss(kind: int, parameters: FloatArray, braking: bool, torque: float, rads: float) -> PowerTerms:
    """Return the losses of one motor that is on, with its inverter [W], and their derivatives by torque and speed."""
    if kind == LOSS_POLYNOMIAL:
        return loss_polynomial.motor_loss(parameters, torque, rads)
    if kind == LOSS_MAP:
        return loss_map.motor_loss(parameters, braking, torque, rads)
    # a kind without a branch here would else lose nothing, silently
    raise ValueError("no kernel of drives knows this kind")


@njit(cache=True)
def _train_loss(kind: int, parameters: FloatArray, braking: bool, effort: float, speed: float) -> PowerTerms:
    """Return the losses of all motors and inverters that are on [W], and their derivatives by effort and speed."""
    motors, turns = parameters[MOTORS], parameters[TURNS]
    # torque of one motor over effort of the train, and speed of the motor over that of the train: chain rule below
    by_effort = work_bounds(parameters)[1 if braking else 0] / (motors * turns)
    p, p_m, p_w, p_mm, p_mw, p_ww = _motor_loss(kind, parameters, braking, by_effort * effort, turns * speed)
    return (
        motors * p,
        motors * p_m * by_effort,
        motors * p_w * turns,
        motors * p_mm * by_effort * by_effort,
        motors * p_mw * by_effort * turns,
        motors * p_ww * turns * turns,
    )


@njit(cache=True)
def power_with_idle(kind: int, parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Return the line power of motors that are on [W] and its derivatives, without the jump at zero effort."""
    share = 1.0 + parameters[GEAR_LOSS]
    p, p_f, p_v, p_ff, p_fv, p_vv = _train_loss(kind, parameters, False, effort, speed)
    return p + share * effort * speed, p_f + share * speed, p_v + share * effort, p_ff, p_fv + share, p_vv


@njit(cache=True)
def generated_with_idle(kind: int, parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Return the power that motors generate that are on [W] and its derivatives; negative where they draw."""
    share = 1.0 - parameters[GEAR_LOSS]
    p, p_f, p_v, p_ff, p_fv, p_vv = _train_loss(kind, parameters, True, effort, speed)
    return share * effort * speed - p, share * speed - p_f, share * effort - p_v, -p_ff, share - p_fv, -p_vv


@njit(cache=True)
def idle_power(kind: int, parameters: FloatArray, speed: float) -> tuple[float, float, float]:
    """Return what motors take that are on without effort [W], and its derivatives by speed: the jump at zero."""
    p, _, p_v, _, _, p_vv = power_with_idle(kind, parameters, 0.0, speed)
    return p, p_v, p_vv


@njit(cache=True)
def driving_power(kind: int, parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Line power [W] at a tractive effort [N] and speed [m/s], and its derivatives.

    Returns (p, dp/df, dp/dv, d2p/df2, d2p/dfdv, d2p/dv2). Zero at an effort that is no more than rounding.
    """
    return off_at_rounding(power_with_idle(kind, parameters, effort, speed), effort, parameters[NEGLIGIBLE])


@njit(cache=True)
def generated_power(kind: int, parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Electrical power [W] generated at an electric braking effort [N] and speed [m/s], and its derivatives.

    Negative near standstill and at small efforts, where the motors lose more than the wheels give.
    """
    if effort <= parameters[NEGLIGIBLE]:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return generated_with_idle(kind, parameters, effort, speed)


@njit(cache=True)
def work_bounds(parameters: FloatArray) -> tuple[float, float]:
    """Return the least line energy per work of traction, and the most energy generated per work of braking."""
    return 1.0 + parameters[GEAR_LOSS], 1.0 - parameters[GEAR_LOSS]
