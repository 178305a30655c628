"""The strategies beside a page: which one all numbers speak of, which are drawn, and what each of them needs."""

from collections.abc import Mapping
from typing import Any

import param
from panel.custom import JSComponent

from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.markup import joined, markup
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.theme import strategies_css
from railjoule.dashboard.page_list import PAGES
from railjoule.dashboard.parts.html import swatch
from railjoule.dashboard.state.draft import shipped
from railjoule.dashboard.work.runs import Runs
from railjoule.dashboard.workbench import Workbench

UNKNOWN = markup("<span></span><span>{}</span>", words.UNKNOWN)
UNDER_WAY = markup('<span class="reason">computing ...</span>')
LIST = """
<div class="section">Strategies</div>
<div class="strategy head" aria-hidden="true"><span class="one">this run</span><span class="draw">draw</span>
<span></span><span></span><span></span><span class="heads"><span>kWh</span><span class="above"></span></span></div>
{}
<div class="refusals" role="status"></div>
<button type="button" class="more" data-open="Set speeds">Adjust set speeds</button>
"""
ROW = """
<div class="strategy" data-name="{name}"><input type="radio" id="{name}" name="this-run" value="{name}">
<input class="draw" type="checkbox" value="{name}" aria-label="Draw {label}">
<span class="swatch">{}</span><label class="name" for="{name}">{label}</label><span>{}</span>
<span class="result"></span></div>
"""
PLAIN_SCENARIO = "ftorek-300s"
"""A shipped scenario that every strategy accepts."""


class StrategyList(JSComponent):
    """A row for each strategy: a radio button for "this run", a box for "draw", its line, its name, its numbers.

    Parameters
    ----------
    state : Workbench
    """

    html = param.String(default="", doc="The rows, without what changes.")
    chosen = param.String(default="", doc="The strategy of all numbers.")
    ticked = param.List(default=[], doc="The strategies that are drawn.")
    results = param.Dict(default={}, doc="Energy of each strategy with a run, or the reason why it has none, as HTML.")
    unknown = param.String(default="", doc="The same for one without a run.")
    above = param.String(default="", doc="Meaning of the second number of each row.")
    hidden = param.List(default=[], doc="Strategies without a row.")
    refusals = param.String(default="", doc="The strategies that refuse the scenario, and why, as HTML.")
    draws = param.Boolean(default=True, doc="Whether the page in sight draws strategies.")

    _esm = module("strategies")
    _stylesheets = [strategies_css()]  # noqa: RUF012

    def __init__(self, state: Workbench) -> None:
        super().__init__(html=strategy_rows(words.STRATEGY_WORDS), sizing_mode="stretch_width", margin=0)
        self.state = state
        state.param.watch(self._show, ["runs", "chosen", "ticked", "page", "failure"])
        self._show()

    def _show(self, *_: Any) -> None:
        runs, use = self.state.runs, PAGES[self.state.page].strategies
        numbers: dict[str, Any] = {}
        if runs is not None:
            results = {name: strategy_numbers(runs, name) for name in (*runs.runs, *runs.refused)}
            asked = {} if self.state.failure is not None else dict.fromkeys(self.state.drawn, UNDER_WAY)
            chosen = self.state.chosen
            # a proven optimum needs no second opinion by dynamic programming, and what refuses has no numbers
            refused = {name: why for name, why in runs.refused.items() if name in self.state.drawn and name != chosen}
            surplus = {"bellman"} - set(self.state.drawn) if runs.is_proven else set()
            numbers = {
                "results": {**asked, **results},
                "unknown": UNKNOWN,
                "above": f"above {comparisons.reference_name(runs.is_proven)}",
                "hidden": [*surplus, *refused],
                "refusals": refusal_lines(refused),
            }
        self.param.update(chosen=self.state.chosen, ticked=list(self.state.ticked), draws=use == "draw", **numbers)

    def _handle_msg(self, data: Any) -> None:
        kind, name = (data.get("kind"), data.get("name")) if isinstance(data, dict) else (None, None)
        if kind == "open":
            self.state.scenario.choose(PLAIN_SCENARIO)
        elif kind == "leave" and self.state.runs is not None:
            refused = self.state.runs.refused
            self.state.ticked = [name for name in self.state.ticked if name not in refused]
        if name not in STRATEGIES:
            return
        if kind == "choose":
            self.state.chosen = name
        elif kind == "draw":
            drawn = {*self.state.ticked, name} if data.get("on") else {*self.state.ticked} - {name}
            # in the order of all, so that the address is the same whatever was ticked first
            self.state.ticked = [other for other in STRATEGIES if other in drawn]


def strategy_rows(labels: Mapping[str, str]) -> str:
    """Return the rows of strategies with these labels, by name."""
    return LIST.format(
        joined(markup(ROW, swatch(name), info(label), name=name, label=label) for name, label in labels.items())
    )


def refusal_lines(refused: Mapping[str, str]) -> str:
    """Return one line per reason with the strategies that refuse a scenario for it, and a way to one that they take."""
    if not refused:
        return ""
    by_reason: dict[str, list[str]] = {}
    for name, reason in refused.items():
        by_reason.setdefault(reason.rstrip("."), []).append(words.strategy(name))
    lines = joined(markup("<p>{}: {}.</p>", ", ".join(names), reason) for reason, names in by_reason.items())
    button = '<button type="button" data-kind="{}">{}</button>'
    ways = {"open": f"Open {shipped(PLAIN_SCENARIO).title}", "leave": "Leave out"}
    return lines + joined(markup(button, *way) for way in ways.items())


def strategy_numbers(runs: Runs, name: str) -> str:
    """Return a strategy's energy and by how much it lies above the best known run, or why it refuses."""
    if name in runs.refused:
        return markup('<span class="reason">{}</span>', runs.refused[name].rstrip("."))
    run = runs.runs[name]
    amount = comparisons.above_reference(run)
    # the column's head has kWh, and there is no room for it
    above = comparisons.off_time(run) or (words.UNKNOWN if amount is None else str(amount).removesuffix(" kWh"))
    return markup("<span>{}</span><span>{}</span>", words.energy(run.energy_kwh), above)
