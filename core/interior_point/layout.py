"""How the interior-point method lays out its numbers.

Scaled: efforts in shares of the largest tractive effort, energies in metres times that effort; speeds, times and
lengths in SI. A cell has a tractive effort f, an electric braking effort x and a friction effort q, bound by
x + q = f - D(w), where D is the net force that its change of speed squared needs. Without friction brakes x is no
variable of its own. If a drive may draw power to brake, psi stands for the larger of 0 and phi, the energy per
metre that braking draws (negative where it generates).

Constraints g >= 0 of a cell, each with a slack and a multiplier, and their derivatives by their own variable and
by the mean speed v of the cell:

    row                  g                             variable   by it       by v
    TRACTION_POSITIVE    f                             f          1           0
    TRACTION_CONSTANT    1 - f                         f          -1          0
    TRACTION_OVER_SPEED  L(v) - f                      f          -1          L'
    BRAKING_POSITIVE     x                             x          1           0
    BRAKING_CONSTANT     largest electric effort - x   x          -1          0
    BRAKING_OVER_SPEED   Lb(v) - x                     x          -1          Lb'
    DRAWN_POSITIVE       psi                           psi
    DRAWN                psi - phi(x, v)               x, psi     -dphi/dx    -dphi/dv
    FRICTION_POSITIVE    q                             q          1
    FRICTION_CONSTANT    largest friction effort - q   q          -1
    ACCELERATION         largest inertia force - k (w1 - w0)
    DECELERATION         largest inertia force + k (w1 - w0)

Per node there are two, w above a floor and below the limit, and one for the time. In a neutral section the largest
efforts of the drive are next to nothing in place of 1 and the electric brake's, and no limit over speed is used.
"""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit

(
    TRACTION_POSITIVE,
    TRACTION_CONSTANT,
    TRACTION_OVER_SPEED,
    BRAKING_POSITIVE,
    BRAKING_CONSTANT,
    BRAKING_OVER_SPEED,
    DRAWN_POSITIVE,
    DRAWN,
    FRICTION_POSITIVE,
    FRICTION_CONSTANT,
    ACCELERATION,
    DECELERATION,
) = range(12)
ROWS = 12
FLOOR, CEILING = range(2)
"""Rows of the nodes' constraints."""
(
    DRIVING_FF,
    DRIVING_FV,
    DRIVING_VV,
    BRAKING_XX,
    BRAKING_XV,
    BRAKING_VV,
    PRICED_VV,
    START_WW,
    END_WW,
) = range(9)
"""Rows of `Work.curvature`: second derivatives of the Lagrangian of a cell. The cost of driving by traction f and mean
speed v, that of braking by x and v, priced time and limits by v, and what the concave mean speed adds by each w."""
CURVATURES = 9
RAY_COUNT = 200
"""Speeds of the table of a drive with idle losses."""
# A cubic over a step misses a power whose second derivative jumps within it by a thirtieth of the jump times the step
# squared: of losses that are a tenth of the power, a millionth of that. Twice as many take twice the time to fill.
ENVELOPE_EFFORTS = 65
"""Efforts of the table of envelopes of a drive whose losses stand in a map."""
# Slack and multiplier of the timetable stand outside of all rows: it couples all cells, so its step is solved for by a
# rank-one update of the tridiagonal system, never row by row.
TIME_SLACK, TIME_MULTIPLIER = range(2)
"""Entries of `Work.time_step`."""

FAST = {"contract", "reassoc", "nsz", "arcp"}
"""Liberties of the compiler; NaN and infinity keep their meaning."""


class Cells(NamedTuple):
    """Arrays of shape (n,), one number a cell."""

    # the point: f, x and psi, and their steps
    traction: FloatArray
    braking: FloatArray
    drawn: FloatArray
    traction_step: FloatArray
    braking_step: FloatArray
    drawn_step: FloatArray
    # net force D and mean speed v at the point, and their derivatives by w0 and w1; k
    force: FloatArray
    force_by_start: FloatArray
    force_by_end: FloatArray
    speed_by_start: FloatArray
    speed_by_end: FloatArray
    inertia: FloatArray
    # how psi follows x and v once it is eliminated
    drawn_by_effort: FloatArray
    drawn_by_speed: FloatArray
    # derivatives of the Lagrangian by f, x and v, and the multiplier of x + q = f - D
    traction_gradient: FloatArray
    braking_gradient: FloatArray
    speed_gradient: FloatArray
    force_price: FloatArray
    # the cell's second-order model after condensing (`newton`): weight on (effort + slope * v)^2 for traction, for all
    # brakes together and for each brake; the coupling of both nodes that is left once efforts are eliminated
    traction_weight: FloatArray
    traction_slope: FloatArray
    braking_weight: FloatArray
    braking_slope: FloatArray
    electric_weight: FloatArray
    friction_weight: FloatArray
    coupling_start: FloatArray
    coupling_end: FloatArray
    # right-hand sides of the efforts, kept for `step.expand`
    traction_right: FloatArray
    electric_right: FloatArray
    friction_right: FloatArray
    drawn_right: FloatArray


