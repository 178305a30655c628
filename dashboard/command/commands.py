"""What the commands of `railjoule` do; their words are read in `railjoule.dashboard.command.cli`."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from railjoule.core import (
    RailjouleError,
    Scenario,
    ScenarioError,
    StrategyRefusedError,
    check_run,
    check_table,
    compare,
    load_scenario,
)
from railjoule.core import solve as solve_scenario
from railjoule.core.bounds import LONGEST_PROOF_S
from railjoule.core.csv_text import plain_table, write_csv
from railjoule.core.parquet import NEEDED, has_parquet
from railjoule.core.scenario import parse_scenario, preset_names
from railjoule.core.scenario.text_file import read_text, read_toml
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.arrival_windows import missed_windows
from railjoule.core.strategy import STRATEGIES
from railjoule.core.written import write_text, written
from railjoule.dashboard.command import summary, terminal
from railjoule.dashboard.keep.embedded import scenario_in_report
from railjoule.dashboard.limits import limits as all_limits
from railjoule.dashboard.provenance import file_attributes
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.report.section_names import SECTION_TITLES
from railjoule.dashboard.scenario_folder import ScenarioFolder, default_folder

if TYPE_CHECKING:
    import pandas
    import xarray

    from railjoule.dashboard.server.options import ServerOptions

TABLE_SUFFIXES = (".csv", ".parquet")
LABELLED_SUFFIXES = (".nc", *TABLE_SUFFIXES)
REPORT_SUFFIXES = (".html", ".htm")


class CommandError(RailjouleError):
    """Something that a command cannot do, in one sentence."""


@dataclass(frozen=True)
class Output:
    """How a result is shown: as JSON or for people."""

    as_json: bool

    def show(self, values: Any, to_text: Callable[[Any], str]) -> None:
        """Print plain values, as JSON or as the text that they become."""
        # NaN is no JSON: what is not known must be null by now, see `_finite` in summary.py
        print(json.dumps(values, indent=2, allow_nan=False) if self.as_json else to_text(values))


def solve(
    file: str,
    changes: Mapping[str, Any],
    strategy: str | None,
    trajectory_file: str | None,
    output: Output,
    with_check: bool = False,
    prove_seconds: float | None = None,
) -> bool:
    """Solve a scenario, write its trajectory if wanted, and show the result; return whether it passed its check.

    Raises
    ------
    CommandError
        If the run that is shown misses a window of arrival.
    RailjouleError
        If anything is wrong with the scenario or the file to write.
    """
    # first of all: a name that cannot be written to is refused before anything is solved
    target = None if trajectory_file is None else table_file(trajectory_file)
    scenario = load(file, changes)
    with refusals_named(strategy or scenario.strategy):
        # a name that is none is refused by the core, in its own words
        trajectory = solve_scenario(scenario, strategy, prove_seconds=prove_seconds)
    if target is not None:
        write_table(trajectory.to_dataframe(), target, index=False)
    task = prepare_task(scenario)
    values = summary.summarise(trajectory, task.shortest_travel_time_s)
    result = check_run(scenario, trajectory) if with_check else None
    if result is None:
        output.show(values, terminal.solution_text)
    else:
        output.show({**values, "check": summary.summarise_check(result)}, terminal.checked_solution_text)
    if missed := missed_windows(task, trajectory):
        raise CommandError(" ".join(missed))
    return result is None or result.ok


def check(
    run_file: str,
    scenario_file: str | None,
    changes: Mapping[str, Any],
    strategy: str | None,
    output: Output,
) -> bool:
    """Check the run of a file against its scenario, and show the result; return whether it keeps every rule.

    Raises
    ------
    RailjouleError
        If the file holds no run, no scenario is named, or anything is wrong with it.
    """
    table = read_table(run_file)
    if scenario_file is None:
        raise CommandError("--scenario is missing: the file of a run does not contain its scenario.")
    scenario = load(scenario_file, changes)
    if strategy is not None and strategy not in STRATEGIES:
        raise CommandError(f"--strategy {shortened(strategy)}: must be one of {', '.join(STRATEGIES)}.")
    try:
        result = check_table(scenario, cast("Mapping[str, Any]", table), strategy)
    except ScenarioError as error:
        raise CommandError(f"{shortened(run_file)} {error}") from None
    output.show(summary.summarise_check(result), terminal.check_text)
    return result.ok


def compare_strategies(
    file: str,
    changes: Mapping[str, Any],
    output: Output,
    prove_seconds: float | None = None,
) -> None:
    """Run every strategy that takes a scenario, and show the results side by side.

    Raises
    ------
    RailjouleError
        If anything is wrong with the scenario.
    """
    scenario = load(file, changes)
    found = compare(scenario, prove_seconds=prove_seconds)
    values = summary.summarise_comparison(found.runs, found.refused, prepare_task(scenario).shortest_travel_time_s)
    output.show(values, terminal.comparison_text)


def advise(file: str, changes: Mapping[str, Any], most: int | None, output: Output) -> None:
    """Show the best runs with few changes of regime, their price against the optimum, and the orders of one of them.

    Raises
    ------
    RailjouleError
        If anything is wrong with the scenario, or no such run is in time.
    """
    from railjoule.core.studies.simple_advice import MAX_CHANGES, simple_advice  # noqa: PLC0415

    task = prepare_task(load(file, changes))
    advice = simple_advice(task, MAX_CHANGES if most is None else most)
    output.show(summary.summarise_advice(advice, last=most is not None), terminal.simple_advice_text)


def simulate(file: str, changes: Mapping[str, Any], output: Output) -> None:
    """Plan a scenario, drive it under its disturbance, and show both.

    Raises
    ------
    RailjouleError
        If anything is wrong with the scenario, or the real train cannot pass the line.
    """
    scenario = load(file, changes)
    with refusals_named(scenario.strategy):
        # each kind alone: all of them take a tenth of a second to import
        if scenario.simulation.kind == "field_oriented":
            from railjoule.core.simulation.field_oriented import simulate_field_oriented  # noqa: PLC0415

            run = simulate_field_oriented(scenario)
            output.show(summary.summarise_field_oriented(run), terminal.field_oriented_text)
        elif scenario.disturbance.events:
            from railjoule.core.simulation.actual_run import actual_run  # noqa: PLC0415

            output.show(summary.summarise_actual(actual_run(scenario)), terminal.ride_text)
        else:
            from railjoule.core.simulation.following import simulate_following  # noqa: PLC0415

            output.show(summary.summarise_following(simulate_following(scenario)), terminal.following_text)


def study(name: str, file: str, changes: Mapping[str, Any], target: str) -> None:
    """Solve many variants of a scenario, and write them as a labelled table.

    Raises
    ------
    RailjouleError
        If anything is wrong with the scenario or the file to write.
    """
    from railjoule.core.studies import (  # noqa: PLC0415
        energy_time_frontier,
        frontier_times,
        monte_carlo,
        sensitivity,
        study_braking_sensors,
    )
    from railjoule.core.studies.rows import worker_count  # noqa: PLC0415

    path = table_file(target, "-o", LABELLED_SUFFIXES)
    scenario = load(file, changes)
    with ThreadPoolExecutor(worker_count(), "study") as executor, refusals_named(scenario.strategy):
        if name == "sensitivity":
            table = sensitivity(scenario, executor=executor).to_xarray()
        elif name == "montecarlo":
            table = monte_carlo(scenario, executor).to_xarray()
        elif name == "braking":
            table = study_braking_sensors(scenario, executor).table.to_xarray()
        else:
            task = prepare_task(scenario)
            table = energy_time_frontier(task, frontier_times(task), executor=executor).to_xarray()
    write_labelled_table(table, path)
    shape = " x ".join(f"{size} {dimension}" for dimension, size in table.sizes.items())
    print(f"{shortened(str(path))}: {shape}")


def write_labelled_table(table: "xarray.Dataset", path: Path) -> None:
    """Write a labelled table in the format of its suffix.

    Raises
    ------
    CommandError
        If the file cannot be written.
    """
    if path.suffix.lower() == ".nc":
        with failures_named(path), written(path) as place:
            # scipy is there anyway; the default engine would need one of netCDF's own libraries
            table.assign_attrs(file_attributes()).to_netcdf(place, engine="scipy")
    else:
        write_table(table.to_dataframe(), path, index=True)


def report(
    file: str,
    changes: Mapping[str, Any],
    strategy: str | None,
    target: str,
    prove_seconds: float | None = None,
    contents: Contents | None = None,
) -> None:
    """Write what there is to tell of a scenario as one file of HTML, by default everything.

    Raises
    ------
    RailjouleError
        If anything is wrong with the scenario or the file to write, or a package of the dashboard is missing.
    """
    path = table_file(target, "-o", REPORT_SUFFIXES)
    scenario = load(file, changes if strategy is None else {**changes, "strategy": strategy})
    with missing_named("a report"):
        from railjoule.dashboard.report.document import report_html  # noqa: PLC0415
        from railjoule.dashboard.report.findings import ReportRequest, compute_findings  # noqa: PLC0415
    request = ReportRequest(scenario, prove_seconds=prove_seconds, contents=contents or Contents())
    *_, findings = compute_findings(request)
    text = report_html(findings, datetime.now().astimezone())
    with failures_named(path):
        write_text(path, text)
    print(f"{shortened(str(path))}: {len(text.encode()) / 1e6:.1f} MB")


def report_contents(sections: Sequence[str], author: str, note: str | None) -> Contents:
    """Return what a report shall tell, its sections separated by spaces or commas; all where none is named.

    Raises
    ------
    RailjouleError
        If the note cannot be read, or there can be no such report.
    """
    text = "" if note is None else read_text(Path(note)).strip()
    named = tuple(name for word in sections for name in word.split(",") if name)
    return Contents(named or tuple(SECTION_TITLES), author.strip(), text)


def benchmark(output: Output) -> None:
    """Show how long all solvers take on the shipped scenarios."""
    from railjoule.core.validation.benchmark import benchmark as time_all  # noqa: PLC0415
    from railjoule.core.validation.ipopt import is_installed  # noqa: PLC0415

    values = summary.summarise_benchmark(list(time_all()))
    output.show({**values, "ipopt": is_installed()}, terminal.benchmark_text)


def validate(paper: str | None, output: Output) -> None:
    """Show the printed numbers and claims of one or all papers with those of railjoule.

    Raises
    ------
    CommandError
        If the paper is not known.
    """
    from railjoule.core.validation import PAPERS  # noqa: PLC0415

    if paper is not None and paper not in PAPERS:
        raise CommandError(f"{paper!r} is not a paper of this version; choose one of {', '.join(PAPERS)}.")
    chosen = PAPERS if paper is None else {paper: PAPERS[paper]}
    validations = [compute() for compute in chosen.values()]
    output.show(summary.summarise_validations(validations), terminal.validations_text)


def compile_kernels() -> None:
    """Compile the solver, and print where the compiled code is."""
    from railjoule.core.compilation import require_compiled  # noqa: PLC0415
    from railjoule.core.kernel_cache import cache_folder  # noqa: PLC0415

    require_compiled()
    print(f"The solver is compiled; the code is in {cache_folder()}.")


def serve(options: "ServerOptions", folder: ScenarioFolder | None = None) -> None:
    """Serve the dashboard, with a folder of scenario files where there is one, until it is interrupted.

    Raises
    ------
    CommandError
        If a package of the dashboard is missing, or the address cannot be served at.
    """
    from railjoule.core.compilation import compilation  # noqa: PLC0415

    # the libraries of the page take seconds to import, which other processes may spend compiling
    compilation().begin()
    with missing_named("the dashboard"):
        from railjoule.dashboard import app  # noqa: PLC0415
    try:
        app.serve(options, folder)
    except OSError as error:
        told = error.strerror or error
        raise CommandError(f"cannot serve at {options.address}, port {options.port}: {told}.") from None


def scenario_folder(named: str | None, options: "ServerOptions") -> ScenarioFolder | None:
    """Return the folder that the dashboard lists: the named one, or the default one of a server for this machine.

    Raises
    ------
    CommandError
        If there is no folder of that name.
    """
    try:
        if named is None:
            # every visitor can save in the folder: others than this machine's users only where it was named
            return ScenarioFolder(default_folder()) if options.is_for_this_machine and not options.origins else None
        folder = ScenarioFolder(named)
        if not folder.path.is_dir():
            raise CommandError(f"--folder {shortened(named)}: there is no such folder; make it first.")
    except (OSError, RuntimeError, ValueError) as error:  # a user without a home, a name with a null character
        if named is None:
            return None
        raise CommandError(f"--folder {shortened(named)}: {error}.") from None
    return folder


def load(file: str, changes: Mapping[str, Any]) -> Scenario:
    """Return the scenario of a file or report, or the shipped one of that name, with changes.

    Raises
    ------
    RailjouleError
        If there is none, or anything in it is wrong.
    """
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


SCENARIO_TABLES = {
    "vehicle": "vehicle.preset=metro-81-7036",
    "line": "line.preset=liashenko-ii",
    "timetable": "timetable.average_speed_kmh=35",
}
"""The tables that every scenario has, and how an option adds each of them."""


def require_tables(path: Path, changes: Mapping[str, Any]) -> None:
    """Raise CommandError, with the next step, for a file that holds only some tables of a scenario, such as a line."""
    if not path.is_file():
        return
    given = {*read_toml(read_text(path), path.name), *(key.partition(".")[0] for key in changes)}
    there = [f"[{table}]" for table in SCENARIO_TABLES if table in given]
    missing = [table for table in SCENARIO_TABLES if table not in given]
    if there and missing:
        raise CommandError(
            f"{path.name}: holds {' and '.join(there)} alone, and a scenario also needs "
            f"{' and '.join(f'[{table}]' for table in missing)}. Add it to the file, or name it here, such as --set "
            f"{' '.join(SCENARIO_TABLES[table] for table in missing)}."
        )


OTHER_NAMES = {"brake_pressure": "brake"}
"""Quantities of a recorder by the names that they had."""
EXAMPLES = {"--column": "speed=v [m/s]", "--unit": "speed=km/h", "--gauge": "effort_gain=1"}


def parsed_changes(words: Sequence[str]) -> dict[str, Any]:
    """Return the changes that 'key=value' words ask for; the values are TOML, bare words are texts.

    Raises
    ------
    CommandError
        If a word has no key or no equals sign.
    """
    changes: dict[str, Any] = {}
    for word in words:
        key, equals, value = word.partition("=")
        if not key.strip() or not equals:
            raise CommandError(f"--set {shortened(word)}: must be KEY=VALUE, such as vehicle.load_factor=0.3.")
        changes[key.strip()] = parsed_value(value)
    return changes


def quantities(option: str, words: Sequence[str]) -> dict[str, str]:
    """Return what 'QUANTITY=VALUE' words say of a recorder's columns.

    Raises
    ------
    CommandError
        If a word has no quantity, no equals sign or no value.
    """
    said = {}
    for word in words:
        quantity, equals, value = (part.strip() for part in word.partition("="))
        if not (quantity and equals and value):
            raise CommandError(f"{option} {shortened(word)}: must be QUANTITY=VALUE, such as {EXAMPLES[option]}.")
        said[OTHER_NAMES.get(quantity, quantity)] = value
    return said


def parsed_seconds(text: str | None) -> float | None:
    """Return how long to tighten a bound [s]; None where nothing is said of it.

    Raises
    ------
    CommandError
        If the text is no number, or one out of its bounds.
    """
    if text is None:
        return None
    try:
        seconds = float(text)
    except ValueError:
        seconds = -1.0
    # `not` before both, as NaN is neither below nor above a bound
    if not 0.0 <= seconds <= LONGEST_PROOF_S:
        raise CommandError(
            f"--prove-seconds {shortened(text)}: must be a number of seconds from 0 to {LONGEST_PROOF_S:g}."
        )
    return seconds


def parsed_value(text: str) -> Any:
    """Return the TOML value that a text gives, or the text itself."""
    try:
        document = read_toml(f"value = {text}", "--set")
    except ScenarioError:
        return text
    # a text with line breaks could name more keys
    return document["value"] if list(document) == ["value"] else text


def table_file(name: str, option: str = "--trajectory", suffixes: Sequence[str] = TABLE_SUFFIXES) -> Path:
    """Return where a table is to be written.

    Raises
    ------
    CommandError
        If the suffix is unknown, or what it needs is not installed.
    """
    path = Path(name)
    if path.suffix.lower() not in suffixes:
        raise CommandError(f"{option} {shortened(name)}: must end in {' or '.join(suffixes)}.")
    if path.suffix.lower() == ".parquet" and not has_parquet():
        raise CommandError(f"{option} {shortened(name)}: {NEEDED}")
    return path


def read_table(name: str) -> "pandas.DataFrame":
    """Return the table of a file.

    Raises
    ------
    CommandError
        If there is none, or it cannot be read.
    """
    import pandas  # noqa: PLC0415  (slow to import, and seldom needed)

    path = table_file(name, "RUN")
    read = pandas.read_csv if path.suffix.lower() == ".csv" else pandas.read_parquet
    try:
        table: pandas.DataFrame = read(path)
    except FileNotFoundError:
        raise CommandError(f"{shortened(name)}: there is no such file.") from None
    except OSError as error:
        raise CommandError(f"{shortened(name)}: {error.strerror or error}.") from None
    except ValueError as error:
        words = " ".join(str(error).split()).rstrip(".")
        raise CommandError(f"{shortened(name)} is not a table in {path.suffix[1:]}: {shortened(words)}.") from None
    return table if path.suffix.lower() == ".parquet" else plain_table(table)


def limits() -> None:
    """Show what may be asked for at most."""
    rows = [(limit.of, limit.library, limit.page) for limit in all_limits()]
    print("\n".join(terminal.table_lines(("of", "terminal", "page"), rows)))


def write_table(table: "pandas.DataFrame", path: Path, index: bool) -> None:
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


@contextmanager
def missing_named(what: str) -> Iterator[None]:
    """Turn the lack of a package of the page into a sentence that says what to install."""
    try:
        yield
    except ModuleNotFoundError as error:
        if str(error.name).partition(".")[0] == "railjoule":  # this package itself is broken
            raise
        sentence = f"{what} needs {error.name}, which is not installed: pip install 'railjoule[page]'."
        raise CommandError(sentence) from None


@contextmanager
def failures_named(path: Path) -> Iterator[None]:
    """Turn a failure to write a file into a sentence that names it."""
    try:
        yield
    except OSError as error:
        raise CommandError(f"{shortened(str(path))} cannot be written: {error.strerror or error}.") from None


@contextmanager
def refusals_named(strategy: str) -> Iterator[None]:
    """Turn a strategy's refusal into a sentence that names it."""
    try:
        yield
    except StrategyRefusedError as refusal:
        raise CommandError(f"{strategy} {refusal}") from None


def shortened(text: str) -> str:
    """Return a text of at most 80 characters."""
    return text if len(text) <= 80 else text[:77] + "..."
