"""The scenario's editor, a drawer beside every page: groups of fields, tables, the line as it can be dragged."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.browser.messages import one_message
from railjoule.dashboard.charts.chart import Axis, Chart
from railjoule.dashboard.charts.drawing import DrawingQueue
from railjoule.dashboard.editor.fields_of import Field, Table, parts_of
from railjoule.dashboard.editor.forms import Disclosure, EditorHead, FieldsForm, TableForm
from railjoule.dashboard.editor.model import GROUPS, Look, Refusal, drive_kinds, preset_options
from railjoule.dashboard.editor.profile_charts import LimitStepsChart, ProfileChart
from railjoule.dashboard.look import words
from railjoule.dashboard.look.key_names import without_keys, words_of
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.parts.failures import failure_words
from railjoule.dashboard.parts.html import html_pane, markup, note_paragraphs, stack
from railjoule.dashboard.state.workbench import Workbench

# beneath the bar of the pages, 48 px and a hairline; as high as Material's bars (1100), below its menus (1300)
WIDTH_PX, BAR_PX, LAYER = 520, 49, 1100
DRAWER_CSS = f"""
:host {{ position: fixed !important; right: 0; top: {BAR_PX}px !important; height: calc(100dvh - {BAR_PX}px) !important;
  width: min({WIDTH_PX}px, 100vw) !important; z-index: {LAYER}; overflow: hidden auto !important;
  background: var(--rj-surface); border-left: 1px solid var(--rj-line2); box-sizing: border-box; }}
