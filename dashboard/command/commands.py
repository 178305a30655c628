"""Commands of `railjoule` that compute one scenario, or none."""

import argparse
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import Any, cast

from railjoule.core import ScenarioError, check_run, check_table
from railjoule.core import compare as compare_strategies
from railjoule.core import solve as solve_scenario
from railjoule.core.scenario import format_scenario
from railjoule.core.scenario.text_file import read_text
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.arrival_windows import missed_windows
from railjoule.core.strategy import STRATEGIES
from railjoule.dashboard.command import files, summary, terminal
from railjoule.dashboard.command.files import CommandError, refusals_named, show
from railjoule.dashboard.command.values import shortened
from railjoule.dashboard.limits import limits as all_limits
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.report.section_names import SECTION_TITLES
from railjoule.dashboard.scenario_folder import ScenarioFolder, default_folder
from railjoule.dashboard.server.options import ServerOptions
from railjoule.dashboard.work.pair import SCENARIO, SecondScenario

# Each takes the options of its command, and raises a RailjouleError where anything in them, or in a file, is wrong.


def solve(options: argparse.Namespace) -> bool:
    """Solve a scenario, write its trajectory if wanted, and show the result; return whether it passed its check.

    Raises
    ------
    CommandError
        If the run that is shown misses a window of arrival.
    """
    scenario = files.scenario(options)
    with refusals_named(options.strategy or scenario.strategy):
        # a name that is none is refused by the core, in its own words
        run = solve_scenario(scenario, options.strategy, prove_seconds=options.prove_seconds)
    if options.trajectory is not None:
        files.write_table(run.to_dataframe(), options.trajectory)
    task = prepare_task(scenario)
    values = summary.summarise(run, task.shortest_travel_time_s)
    result = check_run(scenario, run) if options.check else None
    if result is not None:
        values["check"] = summary.summarise_check(result)
    show(options, values, terminal.solution_text)
    if missed := missed_windows(task, run):
        raise CommandError(" ".join(missed))
    return result is None or result.ok


def check(options: argparse.Namespace) -> bool:
    """Check the run of a file against its scenario, and show the result; return whether it keeps every rule."""
    table = files.read_table(options.run)
    scenario = files.scenario(options, "the file of a run does not contain its scenario")
    strategy = options.strategy
    if strategy is not None and strategy not in STRATEGIES:
        raise CommandError(f"--strategy {shortened(strategy)}: must be one of {', '.join(STRATEGIES)}.")
    try:
        result = check_table(scenario, cast("Mapping[str, Any]", table), strategy)
    except ScenarioError as error:
        raise CommandError(f"{shortened(options.run)} {error}") from None
    show(options, summary.summarise_check(result), terminal.check_text)
    return result.ok


def compare(options: argparse.Namespace) -> None:
    """Run every strategy that takes a scenario, or two scenarios by their own strategies, and show the results."""
    loaded = [files.load(file, options.set) for file in options.file]
    if len(loaded) == 1 and not options.set_second:
        found = compare_strategies(loaded[0], prove_seconds=options.prove_seconds)
        show(options, summary.summarise_comparison(found), terminal.comparison_text)
        return
    first, second = loaded[0], loaded[-1].replace(options.set_second) if options.set_second else loaded[-1]
    with refusals_named(
        f"{first.strategy} or {second.strategy}" if first.strategy != second.strategy else first.strategy
    ):
        found = compare_strategies([first, second], prove_seconds=options.prove_seconds)
    show(options, summary.summarise_pair(found), terminal.pair_text)


def advise(options: argparse.Namespace) -> None:
    """Show the best runs with few changes of regime, their price against the optimum, and the orders of one of them."""
    from railjoule.core.studies.simple_advice import MAX_CHANGES, simple_advice  # noqa: PLC0415

    advice = simple_advice(prepare_task(files.scenario(options)), options.changes or MAX_CHANGES)
    values = summary.summarise_advice(advice, last=options.changes is not None)
    show(options, values, terminal.simple_advice_text)


def simulate(options: argparse.Namespace) -> None:
    """Plan a scenario, drive it under its disturbance, and show both."""
    scenario = files.scenario(options)
    with refusals_named(scenario.strategy):
        # each kind separately: all of them take a tenth of a second to import
        if scenario.simulation.kind == "field_oriented":
            from railjoule.core.simulation.field_oriented import simulate_field_oriented  # noqa: PLC0415

            driven = summary.summarise_field_oriented(simulate_field_oriented(scenario))
            show(options, driven, terminal.field_oriented_text)
        elif scenario.disturbance.events:
            from railjoule.core.simulation.actual_run import actual_run  # noqa: PLC0415

            show(options, summary.summarise_actual(actual_run(scenario)), terminal.ride_text)
        else:
            from railjoule.core.simulation.following import simulate_following  # noqa: PLC0415

            show(options, summary.summarise_following(simulate_following(scenario)), terminal.following_text)


