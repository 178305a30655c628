"""Trains of TTOBench."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Finding, Notes
from railjoule.core.imports.foreign import checked, unknown_keys
from railjoule.core.imports.parts import checked_vehicle
from railjoule.core.imports.source_file import SourceFile, json_of
from railjoule.core.imports.ttobench.format import (
    AREA_UNITS,
    KG_UNITS,
    KMH_UNITS,
    KN_UNITS,
    KW_UNITS,
    M_UNITS,
    MS2_UNITS,
    N_PER_KMH2_UNITS,
    N_PER_KMH_UNITS,
    SHARE_UNITS,
    Quantity,
    Train,
    column_factor,
    factor_of,
    version_findings,
)
from railjoule.core.imports.vehicle import ImportedVehicle, questions, short_numbers
from railjoule.core.units import N_PER_KN


@dataclass(frozen=True)
class TunnelCoefficients:
    """What tunnels add to a train's quadratic term of resistance.

    Parameters
    ----------
    area_m2 : tuple of float
        Cross sections, rising [m2].
    added_n_per_kmh2 : tuple of float
        What each adds [N/(km/h)2].
    open_n_per_kmh2 : float
        The term in the open [N/(km/h)2].
    """

    area_m2: tuple[float, ...]
    added_n_per_kmh2: tuple[float, ...]
    open_n_per_kmh2: float

    def factor_in(self, area_m2: float) -> float | None:
        """Return the factor on the quadratic term; between two known cross sections linear, outside them None."""
        if not self.area_m2[0] <= area_m2 <= self.area_m2[-1] or self.open_n_per_kmh2 <= 0:
            return None
        for (area, added), (next_area, next_added) in pairwise(
            zip((*self.area_m2, math.inf), (*self.added_n_per_kmh2, 0.0), strict=True)
        ):
            if area <= area_m2 < next_area:
                share = (area_m2 - area) / (next_area - area)
                return 1 + (added + share * (next_added - added)) / self.open_n_per_kmh2
        return None


@dataclass(frozen=True)
class ImportedTrain(ImportedVehicle):
    """A train, and what tunnels do to it."""

    tunnels: TunnelCoefficients | None = None


def read_train(source: SourceFile) -> ImportedTrain:
    """Return the vehicle of a train's file.

    Raises
    ------
    ScenarioError
        If anything is wrong with the file.
    """
    train = checked(Train, json_of(source), source.name)
    notes = Notes(version_findings(train.metadata, source.name), unknown_keys(train, source.name))
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
    table = short_numbers(table)
    vehicle = checked_vehicle(table, source.name)
    notes.findings += questions(vehicle, source.name)
    return ImportedTrain(
        source.name,
        {"vehicle": table},
        vehicle,
        _tunnel_coefficients(train, source.name, r2 or 0.0),
        findings=tuple(notes.findings),
        unused=tuple(notes.unused),
    )


@dataclass(frozen=True)
class _Numbers:
    """Numbers of a file in our units."""

    source: str

    def of(self, quantity: Quantity | None, key: str, units: dict[str, float]) -> float | None:
        """Return a number that need not be there."""
        return None if quantity is None else self.some(quantity, key, units)

    def some(self, quantity: Quantity, key: str, units: dict[str, float]) -> float:
        """Return a number that is there."""
        return quantity.value * factor_of(quantity.unit, units, f"{self.source}: {key}.unit")


def _length(train: Train, number: _Numbers, notes: Notes) -> dict[str, Any]:
    length = number.of(train.length, "length", M_UNITS)
    coaches = train.coaches.value if train.coaches else None
    if length is None:
        if coaches is not None:
            notes.unused.append(f"{number.source}: num coaches, as it gives no length.")
        return {}
    if coaches is not None and coaches == int(coaches):
        return {"length_m": length, "car_count": int(coaches)}
    return {"length_m": length}


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
    traction = number.of(train.traction_efficiency, "efficiency traction", SHARE_UNITS)
    braking = number.of(train.braking_efficiency, "efficiency reg brake", SHARE_UNITS)
    for share, key in ((traction, "efficiency traction"), (braking, "efficiency reg brake")):
        if share is None:
            notes.findings.append(Finding("assumption", f"{number.source}: {key} is missing: a drive without losses."))
    notes.findings.append(
        Finding("assumption", f"{number.source}: all that braking generates goes back: recuperation_factor = 1.")
    )
    return {
        "model": "constant_efficiency",
        "traction_efficiency": 1.0 if traction is None else traction,
        "braking_efficiency": 1.0 if braking is None else braking,
        "recuperation_factor": 1.0,
    }


def _tunnel_coefficients(train: Train, source: str, open_n_per_kmh2: float) -> TunnelCoefficients | None:
    given = train.tunnel_resistance
    if given is None:
        return None
    where = f"{source}: tunnel resistance"
    area = column_factor(given.units, "cross section", AREA_UNITS, where)
    added = column_factor(given.units, "coefficient", N_PER_KMH2_UNITS, where)
    rows = sorted((area * row[0], added * row[1]) for row in given.values)
    areas, coefficients = zip(*rows, strict=True)
    if any(later <= earlier for earlier, later in pairwise(areas)):
        raise ScenarioError(f"{where}.values has a cross section twice.")
    return TunnelCoefficients(areas, coefficients, open_n_per_kmh2)


def _without_none(**entries: Any) -> dict[str, Any]:
    return {key: value for key, value in entries.items() if value is not None}
