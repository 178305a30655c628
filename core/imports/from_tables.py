"""Lines from tables in one call, for programs."""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.columns import INTERVAL_KINDS, ColumnMap
from railjoule.core.imports.intervals import read_intervals
from railjoule.core.imports.line import Stop, line_of
from railjoule.core.imports.source_file import SourceFile
from railjoule.core.imports.units import IntervalKind
from railjoule.core.scenario import Line, Station
from railjoule.core.scenario._sentences import shorten

if TYPE_CHECKING:
    import pandas


def line_from_tables(
    tables: Mapping[IntervalKind, "str | Path | pandas.DataFrame | None"],
    stations: Sequence[Station],
    settings: Mapping[str, str],
    begin_m: float | None,
    end_m: float | None,
    reverse: bool,
    name: str,
) -> Line:
    """Return the line that tables describe; arguments as in `Line.from_tables`."""
    maps: dict[str, ColumnMap] = {}
    for path, value in settings.items():
        kind, _, key = path.partition(".")
        if kind not in INTERVAL_KINDS or not key:
            raise ScenarioError(
                f"settings: {shorten(path)} must begin with the kind of its table and a dot; choose one of "
                f"{', '.join(INTERVAL_KINDS)}."
            )
        maps[kind] = ColumnMap.of(key, value).over(maps.get(kind, ColumnMap()))
    read = {
        kind: read_intervals(_source(kind, table), kind, maps.get(kind))
        for kind, table in tables.items()
        if table is not None
    }
    if not read:
        raise ScenarioError("Line.from_tables needs at least one table of gradients, limits, curves or tunnels.")
    stops = [
        Stop(one.name, one.position_m, one.dwell_s, one.earliest_arrival_s, one.latest_arrival_s) for one in stations
    ]
    found = line_of(**read, stops=stops, begin_m=begin_m, end_m=end_m, reverse=reverse, name=name)
    for sentence in (*(finding.sentence for finding in found.findings), *found.unused):
        # the reader of a table should know what was assumed, and a program has no page that lists it
        warnings.warn(sentence, stacklevel=3)
    return found.line


def _source(kind: str, table: "str | Path | pandas.DataFrame") -> SourceFile:
    """Return a table as a file that the readers of imports take."""
    if isinstance(table, str | Path):
        return SourceFile.read(table)
    if not hasattr(table, "to_csv"):
        raise ScenarioError(
            f"{kind} has the type {type(table).__name__}; it must be the path of a table or a DataFrame."
        )
    return SourceFile(kind, table.to_csv(index=False).encode())
