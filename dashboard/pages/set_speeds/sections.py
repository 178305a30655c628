"""Sections of a line with a set speed each, and their fields."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import panel as pn
from panel.viewable import Viewable

from railjoule.core import Scenario
from railjoule.core.motion.line_profile import section_borders
from railjoule.core.strategies.set_speed_run import MIN_LIMIT_KMH
from railjoule.core.strategies.speed_limits import MAX_SECTIONS
from railjoule.dashboard.parts.html import stack
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters

LONGEST_M = 1e7
FIRST_SECTIONS = 2
"""Of each inter-station run in a scenario that names no borders; as in the paper."""
MAX_BORDERS = 50
"""The maximum of `search.boundaries_m`."""


class SectionModel(TypedParameters):
    """One section: its set speed, and the place where it ends."""

    kept = ("limit_kmh", "to_m")

    limit_kmh = TypedNumber("set speed, km/h", "km/h", 1, default=80.0, bounds=(MIN_LIMIT_KMH, 600.0))
    to_m = TypedNumber("ends at, m", "m", default=1000.0, bounds=(1.0, LONGEST_M))


def make_sections(limits_kmh: Sequence[float], ends_m: Sequence[float], max_speed_kmh: float) -> list[SectionModel]:
    """Make sections whose fields accept at most the maximum speed of the vehicle."""
    made = []
    for limit, end in zip(limits_kmh, ends_m, strict=True):
        section = SectionModel(to_m=float(end))
        # of this section only: param copies a parameter for the instance through which it is requested
        section.param.limit_kmh.bounds = (MIN_LIMIT_KMH, max_speed_kmh)
        section.limit_kmh = float(np.clip(limit, MIN_LIMIT_KMH, max_speed_kmh))
        made.append(section)
    return made


def sections_in_file(scenario: Scenario) -> tuple[Sequence[float] | None, list[float], tuple[int, int]]:
    """Return set speeds [km/h] and borders [m] of a scenario, and the least and largest number of sections.

    There are no set speeds where the search finds them.
    """
    options, line = scenario.search, scenario.line.in_running_order()
    own_borders, runs = section_borders(line)[1:-1].tolist(), len(line.stops_m) - 1
    most = min(runs * MAX_SECTIONS, MAX_BORDERS + 1)
    limits = options.limits_kmh
    borders = list(options.boundaries_m) or (
        own_borders if limits else even_borders(line.stops_m, min(runs * FIRST_SECTIONS, most))
    )
    if limits is not None and len(limits) != len(borders) + 1:
        limits = None
    # a search without borders takes those of the line
    return limits, borders, (2 if own_borders else 1, max(most, len(borders) + 1))


def borders_on_drive(scenario: Scenario) -> list[float]:
    """Return the borders of the strategy on other pages [m]: those of the line where the file names none."""
    return list(scenario.search.boundaries_m) or section_borders(scenario.line.in_running_order())[1:-1].tolist()


def even_borders(stops_m: Sequence[float], count: int) -> list[float]:
    """Return the borders of sections of a line, in whole metres where these are long enough [m].

    Stations are borders where there are enough sections. All inter-station runs have as many, the longest one more
    where they cannot, and those of a run are equal.
    """
    if count < len(stops_m) - 1:
        stops_m = stops_m[0], stops_m[-1]
    length = np.diff(stops_m)
    counts = np.full(len(length), count // len(length))
    counts[np.argsort(-length)[: count % len(length)]] += 1
    borders: list[float] = []
    for start, run, pieces in zip(stops_m, length.tolist(), counts.tolist(), strict=False):
        inside = [start + run * number / pieces for number in range(1, pieces)]
        borders += [start, *(float(round(border)) if run > 10 * pieces else border for border in inside)]
    return borders[1:]


def list_sections(page: Any) -> Viewable:
    """Make the fields of the sections, which follow their number."""

    def row(number: int, section: SectionModel) -> pn.Column:
        fields = ["limit_kmh"] if number == len(page.sections) else ["limit_kmh", "to_m"]
        labels = {field: f"{number}: {section.param[field].label}" for field in fields}
        return stack(*(NumberField(section, field, label=label, of="Section ") for field, label in labels.items()))

    def show(*_: Any) -> None:
        listed[:] = [row(number, section) for number, section in enumerate(page.sections, 1)]

    listed = stack()
    page.param.watch(show, "sections")
    show()
    return listed
