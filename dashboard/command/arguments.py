"""The commands of `railjoule` with their arguments, as a table; each function is imported when it is called."""

from collections.abc import Mapping
from dataclasses import dataclass

from railjoule.dashboard.command import values
from railjoule.dashboard.command.shared_options import (
    CHANGES,
    ENCODING,
    FILE,
    JSON,
    LABELLED_OUTPUT,
    PROOF,
    RECORDING,
    SCENARIO,
    STRATEGY,
    TABLE_SUFFIXES,
    TOML_OUTPUT,
    Argument,
    argument,
    changes,
    columns,
    file_argument,
    output,
    several,
    trajectory,
    travel_time,
)
from railjoule.dashboard.report.section_names import SECTION_TITLES
from railjoule.dashboard.server.options import DEFAULT_ADDRESS, DEFAULT_PORT, EXPOSED, HIGHEST_PORT, NO_LOGIN

CHECK_STATUS = "Exit status: 0 if the run keeps every rule, 1 if it breaks one, 2 for bad input."
REPORT_SUFFIXES = (".html", ".htm")
MOST_SESSIONS = 10_000


@dataclass(frozen=True)
class Command:
    """A command: its purpose, its function as 'module.function' of this package, and its arguments."""

    words: str
    calls: str
    arguments: tuple[Argument, ...] = ()
    epilog: str | None = None


@dataclass(frozen=True)
class Group:
    """Commands below a common word, and the placeholder of their names in the usage."""

    words: str
    metavar: str
    commands: Mapping[str, Command]
    epilog: str | None = None


