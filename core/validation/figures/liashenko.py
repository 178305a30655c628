"""Printed figures of Liashenko 2025, rebuilt."""

from functools import partial

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.units import MS_PER_KMH
from railjoule.core.validation.figure import FigureData, Line, Panel, PaperFigure
from railjoule.core.validation.liashenko_runs import compared_table, example, rms

PERMILLE = 1e-3
DISTANCE = "Distance, m"


def followed_plan(place: str) -> FigureData:
    """Return the planned and the actual speed of one of Figures 3 to 6, their difference, and the line's heights."""
    run = example(place).following
    speeds = tuple(
        Line(label, one.position_m, one.speed_ms / MS_PER_KMH)
        for label, one in (("planned", run.planned), ("actual", run.actual))
    )
    note = (
        f"No numbers are printed. Planned {run.planned.energy_kwh:.2f} kWh in {run.planned.travel_time_s:.1f} s, "
        f"actual {run.actual.energy_kwh:.2f} kWh in {run.actual.travel_time_s:.1f} s."
    )
    planned, actual = speeds
    difference = Line("difference", actual.x, actual.y - np.interp(actual.x, planned.x, planned.y))
    panels = (
        Panel(DISTANCE, "Speed, km/h", speeds),
        Panel(DISTANCE, "Actual less planned speed, km/h", (difference,)),
        Panel(DISTANCE, "Height, m", (Line("track", *_heights(place)),)),
    )
    return FigureData(panels, note)


def _heights(place: str) -> tuple[FloatArray, FloatArray]:
    """Return the borders of a line's sections [m] and their heights over its start [m]."""
    sections = example(place).scenario.line.in_running_order().sections
    lengths = np.array([section.length_m for section in sections])
    rises = PERMILLE * lengths * [section.gradient_permille for section in sections]
    return np.concatenate([[0.0], np.cumsum(lengths)]), np.concatenate([[0.0], np.cumsum(rises)])


def surface(place: str) -> FigureData:
    """Return one of Tables 4 to 7 over the position error, with a line for each load, by both measures."""
    table = compared_table(place)
    panels = tuple(
        Panel(
            "Position error, m",
            title,
            tuple(
                Line(f"load {load:g}", table.errors_m, values[:, k], is_printed)
                for values, is_printed in ((computed, False), (table.printed, True))
                for k, load in enumerate(table.loads)
            ),
        )
        for title, computed in (
            ("Overconsumption (12), %", table.by_plan),
            ("Above a plan for the actual load, %", table.by_load),
        )
    )
    by_plan, by_load = rms(table.by_plan - table.printed), rms(table.by_load - table.printed)
    note = (
        f"Numbers of {place} are printed. Root mean square of the differences: {by_plan:.1f} percentage points by "
        f"(12), {by_load:.1f} against a plan for the actual load."
    )
    return FigureData(panels, note)


FIGURES: tuple[PaperFigure, ...] = (
    *(
        PaperFigure(
            f"Fig. {number}",
            f"A plan on profile {profile} at {speed} km/h, followed with {reality}",
            partial(followed_plan, f"Fig. {number}"),
            f"liashenko-fig-{number}",
        )
        for number, profile, speed, reality in (
            (3, "0", 40, "full load and a position error of +10 m"),
            (4, "I", 25, "load 0.2 and a position error of -5 m"),
            (5, "II, reverse,", 50, "full load"),
            (6, "III", 30, "load 0.8 and a position error of -15 m"),
        )
    ),
    *(
        PaperFigure(
            f"Fig. {number}",
            f"Overconsumption over position error and load, profile {profile}",
            partial(surface, f"Table {number - 3}"),
            f"liashenko-{profile.lower()}",
        )
        for number, profile in ((7, "0"), (8, "I"), (9, "II"), (10, "III"))
    ),
)
"""In the order of the paper."""
