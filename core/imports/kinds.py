"""The kind of a table of a line, by the names of its columns; and the sheets of a workbook that are such tables."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.cells import ZIP_MARK, CellTable, first_rows_of_sheets, read_cells
from railjoule.core.imports.columns import (
    PRESETS,
    STATION_ROLES,
    TABLE_KINDS,
    ColumnMap,
    has_name,
    resolve,
    resolve_stations,
    same_name,
)
from railjoule.core.imports.findings import FromFile
from railjoule.core.imports.gpx import is_gpx
from railjoule.core.imports.source_file import SourceFile, select_sheet
from railjoule.core.imports.units import TableKind, plain
from railjoule.core.scenario._sentences import shown_list

GENERIC = ("value", "valeur")
"""Names of columns that name no kind."""
WORDS_IN_NAMES: Mapping[TableKind, tuple[str, ...]] = {
    "heights": ("height", "elevation", "altitude", "hohe", "hoehe"),
    "gradients": ("gradient", "slope", "decliv", "neigung", "profil"),
    "stations": ("station", "stops", "timetable", "gares", "bahnhof", "fahrplan"),
    "limits": ("limit", "vitesse", "speed", "geschwind"),
    "curves": ("curve", "courbe", "radi", "bogen"),
    "tunnels": ("tunnel",),
    "neutral": ("neutral", "neutre"),
}
TIMES = ("time", "timestamp", "zeit", "uhrzeit", "temps", "horodatage")
"""Columns of what a recorder wrote."""


def find_preset(cells: CellTable) -> str | None:
    """Return the published table whose columns a table has; None if it is none of them."""
    return next(
        (
            name
            for name, (_, columns) in PRESETS.items()
            if all(any(same_name(column, one) for one in cells.header) for column in columns.columns.values())
        ),
        None,
    )


def kind_by_name(name: str) -> TableKind | None:
    """Return the kind that the name of a file or a sheet suggests."""
    words = plain(name)
    return next((kind for kind, parts in WORDS_IN_NAMES.items() if any(part in words for part in parts)), None)


def kind_of_table(cells: CellTable, name: str) -> TableKind | None:
    """Return the kind of a table by its columns, then by its name; None if neither names it.

    Parameters
    ----------
    cells : CellTable
        Its columns; rows matter little.
    name : str
        The file or the sheet.
    """
    if preset := find_preset(cells):
        return PRESETS[preset][0]
    by_name = kind_by_name(name)
    if not cells.has_header or any(has_name(column, TIMES) for column in cells.header):
        return by_name
    for kind in ("gradients", "limits", "curves", "tunnels", "heights"):
        try:
            value = resolve(cells, kind, ColumnMap()).value
        except ScenarioError:
            continue
        if value is not None and not has_name(value, GENERIC):
            return kind
    if by_name in (None, "stations") and _is_of_stations(cells):
        return "stations"
    return by_name


def _is_of_stations(cells: CellTable) -> bool:
    try:
        roles, _ = resolve_stations(cells, ColumnMap())
    except ScenarioError:
        return False
    return any(roles[role] for role in STATION_ROLES if role != "position")


def known_columns(cells: CellTable | None, kind: TableKind) -> ColumnMap:
    """Return the columns of a table of a kind, if it is one that is published; else nothing."""
    preset = None if cells is None else find_preset(cells)
    return PRESETS[preset][1] if preset and PRESETS[preset][0] == kind else ColumnMap()


@dataclass(frozen=True)
class FoundTables(FromFile):
    """The tables of a line in a file: by their kind the file, or the sheet as a file of its own, and known columns."""

    tables: Mapping[TableKind, tuple[SourceFile, ColumnMap]]


def tables_of_file(source: SourceFile, chosen: Mapping[TableKind, str]) -> FoundTables:
    """Find the tables of a line in a file by the names of their columns.

    Parameters
    ----------
    source : SourceFile
        A table, or a workbook.
    chosen : mapping of str to str
        Sheets of kinds as the user names them.

    Raises
    ------
    ScenarioError
        If there is no such table, several sheets hold one kind, or the file cannot be read.
    """
    if not source.content.startswith(ZIP_MARK):
        cells = read_cells(source)
        kind = "heights" if is_gpx(source) else kind_of_table(cells, source.name)
        if kind is None:
            raise ScenarioError(
                f"{source.name}: the columns {shown_list(list(cells.header))} name no kind of table; say it, as "
                "--gradients FILE."
            )
        return FoundTables(source.name, {kind: (source, known_columns(cells, kind))})
    tables = first_rows_of_sheets(source)
    found = sheets_by_kind(tables)
    for kind, sheets in found.items():
        if len(sheets) > 1 and kind not in chosen:
            raise ScenarioError(
                f"{source.name}: the sheets {shown_list(list(sheets))} are all tables of {kind}; choose one, as "
                f"{kind}.sheet={sheets[0]}."
            )
    if not found and not chosen:
        kinds = ", ".join(TABLE_KINDS)
        raise ScenarioError(f"{source.name}: no sheet is a table of {kinds} by its columns or its name.")
    names: dict[TableKind, str] = {**{kind: sheets[0] for kind, sheets in found.items()}, **chosen}
    return FoundTables(
        source.name,
        {kind: (select_sheet(source, name), known_columns(tables.get(name), kind)) for kind, name in names.items()},
        unused=unread_sheets(source, tables, names.values()),
    )


def unread_sheets(source: SourceFile, tables: Collection[str], read: Collection[str]) -> tuple[str, ...]:
    """Return in words which sheets are not read."""
    left = [sheet for sheet in tables if sheet not in read]
    return (f"{source.name}: sheets not read: {shown_list(left)}.",) if left else ()


def sheets_by_kind(tables: Mapping[str, CellTable | None]) -> dict[TableKind, tuple[str, ...]]:
    """Return the sheets that are tables of a line by their kind, of tables by their sheet."""
    found: dict[TableKind, tuple[str, ...]] = {}
    for sheet, cells in tables.items():
        if cells is not None and (kind := kind_of_table(cells, sheet)):
            found[kind] = (*found.get(kind, ()), sheet)
    return found
