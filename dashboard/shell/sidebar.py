"""The sidebar: which scenario, the plan, the fields of the page in sight, the strategies, the changed fields."""

from functools import cache, partial
from typing import Any

import panel as pn
import param
from panel.viewable import Viewable

from railjoule.core import RailjouleError
from railjoule.core.motion.line_profile import neutral_stretches
from railjoule.core.scenario import load_scenario
from railjoule.dashboard.browser import Browser, one_message, unfrozen
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.look import words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.page import Hint, Own, Page, Section
from railjoule.dashboard.page_list import PAGES
from railjoule.dashboard.pages.start.compute import card_names, scenario_groups
from railjoule.dashboard.parts.choices import box, menu
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.parts.number_field import LoadField, NumberField
from railjoule.dashboard.shell.share import SaveScenario
from railjoule.dashboard.shell.strategies import StrategyList
from railjoule.dashboard.state.kept import short
from railjoule.dashboard.state.numbers import TypedNumber
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.workbench import Workbench

FIELDS_AFTER_MS = 200
FROM_FILE = "file"
"""The value of a scenario from a file begins with this; its number distinguishes it from the one opened before."""
NOT_SHOWN = "These fields could not be shown because of a program error; the server\u2019s log describes it."
BUTTONS = Markup(
    '<div class="asks">'
    '<button type="button" class="text-button" data-ask="file">Open file</button>'
    '<button type="button" class="text-button" data-ask="import">Import line or train</button>'
    '<button type="button" class="text-button" data-ask="edit">Edit scenario</button>'
    '<button type="button" class="text-button" data-ask="save_scenario">Save scenario</button></div>'
)
SELECT_CSS = """
select:not([multiple]).bk-input { height: 40px; padding-right: 30px; text-overflow: ellipsis; color: var(--rj-ink);
  /* Bokeh's own mark of a menu is black, in the dark theme too */
  background: linear-gradient(45deg, transparent 50%, var(--rj-ink) 50%) right 15px center / 5px 5px no-repeat,
  linear-gradient(-45deg, transparent 50%, var(--rj-ink) 50%) right 10px center / 5px 5px no-repeat; }
select.bk-input option, select.bk-input optgroup { color: var(--rj-ink); background: var(--rj-surface); }
"""
PLAN = '<div class="section">Plan <span>\u00b7 what the timetable expects</span></div>'
UNCHANGED = Markup('<hr class="rule"><div class="row small" style="padding-top:8px"><span>Unchanged</span></div>')
CHANGED = (
    '<hr class="rule"><div class="asks"><button type="button" class="text-button" data-ask="changes" '
    'aria-expanded="{opened}">{count} field{plural} changed {sign}</button>'
    '<button type="button" class="text-button" data-ask="undo_all">Undo all</button></div>{rows}'
)
CHANGE = (
    '<div class="row small changed"><span>{key}<br>{before} \u2192 {now}</span>'
    '<button type="button" class="text-button" data-ask="take_back" data-name="{key}" aria-label="Undo {key}">Undo'
    "</button></div>"
)


