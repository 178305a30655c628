"""Measured runs: what a recorded run cost, what it could have cost, and which train fits it."""

from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.dashboard.charts.chart import Axis, Chart
from railjoule.dashboard.charts.run_charts import LineStrip
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.library_workarounds import SmallFile
from railjoule.dashboard.limits import LARGEST_RUN_BYTES
from railjoule.dashboard.look.theme import padded, parts_css
from railjoule.dashboard.look.tokens import NARROW_PX
from railjoule.dashboard.pages.measured_runs import texts
from railjoule.dashboard.pages.measured_runs.charts import (
    MOST_DOTS,
    NARROW_DOTS,
    MeasuredEnergyChart,
    MeasuredSpeedChart,
    RunsScene,
)
from railjoule.dashboard.pages.measured_runs.columns_form import ColumnsForm
from railjoule.dashboard.pages.measured_runs.compute import Measured, ReadRun
from railjoule.dashboard.pages.measured_runs.fit_parts import FIT_CSS, fit_block
from railjoule.dashboard.pages.measured_runs.work import PAGE, MeasuredRuns, open_on_drive, try_example, use_fit
from railjoule.dashboard.pages.page import BODY_CSS, PageView
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import box, over_time_buttons
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.pins import Pin
from railjoule.dashboard.work.uploads import too_large

HEIGHTS = {"measured_speed": (270, 340, 220), "line": (88, 96, 80), "measured_energy": (200, 240, 180)}
"""Of each chart [px]: in usual, wide and narrow windows."""
RAIL_PX = 400
WIDE_CSS = (
    f"@media (min-width: 1600px) {{ :host {{ display: grid; grid-template-columns: minmax(0, 1fr) {RAIL_PX}px; "
    "align-items: start; } }"
)
SIDES_CSS = (
    "@media (min-width: 1200px) and (max-width: 1599px) { :host { display: grid; gap: 0 32px; align-items: start; "
    "grid-template-columns: minmax(0, 1.35fr) minmax(0, 1fr); } }"
)
PIN, UNPIN = "Pin this run", "Unpin this run"
ROW_CSS = padded("0 20px", "0 14px")
TEXT_CSS = padded("0 20px 12px", "0 14px 12px")