STUDY = (FILE, LABELLED_OUTPUT, CHANGES)
ROBUST = (
    *STUDY,
    # as core/studies/robust_plan.py has them, which is too slow to import for a line of help
    argument(
        "--probability",
        metavar="P",
        type=values.share,
        default=0.9,
        help="of an arrival on time, above 0 to 1; default: 0.9",
    ),
    argument(
        "--candidates", metavar="N", type=values.whole(0), default=24, help="plans to try, 1 to 1000; default: 24"
    ),
    trajectory("robust plan"),
    JSON,
)
SWEEP = (
    *STUDY,
    several(
        "--over",
        metavar="FIELD=LOW:HIGH",
        type=values.field_range,
        required=True,
        help="a number of the scenario and between which values it varies, such as vehicle.load_factor=0:1",
    ),
    argument("--sample", metavar="N", type=values.whole(0), required=True, help="how many rows"),
    argument(
        "--method",
        choices=("grid", "random", "sobol", "halton"),
        default="sobol",
        help="how the rows are drawn; default: sobol; a grid has N^(1/fields) values of each field",
    ),
    argument("--seed", metavar="K", type=values.whole(0), default=0, help="the same seed draws the same; default: 0"),
    STRATEGY,
    several(
        "--columns",
        metavar="NAME",
        help="further columns, such as max_speed_kmh, traction_energy_kwh, recuperated_kwh or losses_kwh",
    ),
    argument(
        "--scheduler",
        metavar="ADDRESS",
        help="of a Dask scheduler whose workers solve the rows, such as tcp://node1:8786; default: this machine's "
        "processors; needs the extra cluster",
    ),
    argument(
        "--resume",
        action="store_true",
        help="go on with a sweep that was stopped or killed, whose rows are kept beside the table",
    ),
    JSON,
)
STUDIES = {
    "tradeoff": Command("solve a scenario for many travel times", "studies.tradeoff", STUDY),
    "sensitivity": Command(
        "drive a plan with other loads and errors of place than planned", "studies.sensitivity", STUDY
    ),
    "assumptions": Command(
        "solve with each assumed value of the vehicle 20 %% too low and too high", "studies.assumptions", STUDY
    ),
    "montecarlo": Command("drive a plan under what chance brings", "studies.montecarlo", STUDY),
    "braking": Command(
        "stop with errors of the braking sensors and the measured speed, with precision braking and without",
        "studies.braking",
        STUDY,
    ),
    "robust": Command(
        "find the plan with the least expected energy that is on time with a chosen probability",
        "studies.robust",
        ROBUST,
        "Each plan is followed under a fifth of montecarlo.runs, and the robust one checked by all of montecarlo.runs "
        "under another seed. disturbance.accepted_delay_s is the lateness that still counts as on time.",
    ),
    "sweep": Command(
        "solve a scenario very many times with other numbers",
        "sweeps.sweep",
        SWEEP,
        "A row that cannot be driven stands in the table with its reason; it is no error.",
    ),
}
INTERVALS = (
    argument(
        "files",
        metavar="FILE",
        nargs="*",
        help="tables that are found by the names of their columns, each sheet of a workbook for itself",
    ),
    *(
        argument(f"--{kind}", metavar="FILE", help=f"a table of {what}")
        for kind, what in (
            ("gradients", "gradients, with columns from, to and value; so are limits, curves, tunnels and neutral"),
            ("heights", "heights over position, or a track in GPX, in place of gradients"),
            ("limits", "speed limits"),
            ("curves", "radii or curvatures"),
            ("tunnels", "tunnels"),
            ("neutral", "neutral sections"),
            ("stations", "stations: name, position, dwell time, arrival, departure, earliest and latest arrival"),
        )
    ),
    several(
        "--preset",
        metavar="NAME",
        help="columns of a published table: sncf-gradients, sncf-limits, sncf-curves or rinf-gradients",
    ),
    several(
        "--columns",
        metavar="TABLE.KEY=VALUE",
        type=values.of_table,
        help="which column holds what, as gradients.from=PKD; KEY is from, to, value, direction, of stations "
        "name, position, dwell, arrival, departure, earliest, latest; position_unit (m, km, "
        "mi, ch, yd, ft, pk, mi.ch, mi.yd), value_unit (of gradients permille, percent, fraction, ratio for 1 in n, "
        "deg, rad, per10000, ft/mi; of limits km/h, m/s, mph; of heights m, ft; of curves m, km, ft, yd, ch, "
        "mi, 1/m, 1/km, 1/ft, or deg for the degree of curve over a chord and deg_arc over an arc; of tunnels factor, "
        "m2; of stations s, min, h), decimal, sheet or of heights tolerance_m (1: the largest difference in m)",
    ),
    several(
        "--rows",
        metavar="TABLE.COLUMN=VALUE",
        type=values.of_table,
        help="use only the rows of one line or track, as gradients.NOM_VOIE=V1",
    ),
    argument(
        "--begin",
        metavar="PLACE",
        type=values.chainage,
        help="chainage at which the line begins, as 12+345 or 12.345km",
    ),
    argument("--end", metavar="PLACE", type=values.chainage, help="chainage at which it ends"),
    argument("--reverse", action="store_true", help="run it in falling chainage"),
    argument("--name", metavar="NAME", help="the line's name"),
    ENCODING,
    argument(
        "--vehicle",
        metavar="V",
        help="a shipped vehicle, or the FILE.toml of one: OUT.toml is then a whole scenario with it",
    ),
    travel_time("with --vehicle: time for the whole run; default: 10 %% above the shortest possible"),
    output("OUT.toml, or OUT.csv for line.file of a scenario", ".toml", ".csv"),
)
TTOBENCH = (
    file_argument("TRACK", "TRACK.json"),
    argument("--train", metavar="TRAIN", required=True, help="TRAIN.json"),
    argument("--journey", metavar="J", help="JOURNEY.json, for travel time and stops"),
    argument(
        "--stops", choices=("all", "ends"), default="all", help="stop at all stops, the default, or only at the ends"
    ),
    ENCODING,
    travel_time("time for the whole run; default: the journey's, or 10 %% above the shortest possible"),
    TOML_OUTPUT,
)
OSRD_STOCK = (
    file_argument("FILE", "FILE.json"),
    argument("--train", metavar="NAME", help="the rolling stock of that name; needed where there are several"),
    argument("--mode", metavar="M", help="the supply whose efforts are taken; default: the file's"),
    ENCODING,
    TOML_OUTPUT,
)
RAILTOOLKIT = (
    file_argument("FILE", "FILE.yaml"),
    argument(
        "--train",
        "--path",
        "--id",
        dest="train",
        metavar="ID",
        help="the train, vehicle or path of that id; needed where there are several",
    ),
    ENCODING,
    TOML_OUTPUT,
)
DATA_SHEET = (
    argument(
        "sheet",
        metavar="KEY=VALUE",
        nargs="+",
        type=values.sheet_value,
        help="values of the sheet: mass_t, power_kw, max_speed_kmh, length_m, max_effort_kn or max_acceleration_ms2, "
        "and where it gives them name, kind (multiple_unit, light_rail, high_speed, freight), cars, axles, "
        "driven_axles, capacity_passengers, rotating_mass_factor, service_deceleration_ms2, electric_brake_kn, "
        "regenerative, efficiency, auxiliary_power_kw, front_area_m2, line_voltage_v",
    ),
    TOML_OUTPUT,
)
RECORDED = (
    file_argument("FILE", "FILE.csv, FILE.xlsx or FILE.gpx"),
    *columns("--columns"),
    output("OUT.csv or OUT.parquet", *TABLE_SUFFIXES),
)
FORMATS = {
    "ttobench": Command(
        "make a scenario of a track and a train of TTOBench, JSON 1.1 to 1.5", "imports.ttobench", TTOBENCH
    ),
    "intervals": Command(
        "put a line together from tables of intervals, heights and stations: CSV, XLSX, GPX",
        "imports.intervals",
        INTERVALS,
    ),
    "osrd-stock": Command(
        "make a vehicle of a rolling stock of OSRD, JSON 3.0 to 3.4", "imports.osrd_stock", OSRD_STOCK
    ),
    "railtoolkit": Command(
        "make a vehicle or a line of a file of railtoolkit, YAML 2022.05 or 2024.07", "imports.railtoolkit", RAILTOOLKIT
    ),
    "data-sheet": Command(
        "make a vehicle of the values of a data sheet; all others are assumed and listed",
        "imports.data_sheet",
        DATA_SHEET,
    ),
    "run": Command(
        "make the table of a run of what a recorder measured, CSV, XLSX or GPX", "imports.measured_run", RECORDED
    ),
}
SERVE = (
    argument("--port", type=values.whole(1, HIGHEST_PORT), default=DEFAULT_PORT, help=f"default: {DEFAULT_PORT}"),
    argument("--address", default=DEFAULT_ADDRESS, help=f"default: {DEFAULT_ADDRESS}, this machine only"),
    several(
        "--origin",
        type=values.origin,
        metavar="NAME[:PORT]",
        help="further names under which browsers reach the server, as behind a proxy; it answers to no others",
    ),
    argument("--prefix", type=values.prefix, default="", metavar="PATH", help="serve below this path, not at /"),
    argument(
        "--sessions",
        type=values.whole(1, MOST_SESSIONS),
        metavar="N",
        help="pages open at a time at most; default: any number",
    ),
    argument(
        "--folder",
        metavar="DIR",
        help="the folder of scenario files that Start lists, in which every visitor can save; default: one in your "
        "data directory, but none where --address or --origin lets others in",
    ),
)
REPORT = (
    FILE,
    output("OUT.html", *REPORT_SUFFIXES),
    argument("--strategy", metavar="S", help="whose results come first; default: the scenario's own"),
    several(
        "--sections",
        metavar="NAME",
        help=f"which sections it has: {', '.join(SECTION_TITLES)}; default: all",
    ),
    argument("--second", metavar="FILE", help="a second scenario, which a section sets beside the first"),
    argument("--author", metavar="NAME", default="", help="who has written it"),
    argument(
        "--note",
        metavar="TEXT_FILE",
        help="a file with a note by the author: plain text, in which an empty line begins a new paragraph",
    ),
    PROOF,
    CHANGES,
)
CHECK = (
    argument(
        "run",
        metavar="RUN",
        type=values.file(*TABLE_SUFFIXES),
        help="RUN.csv or RUN.parquet, as solve --trajectory writes it, or a name",
    ),
    argument("--scenario", metavar="S", help="its scenario file, report, or the name of a scenario"),
    argument("--strategy", metavar="S", help="the strategy that made the run; default: the scenario's own"),
    CHANGES,
    JSON,
)
FIT = (
    argument("runs", metavar="RUN", nargs="+", help="tables of a recorder: RUN.csv or RUN.xlsx"),
    *RECORDING,
    argument(
        "--free",
        metavar="NAME",
        nargs="+",
        help="the parameters to find: resistance.constant_n, resistance.linear_n_per_kmh, "
        "resistance.quadratic_n_per_kmh2, rotating_mass_factor, drive.traction_efficiency, auxiliary_power_kw, all of "
        "them by default, and total_mass_kg",
    ),
    several(
        "--gauge",
        metavar="ERROR=PERCENT",
        type=values.pair("effort_gain=1", values.number),
        help="standard deviations of calibration errors: effort_gain (default 2), effort_offset (0.7), power_gain (1), "
        "power_offset (0.2), offsets over the largest reading, and speed_gain (1) of runs that are not between two "
        "stations; 0 for an exact gauge",
    ),
    argument("--coasting", action="store_true", help="use nothing but samples without effort"),
    output("write the scenario with the fitted vehicle as OUT.toml", ".toml", required=False),
    JSON,
)
COMPARE = (
    argument("file", metavar="FILE", nargs="*", help="a scenario file, or the name of a scenario; one or two of them"),
    changes("change a key of the file, as in solve; of two scenarios in both"),
    several("--set-second", metavar="KEY=VALUE", help="change a key of the second scenario"),
    JSON,
    PROOF,
)
COMMANDS: Mapping[str, Command | Group] = {
    "serve": Command(
        "serve the dashboard in the browser",
        "commands.serve",
        SERVE,
        f"{NO_LOGIN} With the default address, only users of this machine reach it. {EXPOSED}",
    ),
    "solve": Command(
        "solve one scenario",
        "commands.solve",
        (
            *SCENARIO,
            STRATEGY,
            trajectory("run"),
            argument("--check", action="store_true", help="check the run against its scenario: see `railjoule check`"),
            PROOF,
        ),
        f"With --check: {CHECK_STATUS.lower()} A run that misses a window of arrival ends with status 2, too.",
    ),
    "compare": Command(
        "run every strategy that fits a scenario, or set two scenarios side by side",
        "commands.compare",
        COMPARE,
        "Two scenarios are each run by their own strategy; --set changes both, and --set-second only the second, which "
        "is the first one with these changes if only one FILE is named.",
    ),
    "advise": Command(
        "find the best run with few changes of the regime",
        "commands.advise",
        (
            *SCENARIO,
            # as core/studies/simple_advice.py bounds them, which is too slow to import for a line of help
            argument(
                "--changes",
                type=values.whole(2, 9),
                metavar="K",
                help="changes of regime between two stops at most, 2 to 9; default: as few as cost no more than 1 %% "
                "of energy",
            ),
        ),
    ),
    "simulate": Command("follow the plan of a scenario under its disturbance", "commands.simulate", SCENARIO),
    "study": Group("solve many scenarios and write a labelled table", "STUDY", STUDIES),
    "report": Command("write all results of a scenario to one HTML file that works offline", "commands.report", REPORT),
    "benchmark": Command(
        "time every strategy on the shipped scenarios, and CasADi with IPOPT", "commands.benchmark", (JSON,)
    ),
    "limits": Command("show what is asked for at most, in a terminal and on a page", "commands.limits"),
    "compile": Command(
        "compile the solver ahead of its first use, as for an image or a cluster", "commands.compile_kernels"
    ),
    "validate": Command(
        "compare the papers' published numbers with those of railjoule",
        "commands.validate",
        (
            argument(
                "paper",
                metavar="PAPER",
                nargs="?",
                help="ftorek, liashenko, rawicki or shtompel; default: all papers",
            ),
            JSON,
        ),
    ),
    "check": Command(
        "check a run against its scenario, by formulas that share no code with the solvers",
        "commands.check",
        CHECK,
        CHECK_STATUS,
    ),
    "import": Group(
        "read lines, vehicles and runs from files of other programs",
        "FORMAT",
        FORMATS,
        "Contents of the files that were not used are listed on standard error.",
    ),
    "measured": Command(
        "put a measured run beside the model and the optimum in its time",
        "measurements.measured",
        (
            file_argument("RUN", "the table of a recorder: RUN.csv or RUN.xlsx", "run"),
            *RECORDING,
            trajectory("run"),
            output("write its line, stops and time as OUT.toml", ".toml", required=False),
            JSON,
        ),
    ),
    "fit": Command(
        "find resistance, inertia, efficiency and auxiliaries of a train from measured runs", "measurements.fit", FIT
    ),
}
