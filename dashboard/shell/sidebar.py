"""The sidebar: the scenario's editor, and the strategies."""

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, Protocol

import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core.motion.line_profile import neutral_stretches
from railjoule.core.scenario import load_scenario, preset_names
from railjoule.dashboard.browser.messages import added_to, unfrozen
from railjoule.dashboard.insides import SmallFile
from railjoule.dashboard.keep.dropped import LARGEST_REPORT_BYTES, NO_TEXT, TOO_LARGE
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.page_list import PAGES
from railjoule.dashboard.pages.drive.day_fields import ActualFields
from railjoule.dashboard.pages.host import PageFields as OwnFields
from railjoule.dashboard.pages.study.settings import StudyFields
from railjoule.dashboard.pages.what_if.fields import WhatIfFields
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.parts.number_field import LoadField, NumberField
from railjoule.dashboard.shell.changes import Changes
from railjoule.dashboard.shell.save import SaveScenario
from railjoule.dashboard.shell.strategies import StrategyList
from railjoule.dashboard.shell.text_button import STYLE, text_button
from railjoule.dashboard.state.workbench import Workbench

FIELDS_AFTER_MS = 200
FROM_FILE = "file"
"""What the value of a scenario from a file begins with; its number tells it from the one opened before it."""
NOT_SHOWN = "These fields could not be shown: a program error, which the server\u2019s log describes."


class Sidebar:
    """The scenario beside every page."""

    def __init__(self, state: Workbench, keeping: Keeping) -> None:
        self.state, self.keeping = state, keeping
        scenario = state.scenario
        self.preset = pmui.Select(
            label="Scenario",
            options=scenario_options(state),
            value=scenario.preset,
            size="small",
            margin=(16, 16, 0, 16),
            sizing_mode="stretch_width",
        )
        self.file = SmallFile(
            refuse=lambda: keeping.refuse_file("The file", TOO_LARGE),
            label="Open a scenario file",
            # the library would write the file's name here, which the list of scenarios shows
            uploaded_label="Open a scenario file",
            # the larger of both kinds: which one a file is, only its text tells
            max_file_size=LARGEST_REPORT_BYTES,
            icon="folder_open",
            **STYLE,
        )
        self.bring = text_button("Import a line or train", "upload_file", lambda _: setattr(state, "page", "Import"))
        self.edit = text_button(
            "Edit scenario",
            "tune",
            lambda _: setattr(state.editor, "open", not state.editor.open),
            # by this class the browser's half opens the drawer at a press, before the server answers
            css_classes=["rj-edit"],
        )
        self.saving = SaveScenario(state, keeping)
        self.travel_time = NumberField(scenario, "travel_time_s", ends=scenario.travel_time_range_s)
        self.shortest = html_pane()
        self.vehicle = html_pane()
        of_pages = {name: lambda _, page=page: OwnFields(page) for name, page in state.pages.items() if page.fields}
        own = [PageFields(state, name, make).view for name, make in {**OWN_FIELDS, **of_pages}.items()]
        self.line = html_pane()
        self.strategies = StrategyList(state)
        self.strategy_part = stack(
            html_pane('<hr class="rule">'),
            html_pane('<div class="section">Strategies</div>'),
            self.strategies,
            text_button("Adjust set speeds", "speed", lambda _: setattr(state, "page", "Set speeds")),
        )
        self.changes = Changes(state)
        self.view = pn.Column(
            self.preset,
            self.file,
            self.bring,
            self.edit,
            self.saving.view,
            html_pane('<div class="section">Plan <span>\u00b7 what the timetable expects</span></div>'),
            self.travel_time,
            self.shortest,
            LoadField(scenario, "load_percent", ["preset", "opened", "edits", "travel_time_range_s"]),
            NumberField(scenario, "recuperation_percent"),
            *own,
            self.vehicle,
            self.line,
            self.strategy_part,
            html_pane('<hr class="rule">'),
            self.changes.view,
            margin=0,
            sizing_mode="stretch_width",
        )
        self._quiet, self._opened = False, 0
        self.preset.param.watch(self._choose, "value")
        self.file.param.watch(self._open, "value")
        scenario.param.watch(self._name_scenario, ["preset", "opened"])
        scenario.param.watch(self._describe, ["preset", "opened", "edits"])
        scenario.param.watch(self._move_ends, "travel_time_range_s")
        state.param.watch(self._show_runs, "runs")
        state.param.watch(self._fit_page, "page")
        self._fit_page()
        self._describe()

    def _fit_page(self, *_: Any) -> None:
        """Leave out the strategies where they change nothing."""
        self.strategy_part.visible = bool(PAGES[self.state.page].strategies)

    def _choose(self, event: Any) -> None:
        if not self._quiet and not event.new.startswith(FROM_FILE):
            self.state.scenario.choose(event.new)

    def _open(self, event: Any) -> None:
        if event.new is None:
            return
        name = str(self.file.filename)
        try:
            self.keeping.open_file(name, event.new.decode("utf-8"))
        except UnicodeDecodeError:
            self.keeping.refuse_file(name, NO_TEXT)

    def _name_scenario(self, *_: Any) -> None:
        """Show in the list which scenario this is."""
        opened = self.state.scenario.opened
        self._opened += opened is not None
        file = f"{FROM_FILE} {self._opened}"
        # or `_choose` would take the shipped scenario anew, without what was edited in it
        self._quiet = True
        with pn.io.hold():
            # both at once, as a value must be among the options
            self.preset.param.update(
                options=scenario_options(self.state, file),
                value=self.state.scenario.preset if opened is None else file,
            )
        self._quiet = False

    def _move_ends(self, *_: Any) -> None:
        self.travel_time.set_ends(self.state.scenario.travel_time_range_s)

    def _describe(self, *_: Any) -> None:
        """Say which vehicle and line these are."""
        base = self.state.scenario.edited
        self.vehicle.object = markup('<div class="section">Vehicle <span>\u00b7 {}</span></div>', base.vehicle.name)
        self.line.object = markup('<div class="section">Track</div>{}', line_rows(self.state))

    def _show_runs(self, *_: Any) -> None:
        runs = self.state.runs
        if runs is not None:
            shortest = words.number(runs.shortest_time_s)
            template = '<div class="row small"><span class="muted">shortest possible</span><span>{} s</span></div>'
            self.shortest.object = markup(template, shortest)


