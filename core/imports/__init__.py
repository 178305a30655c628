"""Lines and vehicles from files of other programs; in the core, only `measured` reads its tables with it."""

from railjoule.core.imports.columns import INTERVAL_KINDS, PRESETS, ColumnMap
from railjoule.core.imports.findings import Finding, Imported
from railjoule.core.imports.intervals import read_intervals
from railjoule.core.imports.line import ImportedLine, build_line
from railjoule.core.imports.source_file import SourceFile
from railjoule.core.imports.table import ImportedTable, Interval
from railjoule.core.imports.units import IntervalKind

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
    "build_line",
    "read_intervals",
]
