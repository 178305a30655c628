"""Line power of all motors of a train whose losses are a map, with the loss of their gears.

The conventions are those of `railjoule.core.drive.loss_polynomial`; only the loss of a motor comes from a table, one
for driving and one for braking. Outside the map its last piece goes on: `MapDrive` refuses to ask there.
"""

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.loss_map.table import loss_at
from railjoule.core.drive.power_terms import PowerTerms

PARAMETERS = ("motors", "turns_per_metre", "gear_loss_share", "negligible_effort_n", "start of the table of braking")
"""What the parameters of this kind of drive are, in order, before the tables of driving and of braking."""

MOTORS, TURNS, GEAR_LOSS, NEGLIGIBLE, BRAKING_TABLE, DRIVING_TABLE = range(6)


@njit(cache=True)
def _train_loss(parameters: FloatArray, table: int, torque_by_effort: float, effort: float, speed: float) -> PowerTerms:
    """Return the losses of all motors and inverters that are on [W], and their derivatives by effort and speed."""
    motors, turns = parameters[MOTORS], parameters[TURNS]
    p, p_m, p_w, p_mm, p_mw, p_ww = loss_at(parameters, table, torque_by_effort * effort, turns * speed)
    return (
        motors * p,
        motors * p_m * torque_by_effort,
        motors * p_w * turns,
        motors * p_mm * torque_by_effort * torque_by_effort,
        motors * p_mw * torque_by_effort * turns,
        motors * p_ww * turns * turns,
    )


@njit(cache=True)
def power_with_idle(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Return the line power of motors that are on [W] and its derivatives, without the jump at zero effort."""
    share = 1.0 + parameters[GEAR_LOSS]
    by_effort = share / (parameters[MOTORS] * parameters[TURNS])
    p, p_f, p_v, p_ff, p_fv, p_vv = _train_loss(parameters, DRIVING_TABLE, by_effort, effort, speed)
    return p + share * effort * speed, p_f + share * speed, p_v + share * effort, p_ff, p_fv + share, p_vv


@njit(cache=True)
def generated_with_idle(parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Return the power that motors generate that are on [W] and its derivatives; negative where they draw."""
    share = 1.0 - parameters[GEAR_LOSS]
    by_effort = share / (parameters[MOTORS] * parameters[TURNS])
    table = int(parameters[BRAKING_TABLE])
    p, p_f, p_v, p_ff, p_fv, p_vv = _train_loss(parameters, table, by_effort, effort, speed)
    return share * effort * speed - p, share * speed - p_f, share * effort - p_v, -p_ff, share - p_fv, -p_vv


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
