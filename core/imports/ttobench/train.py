"""Files of TTOBench, a library for train trajectory optimisation, versions 1.1 to 1.5; and its trains."""

from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field, create_model

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Foreign, Notes
from railjoule.core.imports.source_file import SourceFile, read_json
from railjoule.core.imports.vehicle import ImportedVehicle, imported_vehicle
from railjoule.core.scenario._base import Number
from railjoule.core.scenario._sentences import show, validated
from railjoule.core.units import MS_PER_KMH, N_PER_KN

KNOWN_VERSIONS = ("1.1", "1.5")
"""The first and the last that are known."""
UNITS: dict[str, dict[str, float]] = {
    "m": {"m": 1.0, "km": 1000.0},
    "kg": {"kg": 1.0, "t": 1000.0},
    "kW": {"kW": 1.0, "W": 1e-3, "MW": 1e3},
    "kN": {"kN": 1.0, "N": 1e-3},
    "N": {"kN": N_PER_KN, "N": 1.0},
    "km/h": {"km/h": 1.0, "m/s": 1 / MS_PER_KMH},
    "m/s2": {"m/s^2": 1.0},
    "share": {"%": 0.01, "-": 1.0},
    "permille": {"permil": 1.0, "\u2030": 1.0, "%": 10.0},
    "s": {"s": 1.0, "min": 60.0},
    "m2": {"m^2": 1.0},
    "N/(km/h)": {
        "kN/(km/h)": N_PER_KN,
        "N/(km/h)": 1.0,
        "kN/(m/s)": N_PER_KN * MS_PER_KMH,
        "N/(m/s)": MS_PER_KMH,
    },
    "N/(km/h)2": {
        "kN/(km/h)^2": N_PER_KN,
        "N/(km/h)^2": 1.0,
        "kN/(m/s)^2": N_PER_KN * MS_PER_KMH**2,
        "N/(m/s)^2": MS_PER_KMH**2,
    },
}
"""Factors from each unit of the files to that of a scenario's key; the first holds for columns without one."""
NUMBERS = {
    "mass": ("tare_kg", "kg", True),
    "rho": ("rotating_mass_factor", "share", False),
    "length": ("length_m", "m", False),
    "rolling resistance r0": ("resistance.constant_n", "N", True),
    "rolling resistance r1": ("resistance.linear_n_per_kmh", "N/(km/h)", True),
    "rolling resistance r2": ("resistance.quadratic_n_per_kmh2", "N/(km/h)2", True),
    "max traction force": ("traction.max_effort_kn", "kN", True),
    "max traction power": ("traction.max_power_kw", "kW", True),
    "max speed": ("traction.max_speed_kmh", "km/h", True),
    "max acceleration": ("traction.max_acceleration_ms2", "m/s2", False),
    "max reg braking force": ("braking.max_effort_kn", "kN", True),
    "max reg braking power": ("braking.max_power_kw", "kW", True),
    "max pn braking force": ("braking.friction_effort_kn", "kN", False),
    "max deceleration": ("braking.max_deceleration_ms2", "m/s2", False),
    "efficiency traction": ("drive.traction_efficiency", "share", False),
    "efficiency reg brake": ("drive.braking_efficiency", "share", False),
}
"""Numbers of a train's file: the key of a scenario's vehicle, its unit, and whether a file must have it."""


class Metadata(Foreign):
    """Identity and version of a file."""

    id: str = Field(max_length=200)
    library_version: str = Field("", alias="library version")


class Quantity(Foreign):
    """A number and its unit."""

    unit: str
    value: Number


class Columns(Foreign):
    """Rows of numbers, and the units of their columns."""

    units: dict[str, str]

    def factor(self, column: str, kind: str, place: str) -> float:
        """Look up the factor of a column's unit to that of a kind; the sentence of an error begins with `place`."""
        known = UNITS[kind]
        return unit_factor(self.units.get(column, next(iter(known))), kind, f"{place}.units.{column}")


Positive = Annotated[Number, Field(ge=0)]


class TunnelResistance(Columns):
    """Increase of the quadratic term of resistance by cross section of a tunnel."""

    values: tuple[tuple[Positive, Positive], ...] = Field(min_length=1, max_length=1000)


class TrainTables(Foreign):
    """The tables of a train's file; its numbers come from `NUMBERS`."""

    metadata: Metadata
    coaches: Quantity | None = Field(None, alias="num coaches")
    tunnel_resistance: TunnelResistance | None = Field(None, alias="tunnel resistance")


