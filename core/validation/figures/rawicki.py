"""Printed figures of Rawicki 2013, rebuilt."""

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH
from railjoule.core.validation.rawicki_runs import (
    PAPER,
    printed_phases,
    replan,
    solve_phases,
    supply_energy_kwh,
    tram_scenario,
)
from railjoule.core.validation.table import FigureData, Line, Panel

DISTANCE, TIME, SPEED, ENERGY = "Distance, m", "Time, s", "Speed, m/s", "Energy, kWh"
STAGES = {
    "full_power": "start",
    "part_power": "start",
    "hold": "constant speed",
    "coast": "coasting",
    "brake": "braking",
    "stand": "stop",
}
"""Phases of a run by the paper's names."""


def ride(place: str) -> FigureData:
    """Return speed and energy of one of Figs. 1 to 4, with the printed ends of phases of Figs. 3 and 4."""
    entry = next(one for one in PAPER["figure"] if one["place"] == place)
    kr = float(entry["recuperation_factor"])
    if "penalty_percent" in entry:
        run, ends = replan(kr, "driver").actual, _printed_ends(kr)
    else:
        # only the energy at the end is printed
        run, ends = solve_phases(kr), np.array([[tram_scenario(kr).line.length_m, np.nan, np.nan, entry["energy_kwh"]]])
    position, time, speed, energy = map(frozen_array, ends.T)
    own = Line("railjoule", run.position_m, frozen_array(run.supply_energy_j / J_PER_KWH))
    panels = (
        Panel(DISTANCE, SPEED, (*_lines_by_stage(run, run.position_m), *_printed(position, speed))),
        Panel(TIME, SPEED, (*_lines_by_stage(run, run.time_s), *_printed(time, speed))),
        Panel(DISTANCE, ENERGY, (own, *_printed(position, energy))),
    )
    printed = entry["energy_kwh"]
    note = (
        f"railjoule needs {run.energy_kwh:.3f} kWh, the paper prints {printed:.3f} kWh "
        f"({100 * (run.energy_kwh / printed - 1):+.1f} %). The starts of railjoule take less than the full current "
        "where the pull-out torque needs less."
    )
    return FigureData(panels, note)


def _printed(x: FloatArray, y: FloatArray) -> tuple[Line, ...]:
    """Return printed points as a line; nothing where no number is printed."""
    return (Line("printed", x, y, is_printed=True),) if np.isfinite(y).any() else ()


def _printed_ends(kr: float) -> FloatArray:
    """Return distance [m], time [s], speed [m/s] and energy so far [kWh] at the printed ends of phases.

    For coasting, and for a brake that recuperates nothing, no energy is printed.
    """
    rows = [(0.0, 0.0, 0.0, 0.0)]
    stop = {"distance_m": 0.0, "duration_s": PAPER["stop_duration_s"], "end_ms": 0.0}
    for phase in (*printed_phases("part I"), stop, *printed_phases(f"part II, kr = {kr:g}")):
        position, time, _, energy = rows[-1]
        position, time = position + phase["distance_m"], time + phase["duration_s"]
        rows.append((position, time, phase["end_ms"], energy + supply_energy_kwh(phase, kr)))
    return np.array(rows)


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
