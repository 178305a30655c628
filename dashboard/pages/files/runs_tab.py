"""The tab of recorded runs: energy of a run, potential saving, and the train that fits all of them."""

from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
from panel.viewable import Viewable

from railjoule.core import RailjouleError
from railjoule.core.measured import MeasuredRun
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.look.theme import padded, parts_css
from railjoule.dashboard.look.tokens import NARROW_PX
from railjoule.dashboard.page import BODY_CSS, Request, shows, study
from railjoule.dashboard.pages.files import texts
from railjoule.dashboard.pages.files.card_view import FileCard, fill, menu
from railjoule.dashboard.pages.files.cards import describe_run, read_meaning
from railjoule.dashboard.pages.files.columns import RunFile
from railjoule.dashboard.pages.files.line_tab import LineTab
from railjoule.dashboard.pages.files.measured import Measured, ReadRun, RunsRequest, compute_measured, fitted_changes
from railjoule.dashboard.pages.files.run_charts import (
    ENERGIES,
    MOST_DOTS,
    NARROW_DOTS,
    RUN_PLOTS,
    SPEEDS,
    TRACK,
    RunsScene,
)
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import box, over_time_buttons
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.kept import result
from railjoule.dashboard.state.numbers import TypedNumber
from railjoule.dashboard.state.pins import Pin

RUNS = "runs"
REST_MS = 150
"""Several changes within this time, as files that are dropped together, are computed once."""
PIN, UNPIN = "Pin this run", "Unpin this run"
ROW_CSS = padded("0 20px", "0 14px")
SIDES_CSS = padded("0 20px 12px", "0 14px 12px") + (
    "@media (min-width: 1200px) { :host { display: grid; gap: 0 32px; align-items: start; "
    "grid-template-columns: minmax(0, 1.35fr) minmax(0, 1fr); } }"
)
TEXT_BUTTON: dict[str, Any] = {"variant": "text", "size": "small", "margin": (4, 8, 0, 0)}
BUTTON: dict[str, Any] = {"variant": "outlined", "size": "small", "height": 30, "margin": (4, 8, 0, 0)}


