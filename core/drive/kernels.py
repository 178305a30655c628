"""The registry of drives: the function that makes each, and its power in compiled code.

A drive has one compiled function of its own, its power while it is on; all others follow from that and from its
capabilities. A kind is selected by its number or by a column of `kinds.CAPABILITIES`, not by the order of the numbers.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive import efficiency_map, geared, loss_map
from railjoule.core.drive.drive import Drive
from railjoule.core.drive.geared import (
    BRAKING_SHARE,
    DRIVING_SHARE,
    FRICTION,
    MOTORS,
    NEGLIGIBLE,
    STANDSTILL_BRAKE,
    TURNS,
)
from railjoule.core.drive.induction import min_loss
from railjoule.core.drive.induction.drive import make_induction
from railjoule.core.drive.induction.machine import make_machine
from railjoule.core.drive.kinds import (
    CONCAVE,
    CONSTANT_EFFICIENCY,
    COPPER_LOSS,
    DRAWS,
    IDLE_LOSSES,
    INDUCTION,
    LOSS_MAP,
    LOSS_POLYNOMIAL,
    PowerTerms,
)
from railjoule.core.drive.synchronous.drive import make_synchronous
from railjoule.core.scenario.drive import (
    ConstantEfficiency,
    CopperLoss,
    DriveParameters,
    EfficiencyMap,
    Induction,
    LossPolynomial,
    Synchronous,
)

MAKERS: dict[type[DriveParameters], Callable[[Any], Drive]] = {
    ConstantEfficiency: geared.make_constant_efficiency,
    CopperLoss: geared.make_copper_loss,
    Induction: make_induction,
    LossPolynomial: geared.make_loss_polynomial,
    EfficiencyMap: efficiency_map.make_efficiency_map,
    Synchronous: make_synchronous,
}
"""The function that makes a drive of the parameters of each class."""


@lru_cache(maxsize=32)
def make_drive(parameters: DriveParameters) -> Drive:
    """Return the drive of validated `parameters` of a scenario; cached."""
    return MAKERS[type(parameters)](parameters)


@njit(cache=True)
def has_idle_losses(kind: int) -> bool:
    """Return whether a drive has idle losses: it takes power without effort while it is on, and none while off."""
    return IDLE_LOSSES[kind]


@njit(cache=True)
def may_be_concave(kind: int) -> bool:
    """Return whether the power of a drive may be concave in its effort."""
    return CONCAVE[kind]


@njit(cache=True)
def may_draw_while_braking(kind: int) -> bool:
    """Return whether a drive may need supply power to brake, near standstill."""
    return DRAWS[kind]


@njit(cache=True)
def _power(kind: int, parameters: FloatArray, braking: bool, effort: float, speed: float, smooth: bool) -> PowerTerms:
    if kind == CONSTANT_EFFICIENCY:
        return geared.constant_efficiency_power(parameters, braking, effort, speed)
    if kind == COPPER_LOSS:
        return geared.copper_loss_power(parameters, braking, effort, speed)
    motors, turns = parameters[MOTORS], parameters[TURNS]
    share = -parameters[BRAKING_SHARE] if braking else parameters[DRIVING_SHARE]
    # torque of one motor over effort of the train, and speed of the motor over that of the train: chain rule below
    by_effort = share / (motors * turns)
    torque, rads = by_effort * effort, turns * speed
    if kind == INDUCTION:
        power = min_loss.input_power_of_shaft(make_machine(parameters), torque, rads, smooth)
        # the input power contains that of the shaft
        share = 0.0
    else:
        by_effort, torque = abs(by_effort), abs(torque)
        if kind == LOSS_POLYNOMIAL:
            power = geared.polynomial_loss(parameters, torque, rads)
        elif kind == LOSS_MAP:
            table = int(parameters[loss_map.BRAKING_TABLE]) if braking else loss_map.DRIVING_TABLE
            power = loss_map.loss_at(parameters, table, torque, rads)
        else:
            # without this, a kind without a branch here would have no losses
            raise ValueError("there is no kernel for this kind of drive")
    p, p_m, p_w, p_mm, p_mw, p_ww = power
    return (
        motors * p + share * effort * speed,
        motors * p_m * by_effort + share * speed,
        motors * p_w * turns + share * effort,
        motors * p_mm * by_effort * by_effort,
        motors * p_mw * by_effort * turns + share,
        motors * p_ww * turns * turns,
    )


@njit(cache=True)
def power_when_on(kind: int, parameters: FloatArray, braking: bool, effort: float, speed: float) -> PowerTerms:
    """Return the power at the terminals of a drive that is on [W], and its derivatives; negative where it generates.

    Parameters
    ----------
    kind, parameters : int and array
        Of the drive.
    braking : bool
        Whether the effort brakes.
    effort, speed : float
        Size of the effort [N] and speed [m/s].
    """
    return _power(kind, parameters, braking, effort, speed, False)


@njit(cache=True)
def smooth_power_when_on(kind: int, parameters: FloatArray, braking: bool, effort: float, speed: float) -> PowerTerms:
    """Return a power with continuous first derivatives, never more than that of `power_when_on`; arguments as there.

    For a solver that steps from derivative to derivative.
    """
    return _power(kind, parameters, braking, effort, speed, True)


@njit(cache=True)
def driving_power(kind: int, parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Return the supply power at a tractive effort [W], and its derivatives; zero at a negligible effort."""
    p, p_f, p_v, p_ff, p_fv, p_vv = power_when_on(kind, parameters, False, effort, speed)
    # slopes by effort stay: a solver at no effort must still see the cost of the first newton
    if IDLE_LOSSES[kind] and effort <= parameters[NEGLIGIBLE]:
        return 0.0, p_f, 0.0, p_ff, p_fv, 0.0
    return p, p_f, p_v, p_ff, p_fv, p_vv


