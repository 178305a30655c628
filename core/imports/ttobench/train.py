"""Files of TTOBench, a library for train trajectory optimisation, versions 1.1 to 1.5; and its trains."""

import re
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Foreign, Notes, unknown_keys
from railjoule.core.imports.source_file import SourceFile, json_of
from railjoule.core.imports.vehicle import ImportedVehicle, imported_vehicle
from railjoule.core.scenario._base import Number
from railjoule.core.scenario._sentences import show, validated
from railjoule.core.units import MS_PER_KMH, N_PER_KN

KNOWN_VERSIONS = ((1, 1), (1, 5))
"""The first and the last that are known."""
M_UNITS = {"m": 1.0, "km": 1000.0}
KG_UNITS = {"kg": 1.0, "t": 1000.0}
KW_UNITS = {"kW": 1.0, "W": 1e-3, "MW": 1e3}
KN_UNITS = {"kN": 1.0, "N": 1e-3}
KMH_UNITS = {"km/h": 1.0, "m/s": 1 / MS_PER_KMH}
MS2_UNITS = {"m/s^2": 1.0}
SHARE_UNITS = {"%": 0.01, "-": 1.0}
PERMILLE_UNITS = {"permil": 1.0, "\u2030": 1.0, "%": 10.0}
SECOND_UNITS = {"s": 1.0, "min": 60.0}
AREA_UNITS = {"m^2": 1.0}
N_PER_KMH_UNITS = {
    "kN/(km/h)": N_PER_KN,
    "N/(km/h)": 1.0,
    "kN/(m/s)": N_PER_KN * MS_PER_KMH,
    "N/(m/s)": MS_PER_KMH,
}
N_PER_KMH2_UNITS = {
    "kN/(km/h)^2": N_PER_KN,
    "N/(km/h)^2": 1.0,
    "kN/(m/s)^2": N_PER_KN * MS_PER_KMH**2,
    "N/(m/s)^2": MS_PER_KMH**2,
}
"""Factors from each unit to the unit of a scenario's key."""
Positive = Annotated[Number, Field(ge=0)]


class Metadata(Foreign):
    """Identity and version of a file."""

    id: str = Field(max_length=200)
    library_version: str = Field("", alias="library version")


class Quantity(Foreign):
    """A number and its unit."""

    unit: str
    value: Number


class Stops(Foreign):
    """Possible stops; the track reaches from the first to the last."""

    unit: str
    values: tuple[Number, ...] = Field(min_length=2, max_length=1000)


class Pairs(Foreign):
    """Values that hold from a position on."""

    units: dict[str, str]
    values: tuple[tuple[Number, Number], ...] = Field(min_length=1, max_length=100_000)


class Curvatures(Foreign):
    """Radii at the begin and at the end of a curve or a transition, or 'infinity'."""

    units: dict[str, str]
    values: tuple[tuple[Number, Number | str, Number | str], ...] = Field(min_length=1, max_length=100_000)


class Tunnels(Foreign):
    """Begin, length and cross section of tunnels."""

    units: dict[str, str]
    values: tuple[tuple[Number, Positive, Positive], ...] = Field(max_length=10_000)


class Track(Foreign):
    """A line."""

    metadata: Metadata
    stops: Stops
    speed_limits: Pairs = Field(alias="speed limits")
    gradients: Pairs | None = None
    curvatures: Curvatures | None = None
    tunnels: Tunnels | None = None


class TunnelResistance(Foreign):
    """Increase of the quadratic term of resistance by cross section of a tunnel."""

    units: dict[str, str]
    values: tuple[tuple[Positive, Positive], ...] = Field(min_length=1, max_length=1000)


class Train(Foreign):
    """A vehicle."""

    metadata: Metadata
    coaches: Quantity | None = Field(None, alias="num coaches")
    length: Quantity | None = None
    mass: Quantity
    rho: Quantity | None = None
    traction_power: Quantity = Field(alias="max traction power")
    braking_power: Quantity = Field(alias="max reg braking power")
    traction_force: Quantity = Field(alias="max traction force")
    braking_force: Quantity = Field(alias="max reg braking force")
    pneumatic_force: Quantity | None = Field(None, alias="max pn braking force")
    acceleration: Quantity | None = Field(None, alias="max acceleration")
    deceleration: Quantity | None = Field(None, alias="max deceleration")
    speed: Quantity = Field(alias="max speed")
    r0: Quantity = Field(alias="rolling resistance r0")
    r1: Quantity = Field(alias="rolling resistance r1")
    r2: Quantity = Field(alias="rolling resistance r2")
    traction_efficiency: Quantity | None = Field(None, alias="efficiency traction")
    braking_efficiency: Quantity | None = Field(None, alias="efficiency reg brake")
    tunnel_resistance: TunnelResistance | None = Field(None, alias="tunnel resistance")


TimingPoint = tuple[Number, Number | None, Number | None, Number | None, Number | None]


class TimingPoints(Foreign):
    """Position, least and largest time, least and largest speed; an empty one is free."""

    units: dict[str, str]
    values: tuple[TimingPoint, ...] = Field(min_length=2, max_length=2000)


class Journey(Foreign):
    """When a train is where."""

    metadata: Metadata
    timing_points: TimingPoints = Field(alias="timing points")


def factor_of(unit: Any, units: dict[str, float], place: str) -> float:
    """Look up the factor of a unit.

    Raises
    ------
    ScenarioError
        If the unit is not known; the sentence begins with `place`.
    """
    if unit not in units:
        raise ScenarioError(f"{place} = {show(unit)} must be one of {', '.join(units)}.")
    return units[unit]


