"""The command `railjoule`: it reads the words, calls `commands` beside it, and turns errors into one line."""

import argparse
import contextlib
import os
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from railjoule.dashboard.report.section_names import SECTION_TITLES
from railjoule.dashboard.server.options import (
    DEFAULT_ADDRESS,
    DEFAULT_PORT,
    EXPOSED,
    HIGHEST_PORT,
    NO_LOGIN,
    PREFIX,
    ServerOptions,
    origin_parts,
)

MOST_SESSIONS = 10_000
# as core/scenario bounds timetable.travel_time_s
LONGEST_TIME_S = 86_400.0
"""The longest that a scenario may take."""
STUDIES = {
    "tradeoff": "solve a scenario for many travel times",
    "sensitivity": "drive a plan with other loads and errors of place than planned",
    "montecarlo": "drive a plan under what chance brings",
    "braking": "stop with errors of the braking sensors and the measured speed, with precision braking and without",
    "robust": "find the plan with the least expected energy that is on time with a chosen probability",
    "sweep": "solve a scenario very many times with other numbers",
}
"""What each study does."""
OK, BROKEN_RULE, BAD_INPUT, INTERRUPTED, BROKEN_PIPE = 0, 1, 2, 130, 141
"""Exit statuses; the last two are those of a shell for programs ended by such a signal."""
CHECK_STATUS = "Exit status: 0 if the run keeps every rule, 1 if it breaks one, 2 for bad input."


class UsageError(Exception):
    """Arguments that make no command, in one sentence."""


