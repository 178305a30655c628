"""A line as it lies on the ground, before any train or mesh: heights, limits and supply over distance."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, IntArray, midpoints
from railjoule.core.physics.place_limits import NO_PLACE, PlaceLimits
from railjoule.core.scenario import Line
from railjoule.core.scenario.line import RailCondition
from railjoule.core.units import N_PER_KN, W_PER_KW

CONDITIONS: tuple[RailCondition | None, ...] = (None, "dry", "wet")
"""Rail conditions, from no limit by adhesion to the lowest one."""


def section_borders(line: Line) -> FloatArray:
    """Return the borders of the sections of a line in running order [m]; shape (sections + 1,)."""
    return np.append(0.0, np.cumsum([section.length_m for section in line.sections]))


def height_profile(line: Line) -> FloatArray:
    """Return the heights at the `section_borders` of a line in running order [m], above the start."""
    # the height over the length of the track: per mille are taken for the sine, as in the force of a gradient
    climbs = [section.length_m * section.gradient_permille / 1000 for section in line.sections]
    return np.append(0.0, np.cumsum(climbs))


def speed_limit_at(line: Line, position_m: FloatArray, lasts_m: float = 0.0) -> FloatArray:
    """Return a line's own speed limit [km/h], infinite where there is none.

    Parameters
    ----------
    line : Line
        In running order.
    position_m : array of shape (k,)
        Places of the front of the train [m], none of them on a border.
    lasts_m : float
        How far beyond its end each limit still holds [m].
    """
    # only inner borders: a place before or beyond the line belongs to its first or last section
    section = np.searchsorted(section_borders(line)[1:-1], position_m)
    limit = np.array([section.speed_limit_kmh or np.inf for section in line.sections])[section]
    stretches = _stretches(line, lasts_m)
    if not len(stretches):
        return limit
    ends = np.unique(stretches[:, :2])
    # between neighbouring ends the stretches allow one speed; the first and the last of these gaps lie beyond them all
    between = np.full(len(ends) + 1, np.inf)
    first, beyond = (np.searchsorted(ends, stretches[:, column]) + 1 for column in (0, 1))
    for start, stop, limit_kmh in zip(first, beyond, stretches[:, 2], strict=True):
        between[start:stop] = np.minimum(between[start:stop], limit_kmh)
    lower: FloatArray = np.minimum(limit, between[np.searchsorted(ends, position_m)])
    return lower


def limit_borders(line: Line, lasts_m: float = 0.0) -> FloatArray:
    """Return the ends of limits beside those of the sections [m]; arguments as `speed_limit_at`."""
    return np.unique(_stretches(line, lasts_m)[:, :2])


def neutral_stretches(line: Line) -> FloatArray:
    """Return from and to [m] of where a line in running order has no traction power, those that meet as one; (k, 2)."""
    length = line.length_m
    joined: list[list[float]] = []
    for section in sorted(line.neutral_sections, key=lambda section: section.from_m):
        start, end = section.from_m, min(section.to_m, length)
        if joined and start <= joined[-1][1]:
            joined[-1][1] = max(joined[-1][1], end)
        else:
            joined.append([start, end])
    return np.array(joined).reshape(-1, 2)


def is_neutral(line: Line, position_m: FloatArray) -> BoolArray:
    """Return whether a line in running order has no traction power at places [m], none on a border; shape (k,)."""
    stretches = neutral_stretches(line)
    begun, ended = (np.searchsorted(stretches[:, column], position_m) for column in (0, 1))
    neutral: BoolArray = begun > ended
    return neutral


def place_borders(line: Line) -> FloatArray:
    """Return the ends of traction limits and of rail conditions of a line in running order [m]; shape (k,)."""
    return np.array([end for one in (*line.traction_limits, *line.rail_conditions) for end in (one.from_m, one.to_m)])


class LimitsByPlace(NamedTuple):
    """The limits of traction, recuperation and adhesion along a line.

    Parameters
    ----------
    number : array of shape (k,)
        Which of `others` hold at each place; NO_PLACE where those of `least` do.
    least : PlaceLimits
        The limits where the line restricts nothing, on the best of its rails.
    others : tuple of PlaceLimits
        All others that the line has, in running order.
    """

    number: IntArray
    least: PlaceLimits
    others: tuple[PlaceLimits, ...]


def limits_by_place(line: Line, position_m: FloatArray) -> LimitsByPlace:
    """Return the limits at places of a line in running order [m], none of them on a border."""
    least = PlaceLimits(rail_condition=min(line.all_rail_conditions, key=CONDITIONS.index))
    # between neighbouring borders the limits are the same
    borders = np.unique([0.0, *place_borders(line), line.length_m])
    between = [_limits_at(line, place) for place in midpoints(borders).tolist()]
    others = tuple(limits for limits in dict.fromkeys(between) if limits != least)
    of_gap = np.array([others.index(limits) if limits != least else NO_PLACE for limits in between])
    gap = np.clip(np.searchsorted(borders, position_m) - 1, 0, len(between) - 1)
    return LimitsByPlace(of_gap[gap], least, others)


def largest_current_a(line: Line, position_m: FloatArray) -> FloatArray:
    """Return the largest current of the supply while driving at places of a line in running order [A]; shape (k,)."""
    number, least, others = limits_by_place(line, position_m)
    return np.array([limits.max_current_a for limits in (*others, least)])[number]


def _limits_at(line: Line, place_m: float) -> PlaceLimits:
    """Return the limits at a place of a line in running order [m]."""
    limits = [one for one in line.traction_limits if one.from_m < place_m < one.to_m]
    conditions = [one.condition for one in line.rail_conditions if one.from_m < place_m < one.to_m]

    def least(key: str, unit: float) -> float:
        return min((unit * value for one in limits if (value := getattr(one, key)) is not None), default=np.inf)

    return PlaceLimits(
        least("max_effort_kn", N_PER_KN),
        least("max_power_kw", W_PER_KW),
        least("max_current_a", 1.0),
        min((one.effort_factor for one in limits), default=1.0),
        min((one.recuperation_factor for one in limits), default=1.0),
        max(conditions, key=CONDITIONS.index) if conditions else line.rail_condition,
    )


def _stretches(line: Line, lasts_m: float) -> FloatArray:
    """Return from and to [m] and limit [km/h] of all limits that the sections do not tell; shape (k, 3)."""
    early_m = line.limit_margin_m
    rows = [(limit.from_m - early_m, limit.to_m + lasts_m, limit.limit_kmh) for limit in line.speed_limits]
    if lasts_m > 0 or early_m > 0:
        # the parts of a section's limit before its begin, and for the cars behind beyond its end
        borders = section_borders(line).tolist()
        limited = zip(pairwise(borders), (section.speed_limit_kmh for section in line.sections), strict=True)
        rows += [(start - early_m, end + lasts_m, limit) for (start, end), limit in limited if limit is not None]
    stretches = np.array(rows).reshape(-1, 3)
    # nothing holds before the line or beyond its end
    stretches[:, :2] = np.clip(stretches[:, :2], 0.0, line.length_m)
    return stretches[stretches[:, 0] < stretches[:, 1]]


def limit_steps(line: Line, max_speed_kmh: float = np.inf, lasts_m: float = 0.0) -> tuple[FloatArray, FloatArray]:
    """Return the stretches of one speed limit of a line.

    Parameters
    ----------
    line : Line
        In running order.
    max_speed_kmh : float
        Limit of the speed where the line has none [km/h].
    lasts_m : float
        As in `speed_limit_at`.

    Returns
    -------
    borders_m : array of shape (k + 1,)
        Their borders [m].
    limit_kmh : array of shape (k,)
        Their limits [km/h].
    """
    borders = np.union1d(section_borders(line), limit_borders(line, lasts_m))
    limits = np.minimum(speed_limit_at(line, midpoints(borders), lasts_m), max_speed_kmh)
    first = np.append(True, limits[1:] != limits[:-1])
    return np.append(borders[:-1][first], borders[-1]), limits[first]
