"""The editor of the scenario: its groups of fields, what is typed into them, and why it is not taken."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import param
from pydantic import BaseModel

from railjoule.core import RailjouleError, Scenario
from railjoule.core.budget import PAGE
from railjoule.core.scenario import preset_document, preset_names
from railjoule.core.scenario.presets import PresetKind
from railjoule.dashboard.editor.fields_of import Field, Table, models_of, parts_of, tables_in
from railjoule.dashboard.editor.first_values import drive_of_kind, first_rows, row_after
from railjoule.dashboard.editor.pasted_table import CellError, parse_cell, rows_of
from railjoule.dashboard.look.key_names import words_of
from railjoule.dashboard.state.scenario import ScenarioModel

GROUPS: Mapping[str, tuple[str, ...]] = {
    "Presets": (),
    "Vehicle": ("vehicle",),
    "Resistance": ("vehicle.resistance",),
    "Traction": ("vehicle.traction",),
    "Braking": ("vehicle.braking",),
    "Powertrain": ("drive",),
    "Track": ("line",),
    "Timetable": ("timetable",),
    "Disturbance": ("disturbance",),
    "Strategy options": ("search", "simulation", "phases", "eoc", "enoc", "solver"),
}
"""The editor's sections, with the tables of the file in each."""
WHOLE_TABLES = ("vehicle", "drive", "line")
"""Tables that a choice replaces as a whole."""
STILL_PERMILLE = 1e-6
"""What rounding alone makes of a gradient."""
SOURCE = "scenario: "
Row = dict[str, Any]


@dataclass(frozen=True)
class Look:
    """The scenario at one moment.

    Parameters
    ----------
    now : Scenario
        As it stands.
    before : Scenario
        As it was before single fields were edited; chosen presets are in it.
    changes : mapping
        The keys that differ.
    """

    now: Scenario
    before: Scenario
    changes: Mapping[str, Any]

    def text(self, field: Field) -> str:
        """Return the text of a field."""
        return field.show(value_at(self.now, field.key))

    def was(self, field: Field) -> str:
        """Return the text that a field had."""
        return field.show(value_at(self.before, field.key))

    def rows(self, table: Table) -> list[Row]:
        """Return the entries of a list, by columns, without what is left out."""
        return entries_at(self.now, table)


@dataclass(frozen=True)
class Refusal:
    """What was typed and not taken; of a table, where."""

    text: str
    sentence: str
    row: int = -1
    column: int = -1


