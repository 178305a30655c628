"""Files from the user: the kind of each by its content, and the choices of the user about it."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from railjoule.core.errors import ChoiceError, RailjouleError, ScenarioError
from railjoule.core.imports import TABLE_KINDS, ColumnMap, SourceFile, TableKind, kind_of_table, sheets_by_kind
from railjoule.core.imports.cells import CellTable, first_rows_of_sheets, read_cells
from railjoule.core.imports.columns import NAMES, ROLES, SELECTORS, STATION_ROLES, same_name
from railjoule.core.imports.data_sheet import KEY
from railjoule.core.imports.kinds import kind_by_name, known_columns
from railjoule.core.imports.source_file import encoding_mentioned, found_code_page, read_json, select_sheet
from railjoule.core.measured import recorder_cells
from railjoule.dashboard.pages.files.columns import RunFile, find_quantities, read_runs

OtherKind = Literal["track", "train", "journey", "sheet", "run"]
Kind = TableKind | OtherKind | Literal[""]
TABLE_WORDS: dict[str, str] = {
    "gradients": "Gradients",
    "heights": "Heights",
    "limits": "Speed limits",
    "curves": "Curves",
    "tunnels": "Tunnels",
    "neutral": "Neutral sections",
    "stations": "Stations",
    "run": "Recorded run",
}
"""Kinds of tables, among which the user can choose."""
KIND_WORDS: dict[str, str] = {
    **TABLE_WORDS,
    "track": "Track of TTOBench",
    "train": "Train of TTOBench",
    "journey": "Journey of TTOBench",
    "sheet": "Data sheet",
}
KEYS_OF_JSON: dict[OtherKind, str] = {
    "track": "stops",
    "journey": "timing points",
    "train": "rolling resistance r0",
    "sheet": KEY,
}
"""By which key of a JSON file its kind is known."""
WORKBOOKS = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0")
LARGEST_SEARCHED_BYTES = 2_000_000
"""Of a workbook whose sheets are searched for tables while the page waits: a second of work."""
SHEET, ENCODING = "sheet", "encoding"
"""Keys of the choices of a sheet of a workbook and of the code page of a text."""
UNKNOWN = (
    "it is none of the files that can be read: recorded runs (CSV, XLSX, GPX), tables of gradients, heights, speed "
    "limits, curves, tunnels, neutral sections or stations (CSV, XLSX), TTOBench (JSON); files of OSRD and railtoolkit "
    "are read by the command railjoule import"
)


@dataclass(frozen=True, eq=False)
class Brought:
    """A file as it was brought, with the choices of the user about it.

    Parameters
    ----------
    number : int
        Its key on the page.
    name : str
    content : bytes
    said_kind : str
        The kind chosen by the user; empty without a choice.
    columns : ColumnMap
        Choices of the user about its columns.
    factors : mapping of str to float
        Factors of numbers of a vehicle by their keys: answers to questions about units.
    encoding : str
        The code page of a text that is not UTF-8, if the user has chosen it.
    is_example : bool
        Whether it is one of the example runs.
    sheet : str
        The sheet of a workbook of several tables that it is.
    """

    number: int
    name: str
    content: bytes
    said_kind: Kind = ""
    columns: ColumnMap = field(default_factory=ColumnMap)
    factors: dict[str, float] = field(default_factory=dict)
    encoding: str = ""
    is_example: bool = False
    sheet: str = ""

    def with_kind(self, kind: Kind) -> "Brought":
        """Return it as a file of another kind, without the choices about its columns."""
        return replace(self, said_kind=kind, columns=ColumnMap(sheet=self.columns.sheet))

    def with_choice(self, key: str, value: str) -> "Brought":
        """Return it with one more choice of the user: a column, a unit, a line, or an answer about a number."""
        what, _, name = key.partition(" ")
        said = self.columns
        if what == "factor":
            return replace(self, factors={**self.factors, name: float(value)})
        # another sheet has other columns, and in another code page their names may be others
        if what in {SHEET, ENCODING}:
            encoding = value if what == ENCODING else self.encoding
            return replace(self, encoding=encoding, columns=ColumnMap(sheet=value or None if what == SHEET else None))
        # an empty value gives back the guess
        chosen = {name or what: value} if value else {}
        if what == "rows":
            rows = {column: text for column, text in said.rows.items() if column != name}
            said = replace(said, rows={**rows, **chosen})
        elif what == "position_unit":
            said = replace(said, position_unit=value or None)
        elif what == "value_unit":
            said = replace(said, value_unit=value or None)
        elif what == "tolerance_m":
            said = replace(said, tolerance_m=float(value) if value else None)
        elif what in (*ROLES, *STATION_ROLES):
            roles = {role: column for role, column in said.columns.items() if role != what}
            said = replace(said, columns={**roles, **chosen})
        return replace(self, columns=said)

    @property
    def source(self) -> SourceFile:
        """The file as the core reads it."""
        return SourceFile(self.name, self.content, self.encoding, self.sheet)

    @cached_property
    def code_page(self) -> str | None:
        """The code page of a text that is not Unicode, empty where it is in doubt; None of other files."""
        if self.content.startswith(WORKBOOKS):
            return None
        found = found_code_page(self.content)
        return found if found is None else self.encoding or found

    @cached_property
    def cells(self) -> CellTable:
        """Its cells, where it is a table."""
        return read_cells(self.source, self.columns.sheet)

    @cached_property
    def runs(self) -> tuple[RunFile, ...]:
        """The recorded runs in it: each sheet of a workbook may be one."""
        return read_runs(self.source, self.columns.sheet)

    @cached_property
    def kind(self) -> Kind:
        """Its kind: chosen by the user, or found by its content.

        Raises
        ------
        ScenarioError
            If no kind of file that can be read fits.
        """
        return self.said_kind or self._guess()

    @cached_property
    def wanted(self) -> ColumnMap:
        """The meaning of its columns: from a published table that has the same ones, and from the user."""
        if self.kind not in TABLE_KINDS:
            return self.columns
        return self.columns.over(known_columns(self.cells, self.kind))

    def _guess(self) -> Kind:
        beginning = self.content.removeprefix(b"\xef\xbb\xbf").lstrip()[:1]
        if not self.content:
            raise ScenarioError(f"{self.name}: it is empty.")
        if beginning in {b"{", b"["}:
            document = read_json(self.source)
            found = next((kind for kind, key in KEYS_OF_JSON.items() if key in document), None)
            if found is None:
                raise ScenarioError(f"{self.name}: {UNKNOWN}.")
            return found
        try:
            cells = self.cells
        except ChoiceError as several:
            return self._guess_of_workbook(several)
        with encoding_mentioned(cells.findings):
            kind = guess_line_kind(cells) or ("run" if self._is_recorded() else "")
        if not kind:
            raise ScenarioError(f"{self.name}: {UNKNOWN}.")
        return kind

    def _guess_of_workbook(self, several: ChoiceError) -> Kind:
        """Return "run" if a sheet of a workbook is a recorded run; else raise `several`, as a sheet is to be chosen."""
        try:
            is_run = bool(self.runs)
        except RailjouleError:
            is_run = False
        if not is_run:
            raise several
        return "run"

    def _is_recorded(self) -> bool:
        """Return whether it is a run with rows above the names of its columns."""
        return is_recording(recorder_cells(self.source, sheet=self.columns.sheet).header)


def is_recording(header: Sequence[str]) -> bool:
    """Return whether a table with these columns is a recorded run: it names times, or places with speeds."""
    found: Collection[str] = find_quantities(header)
    return "time" in found or {"speed", "position"} <= set(found)


def guess_line_kind(cells: CellTable) -> Kind:
    """Return the kind of a table by its columns, then by the file's name; empty if neither identifies it."""
    if is_recording(cells.header) and ("time" in find_quantities(cells.header) or kind_by_name(cells.source) is None):
        return "run"
    return kind_of_table(cells, cells.source) or ""


def split_workbook(name: str, content: bytes) -> list["Brought"]:
    """Return the tables of a line that are sheets of one workbook, each as a file; nothing for other files.

    A kind of which there are several sheets is one file, of which the sheet is to be chosen.
    """
    source = SourceFile(name, content)
    if not content.startswith(WORKBOOKS[0]) or len(content) > LARGEST_SEARCHED_BYTES:
        return []
    try:
        sheets = sheets_by_kind(first_rows_of_sheets(source))
    except RailjouleError:
        return []
    if len(sheets) < 2:
        return []
    return [
        Brought(0, select_sheet(source, names[0]).name, content, sheet=names[0])
        if len(names) == 1
        else Brought(0, f"{name}, {TABLE_WORDS[kind].lower()}", content, said_kind=kind)
        for kind, names in sheets.items()
    ]


def find_selectors(cells: CellTable, used: tuple[str | None, ...]) -> list[str]:
    """Return the columns that name a line or a track."""
    names = [name for role in SELECTORS for name in NAMES[role]]
    return [column for column in cells.header if column not in used and any(same_name(column, name) for name in names)]