class _Version(argparse.Action):
    """Prints the version, which takes long to look up, only where it is asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> NoReturn:
        from importlib.metadata import version  # noqa: PLC0415

        print(f"railjoule {version('railjoule')}")
        parser.exit()


# argparse, as typer takes 60 ms more at each command, and has usage errors of its own
class _Parser(argparse.ArgumentParser):
    """A parser that raises one sentence where the library's prints its usage and leaves."""

    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message}; see {self.prog} --help.")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit status.

    Parameters
    ----------
    arguments : sequence of str, optional
        The arguments after `railjoule`; by default those of the process.
    """
    # a terminal may have an encoding that lacks signs of a title: they are printed as escapes, and nothing fails
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    try:
        status = _run(arguments)
        # here, so that a closed pipe or a full disk is noticed while it can be told
        sys.stdout.flush()
    except BrokenPipeError:
        _drop_output()
        return BROKEN_PIPE
    except OSError as error:
        _drop_output()
        return _complain(f"the result cannot be written: {error.strerror or error}.")
    except KeyboardInterrupt:
        return INTERRUPTED
    return status


def _run(arguments: Sequence[str] | None) -> int:
    try:
        options = build_parser().parse_args(arguments)
    except UsageError as error:
        return _complain(str(error))
    except SystemExit as end:  # after --help and --version
        return int(end.code or OK)
    # only now, as the core takes most of a second to import
    from railjoule.core import RailjouleError  # noqa: PLC0415

    try:
        return OK if _call(options) else BROKEN_RULE
    except RailjouleError as error:
        return _complain(str(error))
    except MemoryError:
        return _complain("not enough memory; a longer solver.mesh_m needs less.")
    except RecursionError:
        return _complain("the input is nested too deeply.")


def _call(options: argparse.Namespace) -> bool:
    """Run a command; return whether all that it was to check holds."""
    from railjoule.dashboard.command import commands  # noqa: PLC0415

    if options.command == "serve":
        place = ServerOptions(
            options.address,
            options.port,
            tuple(options.origin),
            options.prefix.rstrip("/"),
            options.sessions,
        )
        commands.serve(place, commands.scenario_folder(options.folder, place))
        return True
    if options.command == "import":
        from railjoule.dashboard.command import imports  # noqa: PLC0415

        imports.run(options)
        return True
    if options.command in {"measured", "fit"}:
        from railjoule.dashboard.command import measurements  # noqa: PLC0415

        (measurements.measured if options.command == "measured" else measurements.fit)(options)
        return True
    output = commands.Output(getattr(options, "json", False))
    if options.command == "benchmark":
        commands.benchmark(output)
    elif options.command == "compile":
        commands.compile_kernels()
    elif options.command == "limits":
        commands.limits()
    elif options.command == "study" and options.study == "sweep":
        from railjoule.dashboard.command import sweeps  # noqa: PLC0415

        sweeps.study_sweep(options, commands.parsed_changes(options.set))
    elif options.command == "study" and options.study == "robust":
        from railjoule.dashboard.command import robust  # noqa: PLC0415

        robust.study_robust(options, commands.parsed_changes(options.set))
    elif options.command == "study":
        commands.study(options.study, options.file, commands.parsed_changes(options.set), options.output)
    elif options.command == "validate":
        commands.validate(options.paper, output)
    elif options.command == "check":
        changes = commands.parsed_changes(options.set)
        return commands.check(options.run, options.scenario, changes, options.strategy, output)
    elif options.command == "report":
        seconds = commands.parsed_seconds(options.prove_seconds)
        changes = commands.parsed_changes(options.set)
        contents = commands.report_contents(options.sections, options.author, options.note)
        commands.report(options.file, changes, options.strategy, options.output, seconds, contents)
    else:
        file, words = _file_and_changes(options.file, options.set)
        changes = commands.parsed_changes(words)
        if options.command == "solve":
            seconds = commands.parsed_seconds(options.prove_seconds)
            return commands.solve(file, changes, options.strategy, options.trajectory, output, options.check, seconds)
        if options.command == "simulate":
            commands.simulate(file, changes, output)
        elif options.command == "advise":
            commands.advise(file, changes, options.changes, output)
        else:
            commands.compare_strategies(file, changes, output, commands.parsed_seconds(options.prove_seconds))
    return True


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of all commands."""
    parser = _Parser(
        prog="railjoule", description="Energy-optimal driving of one electric rail vehicle.", allow_abbrev=False
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    _add_serve(commands)
    solve = _add_scenario_command(commands, "solve", "solve one scenario")
    solve.add_argument("--strategy", metavar="S", help="the driving strategy; default: the scenario's own")
    solve.add_argument("--trajectory", metavar="OUT", help="write the run to OUT.csv or OUT.parquet")
    solve.add_argument("--check", action="store_true", help="check the run against its scenario: see `railjoule check`")
    _add_proof(solve)
    solve.epilog = (
        f"With --check: {CHECK_STATUS.lower()} A run that misses a window of arrival ends with status 2, too."
    )
    _add_proof(_add_scenario_command(commands, "compare", "run every strategy that fits a scenario"))
    advise = _add_scenario_command(commands, "advise", "find the best run whose driver changes the regime seldom")
    advise.add_argument(
        "--changes",
        type=_changes,
        metavar="K",
        help="changes of regime between two stops at most, 2 to 9; default: as few as cost no more than 1 %% of energy",
    )
    _add_scenario_command(commands, "simulate", "follow the plan of a scenario under its disturbance")
    _add_study(commands)
    report = _add(commands, "report", "write all results of a scenario to one HTML file that works offline")
    report.add_argument("file", metavar="FILE", help="a scenario file, or the name of a scenario")
    report.add_argument("-o", "--output", metavar="OUT", required=True, help="OUT.html")
    report.add_argument("--strategy", metavar="S", help="whose results come first; default: the scenario's own")
    report.add_argument(
        "--sections",
        metavar="NAME",
        nargs="+",
        action="extend",
        default=[],
        help=f"which sections it has: {', '.join(SECTION_TITLES)}; default: all",
    )
    report.add_argument("--author", metavar="NAME", default="", help="who has written it")
    report.add_argument(
        "--note",
        metavar="TEXT_FILE",
        help="a file with a note by the author: plain text, in which an empty line begins a new paragraph",
    )
    _add_proof(report)
    _add_changes(report)
    benchmark = _add(commands, "benchmark", "time every strategy on the shipped scenarios, and CasADi with IPOPT")
    _add_json(benchmark)
    _add(commands, "limits", "show what is asked for at most, in a terminal and on a page")
    _add(commands, "compile", "compile the solver ahead of its first use, as for an image or a cluster")
    validate = _add(commands, "validate", "compare the papers' published numbers with ours")
    validate.add_argument(
        "paper", metavar="PAPER", nargs="?", help="ftorek, liashenko, rawicki or shtompel; default: all papers"
    )
    _add_json(validate)
    _add_check(commands)
    _add_import(commands)
    _add_measured(commands)
    _add_fit(commands)
    return parser


def _add_serve(commands: "argparse._SubParsersAction[_Parser]") -> None:
    serve = _add(commands, "serve", "serve the dashboard in the browser")
    serve.add_argument("--port", type=_port, default=DEFAULT_PORT, help=f"default: {DEFAULT_PORT}")
    serve.add_argument("--address", default=DEFAULT_ADDRESS, help=f"default: {DEFAULT_ADDRESS}, this machine only")
    serve.add_argument(
        "--origin",
        type=_origin,
        metavar="NAME[:PORT]",
        nargs="+",
        action="extend",
        default=[],
        help="further names under which browsers reach the server, as behind a proxy; it answers to no others",
    )
    serve.add_argument("--prefix", type=_prefix, default="", metavar="PATH", help="serve below this path, not at /")
    serve.add_argument(
        "--sessions", type=_sessions, metavar="N", help="pages open at a time at most; default: any number"
    )
    serve.add_argument(
        "--folder",
        metavar="DIR",
        help="the folder of scenario files that Start lists, in which every visitor can save; default: one in your "
        "data directory, but none where --address or --origin lets others in",
    )
    serve.epilog = f"{NO_LOGIN} With the default address that is this machine's users alone. {EXPOSED}"


def _add_study(commands: "argparse._SubParsersAction[_Parser]") -> None:
    studies = _add(commands, "study", "solve many scenarios and write a labelled table").add_subparsers(
        dest="study", metavar="STUDY", required=True
    )
    for name, words in STUDIES.items():
        study = _add(studies, name, words)
        study.add_argument("file", metavar="FILE", help="a scenario file, or the name of a scenario")
        _add_output(study, "OUT.nc (netCDF), OUT.csv or OUT.parquet")
        _add_changes(study)
        if name == "sweep":
            _add_sweep(study)
        elif name == "robust":
            _add_robust(study)


def _add_robust(robust: _Parser) -> None:
    robust.epilog = (
        "Each plan is followed under a fifth of montecarlo.runs, and the robust one checked by all of montecarlo.runs "
        "under another seed. disturbance.accepted_delay_s is the lateness that still counts as on time."
    )
    # as core/studies/robust_plan.py has them, which is too slow to import for a line of help
    robust.add_argument(
        "--probability", metavar="P", type=float, default=0.9, help="of an arrival on time, above 0 to 1; default: 0.9"
    )
    robust.add_argument(
        "--candidates", metavar="N", type=_whole, default=24, help="plans to try, 1 to 1000; default: 24"
    )
    robust.add_argument("--trajectory", metavar="OUT", help="write the robust plan to OUT.csv or OUT.parquet")
    _add_json(robust)


def _add_sweep(sweep: _Parser) -> None:
    sweep.epilog = "A row that cannot be driven stands in the table with its reason; it is no error."
    sweep.add_argument(
        "--over",
        metavar="FIELD=LOW:HIGH",
        nargs="+",
        action="extend",
        required=True,
        help="a number of the scenario and between which values it varies, such as vehicle.load_factor=0:1",
    )
    sweep.add_argument("--sample", metavar="N", type=_whole, required=True, help="how many rows")
    sweep.add_argument(
        "--method",
        choices=("grid", "random", "sobol", "halton"),
        default="sobol",
        help="how the rows are drawn; default: sobol; a grid has N^(1/fields) values of each field",
    )
    sweep.add_argument("--seed", metavar="K", type=_whole, default=0, help="the same seed draws the same; default: 0")
    sweep.add_argument("--strategy", metavar="S", help="the driving strategy; default: the scenario's own")
    sweep.add_argument(
        "--columns",
        metavar="NAME",
        nargs="+",
        action="extend",
        default=[],
        help="further columns, such as max_speed_kmh, traction_energy_kwh, recuperated_kwh or losses_kwh",
    )
    sweep.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="of a Dask scheduler whose workers solve the rows, such as tcp://node1:8786; default: this machine's "
        "processors; needs the extra cluster",
    )
    sweep.add_argument(
        "--resume",
        action="store_true",
        help="go on with a sweep that was stopped or killed, whose rows are kept beside the table",
    )
    _add_json(sweep)


