"""Quantity and unit of each column of a recorder's file: by its name, by a preset, or from the user."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

from railjoule.core.errors import RecordingError
from railjoule.core.imports.columns import same_name
from railjoule.core.imports.numbers import M_PER_MILE
from railjoule.core.imports.units import CLOCK, plain, stated_unit
from railjoule.core.units import J_PER_KWH, J_PER_WH, MS_PER_KMH, N_PER_KN, W_PER_KW

UNITS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0, CLOCK: 1.0},
        "position": {"m": 1.0, "km": 1e3, "mi": M_PER_MILE},
        "speed": {"km/h": MS_PER_KMH, "m/s": 1.0, "mph": M_PER_MILE / 3600.0},
        "effort": {"N": 1.0, "kN": N_PER_KN},
        "tractive_effort": {"N": 1.0, "kN": N_PER_KN},
        "braking_effort": {"N": 1.0, "kN": N_PER_KN},
        # a pressure, or something that is above 0 where the brake is applied
        "brake": {"bar": 1e5, "kPa": 1e3, "Pa": 1.0, "%": 1.0, "on": 1.0},
        "power": {"W": 1.0, "kW": W_PER_KW, "MW": 1e3 * W_PER_KW},
        "energy": {"J": 1.0, "Wh": J_PER_WH, "kWh": J_PER_KWH, "MWh": 1e3 * J_PER_KWH},
        "line_current": {"A": 1.0, "kA": 1e3},
        "line_voltage": {"V": 1.0, "kV": 1e3},
    }
)
"""Quantities of a recorder, and what one of each unit is in SI."""
PRESSURES = ("bar", "kPa", "Pa")
SPELLINGS = {"time": {"sec": "s", "seconds": "s"}}
"""Of units in names of columns, beside those of speeds in other tables."""
NAMES: Mapping[str, Sequence[str]] = MappingProxyType(
    {
        "time": (
            *("time", "t", "seconds", "timestamp", "elapsed", "elapsed_time", "clock"),
            *("zeit", "uhrzeit", "temps", "heure", "horodatage"),
        ),
        "position": (
            *("position", "distance", "chainage", "odometer", "x", "s"),
            *("weg", "pk", "point_kilometrique", "distance_parcourue", "abscisse"),
        ),
        "speed": ("speed", "v", "velocity", "geschwindigkeit", "vitesse"),
        "effort": ("effort", "force", "wheel_effort", "effort_a_la_jante", "effort_jante"),
        "tractive_effort": (
            *("tractive_effort", "traction_effort", "tractive_force"),
            *("zugkraft", "effort_de_traction", "effort_traction"),
        ),
        "braking_effort": (
            *("braking_effort", "brake_effort", "braking_force"),
            *("bremskraft", "effort_de_freinage", "effort_freinage"),
        ),
        "brake": (
            *("brake", "brake_pressure", "cylinder_pressure", "brake_applied", "pressure"),
            *("bremsdruck", "pression_frein", "pression_cylindre_frein"),
        ),
        "power": ("power", "line_power", "electric_power", "power_demand", "leistung", "puissance"),
        "energy": (
            *("energy", "line_energy", "energy_counter", "meter", "counter"),
            *("energie", "compteur_energie"),
        ),
        "line_current": (
            *("line_current", "catenary_current", "pantograph_current", "collector_current"),
            *("netzstrom", "fahrleitungsstrom"),
            *("courant_ligne", "courant_catenaire", "courant_pantographe", "intensite_ligne"),
        ),
        "line_voltage": (
            *("line_voltage", "catenary_voltage", "pantograph_voltage"),
            *("netzspannung", "fahrleitungsspannung"),
            *("tension_ligne", "tension_catenaire", "tension_pantographe"),
        ),
    }
)
"""Names without their unit, by quantity, in English, German and French."""
PLAIN_NAMES: Mapping[str, Sequence[str]] = MappingProxyType(
    {
        "line_current": ("current", "strom", "courant", "intensite"),
        "line_voltage": ("voltage", "spannung", "tension"),
    }
)
"""Names that may also be those of a motor: taken for the line's where both are there."""
NEEDED_UNITS = (
    *("speed", "effort", "tractive_effort", "braking_effort", "power", "energy"),
    *("line_current", "line_voltage"),
)
"""Quantities whose unit must be known; times count as seconds, positions as metres, brakes as on above 0."""
TRAINS = (
    "train",
    "train id",
    "trainid",
    "train no",
    "trainno",
    "train number",
    "vehicle",
    "vehicle id",
    "zug",
    "zugnummer",
)
"""Names of columns of several trains in one file."""
LONGEST_GAP_S = 600.0
BRACKETS = re.compile(r"\s*(.*?)\s*[\[(]\s*(?:in\s+)?(.*?)\s*[\])]\s*")
"""A name, and its unit in brackets, as (km/h) or (in km/h)."""
USUAL_UNITS = MappingProxyType({"time": "s", "position": "m", "brake": "on"})


