"""Printed figures of Liashenko 2025, rebuilt."""

import numpy as np

from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.core.units import MS_PER_KMH
from railjoule.core.validation.liashenko_runs import compared_table, example, rms
from railjoule.core.validation.table import FigureData, Line, Panel

DISTANCE = "Distance, m"


def followed_plan(place: str) -> FigureData:
    """Return the planned and the actual speed of one of Figures 3 to 6, their difference, and the line's heights."""
    run, _ = example(place)
    line = run.planned.scenario.line.in_running_order()
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
        Panel(DISTANCE, "Height, m", (Line("track", section_borders(line), height_profile(line)),)),
    )
    return FigureData(panels, note)


def surface(place: str) -> FigureData:
    """Return one of Tables 4 to 7 over the position error, with a line for each load, by both measures."""
    table = compared_table(place)
    panels = tuple(
        Panel(
            "Position error, m",
            title,
            tuple(
                Line(f"load {load:g}", np.array(table.coordinate_error_m), values, is_printed)
                for key, is_printed in ((computed, False), ("printed", True))
                for load, values in zip(table.load_factor, table[key], strict=True)
            ),
        )
        for title, computed in (
            ("Overconsumption (12), %", "by_plan"),
            ("Above a plan for the actual load, %", "by_load"),
        )
    )
    by_plan, by_load = rms(table.by_plan - table.printed), rms(table.by_load - table.printed)
    note = (
        f"Numbers of {place} are printed. Root mean square of the differences: {by_plan:.1f} percentage points by "
        f"(12), {by_load:.1f} against a plan for the actual load."
    )
    return FigureData(panels, note)
