"""Gradients from heights over position: straight pieces that stay near enough to the heights.

Differences of measured heights make gradients of their errors: 1 m over 25 m is 40 per mille. Therefore the heights are
fitted by a line of straight pieces. Its corners are places of the table, chosen by the algorithm of Douglas and Peucker
(*Algorithms for the reduction of the number of points required to represent a digitized line or its caricature*,
Cartographica 10 (1973) 112-122) with differences in height; the heights of the corners are those of least squares over
all points (a linear spline, de Boor, *A Practical Guide to Splines*, Springer 1978, chapter XIV), so that errors
average out. Then corners without which the line stays near enough are removed. Heights of a line that has such pieces
are met exactly. The parameter is the largest difference in height, which bounds the error in energy: 1 m is 2.7 Wh a
tonne, as much as a train has at 16 km/h.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy import interpolate

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Notes
from railjoule.core.imports.table import MIN_STRETCH_M, Interval, bounded, place
from railjoule.core.imports.table_units import STEEPEST_PERMILLE

USUAL_TOLERANCE_M = 1.0
ROUNDING_M = 1e-9
LOWEST_M, HIGHEST_M, FARTHEST_M = -1000.0, 10_000.0, 1e7
"""Between which heights there is land, and the longest line of a scenario."""
SMALLER = 0.7
"""Factor on the bound for corners, where least squares move the line away from a point by more than is allowed."""
MAX_PIECES = 10_000
METHOD = "corners by Douglas and Peucker (1973), as few as possible, and their heights by least squares"


@dataclass(frozen=True)
class HeightProfile:
    """Straight pieces between `knots_m`, with the height at each, their largest and root mean square difference [m]."""

    knots_m: FloatArray
    height_m: FloatArray
    largest_m: float
    deviation_m: float

    @property
    def gradients_permille(self) -> FloatArray:
        """Gradient of each piece, uphill positive [per mille]; shape (n - 1,)."""
        return np.asarray(1000.0 * np.diff(self.height_m) / np.diff(self.knots_m))


def fit_heights(position_m: FloatArray, height_m: FloatArray, tolerance_m: float) -> HeightProfile:
    """Fit heights by straight pieces that lie nowhere farther from them than a tolerance.

    Parameters
    ----------
    position_m, height_m : array of shape (n,)
        Heights over position; those at one place are averaged [m].
    tolerance_m : float
        The largest difference in height, from 0 [m].
    """
    places, index, counts = np.unique(position_m, return_inverse=True, return_counts=True)
    points = _Points(places, np.bincount(index, height_m) / counts, counts)
    bound = tolerance_m
    while True:
        corners = _corners(points, bound + ROUNDING_M)
        heights, away = points.fitted(corners)
        if (
            away.max() <= tolerance_m + ROUNDING_M
            or len(corners) in {len(places), MAX_PIECES + 1}
            or bound < ROUNDING_M
        ):
            break
        bound *= SMALLER
    corners = _without_needless(points, corners, tolerance_m + ROUNDING_M)
    heights, away = points.fitted(corners)
    return HeightProfile(places[corners], heights, float(away.max()), float(np.sqrt(np.mean(away**2))))


@dataclass(frozen=True)
class _Points:
    """Heights at n rising places, each the mean of so many [m]."""

    place_m: FloatArray
    height_m: FloatArray
    counts: IntArray

    def fitted(self, corners: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return the heights of corners by least squares, and how far each point is from the line between them [m]."""
        knots = self.place_m[corners]
        padded, weights = np.r_[knots[0], knots, knots[-1]], np.sqrt(self.counts)
        heights = interpolate.make_lsq_spline(self.place_m, self.height_m, padded, k=1, w=weights)(knots)
        return heights, np.abs(np.interp(self.place_m, knots, heights) - self.height_m)


def _without_needless(points: _Points, corners: IntArray, bound_m: float) -> IntArray:
    """Remove corners, those of the smallest bends first, while all points stay within a bound of the line [m]."""
    needed = {int(corners[0]), int(corners[-1])}
    while True:
        heights, _ = points.fitted(corners)
        knots = points.place_m[corners]
        share = (knots[1:-1] - knots[:-2]) / (knots[2:] - knots[:-2])
        bend = np.abs(heights[1:-1] - heights[:-2] - share * (heights[2:] - heights[:-2]))
        bend = np.where([int(corner) in needed for corner in corners[1:-1]], np.inf, bend)
        # corners between which others stay, so that each is judged by itself
        beside = np.pad(bend, 2, constant_values=np.inf)
        smallest = np.min([beside[:-4], beside[1:-3], beside[3:-1], beside[4:]], axis=0)
        removed = corners[1:-1][np.isfinite(bend) & (bend <= smallest)]
        if not len(removed):
            return corners
        trial = np.setdiff1d(corners, removed)
        _, away = points.fitted(trial)
        most = np.maximum.reduceat(away, trial[:-1])
        piece = np.searchsorted(trial, removed, side="right") - 1
        near = np.max([most[np.clip(piece + step, 0, len(most) - 1)] for step in (-1, 0, 1)], axis=0)
        kept = np.union1d(trial, removed[near > bound_m])
        needed.update(removed[near > bound_m].tolist())
        if points.fitted(kept)[1].max() > bound_m:
            needed.update(removed.tolist())
        else:
            corners = kept


