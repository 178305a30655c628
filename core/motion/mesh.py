"""Cut a line into cells whose borders fall on every change of the line."""

from collections.abc import Sequence

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import ScenarioError
from railjoule.core.motion.line_profile import section_borders
from railjoule.core.scenario.line import Line

LARGEST_CELL_COUNT = 200_000
SHORTEST_CELL_M = 1e-6
GRADING = (1.0, 0.5, 0.25, 0.125)
"""Lengths of the cells before a stop, as shares of the mesh: force and speed change fastest there."""


def line_borders(line: Line) -> FloatArray:
    """Return the places [m] where gradient, curve or limit change or the train stops, ends included; shape (m,)."""
    sections = section_borders(line)
    places = list(sections)
    for limit in line.speed_limits:
        places += [limit.from_m, limit.to_m]
    places += [station.position_m for station in line.inner_stations]
    borders = np.unique(np.clip(places, 0.0, sections[-1]))
    apart = np.append(True, np.diff(borders) > SHORTEST_CELL_M)
    kept: FloatArray = borders[apart]
    kept[-1] = sections[-1]
    return kept


def line_mesh(line: Line, mesh_m: float) -> FloatArray:
    """Return the nodes [m] of a mesh with cells of at most `mesh_m`, shorter at the stops; shape (n + 1,).

    Raises
    ------
    ScenarioError
        If that takes more than 200,000 cells.
    """
    borders = line_borders(line)
    lengths = np.diff(borders)
    counts = np.maximum(np.ceil(lengths / mesh_m - 1e-9), 1)
    if counts.sum() > LARGEST_CELL_COUNT:
        raise ScenarioError(
            f"solver.mesh_m = {mesh_m:g} would cut the line of {borders[-1] / 1000:.6g} km into {counts.sum():,.0f} "
            f"cells; at most {LARGEST_CELL_COUNT:,} are allowed."
        )
    nodes = [np.linspace(a, b, int(n), endpoint=False) for a, b, n in zip(borders, borders[1:], counts, strict=False)]
    uniform = np.append(np.concatenate(nodes), borders[-1])
    stops = [0.0, *(station.position_m for station in line.inner_stations), borders[-1]]
    return _graded(uniform, np.asarray(stops))


def with_nodes_at(position_m: FloatArray, places_m: Sequence[float] | FloatArray) -> FloatArray:
    """Return nodes [m] with further ones at places between the ends; shape (k,).

    A node that all but falls on a place gives way to it: over a shorter cell rounding makes forces of its own.
    """
    distance = np.abs(position_m[:, None] - np.asarray(places_m)[None, :]).min(axis=1, initial=np.inf)
    distance[[0, -1]] = np.inf
    return np.union1d(position_m[distance > SHORTEST_CELL_M], places_m)


def finer_at_stops(position_m: FloatArray, stops_m: Sequence[float], halvings: int) -> FloatArray:
    """Return nodes [m] with the cells beside each stop halved again and again towards it; shape (k,)."""
    extra: list[float] = []
    shares = 0.5 ** np.arange(1.0, halvings + 1)
    for stop in stops_m:
        node = int(np.argmin(np.abs(position_m - stop)))
        for neighbour in (node - 1, node + 1):
            if 0 <= neighbour < len(position_m):
                extra += (position_m[node] + (position_m[neighbour] - position_m[node]) * shares).tolist()
    return with_nodes_at(position_m, extra)


def _graded(nodes: FloatArray, stops: FloatArray) -> FloatArray:
    """Halve the cells at the stops again and again, down to an eighth."""
    cell = np.diff(nodes)
    shares = 1 - np.asarray(GRADING[1:])
    where = np.searchsorted(nodes, stops - SHORTEST_CELL_M)
    extra = [nodes[i] + cell[i] * (1 - shares) for i in where if i < len(cell)]
    extra += [nodes[i - 1] + cell[i - 1] * shares for i in where if i > 0]
    return np.unique(np.concatenate([nodes, *extra]))
