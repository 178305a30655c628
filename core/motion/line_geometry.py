"""A line over its mesh: gradient, curvature, limits, supply, stops and passing speeds, as one train meets them.

Gradients, curves and tunnels are exact in the mean over each cell. A train with a length feels each of them with that
part of it that stands there, unless the vehicle asks for its front or its middle, as rules of timetable construction
do.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, frozen_array, midpoints
from railjoule.core.budget import LIBRARY
from railjoule.core.motion.line_profile import (
    LimitsByPlace,
    is_neutral,
    limits_by_place,
    section_borders,
    speed_limit_at,
)
from railjoule.core.motion.mesh import SHORTEST_CELL_M, line_mesh, require_budget, with_nodes_at
from railjoule.core.scenario import Line, Section
from railjoule.core.units import MS_PER_KMH

# 64 of them, of 64 bytes a cell, are 80 MB at most
MAX_KEPT_CELLS = 20_000
"""Geometries of more cells are not kept for the next call."""
# a node within a metre of an end would cut the shortest cells, which the mesh has at stops, once more
MIN_TO_END_M = 1.0


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
        # the centres of equal cars
        cars = self.car_count
        return None if cars is None else (np.arange(cars) + 0.5) * self.length_m / cars

    @property
    def crossing_points(self) -> int:
        """How many points feel a border of sections later than the front does, each with a step of force."""
        return int(np.count_nonzero(self.felt_behind_m)) if self.felt_behind_m is not None else 0


POINT = TrainExtent()
"""A train without a length."""


@dataclass(frozen=True, eq=False)
class LineGeometry:
    """A line at n + 1 nodes and in n cells.

    Parameters
    ----------
    position_m : array of shape (n + 1,)
        Nodes [m].
    gradient_permille : array of shape (n,)
        Mean gradient under the train.
    curvature_per_m : array of shape (n,)
        Mean curvature under the train [1/m].
    tunnel_factor : array of shape (n,)
        Mean factor of tunnels on the quadratic resistance; 1 in the open.
    speed_limit_ms : array of shape (n + 1,)
        Limit of the line [m/s], infinite where there is none; the lower one where two cells meet.
    cell_limit_ms : array of shape (n,)
        The same within each cell [m/s].
    neutral : array of shape (n,)
        Whether the cell lies in a neutral section.
    limits_by_place : LimitsByPlace
        Limits of traction, recuperation and adhesion in the cells.
    stop_nodes : tuple of int
        Nodes of the stations between the ends.
    passing_ms : tuple of (int, float)
        Nodes that are passed at a given speed, and that speed [m/s].
    dwell_s : array of shape (n + 1,)
        How long the train stands at each node [s].
    """

    position_m: FloatArray
    gradient_permille: FloatArray
    curvature_per_m: FloatArray
    tunnel_factor: FloatArray
    speed_limit_ms: FloatArray
    cell_limit_ms: FloatArray
    neutral: BoolArray
    limits_by_place: LimitsByPlace
    stop_nodes: tuple[int, ...]
    passing_ms: tuple[tuple[int, float], ...]
    dwell_s: FloatArray


def meshed_geometry(line: Line, mesh_m: float, train: TrainExtent = POINT) -> LineGeometry:
    """Return the geometry of a line over a mesh with cells of at most `mesh_m`; kept for the next call.

    Parameters
    ----------
    line : Line
        The line, in either direction.
    mesh_m : float
        Largest length of a cell [m].
    train : TrainExtent
        How far it reaches behind its front.

    Raises
    ------
    ScenarioError
        If the mesh would need more cells than the current budget has.
    """
    rows = len(line.sections) * max(train.crossing_points, 1)
    large = line.length_m > MAX_KEPT_CELLS * mesh_m or rows > MAX_KEPT_CELLS
    geometry = (_geometry.__wrapped__ if large else _geometry)(line, mesh_m, train)
    # what is kept may come from a larger budget
    crossings = (len(line.sections) - 1) * train.crossing_points
    require_budget(line, mesh_m, len(geometry.gradient_permille), crossings, train.limits_last_m)
    return geometry


@lru_cache(maxsize=64)
def _geometry(line: Line, mesh_m: float, train: TrainExtent) -> LineGeometry:
    running = line.in_running_order()
    nodes = line_mesh(running, mesh_m, train.limits_last_m)
    crossings = (len(line.sections) - 1) * train.crossing_points
    if crossings > LIBRARY.cell_count:
        require_budget(running, mesh_m, len(nodes) - 1 + crossings, crossings, train.limits_last_m)
    # each point's step of force falls on a node, or cells that it cuts would mix driving and coasting
    if train.crossing_points and (offsets := train.felt_behind_m) is not None:
        nodes = with_nodes_at(nodes, car_crossings(running, offsets))
    return geometry_at(running, nodes, train)


def geometry_at(line: Line, position_m: FloatArray, train: TrainExtent = POINT) -> LineGeometry:
    """Return the geometry of a line in running order over given nodes [m]; `train` as in `meshed_geometry`."""

    def over_train(values: list[float]) -> FloatArray:
        return frozen_array(mean_over_train(line, np.array(values), position_m, train))

    stops = [int(np.argmin(np.abs(position_m - station.position_m))) for station in line.inner_stations]
    dwell = np.zeros(len(position_m))
    dwell[stops] = [station.dwell_s for station in line.inner_stations]
    # asked for at the middles of cells: borders of limits are nodes, where it would be open which of both holds
    middle = midpoints(position_m)
    limits = speed_limit_at(line, middle, train.limits_last_m) * MS_PER_KMH
    # nodes of a part of the line leave the other points out: none of them is near
    passing = [point for point in line.passing_points if position_m[0] < point.position_m < position_m[-1]]
    # a node belongs to the cells on both sides, so that the lower of their limits holds there
    return LineGeometry(
        position_m=frozen_array(position_m),
        gradient_permille=over_train([section.gradient_permille for section in line.sections]),
        curvature_per_m=over_train([_curvature(section) for section in line.sections]),
        tunnel_factor=over_train([section.tunnel_factor for section in line.sections]),
        speed_limit_ms=frozen_array(np.minimum(np.append(limits[0], limits), np.append(limits, limits[-1]))),
        cell_limit_ms=frozen_array(limits),
        neutral=is_neutral(line, middle),
        limits_by_place=limits_by_place(line, middle),
        stop_nodes=tuple(stops),
        passing_ms=tuple(
            (int(np.argmin(np.abs(position_m - point.position_m))), point.speed_kmh * MS_PER_KMH) for point in passing
        ),
        dwell_s=frozen_array(dwell),
    )


def _curvature(section: Section) -> float:
    return 1 / section.curve_radius_m if section.curve_radius_m > 0 else 0.0


def mean_over_train(line: Line, values: FloatArray, position_m: FloatArray, train: TrainExtent) -> FloatArray:
    """Return the mean of a section-wise constant over each cell and over the train.

    Parameters
    ----------
    line : Line
        The line in running order.
    values : array of shape (sections,)
        The constant of each section; before the start the first one continues.
    position_m : array of shape (n + 1,)
        Nodes of the mesh [m].
    train : TrainExtent
        How far the train reaches behind its front.

    Returns
    -------
    array of shape (n,)
    """
    borders, offsets = section_borders(line), train.felt_behind_m
    lengths = np.diff(borders)
    once = np.append(0.0, np.cumsum(values * lengths))
    # the mean over a cell is the difference of the integral at its ends, exact for any steps within
    if offsets is not None:
        inside = np.zeros(len(position_m))
        for offset in offsets:  # one array of all would take nodes times points of memory
            places = position_m - offset
            # before the start interpolation stays at zero, while the integral of the first section goes on
            inside += np.interp(places, borders, once) + np.minimum(places, 0.0) * values[0]
        return np.diff(inside / len(offsets)) / np.diff(position_m)
    assert train.length_m is not None
    # over train and cell the constant is integrated twice: quadratic between borders
    twice = np.append(0.0, np.cumsum(once[:-1] * lengths + 0.5 * values * lengths**2))
    at_ends = []
    for places in (position_m, position_m - train.length_m):
        # the first piece serves before the start too: there both integrals begin at zero, and `beyond` is negative
        index = np.clip(np.searchsorted(borders, places, side="right") - 1, 0, len(values) - 1)
        beyond = places - borders[index]
        at_ends.append(twice[index] + once[index] * beyond + 0.5 * values[index] * beyond**2)
    return np.diff((at_ends[0] - at_ends[1]) / train.length_m) / np.diff(position_m)


def car_crossings(line: Line, offsets_m: FloatArray) -> FloatArray:
    """Return the places of the front when a point behind it enters another section [m], rising, ends not included."""
    borders = section_borders(line)
    places = np.unique(np.add.outer(borders[1:-1], offsets_m))
    # where sections are as long as cars, one place comes as several sums that differ in their last digits
    places = places[np.append(True, np.diff(places) > SHORTEST_CELL_M)] if len(places) else places
    inside: FloatArray = places[(places > MIN_TO_END_M) & (places < borders[-1] - MIN_TO_END_M)]
    return inside