def report(options: argparse.Namespace) -> None:
    """Write what there is to tell of a scenario as one file of HTML, by default everything."""
    text = "" if options.note is None else read_text(Path(options.note)).strip()
    # separated by spaces or commas; all where none is named
    sections = tuple(name for word in options.sections for name in word.split(",") if name)
    contents = Contents(sections or tuple(SECTION_TITLES), options.author.strip(), text)
    if options.strategy is not None:
        options.set["strategy"] = options.strategy
    scenario = files.scenario(options)
    with missing_named("a report"):
        from railjoule.dashboard.report.document import report_html  # noqa: PLC0415
        from railjoule.dashboard.report.findings import ReportRequest, compute_findings  # noqa: PLC0415
    second = None
    if options.second is not None:
        second = SecondScenario(SCENARIO, format_scenario(files.load(options.second, {})), 0.0)
    request = ReportRequest(scenario, prove_seconds=options.prove_seconds, second=second, contents=contents)
    *_, findings = compute_findings(request)
    html = report_html(findings, datetime.now().astimezone())
    files.write(options.output, html)
    print(f"{shortened(options.output)}: {len(html.encode()) / 1e6:.1f} MB")


def benchmark(options: argparse.Namespace) -> None:
    """Show how long all solvers take on the shipped scenarios."""
    from railjoule.core.validation.benchmark import benchmark as time_all  # noqa: PLC0415
    from railjoule.core.validation.ipopt import is_installed  # noqa: PLC0415

    results = [asdict(timing) for timing in time_all()]
    show(options, {"results": results, "ipopt": is_installed()}, terminal.benchmark_text)


def validate(options: argparse.Namespace) -> None:
    """Show the printed numbers and claims of one or all papers with those of railjoule."""
    from railjoule.core.validation import PAPERS  # noqa: PLC0415

    paper = options.paper
    if paper is not None and paper not in PAPERS:
        raise CommandError(f"{paper!r} is not a paper of this version; choose one of {', '.join(PAPERS)}.")
    validations = [compute() for name, compute in PAPERS.items() if paper in (None, name)]
    papers = {validation.paper: summary.summarise_validation(validation) for validation in validations}
    show(options, {"papers": papers}, terminal.validations_text)


def limits(_: argparse.Namespace) -> None:
    """Show what may be asked for at most."""
    rows = [(limit.of, limit.library, limit.page) for limit in all_limits()]
    print("\n".join(terminal.table_lines(("of", "terminal", "page"), rows)))


def compile_kernels(_: argparse.Namespace) -> None:
    """Compile the solver, and print where the compiled code is."""
    from railjoule.core.compilation import require_compiled  # noqa: PLC0415
    from railjoule.core.kernel_cache import cache_folder  # noqa: PLC0415

    require_compiled()
    print(f"The solver is compiled; the code is in {cache_folder()}.")


def serve(options: argparse.Namespace) -> None:
    """Serve the dashboard, with a folder of scenario files where there is one, until it is interrupted."""
    from railjoule.core.compilation import compilation  # noqa: PLC0415

    place = ServerOptions(options.address, options.port, tuple(options.origin), options.prefix, options.sessions)
    folder = scenario_folder(options.folder, place)
    # the libraries of the page take seconds to import, which other processes may spend compiling
    compilation().begin()
    with missing_named("the dashboard"):
        from railjoule.dashboard import app  # noqa: PLC0415
    try:
        app.serve(place, folder)
    except OSError as error:
        reason = error.strerror or error
        raise CommandError(f"cannot serve at {place.address}, port {place.port}: {reason}.") from None


def scenario_folder(named: str | None, options: ServerOptions) -> ScenarioFolder | None:
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
        raise CommandError(f"--folder {shortened(named)}: {str(error).rstrip('.')}.") from None
    return folder


@contextmanager
def missing_named(what: str) -> Iterator[None]:
    """Turn the lack of a package of the page into a sentence that names the extra to install."""
    try:
        yield
    except ModuleNotFoundError as error:
        if str(error.name).partition(".")[0] == "railjoule":  # this package itself is broken
            raise
        sentence = f"{what} needs {error.name}, which is not installed: pip install 'railjoule[page]'."
        raise CommandError(sentence) from None