:host > * {{ flex: none !important; }}
"""
"""The library sizes a column by what is in it; a drawer is as high as the window and scrolls."""
HEAD_CSS = ":host { position: sticky !important; top: 0 !important; z-index: 2; background: var(--rj-surface); }"
PROFILE_PX, LIMITS_PX = 150, 130
MAX_ROWS = 60
"""Longer tables show these; all of them can be pasted over."""
SCENARIO_FIELDS = (
    "preset",
    "opened",
    "edits",
    "travel_time_s",
    "load_percent",
    "recuperation_percent",
    "acceleration_time_s",
)
MORE_ROWS = "{} more rows are not shown; paste a table to replace them all."
OWN, NOT_SET = "Custom", "Not set"
# abbreviations, of which `words_of` would make Eoc and Enoc
HEADINGS = {"eoc": words.STRATEGY_WORDS["eoc"], "enoc": words.STRATEGY_WORDS["enoc"]}
CHOICES = {"vehicle": "Vehicle", "line": "Line"}
Entry = dict[str, Any]


class EditorView:
    """The drawer; its content is made when it is first opened, that of a group when the group is."""

    def __init__(self, state: Workbench, browser: Browser, palette: Palette) -> None:
        self.state, self.editor, self.browser, self.palette = state, state.editor, browser, palette
        self.head: EditorHead | None = None
        self.groups: list[Group] = []
        # assets/scripts knows the drawer by its name, and what has the focus in it by its class
        self.view = stack(css=DRAWER_CSS, css_classes=["rj-editor"], visible=False, sizing_mode=None, name="editor")
        self.queue = DrawingQueue(browser, state.faults, lambda: self.editor.open, self._settle)
        self.editor.param.watch(self._turn, "open")
        self.editor.param.watch(self._show, "refused")
        state.scenario.param.watch(self._show, list(SCENARIO_FIELDS))
        state.param.watch(self._tell, ["runs", "failure"])
        browser.follow(["charts_in_sight"], lambda: self.queue.sight(browser.charts_in_sight))

    def redraw(self) -> None:
        """Draw everything again, as after a change of theme."""
        self._show()

    def _turn(self, *_: Any) -> None:
        with one_message():
            if self.head is None:
                self._make()
            assert self.head is not None
            self.browser.drawer = self.view.visible = self.head.open = self.editor.open
            self._tell()
            self._show()
        self.queue.go_on()

    def _make(self) -> None:
        self.head = EditorHead(self._close)
        kinds: Mapping[str, type[Group]] = {"Presets": PresetsGroup, "Powertrain": DriveGroup, "Track": LineGroup}
        self.groups = [kinds.get(name, Group)(self, name) for name in GROUPS]
        self.queue.take(tuple(chart for group in self.groups for chart in group.charts))
        self.view[:] = [stack(self.head, css=HEAD_CSS), *(group.view for group in self.groups)]

    def _close(self, *_: Any) -> None:
        self.editor.open = False

    def _show(self, *_: Any) -> None:
        if not self.editor.open:
            return
        look = self.editor.look()
        with pn.io.hold():
            for group in self.groups:
                group.show(look)

    def _tell(self, *_: Any) -> None:
        """Show the energy and time of the run, or why there is none."""
        run, failure = self.state.run, self.state.failure
        if self.head is None or not self.editor.open:
            return
        if failure is not None:
            self.head.status = without_keys(" ".join(failure_words(failure)))
        elif run is not None:
            name = words.STRATEGY_WORDS[self.state.chosen_now]
            self.head.status = f"{name}: {words.energy(run.energy_kwh)} kWh in {words.number(run.travel_time_s)} s"

    def _settle(self) -> None:
        for group in self.groups:
            group.settle()


class Group:
    """A heading with the fields and lists of some tables of the file."""

    def __init__(self, parent: EditorView, name: str) -> None:
        self.parent, self.editor, self.name = parent, parent.editor, name
        self.head = Disclosure(self._turn, label=name)
        self.body = stack(visible=False)
        self.view = stack(self.head, self.body)
        self._shape: object = None
        self._forms: list[tuple[FieldsForm, list[Field]]] = []
        self._tables: list[tuple[TableForm, Table]] = []

    def _turn(self) -> None:
        with pn.io.hold():
            # before it is shown, as a group that is closed shows nothing
            self.head.open = self.body.visible = not self.head.open
            self.show(self.editor.look())

    def keys(self, look: Look) -> list[str]:
        """Return the keys that were edited in this group."""
        beginnings = tuple(f"{table}." for table in GROUPS[self.name])
        # tables within those of this group may have a group of their own, as vehicle.resistance has
        others = tuple(f"{table}." for name, tables in GROUPS.items() if name != self.name for table in tables)
        inner = tuple(other for other in others if other.startswith(beginnings)) if beginnings else ()
        return [key for key in look.changes if key.startswith(beginnings) and not (inner and key.startswith(inner))]

    def note(self, look: Look) -> str:
        """Return what is in the group, in a few words."""
        return ""

    def show(self, look: Look) -> None:
        """Show the scenario; what is closed shows only whether anything in it was changed."""
        count = len(self.keys(look))
        changed = f"{count} changed" if count else ""
        self.head.param.update(changed=count > 0, note=", ".join(filter(None, [self.note(look), changed])))
        if not self.head.open:
            return
        shape = self.shape(look)
        # else the forms stay, and with them the focus of who types
        if shape != self._shape:
            self._shape = shape
            self._forms, self._tables = [], []
            self.body[:] = self.contents(look)
        for form, fields in self._forms:
            form.show([self.entry(field, look) for field in fields])
        for table_form, table in self._tables:
            table_form.show(self.table_entry(table, look))

    def shape(self, look: Look) -> object:
        """Return what the group's contents depend on, apart from their values."""
        return [heading for table in GROUPS[self.name] for heading, _ in self.editor.parts(table, look.now)]

    def contents(self, look: Look) -> list[Any]:
        """Return forms and tables, with headings where there are several tables of the file."""
        made: list[Any] = []
        several = len(GROUPS[self.name]) > 1
        for table in GROUPS[self.name]:
            for heading, parts in self.editor.parts(table, look.now):
                text = heading or (HEADINGS.get(table, words_of(table)) if several else "")
                if text:
                    template = '<h4 class="section" style="margin:0;padding-left:32px">{}</h4>'
                    made.append(html_pane(markup(template, text)))
                made += self.forms(parts)
        return made

    def forms(self, parts: Sequence[Field | Table]) -> list[Any]:
        """Return a form of the fields, then one for each list."""
        fields = [part for part in parts if isinstance(part, Field)]
        form = FieldsForm(partial(self._hear, {field.key: field for field in fields}))
        self._forms.append((form, fields))
        return [form, *(self.table_form(part) for part in parts if isinstance(part, Table))]

    def table_form(self, table: Table) -> TableForm:
        """Return the form of a list."""
        form = TableForm(partial(self._hear_table, table))
        self._tables.append((form, table))
        return form

    def entry(self, field: Field, look: Look) -> Entry:
        """Return what the browser shows of a field."""
        refusal: Refusal | None = self.editor.refused.get(field.key)
        return {
            "key": field.key,
            "kind": field.kind,
            "label": field.label,
            "help": field.help_words,
            "choices": [
                *([["", NOT_SET]] if field.optional else []),
                *([choice, words_of(choice)] for choice in field.choices),
            ],
            "text": look.text(field) if refusal is None else refusal.text,
            "sentence": "" if refusal is None else refusal.sentence,
            "changed": field.key in look.changes,
            "was": look.was(field),
        }

    def table_entry(self, table: Table, look: Look) -> Entry:
        """Return what the browser shows of a list."""
        rows = look.rows(table)
        refusal: Refusal | None = self.editor.refused.get(table.key)
        beyond = len(rows) - MAX_ROWS
        return {
            "key": table.key,
            "label": table.label,
            "help": table.help,
            "columns": [
                {"label": column.label, "help": column.help_words, "kind": column.kind, "choices": list(column.choices)}
                for column in table.columns
            ],
            "rows": [[column.show(row.get(column.name)) for column in table.columns] for row in rows[:MAX_ROWS]],
            "more": MORE_ROWS.format(words.number(beyond, 0)) if beyond > 0 else "",
            "changed": table.key in look.changes,
            "refusal": None
            if refusal is None
            else {
                "row": refusal.row,
                "column": refusal.column,
                "text": refusal.text,
                "sentence": refusal.sentence,
            },
        }

    @property
    def charts(self) -> tuple[Chart, ...]:
        """The charts of the group."""
        return ()

    def settle(self) -> None:
        """Tell a shared cursor of charts that were drawn; called last within a message."""

    def _hear(self, fields: Mapping[str, Field], message: Mapping[str, Any]) -> None:
        key, text = str(message.get("key")), str(message.get("text", ""))
        if key in fields:
            self._then_show(
                partial(self.editor.take_back, key)
                if message.get("what") == "back"
                else partial(self.editor.type, fields[key], text)
            )

    def _hear_table(self, table: Table, message: Mapping[str, Any]) -> None:
        editor, what = self.editor, str(message.get("what"))
        row, column, text = (
            int(message.get("row", 0)),
            int(message.get("column", 0)),
            str(message.get("text", "")),
        )
        # what the browser sends may be about a row that a step back has just taken away
        there = len(editor.look().rows(table))
        if not (0 <= row < max(there, 1) and 0 <= column < len(table.columns)):
            return
        acts: Mapping[str, Callable[[], None]] = {
            "cell": partial(editor.type_cell, table, row, column, text),
            "insert": partial(editor.insert, table, row),
            "remove": partial(editor.remove, table, row),
            "up": partial(editor.move, table, row, -1),
            "down": partial(editor.move, table, row, 1),
            "paste": partial(editor.paste, table, text, row, column),
            "paste_all": partial(editor.paste, table, text),
            "back": partial(editor.take_back, table.key),
        }
        if what in acts:
            self._then_show(acts[what])

    def _then_show(self, act: Callable[[], None]) -> None:
        """Handle a message, and show the result even if nothing changed."""
        with pn.io.hold():
            act()
            self.show(self.editor.look())


