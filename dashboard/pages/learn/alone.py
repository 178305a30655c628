"""The lessons where no server answers, as in a report: all that the browser needs to judge what is played.

`verdicts.js` in assets/scripts makes of it what `by_hand.verdict_on`, `slack.verdict_on` and `drawing.verdict_on` tell
on the page, in the same words. What was driven and what was shared out have one time, and so the same optimum. A
drawing has a time of its own: its bound is that of `railjoule.core.bounds.time_lines`, and what is laid over it is the
nearest of many optima that take no longer, which is told.
"""

from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from railjoule.core import Trajectory, load_scenario
from railjoule.core.bounds import TimeLines, time_lines
from railjoule.core.energy import SMALL_ENERGY_KWH
from railjoule.core.simulate.by_hand import PARTED_MS
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.learn import by_hand, drawing, slack

OPTIMA_COUNT = 240
"""Over the times of drawings; between two of them, the lines lie a ten-thousandth below the least energy at most."""
LEAST_SLACK_S = 0.4
"""Beyond the shortest time, of the first of them: less than what draw_speed.js asks for before it compares."""
LATEST_SHARE = 1.02
"""The last of them takes so many times as long as a train at the least speed that can be drawn."""


DRAWN_MS, DRAWN_KWH = 0.05, 0.01
"""As closely an optimum is written down at its nodes [m/s, kWh]: all together they are most of a lesson's data, and
between the nodes that are kept the browser lets an even force act."""


@dataclass(frozen=True, eq=False)
class DrawingOptima:
    """The optima of the line that is drawn upon, over rising times, and what they prove of all times."""

    runs: tuple[Trajectory, ...]
    lines: TimeLines


@cache
def drawing_optima() -> DrawingOptima:
    """Return the optima over the times that drawings may take."""
    scenario, course = drawing.drawing_lesson()
    task = prepare_task(scenario)
    latest = LATEST_SHARE * float(course.position_m[-1]) / (drawing.LEAST_KMH * MS_PER_KMH)
    shortest = task.shortest_time_s
    times = shortest + np.geomspace(LEAST_SLACK_S, latest - shortest, OPTIMA_COUNT)
    runs = tuple(run_strategy(replace(task, running_time_s=float(time)), "optimal") for time in times)
    return DrawingOptima(runs, time_lines(task, times))


def drive_it() -> dict[str, Any]:
    """Return the lesson that is driven: its course, and the optimum with what a try is told of it."""
    scenario, course = by_hand.lesson()
    best = by_hand.best_run()
    bound = best.bound
    assert bound is not None
    return {
        "timetable_s": scenario.travel_time_s,
        "length_km": load_scenario(by_hand.PRESET).line.length_m / 1000,
        "course": by_hand.course_arrays(course),
        "in_time_s": by_hand.IN_TIME_S,
        "parted_ms": PARTED_MS,
        "best": {
            "kwh": best.energy_kwh,
            "bound_kwh": bound.energy_j / J_PER_KWH,
            "proven": best.is_proven,
            "ms": best.speed_ms.tolist(),
            "so_far_kwh": (best.line_energy_j / J_PER_KWH).tolist(),
            "spent_kwh": by_hand.spent_kwh(best),
            "phases": [[phase.end_m, words.PHASE_WORDS[phase.phase]] for phase in best.phases],
        },
        "words": {
            **_words(),
            "did": by_hand.DID,
            "here": by_hand.HERE,
            "there": by_hand.THERE,
            "small_kwh": SMALL_ENERGY_KWH,
        },
    }


def share_out() -> dict[str, Any]:
    """Return the lesson on slack: the tables of its lines, and the best sharing of each."""
    begun = slack.judge_slack(slack.SlackRequest())
    return {
        "lines": dict(begun.lines),
        "begun": dict(begun.begun),
        "best": {name: slack.best_of(name) for name in begun.lines},
        "alike_s": slack.ALIKE_S,
        "words": {
            "as_best": slack.AS_BEST,
            "too_many": slack.TOO_MANY,
            "too_few": slack.TOO_FEW,
            "small_price_wh": words.SMALL_PRICE_WH_PER_S,
        },
    }


def draw_speed() -> dict[str, Any]:
    """Return the lesson that is drawn: its course, the optima over the times of drawings, and what they prove."""
    begun, optima = drawing.judge_drawing(drawing.DrawingRequest()), drawing_optima()
    lines = optima.lines
    return {
        "course": dict(begun.course),
        "shortest_s": begun.shortest_s,
        "begun": list(begun.begun),
        "ends_kmh": [drawing.LEAST_KMH, drawing.MOST_KMH],
        "bounds": {
            "time_s": lines.travel_time_s.tolist(),
            "kwh": (lines.energy_j / J_PER_KWH).tolist(),
            "kwh_a_second": (lines.price_of_time_w / J_PER_KWH).tolist(),
        },
        "optima": [_optimum(run) for run in optima.runs],
        "alike": [drawing.ALIKE_KMH, drawing.ALIKE_KWH],
        "words": {
            **_words(),
            "did_alike": drawing.DID_ALIKE,
            "did": drawing.DID,
            "pace": drawing.PACE,
            "same_pace": drawing.SAME_PACE,
            "best_name": drawing.BEST_NAME,
            "other_time": drawing.OTHER_TIME,
        },
    }


def kept_nodes(run: Trajectory) -> list[int]:
    """Return nodes between which an even force gives all speeds and energies within DRAWN_MS and DRAWN_KWH."""
    places, speed, energy = run.nodes_m, run.node_speed_ms, run.line_energy_j / J_PER_KWH
    kept, open_pairs = {0, len(places) - 1}, [(0, len(places) - 1)]
    while open_pairs:
        first, last = open_pairs.pop()
        ends, inner = [first, last], slice(first + 1, last)
        speed2, used = (np.interp(places[inner], places[ends], values[ends]) for values in (speed**2, energy))
        off = np.maximum(np.abs(np.sqrt(speed2) - speed[inner]) / DRAWN_MS, np.abs(used - energy[inner]) / DRAWN_KWH)
        if len(off) and off.max() > 1.0:
            # the farthest one has to be kept, and may be enough
            worst = first + 1 + int(np.argmax(off))
            kept.add(worst)
            open_pairs += [(first, worst), (worst, last)]
    return sorted(kept)


def _optimum(run: Trajectory) -> dict[str, Any]:
    kept = kept_nodes(run)
    # the figure draws the lines, and needs no more digits
    return {
        "time_s": run.travel_time_s,
        "kwh": run.energy_kwh,
        "kept": kept,
        "ms": np.round(run.node_speed_ms[kept], 2).tolist(),
        "so_far_kwh": np.round(run.line_energy_j[kept] / J_PER_KWH, 4).tolist(),
        "spent_kwh": by_hand.spent_kwh(run),
        "stretches": drawing.told_stretches(run),
    }


def _words() -> dict[str, Any]:
    """Return the words of differences."""
    return {"faster": by_hand.FASTER, "more": by_hand.MORE, "beyond": by_hand.BEYOND}
