"""The numbers above the curves of the lessons: before a guess those of the run to compare with, then all."""

from collections.abc import Callable, Mapping

from railjoule.core import Trajectory
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.pages.learn.answers import motors_off_m
from railjoule.dashboard.pages.learn.compute import LessonResult
from railjoule.dashboard.parts import html as parts


def compared_cells(result: LessonResult, name: str) -> list[str]:
    """Return the numbers of the run that the optimum is compared with, which may be known before a guess."""
    run = result.runs[name]
    label = name[0].upper() + name[1:]
    cells = [_energy(run, label, "main"), parts.figure("Highest speed", words.number(run.max_speed_kmh), "km/h", "")]
    off = motors_off_m(run)
    if off is None or result.request.lesson != "recuperation":
        return cells
    return [*cells, parts.figure("Motors off at", words.number(off, 0), "m", "")]


def _energies(result: LessonResult, first: str, second: str) -> list[str]:
    one, other, *_ = result.runs.values()
    return [_energy(one, first), _energy(other, second)]


def _energy(run: Trajectory, label: str, kind: str = "") -> str:
    detail = f"in {words.time(run.travel_time_s)} s"
    return parts.figure(label, words.energy(run.energy_kwh), "kWh", detail, kind, term="Energy from the supply")


def _saved(result: LessonResult, what: str) -> str:
    """Return what the first run saves of the second one's energy, or costs more."""
    one, other, *_ = result.runs.values()
    verb, amount = comparisons.saving(one.energy_kwh, other.energy_kwh)
    return parts.figure(f"{what} {verb}", *amount, "", "main", term="Saving")


def coasting_cells(result: LessonResult) -> list[str]:
    """Return the numbers of the first lesson."""
    run = result.runs["optimum"]
    coasts = sum(phase.end_m - phase.start_m for phase in run.phases if phase.phase == "coast")
    share = words.share(coasts / run.distance_m)
    return [
        _saved(result, "Coasting"),
        *_energies(result, "Optimum", "Constant speed"),
        parts.figure("Coasts", share, "%", "of the distance"),
    ]


def multiplier_cells(result: LessonResult) -> list[str]:
    """Return the numbers of the second lesson: the multiplier, and what a second more saves indeed."""
    run, later = result.runs["optimum"], result.runs["a second later"]
    price = run.price_of_time_w or 0.0
    saved = (run.energy_kwh - later.energy_kwh) * J_PER_KWH
    return [
        parts.figure("Extra second saves", words.price(price), "Wh/s", "the multiplier", "main"),
        parts.figure("Solved again", words.price(saved), "Wh", "saved by a second"),
        *_energies(result, "Optimum", "A second later"),
    ]


def recuperation_cells(result: LessonResult) -> list[str]:
    """Return the numbers of the third lesson."""
    run, steady = result.runs["optimum"], result.steady
    assert steady is not None
    cells = [_saved(result, "Recuperation"), *_energies(result, "Optimum", "Without")]
    off = motors_off_m(run)
    where = "\u2013" if off is None else words.number(off, 0)
    cells.append(parts.figure("Motors off at", where, "m", f"brakes at {words.speed(steady.brake_ms)} km/h"))
    return cells


def gradient_cells(result: LessonResult) -> list[str]:
    """Return the numbers of the fourth lesson."""
    return [_saved(result, "Right plan"), *_energies(result, "Planned with gradients", "Planned for level track")]


def load_cells(result: LessonResult) -> list[str]:
    """Return the numbers of the fifth lesson."""
    driven = result.runs["planned for 30 %"]
    late = driven.travel_time_s - driven.scenario.travel_time_s
    return [
        _saved(result, "Right plan"),
        *_energies(result, "Planned for actual load", "Planned for 30 %"),
        parts.figure("Arrives", words.delay(late), "s", "late" if late >= 0.05 else "on time"),
    ]


CELLS: Mapping[str, Callable[[LessonResult], list[str]]] = {
    "coasting": coasting_cells,
    "multiplier": multiplier_cells,
    "recuperation": recuperation_cells,
    "gradient": gradient_cells,
    "load": load_cells,
}
"""The numbers of each lesson."""
