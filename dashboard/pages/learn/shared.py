"""The lesson on the running-time supplement: three legs, the energy of each over its seconds, and the best of them."""

import re
from collections.abc import Sequence
from functools import cache
from itertools import accumulate
from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.core import Scenario, ScenarioError, load_scenario
from railjoule.core.energy import share_above
from railjoule.core.strategies.line_parts import shortest_times_s, stop_nodes
from railjoule.core.studies.table import StudyTable
from railjoule.core.studies.whole_line import Leg, WholeLine, leg_tables, shared_line
from railjoule.core.task import Task, prepare_task
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.theme import played_css
from railjoule.dashboard.pages.learn.verdict import PLAYED_TEXTS, ROOM, SMALL, Judged, Verdict
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import button

# ---- the judge

BASE = "metro-10-stations"
"""Train, load and recuperation are those of this scenario."""
NAMES = ("Harbour", "Old Town", "University", "Hill")
# assumed: the first line has one long leg between short ones, the second has legs nearly alike
LENGTHS_M = {"uneven": (400.0, 2000.0, 600.0), "even": (1100.0, 1350.0, 1050.0)}
SLACK_S, DWELL_S = 60, 25.0
"""Supplement to distribute over the shortest times, and dwell time at each intermediate station [s]."""
LEAST_S = 1
"""No leg gets less, as the shortest time itself leaves nothing to choose."""
MOST_S = SLACK_S - LEAST_S * (len(NAMES) - 2)
SHARED = re.compile(r"(uneven|even):(\d{1,2}),(\d{1,2}),(\d{1,2})")
# seconds are dragged whole, so that less than one is no difference
ALIKE_S = 1.0
AS_BEST = "{leg}: as in the best distribution, within a second."
BEST = (
    "Best, as the dashed borders: {seconds} s. There, one more second saves {price} Wh on every leg: moving a second "
    "gains nothing."
)
TOO_MANY = "{leg}: {seconds} s too many. Here one more second saves only {price} Wh."
TOO_FEW = "{leg}: {seconds} s too few. Here one more second would save {price} Wh."


def begin(text: str) -> dict[str, Any]:
    """Return the initial data of the browser: both lines, and equal seconds on the first or the distribution of a link.

    Raises
    ------
    ScenarioError
        If the text is no distribution on these lines.
    """
    line, seconds = read_sharing(text or "uneven:20,20,20")
    return {"lines": {name: line_tables(name) for name in LENGTHS_M}, "line": line, "seconds": list(seconds)}


def read_sharing(text: str) -> tuple[str, tuple[int, ...]]:
    """Return the name of a line and the seconds of its legs from a text.

    Raises
    ------
    ScenarioError
        If it names no line, or its seconds are not those that there are to share out.
    """
    found = SHARED.fullmatch(text)
    seconds = tuple(int(one) for one in found.groups()[1:]) if found else ()
    if not found or min(seconds) < LEAST_S or sum(seconds) != SLACK_S:
        raise ScenarioError(
            f"shared must be uneven: or even: with three whole numbers of at least {LEAST_S} that sum to {SLACK_S}."
        )
    return found[1], seconds


@cache
def leg_task(name: str) -> Task:
    """Return the task of a line, whose travel time leaves SLACK_S over the shortest times."""
    wide = _scenario(name, 3600.0)
    shortest = float(shortest_times_s(prepare_task(wide), stop_nodes(prepare_task(wide))).sum())
    return prepare_task(_scenario(name, shortest + SLACK_S + DWELL_S * (len(NAMES) - 2)))


def shared_scenario(name: str, seconds: tuple[int, ...]) -> Scenario:
    """Return a line whose given timetable is a distribution."""
    task = leg_task(name)
    shortest = shortest_times_s(task, stop_nodes(task))
    running = [float(least) + more for least, more in zip(shortest, seconds, strict=True)]
    arrivals = [time + k * DWELL_S for k, time in enumerate(accumulate(running))][:-1]
    return task.scenario.replace(**{"line.stations": _stations(name, arrivals)})


