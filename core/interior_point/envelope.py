"""The lower convex envelope of a drive's power over effort at each speed, for losses that stand in a map.

A map's losses may be concave in the torque, and jump with the speed: where an inverter changes its modulation, a cell
that drives at the faster side of it loses less. Both leave the relaxation local optima, some of them above runs. So it
is given a power that is nowhere above the true one, and better behaved:

- At each speed of a grid the points (0, 0), where the drive is off, and (f, p(f)) are replaced by their lower convex
  hull. The line from zero ends where it touches the power, other lines end at samples.
- If the line's energy per work is not convex in the square of the speed, the power there is lowered by the ratio of
  its lower convex hull to it; in braking, where it is negative, raised in size. It stays convex in effort.

Between the nodes of effort and speed the table is bicubic, with continuous first derivatives.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import power_when_on
from railjoule.core.drive.kinds import PowerTerms
from railjoule.core.interior_point.layout import ENVELOPE_EFFORTS, RAY_COUNT
from railjoule.core.physics.effort_limit import SLOWEST_MS, max_effort_slope
from railjoule.core.physics.mesh_data import MeshData

VALUE, BY_EFFORT, BY_SPEED, BY_BOTH = range(4)
"""Columns of a node: power [W] and its derivatives by effort [N] and speed [m/s]."""
# Of energy per work, which tends to one at high speeds. Nearer to rest braking generates less than that, or draws, and
# a ratio of two such numbers would scale it without bound
MIN_GAIN = 0.2
"""Braking is scaled only at speeds from which on it generates at least so much energy per work."""


@njit(cache=True, error_model="numpy")
def lower_hull(x: FloatArray, y: FloatArray, count: int, hull: IntArray) -> int:
    """Fill the numbers of the points on the lower convex hull of `count` points in rising x; return how many."""
    size = 0
    for i in range(count):
        # a point is no corner where the next one lies below the line through it
        while size > 1:
            a, b = hull[size - 2], hull[size - 1]
            if (y[b] - y[a]) * (x[i] - x[a]) < (y[i] - y[a]) * (x[b] - x[a]):
                break
            size -= 1
        hull[size] = i
        size += 1
    return size


@njit(cache=True, error_model="numpy")
def envelope_steps(mesh: MeshData) -> tuple[float, float]:
    """Return the steps of effort [N], driving and braking alike, and of speed [m/s] of a table."""
    effort = max(mesh.traction.constant_n, mesh.braking.constant_n) / (ENVELOPE_EFFORTS - 1)
    return effort, math.sqrt(mesh.limit_speed2.max()) / (RAY_COUNT - 2)


@njit(cache=True, error_model="numpy")
def tabulate_envelope(mesh: MeshData, table: FloatArray) -> None:
    """Fill the envelopes of driving and braking power.

    Parameters
    ----------
    mesh : MeshData
    table : array of shape (2, RAY_COUNT, ENVELOPE_EFFORTS, 4)
        By side, speed and effort; the columns as numbered above.
    """
    step, speed_step = envelope_steps(mesh)
    slopes = np.empty((RAY_COUNT, 2))
    for side in range(2):
        for k in range(RAY_COUNT):
            slopes[k] = _fill_effort_hull(mesh, side == 1, max(k * speed_step, SLOWEST_MS), step, table[side, k])
        _scale_to_convex(slopes, speed_step, side == 1, table[side])


@njit(cache=True, error_model="numpy")
def _fill_effort_hull(
    mesh: MeshData, braking: bool, speed: float, step: float, nodes: FloatArray
) -> tuple[float, float]:
    """Fill the nodes of one speed; return the slope of the line from zero [W/N] and its derivative by speed."""
    kind, parameters = mesh.drive_kind, mesh.drive_parameters
    end, end_v = max_effort_slope(mesh.braking if braking else mesh.traction, speed)
    if end < step:
        # The drive can do next to nothing here. A line to its limit would be as steep as its idle power is over that,
        # and the cubics would carry it on to the speeds beside
        end, end_v = step, 0.0
    last = min(int(end / step), ENVELOPE_EFFORTS - 1)
    # zero, the nodes below the limit, and the limit itself, unless it is all but a node
    count = last + 2 if end - last * step > 1e-6 * step else last + 1
    x, terms, hull = np.empty(count), np.empty((count, 5)), np.empty(count, dtype=np.int64)
    for i in range(1, count):
        x[i] = end if i > last else i * step
        p, p_f, p_v, p_ff, p_fv, _ = power_when_on(kind, parameters, braking, x[i], speed)
        terms[i, 0], terms[i, 1], terms[i, 2], terms[i, 3], terms[i, 4] = p, p_f, p_v, p_ff, p_fv
    # off at no effort
    x[0], terms[0] = 0.0, 0.0
    corners = lower_hull(x, terms[:, 0], count, hull)
    touch, line = x[hull[1]], terms[hull[1]]
    slope, slope_v = line[0] / touch, line[2] / touch
    if hull[1] < count - 1:
        # the tangent point between samples: Newton's step on y p_f(y) = p(y), which is zero there
        y = touch - (touch * line[1] - line[0]) / (touch * line[3]) if line[3] > 0.0 else touch
        # where another line begins at that sample, it ends the first one as well
        most = min(touch + step, end) if hull[2] == hull[1] + 1 else touch
        y = min(max(y, touch - step, 1e-3 * step), most)
        found = power_when_on(kind, parameters, braking, y, speed)
        if found[0] / y < slope:
            touch, slope, slope_v = y, found[0] / y, found[2] / y
    else:
        slope_v += (line[1] - slope) * end_v / touch
    _fill_nodes(nodes, step, x, terms, hull[:corners], (touch, slope, slope_v), (last, end_v))
    return slope, slope_v


@njit(cache=True, error_model="numpy")
def _fill_nodes(
    nodes: FloatArray,
    step: float,
    x: FloatArray,
    terms: FloatArray,
    hull: IntArray,
    line: tuple[float, float, float],
    limit: tuple[int, float],
) -> None:
    """Fill the nodes of one speed from the hull of its samples.

    Parameters
    ----------
    nodes : array of shape (ENVELOPE_EFFORTS, 4)
    step : float
        Of effort [N].
    x, terms : arrays of shape (m,) and (m, 5)
        Samples: efforts [N], and powers with their derivatives.
    hull : array of shape (c,)
        Which of them lie on the lower convex hull.
    line : tuple
        The effort at which the line from zero touches the power [N], its slope and the slope's derivative by speed.
    limit : tuple
        The last node up to the limit, and the derivative of the limit by speed.
    """
    touch, slope, slope_v = line
    last, end_v = limit
    corner = 1
    for j in range(nodes.shape[0]):
        y = j * step
        while corner < hull.shape[0] - 1 and hull[corner] < j:
            corner += 1
        # beyond the limit nothing is driven: any continuation serves that keeps slopes continuous
        final = x.shape[0] - 1
        if y <= touch or (touch >= x[final] and j > last):
            nodes[j, VALUE], nodes[j, BY_EFFORT], nodes[j, BY_SPEED], nodes[j, BY_BOTH] = (
                slope * y, slope, slope_v * y, slope_v,
            )  # fmt: skip
        elif j > last:
            p, p_f, p_v, p_ff, p_fv = terms[final]
            beyond, change = y - x[final], p_fv + p_ff * end_v
            nodes[j, VALUE], nodes[j, BY_EFFORT] = p + p_f * beyond, p_f
            nodes[j, BY_SPEED], nodes[j, BY_BOTH] = p_v + change * beyond, change
        elif hull[corner] == j or corner == 1:
            p, p_f, p_v, _, p_fv = terms[j]
            nodes[j, VALUE], nodes[j, BY_EFFORT], nodes[j, BY_SPEED], nodes[j, BY_BOTH] = p, p_f, p_v, p_fv
        else:
            # within a line between two samples: by the envelope theorem its ends move along with the power only
            a, b = hull[corner - 1], hull[corner]
            along, rise = (y - x[a]) / (x[b] - x[a]), (terms[b] - terms[a]) / (x[b] - x[a])
            nodes[j, VALUE], nodes[j, BY_EFFORT] = terms[a, 0] + rise[0] * (y - x[a]), rise[0]
            nodes[j, BY_SPEED] = (1.0 - along) * terms[a, 2] + along * terms[b, 2]
            nodes[j, BY_BOTH] = rise[2]


@njit(cache=True, error_model="numpy")
def _scale_to_convex(slopes: FloatArray, step: float, braking: bool, nodes: FloatArray) -> None:
    """Lower the powers of all speeds so that the energy per work of the line from zero is convex in speed squared.

    Parameters
    ----------
    slopes : array of shape (RAY_COUNT, 2)
        Slope of the line from zero [W/N] and its derivative by speed.
    step : float
        Of speed [m/s].
    braking : bool
    nodes : array of shape (RAY_COUNT, ENVELOPE_EFFORTS, 4)
    """
    first = 1
    if braking:
        first = RAY_COUNT
        while first > 1 and slopes[first - 1, 0] < -MIN_GAIN * (first - 1) * step:
            first -= 1
    count = RAY_COUNT - first
    if count < 3:
        return
    w, energy, hull = np.empty(count), np.empty(count), np.empty(count, dtype=np.int64)
    for i in range(count):
        v = (first + i) * step
        w[i], energy[i] = v * v, slopes[first + i, 0] / v
    corners = lower_hull(w, energy, count, hull)
    for corner in range(corners - 1):
        a, b = hull[corner], hull[corner + 1]
        rise = (energy[b] - energy[a]) / (w[b] - w[a])
        for i in range(a + 1, b):
            v = (first + i) * step
            lowered = energy[a] + rise * (w[i] - w[a])
            ratio = lowered / energy[i]
            energy_v = (slopes[first + i, 1] - energy[i]) / v
            ratio_v = (2.0 * v * rise - ratio * energy_v) / energy[i]
            for j in range(nodes.shape[1]):
                node = nodes[first + i, j]
                node[BY_SPEED] = ratio * node[BY_SPEED] + ratio_v * node[VALUE]
                node[BY_BOTH] = ratio * node[BY_BOTH] + ratio_v * node[BY_EFFORT]
                node[VALUE] *= ratio
                node[BY_EFFORT] *= ratio


@njit(cache=True, error_model="numpy")
def envelope_power(mesh: MeshData, table: FloatArray, effort: float, speed: float) -> PowerTerms:
    """Return the power of the envelope [W] at an effort [N] and speed [m/s], and its derivatives.

    Parameters
    ----------
    mesh : MeshData
    table : array of shape (RAY_COUNT, ENVELOPE_EFFORTS, 4)
        Of driving or braking.
    effort, speed : float
    """
    df, dv = envelope_steps(mesh)
    # not a number becomes a large negative integer: it must not lead out of the table
    j = max(min(int(effort / df), ENVELOPE_EFFORTS - 2), 0)
    k = max(min(int(speed / dv), RAY_COUNT - 2), 0)
    a, b = _hermite(effort / df - j), _hermite(speed / dv - k)
    p = p_f = p_v = p_ff = p_fv = p_vv = 0.0
    for m in range(2):
        for n in range(2):
            node = table[k + n, j + m]
            g, g_f, g_v, g_fv = node[VALUE], node[BY_EFFORT] * df, node[BY_SPEED] * dv, node[BY_BOTH] * df * dv
            # basis functions of value and slope at this corner, each with two derivatives
            x, y = a[m], b[n]
            low, low_1, low_2 = g * y[0] + g_v * y[3], g * y[1] + g_v * y[4], g * y[2] + g_v * y[5]
            rise, rise_1, rise_2 = g_f * y[0] + g_fv * y[3], g_f * y[1] + g_fv * y[4], g_f * y[2] + g_fv * y[5]
            p += x[0] * low + x[3] * rise
            p_f += x[1] * low + x[4] * rise
            p_ff += x[2] * low + x[5] * rise
            p_v += x[0] * low_1 + x[3] * rise_1
            p_fv += x[1] * low_1 + x[4] * rise_1
            p_vv += x[0] * low_2 + x[3] * rise_2
    return p, p_f / df, p_v / dv, p_ff / (df * df), p_fv / (df * dv), p_vv / (dv * dv)


@njit(cache=True, error_model="numpy")
def _hermite(x: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return, of both ends of [0, 1], the cubics of a value and of a slope at x, each with two derivatives."""
    square, cube = x * x, x * x * x
    value, slope = 3.0 * square - 2.0 * cube, cube - square
    value_1, value_2 = 6.0 * (x - square), 6.0 - 12.0 * x
    slope_1, slope_2 = 3.0 * square - 2.0 * x, 6.0 * x - 2.0
    start = (1.0 - value, -value_1, -value_2, slope - square + x, slope_1 - 2.0 * x + 1.0, slope_2 - 2.0)
    return start, (value, value_1, value_2, slope, slope_1, slope_2)