def _add_check(commands: "argparse._SubParsersAction[_Parser]") -> None:
    check = _add(commands, "check", "check a run against its scenario, by formulas that share no code with the solvers")
    check.epilog = CHECK_STATUS
    check.add_argument("run", metavar="RUN", help="RUN.csv or RUN.parquet, as solve --trajectory writes it, or a name")
    check.add_argument("--scenario", metavar="S", help="its scenario file, report, or the name of a scenario")
    check.add_argument("--strategy", metavar="S", help="the strategy that made the run; default: the scenario's own")
    _add_changes(check)
    _add_json(check)


def _add_import(commands: "argparse._SubParsersAction[_Parser]") -> None:
    parser = _add(commands, "import", "read lines, vehicles and runs from files of other programs")
    parser.epilog = "What the files hold that was not used is told on standard error."
    formats = parser.add_subparsers(dest="format", metavar="FORMAT", required=True)
    _add_ttobench(formats)
    _add_intervals(formats)
    stock = _add(formats, "osrd-stock", "make a vehicle of a rolling stock of OSRD, JSON 3.0 to 3.4")
    stock.add_argument("file", metavar="FILE", help="FILE.json")
    stock.add_argument("--train", metavar="NAME", help="the rolling stock of that name; needed where there are several")
    stock.add_argument("--mode", metavar="M", help="the supply whose efforts are taken; default: the file's")
    _add_encoding(stock)
    _add_output(stock, "OUT.toml")
    toolkit = _add(formats, "railtoolkit", "make a vehicle or a line of a file of railtoolkit, YAML 2022.05 or 2024.07")
    toolkit.add_argument("file", metavar="FILE", help="FILE.yaml")
    toolkit.add_argument(
        "--train",
        "--path",
        "--id",
        dest="train",
        metavar="ID",
        help="the train, vehicle or path of that id; needed where there are several",
    )
    _add_encoding(toolkit)
    _add_output(toolkit, "OUT.toml")
    measured = _add(formats, "run", "make the table of a run of what a recorder measured, CSV or XLSX")
    measured.add_argument("file", metavar="FILE", help="FILE.csv or FILE.xlsx")
    _add_columns(measured, "--columns")
    _add_output(measured, "OUT.csv or OUT.parquet")


