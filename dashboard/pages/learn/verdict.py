"""The verdict on a try: its comparison with the best run, for the browser and in words, and the parts that show it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import field as declared
from functools import partial
from typing import Any

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.theme import padded, parts_css, played_css
from railjoule.dashboard.look.typed import clock
from railjoule.dashboard.pages.learn.lessons import TEXTS
from railjoule.dashboard.parts import html as parts

PLAYED_TEXTS = TEXTS["played"]
"""The texts of the lessons that are played, by the field of the page that holds the last play."""
ROOM = padded("14px 20px 20px", "12px 14px 16px") + ":host { border-top: 1px solid var(--rj-line); }"
SMALL: dict[str, Any] = {"margin": (8, 8, 0, 0)}
"""Of the buttons of a lesson."""
BEYOND = {"losses": "Lost in motors and brakes", "resistance": "Lost to resistance", "auxiliary": "Auxiliaries"}
"""Words for the energies that a run dissipates."""
FASTER, MORE = ("faster", "slower"), ("more", "less")
"""Words of a difference of speed and of energy that is not negative, and of one that is."""
# a second behind the decimal point is rounding of the last cells
IN_TIME_S = 0.05


@dataclass(frozen=True, eq=False)
class Verdict:
    """How something that was played compares with the best.

    Parameters
    ----------
    field, text : str
        The field of the page that holds what was played, and its text.
    kwh, bound_kwh : float
        Its energy, and the proven lower bound.
    proven : bool
        Whether the best run reaches the bound.
    time_s, allowed_s, late_s : float
        Its time, the time that the bound is for, and its delay against the timetable.
    curves : mapping
        Curves for the browser.
    driven : tuple of array or None
        Places [m] and speeds [km/h] of a run.
    sentences : tuple of str
    rows : tuple
        Extra energy against the best, by where it goes [kWh].
    """

    field: str
    text: str
    kwh: float
    bound_kwh: float
    proven: bool
    time_s: float = 0.0
    allowed_s: float = 0.0
    late_s: float = 0.0
    curves: Mapping[str, Any] = declared(default_factory=dict)
    driven: tuple[FloatArray, FloatArray] | None = None
    sentences: tuple[str, ...] = ()
    rows: tuple[tuple[str, float], ...] = ()

    @property
    def counts(self) -> bool:
        """Whether it is on time."""
        return self.late_s <= IN_TIME_S

    @property
    def share(self) -> float:
        """By how much it lies above the bound, as a share of that."""
        return self.kwh / self.bound_kwh - 1


def compare(
    played: tuple[str, str], run: Trajectory, best: Trajectory, asked_s: float, sentences: tuple[str, ...], **more: Any
) -> Verdict:
    """Compare a run with the best one.

    Parameters
    ----------
    played : tuple of str
        Field and text.
    run, best : Trajectory
    asked_s : float
        The time of the timetable [s].
    sentences : tuple of str
    **more
        Further things for the browser to draw.
    """
    bound = best.bound
    assert bound is not None
    # the optimum may have a finer mesh; within a cell the square of speed is linear
    places = run.position_m
    best_j, best_s = (np.interp(places, best.position_m, one) for one in (best.supply_energy_j, best.time_s))
    curves = {
        "best_ms": np.sqrt(np.interp(places, best.position_m, best.speed_ms**2)).tolist(),
        "best_s": best_s.tolist(),
        "above_kwh": ((run.supply_energy_j - best_j) / J_PER_KWH).tolist(),
        **more,
    }
    return Verdict(
        *played,
        kwh=run.energy_kwh,
        bound_kwh=bound.energy_j / J_PER_KWH,
        proven=best.is_proven,
        time_s=run.travel_time_s,
        allowed_s=best.scenario.travel_time_s,
        late_s=run.travel_time_s - asked_s,
        curves=curves,
        driven=(places, run.speed_ms / MS_PER_KMH),
        sentences=sentences,
        rows=beyond(run, best),
    )


def beyond(run: Trajectory, best: Trajectory) -> tuple[tuple[str, float], ...]:
    """Return the extra energy of a run against the best, by where it goes [kWh]; the parts sum to the whole."""
    mine, least = (
        {
            "losses": sum(one.energy.losses_j.values()),
            "resistance": one.energy.running_resistance_j + one.energy.curve_resistance_j,
            "auxiliary": one.energy.auxiliary_j,
        }
        for one in (run, best)
    )
    rows = ((word, (mine[name] - least[name]) / J_PER_KWH) for name, word in BEYOND.items())
    # a train without auxiliaries has no row of them
    return tuple(row for row in rows if row[1] or row[0] != BEYOND["auxiliary"])


# ---- in words


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


# ---- on the page


class Judged:
    """A lesson that is played in parts of the server: its task, the verdict, and what a subclass puts around them.

    A subclass makes `played`, which appears with the data of the lesson, `after`, which a verdict opens, and `view`; it
    names its `text`, and draws in `lay` and `reveal`.

    Parameters
    ----------
    field : str
        The field of the page that holds what was judged last.
    hear : callable
        Called with the field, what is wanted, and the text of what was played.
    target_s : float
        The time in the task [s].
    """

    frame, busy = "played", ""
    sheets: tuple[Callable[[], str], ...] = (parts_css, played_css)
    text: str
    played: Any
    after: Any

    def __init__(self, field: str, hear: Callable[[str, str, str], None], target_s: float = 0.0) -> None:
        self._hear, self.given = partial(hear, field), dict[str, Any]()
        self.head, self.outcome, self.details = (self.pane() for _ in range(3))
        texts = PLAYED_TEXTS[field]
        text = texts["text"].replace("{target}", clock(target_s))
        self.head.object = self.framed(markup("<h2>{}</h2><p>{}</p>", texts["title"], text))
        self.tell("Opening")

    def pane(self) -> Any:
        """Return a pane in the style of the lessons."""
        return parts.html_pane(stylesheets=[sheet() for sheet in self.sheets])

    def framed(self, html: Markup) -> Markup:
        """Return HTML in the style of the lessons."""
        return markup('<div class="{}">{}</div>', self.frame, html)

    def tell(self, sentence: str) -> None:
        """Say what is under way in the place of the verdict."""
        self.outcome.object = self.framed(markup("<p role=status>{}</p>", sentence))

    def begin(self, given: dict[str, Any]) -> None:
        """Begin with what `begin` of the lesson's module returns."""
        self.given, self.played.visible = given, True
        self.lay(given)

    def refuse(self) -> None:
        """Accept input again after a failed verdict."""
        self.tell("")

    def ask(self, *_: Any) -> None:
        """Ask for the verdict."""
        self.tell(self.busy)
        self._hear("done", self.text)

    def open(self, *_: Any) -> None:
        """Open what was played on another page."""
        self._hear("open", self.text)

    def show(self, verdict: Verdict, tries: Sequence[Verdict]) -> None:
        """Show a verdict, unless something else has been played since it was asked for."""
        if verdict.text == self.text:
            self.outcome.object = self.framed(markup("<div role=status>{}</div>", outcome(verdict)))
            self.details.object = self.framed(details(verdict, tries))
            self.after.visible = True
            self.reveal(verdict)

    def lay(self, given: dict[str, Any]) -> None:
        """Draw what the lesson begins with."""
        raise NotImplementedError

    def reveal(self, verdict: Verdict) -> None:
        """Draw the best beside what was played."""
        raise NotImplementedError