class Sidebar:
    """The scenario beside the pages."""

    def __init__(self, state: Workbench, browser: Browser, keeping: Keeping) -> None:
        self.state = state
        scenario = state.scenario
        self.preset = pn.widgets.Select(
            label="Scenario",
            groups=scenario_options(state),
            value=scenario.preset,
            margin=(12, 16, 0, 16),
            sizing_mode="stretch_width",
            stylesheets=[SELECT_CSS],
        )
        self.travel_time = NumberField(scenario, "travel_time_s", ends=scenario.travel_time_range_s)
        self.own = stack()
        """The fields of pages that were in sight; those of the others are not made yet."""
        self.line = html_pane()
        self.strategies = StrategyList(state)
        self.changes = Changes(state, browser)
        self.load = LoadField(scenario, "load_percent", ["preset", "opened", "edits", "travel_time_range_s"])
        self.load_t = NumberField(scenario, "load_t")
        self.plan = stack(
            html_pane(PLAN),
            self.travel_time,
            self.load,
            self.load_t,
            NumberField(scenario, "recuperation_percent"),
        )
        self.view = stack(
            self.preset,
            html_pane(BUTTONS),
            self.plan,
            self.own,
            self.line,
            self.strategies,
            self.changes.view,
        )
        self.saving = SaveScenario(state, browser, keeping, self.view)
        self._own: dict[str, Viewable] = {}
        self._quiet, self._opened = False, 0
        browser.listen("import", lambda _: setattr(state, "page", "Files"))
        browser.listen("edit", lambda _: setattr(state.editor, "open", not state.editor.open))
        self.preset.param.watch(self._choose, "value")
        scenario.param.watch(self._name_scenario, ["preset", "opened"])
        scenario.param.watch(self._describe, ["preset", "opened", "edits"])
        scenario.param.watch(self._move_ends, "travel_time_range_s")
        state.param.watch(self._show_runs, "runs")
        state.param.watch(self._fit_page, "page")
        self._name_scenario()
        self._fit_page()
        self._describe()
        self._show_runs()

    def _fit_page(self, *_: Any) -> None:
        """Show the fields of the page in sight, and leave out what changes nothing on it."""
        page = self.state.page
        self.plan.visible = PAGES[page].has_plan
        self.strategies.visible = bool(PAGES[page].strategies)
        for name, view in self._own.items():
            view.visible = name == page
        if page in self._own or not self.state.pages[page].fields:
            return
        document = pn.state.curdoc
        if document is None:
            self._add_fields(page)
        else:
            # the page itself comes first
            document.add_timeout_callback(lambda: self._add_fields(page), FIELDS_AFTER_MS)

    def _add_fields(self, page: str) -> None:
        if page in self._own:
            return
        with one_message():
            try:
                with unfrozen():
                    view = page_fields(self.state.pages[page])
            except Exception as error:
                self.state.faults.note(error, f"the fields of {page} could not be shown")
                view = html_pane(markup('<p class="error" role="alert">{}</p>', NOT_SHOWN))
            self._own[page] = view
            view.visible = page == self.state.page
            self.own.append(view)

    def _choose(self, event: Any) -> None:
        if not self._quiet and not event.new.startswith(FROM_FILE):
            self.state.scenario.choose(event.new)

    def _name_scenario(self, *events: Any) -> None:
        """Show in the list which scenario this is."""
        opened = self.state.scenario.opened
        self._opened += opened is not None
        file = f"{FROM_FILE} {self._opened}"
        value = self.state.scenario.preset if opened is None else file
        if not events and value == self.preset.value:
            return
        # or `_choose` would take the shipped scenario again, without what was edited in it
        self._quiet = True
        with pn.io.hold():
            # both together, as a value must be among the options
            self.preset.param.update(groups=scenario_options(self.state, file), value=value)
        self._quiet = False

    def _move_ends(self, *_: Any) -> None:
        self.travel_time.set_ends(self.state.scenario.travel_time_range_s)

    def _describe(self, *_: Any) -> None:
        """Name the vehicle, show its load in its own unit, and describe the line."""
        in_tonnes = self.state.scenario.loads_in_tonnes
        self.load.visible, self.load_t.visible = not in_tonnes, in_tonnes
        self.line.object = markup(
            '<div class="section">Vehicle <span>\u00b7 {}</span></div><div class="section">Track</div>{}'
            '<hr class="rule">',
            self.state.scenario.edited.vehicle.name,
            line_rows(self.state),
        )

    def _show_runs(self, *_: Any) -> None:
        runs = self.state.runs
        if runs is not None:
            self.travel_time.hint = f"shortest possible {words.number(runs.shortest_time_s)} s"


