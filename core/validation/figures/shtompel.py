"""Printed figures of Shtompel 2025, rebuilt with the assumed train and line; the paper prints no number in them."""

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.limit_search.problem import Evaluation
from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.core.units import J_PER_KWH, MS_PER_KMH, N_PER_KN
from railjoule.core.validation.shtompel import map_efficiency, search_limits
from railjoule.core.validation.table import FigureData, Line, Panel

SPEED_KMH = 20
"""The printed average speed."""
TORQUE_SHARES = (0.1, 0.25, 0.5, 0.75)
"""Of the largest torque: the lines of Fig. 1."""
SECTIONS = "Set speed of section 1, km/h", "Set speed of section 2, km/h"
DISTANCE = "Distance, m"


def efficiency_maps() -> FigureData:
    """Return the efficiencies of motor and drive over the speed."""
    maps = map_efficiency()
    panels = []
    for whose, values in (("motor", maps.motor), ("drive", maps.drive)):
        lines = []
        for share in TORQUE_SHARES:
            row = round(share * (len(maps.torque_nm) - 1))
            lines.append(Line(f"{maps.torque_nm[row]:.0f} N m", maps.speed_rads, values[row]))
        panels.append(Panel("Speed of the motor, rad/s", f"Efficiency of the {whose}", tuple(lines)))
    return FigureData(tuple(panels), "A line ends where current or voltage do not allow its torque.")


def even_search() -> FigureData:
    """Return the first search: all combinations, and those that lower the energy."""
    samples = [one for one in search_limits(SPEED_KMH, "coast")[1].evaluations if one.stage == "sample"]
    better = _improvements(samples)
    lines = (
        Line("steps that are not optimal", *_set_speeds(samples)),
        Line("steps that lower the energy", *_set_speeds(better)),
    )
    return FigureData(
        (Panel(*SECTIONS, lines),),
        f"{len(samples)} combinations of Weyl's sequence, {len(better)} of them better than all before. They are "
        "scaled to the time of the window, so they lie on one line.",
    )


def simplex_search() -> FigureData:
    """Return the second search: the simplex from the best of the first search."""
    _, search = search_limits(SPEED_KMH, "coast")
    samples, refined = ([one for one in search.evaluations if one.stage == stage] for stage in ("sample", "refine"))
    start = _improvements(samples)[-1]
    better = _improvements([start, *refined])
    speeds = (
        Line("steps of the simplex", *_set_speeds([start, *refined])),
        Line("steps that lower the energy", *_set_speeds(better)),
    )
    energies = np.array([one.energy_j for one in refined]) / J_PER_KWH
    energy = Line("simplex", np.arange(1.0, len(refined) + 1), np.where(np.isfinite(energies), energies, np.nan))
    panels = Panel(*SECTIONS, speeds), Panel("Step", "Energy, kWh", (energy,))
    first, last = (one.energy_j / J_PER_KWH for one in (start, search.best))
    return FigureData(panels, f"From {first:.3f} kWh, the best of the first search, to {last:.3f} kWh.")


def optimal_schedule() -> FigureData:
    """Return set speed, speed, force, energy and profile over the distance."""
    run, search = search_limits(SPEED_KMH, "coast")
    best = search.best
    line = run.scenario.line.in_running_order()
    ends = np.concatenate([[0.0], np.repeat(best.boundaries_m, 2), [line.length_m]])
    places = np.repeat(run.position_m, 2)[1:-1]
    force = np.repeat(run.tractive_effort_n - run.electric_braking_n - run.friction_braking_n, 2) / N_PER_KN
    panels = (
        Panel(
            DISTANCE,
            "Speed, km/h",
            (
                Line("set speed", ends, np.repeat(best.limits_ms, 2) / MS_PER_KMH),
                Line("speed", run.position_m, run.speed_ms / MS_PER_KMH),
            ),
        ),
        Panel(DISTANCE, "Force, kN", (Line("tractive force", places, force),)),
        Panel(DISTANCE, "Energy, kWh", (Line("energy", run.position_m, run.supply_energy_j / J_PER_KWH),)),
        Panel(DISTANCE, "Height, m", (Line("profile", section_borders(line), height_profile(line)),)),
    )
    return FigureData(
        panels,
        f"{run.energy_kwh:.3f} kWh in {run.travel_time_s:.1f} s. The regulator coasts above the set speed, so the "
        "train exceeds it downhill.",
    )


def _improvements(evaluations: list[Evaluation]) -> list[Evaluation]:
    """Return the evaluations that need less energy than all before them."""
    better: list[Evaluation] = []
    for one in evaluations:
        if np.isfinite(one.energy_j) and (not better or one.energy_j < better[-1].energy_j):
            better.append(one)
    return better


def _set_speeds(evaluations: list[Evaluation]) -> tuple[FloatArray, FloatArray]:
    """Return the set speeds of two sections [km/h]."""
    first, second = np.array([one.limits_ms for one in evaluations]).T / MS_PER_KMH
    return frozen_array(first), frozen_array(second)