class RunsTab(LineTab):
    """The recorded runs among the files."""

    answers = param.Dict(default={}, doc="Meanings of columns by their names: a quantity and a unit, or nothing.")
    begins_at_m = TypedNumber(
        "Begins at, m",
        "m",
        0,
        default=None,
        allow_None=True,
        bounds=(0.0, 1e6),
        doc="Start of the runs; found if empty.",
    )
    shown = param.String(default="", doc="Name of the run that is shown; the last one where there is none of it.")
    coasting_only = param.Boolean(default=False, doc="Fit only samples without effort.")
    measured = result(Measured, "The runs on their line so far.")

    @property
    def runs(self) -> tuple[RunFile, ...]:
        """The recorded runs among the files, as far as they are read."""
        return () if self.reading is None else self.reading.runs

    @study(
        "reading",
        "answers",
        "begins_at_m",
        "shown",
        "coasting_only",
        "scenario",
        into="measured",
        marked=True,
        rest_ms=REST_MS,
        tab=RUNS,
    )
    def _measure(self) -> Request:
        if not self.runs:
            return None
        # from a link they may be anything
        answers = tuple(sorted((str(header), str(text)) for header, text in self.answers.items()))
        scenario = self.desk.scenario.scenario().model_copy(update={"timetable": self.desk.scenario.base.timetable})
        asked = RunsRequest(self.runs, answers, scenario, self.begins_at_m, self.shown, self.coasting_only)
        return compute_measured, asked

    @property
    def run(self) -> MeasuredRun | None:
        """The run that is shown, where it is on its line."""
        return None if self.measured is None else self.measured.shown.run

    def say_of_run(self, key: str, value: str) -> None:
        """Take a choice of the user about the run that is shown."""
        if self.measured is None:
            return
        card = describe_run(self.measured.shown, self.shown_number)
        if key == "kind":
            self.say(card.number, key, value)
        elif card.allows(key, value):
            header, text = read_meaning(key, value)
            self.answers = {**self.answers, header: text}

    @property
    def shown_number(self) -> int:
        """The number of the file that is shown; 0 where there is none."""
        name = "" if self.measured is None else self.measured.shown.file.name
        runs = ((card.number, run) for card in self.cards if card.is_run for run in card.result)
        return next((number for number, run in runs if run.name == name), 0)

    # ---- what is done with a run

    def use_fit(self, *_: Any) -> None:
        """Give the scenario's train the fitted values, as one change; an error is shown on the page."""
        if self.measured is not None and self.measured.fit is not None:
            try:
                self.desk.scenario.edit(fitted_changes(self.measured.fit))
            except RailjouleError as failure:
                self.failure = failure

    def open_on(self, page: str) -> None:
        """Take the stretch, the stops and the time of the run as the scenario, and turn to a page."""
        run = self.run
        if run is None:
            return
        name = run.recording.name
        title = f"{run.scenario.title}, {name}" if run.scenario.title else name
        try:
            self.desk.scenario.open(format_scenario(run.scenario.model_copy(update={"title": title})), name)
        except RailjouleError as failure:
            self.failure = failure
        else:
            self.desk.page = page

    def compare(self, *_: Any) -> None:
        """Pin the run, and show it on Compare beside the strategies in its time and with its stops."""
        if self.run is not None:
            self.desk.pin_measured(self.run)
            self.open_on("Compare")

    def turn_pin(self, *_: Any) -> None:
        """Pin the run, or unpin it."""
        pin = self._pin_of_run()
        if pin is not None:
            self.desk.unpin(pin)
        elif self.run is not None:
            self.desk.pin_measured(self.run)

    def _pin_of_run(self) -> Pin | None:
        return None if self.run is None else self.desk.find_pin(self.run.trajectory)

    # ---- what it shows

    def layout_runs(self) -> Viewable:
        """Make the parts of the tab."""
        self._quiet = self._unfolded = False
        self.chosen = menu("Run", 220)
        self.chosen.param.watch(self._choose, "value")
        over = parts.stack(over_time_buttons(self.desk, margin=(10, 0, 0, 0)), sizing_mode=None)
        self.card = FileCard(self.say_of_run, lambda: self.remove(self.shown_number))
        self.columns = parts.html_pane(sizing_mode=None, margin=(8, 0, 0, 12))
        self.change = pmui.Button(label="Change", on_click=self._unfold, **TEXT_BUTTON)
        # a run whose place is asked for has no results, but this field
        begins = NumberField(self, "begins_at_m", max_width=320)
        line = pn.FlexBox(self.chosen, over, self.columns, self.change, begins, align_items="center", margin=0)
        self.tools = parts.stack(line, self.card.view, css=ROW_CSS, visible=False)
        charts = parts.stack(*(self.host.plots[plot.name].host for plot in RUN_PLOTS), css=BODY_CSS)
        below = parts.stack(self._layout_fit(), self._layout_place(), css=SIDES_CSS)
        self.outcome = parts.stack(self.host.figures, charts, below, visible=False)
        return parts.stack(self.tools, self.outcome)

    def _layout_fit(self) -> Viewable:
        self.fit = parts.html_pane(stylesheets=[parts_css() + texts.FIT_CSS])
        self.fit_button = pmui.Button(label="Fit the train", on_click=self.use_fit, **BUTTON)
        coasting = box(self, "coasting_only", "Coasting samples only", margin=(0, 0))
        return parts.stack(self.fit, pn.FlexBox(self.fit_button, coasting, margin=0))

    def _layout_place(self) -> Viewable:
        self.where = parts.html_pane()
        self.pin = pmui.Button(label=PIN, on_click=self.turn_pin, **BUTTON)
        compare = pmui.Button(label="Compare with the optimum", on_click=self.compare, **BUTTON)
        drive = pmui.Button(
            label="Open its time and stops on Drive", on_click=lambda _: self.open_on("Drive"), **TEXT_BUTTON
        )
        return parts.stack(self.where, pn.FlexBox(compare, self.pin, drive, margin=0))

    def _choose(self, event: Any) -> None:
        if not self._quiet and event.new:
            self.shown = event.new

    def _unfold(self, *_: Any) -> None:
        self._unfolded = not self._unfolded
        self._show_measured()

    @shows("reading", "shown", tab=RUNS)
    def _show_runs(self) -> None:
        names = [run.name for run in self.runs]
        shown = self.shown if self.shown in names else (names[-1] if names else "")
        self._quiet = True
        fill(self.chosen, zip(names, names, strict=True), shown, visible=len(names) > 1)
        self._quiet = False

    @shows("measured", "desk.over_time", tab=RUNS)
    def _show_measured(self) -> None:
        measured = self.measured
        self.tools.visible = measured is not None
        self.outcome.visible = self.run is not None
        if measured is None:
            return
        self._show_columns(measured.shown)
        if self.run is not None:
            self._show_run(measured, self.run)

    def _show_columns(self, read: ReadRun) -> None:
        """Show the meanings of the columns: all while there is a question or an error, else in one line."""
        opened = bool(read.doubts) or read.run is None
        self.card.view.visible = opened or self._unfolded
        self.change.visible = not opened
        self.change.label = "Fold" if self._unfolded else "Change"
        self.columns.object = "" if opened else parts.markup("<p class=muted>{}.</p>", texts.columns_line(read))
        if self.card.view.visible:
            self.card.show(describe_run(read, self.shown_number))

    def _show_run(self, measured: Measured, run: MeasuredRun) -> None:
        host, over_time = self.host, self.desk.over_time
        host.figures.object = texts.figures(measured)
        self.fit.object = texts.fit_block(measured)
        self.where.object = texts.where_block(measured)
        self.fit_button.disabled = measured.fit is None
        narrow = host.browser.window_width < NARROW_PX
        scene = RunsScene(run, measured.saving, over_time, NARROW_DOTS if narrow else MOST_DOTS)
        host.axes[RUNS].fit(scene.end, roomy=not narrow)
        host.draw([SPEEDS, ENERGIES], scene)
        # the track under the measured run: what is drawn of a run's line is the same for each of them
        width_px = host.plots[SPEEDS.name].width_px
        host.draw([TRACK], RunScene("optimal", {"optimal": run.modelled}, None, over_time, narrow, width_px))

    @shows("measured", "desk.pins", tab=RUNS)
    def _show_pin(self) -> None:
        self.pin.label = PIN if self._pin_of_run() is None else UNPIN
