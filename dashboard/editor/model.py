"""The editor of the scenario: its groups of fields, and the typed values that were refused."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import param

from railjoule.core import RailjouleError, Scenario
from railjoule.core.budget import PAGE
from railjoule.dashboard.editor.fields_of import Field, Table, models_of, parts_of, tables_in
from railjoule.dashboard.editor.rows import CellError, Row, changed_rows, drive_of_kind
from railjoule.dashboard.look import words
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
VEHICLE = Field(
    "vehicle",
    "choice",
    "A shipped vehicle with its powertrain; load, line and time are kept. Its own line is in the list of scenarios.",
)
LINE = Field("line", "choice", "A shipped line with its limits and stations.")
DRIVE = Field(
    "drive",
    "choice",
    "A new kind starts with the values of a shipped vehicle that has it, or with assumed ones.",
    choices=models_of("drive"),
)
WHOLE_TABLES = {"vehicle": ("vehicle", "drive"), "drive": ("drive",), "line": ("line",)}
"""Tables that one choice replaces as a whole, with those that go with them."""
# abbreviations, of which `words_of` would make Eoc and Enoc
HEADINGS = {"eoc": words.STRATEGY_WORDS["eoc"], "enoc": words.STRATEGY_WORDS["enoc"]}
STILL_PERMILLE = 1e-6
"""Difference of gradients by rounding only."""
SOURCE = "scenario: "


@dataclass(frozen=True)
class Look:
    """The scenario at one moment.

    Parameters
    ----------
    now : Scenario
        As it stands.
    before : Scenario
        As it was before single fields were edited; chosen presets are in it.
    base : Scenario
        As it was before anything was changed.
    changes : mapping
        The keys that differ from the base.
    """

    now: Scenario
    before: Scenario
    base: Scenario
    changes: Mapping[str, Any]

    def text(self, field: Field) -> str:
        """Return the text of a field."""
        return field.show(value_at(self.now, field.key))

    def was(self, field: Field) -> str:
        """Return the text that a field had."""
        return field.show(value_at(self.base if field.key in WHOLE_TABLES else self.before, field.key))

    def rows(self, table: Table) -> list[Row]:
        """Return the entries of a list, by columns, without what is left out."""
        return entries_at(self.now, table)


@dataclass(frozen=True)
class Refusal:
    """A typed text that was not accepted; of a table, with its cell."""

    text: str
    sentence: str
    row: int = -1
    column: int = -1


class EditorModel(param.Parameterized):
    """The editor's changes of a scenario; all of them go through `ScenarioModel.edit`."""

    open = param.Boolean(default=False, doc="Whether the editor is in sight.")
    refused = param.Dict(default={}, doc="Typed values that were not accepted, by key.")

    def __init__(self, scenario: ScenarioModel, **params: Any) -> None:
        super().__init__(**params)
        self.scenario = scenario
        scenario.param.watch(lambda *_: self.param.update(refused={}), ["preset", "opened"])

    def look(self) -> Look:
        """Return the scenario as it stands and as it was."""
        model = self.scenario
        whole = {key: value for key, value in model.edits.items() if key in WHOLE_TABLES}
        before = model.base.replace(**whole) if whole else model.base
        return Look(model.scenario(), before, model.base, model.changes)

    def parts(self, group: str, scenario: Scenario) -> list[tuple[str, Sequence[Field | Table]]]:
        """Return the fields and lists of a group, under a heading for each table of the file where there are several.

        Tables that have a group of their own are left out, and those that the scenario does not have.
        """
        if group == "Presets":
            return [("", (VEHICLE, LINE, *(part for part in parts_of("") if part.key == "title")))]
        own = {name for tables in GROUPS.values() for name in tables}
        found: list[tuple[str, Sequence[Field | Table]]] = []
        for table in GROUPS[group]:
            model = scenario.vehicle.drive.model if table == "drive" else ""
            first = (DRIVE,) if table == "drive" else ()
            heading = HEADINGS.get(table, words_of(table)) if len(GROUPS[group]) > 1 else ""
            found.append((heading, (*first, *parts_of(table, model))))
            inner = [name for name in tables_in(table, model) if name not in own]
            found += [(words_of(name), parts_of(name, model)) for name in inner if value_at(scenario, name) is not None]
        return found

    # ---- fields

    def type(self, field: Field, text: str) -> None:
        """Accept a text of a field, or the choice of a whole table; else keep the reason for the refusal."""
        look = self.look()
        now = look.text(field)
        is_whole = field.key in WHOLE_TABLES
        kept = "" if is_whole else f"Kept: {f'{now} {field.unit}'.strip() if now else 'nothing'}."
        with self._refusals(field.key, text, kept):
            if is_whole:
                self._choose(field.key, text)
                return
            value = field.parse(text)
            # by their texts: a number that reads as before is no edit, whatever rounding has left in its last digits
            if field.show(value) == look.was(field):
                self._reset(field.key)
                return
            if value is None:
                self._require_absent(field)
            self.scenario.edit({field.key: value})

    def take_back(self, part: Field | Table) -> None:
        """Give a field or list the value again that it had."""
        with self._refusals(part.key):
            if part.key in WHOLE_TABLES:
                self._choose(part.key, "")
            else:
                self._reset(part.key)

    def _choose(self, key: str, name: str) -> None:
        """Take a shipped vehicle or line, or a drive of a kind; the scenario's own where no name is given."""
        base, now = self.scenario.base, self.scenario.scenario()
        if key == "drive":
            name = name or base.vehicle.drive.model
            # beside another vehicle the drive that comes back is that vehicle's, which may be of another kind
            is_own = base.vehicle.drive.model == name and "vehicle" not in self.scenario.edits
        else:
            is_own = name in {"", getattr(base, key).preset}
        if is_own:
            self._reset(*self._keys_under(WHOLE_TABLES[key]))
        elif key == "drive":
            self.scenario.edit({"drive": drive_of_kind(name, now.vehicle.drive)})
        elif key == "vehicle":
            # the vehicle comes with its own drive, beside which edits of the former one must not stay
            self.scenario.edit({"vehicle": {"preset": name, "load_factor": now.vehicle.load_factor}, "drive": None})
        else:
            self.scenario.edit({"line": {"preset": name}})

    def _require_absent(self, field: Field) -> None:
        """Refuse to leave out what a preset or the file's rules give anyway."""
        given = value_at(self.scenario.edited.replace(**{field.key: None}), field.key)
        if given is not None:
            raise ValueError(f"The default is {field.show(given)}; it cannot be left empty.")

    def _keys_under(self, tables: Sequence[str]) -> list[str]:
        beginnings = tuple(f"{table}." for table in tables)
        # they have fields in the sidebar, and stay as they are set there
        sliders = {"vehicle.load_factor", "vehicle.load_t", "drive.recuperation_factor"}
        changes = self.scenario.changes
        return [key for key in changes if key in tables or (key.startswith(beginnings) and key not in sliders)]

    def _reset(self, *keys: str) -> None:
        if any(key in self.scenario.changes for key in keys):
            self.scenario.take_back(*keys)

    # ---- tables

    def change_rows(self, table: Table, what: str, row: int = 0, column: int = 0, text: str = "") -> None:
        """Change the rows of a table, as `changed_rows` describes, or keep the reason for the refusal."""
        look = self.look()
        place = (text, row, column) if what == "cell" else ("", -1, -1)
        with self._refusals(table.key, place[0], "Nothing is changed.", *place[1:]):
            self._set_rows(table, changed_rows(table, look.rows(table), look.now, what, row, column, text))

    def set_rows(self, table: Table, rows: Sequence[Row]) -> None:
        """Take other rows, as a chart gives them, or keep the reason for the refusal."""
        with self._refusals(table.key, "", "Nothing is changed."):
            self._set_rows(table, rows)

    def move_borders(self, table: Table, distance_m: Sequence[float], height_m: Sequence[float]) -> None:
        """Let the sections run through borders of other places and heights [m]; lists of one more than them."""
        rows = self.look().rows(table)
        # rows may have come or gone while the border was dragged
        if len(distance_m) == len(rows) + 1:
            moved = zip(rows, np.diff(distance_m), np.diff(height_m), strict=True)
            self.set_rows(table, [_moved_section(row, length, climb) for row, length, climb in moved])

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
        moved = list(zip(from_m, to_m, limit_kmh, strict=True))
        for row, (_, _, limit) in zip(limited, moved, strict=False):
            row["speed_limit_kmh"] = limit
        stretches = [
            {**row, "from_m": start, "to_m": end, "limit_kmh": limit}
            for row, (start, end, limit) in zip(limit_rows, moved[len(limited) :], strict=True)
        ]
        for table, rows in ((sections, section_rows), (limits, stretches)):
            if rows != look.rows(table):
                self.set_rows(table, rows)

    def _set_rows(self, table: Table, rows: Sequence[Row]) -> None:
        # before they are accepted: rows are checked again at each move of a slider
        if len(rows) > PAGE.row_count:
            raise CellError(f"{len(rows):,} rows; the page takes at most {PAGE.row_count:,}.")
        if list(rows) == entries_at(self.look().before, table):
            self._reset(table.key)
            return
        value = None if table.optional and not rows else [_entry(table, row, n) for n, row in enumerate(rows, 1)]
        self.scenario.edit({table.key: value})

    @contextmanager
    def _refusals(self, key: str, text: str = "", kept: str = "", row: int = -1, column: int = -1) -> Iterator[None]:
        """Keep the reason where a change of a key is refused; a change that is accepted ends the former refusal."""
        refused = {name: refusal for name, refusal in self.refused.items() if name != key}
        try:
            yield
        except (ValueError, RailjouleError) as error:
            sentence = f"{str(error).removeprefix(SOURCE)} {kept}".rstrip()
            refused[key] = Refusal(text, sentence, row, column)
        self.refused = refused


