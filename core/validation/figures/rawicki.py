"""Printed figures of Rawicki 2013, rebuilt."""

from functools import partial

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH
from railjoule.core.validation.figure import FigureData, Line, Panel, PaperFigure
from railjoule.core.validation.rawicki_runs import (
    Printed,
    printed_paper,
    printed_phases,
    replan,
    solve_phases,
    supply_energy_kwh,
    tram_scenario,
)

DISTANCE, TIME, SPEED, ENERGY = "Distance, m", "Time, s", "Speed, m/s", "Energy, kWh"
PRINTED = "printed"
STAGES = {
    "full_power": "start",
    "part_power": "start",
    "hold": "constant speed",
    "coast": "coasting",
    "brake": "braking",
    "stand": "stop",
}
"""Phases of a run by the paper's names."""


def undisturbed(kr: float) -> FigureData:
    """Return speed and energy of Figs. 1 or 2; only the energy at the end is printed in the text."""
    run = solve_phases(kr)
    entry = next(one for one in printed_paper()["figure"] if one["recuperation_factor"] == kr)
    end = Line(PRINTED, np.array([tram_scenario(kr).line.length_m]), np.array([entry["energy_kwh"]]), is_printed=True)
    panels = (
        Panel(DISTANCE, SPEED, _lines_by_stage(run, run.position_m)),
        Panel(TIME, SPEED, _lines_by_stage(run, run.time_s)),
        Panel(DISTANCE, ENERGY, (_energy_line(run), end)),
    )
    return FigureData(panels, _energy_note(run, entry))


def with_stop(kr: float) -> FigureData:
    """Return speed and energy of Figs. 3 or 4 with the printed ends of the phases."""
    run = replan(kr, "driver").actual
    entry = next(one for one in printed_paper()["figure"][2:] if one["recuperation_factor"] == kr)
    position, time, speed, energy = _printed_ends(kr)

    def printed(x: FloatArray, y: FloatArray) -> Line:
        return Line(PRINTED, x, y, is_printed=True)

    # for coasting, and for a brake that recuperates nothing, no energy is printed
    panels = (
        Panel(DISTANCE, SPEED, (*_lines_by_stage(run, run.position_m), printed(position, speed))),
        Panel(TIME, SPEED, (*_lines_by_stage(run, run.time_s), printed(time, speed))),
        Panel(DISTANCE, ENERGY, (_energy_line(run), printed(position, energy))),
    )
    return FigureData(panels, _energy_note(run, entry))


def _printed_ends(kr: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return distance [m], time [s], speed [m/s] and energy so far [kWh] at the printed ends of phases."""
    rows, stop_s = [(0.0, 0.0, 0.0, 0.0)], float(printed_paper()["stop_duration_s"])
    for part in ("part I", f"part II, kr = {kr:g}"):
        for phase in printed_phases(part):
            position, time, _, energy = rows[-1]
            rows.append(
                (
                    position + phase["distance_m"],
                    time + phase["duration_s"],
                    phase["end_ms"],
                    energy + supply_energy_kwh(phase, kr),
                )
            )
        if part == "part I":
            position, time, speed, energy = rows[-1]
            rows.append((position, time + stop_s, speed, energy))
    position, time, speed, energy = np.array(rows).T
    return frozen_array(position), frozen_array(time), frozen_array(speed), frozen_array(energy)


def _lines_by_stage(run: Trajectory, x: FloatArray) -> tuple[Line, ...]:
    """Return the speed of a run over distance or time, one line for each of its stages.

    A stage that occurs twice has a value that is not a number between both parts.
    """
    pieces: dict[str, list[tuple[FloatArray, FloatArray]]] = {}
    for phase in run.phases:
        # nodes just outside of a border within a cell are left out, so its ends are interpolated
        inside = (run.time_s > phase.start_s) & (run.time_s < phase.end_s)
        ends = np.interp([phase.start_s, phase.end_s], run.time_s, x)
        piece = np.concatenate([[ends[0]], x[inside], [ends[1]]])
        speed = np.concatenate([[phase.start_ms], run.speed_ms[inside], [phase.end_ms]])
        pieces.setdefault(STAGES[phase.phase], []).append((piece, speed))
    return tuple(Line(stage, *_joined(parts)) for stage, parts in pieces.items())


def _joined(parts: list[tuple[FloatArray, FloatArray]]) -> tuple[FloatArray, FloatArray]:
    gap = np.array([np.nan])
    x, y = (np.concatenate([np.append(part[axis], gap) for part in parts])[:-1] for axis in (0, 1))
    return frozen_array(x), frozen_array(y)


def _energy_line(run: Trajectory) -> Line:
    return Line("railjoule", run.position_m, frozen_array(run.supply_energy_j / J_PER_KWH))


def _energy_note(run: Trajectory, entry: Printed) -> str:
    printed = entry["energy_kwh"]
    return (
        f"railjoule needs {run.energy_kwh:.3f} kWh, the paper prints {printed:.3f} kWh "
        f"({100 * (run.energy_kwh / printed - 1):+.1f} %). The starts of railjoule take less than the full current "
        "where the pull-out torque needs less."
    )


def _figure(number: int, kr: float) -> PaperFigure:
    has_stop = number > 2
    ride = "The ride with an unplanned stop of 5 s at 300 m" if has_stop else "The ride without disturbances"
    return PaperFigure(
        place=f"Fig. {number}",
        caption=f"{ride}, kr = {kr:g}: speed by phase, and energy",
        compute=partial(with_stop if has_stop else undisturbed, kr),
        scenario="tram-950m-stop" if has_stop else "tram-950m",
        changes={"drive.recuperation_factor": kr},
    )


FIGURES: tuple[PaperFigure, ...] = tuple(_figure(number, kr) for number, kr in ((1, 0.0), (2, 1.0), (3, 0.0), (4, 1.0)))
"""In the order of the paper."""
