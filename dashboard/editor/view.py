"""The scenario's editor, a drawer beside every page: groups of fields, tables, the line as it can be dragged."""

from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from typing import TYPE_CHECKING, Any

import panel as pn
import panel_material_ui as pmui

from railjoule.core.scenario import preset_document, preset_names
from railjoule.core.scenario.presets import PresetKind
from railjoule.dashboard.browser import Browser, one_message
from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.drawing import DrawingQueue
from railjoule.dashboard.editor.fields_of import NO, YES, Field, Table, parts_of
from railjoule.dashboard.editor.forms import EditorHead, TableForm
from railjoule.dashboard.editor.model import GROUPS, WHOLE_TABLES, Look, Refusal
from railjoule.dashboard.editor.profile_charts import LimitStepsChart, ProfileChart
from railjoule.dashboard.library_workarounds import SmallFile
from railjoule.dashboard.look import words
from railjoule.dashboard.look.key_names import without_keys, words_of
from railjoule.dashboard.look.markup import Markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.words import failure_words
from railjoule.dashboard.parts.html import html_pane, markup, note_paragraphs, stack

if TYPE_CHECKING:
    from railjoule.dashboard.workbench import Workbench

# below the bar of the pages, 48 px and a hairline; as high as Material's bars (1100), below its menus (1300)
WIDTH_PX, BAR_PX, LAYER = 520, 49, 1100
DRAWER_CSS = f"""
:host {{ position: fixed !important; right: 0; top: {BAR_PX}px !important; height: calc(100dvh - {BAR_PX}px) !important;
  width: min({WIDTH_PX}px, 100vw) !important; z-index: {LAYER}; overflow: hidden auto !important;
  background: var(--rj-surface); border-left: 1px solid var(--rj-line2); box-sizing: border-box; }}
:host > * {{ flex: none !important; }}
"""
"""The library sizes a column by what is in it; a drawer is as high as the window and scrolls."""
HEAD_CSS = ":host { position: sticky !important; top: 0 !important; z-index: 2; background: var(--rj-surface); }"
FIELDS_CSS = """
:host { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(200px, 100%), 1fr)); gap: 14px 8px;
  padding: 8px 12px 6px; box-sizing: border-box; align-items: start; }
"""
# twice the class, to count for more than the library's own rule
HELP_CSS = ".MuiFormHelperText-root.MuiFormHelperText-root { margin: 3px 2px 0; font-size: 12px; line-height: 1.3; }"
FOLD_SX = {
    "borderTop": "1px solid var(--rj-line)",
    "&::before": {"display": "none"},
    "& .title": {"fontSize": 12},
    "& .MuiAccordionSummary-root": {"minHeight": 37},
    "& .MuiAccordionSummary-content": {"marginY": "8px"},
    "& .MuiAccordionDetails-root": {"padding": "0 0 8px"},
}
FOLD: dict[str, Any] = {
    "margin": 0,
    "sizing_mode": "stretch_width",
    "elevation": 0,
    "square": True,
    "disable_gutters": True,
    "title_variant": "caption",
    "sx": FOLD_SX,
}
PROFILE_PX, LIMITS_PX = 150, 130
MAX_ROWS = 200
"""Longer tables show these; all of them can be pasted over."""
LARGEST_FILE_BYTES = LONGEST_BLOCK = 1_000_000
FILE_TOO_LARGE = "The file is larger than the limit of 1 MB. Nothing is changed."
SCENARIO_FIELDS = (
    "preset",
    "opened",
    "edits",
    "travel_time_s",
    "load_percent",
    "load_t",
    "recuperation_percent",
    "acceleration_time_s",
)
HEAD = """<div style="display:flex;align-items:center;font-size:13px"><b>{}</b>{}
<span class="muted small" style="margin-left:auto;padding:0 8px;font-weight:400">{}</span></div>"""
MORE_ROWS = "{} more rows are not shown; paste a table to replace them all."
OWN, NOT_SET = "Custom", "Not set"
PASTE = "Paste a table or open a CSV file"
PASTE_HELP = (
    "Tabs, semicolons or commas separate cells; the first row can name the columns. You can also paste a block "
    "directly into a cell."
)


