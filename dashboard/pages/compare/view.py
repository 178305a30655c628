"""Compare: the strategies of the scenario and the pinned runs side by side."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.dashboard.charts.chart import Axis, Chart
from railjoule.dashboard.look import words
from railjoule.dashboard.look.differences import difference_words
from railjoule.dashboard.look.theme import padded
from railjoule.dashboard.look.tokens import NARROW_PX
from railjoule.dashboard.pages.compare.charts import (
    ComparedChart,
    ComparedDifferenceChart,
    ComparedEffortChart,
    ComparedEnergyChart,
    ComparedSpeedChart,
    end_of,
)
from railjoule.dashboard.pages.compare.contenders import Contender, contenders, reference_of
from railjoule.dashboard.pages.compare.table import comparison_table
from railjoule.dashboard.pages.compare.work import PAGE, Compare
from railjoule.dashboard.pages.page import BODY_CSS, PageView
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import buttons, over_time_buttons
from railjoule.dashboard.state.pins import LONGEST_NAME, MOST_PINS, PIN_KEYS, Pin
from railjoule.dashboard.state.workbench import Workbench

HEIGHTS = {
    "compared_speed": (290, 360, 240),
    "compared_energy": (170, 210, 150),
    "compared_difference": (140, 180, 120),
    "compared_effort": (124, 150, 110),
}
"""Of each chart [px]: in usual, wide and narrow windows."""
TEXT_CSS = padded("0 20px 16px", "0 14px 16px")
NO_PIN = "Pin up to six runs to compare them here."


class PinRow:
    """One pinned run: its line, its name to change, and the button that lets go of it."""

    def __init__(self, state: Workbench, key: str) -> None:
        self.state, self.key, number = state, key, PIN_KEYS.index(key) + 1
        self._quiet = False
        self.name = pmui.TextInput(
            label=f"Name of pinned run {number}",
            value="",
            max_length=LONGEST_NAME,
            variant="standard",
            size="small",
            margin=(0, 8),
            sizing_mode="stretch_width",
        )
        self.let_go = pmui.Button(
            label=f"Unpin run {number}", variant="text", size="small", margin=(12, 0, 0, 0), on_click=self._unpin
        )
        sample = parts.html_pane(
            f"{parts.swatch(key)} {number}", width=44, height=20, sizing_mode="fixed", margin=(18, 0, 0, 0)
        )
        self.view = pn.Row(
            sample, self.name, self.let_go, margin=0, visible=False, sizing_mode="stretch_width", max_width=620
        )
        self.name.param.watch(self._rename, "value")
        self.show()

    @property
    def pin(self) -> Pin | None:
        """The run that is pinned in this row, if any."""
        return next((pin for pin in self.state.pins if pin.colour == self.key), None)

    def show(self) -> None:
        """Show the run that is pinned here."""
        pin = self.pin
        self.view.visible = pin is not None
        if pin is not None and self.name.value != pin.name:
            self._quiet = True
            self.name.value = pin.name
            self._quiet = False

    def _rename(self, event: Any) -> None:
        pin = self.pin
        if pin is not None and not self._quiet and event.new != pin.name:
            self.state.rename(pin, event.new or "")
            # an empty name has become the one that tells what was run, which the field does not know yet
            self.show()

    def _unpin(self, *_: Any) -> None:
        pin = self.pin
        if pin is not None:
            self.state.unpin(pin)


class CompareView(PageView):
    """The page of all runs."""

    page = PAGE
    works = (Compare,)
    heights = HEIGHTS

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        state, palette = self.state, self.palette
        self.table, self.differences, self.empty = (parts.html_pane() for _ in range(3))
        self.axis = Axis(palette)
        kinds = (ComparedSpeedChart, ComparedEnergyChart, ComparedDifferenceChart, ComparedEffortChart)
        # in the order of HEIGHTS, which the kinds above follow
        heights = [usual for usual, _, _ in HEIGHTS.values()]
        self.compared: tuple[ComparedChart, ...] = tuple(
            kind(height, self.axis, palette) for kind, height in zip(kinds, heights, strict=True)
        )
        self.reference = pmui.Select(label="Reference run", options=[], size="small", margin=(10, 12, 0, 20), width=290)
        some = {"All strategies": True, "Selected only": False}
        self.which = buttons(state, "compare_all", some, margin=(16, 12, 0, 20))
        self.over = over_time_buttons(state, margin=(16, 20, 0, 20))
        self.rows = [PinRow(state, key) for key in PIN_KEYS]
        self._quiet = False
        self._listen()
        return self._laid_out()

    def _laid_out(self) -> pn.Column:
        tools = pn.FlexBox(
            self.reference, self.which, self.over, align_items="flex-start", margin=0, sizing_mode="stretch_width"
        )
        body = parts.stack(*(chart.host for chart in self.compared), css=BODY_CSS)
        pins = parts.stack(self.empty, *(row.view for row in self.rows), self.differences)
        texts = parts.stack(self.table, pins, css=TEXT_CSS)
        return parts.stack(self.heading, self.message, tools, body, texts)

    def _listen(self) -> None:
        state = self.state
        self.reference.param.watch(self._refer, "value")
        shown = ["runs", "compared", "pins", "ticked", "chosen", "compare_all", "over_time", "reference"]
        self.shows(self._show_failure, (state, ["failure", "runs"]))
        self.shows(self._show, (state, shown))
        # a greater bound changes numbers alone, and no line is drawn anew for it
        self.shows(self._show_table, (state, ["tightened"]))

    def _refer(self, event: Any) -> None:
        if not self._quiet and event.new:
            self.state.reference = event.new

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return self.compared

    def settle(self) -> None:
        """Tell the cursor of the runs that it may meet new charts."""
        self.axis.settle_over(self.state.over_time)

    def _show_failure(self) -> None:
        run = self.state.run
        shown = f"Shown: the last valid runs, {words.number(run.travel_time_s)} s." if run else ""
        self.tell(self.state.failure, shown)

    def _show(self) -> None:
        state = self.state
        among = contenders(state)
        if not among:
            return
        reference = reference_of(state, among)
        narrow, over_time = self.browser.window_width < NARROW_PX, state.over_time
        self._offer(among, reference)
        self._show_texts(among, reference)
        self.axis.fit(max(end_of(contender.run, over_time) for contender in among), roomy=not narrow)
        for chart in self.compared:
            chart.show(partial(chart.draw, among, reference, over_time, narrow))

    def _offer(self, among: Sequence[Contender], reference: Contender) -> None:
        """Offer every run as the reference."""
        self._quiet = True
        options = {contender.name: contender.key for contender in among}
        if self.reference.options != options:
            self.reference.options = options
        self.reference.value = reference.key
        self._quiet = False

    def _show_texts(self, among: Sequence[Contender], reference: Contender) -> None:
        state = self.state
        assert state.run is not None
        count = len(state.pins)
        pinned = f"{count} of {MOST_PINS} runs pinned" if count else "nothing pinned"
        title = state.run.scenario.title
        self.heading.object = parts.heading(self.page, title, f"{len(among)} runs, {pinned}", "")
        self._show_table()
        self.empty.object = parts.markup(
            '<div class="block"><h2>Pinned runs</h2>{}</div>', "" if count else parts.markup("<p>{}</p>", NO_PIN)
        )
        for row in self.rows:
            row.show()
        self.differences.object = differences(state.pins, reference)

    def _show_table(self) -> None:
        """Show the numbers of the runs, which change with their bound alone, too."""
        among = contenders(self.state)
        if among:
            self.table.object = comparison_table(among, reference_of(self.state, among)) + self._refusals()

    def _refusals(self) -> parts.Markup:
        """Return why strategies do not take the scenario, as sentences."""
        runs = self.state.compared if self.state.compare_all else self.state.runs
        refused = {} if runs is None else runs.refused
        return parts.note_paragraphs(f"{words.STRATEGY_WORDS[name]}: {reason}" for name, reason in refused.items())


def differences(pins: Sequence[Pin], reference: Contender) -> parts.Markup:
    """Return by what the scenarios of pinned runs differ from that of the reference, as HTML."""
    items = []
    for pin in pins:
        if pin.trajectory is reference.run:
            continue
        told = difference_words(pin.trajectory.scenario, reference.run.scenario)
        text = "; ".join(told) if told else "the same scenario"
        items.append(parts.markup("<li><b>{} {}</b>: {}.</li>", pin.number, pin.name, text))
    if not items:
        return parts.Markup()
    return parts.markup(
        '<div class="block"><h2>How pinned scenarios differ from that of {}</h2><ul class="differences">{}</ul></div>',
        reference.name,
        parts.joined(items),
    )
