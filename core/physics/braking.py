"""How the electric brake and friction brakes share a braking effort.

The electric brake comes first, as far as it goes; friction brakes do what is left. They do more where that gives the
line more or takes less from it: generated power is concave in the effort, F v less losses that grow faster than it,
and near standstill it falls, below zero at last. There the electric brake does as much as generates most, and what
friction cannot do. As `line_power` rises with the power at the terminals, most generated is least taken from the line,
whatever the recuperation factor.
"""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import generated_power, may_draw_while_braking
from railjoule.core.physics.cell import NEARLY_AT_REST_MS

# halved as often, any bracket of efforts is below rounding
MAX_STEPS = 60
# generated power is stationary there, so that the power is exact to the square of this
EXACT = 1e-9
"""How close to its best the electric effort need be found, as a share."""


@njit(cache=True, error_model="numpy")
def electric_effort(
    drive_kind: int,
    drive_parameters: FloatArray,
    braking: float,
    speed: float,
    strongest: float,
    friction: float,
) -> float:
    """Return the electric brake's part of a braking effort [N].

    Parameters
    ----------
    drive_kind, drive_parameters : int and array
        What `railjoule.core.drive.kernels` take.
    braking, speed : float
        The whole effort [N] at a speed above zero [m/s].
    strongest, friction : float
        Largest efforts of the electric brake at that speed, and of the friction brakes [N]. Without friction brakes
        the electric brake does all, even what its limit leaves by rounding.
    """
    if friction <= 0.0:
        return braking
    return _shared_effort(drive_kind, drive_parameters, braking, speed, strongest, friction)


@njit(cache=True, error_model="numpy")
def _shared_effort(
    drive_kind: int, drive_parameters: FloatArray, braking: float, speed: float, strongest: float, friction: float
) -> float:
    """Return the same for a train with friction brakes: its own function, so that the check above costs nothing."""
    first = min(braking, strongest)
    if not may_draw_while_braking(drive_kind):
        return first
    power = generated_power(drive_kind, drive_parameters, first, speed)
    # concave and still rising: no smaller effort generates more
    if power[0] >= 0.0 and power[1] >= 0.0:
        return first
    least = max(braking - friction, 0.0)
    if least >= first:
        return first
    at_least = generated_power(drive_kind, drive_parameters, least, speed)
    # power may jump where the drive turns off, at no effort: compare both ends, then look between them
    best, most = (least, at_least[0]) if at_least[0] > power[0] else (first, power[0])
    # concave: between the ends it is greatest where the slope changes its sign, and nowhere if it does not
    if power[1] < 0.0 <= at_least[1]:
        between = max_generating(drive_kind, drive_parameters, least, first, speed)
        if generated_power(drive_kind, drive_parameters, between, speed)[0] > most:
            best = between
    return best


@njit(cache=True, error_model="numpy")
def max_generating(drive_kind: int, drive_parameters: FloatArray, low: float, high: float, speed: float) -> float:
    """Return the effort between two [N] that generates most: Newton's rule on the slope, kept inside a bracket."""
    effort, exact = high, EXACT * high
    for _ in range(MAX_STEPS):
        _, slope, _, curvature, _, _ = generated_power(drive_kind, drive_parameters, effort, speed)
        if slope < 0.0:
            high = effort
        else:
            low = effort
        # no step without curvature: the lower end fails the next test, and the bracket is halved
        step = effort - slope / curvature if curvature < 0.0 else low
        if not low < step < high:
            step = 0.5 * (low + high)
        if abs(step - effort) <= exact:
            return step
        effort = step
    return effort


@njit(cache=True, error_model="numpy", nogil=True)
def _fill_electric(
    drive_kind: int,
    drive_parameters: FloatArray,
    braking: FloatArray,
    speed: FloatArray,
    strongest: FloatArray,
    friction: float,
    electric: FloatArray,
) -> None:
    for i in range(braking.shape[0]):
        # at rest no power flows, whatever brakes
        v = max(speed[i], NEARLY_AT_REST_MS)
        electric[i] = electric_effort(drive_kind, drive_parameters, braking[i], v, strongest[i], friction)


def electric_efforts(
    drive_kind: int,
    drive_parameters: FloatArray,
    braking_n: FloatArray,
    speed_ms: FloatArray,
    strongest_n: FloatArray,
    friction_n: float,
) -> FloatArray:
    """Return `electric_effort` for arrays of shape (n,)."""
    electric = np.empty(len(braking_n))
    _fill_electric(drive_kind, drive_parameters, braking_n, speed_ms, strongest_n, friction_n, electric)
    return electric
