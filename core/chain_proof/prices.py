"""Prices for the chains: of the squares of speed at the nodes, from the multipliers of an optimum."""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.kernels import jumps_at_no_effort
from railjoule.core.interior_point.certificate import energy_tangents, usable_prices
from railjoule.core.interior_point.certificate import node_prices as smooth_prices
from railjoule.core.interior_point.layout import ACCELERATION, DECELERATION
from railjoule.core.interior_point.solver import Optimum
from railjoule.core.interior_point.switching_bound import START, price_switched_cells
from railjoule.core.physics.course_data import CourseData, cells_of


def node_prices(course: CourseData, optimum: Optimum) -> FloatArray:
    """Return the slopes of the cost to go by the square of speed at each node [J s2/m2]; shape (n + 1,).

    A priced cell's slope by the square of speed at its start is the node's price plus what its force and its limit of
    acceleration say; the cost to go falls by the price. At the end no cost is left to go.
    """
    if not jumps_at_no_effort(course.drive_kind):
        price_of_time, over_speed = usable_prices(course, optimum)
        given = price_of_time + course.auxiliary_power_w, over_speed, energy_tangents(course, optimum)
        return -smooth_prices(course, optimum, *given)
    cells = price_switched_cells(course, optimum)[0]
    cell = cells_of(course)
    by_start = -(cell.inertia - 0.5 * cell.quadratic)
    rise = (optimum.multiplier[ACCELERATION] - optimum.multiplier[DECELERATION]) * cell.inertia
    prices = -(cells[:, START] - optimum.force_price * by_start + rise)
    return np.append(prices, 0.0)