def _add_ttobench(formats: "argparse._SubParsersAction[_Parser]") -> None:
    ttobench = _add(formats, "ttobench", "make a scenario of a track and a train of TTOBench, JSON 1.1 to 1.5")
    ttobench.add_argument("file", metavar="TRACK", help="TRACK.json")
    ttobench.add_argument("--train", metavar="TRAIN", required=True, help="TRAIN.json")
    ttobench.add_argument("--journey", metavar="J", help="JOURNEY.json, for travel time and stops")
    ttobench.add_argument(
        "--stops", choices=("all", "ends"), default="all", help="stop at all stops, the default, or at the ends alone"
    )
    _add_encoding(ttobench)
    _add_travel_time(ttobench, "time for the whole run; default: the journey's, or 10 %% above the shortest possible")
    _add_output(ttobench, "OUT.toml")


def _add_travel_time(parser: _Parser, words: str) -> None:
    parser.add_argument("--travel-time-s", metavar="T", type=_seconds, help=words)


def _add_intervals(formats: "argparse._SubParsersAction[_Parser]") -> None:
    intervals = _add(formats, "intervals", "put a line together from tables of intervals, CSV or XLSX")
    for kind, what in (
        ("gradients", "gradients"),
        ("limits", "speed limits"),
        ("curves", "radii or curvatures"),
        ("tunnels", "tunnels"),
        ("neutral", "neutral sections"),
    ):
        intervals.add_argument(f"--{kind}", metavar="FILE", help=f"a table of {what}, with columns from, to and value")
    intervals.add_argument(
        "--preset",
        metavar="NAME",
        nargs="+",
        action="extend",
        default=[],
        help="columns of a published table: sncf-gradients, sncf-limits, sncf-curves or rinf-gradients",
    )
    intervals.add_argument(
        "--columns",
        metavar="TABLE.KEY=VALUE",
        nargs="+",
        action="extend",
        default=[],
        help="which column holds what, as gradients.from=PKD; KEY is from, to, value, direction, position_unit (m, km, "
        "mi, ch, yd, ft, pk, mi.ch, mi.yd), value_unit (of gradients permille, percent, fraction, ratio for 1 in n, "
        "deg, rad, per10000, ft/mi; of limits km/h, m/s, mph; of curves m, km, ft, yd, ch, 1/m, 1/km, or deg for the "
        "degree of curve; of tunnels factor, m2), decimal or sheet",
    )
    intervals.add_argument(
        "--rows",
        metavar="TABLE.COLUMN=VALUE",
        nargs="+",
        action="extend",
        default=[],
        help="use the rows of one line or track alone, as gradients.NOM_VOIE=V1",
    )
    intervals.add_argument("--begin", metavar="PLACE", help="chainage at which the line begins, as 12+345 or 12.345km")
    intervals.add_argument("--end", metavar="PLACE", help="chainage at which it ends")
    intervals.add_argument("--reverse", action="store_true", help="run it in falling chainage")
    intervals.add_argument("--name", metavar="NAME", help="the line's name")
    _add_encoding(intervals)
    intervals.add_argument(
        "--vehicle",
        metavar="V",
        help="a shipped vehicle, or the FILE.toml of one: OUT.toml is then a whole scenario with it",
    )
    _add_travel_time(intervals, "with --vehicle: time for the whole run; default: 10 %% above the shortest possible")
    _add_output(intervals, "OUT.toml, or OUT.csv for line.file of a scenario")


