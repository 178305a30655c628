"""Compare: the strategies of the scenario and the pinned runs side by side."""

from collections.abc import Mapping
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
from panel.viewable import Viewable

from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.charts.quantities import along
from railjoule.dashboard.look import words
from railjoule.dashboard.look.side_by_side import pair_names
from railjoule.dashboard.look.theme import padded
from railjoule.dashboard.look.tokens import NARROW_PX
from railjoule.dashboard.page import BODY_CSS, Request, shows, study
from railjoule.dashboard.pages.compare import table
from railjoule.dashboard.pages.compare.charts import PAIR_PLOTS, PLOTS, Contender, contenders, find_reference
from railjoule.dashboard.pages.compare.pair_tab import PAIR_FIELDS, PAIR_TAB, STRATEGIES_TAB, PairTab
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import buttons, over_time_buttons
from railjoule.dashboard.parts.tabs import PageTabs
from railjoule.dashboard.state.kept import result
from railjoule.dashboard.state.pins import LONGEST_NAME, MOST_PINS, PIN_KEYS, Pin
from railjoule.dashboard.work.runs import Runs, RunsRequest, compute_runs_in_steps
from railjoule.dashboard.workbench import Workbench

REST_MS = 400
"""While a slider moves, a study under way would delay the page."""
IN_TURN = tuple(sorted(STRATEGIES, key=lambda name: STRATEGIES[name].seconds_per_cell))
"""The slowest come last, as a strategy still under way is abandoned when the next scenario is asked for."""
AMONG = ("desk.runs", "compared", "desk.pins", "desk.ticked", "desk.chosen", "compare_all", "reference")
"""Sources of the runs to compare."""
TEXT_CSS = padded("0 20px 16px", "0 14px 16px")
NO_PIN = parts.Markup("<p>Pin up to six runs to compare them here.</p>")


class PinRow:
    """One pinned run: its line, its name to change, and the button that removes it."""

    def __init__(self, desk: Workbench, key: str) -> None:
        self.desk, self.key, number = desk, key, PIN_KEYS.index(key) + 1
        self.name = pmui.TextInput(
            label=f"Name of pinned run {number}",
            value="",
            max_length=LONGEST_NAME,
            variant="standard",
            size="small",
            margin=(0, 8),
            sizing_mode="stretch_width",
        )
        self.remove = pmui.Button(
            label=f"Unpin run {number}",
            variant="text",
            size="small",
            margin=(12, 0, 0, 0),
            on_click=self._remove,
        )
        line = {"width": 44, "height": 20, "sizing_mode": "fixed", "margin": (18, 0, 0, 0)}
        self.view = pn.Row(
            parts.html_pane(f"{parts.swatch(key)} {number}", **line),
            self.name,
            self.remove,
            margin=0,
            sizing_mode="stretch_width",
            max_width=620,
        )
        self.name.param.watch(self._rename, "value")

    @property
    def pin(self) -> Pin | None:
        """The run that is pinned in this row, if any."""
        return next((pin for pin in self.desk.pins if pin.colour == self.key), None)

    def show(self) -> None:
        """Show the run that is pinned here."""
        if self.pin is not None:
            self.name.value = self.pin.name

    def _rename(self, event: Any) -> None:
        pin = self.pin
        if pin is not None and event.new != pin.name:
            self.desk.rename(pin, event.new or "")
            # an empty name has become the first one again, which the field does not have yet
            self.show()

    def _remove(self, *_: Any) -> None:
        if self.pin is not None:
            self.desk.unpin(self.pin)


TABS: Mapping[str, str] = {STRATEGIES_TAB: "Strategies", PAIR_TAB: "Two scenarios"}
"""The tabs by their names in the address."""


