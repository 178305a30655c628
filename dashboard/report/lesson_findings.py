"""What the lessons of a report need: the data of those that are played, and what the others ask and tell of."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from railjoule.dashboard.pages.learn import alone
from railjoule.dashboard.pages.learn.compute import FIRST_VALUES, LessonRequest, LessonResult, compute_lesson

PLAYED = {"drive_it": alone.drive_it, "share_out": alone.share_out, "draw_speed": alone.draw_speed}
"""By the names of the components that draw them, in the order of the page Learn."""


@dataclass(frozen=True, eq=False)
class LessonFindings:
    """What all lessons need.

    Parameters
    ----------
    played : mapping
        The data of each lesson that is played.
    guessed : mapping
        What each lesson shows that asks for a guess, its slider where it stands at first.
    """

    played: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    guessed: Mapping[str, LessonResult] = field(default_factory=dict)


def compute_lessons() -> Iterator[tuple[LessonFindings, float]]:
    """Yield the lessons so far, and their share of all."""
    found, count = LessonFindings(), len(PLAYED) + len(FIRST_VALUES)
    for done, (name, make) in enumerate(PLAYED.items(), 1):
        found = replace(found, played={**found.played, name: make()})
        yield found, done / count
    for done, (name, value) in enumerate(FIRST_VALUES.items(), len(PLAYED) + 1):
        result = compute_lesson(LessonRequest(name, value))
        found = replace(found, guessed={**found.guessed, name: result})
        yield found, done / count