class EditorModel(param.Parameterized):
    """What the editor does to a scenario; all of it through `ScenarioModel.edit`."""

    open = param.Boolean(default=False, doc="Whether the editor is in sight.")
    refused = param.Dict(default={}, doc="Typed values that were not accepted, by key.")

    def __init__(self, scenario: ScenarioModel, **params: Any) -> None:
        super().__init__(**params)
        self.scenario = scenario
        scenario.param.watch(self._forget, ["preset", "opened"])

    def _forget(self, *_: Any) -> None:
        self.refused = {}

    def look(self) -> Look:
        """Return the scenario as it stands and as it was."""
        model = self.scenario
        whole = {key: value for key, value in model.edits.items() if key in WHOLE_TABLES}
        base = model.base
        return Look(model.scenario(), base.replace(**whole) if whole else base, model.changes)

    def parts(self, table: str, scenario: Scenario) -> list[tuple[str, Sequence[Field | Table]]]:
        """Return the fields and lists of a table of the file, and of the tables in it that are there.

        Each with its heading, empty for the table itself; tables that have a group of their own are left out.
        """
        model = scenario.vehicle.drive.model if table == "drive" else ""
        own = {name for tables in GROUPS.values() for name in tables}
        inner = [name for name in tables_in(table, model) if name not in own and value_at(scenario, name) is not None]
        return [("", parts_of(table, model)), *((words_of(name), parts_of(name, model)) for name in inner)]

    def type(self, field: Field, text: str) -> None:
        """Accept what was typed into a field, or say why not."""
        look = self.look()
        try:
            value = field.parse(text)
            # by their texts: a number that reads as before is no edit, whatever rounding has left in its last digits
            if field.show(value) == look.was(field):
                self._set(field.key, None, back=True)
                return
            if value is None:
                self._require_absent(field)
            self._set(field.key, {field.key: value})
        except (ValueError, RailjouleError) as error:
            before = look.text(field)
            kept = f"{before} {field.unit}".strip() if before else "nothing"
            self._refuse(field.key, Refusal(text, f"{sentence_of(error)} Kept: {kept}."))

    def take_back(self, key: str) -> None:
        """Give a field or list the value again that it had."""
        try:
            self._set(key, None, back=True)
        except RailjouleError as error:
            self._refuse(key, Refusal("", sentence_of(error)))

    def choose(self, kind: PresetKind, name: str) -> None:
        """Take a shipped vehicle or line for the whole of the scenario's; with no name its own again."""
        tables = ("vehicle", "drive") if kind == "vehicles" else ("line",)
        key, own = tables[0], getattr(self.scenario.base, tables[0]).preset
        try:
            if name in {"", own}:
                self.scenario.take_back(*self._keys_under(tables))
            elif kind == "vehicles":
                load = self.scenario.scenario().vehicle.load_factor
                # the vehicle comes with its own drive, beside which edits of the former one must not stay
                self.scenario.edit({"vehicle": {"preset": name, "load_factor": load}, "drive": None})
            else:
                self.scenario.edit({"line": {"preset": name}})
            self._accept(key)
        except RailjouleError as error:
            self._refuse(key, Refusal(name, sentence_of(error)))

    def choose_drive(self, model: str) -> None:
        """Take a drive of another kind; the scenario's own where that is of this kind."""
        try:
            # beside another vehicle the drive that comes back is that vehicle's, which may be of another kind
            if self.scenario.base.vehicle.drive.model == model and "vehicle" not in self.scenario.edits:
                self.scenario.take_back(*self._keys_under(("drive",)))
            else:
                self.scenario.edit({"drive": drive_of_kind(model, self.scenario.scenario().vehicle.drive)})
            self._accept("drive")
        except RailjouleError as error:
            self._refuse("drive", Refusal(model, sentence_of(error)))

    def type_cell(self, table: Table, row: int, column: int, text: str) -> None:
        """Take what was typed into a cell, or say why not."""
        rows, field = self.look().rows(table), table.columns[column]
        try:
            value = parse_cell(field, text, row + 1)
            rows[row] = {name: old for name, old in rows[row].items() if name != field.name}
            if value is not None:
                rows[row][field.name] = value
            self._set_rows(table, rows)
        except (CellError, RailjouleError) as error:
            self._refuse(table.key, Refusal(text, f"{sentence_of(error)} Nothing is changed.", row, column))

    def insert(self, table: Table, row: int) -> None:
        """Add a row below another one, or the first rows."""
        look = self.look()
        rows = look.rows(table)
        made = [*rows[:row], *row_after(table.key, rows, row, look.now), *rows[row + 1 :]] if rows else []
        self._try_rows(table, made or first_rows(table.key, look.now))

    def remove(self, table: Table, row: int) -> None:
        """Take a row away."""
        rows = self.look().rows(table)
        self._try_rows(table, rows[:row] + rows[row + 1 :])

    def move(self, table: Table, row: int, by: int) -> None:
        """Change a row for the one above (-1) or below (1)."""
        rows, other = self.look().rows(table), row + by
        if 0 <= other < len(rows):
            rows[row], rows[other] = rows[other], rows[row]
            self._try_rows(table, rows)

    def paste(self, table: Table, text: str, row: int | None = None, column: int = 0) -> None:
        """Take a block of cells: from a cell on, or for all rows where no cell is named."""
        try:
            block = rows_of(text, table.columns, column)
            if row is None:
                self._set_rows(table, block)
                return
            rows = self.look().rows(table)
            for number, values in enumerate(block, row):
                # beyond the last row the slice is empty: there the block adds rows
                rows[number : number + 1] = [{**rows[number], **values} if number < len(rows) else values]
            self._set_rows(table, rows)
        except (CellError, RailjouleError) as error:
            self._refuse(table.key, Refusal("", f"{sentence_of(error)} Nothing is changed."))

    def set_rows(self, table: Table, rows: Sequence[Row]) -> None:
        """Take other rows, as a chart gives them, or say why not."""
        self._try_rows(table, rows)

    def move_borders(self, table: Table, distance_m: Sequence[float], height_m: Sequence[float]) -> None:
        """Let the sections run through borders of other places and heights [m]; lists of one more than them."""
        lengths, climbs = np.diff(distance_m), np.diff(height_m)
        rows = [
            # to a millimetre, as differences of places have errors of rounding
            {**row, "length_m": float(round(length, 3)), "gradient_permille": _kept_or_rounded(row, length, climb)}
            for row, length, climb in zip(self.look().rows(table), lengths, climbs, strict=True)
        ]
        self.set_rows(table, rows)

    def move_limits(
        self,
        sections: Table,
        limits: Table,
        from_m: Sequence[float],
        to_m: Sequence[float],
        limit_kmh: Sequence[float],
    ) -> None:
        """Take other limits of sections that have one, then of the stretches, in the order of their tables."""
        look = self.look()
        section_rows, limit_rows = look.rows(sections), look.rows(limits)
        limited = [row for row in section_rows if "speed_limit_kmh" in row]
        of_sections = len(limited)
        for row, limit in zip(limited, limit_kmh[:of_sections], strict=True):
            row["speed_limit_kmh"] = limit
        moved = [
            {**row, "from_m": start, "to_m": end, "limit_kmh": limit}
            for row, start, end, limit in zip(
                limit_rows, from_m[of_sections:], to_m[of_sections:], limit_kmh[of_sections:], strict=True
            )
        ]
        for table, rows in ((sections, section_rows), (limits, moved)):
            if rows != look.rows(table):
                self.set_rows(table, rows)

    def _try_rows(self, table: Table, rows: Sequence[Row]) -> None:
        try:
            self._set_rows(table, rows)
        except (CellError, RailjouleError) as error:
            self._refuse(table.key, Refusal("", f"{sentence_of(error)} Nothing is changed."))

    def _set_rows(self, table: Table, rows: Sequence[Row]) -> None:
        # before they are taken for good: rows are checked again at each move of a slider
        if len(rows) > PAGE.row_count:
            raise CellError(f"{len(rows):,} rows; the page takes at most {PAGE.row_count:,}.")
        if list(rows) == entries_at(self.look().before, table):
            self._set(table.key, None, back=True)
            return
        value = None if table.optional and not rows else [_entry(table, row, n) for n, row in enumerate(rows, 1)]
        self._set(table.key, {table.key: value})

    def _set(self, key: str, changes: Mapping[str, Any] | None, back: bool = False) -> None:
        """Edit the scenario, or give a key its value back."""
        if back:
            if key in self.scenario.changes:
                self.scenario.take_back(key)
        else:
            self.scenario.edit(changes or {})
        self._accept(key)

    def _require_absent(self, field: Field) -> None:
        """Refuse to leave out what a preset or the file's rules give anyway."""
        given = value_at(self.scenario.edited.replace(**{field.key: None}), field.key)
        if given is not None:
            raise ValueError(f"The default is {field.show(given)}; it cannot be left empty.")

    def _keys_under(self, tables: Sequence[str]) -> list[str]:
        beginnings = tuple(f"{table}." for table in tables)
        # they have fields beside every page, and stay as they are set there
        sliders = {"vehicle.load_factor", "drive.recuperation_factor"}
        return [
            key for key in self.scenario.changes if key in tables or (key.startswith(beginnings) and key not in sliders)
        ]

    def _accept(self, key: str) -> None:
        self.refused = {name: refusal for name, refusal in self.refused.items() if name != key}

    def _refuse(self, key: str, refusal: Refusal) -> None:
        self.refused = {**self.refused, key: refusal}


