"""Simpler advice beneath the driver's advice on Drive: what few orders cost, and the orders of one such run."""

from functools import partial
from typing import TYPE_CHECKING

import panel as pn
import panel_material_ui as pmui

from railjoule.core import RailjouleError
from railjoule.dashboard.charts.sketches import COMPUTING
from railjoule.dashboard.editor.forms import Disclosure
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.markup import Markup, markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.drive.simple_chart import OrdersChart
from railjoule.dashboard.pages.drive.simple_model import SimpleOrders
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import buttons
from railjoule.dashboard.parts.failures import failure_words
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.simple_advice import more_changes, not_in_time

if TYPE_CHECKING:
    from railjoule.core.studies.simple_advice import SimpleRun

FORCED = "To brake for a limit or a stop, and to keep to a limit, is an order, but not counted as a change of regime."
"""The search drives each regime below the greatest possible speed, whose brakes it does not choose."""
NAME, ASK, ASK_AGAIN = words.strategy(words.ADVISED), "Compute", "Compute again"
PIN, PINNED = "Pin these orders", "Pinned"
ROW_PX = 30
"""Height of the widgets of a row."""
HEAD_CSS = ":host { padding: 0 20px; box-sizing: border-box; } @media (max-width: 899px) { :host { padding: 0 14px; } }"
ROW_CSS = """
:host { display: flex; flex-wrap: wrap; align-items: center; gap: 4px 16px; padding: 4px 20px; box-sizing: border-box; }
@media (max-width: 899px) { :host { padding: 4px 14px; } }
"""
PAIR_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); column-gap: 32px; padding: 0 20px 0 14px;
  box-sizing: border-box; align-items: start; }
@media (max-width: 899px) { :host { grid-template-columns: minmax(0, 1fr); padding: 0 14px; } }
"""
STALE_CSS = ":host(.rj-stale) { --rj-chart-filter: grayscale(1); color: var(--rj-ink3); }"


class SimpleSection:
    """A heading that opens it; what stands beneath is computed when it is opened, and when asked for again."""

    def __init__(self, state: Workbench, height: int, palette: Palette) -> None:
        self.state, self.model = state, state.simple
        self.head = Disclosure(self._turn, label=NAME, level=2)
        self.told = parts.html_pane(sizing_mode=None)
        self.again = pmui.Button(
            label=ASK, variant="outlined", size="small", margin=0, height=ROW_PX, visible=False, on_click=self._press
        )
        # before the choice follows the model: it takes no value that is none of its options
        self.model.param.watch(self._offer, "found")
        self.choice = buttons(self.model, "changes", self._options(), margin=0, height=ROW_PX)
        label = markup("<span>Changes of regime between two stops, at most {}</span>", info(NAME))
        self.pin = pmui.Button(
            label=PIN, variant="text", size="small", margin=0, height=ROW_PX, on_click=lambda _: self.state.pin_simple()
        )
        self.chart = OrdersChart(height, self.model, palette)
        self.table, self.orders = parts.html_pane(), parts.html_pane()
        chooser = _row(parts.html_pane(label, sizing_mode=None), self.choice, self.pin)
        pair = parts.stack(self.chart.host, self.table, css=PAIR_CSS)
        self.results = parts.stack(chooser, pair, self.orders, css=STALE_CSS, visible=False)
        self.body = parts.stack(_row(self.told, self.again), self.results, visible=False)
        # around all of it, as its own display would show what is hidden
        self.view = parts.stack(parts.stack(self.head, css=HEAD_CSS), self.body, visible=False)

    def _turn(self) -> None:
        with pn.io.hold():
            self.model.open = not self.model.open
            if self.model.open and self.model.found is None and not self.model.computing:
                self._press()

    def _press(self, *_: object) -> None:
        self.model.param.trigger("ask")

    def _options(self) -> dict[str, int]:
        found = self.model.found
        return {} if found is None else {str(changes): changes for changes in found.runs}

    def _offer(self, *_: object) -> None:
        """Offer the numbers of changes that were found, and choose the model's."""
        self.choice.param.update(options=self._options(), value=self.model.changes)

    def show_beside_runs(self) -> None:
        """Show what changes with the runs and pins of the page; before the first run there is nothing to ask for."""
        self.view.visible = self.state.runs is not None
        chosen = self.model.chosen
        pinned = chosen is not None and self.state.pin_of(chosen.run) is not None
        self.pin.param.update(disabled=pinned or self.model.stale, label=PINNED if pinned else PIN)

    def show(self) -> None:
        """Show what there is of it."""
        model = self.model
        self.head.open = self.body.visible = model.open
        self.told.object = self._status()
        self.again.visible = not model.computing and (model.found is None or model.stale)
        self.again.label = ASK_AGAIN if model.found is not None else ASK
        self.results.visible = model.found is not None
        self.results.css_classes = ["rj-stale"] if model.stale else []
        if model.found is not None and model.open:
            self._show_found(model.found)

    def _status(self) -> Markup:
        """Return what is going on, and what more or fewer orders than those in the table would do."""
        model, told = self.model, ""
        if model.computing:
            told = COMPUTING
        elif model.failure is not None:
            told = _refusal(model.failure)
        elif model.stale:
            told = "The scenario has changed: these are the figures from before."
        elif model.found is not None:
            told = " ".join(filter(None, [not_in_time(model.found.advice), more_changes(model.found.advice)]))
        else:
            told = "Not computed for this scenario."
        return markup("<p class='note' style='margin: 0' role=status aria-live=polite>{}</p>", told)

    def _show_found(self, found: SimpleOrders) -> None:
        runs, model = found.runs, self.model
        known = found.advice.optimum is not None
        self.chart.host.visible = known
        if known:
            prices = {changes: found.advice.price_kwh(run) for changes, run in runs.items()}
            self.chart.show(partial(self.chart.draw, found.advice, prices, model.changes))
        self.table.object = orders_table(found, model.changes, model.stale)
        chosen = model.chosen
        self.orders.object = "" if chosen is None else orders_card(chosen, model.stale)


