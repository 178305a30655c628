"""The lessons that are played: how each begins, and how what was played is judged."""

from collections.abc import Iterator, Mapping
from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.pages.learn import by_hand, drawing, slack
from railjoule.dashboard.pages.learn.verdict import Verdict

PLAYED: Mapping[str, Any] = {"driven": by_hand, "drawn": drawing, "shared": slack}
"""The modules that begin and judge, by the field of the page that holds the last play; the slowest is last."""
Begun = dict[str, Any]


def begin_all(texts: Mapping[str, str]) -> Iterator[Begun]:
    """Yield the initial data of the lessons, one more at each step; `refused` has errors in a link's text."""
    begun: Begun = {"refused": None}
    for field, lesson in PLAYED.items():
        try:
            begun = {**begun, field: lesson.begin(texts[field])}
        except RailjouleError as error:
            begun = {**begun, "refused": error, field: lesson.begin("")}
        yield begun


def judge(field: str, text: str, _count: int) -> Verdict:
    """Return the verdict on a try in a lesson; the count makes equal requests differ."""
    verdict: Verdict = PLAYED[field].judge(text)
    return verdict