class Rows(NamedTuple):
    """Arrays of shape (rows, n): the constraints of cells (12 rows) or of nodes (2 rows, floor and ceiling)."""

    slack: FloatArray
    multiplier: FloatArray
    # of the barrier: the length for which a constraint stands; 0 where it does not occur
    weight: FloatArray
    # g - slack
    residual: FloatArray
    # derivatives of g where they are not constant
    by_effort: FloatArray
    by_speed: FloatArray
    slack_step: FloatArray
    multiplier_step: FloatArray
    # what slack times multiplier is aimed at, over the slack; and what the row adds to the right-hand side
    target: FloatArray
    rhs: FloatArray


class Nodes(NamedTuple):
    """Arrays of shape (n + 1,), one number a node."""

    speed2: FloatArray
    # the right-hand side until it is solved for, then the step
    speed2_step: FloatArray
    # 1 where the speed is unknown, 0 where it is prescribed: a factor, so that inner loops do not branch
    free: FloatArray
    floor: FloatArray
    ceiling: FloatArray
    # derivatives of the Lagrangian and of the travel time by w; the tridiagonal system's answer to the latter
    gradient: FloatArray
    time_gradient: FloatArray
    time_response: FloatArray
    # factors of the tridiagonal system
    inverse_pivot: FloatArray
    ratio: FloatArray


class Work(NamedTuple):
    """All arrays of one solution.

    `curvature` has shape (9, n), its rows as numbered above. Of a drive with idle losses, `rays` is the table of
    `switching.tabulate_rays` or `envelope` that of `envelope.tabulate_envelope`, and `last_curvature`, shape (6, n),
    has the first six rows of `curvature` an iteration ago. `time_step` holds the steps of the timetable's slack and
    multiplier; `used` is 1 for the rows that occur at all.
    """

    cells: Cells
    rows: Rows
    nodes: Nodes
    bounds: Rows
    curvature: FloatArray
    rays: FloatArray
    envelope: FloatArray
    last_curvature: FloatArray
    time_step: FloatArray
    used: FloatArray


@njit(cache=True)
def _rows(count: int, length: int) -> Rows:
    return Rows(
        np.ones((count, length)),
        np.zeros((count, length)),
        np.zeros((count, length)),
        np.zeros((count, length)),
        np.zeros((count, length)),
        np.zeros((count, length)),
        np.zeros((count, length)),
        np.zeros((count, length)),
        np.zeros((count, length)),
        np.zeros((count, length)),
    )


@njit(cache=True)
def allocate(n: int, envelope_efforts: int) -> Work:
    """Return the zeroed work arrays of a meshed line with `n` cells; all slacks are 1.

    The table of envelopes holds so many efforts, none where a drive has no use for it.
    """
    c = np.zeros((30, n))
    m = np.zeros((10, n + 1))
    cells = Cells(
        c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8], c[9],
        c[10], c[11], c[12], c[13], c[14], c[15], c[16], c[17], c[18], c[19],
        c[20], c[21], c[22], c[23], c[24], c[25], c[26], c[27], c[28], c[29],
    )  # fmt: skip
    nodes = Nodes(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9])
    curvature, rays, last_curvature = np.zeros((CURVATURES, n)), np.zeros((2, RAY_COUNT, 3)), np.zeros((6, n))
    envelope, bounds, used = np.zeros((2, RAY_COUNT, envelope_efforts, 4)), _rows(2, n + 1), np.zeros(ROWS)
    return Work(cells, _rows(ROWS, n), nodes, bounds, curvature, rays, envelope, last_curvature, np.zeros(2), used)
