"""The limits of sections that cost least: an even search, then a simplex.

Problem: least energy of a trip over limits u of k sections, and their borders if they are free, with T(u) <= t_max.
Every vector is scaled until its trip takes t_max: only 0 to 5 % of unscaled vectors lie within the window of the time,
and where energy is smooth its optimum is at the window's late edge. That leaves k - 1 ratios and the borders.
Method: Weyl's sequence, whose points k a_j mod 1 fill a cube evenly, finds where to begin; Nelder and Mead's simplex
goes on in the logarithms of the ratios. Neither proves anything: a search may end beside the best.

Over a line with stations there are too many ratios for an even search. There the limits of the inter-station runs, each
searched by itself, are one more place to begin; from there a simplex first looks for one factor for each of the runs,
which shares the time among them.

Sources: Shtompel, Khvorost 2025, (14)-(16); Nelder, Mead: A simplex method for function minimization, The Computer
Journal 7, 1965; the steps of the sequence are the powers of the root of x^(k + 1) = x + 1.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.limit_search.problem import MIN_SECTION_M, Evaluation, LimitProblem

SAMPLES_PER_SECTION, MAX_SAMPLES = 64, 256
REFINEMENTS_PER_DIMENSION, MAX_REFINEMENTS, STARTS = 60, 240, 2
"""Numbers of evaluations, chosen for a search of less than a second; a test compares its result for two sections with
800 ratios of their limits."""
RATIO_STEP, BORDER_STEP_SHARE = 0.1, 0.08
"""Sizes of the first simplex, as logarithms of ratios of limits and shares of the line: options of railjoule."""
# any number that no trip needs
INFEASIBLE_J = 1e30
RATIO_EXACT, ENERGY_EXACT = 1e-4, 1e-6
"""Tolerances of the simplex, in logarithms of ratios and as a share of the energy."""


@dataclass(frozen=True, eq=False)
class LimitSearch:
    """A search's path and its end.

    Parameters
    ----------
    evaluations : tuple of Evaluation
        Everything it looked at, in order.
    best : Evaluation
        The one of least energy.
    runs : tuple of LimitSearch
        The searches of the inter-station runs, where each was searched by itself; the evaluations are then theirs.
    """

    evaluations: tuple[Evaluation, ...]
    best: Evaluation
    runs: tuple["LimitSearch", ...] = ()


class Start(NamedTuple):
    """Limits from which a search over a line with stations goes on.

    Parameters
    ----------
    limits_ms : array of shape (k,)
        Of the sections [m/s].
    run_numbers : array of shape (k,)
        In which inter-station run each section lies, counted from 0.
    """

    limits_ms: FloatArray
    run_numbers: IntArray


def search_limits(
    problem: LimitProblem, boundaries_m: FloatArray, free_boundaries: bool, start: Start | None = None
) -> LimitSearch:
    """Return the search for the best limits.

    Parameters
    ----------
    problem : LimitProblem
    boundaries_m : array of shape (k - 1,)
        Borders between sections, where they begin if they are free [m].
    free_boundaries : bool
        Whether the search may move them.
    start : Start, optional
        Further limits to begin with.
    """
    sections = len(boundaries_m) + 1
    moved = len(boundaries_m) if free_boundaries else 0
    found: list[Evaluation] = []
    count = min(SAMPLES_PER_SECTION * sections, MAX_SAMPLES) if sections > 1 else 1
    for point in weyl_points(count, sections + moved):
        limits = problem.min_ms + point[:sections] * (problem.most_ms - problem.min_ms)
        borders = _borders_at(problem, point[sections:]) if moved else boundaries_m
        found.append(problem.evaluate("sample", limits, borders))
    directions = np.eye(sections)[1:]
    if start is not None:
        found.append(problem.evaluate("start", start.limits_ms, boundaries_m))
        by_run = np.equal.outer(np.arange(1, start.run_numbers[-1] + 1), start.run_numbers).astype(float)
        _refine(problem, found, min(found, key=_energy), by_run, 0)
    # with more directions a simplex would not even be complete
    if 1 < sections + moved < MAX_REFINEMENTS:
        # a simplex that has shrunk beside the best gets a second start from there, where there is more than one way
        for _ in range(1 if sections + moved == 2 else STARTS):
            _refine(problem, found, min(found, key=_energy), directions, moved)
    return LimitSearch(tuple(found), min(found, key=_energy))


def weyl_points(count: int, dimensions: int) -> FloatArray:
    """Return points of Weyl's sequence in the unit cube; shape (count, dimensions)."""
    root = 1.5
    # a fixed point whose slope x / ((k + 1) (1 + x)) is below a third: 60 steps are far more than digits
    for _ in range(60):
        root = (1 + root) ** (1 / (dimensions + 1))
    steps = root ** -np.arange(1.0, dimensions + 1)
    points: FloatArray = (0.5 + np.outer(np.arange(1, count + 1), steps)) % 1.0
    return points


def _energy(evaluation: Evaluation) -> float:
    return evaluation.energy_j


def _borders_at(problem: LimitProblem, shares: FloatArray) -> FloatArray:
    """Return rising borders [m] at shares of the line, in any order, none closer than the shortest section."""
    first, last = problem.mesh.position_m[[0, -1]]
    borders = np.sort(first + shares * (last - first))
    for index in range(len(borders)):
        least = (borders[index - 1] if index else first) + MIN_SECTION_M
        borders[index] = min(max(borders[index], least), last - MIN_SECTION_M * (len(borders) - index))
    return borders


def _refine(
    problem: LimitProblem, found: list[Evaluation], start: Evaluation, directions: FloatArray, moved: int
) -> None:
    """Let a simplex go on from the best of what was found, and add what it looks at.

    Each row of `directions` names the sections whose limits change by one factor, relative to all others.
    """
    if not np.isfinite(start.energy_j):
        return
    first, last = problem.mesh.position_m[[0, -1]]
    # a factor that all limits share is undone when they are scaled to the time
    count = len(directions)
    shares = (start.boundaries_m - first) / (last - first) if moved else np.empty(0)
    origin = np.concatenate([np.zeros(count), shares])
    steps = np.concatenate([np.full(count, RATIO_STEP), np.full(moved, BORDER_STEP_SHARE)])

    def cost(place: FloatArray) -> float:
        limits = start.limits_ms * np.exp(place[:count] @ directions)
        borders = _borders_at(problem, place[count:]) if moved else start.boundaries_m
        found.append(problem.evaluate("refine", limits, borders))
        # finite: the simplex subtracts energies to see whether it may end, and infinite ones have no difference
        return min(found[-1].energy_j, INFEASIBLE_J)

    options = {
        "initial_simplex": np.vstack([origin, origin + np.diag(steps)]),
        "xatol": RATIO_EXACT,
        "fatol": ENERGY_EXACT * start.energy_j,
        "maxfev": min(REFINEMENTS_PER_DIMENSION * len(origin), MAX_REFINEMENTS),
    }
    scipy.optimize.minimize(cost, origin, method="Nelder-Mead", options=options)
