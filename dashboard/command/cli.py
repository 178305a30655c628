"""The command `railjoule`: it reads its words by the table in `arguments`, and turns errors into one line."""

import argparse
import contextlib
import os
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any, NoReturn

from railjoule.dashboard.command.arguments import COMMANDS, Command, Group
from railjoule.dashboard.command.values import VEHICLE, UsageError, changes, printable

OK, BROKEN_RULE, BAD_INPUT, INTERRUPTED, BROKEN_PIPE = 0, 1, 2, 130, 141
"""Exit statuses; the last two are those of a shell for programs ended by such a signal."""

MOST_FILES = 2
"""Of `railjoule compare`."""


class _Version(argparse.Action):
    """Prints the version, which takes long to look up, only where it is asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> NoReturn:
        from importlib.metadata import version  # noqa: PLC0415

        print(f"railjoule {version('railjoule')}")
        parser.exit()


# not click or typer, which take 20 and 60 ms more at each command and let no option take several words, as --set does
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
        # here, so that a closed pipe or a full disk is noticed while it can be reported
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
        _settle_changes(options)
    except UsageError as error:
        return _complain(str(error))
    except SystemExit as end:  # after --help and --version
        return int(end.code or OK)
    # only now, as the core takes most of a second to import
    from railjoule.core import RailjouleError  # noqa: PLC0415

    module, _, function = options.call.partition(".")
    try:
        holds = getattr(import_module(f"{__package__}.{module}"), function)(options)
    except RailjouleError as error:
        return _complain(str(error))
    except MemoryError:
        return _complain("not enough memory; a longer solver.mesh_m needs less.")
    except RecursionError:
        return _complain("the input is nested too deeply.")
    return BROKEN_RULE if holds is False else OK


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of all commands."""
    parser = _Parser(
        prog="railjoule", description="Energy-optimal driving of one electric rail vehicle.", allow_abbrev=False
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="show the version and exit")
    _add_commands(parser, COMMANDS, "command", "COMMAND")
    return parser


def _add_commands(
    parser: argparse.ArgumentParser, commands: Mapping[str, Command | Group], name: str, metavar: str
) -> None:
    added = parser.add_subparsers(dest=name, metavar=metavar, required=True)
    for word, command in commands.items():
        help_text = command.words
        child = added.add_parser(
            word,
            help=help_text,
            description=f"{help_text[0].upper()}{help_text[1:]}.",
            epilog=command.epilog,
            allow_abbrev=False,
        )
        if isinstance(command, Group):
            _add_commands(child, command.commands, command.metavar.lower(), command.metavar)
            continue
        child.set_defaults(call=command.calls)
        for names, settings in command.arguments:
            child.add_argument(*names, **settings)


def _settle_changes(options: argparse.Namespace) -> None:
    """Read what changes the scenario; --set takes all words that follow it, FILE too where that stands last."""
    may_be_two = hasattr(options, "set_second")
    given = {name: getattr(options, name, []) for name in ("set", "set_second")}
    loose: list[str] = []
    if may_be_two or getattr(options, "file", "") is None:
        loose = [word for words in given.values() for word in words if "=" not in word]
        # a shipped vehicle without FILE runs in a scenario of its own
        vehicle = [word for word in given["set"] if word.startswith(VEHICLE)][:1]
        files = [*(options.file or []), *loose] or vehicle
        if not files or (not may_be_two and len(files) > 1):
            raise UsageError("FILE is missing: a scenario file or the name of a scenario.")
        if len(files) > MOST_FILES:
            raise UsageError(f"{len(files)} FILEs are named; at most {MOST_FILES} scenarios stand side by side.")
        options.file = files if may_be_two else files[0]
    for name, words in given.items():
        setattr(options, name, changes(word for word in words if word not in loose))


def _complain(sentence: str) -> int:
    """Print one sentence on standard error."""
    with contextlib.suppress(OSError):
        print(f"railjoule: {printable(sentence)}", file=sys.stderr, flush=True)
    return BAD_INPUT


def _drop_output() -> None:
    """Discard the interpreter's last flush, as nobody reads it any more."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


if __name__ == "__main__":
    sys.exit(main())
