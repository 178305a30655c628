"""The lessons that are played: one component each in the browser, one form of begin, judge and verdict for all."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import param

from railjoule.core import RailjouleError
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.theme import played_css
from railjoule.dashboard.pages.learn import by_hand, drawing, slack
from railjoule.dashboard.pages.learn.by_hand import TRIES
from railjoule.dashboard.pages.learn.verdict import Verdict
from railjoule.dashboard.pages.learn.verdict_words import PLAYED_TEXTS, best_try, details, outcome

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


class Played(Form):
    """A lesson that is played in the browser, and judged by the server.

    Parameters
    ----------
    field : str
        The field of the page that holds what was played last.
    hear : callable
        Called with the field, what the browser reports, and the text of what was played.
    """

    title = param.String(default="", doc="Its heading.")
    text = param.String(default="", doc="The task of the lesson.")
    given = param.Dict(default={}, doc="Initial data of the lesson.")
    verdict = param.Dict(default={}, doc="How what was played compares with the best; empty before the first time.")
    refusals = param.Integer(default=0, doc="Counts what could not be judged.")
    lead = param.String(default="", doc="The lesson that a link leads to.")

    def __init__(self, field: str, hear: Callable[[str, str, str], None]) -> None:
        texts = PLAYED_TEXTS[field]
        super().__init__(
            lambda message: hear(field, str(message.get("what", "")), str(message.get("text", ""))),
            title=texts["title"],
            text=texts["text"],
            css_classes=[f"rj-lesson-{field}"],
            stylesheets=[played_css()],
        )

    @property
    def view(self) -> "Played":
        """The part of the page."""
        return self

    def begin(self, given: Begun) -> None:
        """Begin with what the module of the lesson returns."""
        self.given = given

    def refuse(self) -> None:
        """Accept input again after a failed verdict."""
        self.refusals += 1

    def show(self, verdict: Verdict, tries: Sequence[Verdict]) -> None:
        """Show a verdict, beside the tries so far where they are counted."""
        best = best_try(tries)
        self.verdict = {
            **verdict.curves,
            "head": str(outcome(verdict) + buttons(verdict, tries)),
            "details": str(details(verdict, tries)),
            "tried": len(tries),
            "note": f"best of your tries {words.energy(best.kwh)}" if best else "",
            # the same may be judged twice, and only a difference is sent to the browser
            "count": self.verdict.get("count", 0) + 1,
        }


class DriveIt(Played):
    """The lesson that is driven."""

    _esm = module("drive_it")


def buttons(verdict: Verdict, tries: Sequence[Verdict]) -> Markup:
    """Return the buttons that lead on from a verdict."""
    plain, left = Markup(""), TRIES - len(tries)
    again = f"Drive again ({left} left)" if left else "Begin again with three tries"
    open_it = PLAYED_TEXTS[verdict.field]["open"]
    made = (("again", again, plain), ("watch", "Watch your run", plain), ("open", open_it, Markup(" class=main")))
    pieces = (markup("<button type=button data-what={}{}>{}</button>", what, kind, label) for what, label, kind in made)
    return markup("<div class=row>{}</div>", joined(pieces))
