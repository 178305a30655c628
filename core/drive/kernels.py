"""The one place where compiled code asks a drive for its power, whatever its kind.

A kind is asked for by its own number or by a column of `kinds.CAPABILITIES`, never by the order of the numbers. A new
drive is one file with `driving_power` and `generated_power`, a number and a row in `kinds`, a branch in the first two
functions here and one function in `build`; where its power jumps at no effort, a branch in `idle_power` and
`power_when_on` too. Geared motors with another loss are one file with `motor_loss` and one branch in `geared_power`.
No solver changes.
"""

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive import constant_efficiency, copper_loss, geared_power
from railjoule.core.drive.geared_parameters import NEGLIGIBLE
from railjoule.core.drive.induction import power as induction
from railjoule.core.drive.kinds import CONCAVE, CONSTANT_EFFICIENCY, COPPER_LOSS, DRAWS, GEARED, INDUCTION, JUMPS
from railjoule.core.drive.power_terms import PowerTerms

LEAST_SIGNED_N = 1e-9
"""Stands for no effort where its sign tells driving from braking [N]."""


@njit(cache=True)
def driving_power(kind: int, parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Line power [W] at a tractive effort [N] and speed [m/s] with first and second derivatives."""
    if kind == CONSTANT_EFFICIENCY:
        return constant_efficiency.driving_power(parameters, effort, speed)
    if kind == COPPER_LOSS:
        return copper_loss.driving_power(parameters, effort, speed)
    if kind == INDUCTION:
        return induction.driving_power(parameters, effort, speed)
    return geared_power.driving_power(kind, parameters, effort, speed)


@njit(cache=True)
def generated_power(kind: int, parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Electrical power [W] generated at a braking effort [N] and speed [m/s] with first and second derivatives."""
    if kind == CONSTANT_EFFICIENCY:
        return constant_efficiency.generated_power(parameters, effort, speed)
    if kind == COPPER_LOSS:
        return copper_loss.generated_power(parameters, effort, speed)
    if kind == INDUCTION:
        return induction.generated_power(parameters, effort, speed)
    return geared_power.generated_power(kind, parameters, effort, speed)


@njit(cache=True)
def jumps_at_no_effort(kind: int) -> bool:
    """Return whether a drive that is on takes power without effort, and none when it is off."""
    return JUMPS[kind]


@njit(cache=True)
def may_be_concave(kind: int) -> bool:
    """Return whether the power of a drive may be concave in its effort."""
    return CONCAVE[kind]


@njit(cache=True)
def may_draw_while_braking(kind: int) -> bool:
    """Return whether a drive may need line power to brake, near standstill."""
    return DRAWS[kind]


@njit(cache=True)
def idle_power(kind: int, parameters: FloatArray, speed: float) -> tuple[float, float, float]:
    """Return the jump at zero effort: what a drive takes that is on without any [W], and two derivatives by speed."""
    if kind == INDUCTION:
        return induction.idle_power(parameters, speed)
    if GEARED[kind]:
        return geared_power.idle_power(kind, parameters, speed)
    return 0.0, 0.0, 0.0


@njit(cache=True)
def power_when_on(kind: int, parameters: FloatArray, braking: bool, effort: float, speed: float) -> PowerTerms:
    """Power [W] of a drive that is on and falls to `idle_power` with the effort, negative where it generates."""
    if not braking:
        if kind == INDUCTION:
            return induction.power_with_idle(parameters, effort, speed)
        if GEARED[kind]:
            return geared_power.power_with_idle(kind, parameters, effort, speed)
        return driving_power(kind, parameters, effort, speed)
    if kind == INDUCTION:
        p, p_f, p_v, p_ff, p_fv, p_vv = induction.generated_with_idle(parameters, effort, speed)
    elif GEARED[kind]:
        p, p_f, p_v, p_ff, p_fv, p_vv = geared_power.generated_with_idle(kind, parameters, effort, speed)
    else:
        p, p_f, p_v, p_ff, p_fv, p_vv = generated_power(kind, parameters, effort, speed)
    # taken is positive in this function, generated is positive in those that it asks
    return -p, -p_f, -p_v, -p_ff, -p_fv, -p_vv


@njit(cache=True)
def work_bounds(kind: int, parameters: FloatArray) -> tuple[float, float]:
    """Return the least line energy per work of traction, and the most energy generated per work of braking.

    Of a kind that tells no more they are 1: no drive gives energy for nothing.
    """
    if kind == CONSTANT_EFFICIENCY:
        return constant_efficiency.work_bounds(parameters)
    if kind == INDUCTION:
        return induction.work_bounds(parameters)
    if GEARED[kind]:
        return geared_power.work_bounds(parameters)
    return 1.0, 1.0


@njit(cache=True)
def shaft_force(kind: int, parameters: FloatArray, braking: bool, effort: float) -> tuple[float, float]:
    """Return the work of the shafts over distance [N] and its derivative by effort, negative where they are driven.

    Gear and friction are part of it; what power remains are losses that do not fall with speed.
    """
    if kind == INDUCTION:
        return induction.shaft_force(parameters, -effort if braking else effort)
    if GEARED[kind]:
        # gears take their part of the work whatever the speed
        share = work_bounds(kind, parameters)[1 if braking else 0]
        return (-share * effort, -share) if braking else (share * effort, share)
    return (-effort, -1.0) if braking else (effort, 1.0)


@njit(cache=True)
def smooth_power_when_on(kind: int, parameters: FloatArray, braking: bool, effort: float, speed: float) -> PowerTerms:
    """Power [W] of a drive that is on, with continuous first derivatives, never more than the true one.

    Negative where it generates; for a solver that steps from derivative to derivative.
    """
    if kind == INDUCTION:
        # the gear's loss changes its side with the direction of the power, which no effort would not tell
        signed = max(effort, LEAST_SIGNED_N) * (-1.0 if braking else 1.0)
        p, p_f, p_v, p_ff, p_fv, p_vv = induction.smooth_power_with_idle(parameters, signed, speed)
        if not braking:
            return p, p_f, p_v, p_ff, p_fv, p_vv
        # by the size of the effort, whose sign comes in once with each derivative by it
        return p, -p_f, p_v, p_ff, -p_fv, p_vv
    return power_when_on(kind, parameters, braking, effort, speed)


@njit(cache=True)
def has_standstill_brake(kind: int, parameters: FloatArray) -> bool:
    """Return whether another brake takes over where the electric one would draw power."""
    return kind == INDUCTION and induction.has_standstill_brake(parameters)


@njit(cache=True)
def negligible_effort(kind: int, parameters: FloatArray) -> float:
    """Return the effort up to which a drive that idles counts as off [N]; zero of one that does not idle."""
    if kind == INDUCTION:
        idle: float = parameters[induction.NEGLIGIBLE]
        return idle
    if GEARED[kind]:
        geared: float = parameters[NEGLIGIBLE]
        return geared
    return 0.0


@njit(cache=True, nogil=True)
def electrical_power_array(
    kind: int, parameters: FloatArray, effort: FloatArray, speed: FloatArray, power: FloatArray
) -> None:
    """Fill `power` [W] for signed electric efforts [N] and speeds [m/s]; all of shape (n,).

    Positive is taken, negative is generated; what of it the line takes back is not asked here.
    """
    for i in range(effort.shape[0]):
        if effort[i] >= 0.0:
            power[i] = driving_power(kind, parameters, effort[i], speed[i])[0]
        else:
            power[i] = -generated_power(kind, parameters, -effort[i], speed[i])[0]