class Compare(PairTab):
    """All runs of a scenario, and pinned ones of others; and the runs of two scenarios."""

    page = "Compare"
    kept = ("tab", "compare_all", "reference", *PAIR_FIELDS)
    passing = ("comparing",)
    figures = (*PLOTS, *PAIR_PLOTS)
    # as the grid of the tab, which has one column up to 899 px
    halves_from_px = NARROW_PX
    full_width = tuple(plot.name for plot in PLOTS)

    tab = param.Selector(default=STRATEGIES_TAB, objects=list(TABS), doc="The tab in sight.")
    compare_all = param.Boolean(default=True, doc="Compare all strategies, not only those that are ticked.")
    reference = param.String(default="", doc="Strategy or pin that others are compared with; empty for the usual one.")
    comparing = param.Boolean(default=False, doc="Whether runs of further strategies are under way.")
    compared = result(Runs, "The runs of all strategies.")

    # ---- what it computes

    @study(
        "scenario",
        "compare_all",
        into="compared",
        busy="comparing",
        rest_ms=REST_MS,
        only_whole=True,
        tab=STRATEGIES_TAB,
    )
    def _compared(self) -> Request:
        if not self.compare_all:
            return None
        return compute_runs_in_steps, RunsRequest(self.desk.scenario.scenario(), IN_TURN)

    @property
    def among(self) -> tuple[Contender, ...]:
        """The runs to compare, each with the greatest bound that is proven by now."""
        compared = None if self.compared is None else self.desk.proof.laid_on(self.compared)
        return contenders(self.desk, compared, only_ticked=not self.compare_all)

    def is_over_time(self, axis: str) -> bool:
        """Return whether the figures are over time; else they are over distance."""
        return bool(self.desk.over_time)

    # ---- what it shows

    def layout(self) -> Viewable:
        """Make the tabs and the parts of the one that is open, and return them laid out."""
        self.tabs = PageTabs(self, TABS, {STRATEGIES_TAB: self.layout_strategies, PAIR_TAB: self.layout_pair})
        return self.tabs.view

    def layout_strategies(self) -> Viewable:
        """Return the parts of the tab of the strategies, laid out."""
        self.table, self.pins, self.differences = (parts.html_pane() for _ in range(3))
        self.menu = pmui.Select(label="Reference run", options=[], size="small", margin=(10, 12, 0, 20), width=290)
        self.menu.param.watch(self._refer, "value")
        self._quiet = False
        some = {"All strategies": True, "Selected only": False}
        tools = pn.FlexBox(
            self.menu,
            buttons(self, "compare_all", some, margin=(16, 12, 0, 20)),
            over_time_buttons(self.desk, margin=(16, 20, 0, 20)),
            align_items="flex-start",
            margin=0,
            sizing_mode="stretch_width",
        )
        self.rows: dict[str, PinRow] = {}
        figures = parts.stack(*(self.host.plots[plot.name].host for plot in PLOTS), css=BODY_CSS)
        self.pin_rows = parts.stack()
        pins = parts.stack(self.pins, self.pin_rows, self.differences)
        return parts.stack(self.host.figures, tools, figures, parts.stack(self.table, pins, css=TEXT_CSS))

    def _show_pins(self) -> None:
        """Have a row for each pinned run; rows are made with their runs."""
        pinned = [pin.colour for pin in self.desk.pins]
        for key in pinned:
            if key not in self.rows:
                self.rows[key] = PinRow(self.desk, key)
            self.rows[key].show()
        views = [self.rows[key].view for key in PIN_KEYS if key in pinned]
        if views != list(self.pin_rows):
            self.pin_rows[:] = views

    def _refer(self, event: Any) -> None:
        if not self._quiet and event.new:
            self.reference = event.new

    @shows("desk.failure", "desk.runs", "failure", "tab")
    def _show_failure(self) -> None:
        run = self.desk.run
        shown = f"Showing the last feasible runs, {words.number(run.travel_time_s)} s." if run else ""
        # that of the strategies comes from the same scenario as that of the desk
        own = self.failure if self.tab == PAIR_TAB else None
        self.host.tell(self.desk.failure or own, shown)

    @shows("desk.runs", "desk.pins", "desk.ticked", "compared", "compare_all", "pair", "tab")
    def _show_heading(self) -> None:
        count, run, pair = len(self.desk.pins), self.desk.run, self.pair
        if run is None:
            return
        subtitle = f"{len(self.among)} runs, {f'{count} of {MOST_PINS} pinned' if count else 'none pinned'}"
        if self.tab == PAIR_TAB:
            subtitle = "" if pair is None else f"beside {pair_names(*pair.runs)[1]}"
        self.host.heading.object = parts.heading(self.page, run.scenario.title, subtitle, "")

    @shows(*AMONG, "desk.over_time", tab=STRATEGIES_TAB)
    def _show(self) -> None:
        among, desk = self.among, self.desk
        if not among or desk.run is None:
            return
        reference = find_reference(desk, among, self.reference)
        narrow, over_time = self.host.browser.window_width < NARROW_PX, desk.over_time
        self._offer(among, reference)
        self.pins.object = parts.markup('<div class="block"><h2>Pinned runs</h2>{}</div>', "" if desk.pins else NO_PIN)
        self._show_pins()
        self.differences.object = table.scenario_differences(desk.pins, reference)
        x = along(over_time)
        self.host.axis.fit(max(float(x.values(one.run)[-1]) for one in among), roomy=not narrow)
        self.host.draw(PLOTS, among, reference, over_time, narrow)

    def _offer(self, among: tuple[Contender, ...], reference: Contender) -> None:
        options = {one.name: one.key for one in among}
        if (self.menu.options, self.menu.value) != (options, reference.key):
            self._quiet = True
            self.menu.param.update(options=options, value=reference.key)
            self._quiet = False

    # a greater bound changes only numbers, and no line is drawn again for it
    # `comparing` begins before runs come and ends with them or a failure: no further drawing is needed for it
    @shows(*AMONG, "desk.tightened", "failure", tab=STRATEGIES_TAB)
    def _show_table(self) -> None:
        among, desk = self.among, self.desk
        if among:
            reference = find_reference(desk, among, self.reference)
            known = self.compared if self.compare_all and self.compared is not None else desk.runs
            refused = {} if known is None else known.refused
            self.host.figures.object = table.answer(among, reference, so_far=self.comparing)
            self.table.object = (
                table.comparison_table(among, reference) + table.arrival_table(among) + table.refusals(refused)
            )