@cache
def shipped_scenarios() -> tuple[tuple[str, str], ...]:
    """Return title and name of each shipped scenario; they never change."""
    return tuple((load_scenario(name).title, name) for name in preset_names("scenarios"))


def scenario_options(state: Workbench, file: str = FROM_FILE) -> dict[str, str]:
    """Return the scenarios to choose from by their titles, that of a file included under a name of its own."""
    options = dict(shipped_scenarios())
    opened = state.scenario.opened
    if opened is not None:
        options[f"{opened.title or 'Untitled'} (file)"] = file
    return options


class HasView(Protocol):
    """Fields that are drawn."""

    view: Viewable


class PageFields:
    """Fields that one page alone has; they are made when it is first in sight, as they cost every page that opens."""

    def __init__(self, state: Workbench, page: str, make: Callable[[Workbench], HasView]) -> None:
        self.state, self.page, self.make = state, page, make
        self._called = False
        self.view = pn.Column(margin=0, sizing_mode="stretch_width")
        state.param.watch(self._show, "page")
        self._show()

    def _show(self, *_: Any) -> None:
        self.view.visible = self.state.page == self.page
        if not self.view.visible or self.view.objects or self._called:
            return
        document = pn.state.curdoc
        if document is None:
            self._fill()
        else:
            # the page itself comes first
            self._called = True
            document.add_timeout_callback(self._fill, FIELDS_AFTER_MS)

    def _fill(self) -> None:
        self._called = False
        with added_to(self.view):
            try:
                with unfrozen():
                    self.view[:] = [self.make(self.state).view]
            except Exception as error:
                self.state.faults.note(error, f"the fields of {self.page} could not be shown")
                self.view[:] = [html_pane(markup('<p class="error" role="alert">{}</p>', NOT_SHOWN))]


OWN_FIELDS: Mapping[str, Callable[[Workbench], HasView]] = {
    "Drive": ActualFields,
    "What if": WhatIfFields,
    "Study": StudyFields,
}
"""Fields that one page alone has, by its name."""


def line_rows(state: Workbench) -> Markup:
    """Return what the line is like, in rows."""
    line = state.scenario.edited.line.in_running_order()
    gradients = [section.gradient_permille for section in line.sections]
    if min(gradients) == max(gradients):
        level = "level" if gradients[0] == 0 else f"{words.signed(gradients[0], 0)} {words.PER_MILLE}"
    else:
        level = f"{words.signed(min(gradients), 0)} to {words.signed(max(gradients), 0)} {words.PER_MILLE}"
    rows = [markup('<div class="row"><span>{} km, {}</span></div>', words.distance(line.length_m), level)]
    rows += [
        markup(
            '<div class="row"><span>Limit {} km/h</span><span>{}\u2013{} m</span></div>',
            *(f"{value:g}" for value in (limit.limit_kmh, limit.from_m, limit.to_m)),
        )
        for limit in line.speed_limits
    ]
    rows += [
        markup(
            '<div class="row"><span>Neutral section</span><span>{}\u2013{} m</span></div>',
            *(f"{end:g}" for end in ends),
        )
        for ends in neutral_stretches(line).tolist()
    ]
    return joined(rows)
