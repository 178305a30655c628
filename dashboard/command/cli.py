"""The command `railjoule`: it reads the words, calls `commands` beside it, and turns errors into one line."""

import argparse
import contextlib
import os
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

DEFAULT_ADDRESS, DEFAULT_PORT = "127.0.0.1", 5006
LARGEST_PORT = 65_535
STUDIES = ("tradeoff", "sensitivity", "montecarlo")
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
        commands.serve(options.address, options.port)
        return True
    output = commands.Output(getattr(options, "json", False))
    if options.command == "benchmark":
        commands.benchmark(output)
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
        commands.report(options.file, changes, options.strategy, options.output, seconds)
    else:
        file, words = _file_and_changes(options.file, options.set)
        changes = commands.parsed_changes(words)
        if options.command == "solve":
            seconds = commands.parsed_seconds(options.prove_seconds)
            return commands.solve(file, changes, options.strategy, options.trajectory, output, options.check, seconds)
        if options.command == "simulate":
            commands.simulate(file, changes, output)
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
    solve.epilog = f"With --check: {CHECK_STATUS.lower()}"
    _add_proof(_add_scenario_command(commands, "compare", "run every strategy that fits a scenario"))
    _add_scenario_command(commands, "simulate", "follow the plan of a scenario under its disturbance")
    study = _add(commands, "study", "solve many scenarios and write a labelled table")
    study.add_argument("study", metavar="STUDY", choices=STUDIES, help=" or ".join(STUDIES))
    study.add_argument("file", metavar="FILE", help="a scenario file, or the name of a shipped scenario")
    study.add_argument("-o", "--output", metavar="OUT", required=True, help="OUT.nc (netCDF), OUT.csv or OUT.parquet")
    study.add_argument("--set", metavar="KEY=VALUE", nargs="+", action="extend", default=[], help="as in solve")
    report = _add(commands, "report", "write all results of a scenario to one HTML file that works offline")
    report.add_argument("file", metavar="FILE", help="a scenario file, or the name of a shipped scenario")
    report.add_argument("-o", "--output", metavar="OUT", required=True, help="OUT.html")
    report.add_argument("--strategy", metavar="S", help="whose results come first; default: the scenario's own")
    _add_proof(report)
    report.add_argument("--set", metavar="KEY=VALUE", nargs="+", action="extend", default=[], help="as in solve")
    benchmark = _add(commands, "benchmark", "time every strategy on the shipped scenarios, and CasADi with IPOPT")
    _add_json(benchmark)
    validate = _add(commands, "validate", "compare the papers' published numbers with ours")
    validate.add_argument(
        "paper", metavar="PAPER", nargs="?", help="ftorek, liashenko, rawicki or shtompel; default: all papers"
    )
    _add_json(validate)
    _add_check(commands)
    return parser


def _add_serve(commands: "argparse._SubParsersAction[_Parser]") -> None:
    serve = _add(commands, "serve", "serve the dashboard in the browser")
    serve.add_argument("--port", type=_port, default=DEFAULT_PORT, help=f"default: {DEFAULT_PORT}")
    serve.add_argument("--address", default=DEFAULT_ADDRESS, help=f"default: {DEFAULT_ADDRESS}, this machine only")


def _add_check(commands: "argparse._SubParsersAction[_Parser]") -> None:
    check = _add(commands, "check", "check a run against its scenario, by formulas that share no code with the solvers")
    check.epilog = CHECK_STATUS
    check.add_argument("run", metavar="RUN", help="RUN.csv or RUN.parquet, as solve --trajectory writes it")
    check.add_argument("--scenario", metavar="S", help="its scenario file, report, or the name of a shipped scenario")
    check.add_argument("--strategy", metavar="S", help="the strategy that made the run; default: the scenario's own")
    check.add_argument("--set", metavar="KEY=VALUE", nargs="+", action="extend", default=[], help="as in solve")
    _add_json(check)


def _add_scenario_command(commands: "argparse._SubParsersAction[_Parser]", name: str, words: str) -> _Parser:
    parser = _add(commands, name, words)
    parser.add_argument("file", metavar="FILE", nargs="?", help="a scenario file, or the name of a shipped scenario")
    parser.add_argument(
        "--set",
        metavar="KEY=VALUE",
        nargs="+",
        action="extend",
        default=[],
        help="change a key of the file, such as vehicle.load_factor=0.3; the value is TOML",
    )
    _add_json(parser)
    return parser


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


def _port(text: str) -> int:
    # to `isdigit`, superscripts are digits too, which `int` refuses
    if not (text.isascii() and text.isdigit() and len(text) < 6 and 1 <= int(text) <= LARGEST_PORT):
        raise argparse.ArgumentTypeError(f"{text[:20]!r} is not a port from 1 to {LARGEST_PORT}")
    return int(text)


def _file_and_changes(file: str | None, words: Sequence[str]) -> tuple[str, list[str]]:
    """Return the scenario and the changes; an argument without equals sign after --set is the scenario."""
    if file is not None:
        return file, list(words)
    from railjoule.dashboard.command.commands import CommandError  # noqa: PLC0415

    without = [word for word in words if "=" not in word]
    if len(without) != 1:
        raise CommandError("FILE is missing: a scenario file or the name of a shipped scenario.")
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