class EditorView:
    """The drawer; its content is made when it is first opened, that of a group when the group is."""

    def __init__(self, state: "Workbench", browser: Browser, palette: Palette) -> None:
        self.state, self.editor, self.browser, self.palette = state, state.editor, browser, palette
        self.head: EditorHead | None = None
        self.groups: list[Group] = []
        self.folds: Any = None
        self._is_acting = False
        # assets/scripts finds the drawer by its name, and its focused field by its class
        self.view = stack(css=DRAWER_CSS, css_classes=["rj-editor"], visible=False, sizing_mode=None, name="editor")
        self.queue = DrawingQueue(browser, state.faults, lambda: self.editor.open, self._settle)
        self.editor.param.watch(self._turn, "open")
        self.editor.param.watch(self.redraw, "refused")
        state.scenario.param.watch(self.redraw, list(SCENARIO_FIELDS))
        state.param.watch(self._report_run, ["runs", "failure"])
        browser.follow(["charts_in_sight"], lambda: self.queue.sight(browser.charts_in_sight))

    def act(self, change: Callable[[], None]) -> None:
        """Change the scenario, and show the result even if nothing has changed: the browser shows a typed text."""
        with pn.io.hold():
            self._is_acting = True
            try:
                change()
            finally:
                self._is_acting = False
            self.redraw()

    def redraw(self, *_: Any) -> None:
        """Show the scenario in the groups that are open, and the changes of the others beside their names."""
        if not self.editor.open or self._is_acting:
            return
        look = self.editor.look()
        with pn.io.hold():
            for index, group in enumerate(self.groups):
                group.head.object = group.title(look)
                if index in self.folds.active:
                    group.show(look)
            assert self.head is not None
            # a table announces the refusals of its cells itself
            self.head.alert = " ".join(one.sentence for one in self.editor.refused.values() if one.row < 0)

    def _turn(self, *_: Any) -> None:
        with one_message():
            if self.head is None:
                self._make()
            assert self.head is not None
            self.browser.drawer = self.view.visible = self.head.open = self.editor.open
            self._report_run()
            self.redraw()
        self.queue.go_on()

    def _make(self) -> None:
        self.head = EditorHead(lambda _: setattr(self.editor, "open", False))
        self.track = LineGroup(self, "Track")
        self.groups = [self.track if name == self.track.name else Group(self, name) for name in GROUPS]
        self.queue.take(self.track.charts)
        self.folds = pmui.Accordion(*((group.head, group.body) for group in self.groups), **FOLD)
        self.folds.param.watch(self._unfold, "active")
        self.view[:] = [stack(self.head, css=HEAD_CSS), self.folds]

    def _settle(self) -> None:
        self.track.settle()

    def _unfold(self, *_: Any) -> None:
        with one_message():
            self.redraw()

    def _report_run(self, *_: Any) -> None:
        """Show the energy and time of the run, or why there is none."""
        run, failure = self.state.run, self.state.failure
        if self.head is None or not self.editor.open:
            return
        if failure is not None:
            self.head.status = without_keys(" ".join(failure_words(failure)))
        elif run is not None:
            name = words.STRATEGY_WORDS[self.state.chosen_now]
            self.head.status = f"{name}: {words.energy(run.energy_kwh)} kWh in {words.number(run.travel_time_s)} s"


