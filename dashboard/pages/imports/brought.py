"""Files that a user brings: what each of them is, by its content."""

import base64
import binascii
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from railjoule.core.errors import ScenarioError
from railjoule.core.imports import INTERVAL_KINDS, PRESETS, ColumnMap, IntervalKind, SourceFile
from railjoule.core.imports.cells import CellTable, read_cells
from railjoule.core.imports.columns import NAMES, ROLES, SELECTORS, resolve, same_name
from railjoule.core.imports.source_file import encoding_mentioned, found_code_page, read_json

OtherKind = Literal["track", "train", "journey"]
Kind = IntervalKind | OtherKind | Literal[""]
TABLE_WORDS: dict[str, str] = {
    "gradients": "Gradients",
    "limits": "Speed limits",
    "curves": "Curves",
    "tunnels": "Tunnels",
    "neutral": "Neutral sections",
}
"""Kinds of tables of intervals, among which the user can choose."""
KIND_WORDS: dict[str, str] = {
    **TABLE_WORDS,
    "track": "Track of TTOBench",
    "train": "Train of TTOBench",
    "journey": "Journey of TTOBench",
}
KEYS_OF_JSON: dict[OtherKind, str] = {
    "track": "stops",
    "journey": "timing points",
    "train": "rolling resistance r0",
}
"""By which key of a JSON file its kind is known."""
WORKBOOKS = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")
SHEET, ENCODING = "sheet", "encoding"
"""Keys of the choices of a sheet of a workbook and of the code page of a text."""
GENERIC = ("value", "valeur")
"""Names of columns that say nothing of the kind."""
WORDS_IN_NAMES: dict[IntervalKind, tuple[str, ...]] = {
    "gradients": ("gradient", "slope", "decliv", "neigung", "profil"),
    "limits": ("limit", "vitesse", "speed", "geschwind"),
    "curves": ("curve", "courbe", "radi", "bogen"),
    "tunnels": ("tunnel",),
    "neutral": ("neutral", "neutre"),
}
UNKNOWN = (
    "it is none of the files that can be read: tables of gradients, speed limits, curves, tunnels or neutral "
    "sections (CSV, XLSX), TTOBench (JSON); files of OSRD and railtoolkit are read by the command railjoule import"
)


