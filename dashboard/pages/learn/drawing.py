"""The lesson that is drawn: the mesh, the run below a drawing, and how it compares with the best in its time."""

import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np

from railjoule.core import Scenario, ScenarioError, Trajectory, load_scenario, solve
from railjoule.core.motion import MeshedLine, build_meshed_line
from railjoule.core.phases import PhaseName
from railjoule.core.simulation.manual import drive_drawn
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.learn.lessons import TEXTS
from railjoule.dashboard.pages.learn.verdict import FASTER, MORE, Verdict, compare

PRESET = "liashenko-iii"
"""A metro with a constant efficiency on a long climb, whose optimum has all four phases."""
POINTS = 35
"""A drawing has a point every 50 m."""
LEAST_KMH, MOST_KMH = 5, 80
TARGET_S = 130.0
"""The train is to arrive by then."""
DRAWN = re.compile(r"\d{1,2}(,\d{1,2})*")
REASONS: Mapping[PhaseName, str] = TEXTS["reason"]
# of the line: what is shorter nobody sees in the figure
SHORT_SHARE = 0.01
# below both of these one did as the optimum does
ALIKE_KMH, ALIKE_KWH = 1.0, 0.05
STRETCH = "{start}\u2013{end} m, {phase}: {reason}."
DID_ALIKE = "{stretch} You did much the same."
DID = "{stretch} You were {pace} and used {energy} kWh {more} here."
PACE, SAME_PACE = "{speed} km/h {faster} on average", "as fast on average"


def begin(text: str) -> dict[str, Any]:
    """Return the initial data of the browser: the line, and a drawing at the limit or from a link.

    Raises
    ------
    ScenarioError
        If the text is no drawing.
    """
    points = read_drawing(text) if text else (MOST_KMH,) * POINTS
    return {"points": list(points)}


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


def drive_drawing(speeds_kmh: Sequence[int]) -> Trajectory:
    """Return the run below a drawing."""
    scenario, mesh = drawing_lesson()
    places = np.linspace(0.0, float(mesh.position_m[-1]), len(speeds_kmh))
    return drive_drawn(scenario, mesh, np.interp(mesh.position_m, places, speeds_kmh) * MS_PER_KMH)


def judge(text: str) -> Verdict:
    """Compare a drawing with the best run that arrives in time, or as late as the drawing.

    Raises
    ------
    ScenarioError
        If the text is no drawing.
    """
    run = drive_drawing(read_drawing(text))
    best = solve(compared_scenario(run))
    return compare(("drawn", text), run, best, TARGET_S, tuple(stretches(run, best)))


def opened(text: str) -> Scenario:
    """Return the scenario in which the best run beside a drawing is found; errors as `judge`."""
    return compared_scenario(drive_drawing(read_drawing(text)))


def compared_scenario(run: Trajectory) -> Scenario:
    """Return the scenario of the lesson in the time that a run is allowed: its own, if it is late."""
    return drawing_lesson()[0].replace(**{"timetable.travel_time_s": max(TARGET_S, run.travel_time_s)})


def stretches(run: Trajectory, best: Trajectory) -> list[str]:
    """Return a sentence on each stretch of the best run: its action, the reason, and the action of the drawing."""
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
    mine, least = (_pace_and_energy(one, start_m, end_m) for one in (run, best))
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


def _pace_and_energy(run: Trajectory, start_m: float, end_m: float) -> tuple[float, float]:
    """Return mean speed [m/s] and energy [kWh] of a run over a stretch."""
    time_s, energy_j = (
        float(np.diff(np.interp([start_m, end_m], run.position_m, one))[0]) for one in (run.time_s, run.supply_energy_j)
    )
    return (end_m - start_m) / time_s, energy_j / J_PER_KWH
