"""What the line does to the train: force of gradient and curve, exact in the mean over each cell.

A train with a length feels each gradient with that part of it that stands there, unless the vehicle asks for its front
or its middle, as rules of timetable construction do.
"""

from typing import Literal, NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.motion.line_profile import section_borders
from railjoule.core.motion.mesh import SHORTEST_CELL_M
from railjoule.core.scenario.line import Line

# a node within a metre of an end would cut the shortest cells, which the mesh has at stops, once more
LEAST_TO_END_M = 1.0


class TrainExtent(NamedTuple):
    """How far a train reaches behind its front, as far as the line asks.

    Parameters
    ----------
    length_m : float or None
        Its length [m]; None for a point.
    car_count : int or None
        Number of equal cars, each felt at its centre; None for an evenly spread weight.
    gradient_at : str
        Whether gradients, curves and tunnels count under all of it, at its front or at its middle.
    limits_last_m : float
        How far beyond its end a speed limit still holds for the front [m].
    """

    length_m: float | None = None
    car_count: int | None = None
    gradient_at: Literal["whole_train", "front", "middle"] = "whole_train"
    limits_last_m: float = 0.0

    @property
    def felt_behind_m(self) -> FloatArray | None:
        """How far behind the front the points lie that feel the line [m]; None where all of an even train does."""
        if self.length_m is None or self.gradient_at == "front":
            return np.zeros(1)
        if self.gradient_at == "middle":
            return np.array([0.5 * self.length_m])
        return None if self.car_count is None else car_offsets_m(self.length_m, self.car_count)

    @property
    def crossing_points(self) -> int:
        """How many points feel a border of sections later than the front does, each with a step of force."""
        return int(np.count_nonzero(self.felt_behind_m)) if self.felt_behind_m is not None else 0


POINT = TrainExtent()
"""A train without a length."""


def cell_means(line: Line, values: FloatArray, position_m: FloatArray, offsets_m: FloatArray) -> FloatArray:
    """Return the mean of a section-wise constant over each cell and over points behind the front of the train.

    Parameters
    ----------
    line : Line
        The line in running order.
    values : array of shape (sections,)
        The constant of each section; before the start the first one continues.
    position_m : array of shape (n + 1,)
        Nodes of the mesh [m].
    offsets_m : array of shape (m,)
        How far the points lie behind the front [m].

    Returns
    -------
    array of shape (n,)
    """
    borders = section_borders(line)
    integral = np.append(0.0, np.cumsum(values * np.diff(borders)))
    inside = np.zeros(len(position_m))
    # the mean over a cell is the difference of the integral at its ends, exact for any steps within
    for offset in offsets_m:  # all at once would take nodes times points of memory
        places = position_m - offset
        # before the start interpolation stays at zero, while the integral of the first section goes on
        inside += np.interp(places, borders, integral) + np.minimum(places, 0.0) * values[0]
    means: FloatArray = np.diff(inside / len(offsets_m)) / np.diff(position_m)
    return means


def mean_over_length(line: Line, values: FloatArray, position_m: FloatArray, length_m: float) -> FloatArray:
    """Return the mean of a section-wise constant over each cell and over a train of `length_m` [m]; shape (n,).

    Arguments as in `cell_means`.
    """
    borders = section_borders(line)
    # over train and cell the constant is integrated twice: quadratic between borders
    lengths = np.diff(borders)
    first = np.append(0.0, np.cumsum(values * lengths))
    second = np.append(0.0, np.cumsum(first[:-1] * lengths + 0.5 * values * lengths**2))

    def twice_integrated(places: FloatArray) -> FloatArray:
        # the first piece serves before the start too: there both integrals begin at zero, and `beyond` is negative
        index = np.clip(np.searchsorted(borders, places, side="right") - 1, 0, len(values) - 1)
        beyond = places - borders[index]
        integral: FloatArray = second[index] + first[index] * beyond + 0.5 * values[index] * beyond**2
        return integral

    over_train = (twice_integrated(position_m) - twice_integrated(position_m - length_m)) / length_m
    means: FloatArray = np.diff(over_train) / np.diff(position_m)
    return means


def car_offsets_m(length_m: float, car_count: int) -> FloatArray:
    """Return how far the centres of equal cars lie behind the front of a train of `length_m` [m]; shape (cars,)."""
    offsets: FloatArray = (np.arange(car_count) + 0.5) * length_m / car_count
    return offsets


def car_crossings(line: Line, offsets_m: FloatArray) -> FloatArray:
    """Return where the front is when a point behind it enters another section [m], rising, ends not included."""
    borders = section_borders(line)
    places = np.unique(np.add.outer(borders[1:-1], offsets_m))
    # where sections are as long as cars, one place comes as several sums that differ in their last digits
    places = places[np.append(True, np.diff(places) > SHORTEST_CELL_M)] if len(places) else places
    inside: FloatArray = places[(places > LEAST_TO_END_M) & (places < borders[-1] - LEAST_TO_END_M)]
    return inside


def mean_over_train(line: Line, values: FloatArray, position_m: FloatArray, train: TrainExtent) -> FloatArray:
    """Return the mean of a section-wise constant over each cell and over the train; shape (n,).

    The first three arguments as in `cell_means`.
    """
    offsets = train.felt_behind_m
    if offsets is not None:
        return cell_means(line, values, position_m, offsets)
    assert train.length_m is not None
    return mean_over_length(line, values, position_m, train.length_m)
