"""The command `railjoule import`: read files of other programs."""

import argparse
import math
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railjoule.core.imports import (
    INTERVAL_KINDS,
    PRESETS,
    ColumnMap,
    Finding,
    Imported,
    ImportedLine,
    IntervalKind,
    SourceFile,
    build_line,
    read_intervals,
)
from railjoule.core.imports.numbers import parse_position
from railjoule.core.scenario import Line, Vehicle, scenario_from_document
from railjoule.core.scenario._sentences import counted
from railjoule.core.scenario.text_file import read_text, read_toml
from railjoule.core.written import write_text
from railjoule.dashboard.command import terminal
from railjoule.dashboard.command.cli import LONGEST_TIME_S
from railjoule.dashboard.command.commands import (
    TABLE_SUFFIXES,
    CommandError,
    failures_named,
    quantities,
    shortened,
    table_file,
    write_table,
)

if TYPE_CHECKING:
    from railjoule.core.imports.ttobench import ImportedScenario

ASSUMED_SLACK = 0.1
"""Slack over the shortest time where nothing tells a travel time; told, and easily changed in the file."""


def run(options: argparse.Namespace) -> None:
    """Read the files that the options name, write the result, and tell what was noticed and not used.

    Raises
    ------
    RailjouleError
        If anything is wrong with a file or an option.
    """
    READERS[options.format](options)


def intervals(options: argparse.Namespace) -> None:
    """Put a line together from tables of intervals."""
    target = _target(options.output, (".toml", ".csv"))
    if options.vehicle is None and options.travel_time_s is not None:
        raise CommandError("--travel-time-s needs --vehicle: a line alone has no timetable.")
    if options.vehicle is not None and target.suffix.lower() == ".csv":
        raise CommandError(f"-o {shortened(options.output)}: must end in .toml with --vehicle, which makes a scenario.")
    train = {} if options.vehicle is None else _train(options.vehicle)
    maps = _column_maps(options)
    files = {kind: getattr(options, kind) for kind in INTERVAL_KINDS if getattr(options, kind) is not None}
    for kind in maps:
        if kind not in files:
            raise CommandError(f"--{kind} is missing, whose columns are named.")
    tables: dict[str, Any] = {
        kind: read_intervals(SourceFile.read(file, options.encoding), kind, maps.get(kind))
        for kind, file in files.items()
    }
    line = build_line(
        **tables,
        begin_m=_place("--begin", options.begin),
        end_m=_place("--end", options.end),
        reverse=options.reverse,
        name=options.name or "",
    )
    if train:
        scenario = _scenario_of(line, train, options.travel_time_s)
        _write_scenario(target, scenario)
        return
    if target.suffix.lower() != ".csv":
        _write(target, line.to_toml())
    else:
        _write(target, line.to_csv())
        # a table of sections has no row for them
        if line.line.neutral_sections:
            line = replace(line, unused=(*line.unused, f"{target.name}: it holds sections alone, no neutral ones."))
    _tell(line)
    print(f"{target}: {_line_words(line.line)}")


def _train(name: str) -> Mapping[str, Any]:
    """Return the tables of a vehicle: of a file that has them, or those that name a shipped vehicle."""
    if Path(name).suffix.lower() != ".toml":
        return {"vehicle": {"preset": name}}
    path = Path(name)
    with failures_named(path):
        document = read_toml(read_text(path), path.name)
    if "vehicle" not in document:
        raise CommandError(f"--vehicle {shortened(name)}: has no table [vehicle].")
    return {key: document[key] for key in ("vehicle", "drive") if key in document}


def _scenario_of(line: ImportedLine, train: Mapping[str, Any], travel_time_s: float | None) -> "ImportedScenario":
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
    if travel_time_s is None:
        return _with_some_time(imported, "no --travel-time-s")
    document = {**imported.document, "timetable": {"travel_time_s": travel_time_s}}
    return replace(imported, document=document, travel_time_s=travel_time_s)


def _write_scenario(target: Path, imported: "ImportedScenario") -> None:
    # the time that the options name is checked here
    scenario = scenario_from_document(imported.document, imported.source)
    _write(target, imported.to_toml())
    _tell(imported)
    print(f"{target}: {_line_words(scenario.line)}, {terminal.time(scenario.travel_time_s)} s")


def ttobench(options: argparse.Namespace) -> None:
    """Make a scenario of a track and a train of TTOBench."""
    from railjoule.core.imports.ttobench import read_ttobench  # noqa: PLC0415

    target = _target(options.output, (".toml",))
    imported = read_ttobench(
        SourceFile.read(options.file, options.encoding),
        SourceFile.read(options.train, options.encoding),
        None if options.journey is None else SourceFile.read(options.journey, options.encoding),
        stops=options.stops,
        travel_time_s=options.travel_time_s,
    )
    if imported.travel_time_s is None:
        imported = _with_some_time(imported, "no journey and no --travel-time-s")
    _write_scenario(target, imported)


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

    target = _target(options.output, (".toml",))
    vehicle = read_osrd_stock(SourceFile.read(options.file, options.encoding), options.mode, options.train)
    _write(target, vehicle.to_toml())
    _tell(vehicle)
    print(f"{target}: {_vehicle_words(vehicle.vehicle)}")


