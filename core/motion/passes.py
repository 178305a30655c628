"""The greatest speed at every place, by one pass forward and one backward over the mesh.

Problem: among all runs that keep every limit, the one that is fastest everywhere at once. Forward, each cell
starts from the greatest speed reached so far and uses full effort; backward, each cell ends at the greatest
speed allowed there and brakes fully. Both steps are exact for the mesh.

Limits of acceleration and deceleration bound speeds from the other side as well: uphill, full effort may not keep
the deceleration small enough, downhill, full braking not the acceleration. The speeds above which that happens are
taken off first; then the passes settle at once, unless no speed is slow enough.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.motion.course import CourseData
from railjoule.core.motion.effort_limit import EffortLimit, limit_over_speed

MOVED = -1
"""Result of a pass that met no obstacle."""
MOST_PASSES = 50
ROOT_STEPS = 80


@njit(cache=True)
def _excess(
    limit: EffortLimit,
    inertia: float,
    against: float,
    linear: float,
    quadratic: float,
    known: float,
    x: float,
    sign: float,
) -> tuple[float, float]:
    """Return by how much the force of a cell exceeds the largest effort [N], and its derivative.

    `known` is the speed squared at one end, `x` the unknown one at the other; `sign` is 1 where the cell
    starts with `known` under full traction, -1 where it ends with it under full braking. `against` is the
    part of the resistance that does not vary with speed.
    """
    root = math.sqrt(x)
    mean_speed = max(0.5 * (math.sqrt(known) + root), 1e-9)
    mean_slope = 0.25 / root if root > 0.0 else 0.0
    value = inertia * (x - known) + sign * (against + linear * mean_speed + 0.5 * quadratic * (known + x))
    slope = inertia + sign * (0.5 * quadratic + linear * mean_slope)
    # most cells are slow enough for the constant limit: no look at the other
    if limit.power_w < np.inf or limit.table.shape[0] > 0:
        effort, effort_slope, _ = limit_over_speed(limit, mean_speed)
        if effort < limit.constant_n:
            return value - effort, slope - effort_slope * mean_slope
    return value - limit.constant_n, slope


@njit(cache=True)
def _greatest_reachable(
    limit: EffortLimit,
    inertia: float,
    against: float,
    linear: float,
    quadratic: float,
    known: float,
    bound: float,
    sign: float,
) -> float:
    """Return the greatest speed squared up to `bound` at the unknown end of a cell; negative if there is none.

    Arguments as in `_excess`, which rises with the unknown: Newton's rule, kept inside a bracket.
    """
    if _excess(limit, inertia, against, linear, quadratic, known, bound, sign)[0] <= 0.0:
        return bound
    value, slope = _excess(limit, inertia, against, linear, quadratic, known, known, sign)
    low, high, x = 0.0, bound, known
    if value > 0.0:
        high = known
        if _excess(limit, inertia, against, linear, quadratic, known, 0.0, sign)[0] > 0.0:
            return -1.0
    else:
        low = known
    for _ in range(ROOT_STEPS):
        step = x - value / slope if slope > 0.0 else low
        if abs(step - x) <= 1e-13 * bound or high - low <= 1e-13 * bound:
            break
        if not low < step < high:
            step = 0.5 * (low + high)
        x = step
        value, slope = _excess(limit, inertia, against, linear, quadratic, known, x, sign)
        if value > 0.0:
            high = x
        else:
            low = x
    return min(x, high)


@njit(cache=True)
def _greatest_steady(
    limit: EffortLimit,
    inertia: float,
    against: float,
    linear: float,
    quadratic: float,
    bound: float,
    change: float,
    sign: float,
) -> float:
    """Return the greatest speed squared up to `bound` from which the effort keeps the speed squared within `change`.

    Arguments as in `_excess`: at the known end the speed squared is the result, at the other end less by `change`.
    """
    if bound <= change or _excess(limit, inertia, against, linear, quadratic, bound, bound - change, sign)[0] <= 0.0:
        return bound
    low, high = change, bound
    for _ in range(ROOT_STEPS):
        x = 0.5 * (low + high)
        if _excess(limit, inertia, against, linear, quadratic, x, x - change, sign)[0] > 0.0:
            high = x
        else:
            low = x
    return low


@njit(cache=True)
def _take_off_unsteady(course: CourseData, speed2: FloatArray) -> None:
    """Lower `speed2` to where full effort keeps the deceleration, and full braking the acceleration, within limits."""
    for i in range(course.cell_length_m.shape[0]):
        h = course.cell_length_m[i]
        inertia = course.half_inertia_kg / h
        against = course.line_force_n[i] + course.resistance_constant_n
        linear, quadratic = course.resistance_linear, course.resistance_quadratic[i]
        if course.max_deceleration_ms2 < np.inf:
            change = 2.0 * course.max_deceleration_ms2 * h
            speed2[i] = _greatest_steady(course.traction, inertia, against, linear, quadratic, speed2[i], change, 1.0)
        if course.max_acceleration_ms2 < np.inf:
            change = 2.0 * course.max_acceleration_ms2 * h
            against += course.friction_effort_n
            speed2[i + 1] = _greatest_steady(
                course.braking, inertia, against, linear, quadratic, speed2[i + 1], change, -1.0
            )


@njit(cache=True)
def _forward(course: CourseData, speed2: FloatArray) -> int:
    """Lower `speed2` to what full effort reaches; return the cell that cannot be passed, or MOVED."""
    for i in range(course.cell_length_m.shape[0]):
        h = course.cell_length_m[i]
        reached = _greatest_reachable(
            course.traction,
            course.half_inertia_kg / h,
            course.line_force_n[i] + course.resistance_constant_n,
            course.resistance_linear,
            course.resistance_quadratic[i],
            speed2[i],
            min(speed2[i + 1], speed2[i] + 2.0 * course.max_acceleration_ms2 * h),
            1.0,
        )
        if reached < 0.0 or (reached <= 0.0 and course.fixed_speed2[i + 1] != 0.0):
            return i
        speed2[i + 1] = reached
    return MOVED


@njit(cache=True)
def entering_speed2_under_brakes(
    course: CourseData, number: int, leaving_speed2: float, largest_speed2: float
) -> float:
    """Return the greatest square of speed, up to `largest_speed2`, at the start of a cell that full braking leaves.

    Negative where full braking does not slow the train down to `leaving_speed2` at all; all in [m2/s2].
    """
    h = course.cell_length_m[number]
    return _greatest_reachable(
        course.braking,
        course.half_inertia_kg / h,
        course.line_force_n[number] + course.resistance_constant_n + course.friction_effort_n,
        course.resistance_linear,
        course.resistance_quadratic[number],
        leaving_speed2,
        largest_speed2,
        -1.0,
    )


@njit(cache=True)
def _backward(course: CourseData, speed2: FloatArray) -> int:
    """Lower `speed2` to what full braking can still slow down; return the cell that cannot be passed, or MOVED."""
    for i in range(course.cell_length_m.shape[0] - 1, -1, -1):
        h = course.cell_length_m[i]
        entered = _greatest_reachable(
            course.braking,
            course.half_inertia_kg / h,
            course.line_force_n[i] + course.resistance_constant_n + course.friction_effort_n,
            course.resistance_linear,
            course.resistance_quadratic[i],
            speed2[i + 1],
            min(speed2[i], speed2[i + 1] + 2.0 * course.max_deceleration_ms2 * h),
            -1.0,
        )
        if entered < 0.0 or (entered <= 0.0 and course.fixed_speed2[i] != 0.0):
            return i
        speed2[i] = entered
    return MOVED


@njit(cache=True, nogil=True)
def greatest_speeds(course: CourseData) -> tuple[FloatArray, int, bool]:
    """Return the greatest feasible squares of speed, the obstacle and whether it was met while braking.

    Returns
    -------
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2].
    obstacle : int
        A cell that no run can pass, or MOVED.
    braking : bool
        Whether that cell asks for more braking, not more traction.
    """
    nodes = course.largest_speed2.shape[0]
    speed2 = course.largest_speed2.copy()
    for i in range(nodes):
        if course.fixed_speed2[i] >= 0.0:
            speed2[i] = min(course.fixed_speed2[i], speed2[i])
    _take_off_unsteady(course, speed2)
    once = course.max_deceleration_ms2 == np.inf and course.max_acceleration_ms2 == np.inf
    before = np.empty(nodes)
    for _ in range(MOST_PASSES):
        before[:] = speed2
        obstacle = _forward(course, speed2)
        if obstacle != MOVED:
            return speed2, obstacle, False
        obstacle = _backward(course, speed2)
        if obstacle != MOVED:
            return speed2, obstacle, True
        for i in range(nodes):
            fixed = course.fixed_speed2[i]
            # an end's speed is prescribed: a run that cannot have it is none
            if fixed >= 0.0 and speed2[i] < fixed * (1.0 - 1e-9):
                return speed2, max(i - 1, 0), i == 0
        if once or np.max(np.abs(before - speed2)) <= 1e-12 * np.max(speed2):
            return speed2, MOVED, False
    # speeds that still fall have no end but a stand, at a place that the train may not run down so fast
    return speed2, max(int(np.argmax(before - speed2)) - 1, 0), True


@njit(cache=True, nogil=True)
def slowed_to_reach(course: CourseData, speed2: FloatArray) -> FloatArray:
    """Return squares of speed lowered to what full effort reaches and full braking can still slow down.

    Parameters
    ----------
    course : CourseData
        What the run obeys.
    speed2 : array of shape (n + 1,)
        Squares of speed [m2/s2], none above the greatest feasible ones.
    """
    lowered = speed2.copy()
    _forward(course, lowered)
    _backward(course, lowered)
    return lowered


@njit(cache=True, nogil=True)
def running_time(cell_length_m: FloatArray, speed2: FloatArray) -> float:
    """Return the time of a run [s]: 2 h / (v0 + v1) a cell."""
    total = 0.0
    for i in range(cell_length_m.shape[0]):
        total += 2.0 * cell_length_m[i] / (math.sqrt(speed2[i]) + math.sqrt(speed2[i + 1]))
    return total