def _moved_section(row: Row, length_m: float, climb_m: float) -> Row:
    """Return a section with another length and climb: its gradient in tenths, or as it was where it has not changed."""
    gradient, was = 1000 * climb_m / length_m, float(row.get("gradient_permille", 0.0))
    gradient = was if abs(gradient - was) < STILL_PERMILLE else float(round(gradient, 1))
    # to a millimetre, as differences of places have errors of rounding
    return {**row, "length_m": float(round(length_m, 3)), "gradient_permille": gradient}


def value_at(scenario: Scenario, key: str) -> Any:
    """Return the value at a dotted key of a scenario, None where there is none; of a whole table its preset or kind."""
    value: Any = scenario
    for name in f"vehicle.{key}".split(".") if key.split(".", maxsplit=1)[0] == "drive" else key.split("."):
        value = getattr(value, name, None)
    if key in WHOLE_TABLES:
        return value.model if key == "drive" else value.preset
    return value


def entries_at(scenario: Scenario, table: Table) -> list[Row]:
    """Return the entries of a list of a scenario by their columns, without what is left out."""
    entries = value_at(scenario, table.key) or ()
    names = [column.name for column in table.columns]
    if table.of_lists:
        return [dict(zip(names, entry, strict=True)) for entry in entries]
    return [{name: value for name in names if (value := getattr(entry, name)) is not None} for entry in entries]


def _entry(table: Table, row: Row, number: int) -> Any:
    """Return a row as it stands in the file."""
    if not table.of_lists:
        return row
    missing = [column.label for column in table.columns if column.name not in row]
    if missing:
        raise CellError(f"Row {number}, {missing[0]}: a value is missing.")
    return [row[column.name] for column in table.columns]
