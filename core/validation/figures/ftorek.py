"""Printed figures of Ftorek 2025, rebuilt."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.strategies.enoc import enoc_coefficients, enoc_energy
from railjoule.core.strategies.plain_line import SampledRun
from railjoule.core.units import J_PER_WH, MS_PER_KMH
from railjoule.core.validation.ftorek_runs import (
    BASE_TIME_S,
    PAPER,
    TABLE_3_COPPER_WEIGHT,
    TIMES_S,
    amperes_per_newton,
    min_energies_j,
    paper_line,
    printed_entry,
    printed_run,
)
from railjoule.core.validation.table import FigureData, Line, Panel

NAMES = {"eoc": "EOC as printed", "enoc": "ENOC with the ramps of (15)"}
PRINTED = "printed extremes"
TIME, PLACE, SPEED, ACCELERATION = "Time, s", "Position, m", "Speed, km/h", "Acceleration, m/s2"
OWN_RAMP = "On page Compare ENOC has its own best ramps, not these."
NOTES = {
    "eoc": "Speeds, currents and energies agree within 1 %. The plan is drawn; the paper drew its filtered loop.",
    "enoc": f"Speeds and currents agree within 0.1 %, energies within 0.3 %. The plan is drawn. {OWN_RAMP}",
}
POINTS_A_LINE = 401
Curve = Callable[[SampledRun], tuple[FloatArray, FloatArray]]
"""Computes x and y of a run for a panel."""


def speed_figure() -> FigureData:
    """Return Figure 2: speeds of both strategies over time."""
    lines: list[Line] = []
    for strategy in NAMES:
        lines += [_line(f"{strategy.upper()}, {t} s", *_speed_over_time(printed_run(strategy, t))) for t in TIMES_S]
        lines.append(_extremes(strategy, lambda run: (run.time_s, run.speed_ms), ("max_speed_kmh",)))
    return FigureData((Panel(TIME, SPEED, tuple(lines)),), f"EOC leaves the work of drag out of its cost. {OWN_RAMP}")


def reference_figure() -> FigureData:
    """Return Figure 3: acceleration, speed and position of the reference for 300 s."""
    runs = {name: printed_run(strategy, BASE_TIME_S) for strategy, name in NAMES.items()}
    curves: dict[str, Curve] = {
        ACCELERATION: _acceleration_over_time,
        SPEED: _speed_over_time,
        PLACE: lambda run: (run.time_s, run.position_m),
    }
    panels = (
        Panel(TIME, title, tuple(_line(name, *curve(run)) for name, run in runs.items()))
        for title, curve in curves.items()
    )
    return FigureData(tuple(panels), "The paper draws the motor's angle; here it is the train's position.")


def run_figure(strategy: str) -> FigureData:
    """Return Figure 4 (`eoc`) or 5 (`enoc`): the three runs of a table, with their printed extremes."""
    amperes, speeds = amperes_per_newton(), ("max_speed_kmh",)
    currents, energies = ("max_current_a", "min_current_a"), ("peak_energy_wh", "total_energy_wh")
    panels: tuple[tuple[str, str, Curve, tuple[str, ...]], ...] = (
        (PLACE, SPEED, lambda run: (run.position_m, run.speed_ms / MS_PER_KMH), speeds),
        (TIME, SPEED, _speed_over_time, speeds),
        (TIME, "Torque current, A", lambda run: (run.time_s, amperes * run.effort_n), currents),
        (TIME, "Energy, Wh", lambda run: (run.time_s, run.energy_j / J_PER_WH), energies),
        (TIME, ACCELERATION, _acceleration_over_time, ()),
    )
    return FigureData(tuple(_run_panel(strategy, *panel) for panel in panels), NOTES[strategy])


def _speed_over_time(run: SampledRun) -> tuple[FloatArray, FloatArray]:
    return run.time_s, run.speed_ms / MS_PER_KMH


def _acceleration_over_time(run: SampledRun) -> tuple[FloatArray, FloatArray]:
    return run.time_s, run.acceleration_ms2


def _run_panel(strategy: str, x_title: str, y_title: str, curve: Curve, keys: tuple[str, ...]) -> Panel:
    lines = [_line(f"{time} s", *curve(printed_run(strategy, time))) for time in TIMES_S]
    if keys:
        lines.append(_extremes(strategy, curve, keys))
    return Panel(x_title, y_title, tuple(lines))


def _extremes(strategy: str, curve: Curve, keys: tuple[str, ...]) -> Line:
    """Return printed extremes of the three runs as points, at the places of the computed extremes."""
    points = []
    for time in TIMES_S:
        x, y = curve(printed_run(strategy, time))
        highest = int(np.argmax(y))
        places = {"max": highest, "min": int(np.argmin(y)), "peak": highest, "total": len(y) - 1}
        points += [(x[places[key.partition("_")[0]]], printed_entry(strategy, time)[key]) for key in keys]
    x, y = np.transpose(points)
    return Line(PRINTED, x, y, is_printed=True)


def _line(label: str, x: FloatArray, y: FloatArray) -> Line:
    """Return a curve with so many samples as a screen shows."""
    step = max(len(x) // POINTS_A_LINE, 1)
    # the last sample too: it has the energy of the run
    kept = np.union1d(np.arange(0, len(x), step), [len(x) - 1, np.argmax(y), np.argmin(y)])
    return Line(label, x[kept], y[kept])


def surface_figure(section: dict[str, Any]) -> FigureData:
    """Return sections of ENOC's energy surface through printed points, over T_m and over T_e.

    Parameters
    ----------
    section : dict
        Key of the `table` of points in the paper's file, and ends `longest_s` and `longest_ramp_s` of the axes [s].
    """
    line, points = paper_line(), PAPER[section["table"]]
    coefficients = enoc_coefficients(line)
    times = np.linspace(min(p["travel_time_s"] for p in points) / 1.3, section["longest_s"], POINTS_A_LINE)
    over_time = [Line("T_e of least energy", times, min_energies_j(coefficients, times) / J_PER_WH)]
    over_ramp = []
    if section["table"] == "table_3":
        label = f"T_e of least energy, {TABLE_3_COPPER_WEIGHT:g} times the copper loss"
        heavier = replace(line, loss_coefficient=TABLE_3_COPPER_WEIGHT * line.loss_coefficient)
        over_time.append(Line(label, times, min_energies_j(enoc_coefficients(heavier), times) / J_PER_WH))
    for point in points:
        time, ramp = point["travel_time_s"], point["acceleration_time_s"]
        over_time.append(Line(f"T_e = {ramp:g} s", times, enoc_energy(coefficients, times, ramp) / J_PER_WH))
        ramps = np.linspace(ramp / 5, min(section["longest_ramp_s"], time / 2), POINTS_A_LINE)
        over_ramp.append(Line(f"T_m = {time:g} s", ramps, enoc_energy(coefficients, time, ramps) / J_PER_WH))
    energies = np.array([point["total_energy_wh"] for point in points])
    panels = (
        Panel(title, "Energy, Wh", (*lines, Line("printed points", np.array([p[key] for p in points]), energies, True)))
        for title, lines, key in (
            ("Travel time T_m, s", over_time, "travel_time_s"),
            ("Acceleration time T_e, s", over_ramp, "acceleration_time_s"),
        )
    )
    note = "With the copper loss that fits Table 2; Table 3 agrees only with 3.087 times that loss."
    return FigureData(tuple(panels), note)
