"""Arguments that several commands share, and the functions that make arguments for `argparse`."""

from collections.abc import Callable, Mapping
from typing import Any

from railjoule.dashboard.command import values

TABLE_SUFFIXES, LABELLED_SUFFIXES = (".csv", ".parquet"), (".nc", ".csv", ".parquet")
Argument = tuple[tuple[str, ...], Mapping[str, Any]]
"""The names of an argument of a command, and its settings for `argparse`."""


def argument(*names: str, type: Callable[[str], Any] | None = None, **settings: Any) -> Argument:  # noqa: A002
    """Return an argument; a word that its type refuses raises UsageError with the name of the argument."""
    if type is None:
        return names, settings
    name = names[0] if names[0].startswith("-") else str(settings.get("metavar", names[0]))

    def read(text: str) -> Any:
        try:
            return type(text)
        except ValueError as error:
            # not an error of argparse's, which would put a name with all its other forms before the sentence
            raise values.UsageError(f"{name} {values.shortened(text)}: {error}.") from None

    return names, {**settings, "type": read}


def several(*names: str, **settings: Any) -> Argument:
    """Return an argument that takes several words, and may come more than once."""
    return argument(*names, nargs="+", action="extend", default=[], **settings)


def output(description: str, *suffixes: str, required: bool = True) -> Argument:
    """Return the option that names the file to write."""
    return argument("-o", "--output", metavar="OUT", type=values.file(*suffixes), required=required, help=description)


def changes(description: str = "as in solve") -> Argument:
    """Return the option that changes keys of a scenario."""
    return several("--set", metavar="KEY=VALUE", help=description)


def travel_time(description: str) -> Argument:
    """Return the option that names the time of a whole run."""
    return argument("--travel-time-s", metavar="T", type=values.seconds, help=description)


def trajectory(what: str) -> Argument:
    """Return the option that names the file for a run."""
    description = f"write the {what} to OUT.csv or OUT.parquet"
    return argument("--trajectory", metavar="OUT", type=values.file(*TABLE_SUFFIXES), help=description)


def file_argument(metavar: str, description: str, name: str = "file") -> Argument:
    """Return the argument that names the file to read."""
    return argument(name, metavar=metavar, help=description)


FILE = file_argument("FILE", "a scenario file, or the name of a scenario")
JSON = argument("--json", action="store_true", help="print JSON")
CHANGES = changes()
SCENARIO = (
    argument("file", metavar="FILE", nargs="?", help="a scenario file, or the name of a scenario"),
    changes("change a key of the file, such as vehicle.load_factor=0.3; the value is TOML, or typed as 0,3 or 2:30"),
    JSON,
)
STRATEGY = argument("--strategy", metavar="S", help="the driving strategy; default: the scenario's own")
PROOF = argument(
    "--prove-seconds",
    metavar="S",
    type=values.seconds,
    help="how long to tighten a bound that is loose, as that of a powertrain often is which takes power without "
    "effort, such as 10; 0: the first bound only; default: a fixed number of steps, about 0.5 s, as on the page",
)
ENCODING = argument(
    "--encoding",
    metavar="NAME",
    default="",
    help="code page of files that are not UTF-8, such as cp1250, cp1251 or gbk; default: found by their letters",
)


def columns(*other_names: str) -> tuple[Argument, ...]:
    """Return the options that say how a recorder writes its files."""
    return (
        argument(
            "--preset", metavar="P", default="generic", help="generic, osrd or ztbus; default: found by the columns"
        ),
        several(
            "--column",
            *other_names,
            metavar="QUANTITY=NAME",
            type=values.pair("speed=v [m/s]"),
            help="which column holds what, where its name does not tell, as 'speed=v [m/s]': time, position, speed, "
            "effort (braking negative), tractive_effort, braking_effort, brake, power, energy, line_current "
            "(regenerated negative) or line_voltage",
        ),
        several(
            "--unit",
            metavar="QUANTITY=UNIT",
            type=values.pair("speed=km/h"),
            help="such as speed=km/h effort=kN",
        ),
        argument("--sheet", metavar="NAME", help="the sheet of a workbook; needed where it has several"),
        ENCODING,
    )


RECORDING = (
    argument("--scenario", metavar="S", help="vehicle and line: a scenario file, or a shipped scenario"),
    argument(
        "--from",
        dest="start_m",
        metavar="M",
        type=values.number,
        help="where on the line the run begins; default: found",
    ),
    *columns(),
    argument(
        "--longest-gap",
        metavar="S",
        type=values.seconds,
        default=10.0,
        help="for how long samples may be missing; default: 10 s",
    ),
    CHANGES,
)
TOML_OUTPUT = output("OUT.toml", ".toml")
LABELLED_OUTPUT = output("OUT.nc (netCDF), OUT.csv or OUT.parquet", *LABELLED_SUFFIXES)