class Changes:
    """How many fields differ from the preset, which, and a way back for each; the list opens at a press."""

    def __init__(self, state: Workbench, browser: Browser) -> None:
        self.state, self.opened = state, False
        self.view = html_pane()
        browser.listen("changes", lambda _: self._turn())
        browser.listen("undo_all", lambda _: state.scenario.restore())
        browser.listen("take_back", lambda message: self._take_back(str(message.get("name"))))
        state.scenario.param.watch(self._show, ["preset", "opened", *RUN_FIELDS])
        self._show()

    def _turn(self) -> None:
        self.opened = not self.opened
        self._show()

    def _show(self, *_: Any) -> None:
        changes, original = self.state.scenario.changes, self.state.scenario.original
        if not changes:
            self.opened = False
            self.view.object = UNCHANGED
            return
        rows = (
            markup(CHANGE, key=key, before=short(original(key)), now=short(value)) for key, value in changes.items()
        )
        self.view.object = markup(
            CHANGED,
            opened=str(self.opened).lower(),
            count=len(changes),
            plural="" if len(changes) == 1 else "s",
            sign="\u25b4" if self.opened else "\u25be",
            rows=joined(rows) if self.opened else "",
        )

    def _take_back(self, key: str) -> None:
        if key not in self.state.scenario.changes:
            return
        try:
            self.state.scenario.take_back(key)
        except RailjouleError as refusal:
            self.state.failure = refusal


@cache
def shipped_scenarios() -> dict[str, dict[str, str]]:
    """Return the names of the shipped scenarios by their titles, in the groups of the page Start."""
    return {
        title: {load_scenario(name).title: name for name in names} for title, _, names in scenario_groups(card_names())
    }


def scenario_options(state: Workbench, file: str = FROM_FILE) -> dict[str, dict[str, str]]:
    """Return the scenarios to choose from, that of a file included under a value of its own."""
    opened = state.scenario.opened
    if opened is None:
        return shipped_scenarios()
    return {"From a file": {f"{opened.title or 'Untitled'} (file)": file}, **shipped_scenarios()}


def _field(page: Page, spec: str | Section | Hint | Own) -> Viewable:
    if isinstance(spec, Own):
        return spec.make(page)
    if isinstance(spec, Section):
        aside = markup(" <span>\u00b7 {}</span>", spec.aside) if spec.aside else ""
        return html_pane(markup('<div class="section">{}{}</div>', spec.title, aside))
    if isinstance(spec, Hint):
        return html_pane(markup('<div class="row small"><span>{}{}</span></div>', spec.sentence, info(spec.term)))
    declared = page.param[spec]
    if isinstance(declared, TypedNumber):
        return NumberField(page, spec)
    if isinstance(declared, param.Selector):
        return menu(page, spec, declared.label, page.choices.get(spec) or {str(one): one for one in declared.objects})
    return box(page, spec, declared.label, margin=(0, 16, 0, 14))


def page_fields(page: Page) -> Viewable:
    """Return the fields of a page, below one another."""
    return stack(*(_field(page, spec) for spec in page.fields), html_pane('<hr class="rule">'))


def line_rows(state: Workbench) -> Markup:
    """Describe the line, in rows."""
    permille = partial(words.tenths, number=words.signed)
    line = state.scenario.edited.line.in_running_order()
    gradients = [section.gradient_permille for section in line.sections]
    if min(gradients) == max(gradients):
        level = "level" if gradients[0] == 0 else f"{permille(gradients[0])} {words.PER_MILLE}"
    else:
        level = f"{permille(min(gradients))} to {permille(max(gradients))} {words.PER_MILLE}"
    stretches: list[tuple[str, float, float]] = [
        *((f"Limit {words.tenths(one.limit_kmh)} km/h", one.from_m, one.to_m) for one in line.speed_limits),
        *(("Traction limit", one.from_m, one.to_m) for one in line.traction_limits),
        *((f"{one.condition.capitalize()} rails", one.from_m, one.to_m) for one in line.rail_conditions),
        *(("Neutral section", *ends) for ends in neutral_stretches(line).tolist()),
    ]
    row = '<div class="row"><span>{}</span><span>{}\u2013{} m</span></div>'
    return joined(
        [
            markup('<div class="row"><span>{} km, {}</span></div>', words.distance(line.length_m), level),
            *(markup(row, name, words.tenths(begin), words.tenths(end)) for name, begin, end in stretches),
        ]
    )
