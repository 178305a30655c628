"""Lines and vehicles from files of other programs; in the core, only `measured` reads its tables with it."""

from railjoule.core.imports.columns import INTERVAL_KINDS, PRESETS, TABLE_KINDS, ColumnMap
from railjoule.core.imports.findings import Finding, Imported
from railjoule.core.imports.intervals import read_intervals
from railjoule.core.imports.kinds import kind_of_table, sheets_by_kind, tables_of_file
from railjoule.core.imports.line import ImportedLine, LineTable, build_line, read_line_table
from railjoule.core.imports.source_file import SourceFile
from railjoule.core.imports.stations import StationTable, read_stations
from railjoule.core.imports.table import ImportedTable, Interval
from railjoule.core.imports.units import IntervalKind, TableKind

__all__ = [
    "INTERVAL_KINDS",
    "PRESETS",
    "TABLE_KINDS",
    "ColumnMap",
    "Finding",
    "Imported",
    "ImportedLine",
    "ImportedTable",
    "Interval",
    "IntervalKind",
    "LineTable",
    "SourceFile",
    "StationTable",
    "TableKind",
    "build_line",
    "kind_of_table",
    "read_intervals",
    "read_line_table",
    "read_stations",
    "sheets_by_kind",
    "tables_of_file",
]
