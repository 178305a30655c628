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
from railjoule.dashboard.look.typed import clock
from railjoule.dashboard.pages.learn import by_hand, drawing, slack
from railjoule.dashboard.pages.learn.by_hand import TRIES
from railjoule.dashboard.pages.learn.lessons import TEXTS
from railjoule.dashboard.pages.learn.verdict import Verdict
from railjoule.dashboard.parts import html as parts

PLAYED: Mapping[str, Any] = {"driven": by_hand, "drawn": drawing, "shared": slack}
"""The modules that begin and judge, by the field of the page that holds the last play; the slowest is last."""
WORDS = TEXTS["played"]
Begun = dict[str, Any]


def begin_all(texts: Mapping[str, str]) -> Iterator[Begun]:
    """Yield what the lessons begin with, one more at each step; under `refused` why a link's text cannot be taken."""
    begun: Begun = {"refused": None}
    for field, lesson in PLAYED.items():
        try:
            begun = {**begun, field: lesson.begin(texts[field])}
        except RailjouleError as error:
            begun = {**begun, "refused": error, field: lesson.begin("")}
        yield begun


def judge(field: str, text: str, _count: int) -> Verdict:
    """Return the verdict on what was played in a lesson; the count makes equal requests differ."""
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
    text = param.String(default="", doc="What is to be done.")
    given = param.Dict(default={}, doc="What it begins with.")
    verdict = param.Dict(default={}, doc="How what was played compares with the best; empty before the first time.")
    refusals = param.Integer(default=0, doc="Counts what could not be judged.")
    lead = param.String(default="", doc="The lesson that a link leads to.")

    def __init__(self, field: str, hear: Callable[[str, str, str], None]) -> None:
        given = WORDS[field]
        super().__init__(
            lambda message: hear(field, str(message.get("what", "")), str(message.get("text", ""))),
            title=given["title"],
            text=given["text"].replace("{target}", clock(drawing.TARGET_S)),
            css_classes=[f"rj-lesson-{field}"],
            stylesheets=[played_css()],
        )

    def show(self, verdict: Verdict, tries: Sequence[Verdict]) -> None:
        """Show a verdict, beside the tries so far where they are counted."""
        best = best_try(tries)
        self.verdict = {
            **verdict.curves,
            "head": str(verdict_head(verdict, tries)),
            "details": str(verdict_details(verdict, tries)),
            "tried": len(tries),
            "note": f"best of your tries {words.energy(best.kwh)}" if best else "",
            # the same may be judged twice, and only a difference is sent to the browser
            "count": self.verdict.get("count", 0) + 1,
        }


class DriveIt(Played):
    """The lesson that is driven."""

    _esm = module("drive_it")


class ShareOut(Played):
    """The lesson on the running-time supplement."""

    _esm = module("share_out")


class DrawSpeed(Played):
    """The lesson that is drawn."""

    _esm = module("draw_speed")


COMPONENTS: Mapping[str, type[Played]] = {"driven": DriveIt, "shared": ShareOut, "drawn": DrawSpeed}


def best_try(tries: Sequence[Verdict]) -> Verdict | None:
    """Return the try of least energy among those on time."""
    return min((one for one in tries if one.counts), key=lambda one: one.kwh, default=None)


# ---- the verdict in words


def verdict_head(verdict: Verdict, tries: Sequence[Verdict]) -> Markup:
    """Return the result in one line, its proof, and the buttons that lead on."""
    given, digits = WORDS[verdict.field], 3 if verdict.field == "shared" else 2
    outcome = given["outcome" if verdict.counts else "late"].format(
        kwh=words.number(verdict.kwh, digits),
        bound=words.number(verdict.bound_kwh, digits),
        late=words.time(verdict.late_s),
        allowed=clock(verdict.allowed_s),
    )
    more = f" \u00b7 {words.number(verdict.kwh - verdict.bound_kwh, digits)} kWh more than needed ("
    above = f"{more}{words.share_difference(verdict.share)} %)." if verdict.counts else ""
    colours = " Blue is the best run, the thinner line is yours." if "best_ms" in verdict.curves else ""
    return markup(
        "<h2 class=outcome tabindex=-1>{}</h2><p>{}{}{}</p><div class=row>{}</div>",
        outcome,
        parts.PROVEN if verdict.proven else "not proven",
        above,
        colours,
        joined(
            markup("<button type=button data-what={}{}>{}</button>", what, kind, label)
            for what, label, kind in _buttons(verdict, tries)
        ),
    )


def _buttons(verdict: Verdict, tries: Sequence[Verdict]) -> list[tuple[str, str, Markup]]:
    plain, left = Markup(""), TRIES - len(tries)
    open_it = ("open", WORDS[verdict.field]["open"], Markup(" class=main"))
    if verdict.field == "driven":
        again = f"Drive again ({left} left)" if left else "Begin again with three tries"
        return [("again", again, plain), ("watch", "Watch your run", plain), open_it]
    others = {"uneven": "Next: a line with legs alike", "even": "Back to the line with uneven legs"}
    other = [("other", others[verdict.text.partition(":")[0]], plain)] if verdict.field == "shared" else []
    return [("change", "Change it", plain), *other, open_it]


def verdict_details(verdict: Verdict, tries: Sequence[Verdict]) -> Markup:
    """Return the tries, sentences on the play, and a table of the extra energy."""
    columns = []
    if verdict.field == "driven":
        best = best_try(tries)
        rows = (
            markup(
                "<tr{}><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
                Markup(" class=best") if one is best else "",
                number,
                words.number(one.kwh, 2),
                # the bound holds only for runs on time
                words.share_difference(one.share) if one.counts else words.UNKNOWN,
                _arrival(one),
            )
            for number, one in enumerate(tries, 1)
        )
        head = "<tr><th>Try</th><th>kWh</th><th>above the bound, %</th><th>arrived</th></tr>"
        columns.append(markup("<h3>Your tries</h3><table>{}{}</table>", Markup(head), joined(rows)))
    if verdict.sentences:
        items = joined(markup("<li>{}</li>", sentence) for sentence in verdict.sentences)
        columns.append(markup("<h3>{}</h3><ul>{}</ul>", "What makes the difference", items))
    if verdict.rows:
        lost = (markup("<tr><td>{}</td><td>{}</td></tr>", word, words.signed(kwh, 2)) for word, kwh in verdict.rows)
        columns.append(markup("<h3>{}</h3><table>{}</table>", WORDS[verdict.field]["extra"], joined(lost)))
    return markup("<div class=results>{}</div>", joined(markup("<div>{}</div>", one) for one in columns))


def _arrival(verdict: Verdict) -> Markup:
    words_of = f"{words.time(abs(verdict.late_s))} s {'early' if verdict.counts else 'late'}"
    return markup("<span{}>{}</span>", "" if verdict.counts else Markup(" class=late"), words_of)