def column_factor(units: dict[str, str], column: str, known: dict[str, float], place: str) -> float:
    """Look up the factor of a column's unit, by default of the first that is known."""
    return factor_of(units.get(column, next(iter(known))), known, f"{place}.units.{column}")


def notes_on(table: Any, source: str) -> Notes:
    """Note an unknown version and unknown keys of a file."""
    notes = Notes(source)
    notes.add_unused(unknown_keys(table))
    version = table.metadata.library_version
    found = re.search(r"(\d{1,4})\.(\d{1,4})", version)
    first, last = KNOWN_VERSIONS
    if not found or not first <= (int(found[1]), int(found[2])) <= last:
        what = f"its library version is {show(version)}" if version else "it has no version"
        notes.add("question", f"{what}, and 1.1 to 1.5 are known: what is known of it was read.")
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
    train = validated(Train, json_of(source), source.name)
    notes = notes_on(train, source.name)
    number = _Numbers(source.name)
    r2 = number.of(train.r2, "rolling resistance r2", N_PER_KMH2_UNITS)
    table: dict[str, Any] = {
        "name": train.metadata.id,
        "tare_kg": number.of(train.mass, "mass", KG_UNITS),
        "rotating_mass_factor": number.of(train.rho, "rho", SHARE_UNITS) or 0.0,
        **_length(train, number, notes),
        "resistance": {
            "constant_n": N_PER_KN * number.some(train.r0, "rolling resistance r0", KN_UNITS),
            "linear_n_per_kmh": number.of(train.r1, "rolling resistance r1", N_PER_KMH_UNITS),
            "quadratic_n_per_kmh2": r2,
        },
        "traction": _without_none(
            max_effort_kn=number.of(train.traction_force, "max traction force", KN_UNITS),
            max_power_kw=number.of(train.traction_power, "max traction power", KW_UNITS),
            max_speed_kmh=number.of(train.speed, "max speed", KMH_UNITS),
            max_acceleration_ms2=number.of(train.acceleration, "max acceleration", MS2_UNITS),
        ),
        "braking": _braking(train, number),
        "drive": _drive(train, number, notes),
    }
    imported = imported_vehicle(table, notes)
    return ImportedTrain(**vars(imported), tunnels=_tunnel_coefficients(train, source.name, r2 or 0.0))


@dataclass(frozen=True)
class _Numbers:
    """Numbers of a file in our units."""

    source: str

    def of(self, quantity: Quantity | None, key: str, units: dict[str, float]) -> float | None:
        """Convert an optional number."""
        return None if quantity is None else self.some(quantity, key, units)

    def some(self, quantity: Quantity, key: str, units: dict[str, float]) -> float:
        """Convert a number."""
        return quantity.value * factor_of(quantity.unit, units, f"{self.source}: {key}.unit")


def _length(train: Train, number: _Numbers, notes: Notes) -> dict[str, Any]:
    length = number.of(train.length, "length", M_UNITS)
    coaches = train.coaches.value if train.coaches else None
    if length is None:
        notes.add_unused("num coaches, as it gives no length." if coaches is not None else "")
        return {}
    cars = {} if coaches is None or coaches != int(coaches) else {"car_count": int(coaches)}
    return {"length_m": length, **cars}


def _braking(train: Train, number: _Numbers) -> dict[str, Any]:
    power = number.some(train.braking_power, "max reg braking power", KW_UNITS)
    effort = number.some(train.braking_force, "max reg braking force", KN_UNITS)
    return _without_none(
        # no power is no brake, which our keys say by its effort
        max_effort_kn=effort if power else 0.0,
        max_power_kw=power or None,
        friction_effort_kn=number.of(train.pneumatic_force, "max pn braking force", KN_UNITS) or None,
        max_deceleration_ms2=number.of(train.deceleration, "max deceleration", MS2_UNITS),
    )


def _drive(train: Train, number: _Numbers, notes: Notes) -> dict[str, Any]:
    drive: dict[str, Any] = {"model": "constant_efficiency"}
    for name, quantity, key in (
        ("traction_efficiency", train.traction_efficiency, "efficiency traction"),
        ("braking_efficiency", train.braking_efficiency, "efficiency reg brake"),
    ):
        share = number.of(quantity, key, SHARE_UNITS)
        if share is None:
            notes.add("assumption", f"{key} is missing: a drive without losses.")
        drive[name] = 1.0 if share is None else share
    notes.add("assumption", "all that braking generates goes back: recuperation_factor = 1.")
    return {**drive, "recuperation_factor": 1.0}


def _tunnel_coefficients(train: Train, source: str, open_n_per_kmh2: float) -> TunnelCoefficients | None:
    given = train.tunnel_resistance
    if given is None:
        return None
    where = f"{source}: tunnel resistance"
    area = column_factor(given.units, "cross section", AREA_UNITS, where)
    added = column_factor(given.units, "coefficient", N_PER_KMH2_UNITS, where)
    rows = sorted((area * row[0], added * row[1]) for row in given.values)
    areas, coefficients = zip(*rows, strict=True)
    if len(set(areas)) < len(areas):
        raise ScenarioError(f"{where}.values has a cross section twice.")
    return TunnelCoefficients(areas, coefficients, open_n_per_kmh2)


def _without_none(**entries: Any) -> dict[str, Any]:
    return {key: value for key, value in entries.items() if value is not None}
