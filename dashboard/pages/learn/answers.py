"""The answers to the guesses, and what explains them: the figures above the curves, and the optimum in sentences.

Above its cost, a joule of kinetic energy is bought with full power; below the value of braking it is braked away;
between the two the train coasts: see `railjoule.core.studies.steady`, which has both values for a drive of constant
efficiency.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.energy import share_above
from railjoule.core.energy_along import BRAKES, EnergyAlong, Stretch, energy_along, stretches
from railjoule.core.phases import PhaseName
from railjoule.core.phases.borders import FULL_BRAKING_SHARE
from railjoule.core.phases.labels import HOLD_TOLERANCE_MS, SHORTEST_S
from railjoule.core.studies.steady import steady_speeds
from railjoule.core.units import J_PER_KWH, J_PER_WH
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.learn.compute import LessonResult
from railjoule.dashboard.pages.learn.lessons import TEXTS, Lesson
from railjoule.dashboard.parts import html as parts

WITHOUT = "without recuperation it is the dashed run itself."
ENERGIES: Mapping[str, Callable[[EnergyAlong], Any]] = {
    "Kinetic": lambda along: along.motion_j,
    "Potential": lambda along: along.height_j,
    "Resistance": lambda along: along.resistance_j,
    "Losses": lambda along: along.losses_j,
    "Regenerated": lambda along: along.returned_j,
    "Drawn from the supply": lambda along: along.drawn_j,
}
"""Energies of a run up to a place, by their words."""
NUMBERS: Mapping[str, Callable[[LessonResult], float]] = {
    "coasting": lambda result: 100 * result.saved_share,
    "multiplier": lambda result: _difference_j(result) / J_PER_WH,
    "recuperation": lambda result: off_m(next(iter(result.runs.values()))),
    "gradient": lambda result: 100 * result.saved_share,
    "load": lambda result: 100 * share_above(*(run.energy_kwh for run in reversed(tuple(result.runs.values())))),
}
"""The answers, each in the unit of its guess."""


class Answer(NamedTuple):
    """The answer to a question, in the unit of the guess, and its reason: the end of a sentence."""

    number: float
    because: str


def find_answer(lesson: Lesson, result: LessonResult) -> Answer:
    """Return the answer to the question of a lesson."""
    first, second = result.runs.values()
    fields = {"later": words.number(off_m(first) - off_m(second), 0)}
    for number, run in enumerate((first, second), 1):
        fields |= {
            f"from_{number}": words.speed(run.phases[-1].start_ms, 1),
            f"away_{number}": words.energy(braked_away_kwh(run)),
            f"off_{number}": words.number(off_m(run), 0),
            f"energy_{number}": words.energy(run.energy_kwh),
            f"returned_{number}": words.energy(run.energy.recuperated_j / J_PER_KWH),
        }
    no_difference = lesson.name == "recuperation" and first.energy.recuperated_j <= 0
    return Answer(NUMBERS[lesson.name](result), WITHOUT if no_difference else lesson.because.format(**fields))


def motors_off_m(run: Trajectory) -> float | None:
    """Return the position at which the motors of a run are switched off for the last time [m]; None if never."""
    # a run may also coast for a moment where it has reached the speed that it then holds
    return next((phase.start_m for phase in reversed(run.phases) if phase.phase == "coast"), None)


def off_m(run: Trajectory) -> float:
    """Return the position at which a run stops using its motors [m]; without coasting, that is the braking point."""
    off = motors_off_m(run)
    return run.phases[-1].start_m if off is None else off


def braked_away_kwh(run: Trajectory) -> float:
    """Return the energy that a run loses in its brakes [kWh]."""
    return sum(run.energy.losses_j.get(kind, 0.0) for kind in BRAKES) / J_PER_KWH


def _difference_j(result: LessonResult) -> float:
    first, second = result.runs.values()
    return first.energy.net_j - second.energy.net_j


# ---- the numbers above the curves


def compared_cells(lesson: Lesson, result: LessonResult) -> list[str]:
    """Return the numbers of the run that the optimum is compared with, which may be known before a guess."""
    name, run = list(result.runs.items())[1]
    cells = [
        _energy(run, name[0].upper() + name[1:], "main"),
        parts.figure("Highest speed", words.number(run.max_speed_kmh), "km/h", ""),
    ]
    off = motors_off_m(run)
    if off is not None and lesson.name == "recuperation":
        cells.append(parts.figure("Motors off at", words.number(off, 0), "m", ""))
    return cells


def cells(lesson: Lesson, result: LessonResult) -> list[str]:
    """Return the numbers of a lesson: what it is about, the energies of both runs, and what else explains it."""
    first, second = result.runs.values()
    saved = (words.share(result.saved_share), "%", "")
    more = {
        "load": (words.number(NUMBERS[lesson.name](result)), "%", "more energy"),
        "multiplier": (words.price(first.price_of_time_w or 0.0), "Wh/s", "the multiplier"),
    }
    headline = parts.figure(lesson.headline, *more.get(lesson.name, saved), "main", term=lesson.term)
    energies = [_energy(first, lesson.first_name), _energy(second, lesson.second_name)]
    return [headline, *energies, *_more_cells(lesson, result, first, second)]


def _more_cells(lesson: Lesson, result: LessonResult, first: Trajectory, second: Trajectory) -> list[str]:
    if lesson.name == "coasting":
        coasts = sum(phase.end_m - phase.start_m for phase in first.phases if phase.phase == "coast")
        return [parts.figure("Coasts", words.share(coasts / first.distance_m), "%", "of the distance")]
    if lesson.name == "multiplier":
        check = f"solved for {words.number(second.travel_time_s, 0)} s"
        return [parts.figure("Check", words.price(_difference_j(result)), "Wh", check)]
    if lesson.name == "recuperation" and result.steady is not None:
        brakes = f"brakes at {words.speed(result.steady.brake_ms)} km/h"
        return [parts.figure("Motors off at", words.number(off_m(first), 0), "m", brakes)]
    if lesson.name == "load":
        late = second.travel_time_s - second.scenario.travel_time_s
        return [parts.figure("Arrives", words.delay(late), "s", "late" if late >= 0.05 else "on time")]
    return []


def _energy(run: Trajectory, label: str, kind: str = "") -> str:
    detail = f"in {words.time(run.travel_time_s)} s"
    return parts.figure(label, words.energy(run.energy_kwh), "kWh", detail, kind, term="Energy from the supply")


# ---- energies along the runs


def energies_at(run: Trajectory, place_m: float) -> dict[str, float]:
    """Return the energies of a run up to a place, by the words of their bars [kWh]."""
    along = energy_along(run)
    return {word: float(np.interp(place_m, along.position_m, of(along))) / J_PER_KWH for word, of in ENERGIES.items()}


def energy_table(lesson: Lesson, runs: Mapping[str, Trajectory], place_m: float) -> parts.Markup:
    """Return a table with bars of the energies of some runs up to a place."""
    columns = [energies_at(run, place_m) for run in runs.values()]
    # the largest along the way, so that bars of different places can be compared
    widest = max(max(abs(one) for one in energies_at(run, run.distance_m).values()) for run in runs.values())
    kinds = ["other"] if len(runs) == 1 else ["best", "other"]
    rows = [
        parts.markup(
            "<tr><th scope=row>{}</th><td class=bars aria-hidden=true>{}</td>{}</tr>",
            word,
            parts.joined(
                parts.markup(
                    "<i class='{}{}' style='width:{}%'></i>",
                    kind,
                    " less" if column[word] < 0 else "",
                    f"{min(100 * abs(column[word]) / widest, 100):.1f}",
                )
                for kind, column in zip(kinds, columns, strict=True)
            ),
            parts.joined(parts.markup("<td>{}</td>", words.number(column[word], 2)) for column in columns),
        )
        for word in ENERGIES
    ]
    heads = (
        parts.markup("<th scope=col><i class={} aria-hidden=true></i>{}</th>", kind, name)
        for kind, name in zip(kinds, runs, strict=True)
    )
    return parts.markup(
        "<div class=energies><table data-name='Energies up to {place} m'><caption>Up to {place} m, kWh</caption><thead>"
        "<tr><th scope=col>Energy</th><td></td>{heads}</tr></thead><tbody>{rows}</tbody></table></div>",
        place=words.number(place_m, 0),
        heads=parts.joined(heads),
        rows=parts.joined(rows),
    )


# ---- the stretches of an optimum

LEAST_J = words.LEAST_ENERGY_KWH * J_PER_KWH
SENTENCES = TEXTS["stretch"]


@dataclass(frozen=True)
class StretchWords:
    """A stretch in words.

    Parameters
    ----------
    phase, where, sentence : str
        The phase, as the name of its colour; its ends; what the train does and why.
    """

    phase: PhaseName
    where: str
    sentence: str


def stretch_words(run: Trajectory) -> tuple[StretchWords, ...]:
    """Return the stretches of an optimum whose drive has a constant efficiency, in order.

    A stretch on the way that is too short for an instruction of its own is left out.
    """
    price = run.price_of_time_w or 0.0
    steady, along, parts = steady_speeds(run.scenario, price), energy_along(run), stretches(run)
    prices = {
        "second": f"{words.price(price)} Wh a second",
        "costs": words.number(steady.driving_adjoint, 2),
        "returns": words.number(steady.braking_adjoint, 2),
    }
    ends = parts[0], parts[-1]
    long = (part for part in parts if part in ends or part.phase.end_s - part.phase.start_s >= SHORTEST_S)
    return tuple(_in_words(run, part, along, prices) for part in long)


def _in_words(run: Trajectory, part: Stretch, along: EnergyAlong, prices: dict[str, str]) -> StretchWords:
    phase, lent = part.phase, _lent_j(part, along)
    recovered = -phase.energy_j
    numbers = {
        "start": words.speed(phase.start_ms, 1),
        "end": words.speed(phase.end_ms, 1),
        "mean": words.speed(phase.mean_speed_ms, 1),
        "lasts": words.time(phase.end_s - phase.start_s),
        "drawn": _kwh(phase.energy_j),
        "resistance": _kwh(part.resistance_j),
        "kinetic": _kwh(-part.motion_j),
        "recovered": f"{_kwh(recovered)} kWh" if recovered > LEAST_J else "none",
        "descent": SENTENCES["descent"].format(lent=_kwh(lent)) if lent > LEAST_J else "",
    }
    where = f"{words.number(phase.start_m, 0)}\u2013{words.number(phase.end_m, 0)} m"
    return StretchWords(phase.phase, where, SENTENCES[_kind(run, part)].format(**numbers, **prices))


def _kind(run: Trajectory, part: Stretch) -> str:
    """Return which sentence a stretch has."""
    phase, data = part.phase, run.run_data
    if phase.phase == "hold":
        cell = int(np.searchsorted(data.position_m, phase.start_m, side="right")) - 1
        at_limit = phase.mean_speed_ms >= data.limit_ms[cell] - HOLD_TOLERANCE_MS
        return "hold_limit" if at_limit else "hold"
    planned = phase.phase == "brake" and (phase.effort_share or 0.0) < FULL_BRAKING_SHARE
    return "brake_curve" if planned else phase.phase


def _kwh(joules: float) -> str:
    return words.energy(joules / J_PER_KWH)


def _lent_j(part: Stretch, along: EnergyAlong) -> float:
    """Return by how much a stretch lies lower on its way than where it starts, as energy [J]."""
    places = along.position_m[(along.position_m >= part.phase.start_m) & (along.position_m <= part.phase.end_m)]
    heights = np.interp([part.phase.start_m, *places, part.phase.end_m], along.position_m, along.height_j)
    return float(heights[0] - heights.min())
