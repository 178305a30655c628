"""The lesson on the running-time supplement: borders between legs, and what each makes of its seconds."""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import accumulate
from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.theme import padded, played_css
from railjoule.dashboard.pages.learn.slack import LEAST_S, SLACK_S
from railjoule.dashboard.pages.learn.verdict import Verdict
from railjoule.dashboard.pages.learn.verdict_words import PLAYED_TEXTS, details, outcome
from railjoule.dashboard.parts import html as parts

ASK, BUSY = "Show the best distribution", "The best distribution is being computed."
OTHER = {"uneven": ("even", "Next: a line with legs alike"), "even": ("uneven", "Back to the line with uneven legs")}
ROOM = padded("14px 20px 20px", "12px 14px 16px") + ":host { border-top: 1px solid var(--rj-line); }"
SHARE = '<div class=share style="width:{}%" title="{}"><b>{} s</b><span>{}</span></div>'
LEG = (
    "<span>{}<small>{} km, {} kWh</small></span>"
    "<div><i style='width:{}%;background:var(--rj-accent)'></i></div><span>{}</span>"
)
BEST = '<i class=best style="left:{}%"></i>'
STAGE = (
    "<div class=stage><div><h3>One more second would save, Wh</h3><div class=bars>{}</div></div>"
    "<div class=clocks><div>Whole line<b>{} kWh</b><small>{} kWh against an equal supplement</small></div></div></div>"
)
Seconds = tuple[int, ...]