def opened(text: str) -> Scenario:
    """Return a line whose timetable is a distribution; errors as `judge`."""
    return shared_scenario(*read_sharing(text))


@cache
def line_tables(name: str) -> dict[str, Any]:
    """Return a line as the browser takes it: each leg's energy and price at each whole second of slack."""
    task = leg_task(name)
    dwells = DWELL_S * (len(NAMES) - 2)
    tables = leg_tables(task, range(LEAST_S, MOST_S + 1))
    # what the train takes while it stands is the same however the seconds are shared
    standing_j = task.mesh.data.auxiliary_power_w * dwells
    return {
        "legs": [_leg(name, k, table) for k, table in enumerate(tables)],
        "standing_kwh": standing_j / J_PER_KWH,
        "min_s": LEAST_S,
        "slack_s": SLACK_S,
    }


@cache
def best_line(name: str) -> WholeLine:
    """Return the optimum of a line."""
    return shared_line(leg_task(name), "optimum")


def driven_line(name: str, seconds: tuple[int, ...]) -> WholeLine:
    """Return the run of least energy under a sharing."""
    return shared_line(prepare_task(shared_scenario(name, seconds)), "given")


def judge(text: str) -> Verdict:
    """Compare a distribution with the best one.

    Raises
    ------
    ScenarioError
        If the text is no distribution on these lines.
    """
    name, seconds = read_sharing(text)
    mine, best, legs = driven_line(name, seconds), best_line(name), len(LENGTHS_M[name])
    bound = best.run.bound
    assert bound is not None
    equal = driven_line(name, (SLACK_S // legs,) * legs)
    best_s = [leg.supplement_s for leg in best.legs]
    sentences = [_on_leg(*pair) for pair in zip(mine.legs, best.legs, strict=True)]
    sentences += [
        BEST.format(seconds=", ".join(map(words.time, best_s)), price=words.price(best.legs[0].price_of_time_w)),
        _worth(share_above(equal.run.energy_kwh, best.run.energy_kwh)),
    ]
    return Verdict(
        "shared",
        text,
        kwh=mine.run.energy_kwh,
        bound_kwh=bound.energy_j / J_PER_KWH,
        proven=best.run.is_proven,
        curves={"best_s": best_s},
        sentences=tuple(sentences),
    )


def _on_leg(mine: Leg, best: Leg) -> str:
    """Return a sentence that compares the supplement of a leg with the best one."""
    more = mine.supplement_s - best.supplement_s
    sentence = AS_BEST if abs(more) < ALIKE_S else TOO_MANY if more > 0 else TOO_FEW
    return sentence.format(
        leg=f"{mine.departs_from} \u2013 {mine.arrives_at}",
        seconds=words.time(abs(more)),
        price=words.price(mine.price_of_time_w),
    )


def _worth(share: float) -> str:
    """Return sentences on the cost of an equal supplement on a line, and on the use of a better distribution."""
    costs = f"An equal supplement costs {100 * share:.2f} % more than the best distribution"
    # as on the page Line: a load or a day's weather moves the energy by more
    if share >= 0.01:
        return f"{costs}: on this line, distributing it pays."
    return f"{costs}: on this line it does not pay. A few more passengers change more."


def _leg(name: str, number: int, table: StudyTable) -> dict[str, Any]:
    return {
        "from": NAMES[number],
        "to": NAMES[number + 1],
        "length_m": LENGTHS_M[name][number],
        "shortest_s": table.shortest_time_s,
        "energy_kwh": table["energy_kwh"].tolist(),
        "price_wh_s": table["price_of_time_wh_per_s"].tolist(),
    }


def _scenario(name: str, travel_time_s: float) -> Scenario:
    sections = [section for length in LENGTHS_M[name] for section in _hump(length)]
    line = {"name": f"Three {name} legs (assumed)", "sections": sections, "stations": _stations(name)}
    title = f"Distribute the supplement: {name} legs"
    return load_scenario(BASE).replace(title=title, line=line, **{"timetable.travel_time_s": travel_time_s})


def _hump(length_m: float) -> list[dict[str, float]]:
    """Return a leg between stations on humps, as metros have them."""
    level, slope = {"length_m": 60.0}, 100.0
    down, up = ({"length_m": slope, "gradient_permille": gradient} for gradient in (-20.0, 20.0))
    between = {"length_m": length_m - 2 * (level["length_m"] + slope)}
    return [level, down, between, up, level]


def _stations(name: str, arrivals_s: list[float] | None = None) -> list[dict[str, Any]]:
    places = [0.0, *accumulate(LENGTHS_M[name])]
    rows: list[dict[str, Any]] = [
        {"name": name, "position_m": place} for name, place in zip(NAMES, places, strict=True)
    ]
    for row in rows[1:-1]:
        row["dwell_s"] = DWELL_S
    for row, arrival in zip(rows[1:-1], arrivals_s or (), strict=False):
        row["arrival_s"] = arrival
    return rows


# ---- the parts

OTHER = {"uneven": ("even", "Next: a line with legs alike"), "even": ("uneven", "Back to the line with uneven legs")}
Seconds = tuple[int, ...]
SHARE = '<div class=share style="width:{}%" title="{}"><b>{} s</b><span>{}</span></div>'
LEG = (
    "<span>{}<small>{} km, {} kWh</small></span>"
    "<div><i style='width:{}%;background:var(--rj-accent)'></i></div><span>{}</span>"
)
STAGE = (
    "<div class=stage><div><h3>One more second would save, Wh</h3><div class=bars>{}</div></div>"
    "<div class=clocks><div>Whole line<b>{} kWh</b><small>{} kWh against an equal supplement</small></div></div></div>"
)


class ShareOut(Judged):
    """The lesson."""

    frame, busy = "played share-out", "The best distribution is being computed."
    sheets = (played_css,)

    def __init__(self, field: str, hear: Any) -> None:
        super().__init__(field, hear)
        self.name, self.seconds = "", Seconds()
        self.split, self.stage = self.pane(), self.pane()
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
        ask = button("Show the best distribution", self.ask, **{**SMALL, "variant": "contained"})
        self.other = button("", self._turn, **SMALL)
        open_it = button(PLAYED_TEXTS[field]["open"], self.open, **{**SMALL, "variant": "contained"})
        self.after = parts.stack(self.details, pn.Row(self.other, open_it, margin=0), visible=False)
        self.played = parts.stack(self.split, self.borders, self.stage, ask, self.after, visible=False)
        self.view = parts.stack(
            self.head,
            self.outcome,
            self.played,
            css=ROOM,
            css_classes=[f"rj-lesson-{field}"],
            name=PLAYED_TEXTS[field]["title"],
        )

    @property
    def text(self) -> str:  # type: ignore[override]
        """The distribution as a text that fits into a link."""
        return f"{self.name}:{','.join(map(str, self.seconds))}"

    def lay(self, given: dict[str, Any]) -> None:
        """Show the line and the seconds that it begins with."""
        self._lay(given["line"], tuple(given["seconds"]))

    def reveal(self, verdict: Verdict) -> None:
        """Draw the best borders."""
        self.other.label = OTHER[self.name][1]
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
        self.tell("")
        self._draw()

    def _draw(self, best_s: Sequence[float] = ()) -> None:
        self.split.object, self.stage.object = self._split(best_s), self._stage()

    def _turn(self, _: Any) -> None:
        self._lay(OTHER[self.name][0], equal(len(self.seconds)))

    def _split(self, best_s: Sequence[float]) -> Markup:
        legs = zip(self.given["lines"][self.name]["legs"], self.seconds, strict=True)
        shares = (markup(SHARE, f"{100 * one / SLACK_S:.1f}", title(leg), one, title(leg)) for leg, one in legs)
        lines = (
            markup('<i class=best style="left:{}%"></i>', f"{100 * s / SLACK_S:.1f}") for s in accumulate(best_s[:-1])
        )
        return self.framed(markup("<div class=split>{}</div>", joined((*shares, *lines))))

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
        return self.framed(
            markup(STAGE, joined(legs), words.number(kwh, 3), words.signed(kwh - total_kwh(line, fair), 3))
        )


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