def _kept_or_rounded(row: Row, length_m: float, climb_m: float) -> float:
    """Return the gradient of a moved section in tenths, and that of another as it was."""
    gradient = 1000 * climb_m / length_m
    was = float(row.get("gradient_permille", 0.0))
    return was if abs(gradient - was) < STILL_PERMILLE else round(gradient, 1)


def value_at(scenario: Scenario, key: str) -> Any:
    """Return what stands at a dotted key of a scenario; None where there is nothing."""
    value: Any = scenario
    for name in f"vehicle.{key}".split(".") if key.split(".", maxsplit=1)[0] == "drive" else key.split("."):
        value = getattr(value, name, None)
    return value


def entries_at(scenario: Scenario, table: Table) -> list[Row]:
    """Return the entries of a list of a scenario by their columns, without what is left out."""
    entries = value_at(scenario, table.key) or ()
    names = [column.name for column in table.columns]
    if table.of_lists:
        return [dict(zip(names, entry, strict=True)) for entry in entries]
    assert all(isinstance(entry, BaseModel) for entry in entries)
    return [{name: value for name in names if (value := getattr(entry, name)) is not None} for entry in entries]


def _entry(table: Table, row: Row, number: int) -> Any:
    """Return a row as it stands in the file."""
    if not table.of_lists:
        return row
    missing = [column.label for column in table.columns if column.name not in row]
    if missing:
        raise CellError(f"Row {number}, {missing[0]}: a value is missing.")
    return [row[column.name] for column in table.columns]


def sentence_of(error: Exception) -> str:
    """Return an error's sentence without the name of what it is about: that is in sight."""
    return str(error).removeprefix(SOURCE)


def preset_options(kind: PresetKind) -> dict[str, str]:
    """Return the names of shipped vehicles or lines by what they are called."""
    return {str(preset_document(kind, name)["name"]): name for name in preset_names(kind)}


def drive_kinds() -> tuple[str, ...]:
    """Return the kinds of drives."""
    return models_of("drive")
