"""The answers to the guesses, from what the lessons compute, each with the numbers that explain it."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from railjoule.core import Trajectory
from railjoule.core.energy import share_above
from railjoule.core.energy_along import BRAKES
from railjoule.core.units import J_PER_KWH, J_PER_WH
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.learn.compute import LessonResult


class Answer(NamedTuple):
    """What was asked for, in the unit of the guess, and why it is that: the end of a sentence."""

    number: float
    because: str


def answer_of(result: LessonResult) -> Answer:
    """Return the answer to the question of a lesson."""
    return ANSWERS[result.request.lesson](result)


def motors_off_m(run: Trajectory) -> float | None:
    """Return where the motors of a run are switched off for the last time [m]; None where they never are."""
    # a run may also coast for a moment where it has reached the speed that it then holds
    return next((phase.start_m for phase in reversed(run.phases) if phase.phase == "coast"), None)


def brakes_from_ms(run: Trajectory) -> float:
    """Return the speed from which a run brakes to its stop [m/s]."""
    return run.phases[-1].start_ms


def braked_away_kwh(run: Trajectory) -> float:
    """Return what a run loses in its brakes [kWh]."""
    return sum(run.energy.losses_j.get(kind, 0.0) for kind in BRAKES) / J_PER_KWH


def _off_m(run: Trajectory) -> float:
    # one that does not coast drives until it brakes
    off = motors_off_m(run)
    return run.phases[-1].start_m if off is None else off


def _off_words(run: Trajectory) -> str:
    return words.number(_off_m(run), 0)


def _coasting(result: LessonResult) -> Answer:
    best, other = result.runs.values()
    because = (
        f"the best run brakes from {words.speed(brakes_from_ms(best), 1)} km/h instead of "
        f"{words.speed(brakes_from_ms(other), 1)}, so that the brakes waste {words.energy(braked_away_kwh(best))} "
        f"instead of {words.energy(braked_away_kwh(other))} kWh."
    )
    return Answer(100 * result.saved_share, because)


def _multiplier(result: LessonResult) -> Answer:
    best, later = result.runs.values()
    because = (
        f"with the second more, the motors are switched off at {_off_words(later)} instead of {_off_words(best)} m, "
        f"and the brakes waste {words.energy(braked_away_kwh(later))} instead of "
        f"{words.energy(braked_away_kwh(best))} kWh."
    )
    return Answer((best.energy.net_j - later.energy.net_j) / J_PER_WH, because)


def _recuperation(result: LessonResult) -> Answer:
    best, without = result.runs.values()
    off, off_without = (_off_m(run) for run in (best, without))
    if best.energy.recuperated_j <= 0:
        return Answer(off, "without recuperation it is the dashed run itself.")
    because = (
        f"braking returns {words.energy(best.energy.recuperated_j / J_PER_KWH)} kWh, so that it pays to keep the speed "
        f"for {words.number(off - off_without, 0)} m more than without."
    )
    return Answer(off, because)


def _gradient(result: LessonResult) -> Answer:
    best, other = result.runs.values()
    because = (
        f"the plan for level track brakes {words.energy(braked_away_kwh(other))} kWh away, "
        f"the plan with gradients {words.energy(braked_away_kwh(best))}."
    )
    return Answer(100 * result.saved_share, because)


def _load(result: LessonResult) -> Answer:
    best, driven = result.runs.values()
    because = (
        f"both runs are alike: {words.energy(driven.energy_kwh)} kWh, of which the brakes waste "
        f"{words.energy(braked_away_kwh(driven))}, against {words.energy(best.energy_kwh)} and "
        f"{words.energy(braked_away_kwh(best))}."
    )
    return Answer(100 * share_above(driven.energy_kwh, best.energy_kwh), because)


ANSWERS: Mapping[str, Callable[[LessonResult], Answer]] = {
    "coasting": _coasting,
    "multiplier": _multiplier,
    "recuperation": _recuperation,
    "gradient": _gradient,
    "load": _load,
}
"""By lesson."""