def _add_output(parser: _Parser, told: str) -> None:
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help=told)


def _add_measured(commands: "argparse._SubParsersAction[_Parser]") -> None:
    measured = _add(commands, "measured", "put a measured run beside the model and the optimum in its time")
    measured.add_argument("run", metavar="RUN", help="the table of a recorder: RUN.csv or RUN.xlsx")
    _add_recording(measured)
    measured.add_argument("--trajectory", metavar="OUT", help="write the run to OUT.csv or OUT.parquet")
    measured.add_argument("-o", "--output", metavar="OUT", help="write its line, stops and time as OUT.toml")
    _add_json(measured)


def _add_fit(commands: "argparse._SubParsersAction[_Parser]") -> None:
    fit = _add(commands, "fit", "find resistance, inertia, efficiency and auxiliaries of a train from measured runs")
    fit.add_argument("runs", metavar="RUN", nargs="+", help="tables of a recorder: RUN.csv or RUN.xlsx")
    _add_recording(fit)
    fit.add_argument(
        "--free",
        metavar="NAME",
        nargs="+",
        help="the parameters to find: resistance.constant_n, resistance.linear_n_per_kmh, "
        "resistance.quadratic_n_per_kmh2, rotating_mass_factor, drive.traction_efficiency, auxiliary_power_kw, all of "
        "them by default, and total_mass_kg",
    )
    fit.add_argument(
        "--gauge",
        metavar="ERROR=PERCENT",
        nargs="+",
        action="extend",
        default=[],
        help="standard deviations of calibration errors: effort_gain (default 2), effort_offset (0.7), power_gain (1), "
        "power_offset (0.2), offsets over the largest reading, and speed_gain (1) of runs that are not between two "
        "stations; 0 for an exact gauge",
    )
    fit.add_argument("--coasting", action="store_true", help="use nothing but samples without effort")
    fit.add_argument("-o", "--output", metavar="OUT", help="write the scenario with the fitted vehicle as OUT.toml")
    _add_json(fit)


def _add_columns(parser: _Parser, *other_names: str) -> None:
    """Add what says how a recorder writes its files."""
    parser.add_argument(
        "--preset", metavar="P", default="generic", help="generic, osrd or ztbus; default: found by the columns"
    )
    parser.add_argument(
        "--column",
        *other_names,
        metavar="QUANTITY=NAME",
        nargs="+",
        action="extend",
        default=[],
        help="which column holds what, where its name does not tell, as 'speed=v [m/s]': time, position, speed, effort "
        "(braking negative), tractive_effort, braking_effort, brake, power, energy, line_current (regenerated "
        "negative) or line_voltage",
    )
    parser.add_argument(
        "--unit", metavar="QUANTITY=UNIT", nargs="+", action="extend", default=[], help="such as speed=km/h effort=kN"
    )
    parser.add_argument("--sheet", metavar="NAME", help="the sheet of a workbook; needed where it has several")
    _add_encoding(parser)


def _add_encoding(parser: _Parser) -> None:
    parser.add_argument(
        "--encoding",
        metavar="NAME",
        default="",
        help="code page of files that are not UTF-8, such as cp1250, cp1251 or gbk; default: found by their letters",
    )


