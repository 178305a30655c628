"""The motion of a train through one cell of the mesh, from a square of speed w0 at its start to w1 at its end.

The net force of a cell is constant, so w = v^2 is linear over its length h, dw/ds = 2 F / m, and with half the inertia
over the length, k = m / (2 h):

    mean speed over time    v = (v0 + v1) / 2                     dv/dw0 = 1 / (4 v0)    d2v/dw0^2 = -1 / (8 v0^3)
    time                    t = h / v                             exact: v rises evenly with time
    force at the wheels     F = k (w1 - w0) + R(v, (w0 + w1) / 2) + line
                            dF/dw0 = -k + C / 2 + B dv/dw0        dF/dw1 = k + C / 2 + B dv/dw1

with the running resistance R of `resistance`, and the mean of its starting resistance where there is one. A cell may be
scaled: where its force is to come out in shares of an effort, its inertia and its coefficients are divided by that.
"""

from typing import NamedTuple

from railjoule.core.compiled import Numbers, Value, formula
from railjoule.core.physics.resistance import mean_starting_resistance, mean_starting_slopes, running_resistance

NEARLY_AT_REST_MS = 1e-9
"""Stands for rest in the mean speed of a cell, where the effort of a limit of power would be infinite."""


class Cell(NamedTuple):
    """The parameters of the motion through a cell, and its supply: numbers of one cell, or arrays of many.

    Plain numbers: inner loops that make a tuple with arrays in it for each cell are ten times slower.

    Parameters
    ----------
    length_m : float or array
        h [m].
    inertia : float or array
        k, force over the change of speed squared [N s2/m2].
    constant_n : float or array
        Resistance at any speed: A and the forces of the line [N].
    linear : float
        B [N s/m].
    quadratic : float or array
        C [N s2/m2].
    supply_share : float or array
        Share of the drive's largest efforts that the supply allows: 1, or next to nothing in a neutral section, as an
        interior-point method needs a strictly feasible start.
    starting_n, starting_ends_ms : float
        Starting resistance at rest [N], 0 where there is none, and the speed at which it ends [m/s].
    """

    length_m: Numbers
    inertia: Numbers
    constant_n: Numbers
    linear: Numbers
    quadratic: Numbers
    supply_share: Numbers
    starting_n: Numbers = 0.0
    starting_ends_ms: Numbers = 1.0


@formula
def mean_speed(start_speed: Value, end_speed: Value) -> Value:
    """Return the mean speed over time [m/s] between two speeds [m/s]."""
    return 0.5 * (start_speed + end_speed)


@formula
def mean_speed_slope(speed: float) -> float:
    """Return the derivative of the mean speed by the square of one of its two speeds [s/m]; infinite at rest."""
    return 0.25 / speed


@formula
def mean_speed_curvature(slope: float, speed2: float) -> float:
    """Return the second derivative of the mean speed by the square of one of its two speeds, from the first."""
    # 1 / (4 sqrt(w)) differentiated once more: -1 / (8 w sqrt(w))
    return -0.5 * slope / speed2


@formula
def duration(length_m: Value, mean_speed: Value) -> Value:
    """Return the time [s] over a length [m]."""
    return length_m / mean_speed


@formula
def needed_force(cell: Cell, start_speed2: Value, end_speed2: Value, mean_speed: Value) -> Value:
    """Return the force at the wheels [N] that leads from one square of speed [m2/s2] to another; braking is negative.

    The mean speed [m/s] is the caller's: a bound may take the least one of a range.
    """
    mean_speed2 = 0.5 * (start_speed2 + end_speed2)
    resistance = running_resistance(cell.constant_n, cell.linear, cell.quadratic, mean_speed, mean_speed2)
    force: Value = cell.inertia * (end_speed2 - start_speed2) + resistance
    if cell.starting_n > 0.0:
        force = force + mean_starting_resistance(cell.starting_n, cell.starting_ends_ms, start_speed2, end_speed2)
    return force


@formula
def force_slopes(
    cell: Cell, start_speed2: float, end_speed2: float, start_slope: float, end_slope: float
) -> tuple[float, float]:
    """Return the derivatives of `needed_force` by the squares of speed at start and end [N s2/m2].

    `start_slope` and `end_slope` are those of the mean speed [s/m], zero where an end is prescribed.
    """
    # C acts on the mean of both squares of speed, so each end has half of it; B on the mean speed, by its slope
    half = 0.5 * cell.quadratic
    by_start, by_end = cell.linear * start_slope - (cell.inertia - half), cell.linear * end_slope + cell.inertia + half
    if cell.starting_n > 0.0:
        more = mean_starting_slopes(cell.starting_n, cell.starting_ends_ms, start_speed2, end_speed2)
        by_start, by_end = by_start + more[0], by_end + more[1]
    return by_start, by_end


@formula
def reached_speed2(cell: Cell, start_speed2: float, known_speed2: float, mean_speed: float, force: float) -> float:
    """Return the square of speed at the end of a cell [m2/s2] to which a force [N] leads: `needed_force` the other way.

    At a mean speed and a square of speed at the end that are taken for known; where B or the starting resistance is not
    zero or the force varies with speed, a caller iterates.
    """
    half = 0.5 * cell.quadratic
    # needed_force(w0, w1) = F solved for w1: w1 (k + C / 2) = w0 (k - C / 2) - A - B v + F
    left = (cell.inertia - half) * start_speed2 - cell.constant_n - cell.linear * mean_speed
    if cell.starting_n > 0.0:
        end2 = max(known_speed2, 0.0)
        left -= mean_starting_resistance(cell.starting_n, cell.starting_ends_ms, start_speed2, end2)
    speed2: float = (left + force) / (cell.inertia + half)
    return speed2
