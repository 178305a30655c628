"""A line as it lies on the ground, before any train or mesh: heights and speed limits over distance."""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.scenario import Line


def section_borders(line: Line) -> FloatArray:
    """Return where the sections of a line in running order begin and end [m]; shape (sections + 1,)."""
    return np.append(0.0, np.cumsum([section.length_m for section in line.sections]))


def height_profile(line: Line) -> FloatArray:
    """Return the heights at the `section_borders` of a line in running order [m], above the start."""
    # the height over the length of the track: per mille are taken for the sine, as in the force of a gradient
    climbs = [section.length_m * section.gradient_permille / 1000 for section in line.sections]
    return np.append(0.0, np.cumsum(climbs))


def speed_limit_at(line: Line, position_m: FloatArray) -> FloatArray:
    """Return a line's own speed limit [km/h], infinite where there is none.

    Parameters
    ----------
    line : Line
        In running order.
    position_m : array of shape (k,)
        Places [m], none of them on a border.
    """
    # inner borders alone: a place before or beyond the line belongs to its first or last section
    section = np.searchsorted(section_borders(line)[1:-1], position_m)
    limit = np.array([section.speed_limit_kmh or np.inf for section in line.sections])[section]
    ends = np.unique([place for stretch in line.speed_limits for place in (stretch.from_m, stretch.to_m)])
    if not len(ends):
        return limit
    # between neighbouring ends the stretches allow one speed; the first and the last of these gaps lie beyond them all
    between = np.full(len(ends) + 1, np.inf)
    first = np.searchsorted(ends, [stretch.from_m for stretch in line.speed_limits]) + 1
    beyond = np.searchsorted(ends, [stretch.to_m for stretch in line.speed_limits]) + 1
    for stretch, start, stop in zip(line.speed_limits, first, beyond, strict=True):
        between[start:stop] = np.minimum(between[start:stop], stretch.limit_kmh)
    lower: FloatArray = np.minimum(limit, between[np.searchsorted(ends, position_m)])
    return lower


def limit_steps(line: Line, max_speed_kmh: float = np.inf) -> tuple[FloatArray, FloatArray]:
    """Return the stretches of one speed limit of a line.

    Parameters
    ----------
    line : Line
        In running order.
    max_speed_kmh : float
        What limits the speed where the line does not [km/h].

    Returns
    -------
    borders_m : array of shape (k + 1,)
        Where they begin and end [m].
    limit_kmh : array of shape (k,)
        Their limits [km/h].
    """
    ends = [place for limit in line.speed_limits for place in (limit.from_m, limit.to_m)]
    borders = np.union1d(section_borders(line), ends)
    limits = np.minimum(speed_limit_at(line, 0.5 * (borders[1:] + borders[:-1])), max_speed_kmh)
    first = np.append(True, limits[1:] != limits[:-1])
    return np.append(borders[:-1][first], borders[-1]), limits[first]