class ChoosingGroup(Group):
    """A group that begins with choices of whole tables."""

    def choices(self, look: Look) -> list[Entry]:
        """Return what the browser shows of the choices."""
        raise NotImplementedError

    def choose(self, key: str, value: str) -> None:
        """Take a choice."""
        raise NotImplementedError

    def contents(self, look: Look) -> list[Any]:
        """Return the choices, then what a group has."""
        self._choices = FieldsForm(self._hear_choice)
        return [self._choices, *super().contents(look)]

    def show(self, look: Look) -> None:
        """Show the scenario."""
        super().show(look)
        if self.head.open:
            self._choices.show(self.choices(look))

    def _hear_choice(self, message: Mapping[str, Any]) -> None:
        value = "" if message.get("what") == "back" else str(message.get("text", ""))
        self._then_show(partial(self.choose, str(message.get("key")), value))

    def choice(self, key: str, label: str, about: str, options: Sequence[tuple[str, str]], now: str, was: str) -> Entry:
        """Return what the browser shows of one choice."""
        refusal: Refusal | None = self.editor.refused.get(key)
        return {
            "key": key,
            "kind": "choice",
            "label": label,
            "help": about,
            "choices": [list(option) for option in options],
            "text": now,
            "sentence": "" if refusal is None else refusal.sentence,
            "changed": key in self.editor.scenario.changes,
            "was": was,
        }