@njit(cache=True)
def generated_power(kind: int, parameters: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Return the power generated at an electric braking effort [W], and its derivatives; zero at a negligible effort.

    Negative where braking needs power, unless the train has a standstill brake.
    """
    if IDLE_LOSSES[kind] and effort <= parameters[NEGLIGIBLE]:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    p, p_f, p_v, p_ff, p_fv, p_vv = power_when_on(kind, parameters, True, effort, speed)
    # motors that need power to brake are better off: the standstill brake then brakes for them
    if p > 0.0 and has_standstill_brake(kind, parameters):
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    return -p, -p_f, -p_v, -p_ff, -p_fv, -p_vv


@njit(cache=True)
def work_bounds(kind: int, parameters: FloatArray) -> tuple[float, float]:
    """Return the least supply energy per work of traction, and the most energy generated per work of braking."""
    if kind == CONSTANT_EFFICIENCY:
        return 1.0 / parameters[geared.TRACTION_EFFICIENCY], parameters[geared.BRAKING_EFFICIENCY]
    if IDLE_LOSSES[kind]:
        # losses and friction of the motors only add to the gear's share
        return parameters[DRIVING_SHARE], parameters[BRAKING_SHARE]
    return 1.0, 1.0


@njit(cache=True)
def shaft_force(kind: int, parameters: FloatArray, braking: bool, effort: float) -> tuple[float, float]:
    """Return the work of the shafts over distance [N] and its derivative by effort, negative where they are driven.

    Gear and friction are part of it; the rest of the power are losses that do not fall with speed.
    """
    sign = -1.0 if braking else 1.0
    if not IDLE_LOSSES[kind]:
        return sign * effort, sign
    by_effort = sign * parameters[BRAKING_SHARE if braking else DRIVING_SHARE]
    return parameters[MOTORS] * parameters[TURNS] * parameters[FRICTION] + by_effort * effort, by_effort


@njit(cache=True)
def has_standstill_brake(kind: int, parameters: FloatArray) -> bool:
    """Return whether another brake takes over where the electric one would need supply power."""
    return IDLE_LOSSES[kind] and parameters[STANDSTILL_BRAKE] > 0.0


@njit(cache=True)
def negligible_effort(kind: int, parameters: FloatArray) -> float:
    """Return the effort up to which a drive with idle losses is off [N]; zero of any other."""
    effort: float = parameters[NEGLIGIBLE] if IDLE_LOSSES[kind] else 0.0
    return effort


@njit(cache=True, nogil=True)
def electrical_power_array(
    kind: int, parameters: FloatArray, effort: FloatArray, speed: FloatArray, power: FloatArray
) -> None:
    """Fill `power` [W] for signed electric efforts [N] and speeds [m/s]; all of shape (n,).

    Positive is taken, negative is generated, before recuperation.
    """
    for i in range(effort.shape[0]):
        if effort[i] >= 0.0:
            power[i] = driving_power(kind, parameters, effort[i], speed[i])[0]
        else:
            power[i] = -generated_power(kind, parameters, -effort[i], speed[i])[0]