def orders_table(found: SimpleOrders, chosen: int | None, stale: bool = False) -> Markup:
    """Return what each number of changes needs, and how much more than the optimum that is."""
    optimum = found.advice.optimum
    rows = [
        (
            (str(changes), str(len(simple.run.advice)), words.energy(simple.run.energy_kwh), *_more(found, simple)),
            changes == chosen,
        )
        for changes, simple in found.runs.items()
    ]
    made = parts.table("What few orders cost", ("Changes", "orders", "kWh", "more, kWh", "more, %"), rows)
    told = "No optimum is known to compare with."
    if optimum is not None:
        told = f"More than the {comparisons.reference_noun(optimum.is_proven)}, {words.energy(optimum.energy_kwh)} kWh."
    missed = () if chosen is None else found.runs[chosen].run.notes
    kind = markup(" class=stale") if stale else ""
    return markup("<div{}>{}{}</div>", kind, made, parts.note_paragraphs([told, *missed, FORCED]))


def _more(found: SimpleOrders, simple: "SimpleRun") -> tuple[str, str]:
    optimum = found.advice.optimum
    if optimum is None:
        return words.UNKNOWN, words.UNKNOWN
    more = comparisons.above(simple.run.energy_kwh, optimum.energy_kwh)
    return words.energy_difference(found.advice.price_kwh(simple)), comparisons.cell(more)


def orders_card(simple: "SimpleRun", stale: bool) -> Markup:
    """Return the orders of a run, with what is printed beside them."""
    run = simple.run
    more = f", at most {simple.changes} changes of regime"
    return parts.advice(run, stale, NAME.lower(), more, parts.driver_sheet(run))


def _refusal(failure: RailjouleError) -> str:
    what, why = failure_words(failure)
    return f"{what} {why[:1].upper()}{why[1:]}"


def _row(*pieces: object) -> pn.Row:
    return pn.Row(*pieces, margin=0, sizing_mode="stretch_width", stylesheets=[ROW_CSS])