_FIELDS: dict[str, Any] = {
    key.replace(" ", "_"): (Quantity, Field(alias=key)) if is_needed else (Quantity | None, Field(None, alias=key))
    for key, (_, _, is_needed) in NUMBERS.items()
}
Train = create_model("Train", __base__=TrainTables, **_FIELDS)


def unit_factor(unit: Any, kind: str, place: str) -> float:
    """Look up the factor of a unit to that of a kind in `UNITS`.

    Raises
    ------
    ScenarioError
        If the unit is not known; the sentence begins with `place`.
    """
    if unit not in UNITS[kind]:
        raise ScenarioError(f"{place} = {show(unit)} must be one of {', '.join(UNITS[kind])}.")
    return UNITS[kind][unit]


def notes_on(table: Any, source: str) -> Notes:
    """Note an unknown version and unknown keys of a file."""
    notes = Notes(source)
    notes.add_unknown_keys(table)
    notes.version("library version", table.metadata.library_version, KNOWN_VERSIONS)
    return notes


@dataclass(frozen=True)
class TunnelCoefficients:
    """The increase of a train's quadratic term of resistance [N/(km/h)2] over rising cross sections of tunnels."""

    area_m2: tuple[float, ...]
    added_n_per_kmh2: tuple[float, ...]
    open_n_per_kmh2: float

    def factor_in(self, area_m2: float) -> float | None:
        """Compute the factor on the quadratic term: linear between two known cross sections, None outside them."""
        if not self.area_m2[0] <= area_m2 <= self.area_m2[-1] or self.open_n_per_kmh2 <= 0:
            return None
        return 1 + float(np.interp(area_m2, self.area_m2, self.added_n_per_kmh2)) / self.open_n_per_kmh2


@dataclass(frozen=True)
class ImportedTrain(ImportedVehicle):
    """A train, and what tunnels do to it."""

    tunnels: TunnelCoefficients | None = None


def read_train(source: SourceFile) -> ImportedTrain:
    """Read the vehicle of a train's file.

    Raises
    ------
    ScenarioError
        If anything is wrong with the file.
    """
    train = validated(Train, read_json(source), source.name)
    notes = notes_on(train, source.name)
    table: dict[str, Any] = {"name": train.metadata.id, "resistance": {}, "traction": {}, "braking": {}}
    table["drive"] = {"model": "constant_efficiency"}
    for key, (path, kind, _) in NUMBERS.items():
        quantity, (*parent, name) = getattr(train, key.replace(" ", "_")), path.split(".")
        if quantity is not None:
            factor = unit_factor(quantity.unit, kind, f"{source.name}: {key}.unit")
            (table[parent[0]] if parent else table)[name] = factor * quantity.value
    table.setdefault("rotating_mass_factor", 0.0)
    coaches = train.coaches.value if train.coaches else None
    if coaches is not None and "length_m" not in table:
        notes.add_unused("num coaches, as it gives no length.")
    elif coaches is not None and coaches == int(coaches):
        table["car_count"] = int(coaches)
    braking = table["braking"]
    if not braking["max_power_kw"]:
        # no power is no brake, which our keys say by its effort
        braking |= {"max_effort_kn": 0.0, "max_power_kw": None}
    braking["friction_effort_kn"] = braking.get("friction_effort_kn") or None
    for key in ("efficiency traction", "efficiency reg brake"):
        name = NUMBERS[key][0].removeprefix("drive.")
        if name not in table["drive"]:
            table["drive"][name] = 1.0
            notes.add("assumption", f"{key} is missing: a drive without losses.")
    notes.add("assumption", "all that braking generates goes back: recuperation_factor = 1.")
    table["drive"]["recuperation_factor"] = 1.0
    imported = imported_vehicle(table, notes)
    open_n_per_kmh2 = table["resistance"]["quadratic_n_per_kmh2"]
    return ImportedTrain(
        **vars(imported), tunnels=_tunnel_coefficients(train.tunnel_resistance, notes, open_n_per_kmh2)
    )


def _tunnel_coefficients(
    given: TunnelResistance | None, notes: Notes, open_n_per_kmh2: float
) -> TunnelCoefficients | None:
    if given is None:
        return None
    where = f"{notes.source}: tunnel resistance"
    area = given.factor("cross section", "m2", where)
    added = given.factor("coefficient", "N/(km/h)2", where)
    areas, coefficients = zip(*sorted((area * row[0], added * row[1]) for row in given.values), strict=True)
    if len(set(areas)) < len(areas):
        raise ScenarioError(f"{where}.values has a cross section twice.")
    return TunnelCoefficients(areas, coefficients, open_n_per_kmh2)