class MeasuredRunsView(PageView):
    """The page of measured runs."""

    page = PAGE
    works = (MeasuredRuns,)
    heights = HEIGHTS
    rail_px = RAIL_PX

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        state, palette = self.state, self.palette
        self.model = state.measured_runs
        self.axis = Axis(palette)
        usual = [height for height, _, _ in HEIGHTS.values()]
        self.speed = MeasuredSpeedChart(usual[0], self.axis, palette)
        self.track = LineStrip(usual[1], self.axis, palette)
        self.energy = MeasuredEnergyChart(usual[2], self.axis, palette)
        self.form = ColumnsForm(self.model.say)
        self._unfolded = self._quiet = False
        tools = self._tools()
        self.mapper = parts.stack(self._mapper_line(), parts.stack(self.form), visible=False)
        self.form_place = self.mapper[1]
        self.invitation = parts.stack(parts.html_pane(texts.invitation()), css=ROW_CSS)
        self.refusal = parts.html_pane(visible=False)
        below = parts.stack(
            self.figures,
            parts.stack(
                parts.stack(self.speed.host, self.track.host, self.energy.host, css=BODY_CSS),
                parts.stack(self._fit_panel(), self._where(), css=TEXT_CSS + SIDES_CSS),
                css=WIDE_CSS,
            ),
        )
        self.results = parts.stack(below, visible=False)
        self._listen()
        return parts.stack(self.heading, self.message, self.refusal, self.invitation, tools, self.mapper, self.results)

    def _tools(self) -> Viewable:
        """Make what brings files, chooses among them, and lays the charts over distance or time."""
        self.files = SmallFile(
            refuse=lambda: setattr(self.model, "refusal", too_large("The file")),
            label="Choose files",
            uploaded_label="Choose files",
            accept=texts.ACCEPTED,
            multiple=True,
            max_file_size=LARGEST_RUN_BYTES,
            icon="folder_open",
            variant="outlined",
            size="small",
            margin=(8, 8, 0, 0),
        )
        self.example = pmui.Button(
            label="Try the example",
            variant="outlined",
            size="small",
            height=30,
            margin=(8, 8, 0, 0),
            on_click=lambda _: try_example(self.state),
        )
        self.chosen = pmui.Select(label="Run", options=[], size="small", margin=(6, 8, 0, 8), width=220, visible=False)
        self.remove = pmui.Button(
            label="Remove this run",
            variant="text",
            size="small",
            margin=(8, 8, 0, 0),
            on_click=self._remove,
            visible=False,
        )
        self.over = parts.stack(over_time_buttons(self.state, margin=(10, 0, 0, 8)), visible=False, sizing_mode=None)
        self.files.param.watch(self._bring, "value")
        self.chosen.param.watch(self._choose, "value")
        tools = pn.FlexBox(
            self.files,
            self.example,
            parts.stack(self.chosen, sizing_mode=None),
            self.remove,
            self.over,
            align_items="center",
            margin=0,
            sizing_mode="stretch_width",
        )
        return parts.stack(tools, css=ROW_CSS)

    def _mapper_line(self) -> Viewable:
        self.columns = parts.html_pane(sizing_mode=None, margin=(8, 0, 0, 0))
        self.change = pmui.Button(
            label="Change", variant="text", size="small", margin=(0, 0, 0, 4), on_click=self._unfold
        )
        # a run whose place is asked for has no results, but this field
        self.begins = NumberField(self.model, "begins_at_m", max_width=320)
        line = pn.Row(self.columns, self.change, self.begins, margin=(6, 0, 4, 0), stylesheets=[parts.WRAP_CSS])
        return parts.stack(line, css=ROW_CSS)

    def _fit_panel(self) -> Viewable:
        self.fit = parts.html_pane(stylesheets=[parts_css() + FIT_CSS])
        self.use = pmui.Button(
            label="Use fitted values",
            variant="outlined",
            size="small",
            height=30,
            margin=(0, 10, 0, 0),
            on_click=lambda _: use_fit(self.state),
        )
        coasting = box(self.model, "coasting_only", "Coasting samples only", margin=(0, 0))
        return parts.stack(self.fit, pn.Row(self.use, coasting, margin=(4, 0, 8, 0), stylesheets=[parts.WRAP_CSS]))

    def _where(self) -> Viewable:
        self.where = parts.html_pane()
        opened = pmui.Button(
            label="Open its time and stops on Drive",
            variant="text",
            size="small",
            margin=(4, 0, 0, 0),
            on_click=lambda _: open_on_drive(self.state),
        )
        self.pin = pmui.Button(
            label=PIN, variant="outlined", size="small", height=30, margin=(4, 8, 0, 0), on_click=self._turn_pin
        )
        return parts.stack(self.where, pn.Row(self.pin, opened, margin=0, stylesheets=[parts.WRAP_CSS]))

    def _listen(self) -> None:
        model = self.model
        self.shows(self._show_files, (model, ["files", "shown", "reading", "refusal", "failure"]))
        self.shows(self._show, (model, ["measured"]), (self.state, ["over_time"]))
        self.shows(self._name_pin, (model, ["measured"]), (self.state, ["pins"]))

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return self.speed, self.track, self.energy

    def settle(self) -> None:
        """Tell the cursor of the runs that it may meet new charts."""
        self.axis.settle_over(self.state.over_time)

    # ---- what is asked

    def _bring(self, *_: Any) -> None:
        """Hand over the files that were chosen, as one or as a list."""
        contents, names = self.files.value, self.files.filename
        if not contents:
            return
        pairs = zip(names, contents, strict=True) if isinstance(contents, list) else [(names, contents)]
        self.model.bring([(str(name), content) for name, content in pairs])

    def _choose(self, event: Any) -> None:
        if not self._quiet and event.new:
            self.model.shown = event.new

    def _remove(self, *_: Any) -> None:
        if self.chosen.value:
            self.model.remove(self.chosen.value)

    def _turn_pin(self, *_: Any) -> None:
        """Pin the measured run, or let go of it."""
        pin = self._pin_of_run()
        if pin is None:
            self.state.pin_measured()
        else:
            self.state.unpin(pin)

    def _pin_of_run(self) -> Pin | None:
        measured = self.model.measured
        run = None if measured is None else measured.shown.run
        return None if run is None else self.state.pin_of(run.trajectory)

    def _name_pin(self) -> None:
        self.pin.label = PIN if self._pin_of_run() is None else UNPIN

    def _unfold(self, *_: Any) -> None:
        self._unfolded = not self._unfolded
        self._show()

    # ---- what is shown

    def _show_files(self) -> None:
        model = self.model
        names = [file.name for file in model.files]
        shown = model.shown if model.shown in names else (names[-1] if names else "")
        self._quiet = True
        if self.chosen.options != names:
            self.chosen.options = names
        self.chosen.value = shown or None
        self._quiet = False
        some = bool(names)
        self.invitation.visible = not some
        self.example.visible = not model.example
        self.chosen.visible, self.remove.visible, self.over.visible = len(names) > 1, some, some
        self.refusal.visible = bool(model.refusal)
        self.refusal.object = parts.refusal(model.refusal) if model.refusal else ""
        self.tell(model.failure, "")
        if not some:
            self.heading.object = parts.heading(self.page, self.state.scenario.edited.title, "", "")

    def _show(self) -> None:
        measured = self.model.measured
        read = None if measured is None else measured.shown
        run = None if read is None else read.run
        self.mapper.visible, self.results.visible = read is not None, run is not None
        if measured is None or read is None:
            return
        title = measured.request.scenario.title
        self.heading.object = parts.heading(self.page, title, texts.subtitle(measured), "")
        if read.refusal:
            self.refusal.object, self.refusal.visible = parts.refusal(read.refusal), True
        elif not self.model.refusal:
            self.refusal.visible = False
        self._show_columns(read)
        if run is not None:
            self._show_run(measured)

    def _show_columns(self, read: ReadRun) -> None:
        """Show what the columns mean: all of them while something is asked or wrong, else in one line."""
        opened = bool(read.doubts) or read.run is None
        self.form_place.visible = opened or self._unfolded
        self.change.visible = not opened
        self.change.label = "Fold" if self._unfolded else "Change"
        line = "What the columns mean" if opened else f"{texts.columns_line(read)}."
        self.columns.object = parts.markup("<h2>{}</h2>" if opened else "<p class=muted>{}</p>", line)
        self.form.show(read)

    def _show_run(self, measured: Measured) -> None:
        run = measured.shown.run
        assert run is not None
        self.figures.object = texts.figures(measured)
        self.fit.object = fit_block(measured)
        self.where.object = texts.where_block(measured)
        self.use.disabled = measured.fit is None
        narrow = self.browser.window_width < NARROW_PX
        scene = RunsScene(run, measured.saving, self.state.over_time, NARROW_DOTS if narrow else MOST_DOTS)
        self.axis.fit(scene.end, roomy=not narrow)
        self.speed.show(partial(self.speed.draw, scene))
        # the track under the measured run: what is drawn of a run's line is the same for each of them
        track = RunScene("optimal", {"optimal": run.modelled}, None, scene.over_time, narrow, self.speed.width_px)
        self.track.show(partial(self.track.draw, track))
        self.energy.show(partial(self.energy.draw, scene))
