"""The lesson that is drawn: the mesh, the run below a drawing, and how it compares with the best in its time."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from railjoule.core import Scenario, ScenarioError, Trajectory, load_scenario, solve
from railjoule.core.arrays import FloatArray
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.phases import PhaseName
from railjoule.core.simulation.manual import drive_drawn
from railjoule.core.strategies import prepare_task
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.learn.by_hand import FASTER, MORE, beyond, mesh_arrays

PRESET = "liashenko-iii"
"""A metro with a constant efficiency on a long climb, whose optimum has all four phases."""
POINTS = 35
"""A drawing has a point every 50 m."""
LEAST_KMH, MOST_KMH = 5, 80
DRAWN = re.compile(r"\d{1,2}(,\d{1,2})*")
REASONS: Mapping[PhaseName, str] = {
    "full_power": "speed won early serves the whole run",
    "part_power": "just the power that the limit leaves room for",
    "hold": "resistance rises with speed, so an even speed is the cheapest",
    "coast": "resistance takes the speed that the brakes would waste",
    "brake": "late, and from a lower speed",
    "stand": "the timetable asks for it",
}
# of the line: what is shorter nobody sees in the figure
SHORT_SHARE = 0.01
# below both of these one did as the optimum does
ALIKE_KMH, ALIKE_KWH = 1.0, 0.05
STRETCH = "{start}\u2013{end} m, {phase}: {reason}."
DID_ALIKE = "{stretch} You did much the same."
DID = "{stretch} You were {pace} and used {energy} kWh {more} here."
PACE, SAME_PACE = "{speed} km/h {faster} on average", "as fast on average"


@dataclass(frozen=True)
class DrawingRequest:
    """A drawing as a text: a speed in km/h at each point, such as 40,60,60.

    Parameters
    ----------
    judged : str
        The one to be compared with the best; empty where only the meshed line is asked for.
    begun : str
        The one to begin with; empty for one at the limit.
    """

    judged: str = ""
    begun: str = ""


@dataclass(frozen=True, eq=False)
class DrawingResult:
    """What the browser is told.

    Parameters
    ----------
    request : DrawingRequest
    mesh : mapping
        What the train obeys.
    shortest_s : float
        Shortest possible time [s].
    begun : tuple of int
        The drawing to begin with [km/h].
    verdict : mapping or None
        How a drawing compares with the best run; None where there was none.
    """

    request: DrawingRequest
    mesh: Mapping[str, Any]
    shortest_s: float
    begun: tuple[int, ...]
    verdict: Mapping[str, Any] | None = None


def judge_drawing(request: DrawingRequest) -> DrawingResult:
    """Return the meshed line and how a drawing compares with the best run.

    Raises
    ------
    ScenarioError
        If a text is no drawing.
    TimetableError
        If a drawing leaves no time to save with.
    """
    begun = read_drawing(request.begun) if request.begun else (MOST_KMH,) * POINTS
    scenario, mesh = drawing_lesson()
    verdict = verdict_on(read_drawing(request.judged)) if request.judged else None
    shortest = prepare_task(scenario).shortest_travel_time_s
    return DrawingResult(request, mesh_arrays(mesh), shortest, begun, verdict)


@cache
def drawing_lesson() -> tuple[Scenario, MeshedLine]:
    """Return the scenario of the lesson, and its meshed line."""
    scenario = load_scenario(PRESET)
    return scenario, build_meshed_line(scenario)


def read_drawing(text: str) -> tuple[int, ...]:
    """Return the speeds of a drawing [km/h].

    Raises
    ------
    ScenarioError
        If there is not one whole number within the bounds for each point.
    """
    speeds = tuple(int(one) for one in text.split(",")) if DRAWN.fullmatch(text) else ()
    if len(speeds) != POINTS or not all(LEAST_KMH <= one <= MOST_KMH for one in speeds):
        raise ScenarioError(
            f"drawn must be {POINTS} whole numbers from {LEAST_KMH} to {MOST_KMH}, with commas between."
        )
    return speeds


def run_of(speeds_kmh: Sequence[int]) -> Trajectory:
    """Return the run beneath a drawing."""
    scenario, mesh = drawing_lesson()
    places = np.linspace(0.0, float(mesh.position_m[-1]), len(speeds_kmh))
    return drive_drawn(scenario, mesh, np.interp(mesh.position_m, places, speeds_kmh) * MS_PER_KMH)


def verdict_on(speeds_kmh: Sequence[int]) -> dict[str, Any]:
    """Return how a drawing compares with the best run in its own time, in numbers and sentences."""
    run = run_of(speeds_kmh)
    best = solve(in_time_of(run))
    bound = best.bound
    assert bound is not None
    # the optimum may have a finer mesh; within a cell the square of speed is linear
    best_j = np.interp(run.position_m, best.position_m, best.supply_energy_j)
    return {
        "points": list(speeds_kmh),
        "kwh": run.energy_kwh,
        "time_s": run.travel_time_s,
        "bound_kwh": bound.energy_j / J_PER_KWH,
        "proven": best.is_proven,
        "best_kwh": best.energy_kwh,
        "best_ms": np.sqrt(np.interp(run.position_m, best.position_m, best.speed_ms**2)).tolist(),
        "above_kwh": ((run.supply_energy_j - best_j) / J_PER_KWH).tolist(),
        "rows": beyond(run, best),
        "stretches": stretches(run, best),
    }


def in_time_of(run: Trajectory) -> Scenario:
    """Return the scenario of the lesson with the time of a run."""
    return drawing_lesson()[0].replace(**{"timetable.travel_time_s": run.travel_time_s})


def stretches(run: Trajectory, best: Trajectory) -> list[str]:
    """Return a sentence on each stretch of the best run: what it does, why, and what one did there."""
    joined: list[tuple[PhaseName, float, float]] = []
    for phase in best.phases:
        if joined and (phase.phase == joined[-1][0] or phase.end_m - phase.start_m < SHORT_SHARE * best.distance_m):
            joined[-1] = (*joined[-1][:2], phase.end_m)
        else:
            joined.append((phase.phase, phase.start_m, phase.end_m))
    return [_on_stretch(run, best, *stretch) for stretch in joined]


def _on_stretch(run: Trajectory, best: Trajectory, phase: PhaseName, start_m: float, end_m: float) -> str:
    """Return the sentence on one stretch of the best run."""
    start, end = words.number(start_m, 0), words.number(end_m, 0)
    stretch = STRETCH.format(start=start, end=end, phase=words.PHASE_WORDS[phase], reason=REASONS[phase])
    mine, least = ((_mean_speed(one, start_m, end_m), _taken_kwh(one, start_m, end_m)) for one in (run, best))
    faster, more = (mine[0] - least[0]) / MS_PER_KMH, mine[1] - least[1]
    if abs(faster) < ALIKE_KMH and abs(more) < ALIKE_KWH:
        return DID_ALIKE.format(stretch=stretch)
    pace = PACE.format(speed=words.number(abs(faster), 0), faster=FASTER[faster < 0])
    return DID.format(
        stretch=stretch,
        pace=SAME_PACE if abs(faster) < ALIKE_KMH else pace,
        energy=f"{abs(more):.2f}",
        more=MORE[more < 0],
    )


def _growth(places: FloatArray, values: FloatArray, start_m: float, end_m: float) -> float:
    """Return by how much a quantity grows over a stretch."""
    first, last = np.interp([start_m, end_m], places, values)
    return float(last - first)


def _mean_speed(run: Trajectory, start_m: float, end_m: float) -> float:
    return (end_m - start_m) / _growth(run.position_m, run.time_s, start_m, end_m)


def _taken_kwh(run: Trajectory, start_m: float, end_m: float) -> float:
    return _growth(run.position_m, run.supply_energy_j, start_m, end_m) / J_PER_KWH
