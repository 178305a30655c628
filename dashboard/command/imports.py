"""The command `railjoule import`: read files of other programs, write the result, and tell what was not used."""

import argparse
import math
import sys
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railjoule.core.imports import (
    PRESETS,
    TABLE_KINDS,
    ColumnMap,
    Finding,
    Imported,
    ImportedLine,
    SourceFile,
    TableKind,
    build_line,
    read_line_table,
    tables_of_file,
)
from railjoule.core.scenario import Line, Vehicle, scenario_from_document
from railjoule.core.scenario._sentences import counted
from railjoule.core.scenario.text_file import read_text, read_toml
from railjoule.dashboard.command import files, terminal
from railjoule.dashboard.command.files import CommandError
from railjoule.dashboard.command.values import LONGEST_TIME_S, printable, shortened

if TYPE_CHECKING:
    from railjoule.core.imports.ttobench import ImportedScenario

ASSUMED_SLACK = 0.1
"""Slack over the shortest time if no travel time is given; reported, and easily changed in the file."""


def intervals(options: argparse.Namespace) -> None:
    """Put a line together from tables of intervals."""
    target: Path = options.output
    as_table = target.suffix.lower() == ".csv"
    if options.vehicle is None and options.travel_time_s is not None:
        raise CommandError("--travel-time-s needs --vehicle: a line has no timetable.")
    if options.vehicle is not None and as_table:
        raise CommandError(f"-o {shortened(target)}: must end in .toml with --vehicle, which makes a scenario.")
    train = {} if options.vehicle is None else _train(options.vehicle)
    maps = _column_maps(options)
    given, unread = _line_files(options, maps)
    if missing := [kind for kind in maps if kind not in given]:
        raise CommandError(f"--{missing[0]} is missing, whose columns are named.")
    tables: dict[str, Any] = {kind: read_line_table(source, kind, maps.get(kind)) for kind, source in given.items()}
    line = build_line(
        **tables, begin_m=options.begin, end_m=options.end, reverse=options.reverse, name=options.name or ""
    )
    line = replace(line, unused=(*line.unused, *unread))
    if train:
        _write_scenario(target, _build_scenario(line, train, options.travel_time_s))
        return
    files.write(target, line.to_csv() if as_table else line.to_toml())
    # a table of sections has no row for them
    for words, parts in (("neutral ones", line.line.neutral_sections), ("stations", line.line.stations)):
        if as_table and parts:
            line = replace(line, unused=(*line.unused, f"{target.name}: it contains only sections, no {words}."))
    _tell(line, target, _line_words(line.line))


def _line_files(
    options: argparse.Namespace, maps: dict[TableKind, ColumnMap]
) -> tuple[dict[TableKind, SourceFile], list[str]]:
    """Return the file of each kind of table, named or found by its columns, and in words what is not read.

    `maps` receives the columns of published tables.
    """
    named: dict[TableKind, Any] = {kind: getattr(options, kind) for kind in TABLE_KINDS}
    given = {kind: SourceFile.read(file, options.encoding) for kind, file in named.items() if file is not None}
    unread: list[str] = []
    for name in options.files:
        source = SourceFile.read(name, options.encoding)
        chosen = {kind: one.sheet for kind, one in maps.items() if one.sheet is not None and kind not in given}
        found = tables_of_file(source, chosen)
        unread += found.unused
        for kind, (table, columns) in found.tables.items():
            # a file that is named precedes
            if kind in given and named[kind] is None:
                raise CommandError(
                    f"{given[kind].name} and {table.name} are both tables of {kind}; leave out one of them."
                )
            if kind not in given:
                given[kind], maps[kind] = table, maps.get(kind, ColumnMap()).over(columns)
    return given, unread


def _train(name: str) -> Mapping[str, Any]:
    """Return the tables of a vehicle: of a file that has them, or those that name a shipped vehicle."""
    if Path(name).suffix.lower() != ".toml":
        return {"vehicle": {"preset": name}}
    path = Path(name)
    with files.failures_named(path):
        document = read_toml(read_text(path), path.name)
    if "vehicle" not in document:
        raise CommandError(f"--vehicle {shortened(name)}: has no table [vehicle].")
    return {key: document[key] for key in ("vehicle", "drive") if key in document}


def _build_scenario(line: ImportedLine, train: Mapping[str, Any], travel_time_s: float | None) -> "ImportedScenario":
    """Return the scenario of a train on an imported line, in a given time or in some time that it can keep."""
    from railjoule.core.imports.ttobench import ImportedScenario  # noqa: PLC0415

    # the longest time that a scenario may have: only here to read vehicle and line
    any_time = {"timetable": {"travel_time_s": LONGEST_TIME_S}}
    whole = scenario_from_document({**train, **line.document, **any_time}, line.source)
    title = f"{whole.line.name or 'Own line'}, {whole.vehicle.name}"[:200]
    imported = ImportedScenario(
        line.source,
        {"title": title, **train, **line.document},
        line=whole.line,
        vehicle=whole.vehicle,
        findings=line.findings,
        unused=line.unused,
    )
    travel_time_s = line.travel_time_s if travel_time_s is None else travel_time_s
    if travel_time_s is None:
        return _with_some_time(imported, "no --travel-time-s")
    document = {**imported.document, "timetable": {"travel_time_s": travel_time_s}}
    return replace(imported, document=document, travel_time_s=travel_time_s)


def _write_scenario(target: Path, imported: "ImportedScenario") -> None:
    # the time that the options name is checked here
    scenario = scenario_from_document(imported.document, imported.source)
    files.write(target, imported.to_toml())
    _tell(imported, target, f"{_line_words(scenario.line)}, {terminal.time(scenario.travel_time_s)} s")


