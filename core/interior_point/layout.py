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

    FLOOR                w - floor, of a node
    CEILING              limit - w, of a node

There is one more for the time. In a neutral section the largest efforts of the drive are next to nothing in place of 1
and the electric brake's, and no limit over speed is used.
"""

from collections import namedtuple
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
    FLOOR,
    CEILING,
) = range(14)
ROWS, CELL_ROWS = 14, 12
"""Rows of constraints, and how many of them are of cells; a row of cells has no entry at the last node."""
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


Cells = namedtuple(
    "Cells",
    [
        # the point: f, x and psi, and their steps
        "traction", "braking", "drawn", "traction_step", "braking_step", "drawn_step",
        # derivatives by w0 and w1 of net force D and mean speed v at the point; k
        "force_by_start", "force_by_end", "speed_by_start", "speed_by_end", "inertia",
        # how psi follows x and v once it is eliminated
        "drawn_by_effort", "drawn_by_speed",
        # derivatives of the Lagrangian by f, x and v, and the multiplier of x + q = f - D
        "traction_gradient", "braking_gradient", "speed_gradient", "force_price",
        # the cell's second-order model after condensing (`newton`): weight on (effort + slope * v)^2 for traction, for
        # all brakes together and for each brake; the coupling of both nodes that is left once efforts are eliminated
        "traction_weight", "traction_slope", "braking_weight", "braking_slope", "electric_weight", "friction_weight",
        "coupling_start", "coupling_end",
        # right-hand sides of the efforts, kept for `step.expand`
        "traction_right", "electric_right", "friction_right", "drawn_right",
    ],
)  # fmt: skip
"""Arrays of shape (n,), one number a cell."""
Rows = namedtuple(
    "Rows",
    [
        # weight of the barrier: the length for which a constraint stands; 0 where it does not occur
        "slack", "multiplier", "weight",
        # g - slack, and the derivatives of g where they are not constant
        "residual", "by_effort", "by_speed",
        "slack_step", "multiplier_step",
        # what slack times multiplier is aimed at, over the slack; and what the row adds to the right-hand side
        "target", "rhs",
    ],
)  # fmt: skip
"""Arrays of shape (ROWS, n + 1): the constraints. One that does not occur has the slack 1 and the multiplier 0."""
Nodes = namedtuple(
    "Nodes",
    [
        # the step is the right-hand side until it is solved for
        "speed2", "speed2_step",
        # 1 where the speed is unknown, 0 where it is prescribed: a factor, so that inner loops do not branch
        "free",
        "floor", "ceiling",
        # derivatives of the Lagrangian and of the travel time by w; the tridiagonal system's answer to the latter
        "gradient", "time_gradient", "time_response",
        # factors of the tridiagonal system
        "inverse_pivot", "ratio",
    ],
)  # fmt: skip
"""Arrays of shape (n + 1,), one number a node."""


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
    curvature: FloatArray
    rays: FloatArray
    envelope: FloatArray
    last_curvature: FloatArray
    time_step: FloatArray
    used: FloatArray


@njit(cache=True)
def allocate(n: int, envelope_efforts: int) -> Work:
    """Return the zeroed work arrays of a meshed line with `n` cells; all slacks are 1.

    The table of envelopes holds so many efforts, none where a drive has no use for it.
    """
    c, r, m = np.zeros((29, n)), np.zeros((10, ROWS, n + 1)), np.zeros((10, n + 1))
    r[0] = 1.0
    cells = Cells(
        c[0], c[1], c[2], c[3], c[4], c[5], c[6], c[7], c[8], c[9],
        c[10], c[11], c[12], c[13], c[14], c[15], c[16], c[17], c[18], c[19],
        c[20], c[21], c[22], c[23], c[24], c[25], c[26], c[27], c[28],
    )  # fmt: skip
    rows = Rows(r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8], r[9])
    nodes = Nodes(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9])
    rays, envelope = np.zeros((2, RAY_COUNT, 3)), np.zeros((2, RAY_COUNT, envelope_efforts, 4))
    curvature, last_curvature = np.zeros((CURVATURES, n)), np.zeros((6, n))
    return Work(cells, rows, nodes, curvature, rays, envelope, last_curvature, np.zeros(2), np.zeros(ROWS))