class Group:
    """The fields and lists of some tables of the file."""

    def __init__(self, parent: EditorView, name: str) -> None:
        self.parent, self.editor, self.name = parent, parent.editor, name
        self.head = html_pane()
        # without a name, which the library would show in place of the head
        self.body = stack(name="")
        self._shape: object = None
        self._fields: list[FieldForm] = []
        self._tables: list[tuple[TableForm, Table]] = []

    def title(self, look: Look) -> Markup:
        """Return the heading of the group, with the number of changed keys."""
        keys = [part.key for _, parts in self.editor.parts(self.name, look.now) for part in parts]
        count = sum(
            any(key == change or (change not in WHOLE_TABLES and key.startswith(f"{change}.")) for key in keys)
            for change in look.changes
        )
        vehicle, line = look.now.vehicle, look.now.line
        notes = {"Powertrain": words_of(vehicle.drive.model), "Track": f"{words.number(line.length_m, 0)} m"}
        note = ", ".join(filter(None, [notes.get(self.name), f"{count} changed" if count else ""]))
        return markup(HEAD, self.name, Markup("<i class=dot></i>") if count else "", note)

    def show(self, look: Look) -> None:
        """Show the scenario; the parts are made again only where others are needed, as one of them has the focus."""
        groups = self.editor.parts(self.name, look.now)
        shape = [(heading, [part.key for part in parts]) for heading, parts in groups]
        if shape != self._shape:
            self._shape = shape
            self._fields, self._tables = [], []
            self.body[:] = self.contents(groups)
        for form in self._fields:
            form.show(look)
        for table_form, table in self._tables:
            table_form.show(table_entry(table, look, self.editor.refused.get(table.key)))

    def contents(self, groups: Sequence[tuple[str, Sequence[Field | Table]]]) -> list[Any]:
        """Return the fields and the tables under their headings."""
        made: list[Any] = []
        for heading, parts in groups:
            fields = [FieldForm(self.parent, part) for part in parts if isinstance(part, Field)]
            tables = [part for part in parts if isinstance(part, Table)]
            forms = [TableForm(partial(self._change_rows, table)) for table in tables]
            self._fields += fields
            self._tables += zip(forms, tables, strict=True)
            if heading:
                made.append(html_pane(markup('<h4 class="section" style="margin:0;padding-left:8px">{}</h4>', heading)))
            if fields:
                made.append(stack(*(form.view for form in fields), css=FIELDS_CSS))
            made += forms
        return [*made, self._paste_form()] if self._tables else made

    def _paste_form(self) -> pmui.Accordion:
        """Return the fields that replace all rows of a table, by a pasted block or a file."""
        tables = {table.label: table for _, table in self._tables}

        def replace(text: str) -> None:
            self.parent.act(lambda: self.editor.change_rows(tables[which.value], "replace", text=text))

        def refuse() -> None:
            table = tables[which.value]
            refusal = Refusal("", FILE_TOO_LARGE)
            self.parent.act(lambda: self.editor.param.update(refused={**self.editor.refused, table.key: refusal}))

        common: dict[str, Any] = {"size": "small", "margin": (6, 8), "sizing_mode": "stretch_width"}
        which = pmui.Select(label="Table", options=list(tables), visible=len(tables) > 1, **common)
        block = pmui.TextAreaInput(
            label="Cells of a spreadsheet", helper_text=PASTE_HELP, max_length=LONGEST_BLOCK, rows=3, **common
        )
        button = pmui.Button(
            label="Replace all rows", variant="text", on_click=lambda _: replace(block.value), **common
        )
        file = SmallFile(
            refuse,
            label="Open a CSV file",
            accept=".csv,.tsv,.txt",
            variant="text",
            max_file_size=LARGEST_FILE_BYTES,
            **common,
        )

        def read(event: Any) -> None:
            if event.new:
                replace(event.new.decode(errors="replace"))

        file.param.watch(read, "value")
        content = stack(which, block, pn.Row(button, file, margin=0, sizing_mode="stretch_width"))
        return pmui.Accordion((PASTE, content), **FOLD)

    def _change_rows(self, table: Table, message: Mapping[str, Any]) -> None:
        row, column = int(message.get("row") or 0), int(message.get("column") or 0)
        what, text = str(message.get("what")), str(message.get("text", ""))
        # what the browser sends may be about a row that a step back has just taken away
        count = len(self.editor.look().rows(table))
        if not (0 <= row < max(count, 1) and 0 <= column < len(table.columns)):
            return
        if what == "back":
            self.parent.act(lambda: self.editor.take_back(table))
        else:
            self.parent.act(lambda: self.editor.change_rows(table, what, row, column, text))


class FieldForm:
    """A field as a stock widget: its help or its refusal stands under it, and a button beside it resets it."""

    def __init__(self, parent: EditorView, field: Field) -> None:
        self.parent, self.editor, self.field = parent, parent.editor, field
        kind = pmui.Select if field.kind in {"choice", "yes_no"} else pmui.TextInput
        self.widget = kind(size="small", margin=0, sizing_mode="stretch_width", stylesheets=[HELP_CSS])
        self.back: pmui.IconButton | None = None
        self.view = pn.Row(self.widget, margin=0, sizing_mode="stretch_width")
        self._text = self.widget.value
        self.widget.param.watch(self._type, "value")

    def show(self, look: Look) -> None:
        """Show the value of the scenario, or a refused text with the sentence."""
        field, refusal = self.field, self.editor.refused.get(self.field.key)
        options = field_options(field, look)
        is_changed = field.key in look.changes
        self._text = look.text(field) if refusal is None else refusal.text
        shown: dict[str, Any] = {
            "label": f"{field.label} \u00b7 changed" if is_changed else field.label,
            "helper_text": field.help_words if refusal is None else refusal.sentence,
            "error_state": refusal is not None,
            "value": self._text,
        }
        if options:
            shown["options"] = options
        self.widget.param.update(**{name: new for name, new in shown.items() if getattr(self.widget, name) != new})
        if is_changed:
            was = look.was(field)
            was = next((word for word, value in options.items() if value == was), was)
            # made when it is first needed: a group may have some forty fields
            self.back = self.back or pmui.IconButton(icon="undo", size="small", margin=(4, 0), on_click=self._reset)
            self.back.description = f"Reset {field.label} to {was or 'empty'}"
        if is_changed != (len(self.view) > 1):
            self.view[:] = [self.widget, self.back] if is_changed else [self.widget]

    def _type(self, event: Any) -> None:
        # the field's own text is no news
        if event.new != self._text:
            self.parent.act(lambda: self.editor.type(self.field, event.new))

    def _reset(self, *_: Any) -> None:
        self.widget.focus()
        self.parent.act(lambda: self.editor.take_back(self.field))