@dataclass(frozen=True)
class Column:
    """A column of a file with its quantity and unit, of `UNITS`; assumed if nothing names the unit."""

    quantity: str
    header: str
    unit: str
    is_assumed: bool = False

    @property
    def factor(self) -> float:
        """The SI value of one of its unit."""
        return UNITS[self.quantity][self.unit]


PRESETS: Mapping[str, Sequence[Column]] = MappingProxyType(
    {
        "generic": (),
        # what the export of a simulated run writes below three lines of text
        "osrd": (
            Column("time", "seconds", "s"),
            Column("position", "position", "km"),
            Column("speed", "speed", "km/h"),
        ),
        # Widmer, Ritter, Onder: ZTBus, doi 10.1038/s41597-023-02600-6, SI throughout
        "ztbus": (
            Column("time", "time_unix", "s"),
            Column("speed", "odometry_vehicleSpeed", "m/s"),
            Column("effort", "traction_tractionForce", "N"),
            Column("brake", "traction_brakePressure", "Pa"),
            Column("power", "electric_powerDemand", "W"),
        ),
    }
)
"""Columns of files of known programs; those of 'generic' are found by their names."""
MARKS: Mapping[str, Sequence[str]] = MappingProxyType(
    {
        # other files too have seconds, position and speed, with the position in other units
        "osrd": (*(column.header for column in PRESETS["osrd"]), "speedLimit"),
        "ztbus": tuple(column.header for column in PRESETS["ztbus"]),
    }
)
"""The columns by which files of known programs are known, where no preset is named."""


@dataclass(frozen=True)
class RecorderFormat:
    """How a recorder writes its files.

    Parameters
    ----------
    preset : str
        One of `PRESETS`.
    columns, units : mapping of str to str
        Names of columns and units by quantity from the user; they precede preset and names. A name may end with its
        unit, as 'v [m/s]'.
    longest_gap_s : float
        Maximum time without samples [s]: the speed in between is interpolated.
    assumed : mapping of str to str
        Units by quantity that are assumed, with a note, if nothing names one.
    encoding : str
        Code page of files that are not UTF-8; empty if it is to be found.
    """

    preset: str = "generic"
    columns: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    longest_gap_s: float = 10.0
    assumed: Mapping[str, str] = field(default_factory=dict)
    encoding: str = ""

    def require_known(self) -> None:
        """Raise RecordingError if the preset, a quantity or a unit is unknown, or the gap no length of time."""
        checks: list[tuple[str, str, Iterable[str]]] = [("--preset ", self.preset, PRESETS)]
        checks += [("--column ", quantity, UNITS) for quantity in self.columns]
        checks += [("--unit ", quantity, UNITS) for quantity in self.units]
        checks += [(f"--unit {quantity}=", unit, UNITS.get(quantity, ())) for quantity, unit in self.units.items()]
        for option, given, known in checks:
            if given not in known:
                raise RecordingError(f"{option}{given}: must be one of {', '.join(known)}.")
        if not 0 < self.longest_gap_s <= LONGEST_GAP_S:
            raise RecordingError(
                f"--longest-gap {self.longest_gap_s:g}: must be above 0 and at most {LONGEST_GAP_S:g} s."
            )


GENERIC = RecorderFormat()


def recognised(headers: Sequence[str], form: RecorderFormat) -> list[Column]:
    """Recognise columns by their names; their unit is empty if the name contains none."""
    named = {quantity: _named(headers, words) for quantity, words in form.columns.items()}
    columns = [
        Column(quantity, header, unit or _unit_in(header, quantity))
        for quantity, (header, unit) in named.items()
        if header is not None
    ]
    # a known program by the columns of its file, where no preset is named
    by_marks = next((name for name, marks in MARKS.items() if set(marks) <= set(headers)), "generic")
    preset = form.preset if form.preset != "generic" else by_marks
    if preset != "generic":
        return columns + [known for known in PRESETS[preset] if known.header in headers and known.quantity not in named]
    free = [header for header in headers if header not in {column.header for column in columns}]
    columns += [
        Column(quantity, header, _unit_in(header, quantity))
        for header in free
        # a name matches as a whole, and no name has two quantities: 'brake_pressure_bar' is no 'brake' in another unit
        for quantity, names in NAMES.items()
        if quantity not in named and _has_name(header, quantity, names)
    ]
    known = {column.quantity for column in columns}
    taken = {column.header for column in columns}
    plain_columns = [
        Column(quantity, header, _known_unit(_words(header)[1], quantity))
        for quantity, names in PLAIN_NAMES.items()
        if quantity not in known
        for header in free
        if header not in taken and _has_name(header, quantity, names)
    ]
    # current and voltage only count together, and beside a measured power they may be those of a motor
    is_needed = not known & {"power", "energy"}
    is_whole = known | {column.quantity for column in plain_columns} >= PLAIN_NAMES.keys()
    return columns + (plain_columns if is_needed and is_whole else [])