def ttobench(options: argparse.Namespace) -> None:
    """Make a scenario of a track and a train of TTOBench."""
    from railjoule.core.imports.ttobench import read_ttobench  # noqa: PLC0415

    track, train = (SourceFile.read(name, options.encoding) for name in (options.file, options.train))
    journey = None if options.journey is None else SourceFile.read(options.journey, options.encoding)
    imported = read_ttobench(track, train, journey, stops=options.stops, travel_time_s=options.travel_time_s)
    if imported.travel_time_s is None:
        imported = _with_some_time(imported, "no journey and no --travel-time-s")
    _write_scenario(options.output, imported)


def _with_some_time(imported: "ImportedScenario", missing: str) -> "ImportedScenario":
    """Return a scenario without a time with one that its train can keep; `missing` names what would have said it."""
    from railjoule.core.strategies import prepare_task  # noqa: PLC0415

    timetable = {**imported.document.get("timetable", {}), "travel_time_s": LONGEST_TIME_S}
    any_time = {**imported.document, "timetable": timetable}
    shortest = prepare_task(scenario_from_document(any_time, imported.source)).shortest_travel_time_s
    travel_time = math.ceil((1 + ASSUMED_SLACK) * shortest)
    sentence = (
        f"{missing}: {travel_time} s, {100 * ASSUMED_SLACK:g} % above the shortest possible "
        f"{terminal.time(shortest)} s."
    )
    return imported.with_travel_time(float(travel_time), Finding("assumption", sentence))


def osrd_stock(options: argparse.Namespace) -> None:
    """Make a vehicle of a rolling stock of OSRD."""
    from railjoule.core.imports.osrd_stock import read_osrd_stock  # noqa: PLC0415

    vehicle = read_osrd_stock(SourceFile.read(options.file, options.encoding), options.mode, options.train)
    files.write(options.output, vehicle.to_toml())
    _tell(vehicle, options.output, _vehicle_words(vehicle.vehicle))


def railtoolkit(options: argparse.Namespace) -> None:
    """Make a vehicle or a line of a file of railtoolkit."""
    from railjoule.core.imports.railtoolkit import read_railtoolkit  # noqa: PLC0415

    imported = read_railtoolkit(SourceFile.read(options.file, options.encoding), options.train)
    files.write(options.output, imported.to_toml())
    description = _line_words(imported.line) if isinstance(imported, ImportedLine) else _vehicle_words(imported.vehicle)
    _tell(imported, options.output, description)


def data_sheet(options: argparse.Namespace) -> None:
    """Make a vehicle of the values of a data sheet."""
    from railjoule.core.imports.data_sheet import read_data_sheet  # noqa: PLC0415

    vehicle = read_data_sheet(dict(options.sheet), "data sheet")
    files.write(options.output, vehicle.to_toml())
    _tell(vehicle, options.output, _vehicle_words(vehicle.vehicle))


def measured_run(options: argparse.Namespace) -> None:
    """Convert a table of a recorder to a table of a run with the columns of railjoule."""
    import pandas  # noqa: PLC0415  (slow to import, and rarely needed)

    from railjoule.core.measured import RecorderFormat, recorder_cells, run_table  # noqa: PLC0415

    form = RecorderFormat(options.preset, dict(options.column), dict(options.unit), encoding=options.encoding)
    source = SourceFile.read(options.file, options.encoding)
    run = run_table(recorder_cells(source, form, options.sheet), form)
    files.write_table(pandas.DataFrame(run.columns), options.output)
    _print_on_stderr(f"{run.source}: {note}" for note in run.notes)
    length, time = (float(run.columns[name][-1]) for name in ("position_m", "time_s"))
    rows = counted(len(run.columns["time_s"]), "row")
    print(f"{options.output}: {terminal.distance(length)} km in {terminal.time(time)} s, {rows}")


def _vehicle_words(vehicle: Vehicle) -> str:
    mass, speed = terminal.number(vehicle.total_mass_kg / 1000), terminal.number(vehicle.traction.max_speed_kmh)
    return f"{printable(vehicle.name)}, {mass} t, {speed} km/h"


def _line_words(line: Line) -> str:
    stations = f", {counted(len(line.stations), 'station')}" if line.stations else ""
    return f"{terminal.distance(line.length_m)} km, {counted(len(line.sections), 'section')}{stations}"


def _column_maps(options: argparse.Namespace) -> dict[TableKind, ColumnMap]:
    """Return the options for the columns of each table."""
    maps: dict[TableKind, ColumnMap] = {}
    for name in options.preset:
        if name not in PRESETS:
            raise CommandError(f"--preset {shortened(name)}: must be one of {', '.join(PRESETS)}.")
        kind, columns = PRESETS[name]
        maps[kind] = columns
    said = [(kind, ColumnMap.of(key, value)) for kind, key, value in options.columns]
    said += [(kind, ColumnMap(rows={key: value})) for kind, key, value in options.rows]
    for kind, columns in said:
        maps[kind] = columns.over(maps.get(kind, ColumnMap()))
    return maps


def _tell(imported: Imported, target: Path, what: str) -> None:
    """Print what was written, and on standard error what its reader should know and what was not used."""
    _print_on_stderr(finding.sentence for finding in imported.findings)
    _print_on_stderr(f"not used: {sentence}" for sentence in imported.unused)
    print(f"{target}: {what}")


def _print_on_stderr(lines: Iterable[str]) -> None:
    for line in lines:
        print(printable(line), file=sys.stderr)