class PresetsGroup(ChoosingGroup):
    """Which shipped vehicle runs on which line."""

    def keys(self, look: Look) -> list[str]:
        """Return the choices that were made."""
        return [key for key in ("vehicle", "line", "title") if key in look.changes]

    def contents(self, look: Look) -> list[Any]:
        """Return the choices and the title."""
        return [*super().contents(look), *self.forms([part for part in parts_of("") if part.key == "title"])]

    def choices(self, look: Look) -> list[Entry]:
        """Return vehicle and line."""
        base = self.editor.scenario.base
        made = []
        for key, kind, about in (
            ("vehicle", "vehicles", "A shipped vehicle with its powertrain; the load is kept."),
            ("line", "lines", "A shipped line with its limits and stations."),
        ):
            options = [(name, title) for title, name in preset_options(kind).items()]  # type: ignore[arg-type]
            own, used = getattr(base, key), getattr(look.now, key)
            custom = used if used.preset is None else own
            if custom.preset is None:
                options = [("", f"{OWN}: {custom.name}" if custom.name else OWN), *options]
            titles = dict(options)
            was = titles.get(own.preset, "") if own.preset else own.name or OWN
            made.append(self.choice(key, CHOICES[key], about, options, used.preset or "", was))
        return made

    def choose(self, key: str, value: str) -> None:
        """Take a shipped vehicle or line; its own again where none is named."""
        if key in CHOICES:
            self.editor.choose("vehicles" if key == "vehicle" else "lines", value)


class DriveGroup(ChoosingGroup):
    """The drive: which kind, then its fields."""

    def note(self, look: Look) -> str:
        """Return the kind."""
        return words_of(look.now.vehicle.drive.model)

    def shape(self, look: Look) -> object:
        """Return the kind: each has other fields."""
        return look.now.vehicle.drive.model, super().shape(look)

    def choices(self, look: Look) -> list[Entry]:
        """Return the kinds."""
        options = [(kind, words_of(kind)) for kind in drive_kinds()]
        now, was = look.now.vehicle.drive.model, self.editor.scenario.base.vehicle.drive.model
        about = "A new kind starts with the values of a shipped vehicle that has it, or with assumed ones."
        return [self.choice("drive", "Kind", about, options, now, words_of(was))]

    def choose(self, key: str, value: str) -> None:
        """Take a drive of another kind; the scenario's own where none is named."""
        kind = value or self.editor.scenario.base.vehicle.drive.model
        if key == "drive" and kind in drive_kinds():
            self.editor.choose_drive(kind)


class LineGroup(Group):
    """The line: as it can be dragged, then its fields and lists."""

    def __init__(self, parent: EditorView, name: str) -> None:
        super().__init__(parent, name)
        tables = {part.key: part for part in parts_of("line") if isinstance(part, Table)}
        self.sections, self.limits = tables["line.sections"], tables["line.speed_limits"]
        self.axis = Axis(parent.palette)
        self.profile = ProfileChart(PROFILE_PX, self.axis, parent.palette, self._drop_borders)
        self.steps = LimitStepsChart(LIMITS_PX, self.axis, parent.palette, self._drop_limits)
        self.way = html_pane()
        self.bring = pmui.Button(
            label="Import tables of a line",
            variant="text",
            size="small",
            margin=(0, 8, 4, 24),
            on_click=lambda _: self._bring(),
        )

    @property
    def charts(self) -> tuple[Chart, ...]:
        """Both charts."""
        return self.profile, self.steps

    def note(self, look: Look) -> str:
        """Return how long the line is."""
        return f"{words.number(look.now.line.length_m, 0)} m"

    def contents(self, look: Look) -> list[Any]:
        """Return the charts, then what a group has."""
        charts = stack(*(chart.host for chart in self.charts), css=":host { padding: 0 8px 8px 14px; }")
        return [self.bring, charts, self.way, *super().contents(look)]

    def _bring(self) -> None:
        """Turn to the page that reads tables; the editor would cover half of it."""
        self.editor.open = False
        self.parent.state.page = "Import"

    def show(self, look: Look) -> None:
        """Show the scenario."""
        super().show(look)
        if not self.head.open:
            return
        line, most = look.now.line, look.now.vehicle.traction.max_speed_kmh
        self.axis.fit(line.length_m, roomy=False)
        self.profile.show(partial(self.profile.draw, line))
        self.steps.show(partial(self.steps.draw, line, most))
        turned = "Charts and tables show the track as in its file; the train runs from its end to its start."
        self.way.object = note_paragraphs([turned], "padding-left:32px") if line.reverse else ""
        self.settle()

    def settle(self) -> None:
        """Tell the cursor of both charts."""
        self.axis.settle("m", 0)

    def _drop_borders(self, distance_m: Sequence[float], height_m: Sequence[float]) -> None:
        # rows may have come or gone while the border was dragged
        if len(distance_m) == len(self.editor.look().rows(self.sections)) + 1:
            self._then_show(partial(self.editor.move_borders, self.sections, distance_m, height_m))

    def _drop_limits(self, from_m: Sequence[float], to_m: Sequence[float], limit_kmh: Sequence[float]) -> None:
        self._then_show(partial(self.editor.move_limits, self.sections, self.limits, from_m, to_m, limit_kmh))