def _add_recording(parser: _Parser) -> None:
    parser.add_argument("--scenario", metavar="S", help="vehicle and line: a scenario file, or a shipped scenario")
    parser.add_argument("--from", dest="start_m", metavar="M", help="where on the line the run begins; default: found")
    _add_columns(parser)
    parser.add_argument("--longest-gap", metavar="S", help="for how long samples may be missing; default: 10 s")
    _add_changes(parser)


def _add_scenario_command(commands: "argparse._SubParsersAction[_Parser]", name: str, words: str) -> _Parser:
    parser = _add(commands, name, words)
    parser.add_argument("file", metavar="FILE", nargs="?", help="a scenario file, or the name of a scenario")
    _add_changes(parser, "change a key of the file, such as vehicle.load_factor=0.3; the value is TOML")
    _add_json(parser)
    return parser


def _add_changes(parser: argparse.ArgumentParser, words: str = "as in solve") -> None:
    parser.add_argument("--set", metavar="KEY=VALUE", nargs="+", action="extend", default=[], help=words)


def _add(commands: "argparse._SubParsersAction[_Parser]", name: str, words: str) -> _Parser:
    return commands.add_parser(name, help=words, description=words[0].upper() + words[1:] + ".", allow_abbrev=False)


def _add_json(parser: _Parser) -> None:
    parser.add_argument("--json", action="store_true", help="print JSON")


def _add_proof(parser: _Parser) -> None:
    parser.add_argument(
        "--prove-seconds",
        metavar="S",
        help="how long to tighten a bound that is loose, as that of a powertrain often is which takes power without "
        "effort, such as 10; 0: the first bound only; default: a fixed number of steps, about 0.5 s, as on the page",
    )


def _changes(text: str) -> int:
    # as core/studies/simple_advice.py bounds them, which is too slow to import for a line of help
    if not text.isdecimal() or not 2 <= int(text) <= 9:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 2 to 9")
    return int(text)


def _whole(text: str) -> int:
    # the length before `int`, which refuses thousands of digits by an error of its own
    if not (text.isascii() and text.isdigit() and len(text) < 20):
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is not a whole number of at least 0")
    return int(text)


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = -1.0
    # `not` before both, as NaN is neither below nor above a bound
    if not 0.0 < seconds <= LONGEST_TIME_S:
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is not a number of seconds above 0, to {LONGEST_TIME_S:g}")
    return seconds


def _origin(text: str) -> str:
    try:
        origin_parts(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    return text


def _prefix(text: str) -> str:
    if text.strip("/") and not PREFIX.fullmatch(text.rstrip("/")):
        raise argparse.ArgumentTypeError(f"{text[:60]!r} is not a path such as /tools/railjoule")
    return text


def _sessions(text: str) -> int:
    if not (text.isascii() and text.isdigit() and len(text) < 6 and 1 <= int(text) <= MOST_SESSIONS):
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is not a whole number from 1 to {MOST_SESSIONS}")
    return int(text)


def _port(text: str) -> int:
    # to `isdigit`, superscripts are digits too, which `int` refuses
    # the length before `int` as well, which refuses thousands of digits by an error of its own
    if not (text.isascii() and text.isdigit() and len(text) < 6 and 1 <= int(text) <= HIGHEST_PORT):
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is not a port from 1 to {HIGHEST_PORT}")
    return int(text)


def _file_and_changes(file: str | None, words: Sequence[str]) -> tuple[str, list[str]]:
    """Return the scenario and the changes; an argument without equals sign after --set is the scenario."""
    if file is not None:
        return file, list(words)
    from railjoule.dashboard.command.commands import CommandError  # noqa: PLC0415

    # --set takes all words that follow it, FILE too where that stands last
    without = [word for word in words if "=" not in word]
    if len(without) != 1:
        raise CommandError("FILE is missing: a scenario file or the name of a scenario.")
    return without[0], [word for word in words if word != without[0]]


def _complain(sentence: str) -> int:
    """Print one sentence on standard error."""
    # a file's name or text may hold control characters, which a terminal would obey
    line = "".join(character if character.isprintable() else " " for character in sentence)
    with contextlib.suppress(OSError):
        print(f"railjoule: {line}", file=sys.stderr, flush=True)
    return BAD_INPUT


def _drop_output() -> None:
    """Discard the interpreter's last flush, as nobody reads it any more."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    sys.exit(main())