class ShareOut:
    """The lesson, with the parts of a lesson that is played.

    Parameters
    ----------
    field : str
        The field of the page that holds what was judged last.
    hear : callable
        Called with the field, what is wanted, and the text of the distribution.
    """

    def __init__(self, field: str, hear: Callable[[str, str, str], None]) -> None:
        self._hear = partial(hear, field)
        self.given: dict[str, Any] = {}
        self.name, self.seconds = "", Seconds()
        self.head, self.outcome, self.split, self.stage, self.details = (
            parts.html_pane(stylesheets=[played_css()]) for _ in range(5)
        )
        texts = PLAYED_TEXTS[field]
        self.head.object = framed(markup("<h2>{}</h2><p>{}</p>", texts["title"], texts["text"]))
        self._tell("Opening")
        # as long as the bar above it: the library would move the ends of its rail inwards
        self.borders = pmui.RangeSlider(
            label="",
            show_value=False,
            start=0,
            end=SLACK_S,
            value=(0, SLACK_S),
            step=1,
            size="small",
            margin=(0, 0, 4, 0),
            sx={"width": "100%", "mx": 0},
            sizing_mode="stretch_width",
        )
        self.borders.param.watch(self._move, "value")
        small: dict[str, Any] = {"size": "small", "margin": (8, 8, 0, 0)}
        self.ask = pmui.Button(label=ASK, variant="contained", on_click=self._ask, **small)
        self.other = pmui.Button(label="", variant="outlined", on_click=self._turn, **small)
        self.open = pmui.Button(label=texts["open"], on_click=lambda _: self._hear("open", self.text), **small)
        self.after = parts.stack(self.details, pn.Row(self.other, self.open, margin=0), visible=False)
        self.played = parts.stack(self.split, self.borders, self.stage, self.ask, self.after, visible=False)
        self.view = parts.stack(
            self.head, self.outcome, self.played, css=ROOM, css_classes=[f"rj-lesson-{field}"], name=texts["title"]
        )

    @property
    def text(self) -> str:
        """The distribution as a text that fits into a link."""
        return f"{self.name}:{','.join(map(str, self.seconds))}"

    def begin(self, given: dict[str, Any]) -> None:
        """Begin with what `slack.begin` returns."""
        self.given = given
        self.played.visible = True
        self._lay(given["line"], tuple(given["seconds"]))

    def refuse(self) -> None:
        """Accept input again after a failed verdict."""
        self._tell("")

    def show(self, verdict: Verdict, tries: Sequence[Verdict]) -> None:
        """Show a verdict, unless the borders have moved since it was asked for."""
        if verdict.text == self.text:
            self.outcome.object = framed(markup("<div role=status>{}</div>", outcome(verdict)))
            self.details.object = framed(details(verdict, tries))
            self.other.label, self.after.visible = OTHER[self.name][1], True
            self._draw(verdict.curves["best_s"])

    def _lay(self, name: str, seconds: Seconds) -> None:
        self.name, self.seconds = name, seconds
        stations = [leg["to"] for leg in self.given["lines"][name]["legs"][:-1]]
        label = f"Supplement used up to {' and up to '.join(stations)}, s"
        self.borders.param.update(label=label, value=tuple(accumulate(seconds))[:-1])
        self._change()

    def _move(self, event: Any) -> None:
        """Take borders, each as far as it leaves its legs the least; what is taken is shown."""
        first, second = (round(place) for place in event.new)
        first = min(max(first, LEAST_S), SLACK_S - 2 * LEAST_S)
        second = min(max(second, first + LEAST_S), SLACK_S - LEAST_S)
        seconds = (first, second - first, SLACK_S - second)
        if self.name and seconds != self.seconds:
            self.seconds = seconds
            self._change()
        if (first, second) != tuple(event.new):
            self.borders.value = (first, second)

    def _change(self) -> None:
        self.after.visible = False
        self._tell("")
        self._draw()

    def _draw(self, best_s: Sequence[float] = ()) -> None:
        self.split.object, self.stage.object = self._split(best_s), self._stage()

    def _tell(self, sentence: str) -> None:
        self.outcome.object = framed(markup("<p role=status>{}</p>", sentence))

    def _ask(self, _: Any) -> None:
        self._tell(BUSY)
        self._hear("done", self.text)

    def _turn(self, _: Any) -> None:
        self._lay(OTHER[self.name][0], equal(len(self.seconds)))

    def _split(self, best_s: Sequence[float]) -> Markup:
        legs = zip(self.given["lines"][self.name]["legs"], self.seconds, strict=True)
        shares = (markup(SHARE, f"{100 * one / SLACK_S:.1f}", title(leg), one, title(leg)) for leg, one in legs)
        lines = (
            markup('<i class=best style="left:{}%"></i>', f"{100 * s / SLACK_S:.1f}") for s in accumulate(best_s[:-1])
        )
        return framed(markup("<div class=split>{}</div>", joined((*shares, *lines))))

    def _stage(self) -> Markup:
        """Return the saving of one more second on each leg, and the energy of the line."""
        line, fair = self.given["lines"][self.name], equal(len(self.seconds))
        prices, usual = (find_prices(line, seconds) for seconds in (self.seconds, fair))
        # one scale as long as no price passes it, so that a bar's length can be compared with that before
        widest = max(*prices, *(1.5 * price for price in usual))
        legs = (
            markup(
                LEG,
                f"{title(leg)} ",
                words.number(leg["length_m"] / 1000, 2),
                words.number(leg["energy_kwh"][seconds - LEAST_S], 2),
                f"{100 * price / widest:.1f}",
                words.number(price, 1 if price < 100 else 0),
            )
            for leg, seconds, price in zip(line["legs"], self.seconds, prices, strict=True)
        )
        kwh = total_kwh(line, self.seconds)
        return framed(markup(STAGE, joined(legs), words.number(kwh, 3), words.signed(kwh - total_kwh(line, fair), 3)))


def framed(html: Markup) -> Markup:
    """Return HTML in the style of the lessons."""
    return markup('<div class="played share-out">{}</div>', html)


def title(leg: dict[str, Any]) -> str:
    """Return the name of a leg."""
    return f"{leg['from']} \u2013 {leg['to']}"


def equal(legs: int) -> Seconds:
    """Return equal seconds for all legs."""
    return (SLACK_S // legs,) * legs


def find_prices(line: dict[str, Any], seconds: Seconds) -> list[float]:
    """Return the saving of one more second on each leg [Wh]; tables begin with the least seconds, and go on by one."""
    return [leg["price_wh_s"][one - LEAST_S] for leg, one in zip(line["legs"], seconds, strict=True)]


def total_kwh(line: dict[str, Any], seconds: Seconds) -> float:
    """Return the energy of a line under a distribution."""
    legs = zip(line["legs"], seconds, strict=True)
    return float(line["standing_kwh"] + sum(leg["energy_kwh"][one - LEAST_S] for leg, one in legs))