def railtoolkit(options: argparse.Namespace) -> None:
    """Make a vehicle or a line of a file of railtoolkit."""
    from railjoule.core.imports.railtoolkit import read_railtoolkit  # noqa: PLC0415

    target = _target(options.output, (".toml",))
    imported = read_railtoolkit(SourceFile.read(options.file, options.encoding), options.train)
    _write(target, imported.to_toml())
    _tell(imported)
    told = _line_words(imported.line) if isinstance(imported, ImportedLine) else _vehicle_words(imported.vehicle)
    print(f"{target}: {told}")


def measured_run(options: argparse.Namespace) -> None:
    """Convert a table of a recorder to a table of a run with the columns of railjoule."""
    import pandas  # noqa: PLC0415  (slow to import, and rarely needed)

    from railjoule.core.measured import RecorderFormat, recorder_cells, run_table  # noqa: PLC0415

    target = _target(options.output, TABLE_SUFFIXES)
    columns, units = quantities("--column", options.column), quantities("--unit", options.unit)
    form = RecorderFormat(options.preset, columns, units, encoding=options.encoding)
    source = SourceFile.read(options.file, options.encoding)
    path = table_file(str(target), "-o")  # says what parquet needs
    run = run_table(recorder_cells(source, form, options.sheet), form)
    write_table(pandas.DataFrame(run.columns), path, index=False)
    _print_on_stderr(f"{run.source}: {note}" for note in run.notes)
    length, time = (float(run.columns[name][-1]) for name in ("position_m", "time_s"))
    rows = counted(len(run.columns["time_s"]), "row")
    print(f"{target}: {terminal.distance(length)} km in {terminal.time(time)} s, {rows}")


def _vehicle_words(vehicle: Vehicle) -> str:
    mass, speed = terminal.number(vehicle.total_mass_kg / 1000), terminal.number(vehicle.traction.max_speed_kmh)
    return f"{terminal.printable(vehicle.name)}, {mass} t, {speed} km/h"


READERS: Mapping[str, Callable[[argparse.Namespace], None]] = {
    "intervals": intervals,
    "ttobench": ttobench,
    "osrd-stock": osrd_stock,
    "railtoolkit": railtoolkit,
    "run": measured_run,
}


def _line_words(line: Line) -> str:
    return f"{terminal.distance(line.length_m)} km, {counted(len(line.sections), 'section')}"


def _column_maps(options: argparse.Namespace) -> dict[IntervalKind, ColumnMap]:
    """Return what the options say of each table's columns."""
    maps: dict[IntervalKind, ColumnMap] = {}
    for name in options.preset:
        if name not in PRESETS:
            raise CommandError(f"--preset {shortened(name)}: must be one of {', '.join(PRESETS)}.")
        kind, columns = PRESETS[name]
        maps[kind] = columns
    for kind, key, value in _settings("--columns", options.columns):
        maps[kind] = ColumnMap.of(key, value).over(maps.get(kind, ColumnMap()))
    for kind, key, value in _settings("--rows", options.rows):
        maps[kind] = ColumnMap(rows={key: value}).over(maps.get(kind, ColumnMap()))
    return maps


def _settings(option: str, given: Sequence[str]) -> Iterable[tuple[IntervalKind, str, str]]:
    """Return the parts of words 'TABLE.KEY=VALUE'."""
    for word in given:
        path, equals, value = word.partition("=")
        table, dot, key = path.partition(".")
        kind = next((kind for kind in INTERVAL_KINDS if kind == table), None)
        if kind is None or not (equals and dot and key):
            raise CommandError(
                f"{option} {shortened(word)}: must be TABLE.KEY=VALUE, where TABLE is {', '.join(INTERVAL_KINDS)}."
            )
        yield kind, key, value


def _place(option: str, text: str | None) -> float | None:
    """Return a chainage [m], as '12345', '12+345', '12.345km' or '7mi 40ch'."""
    if text is None:
        return None
    try:
        return parse_position(text, "m", ".")
    except ValueError as error:
        raise CommandError(f"{option} {shortened(text)} {error}.") from None


def _target(name: str, suffixes: Sequence[str], option: str = "-o") -> Path:
    path = Path(name)
    if path.suffix.lower() not in suffixes:
        raise CommandError(f"{option} {shortened(name)}: must end in {' or '.join(suffixes)}.")
    return path


def _write(path: Path, text: str) -> None:
    with failures_named(path):
        write_text(path, text)


def _tell(imported: Imported) -> None:
    """Print on standard error what the reader of the files should know, and what was not used."""
    _print_on_stderr(finding.sentence for finding in imported.findings)
    _print_on_stderr(f"not used: {sentence}" for sentence in imported.unused)


def _print_on_stderr(lines: Iterable[str]) -> None:
    for line in lines:
        # a file's text may hold control characters, which a terminal would obey
        print(terminal.printable(line), file=sys.stderr)
