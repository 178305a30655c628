"""Cut a line into cells whose borders fall on every change of the line."""

from collections.abc import Sequence

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.budget import LIBRARY, current_budget, rounded_up
from railjoule.core.errors import ScenarioError
from railjoule.core.motion.line_profile import limit_borders, neutral_stretches, place_borders, section_borders
from railjoule.core.scenario.line import Line

# borders closer than a micrometre are one: lengths of sections add up with rounding, and a cell's inertia is over its
# length; the longest is the greatest `solver.mesh_m`
SHORTEST_CELL_M, LONGEST_CELL_M = 1e-6, 1000.0
# over distance, speed changes fastest beside a stop, as the square root of it
HALVINGS = 3
"""How often the cells beside a stop are halved towards it."""


def line_borders(line: Line, lasts_m: float = 0.0) -> FloatArray:
    """Return the places [m] where gradient, curve, limit or supply change, the train stops or passes at a given speed.

    Parameters
    ----------
    line : Line
        In running order.
    lasts_m : float
        How far beyond its end each limit still holds [m].

    Returns
    -------
    array of shape (m,)
        Rising, ends included.
    """
    sections = section_borders(line)
    places = [*sections, *limit_borders(line, lasts_m), *neutral_stretches(line).ravel()]
    places += place_borders(line).tolist()
    places += [station.position_m for station in line.inner_stations]
    places += [point.position_m for point in line.passing_points]
    borders = np.unique(np.clip(places, 0.0, sections[-1]))
    distinct = np.append(True, np.diff(borders) > SHORTEST_CELL_M)
    kept: FloatArray = borders[distinct]
    # of a border that is all but the end, the end stays
    kept[-1] = sections[-1]
    return kept


def line_mesh(line: Line, mesh_m: float, lasts_m: float = 0.0) -> FloatArray:
    """Return the nodes [m] of a mesh with cells of at most `mesh_m`, shorter at the stops; shape (n + 1,).

    `lasts_m` as in `line_borders`.

    Raises
    ------
    ScenarioError
        If that takes more cells than any budget has.
    """
    borders = line_borders(line, lasts_m)
    lengths = np.diff(borders)
    # rounding of a length that is a multiple of the mesh must not add a cell
    counts = np.maximum(np.ceil(lengths / mesh_m - 1e-9), 1)
    if counts.sum() > LIBRARY.cell_count:
        require_budget(line, mesh_m, int(counts.sum()), lasts_m=lasts_m)
    nodes = [np.linspace(a, b, int(n), endpoint=False) for a, b, n in zip(borders, borders[1:], counts, strict=False)]
    uniform = np.append(np.concatenate(nodes), borders[-1])
    stops = [0.0, *(station.position_m for station in line.inner_stations), borders[-1]]
    return finer_at_stops(uniform, stops, HALVINGS)


def require_budget(line: Line, mesh_m: float, cell_count: int, crossings: int = 0, lasts_m: float = 0.0) -> None:
    """Refuse a mesh of more cells than the current budget has.

    Parameters
    ----------
    line, mesh_m, lasts_m
        As in `line_mesh`.
    cell_count, crossings : int
        Cells of the mesh, and those that the cars of the train add to it.

    Raises
    ------
    ScenarioError
        If there are more.
    """
    budget = current_budget()
    if cell_count > budget.cell_count:
        raise ScenarioError(
            f"solver.mesh_m = {mesh_m:g} makes {cell_count:,} cells; {budget.name} takes at most "
            f"{budget.cell_count:,}{enough_words(line, budget.cell_count, crossings, lasts_m)}"
        )


def enough_words(line: Line, max_cells: int, crossings: int = 0, lasts_m: float = 0.0) -> str:
    """Return the end of a sentence about too many cells: from which `solver.mesh_m` on there are few enough.

    Parameters
    ----------
    line : Line
        In running order.
    max_cells, crossings : int
        Cells allowed, and those that the cars of the train add.
    lasts_m : float
        As in `line_borders`.
    """
    # each station has two sides that are graded, both ends of the line together two
    stops = len(line.inner_stations) + 1
    unavoidable = len(line_borders(line, lasts_m)) - 1 + 2 * stops * HALVINGS + crossings
    if max_cells > unavoidable:
        enough_m = rounded_up(line.length_m / (max_cells - unavoidable))
        if enough_m <= LONGEST_CELL_M:
            return f". Use {enough_m:g} m or more."
    return f", and sections, limits and stops of the line already make {unavoidable:,}."


def with_nodes_at(position_m: FloatArray, places_m: Sequence[float] | FloatArray) -> FloatArray:
    """Return nodes [m] with further ones at places between the ends; shape (k,).

    A node that all but falls on a place gives way to it: over a shorter cell rounding makes forces of its own.
    """
    places = np.unique(np.asarray(places_m, dtype=float))
    if not len(places):
        return np.unique(position_m)
    after = np.searchsorted(places, position_m)
    before, behind = places[np.maximum(after - 1, 0)], places[np.minimum(after, len(places) - 1)]
    distinct = np.minimum(np.abs(position_m - before), np.abs(position_m - behind)) > SHORTEST_CELL_M
    distinct[[0, -1]] = True
    return np.union1d(position_m[distinct], places)


def finer_at_stops(position_m: FloatArray, stops_m: Sequence[float], halvings: int) -> FloatArray:
    """Return nodes [m] with the cells beside each stop halved again and again towards it; shape (k,)."""
    cell, near = np.diff(position_m), 0.5 ** np.arange(1.0, halvings + 1)
    # a little before each stop, so that rounding does not find the node behind it
    where = np.searchsorted(position_m, np.asarray(stops_m) - SHORTEST_CELL_M)
    extra = [position_m[i] + cell[i] * near for i in where if i < len(cell)]
    extra += [position_m[i - 1] + cell[i - 1] * (1 - near) for i in where if i > 0]
    return np.unique(np.concatenate([position_m, *extra]))
