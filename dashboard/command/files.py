"""Scenarios, tables and reports that commands read and write; every failure raises one sentence."""

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from railjoule.core import RailjouleError, Scenario, ScenarioError, StrategyRefusedError, load_scenario
from railjoule.core.csv_text import plain_table, write_csv
from railjoule.core.scenario import parse_scenario, preset_names, scenario_of_vehicle
from railjoule.core.scenario.text_file import read_text, read_toml
from railjoule.core.written import write_text, written
from railjoule.dashboard.command.arguments import REPORT_SUFFIXES
from railjoule.dashboard.command.values import VEHICLE, shortened
from railjoule.dashboard.keep.dropped import scenario_in_report
from railjoule.dashboard.provenance import file_attributes

if TYPE_CHECKING:
    import argparse

    import pandas
    import xarray

SCENARIO_TABLES = {
    "vehicle": "vehicle.preset=metro-81-7036",
    "line": "line.preset=liashenko-ii",
    "timetable": "timetable.average_speed_kmh=35",
}
"""The tables that every scenario has, and how an option adds each of them."""


class CommandError(RailjouleError):
    """Something that a command cannot do, in one sentence."""


def show(options: "argparse.Namespace", values: Any, to_text: Callable[[Any], str]) -> None:
    """Print plain values, as JSON where the options ask for it, or as the text that they become."""
    # NaN is no JSON: what is not known must be null by now, see `_finite` in summary.py
    print(json.dumps(values, indent=2, allow_nan=False) if options.json else to_text(values))


def scenario(options: "argparse.Namespace", needed_for: str = "") -> Scenario:
    """Return the scenario that the options name and change: by FILE, or by --scenario if `needed_for` is the reason.

    Raises
    ------
    RailjouleError
        If none is named, there is none, or anything in it is wrong.
    """
    if not needed_for:
        return load(options.file, options.set)
    if options.scenario is None:
        raise CommandError(f"--scenario is missing: {needed_for}.")
    return load(options.scenario, options.set)


def load(file: str, changes: Mapping[str, Any]) -> Scenario:
    """Return the scenario of a file or report, or the shipped one of that name, with changes.

    Raises
    ------
    RailjouleError
        If there is none, or anything in it is wrong.
    """
    if file.startswith(VEHICLE):
        file = scenario_of_vehicle(file.removeprefix(VEHICLE))
    try:
        known = Path(file).exists() or file in preset_names("scenarios")
        # a name with a suffix is meant for a file, which is missing then
        if not known and not Path(file).suffix:
            choices = ", ".join(preset_names("scenarios"))
            raise CommandError(f"{file}: there is no such file or shipped scenario; choose one of {choices}.")
        if Path(file).suffix.lower() in REPORT_SUFFIXES:
            name = Path(file).name
            return parse_scenario(scenario_in_report(read_text(Path(file)), name), name, changes=changes)
        try:
            return load_scenario(file, changes)
        except ScenarioError:
            require_tables(Path(file), changes)
            raise
    except OSError as error:
        raise CommandError(f"{shortened(file)}: {error.strerror or error}.") from None


def require_tables(path: Path, changes: Mapping[str, Any]) -> None:
    """Raise CommandError, with the next step, for a file that holds only some tables of a scenario, such as a line."""
    if not path.is_file():
        return
    given = {*read_toml(read_text(path), path.name), *(key.partition(".")[0] for key in changes)}
    there = [f"[{table}]" for table in SCENARIO_TABLES if table in given]
    missing = [table for table in SCENARIO_TABLES if table not in given]
    if there and missing:
        raise CommandError(
            f"{path.name}: holds only {' and '.join(there)}, and a scenario also needs "
            f"{' and '.join(f'[{table}]' for table in missing)}. Add it to the file, or name it here, such as --set "
            f"{' '.join(SCENARIO_TABLES[table] for table in missing)}."
        )


def read_table(path: Path) -> "pandas.DataFrame":
    """Return the table of a file.

    Raises
    ------
    CommandError
        If there is none, or it cannot be read.
    """
    import pandas  # noqa: PLC0415  (slow to import, and rarely needed)

    name, is_parquet = shortened(path), path.suffix.lower() == ".parquet"
    try:
        return pandas.read_parquet(path) if is_parquet else plain_table(pandas.read_csv(path))
    except FileNotFoundError:
        raise CommandError(f"{name}: there is no such file.") from None
    except OSError as error:
        raise CommandError(f"{name}: {error.strerror or error}.") from None
    except ValueError as error:
        words = " ".join(str(error).split()).rstrip(".")
        raise CommandError(f"{name} is not a table in {path.suffix[1:]}: {shortened(words)}.") from None


def write_table(table: "pandas.DataFrame", path: Path, index: bool = False) -> None:
    """Write a table, with its index if asked for.

    Raises
    ------
    CommandError
        If the file cannot be written.
    """
    with failures_named(path), written(path) as place:
        if path.suffix.lower() == ".csv":
            write_csv(table, place, index)
        else:
            table.to_parquet(place, index=index)


def write_labelled_table(table: "xarray.Dataset", path: Path) -> None:
    """Write a labelled table in the format of its suffix; errors as `write_table`."""
    if path.suffix.lower() != ".nc":
        write_table(table.to_dataframe(), path, index=True)
        return
    with failures_named(path), written(path) as place:
        # scipy is there anyway; the default engine would need one of netCDF's own libraries
        table.assign_attrs(file_attributes()).to_netcdf(place, engine="scipy")


def write(path: Path, text: str) -> None:
    """Write a text; errors as `write_table`."""
    with failures_named(path):
        write_text(path, text)


@contextmanager
def failures_named(path: Path) -> Iterator[None]:
    """Turn a failure to write a file into a sentence that names it."""
    try:
        yield
    except OSError as error:
        raise CommandError(f"{shortened(path)} cannot be written: {error.strerror or error}.") from None


@contextmanager
def refusals_named(strategy: str) -> Iterator[None]:
    """Turn a strategy's refusal into a sentence that names it."""
    try:
        yield
    except StrategyRefusedError as refusal:
        raise CommandError(f"{strategy} {refusal}") from None