class LineGroup(Group):
    """The line: as it can be dragged, then its fields and lists."""

    def __init__(self, parent: EditorView, name: str) -> None:
        super().__init__(parent, name)
        self.axis = Axis(parent.palette)
        palette, tables = parent.palette, {part.key: part for part in parts_of("line") if isinstance(part, Table)}
        sections, limits = tables["line.sections"], tables["line.speed_limits"]

        def drop(change: Callable[..., None], *columns: Sequence[float]) -> None:
            parent.act(lambda: change(*columns))

        move_borders = partial(drop, partial(self.editor.move_borders, sections))
        move_limits = partial(drop, partial(self.editor.move_limits, sections, limits))
        self.profile = ProfileChart(PROFILE_PX, self.axis, palette, move_borders)
        self.steps = LimitStepsChart(LIMITS_PX, self.axis, palette, move_limits)
        self.charts: tuple[Chart, ...] = (self.profile, self.steps)
        self.way = html_pane()

    def contents(self, groups: Sequence[tuple[str, Sequence[Field | Table]]]) -> list[Any]:
        """Return the charts, then the fields and the tables."""

        def bring(*_: Any) -> None:
            # the editor would cover half of the page that reads tables
            self.editor.open = False
            self.parent.state.page = "Files"

        label, margin = "Import tables of a line", (0, 8, 4, 0)
        button = pmui.Button(label=label, variant="text", size="small", margin=margin, on_click=bring)
        charts = stack(*(chart.host for chart in self.charts), css=":host { padding: 0 8px 8px 0; }")
        return [button, charts, self.way, *super().contents(groups)]

    def show(self, look: Look) -> None:
        """Show the scenario."""
        super().show(look)
        line, most = look.now.line, look.now.vehicle.traction.max_speed_kmh
        self.axis.fit(line.length_m, roomy=False)
        self.profile.show(partial(self.profile.draw, line))
        self.steps.show(partial(self.steps.draw, line, most))
        turned = "Charts and tables show the track as in its file; the train runs from its end to its start."
        self.way.object = note_paragraphs([turned], "padding-left:8px") if line.reverse else ""
        self.settle()

    def settle(self) -> None:
        """Update the shared cursor of both charts once they were drawn."""
        self.axis.settle("m", 0)


@cache
def preset_titles(kind: PresetKind) -> dict[str, str]:
    """Return the names of shipped vehicles or lines by their titles."""
    return {str(preset_document(kind, name)["name"]): name for name in preset_names(kind)}


def field_options(field: Field, look: Look) -> dict[str, str]:
    """Return the choices of a field by their words; nothing where it is typed."""
    if field.kind == "yes_no":
        return {"Yes": YES[0], "No": NO[0]}
    if field.key not in {"vehicle", "line"}:
        empty = {NOT_SET: ""} if field.optional and field.choices else {}
        return {**empty, **{words_of(choice): choice for choice in field.choices}}
    own, used = getattr(look.base, field.key), getattr(look.now, field.key)
    custom = used if used.preset is None else own
    first = {f"{OWN}: {custom.name}" if custom.name else OWN: ""} if custom.preset is None else {}
    return {**first, **preset_titles("vehicles" if field.key == "vehicle" else "lines")}


def table_entry(table: Table, look: Look, refusal: Refusal | None) -> dict[str, Any]:
    """Return the browser's view of a list."""
    rows = look.rows(table)
    beyond = len(rows) - MAX_ROWS
    return {
        "label": table.label,
        "help": table.help,
        "columns": [
            {"label": column.label, "help": column.help_words, "kind": column.kind, "choices": list(column.choices)}
            for column in table.columns
        ],
        "rows": [[column.show(row.get(column.name)) for column in table.columns] for row in rows[:MAX_ROWS]],
        "more": MORE_ROWS.format(words.number(beyond, 0)) if beyond > 0 else "",
        "changed": table.key in look.changes,
        "refusal": None if refusal is None else vars(refusal),
    }
