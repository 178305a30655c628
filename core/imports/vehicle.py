"""A vehicle from another program's file, and questions about numbers that no train has."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from railjoule.core.imports.findings import Finding, Imported, Notes, OtherUnit
from railjoule.core.scenario import Vehicle
from railjoule.core.scenario._sentences import validated
from railjoule.core.scenario.drive import ConstantEfficiency
from railjoule.core.units import KG_PER_T, N_PER_KN, STANDARD_GRAVITY_MS2


@dataclass(frozen=True)
class ImportedVehicle(Imported):
    """A vehicle from a file."""

    vehicle: Vehicle


class _VehicleTable(BaseModel):
    vehicle: Vehicle


def checked_vehicle(table: Mapping[str, Any], source: str) -> Vehicle:
    """Validate a scenario's table `vehicle`; ScenarioError, beginning with `source`, if it is none."""
    return validated(_VehicleTable, {"vehicle": table}, source).vehicle


def imported_vehicle(table: dict[str, Any], notes: Notes) -> ImportedVehicle:
    """Make the result of a reader from the table `vehicle` that it filled, with questions about its numbers.

    Entries that are None are left out; a table without a drive gets one without losses.

    Raises
    ------
    ScenarioError
        If there can be no such vehicle.
    """
    if "drive" not in table:
        table["drive"] = {"model": "constant_efficiency", "traction_efficiency": 1.0}
        notes.add("assumption", "no losses are given: a drive without losses.")
    table = short_numbers(table)
    vehicle = checked_vehicle(table, notes.source)
    findings = (*notes.findings, *questions(vehicle, notes.source))
    return ImportedVehicle(notes.source, {"vehicle": table}, vehicle, findings=findings, unused=tuple(notes.unused))


@dataclass(frozen=True)
class _Doubt:
    """A number to look at, and a measure of it that depends little on the train, with its range.

    The ranges contain all trains from a tram to a heavy freight train with a margin; a wrong unit leaves them.
    """

    name: str
    value: float
    unit: str
    measure: float
    least: float
    most: float
    factors: tuple[float, ...] = (1000.0, 1e-3)

    @property
    def is_usual(self) -> bool:
        """Whether the measure lies in its range."""
        return self.least <= self.measure <= self.most

    def question(self, source: str, mass_t: float) -> Finding:
        """Make a question about it, with the number in the unit that was likely meant."""
        likely = [factor for factor in self.factors if self.least <= factor * self.measure <= self.most]
        given, *meant = (f"{factor * self.value:.6g} {self.unit}".rstrip() for factor in (1.0, *likely[:1]))
        other = OtherUnit(self.name, likely[0], given, meant[0]) if likely else None
        words = f"was {meant[0]} meant?" if likely else "is this right?"
        train = "" if self.name == "tare_kg" else f" for a train of {mass_t:g} t"
        return Finding("question", f"{source}: vehicle.{self.name} = {given}{train}: {words}", other_unit=other)


def questions(vehicle: Vehicle, source: str) -> list[Finding]:
    """Ask about numbers of a vehicle of a file that suggest another unit."""
    mass_t, speed = vehicle.total_mass_kg / KG_PER_T, vehicle.traction.max_speed_kmh
    tare = _Doubt("tare_kg", vehicle.tare_kg, "kg", vehicle.tare_kg, 3e3, 2e7)
    doubts = [tare, _Doubt("traction.max_speed_kmh", speed, "km/h", speed, 25.0, 600.0, (3.6,))]
    if tare.is_usual:  # else all that is measured by the mass would look wrong
        doubts += _doubts_by_mass(vehicle, mass_t)
    return [doubt.question(source, mass_t) for doubt in doubts if not doubt.is_usual]


def short_numbers(value: Any) -> Any:
    """Round the numbers of a table to ten digits, as products of units have tails, and leave out None."""
    if isinstance(value, dict):
        return {key: short_numbers(entry) for key, entry in value.items() if entry is not None}
    if isinstance(value, list):
        return [short_numbers(entry) for entry in value]
    return float(f"{value:.10g}") if isinstance(value, float) else value


def _doubts_by_mass(vehicle: Vehicle, mass_t: float) -> Iterator[_Doubt]:
    for name, limits, least in (("traction", vehicle.traction, 0.03), ("braking", vehicle.braking, 0.01)):
        # kilonewtons over tonnes are m/s2, kilowatts over tonnes W/kg
        for key, unit, low, high in (("max_effort_kn", "kN", least, 5.0), ("max_power_kw", "kW", 0.3, 100.0)):
            if amount := getattr(limits, key):
                yield _Doubt(f"{name}.{key}", amount, unit, amount / mass_t, low, high)
        if limits.curve:
            greatest = max(effort for _, effort in limits.curve)
            yield _Doubt(f"{name}.curve, greatest effort", greatest, "kN", greatest / mass_t, least, 5.0, ())
    weight_kn = vehicle.total_mass_kg * STANDARD_GRAVITY_MS2 / N_PER_KN
    terms, speed = vehicle.resistance, vehicle.traction.max_speed_kmh
    standing = terms.absolute[0] + weight_kn * vehicle.specific_resistance.constant_n_per_kn
    yield _Doubt("resistance.constant_n", standing, "N", standing / weight_kn, 0.2, 20.0)
    # from nothing on, as neither of the other terms must be there
    for key, unit, power in (("linear_n_per_kmh", "N/(km/h)", 1), ("quadratic_n_per_kmh2", "N/(km/h)2", 2)):
        amount = getattr(terms, key)
        yield _Doubt(f"resistance.{key}", amount, unit, amount * speed**power / weight_kn, 0.0, 60.0)
    if (factor := vehicle.rotating_mass_factor) is not None:
        yield _Doubt("rotating_mass_factor", factor, "", factor, 0.0, 0.6, (0.01,))
    elif vehicle.inertial_mass_kg is not None:
        share = vehicle.inertial_mass_kg / vehicle.tare_kg - 1
        yield _Doubt("inertial_mass_kg", vehicle.inertial_mass_kg, "kg", share, 0.0, 0.6, ())
    drive = vehicle.drive
    for name in ("traction_efficiency", "braking_efficiency") if isinstance(drive, ConstantEfficiency) else ():
        if (share := getattr(drive, name)) is not None:
            yield _Doubt(f"drive.{name}", share, "", share, 0.3, 1.0, (100.0,))
