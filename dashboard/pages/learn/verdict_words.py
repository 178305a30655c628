"""The verdict on a try in words: the result in one line, and the causes of the difference."""

from collections.abc import Sequence

from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.typed import clock
from railjoule.dashboard.pages.learn.lessons import TEXTS
from railjoule.dashboard.pages.learn.verdict import Verdict
from railjoule.dashboard.parts import html as parts

PLAYED_TEXTS = TEXTS["played"]
"""The texts of the lessons that are played, by the field of the page that holds the last play."""


def best_try(tries: Sequence[Verdict]) -> Verdict | None:
    """Return the try of least energy among those on time."""
    return min((one for one in tries if one.counts), key=lambda one: one.kwh, default=None)


def outcome(verdict: Verdict) -> Markup:
    """Return the result in one line, and its proof."""
    given, digits = PLAYED_TEXTS[verdict.field], 3 if verdict.field == "shared" else 2
    sentence = given["outcome" if verdict.counts else "late"].format(
        kwh=words.number(verdict.kwh, digits),
        bound=words.number(verdict.bound_kwh, digits),
        late=words.time(verdict.late_s),
        allowed=clock(verdict.allowed_s),
    )
    more = f" \u00b7 {words.number(verdict.kwh - verdict.bound_kwh, digits)} kWh more than needed ("
    above = f"{more}{words.share_difference(verdict.share)} %)." if verdict.counts else ""
    colours = " Blue is the best run, the thinner line is yours." if "best_ms" in verdict.curves else ""
    return markup(
        "<h2 class=outcome tabindex=-1>{}</h2><p>{}{}{}</p>",
        sentence,
        parts.PROVEN if verdict.proven else "not proven",
        above,
        colours,
    )


def details(verdict: Verdict, tries: Sequence[Verdict]) -> Markup:
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
        columns.append(markup("<h3>{}</h3><ul>{}</ul>", "Causes of the difference", items))
    if verdict.rows:
        lost = (markup("<tr><td>{}</td><td>{}</td></tr>", word, words.signed(kwh, 2)) for word, kwh in verdict.rows)
        columns.append(markup("<h3>{}</h3><table>{}</table>", PLAYED_TEXTS[verdict.field]["extra"], joined(lost)))
    return markup("<div class=results>{}</div>", joined(markup("<div>{}</div>", one) for one in columns))


def _arrival(verdict: Verdict) -> Markup:
    words_of = f"{words.time(abs(verdict.late_s))} s {'early' if verdict.counts else 'late'}"
    return markup("<span{}>{}</span>", "" if verdict.counts else Markup(" class=late"), words_of)