def _corners(points: _Points, bound_m: float) -> IntArray:
    """Choose corners so that the heights between lie within a bound of the chord; all pieces are split in turn."""
    places, heights = points.place_m, points.height_m
    corners = np.array([0, len(places) - 1])
    while len(corners) <= MAX_PIECES:
        away = np.abs(np.interp(places, places[corners], heights[corners]) - heights)
        most = np.maximum.reduceat(away, corners[:-1])
        # the first of those that are farthest in their piece
        is_most = away == np.repeat(most, np.diff([*corners[:-1], len(places)]))
        piece = np.searchsorted(corners, np.arange(len(places)), side="right") - 1
        candidates = np.flatnonzero(is_most & (away > bound_m))
        added = candidates[np.unique(piece[candidates], return_index=True)[1]]
        if not len(added):
            break
        corners = np.union1d(corners, added)
    return corners[: MAX_PIECES + 1]


def intervals_of_heights(points: Sequence[Interval], tolerance_m: float | None, notes: Notes) -> list[Interval]:
    """Turn heights at places, the begins of intervals, into stretches of one gradient [per mille], with the method.

    Parameters
    ----------
    points : sequence of Interval
        Their begins are places, their values heights [m].
    tolerance_m : float, optional
        As of `fit_heights`; by default `USUAL_TOLERANCE_M`.
    notes : Notes
        Receives the method with its parameter, and what it left of the heights.

    Raises
    ------
    ScenarioError
        If there are fewer than two places, two heights at one differ by too much, or gradients are none of a railway.
    """
    tolerance = USUAL_TOLERANCE_M if tolerance_m is None else tolerance_m
    setting = "heights.tolerance_m"
    ordered = sorted((one.from_m, one.value, one.row) for one in points if one.value is not None)
    for place_m, height_m, row in ordered:
        if not (abs(place_m) <= FARTHEST_M and LOWEST_M <= height_m <= HIGHEST_M):
            raise ScenarioError(
                f"{notes.source}, row {row}: {height_m:g} m at {place(place_m)} m must be a height from "
                f"{LOWEST_M:g} to {HIGHEST_M:g} m at a place within {FARTHEST_M / 1e3:g} km."
            )
    for (place_m, height_m, row), (beside_m, other_m, beside_row) in pairwise(ordered):
        if place_m == beside_m and abs(other_m - height_m) > 2 * tolerance:
            raise ScenarioError(
                f"{notes.source}: rows {row} and {beside_row} give two heights at {place(place_m)} m, {height_m:g} and "
                f"{other_m:g} m; leave one of them out, or allow more by {setting}."
            )
    position, height, numbers = np.array(ordered).T
    if position[-1] - position[0] < MIN_STRETCH_M:
        raise ScenarioError(f"{notes.source}: needs heights at two places at least.")
    profile = fit_heights(position, height, tolerance)
    if len(profile.knots_m) > MAX_PIECES:
        raise ScenarioError(
            f"{notes.source}: more than {MAX_PIECES} straight pieces with a tolerance of {tolerance:g} m; allow more, "
            f"as {setting}=5."
        )
    slopes = profile.gradients_permille
    steepest = int(np.argmax(np.abs(slopes)))
    where = f"{slopes[steepest]:.4g} per mille from {place(profile.knots_m[steepest])} m on"
    if abs(slopes[steepest]) > STEEPEST_PERMILLE:
        if tolerance_m is None:
            raise ScenarioError(
                f"{notes.source}: with a tolerance of {tolerance:g} m its gradients reach {where}; if errors of the "
                f"heights make them, allow more, as {setting}=5; if not, keep it, as {setting}={tolerance:g}."
            )
        notes.add("question", f"its gradients reach {where}: is {setting} = {tolerance:g} too small?")
    pieces = len(slopes)
    notes.add(
        "assumption",
        f"gradients are those of {pieces} straight piece{'s' * (pieces > 1)} through {len(ordered)} heights: {METHOD}, "
        f"{setting} = {tolerance:g} m; the heights differ from them by at most {profile.largest_m:.2g} m, in the root "
        f"mean square {profile.deviation_m:.2g} m.",
    )
    rows = [int(numbers[index]) for index in np.searchsorted(position, profile.knots_m)]
    name = f"{notes.source}, row"
    return [
        Interval(
            float(begin),
            float(end),
            bounded(f"{name} {row}", "the gradient", float(slope), float(slope), "gradients"),
            row,
        )
        for begin, end, slope, row in zip(profile.knots_m, profile.knots_m[1:], slopes, rows, strict=False)
    ]
