"""A part of a line as a line of its own, with the stops that a measured run made."""

from collections.abc import Sequence

import numpy as np

from railjoule.core.motion.line_profile import section_borders
from railjoule.core.scenario import Line, Section, Station
from railjoule.core.scenario.line import SHORTEST_DISTANCE_M, Stretch

# a border that rounding puts beside an end would make a section of nothing
SHORTEST_PIECE_M = 1e-6


def part_of_line(line: Line, start_m: float, end_m: float, stops: Sequence[Station]) -> Line:
    """Return the part of a line between two places.

    Parameters
    ----------
    line : Line
        In running order.
    start_m, end_m : float
        Where the part begins and ends [m].
    stops : sequence of Station
        The stops of the part, in its own metres; they stand for those of the line.
    """
    length = end_m - start_m
    fixed = [stop.position_m for stop in stops] + [0.0, length]
    points = [
        point.model_copy(update={"position_m": point.position_m - start_m})
        for point in line.passing_points
        if min(abs(point.position_m - start_m - place) for place in fixed) >= SHORTEST_DISTANCE_M
        and start_m < point.position_m < end_m
    ]
    return line.model_copy(
        update={
            "preset": None,
            "sections": tuple(_sections_between(line, start_m, end_m)),
            "speed_limits": _stretches_between(line.speed_limits, start_m, end_m),
            "neutral_sections": _stretches_between(line.neutral_sections, start_m, end_m),
            "stations": tuple(stops),
            "passing_points": tuple(points),
        }
    )


def _stretches_between(stretches: Sequence[Stretch], start_m: float, end_m: float) -> tuple[Stretch, ...]:
    """Return what of stretches lies between two places, in metres from the first."""
    return tuple(
        # made anew, as a copy is not checked
        type(one)(
            **{
                **one.model_dump(),
                "from_m": max(one.from_m - start_m, 0.0),
                "to_m": min(one.to_m - start_m, end_m - start_m),
            }
        )
        for one in stretches
        if one.from_m < end_m - SHORTEST_PIECE_M and one.to_m > start_m + SHORTEST_PIECE_M
    )


def _sections_between(line: Line, start_m: float, end_m: float) -> list[Section]:
    borders = section_borders(line)
    kept = []
    for section, begins, ends in zip(line.sections, borders[:-1], borders[1:], strict=True):
        length = float(np.minimum(ends, end_m) - np.maximum(begins, start_m))
        if length > SHORTEST_PIECE_M:
            kept.append(section.model_copy(update={"length_m": length}))
    return kept