def _named(headers: Sequence[str], words: str) -> tuple[str | None, str]:
    """Find the column that a user names, None if there is none, and the unit in brackets behind its name."""
    match = re.fullmatch(r"(.*?)\s*\[([^\]]*)\]", words)
    for name, unit in ((words, ""), *([(match[1], match[2])] if match else [])):
        # a name in other letters would be nothing but signs to `same_name`, and like any other such name
        alike = [header for header in headers if name.isascii() and same_name(header, name)]
        if name in headers or alike:
            return name if name in headers else alike[0], unit
    return None, ""


def find_columns(headers: Sequence[str], form: RecorderFormat, source: str) -> list[Column]:
    """Recognise the columns of a file, each with its unit.

    Parameters
    ----------
    headers, form
        As in `recognised`.
    source : str
        The file, for sentences.

    Raises
    ------
    RecordingError
        If speed, or both time and position, are missing, a column that is named is not there, two columns hold one
        quantity, or a unit is missing.
    """
    has = f"the file has {', '.join(headers)}"[:200]
    for quantity, words in form.columns.items():
        header, unit = _named(headers, words)
        if header is None:
            raise RecordingError(f"{source}: there is no column {words!r} for {quantity}; {has}.")
        if unit and not _known_unit(unit, quantity):
            known = ", ".join(UNITS[quantity])
            raise RecordingError(f"{source}: {quantity} = {words!r}: the unit must be one of {known}.")
    columns: dict[str, Column] = {}
    for column in recognised(headers, form):
        if column.quantity in columns:
            raise RecordingError(
                f"{source}: the columns {columns[column.quantity].header!r} and {column.header!r} both hold a "
                f"{column.quantity}; choose one by --column {column.quantity}=NAME."
            )
        columns[column.quantity] = _with_unit(column, form, source)
    for missing, words, quantities in (
        ("speed", "speed", {"speed"}),
        ("time", "time or position", {"time", "position"}),
    ):
        if not quantities & columns.keys():
            raise RecordingError(f"{source}: no column holds the {words}; {has}. Name it by --column {missing}=NAME.")
    if "effort" in columns and {"tractive_effort", "braking_effort"} & columns.keys():
        raise RecordingError(
            f"{source}: column {columns['effort'].header!r} holds the effort of driving and braking, and another one "
            "holds a part of it."
        )
    return list(columns.values())


def _with_unit(column: Column, form: RecorderFormat, source: str) -> Column:
    quantity, header = column.quantity, column.header
    stated = form.units.get(quantity) or _known_unit(column.unit, quantity)
    strange = unknown_unit(header, quantity)
    unit = stated or form.assumed.get(quantity) or USUAL_UNITS.get(quantity)
    if unit is None or (strange and not stated):
        choices = " or ".join(f"--unit {quantity}={unit}" for unit in UNITS[quantity])
        doubt = (
            f"the unit {strange!r} of column {header!r} is not known" if strange else f"column {header!r} has no unit"
        )
        raise RecordingError(f"{source}: {doubt}; add {choices}.")
    return Column(quantity, header, unit, is_assumed=not stated)


def unknown_unit(header: str, quantity: str) -> str:
    """Extract the text in brackets behind the name of a column if it is no unit of its quantity; else an empty one."""
    match = BRACKETS.fullmatch(header)
    if match is None or quantity == "brake" or not re.search("[a-z]", match[2].lower()):
        return ""
    is_clock = quantity == "time" and ":" in match[2]
    return "" if is_clock or _known_unit(match[2], quantity) else match[2]


def _words(header: str) -> tuple[str, str]:
    """Split a column's name from the word that may be its unit, such as 'speed' and 'km/h' of 'Speed [km/h]'."""
    match = BRACKETS.fullmatch(header)
    # in small letters, without accents, and with one sign between words
    name = re.sub(r"[\s\-.'\u2019]+", "_", plain((match[1] if match else header).strip()))
    rate = re.search(r"[^_]+_per_[^_]+$", name)
    return name, match[2] if match else rate[0] if rate else name.rpartition("_")[2]


def _has_name(header: str, quantity: str, names: Sequence[str]) -> bool:
    name, unit = _words(header)
    return name in names or (name.removesuffix(f"_{unit}") in names and _known_unit(unit, quantity) != "")


def _unit_in(header: str, quantity: str) -> str:
    """Return the unit in the name of a column; empty if it has none."""
    name, unit = _words(header)
    is_only_name = name in NAMES[quantity] and BRACKETS.fullmatch(header) is None
    return _known_unit(unit, quantity) if not is_only_name else "s" if name == "seconds" else ""


def has_plain_name(column: Column) -> bool:
    """Tell whether the name of a column of the line's current or voltage does not name the line."""
    return _has_name(column.header, column.quantity, PLAIN_NAMES.get(column.quantity, ()))


def _known_unit(word: str, quantity: str) -> str:
    """Look up a unit by its spelling; empty if it is unknown."""
    by_spelling = {**SPELLINGS.get(quantity, {}), **{unit.lower(): unit for unit in UNITS[quantity]}}
    unit = by_spelling.get(word.lower()) or (
        stated_unit(word.replace("_", " "), "limits") if quantity == "speed" else None
    )
    return unit if unit is not None and unit in UNITS[quantity] else ""
