"""A vehicle from another program's file, and questions about numbers that no train has."""

from dataclasses import dataclass
from typing import Any

from railjoule.core.imports.findings import Finding, Imported, OtherUnit
from railjoule.core.scenario import Vehicle
from railjoule.core.scenario.drive import ConstantEfficiency
from railjoule.core.units import N_PER_KN, STANDARD_GRAVITY_MS2

KG_PER_T = 1000.0


@dataclass(frozen=True)
class ImportedVehicle(Imported):
    """A vehicle from a file.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    """

    vehicle: Vehicle


@dataclass(frozen=True)
class _Doubt:
    """A number to look at: what it is, and over which range of a quantity that hardly depends on the train it may be.

    The ranges hold all trains from a tram to a heavy freight train with room to spare; a wrong unit leaves them.
    """

    name: str
    value: float
    unit: str
    measure: float
    least: float
    most: float
    factors: tuple[float, ...] = (1000.0, 1e-3)

    @property
    def holds(self) -> bool:
        """Whether there are such trains."""
        return self.least <= self.measure <= self.most

    def question(self, mass_t: float) -> str:
        """Return the question about it, with the number in the unit that was likely meant."""
        meant = self.other_unit
        told = f"was {meant.meant} meant?" if meant else "is this right?"
        train = "" if self.name == "tare_kg" else f" for a train of {mass_t:g} t"
        return f"{self.name} = {self._words(1.0)}{train}: {told}"

    @property
    def other_unit(self) -> OtherUnit | None:
        """The unit in which it would be a number that trains have."""
        likely = [factor for factor in self.factors if self.least <= factor * self.measure <= self.most]
        return OtherUnit(self.name, likely[0], self._words(1.0), self._words(likely[0])) if likely else None

    def _words(self, factor: float) -> str:
        return f"{factor * self.value:.6g} {self.unit}".rstrip()


def questions(vehicle: Vehicle, source: str) -> list[Finding]:
    """Return questions about numbers of a vehicle that look as if another unit was meant.

    Parameters
    ----------
    vehicle : Vehicle
        The vehicle.
    source : str
        The file.
    """
    doubts = [doubt for doubt in _mass_and_speed(vehicle) if not doubt.holds]
    if not any(doubt.name == "tare_kg" for doubt in doubts):  # else all that is measured by the mass would look wrong
        doubts += [one for one in (*_efforts(vehicle), *_resistances(vehicle), *_shares(vehicle)) if not one.holds]
    mass_t = vehicle.total_mass_kg / KG_PER_T
    return [
        Finding("question", f"{source}: vehicle.{doubt.question(mass_t)}", other_unit=doubt.other_unit)
        for doubt in doubts
    ]


def short_numbers(value: Any) -> Any:
    """Return a table with numbers of ten digits at most: products of units have tails."""
    if isinstance(value, dict):
        return {key: short_numbers(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [short_numbers(entry) for entry in value]
    return float(f"{value:.10g}") if isinstance(value, float) else value


def _mass_and_speed(vehicle: Vehicle) -> list[_Doubt]:
    speed = vehicle.traction.max_speed_kmh
    return [
        _Doubt("tare_kg", vehicle.tare_kg, "kg", vehicle.tare_kg, 3e3, 2e7),
        _Doubt("traction.max_speed_kmh", speed, "km/h", speed, 25.0, 600.0, (3.6,)),
    ]


def _efforts(vehicle: Vehicle) -> list[_Doubt]:
    mass_t = vehicle.total_mass_kg / KG_PER_T
    doubts = []
    for name, limits, least in (("traction", vehicle.traction, 0.03), ("braking", vehicle.braking, 0.01)):
        effort, power = limits.max_effort_kn, limits.max_power_kw
        # kilonewtons over tonnes are m/s2, kilowatts over tonnes W/kg
        if effort:
            doubts.append(_Doubt(f"{name}.max_effort_kn", effort, "kN", effort / mass_t, least, 5.0))
        if power:
            doubts.append(_Doubt(f"{name}.max_power_kw", power, "kW", power / mass_t, 0.3, 100.0))
    return doubts


def _resistances(vehicle: Vehicle) -> list[_Doubt]:
    weight_kn = vehicle.total_mass_kg * STANDARD_GRAVITY_MS2 / N_PER_KN
    terms, speed = vehicle.resistance, vehicle.traction.max_speed_kmh
    standing = terms.constant_n + weight_kn * vehicle.specific_resistance.constant_n_per_kn
    linear = terms.linear_n_per_kmh
    quadratic = terms.quadratic_n_per_kmh2
    return [
        _Doubt("resistance.constant_n", standing, "N", standing / weight_kn, 0.2, 20.0),
        *(
            # from nothing on, as neither term must be there
            _Doubt(f"resistance.{name}", value, unit, value * speed**power / weight_kn, 0.0, 60.0)
            for name, value, unit, power in (
                ("linear_n_per_kmh", linear, "N/(km/h)", 1),
                ("quadratic_n_per_kmh2", quadratic, "N/(km/h)2", 2),
            )
        ),
    ]


def _shares(vehicle: Vehicle) -> list[_Doubt]:
    doubts = []
    if vehicle.rotating_mass_factor is not None:
        factor = vehicle.rotating_mass_factor
        doubts.append(_Doubt("rotating_mass_factor", factor, "", factor, 0.0, 0.6, (0.01,)))
    if isinstance(vehicle.drive, ConstantEfficiency):
        for name in ("traction_efficiency", "braking_efficiency"):
            share = getattr(vehicle.drive, name)
            if share is not None:
                doubts.append(_Doubt(f"drive.{name}", share, "", share, 0.3, 1.0, (100.0,)))
    return doubts