@dataclass(frozen=True, eq=False)
class Brought:
    """A file as it was brought, and what the user says of it.

    Parameters
    ----------
    number : int
        By which the page knows it.
    name : str
    encoded : str
        What it holds, in base64, as a browser sends it.
    said_kind : str
        What it is, where the user says so.
    columns : ColumnMap
        What the user says of its columns.
    factors : mapping of str to float
        What numbers of a vehicle are multiplied with, by their keys: answers to questions about units.
    encoding : str
        The code page of a text that is not UTF-8, where the user says it.
    """

    number: int
    name: str
    encoded: str
    said_kind: Kind = ""
    columns: ColumnMap = field(default_factory=ColumnMap)
    factors: dict[str, float] = field(default_factory=dict)
    encoding: str = ""

    @classmethod
    def of(cls, number: int, source: SourceFile) -> "Brought":
        """Return a file of this machine."""
        return cls(number, source.name, base64.b64encode(source.content).decode())

    def with_kind(self, kind: Kind) -> "Brought":
        """Return it as a file of another kind; what was said of its columns is forgotten."""
        return replace(self, said_kind=kind, columns=ColumnMap(sheet=self.columns.sheet))

    def told(self, key: str, value: str) -> "Brought":
        """Return it with one thing more that the user says: a column, a unit, a line, or an answer about a number."""
        what, _, name = key.partition(" ")
        if what == "factor":
            return replace(self, factors={**self.factors, name: 1.0 if value == "1" else float(value)})
        if what == ENCODING:
            # the names of its columns may be others in this code page
            return replace(self, encoding=value, columns=ColumnMap())
        if what == SHEET:
            # another sheet has other columns
            return replace(self, columns=ColumnMap(sheet=value or None))
        if what == "rows":
            rows = {column: text for column, text in self.columns.rows.items() if column != name}
            return replace(self, columns=replace(self.columns, rows={**rows, name: value} if value else rows))
        if what in {"position_unit", "value_unit"} and not value:
            is_position = what == "position_unit"
            kept = replace(self.columns, position_unit=None) if is_position else replace(self.columns, value_unit=None)
            return replace(self, columns=kept)
        if not value:
            # the guess again
            columns = {role: column for role, column in self.columns.columns.items() if role != what}
            return replace(self, columns=replace(self.columns, columns=columns))
        if what in {*ROLES, "position_unit", "value_unit"}:
            return replace(self, columns=ColumnMap.of(what, value).over(self.columns))
        return self

    @cached_property
    def source(self) -> SourceFile:
        """The file.

        Raises
        ------
        ScenarioError
            If it did not arrive whole.
        """
        try:
            return SourceFile(self.name, base64.b64decode(self.encoded, validate=True), self.encoding)
        except (binascii.Error, ValueError):
            raise ScenarioError(f"{self.name}: it did not arrive whole; choose it again.") from None

    @cached_property
    def code_page(self) -> str | None:
        """The code page of a text that is not Unicode, empty where it is in doubt; None of other files."""
        if self.source.content.startswith(WORKBOOKS):
            return None
        found = found_code_page(self.source.content)
        return found if found is None else self.encoding or found

    @cached_property
    def cells(self) -> CellTable:
        """Its cells, where it is a table."""
        return read_cells(self.source, self.columns.sheet)

    @cached_property
    def kind(self) -> Kind:
        """What it is: as the user says, or by its content.

        Raises
        ------
        ScenarioError
            If it is nothing that can be read.
        """
        return self.said_kind or self._guess()

    @cached_property
    def wanted(self) -> ColumnMap:
        """What is known of its columns: by a published table that has these, and by the user."""
        if self.kind not in INTERVAL_KINDS:
            return self.columns
        preset = preset_of(self.cells)
        known = PRESETS[preset][1] if preset and PRESETS[preset][0] == self.kind else ColumnMap()
        return self.columns.over(known)

    def _guess(self) -> Kind:
        content = self.source.content
        beginning = content.removeprefix(b"\xef\xbb\xbf").lstrip()[:1]
        if not content:
            raise ScenarioError(f"{self.name}: it is empty.")
        if beginning in {b"{", b"["}:
            document = read_json(self.source)
            found = next((kind for kind, key in KEYS_OF_JSON.items() if key in document), None)
            if found is None:
                raise ScenarioError(f"{self.name}: {UNKNOWN}.")
            return found
        with encoding_mentioned(self.cells.findings):
            return kind_of_table(self.cells)


def preset_of(cells: CellTable) -> str | None:
    """Return the published table whose columns a table has; None where it is none of them."""
    return next(
        (
            name
            for name, (_, columns) in PRESETS.items()
            if all(any(same_name(column, one) for one in cells.header) for column in columns.columns.values())
        ),
        None,
    )


def kind_of_table(cells: CellTable) -> Kind:
    """Return what a table tells of, by its columns, then by the file's name.

    Raises
    ------
    ScenarioError
        If neither says it.
    """
    if preset := preset_of(cells):
        return PRESETS[preset][0]
    name = cells.source.lower()
    by_name = next((kind for kind, parts in WORDS_IN_NAMES.items() if any(part in name for part in parts)), None)
    for kind in ("gradients", "limits", "curves", "tunnels"):
        try:
            value = resolve(cells, kind, ColumnMap()).value if cells.has_header else None
        except ScenarioError:
            continue
        if value is not None and not any(same_name(value, word) for word in GENERIC):
            return kind
    if by_name is None:
        raise ScenarioError(f"{cells.source}: {UNKNOWN}.")
    return by_name


def selectors_of(cells: CellTable, used: tuple[str | None, ...]) -> list[str]:
    """Return the columns that name a line or a track."""
    names = [name for role in SELECTORS for name in NAMES[role]]
    return [column for column in cells.header if column not in used and any(same_name(column, name) for name in names)]
