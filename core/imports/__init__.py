"""Lines, vehicles and runs from files of other programs; nothing else of the core knows of it."""

from railjoule.core.imports.columns import INTERVAL_KINDS, PRESETS, ColumnMap, IntervalKind
from railjoule.core.imports.findings import Finding, Imported
from railjoule.core.imports.intervals import read_intervals
from railjoule.core.imports.line import ImportedLine, line_of
from railjoule.core.imports.source_file import SourceFile
from railjoule.core.imports.table import ImportedTable, Interval

__all__ = [
    "INTERVAL_KINDS",
    "PRESETS",
    "ColumnMap",
    "Finding",
    "Imported",
    "ImportedLine",
    "ImportedTable",
    "Interval",
    "IntervalKind",
    "SourceFile",
    "line_of",
    "read_intervals",
]
