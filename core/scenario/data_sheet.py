"""A vehicle from the few values of a data sheet; the others follow from formulas for its kind, marked as assumed.

Sources of the running resistance, V in km/h, G the weight in kN, M the mass in t, m the load of an axle in t:

- Sauthoff (Deutsche Bahn, passenger trains; the form of TTOBench's utils/rolling_resistance.py, with n cars):
  (1.9 + 0.0025 V) G + 4.8 (n + 2.7) 0.0145 (V + 15)^2, in N. TTOBench's own files hold the second derivative as its
  quadratic coefficient, twice the value.
- SNCF (TGV; coefficients as in Rochard, Schmid, Proc. IMechE F 214, 2000): lambda M sqrt(10 / m) + 0.01 M V +
  (k1 S + k2 p L) V^2, in daN, with lambda 0.9, k1 0.0009, k2 0.00002, perimeter p 10 m, front area S and length L.
- Strahl (Deutsche Bahn, freight trains of mixed wagons): (2.0 + (0.007 + 0.05) (V / 10)^2) G, in N.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, Self

from pydantic import Field, model_validator

from railjoule.core.scenario._base import Count, Name, Number, Part, require_effect
from railjoule.core.scenario._sentences import validated
from railjoule.core.scenario.vehicle import Vehicle
from railjoule.core.units import N_PER_KN, STANDARD_GRAVITY_MS2

TrainKind = Literal["multiple_unit", "light_rail", "high_speed", "freight"]
KG_PER_T, N_PER_DAN = 1000.0, 10.0
CAR_LENGTH_M = 25.0
FRONT_AREA_M2 = 10.0


@dataclass(frozen=True)
class KindDefaults:
    """Typical values of a kind of train, each with its source."""

    rotating_mass_factor: tuple[float, str]
    service_deceleration_ms2: tuple[float, str]
    resistance: Callable[["DataSheet"], tuple[dict[str, float], str]]


class DataSheet(Part):
    """The values of a train's data sheet. Those that are left empty are assumed."""

    name: Name = Field("Train from a data sheet", max_length=200, description="Name of the vehicle.")
    kind: TrainKind | None = Field(
        None, description="Kind of train, which selects the formulas: multiple unit, light rail, high speed or freight."
    )
    mass_t: Number = Field(gt=0, le=10_000, description="Mass: empty, or of the train as it runs [t].")
    power_kw: Number = Field(gt=0, le=1e5, description="Largest power [kW].")
    max_effort_kn: Number | None = Field(None, gt=0, le=1e4, description="Largest tractive effort [kN].")
    max_acceleration_ms2: Number | None = Field(None, gt=0, le=20, description="Largest acceleration [m/s2].")
    max_speed_kmh: Number = Field(gt=0, le=600, description="Largest speed [km/h].")
    length_m: Number = Field(gt=0, le=5000, description="Length of the train [m].")
    cars: Count | None = Field(None, ge=1, le=200, description="Number of cars.")
    axles: Count | None = Field(None, ge=2, le=1000, description="Number of axles.")
    driven_axles: Count | None = Field(None, ge=1, le=1000, description="Number of driven axles.")
    capacity_passengers: Number | None = Field(None, ge=0, le=1e5, description="Seats and standing places.")
    rotating_mass_factor: Number | None = Field(None, ge=0, le=5, description="Inertia of the rotating parts.")
    service_deceleration_ms2: Number | None = Field(None, gt=0, le=20, description="Service braking [m/s2].")
    electric_brake_kn: Number | None = Field(None, gt=0, le=1e4, description="Largest electric braking effort [kN].")
    regenerative: bool | None = Field(None, strict=True, description="Whether braking returns energy to the supply.")
    efficiency: Number | None = Field(None, gt=0, le=1, description="Efficiency from the supply to the wheel.")
    auxiliary_power_kw: Number | None = Field(None, ge=0, le=1e4, description="Power of light, heating and so on [kW].")
    front_area_m2: Number | None = Field(None, gt=0, le=30, description="Cross-section of the front [m2].")
    line_voltage_v: Number | None = Field(None, gt=0, le=100_000, description="Nominal voltage of the supply [V].")

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        if self.max_effort_kn is None and self.max_acceleration_ms2 is None:
            raise ValueError("needs max_effort_kn or max_acceleration_ms2")
        if self.driven_axles is not None and self.axles is None:
            raise ValueError("driven_axles needs axles, of which they are a share")
        if self.driven_axles is not None and self.axles is not None and self.driven_axles > self.axles:
            raise ValueError(f"driven_axles = {self.driven_axles} must be at most axles = {self.axles}")
        if self.kind != "high_speed":
            require_effect(self, ("front_area_m2",), "without kind = 'high_speed', whose formula contains it")
        if self.regenerative is False:
            require_effect(self, ("electric_brake_kn",), "with regenerative = false: only what it returns counts")
        return self

    @property
    def weight_kn(self) -> float:
        """Weight [kN]."""
        return self.mass_t * STANDARD_GRAVITY_MS2

    @property
    def car_number(self) -> int:
        """Number of cars, given or by the length."""
        return self.cars or math.ceil(self.length_m / CAR_LENGTH_M)

    def to_vehicle(self) -> Vehicle:
        """Return the vehicle, with its assumed values in `assumed`."""
        return validated(Vehicle, self.to_document(), "data sheet")

    def to_document(self) -> dict[str, Any]:
        """Return the table `vehicle` of a scenario file."""
        return _Builder(self).document()


class _Builder:
    """Fills the table of a vehicle with given and assumed values."""

    def __init__(self, sheet: DataSheet) -> None:
        self.sheet, self.table = sheet, dict[str, Any]()
        self.assumed: list[dict[str, Any]] = []

    def put(self, key: str, given: float | None, value: float, basis: str) -> float:
        """Set a number to the sheet's, or to an assumed value with its basis; return it."""
        *tables, name = key.removeprefix("vehicle.").split(".")
        table = self.table
        for one in tables:
            table = table.setdefault(one, {})
        table[name] = number = float(f"{value:.6g}") if given is None else given
        if given is None:
            self.assumed.append({"key": key, "value": number, "basis": basis})
        return number

    def document(self) -> dict[str, Any]:
        """Return the table `vehicle`."""
        sheet, kind = self.sheet, KINDS[self.sheet.kind or "multiple_unit"]
        given = {
            "name": sheet.name,
            "tare_kg": sheet.mass_t * KG_PER_T,
            "length_m": sheet.length_m,
            "line_voltage_v": sheet.line_voltage_v,
            "traction": {"max_speed_kmh": sheet.max_speed_kmh},
            "drive": {"model": "constant_efficiency"},
        }
        self.table = {key: value for key, value in given.items() if value is not None}
        factor = self.put("vehicle.rotating_mass_factor", sheet.rotating_mass_factor, *kind.rotating_mass_factor)
        self._passengers()
        standing_n = self._resistance(kind)
        inertia_t = (1 + factor) * sheet.mass_t
        self._traction(inertia_t, standing_n)
        self._braking(kind, inertia_t)
        self._drive()
        return {**self.table, "assumed": self.assumed}

    def _passengers(self) -> None:
        capacity = self.sheet.capacity_passengers
        if capacity:
            self.table["capacity_passengers"] = capacity
            self.put("vehicle.passenger_mass_kg", None, 75.0, "75 kg a passenger, as in the shipped vehicles")

    def _resistance(self, kind: KindDefaults) -> float:
        """Set the running resistance; return that at a stand [N]."""
        terms, basis = kind.resistance(self.sheet)
        if self.sheet.kind is None:
            basis += "; no kind is given: that of a multiple unit"
        for name, value in terms.items():
            self.put(f"vehicle.resistance.{name}", None, value, basis)
        curve = "700 / R, traction rules of Ukraine"
        self.put("vehicle.resistance.curve_constant_m_n_per_kn", None, 700.0, curve)
        return terms["constant_n_per_kn"] * self.sheet.weight_kn + terms.get("constant_n", 0.0)

    def _traction(self, inertia_t: float, standing_n: float) -> None:
        sheet, acceleration = self.sheet, self.sheet.max_acceleration_ms2
        basis = "the sheet's power, taken as that at the wheel"
        self.put("vehicle.traction.max_power_kw", None, sheet.power_kw, basis)
        by_acceleration = inertia_t * (acceleration or 0.0) + standing_n / N_PER_KN
        basis = f"{acceleration or 0.0:g} m/s2 of {inertia_t:.5g} t with rotating masses, and the resistance at a stand"
        self.put("vehicle.traction.max_effort_kn", sheet.max_effort_kn, by_acceleration, basis)
        if acceleration is not None:
            self.table["traction"]["max_acceleration_ms2"] = acceleration
        if sheet.axles is not None and sheet.driven_axles is not None:
            share, basis = sheet.driven_axles / sheet.axles, "driven axles over axles, all equally loaded"
            self.put("vehicle.adhesion.driven_mass_share", None, share, basis)

    def _braking(self, kind: KindDefaults, inertia_t: float) -> None:
        sheet, traction = self.sheet, self.table["traction"]
        rate = self.put(
            "vehicle.braking.max_deceleration_ms2", sheet.service_deceleration_ms2, *kind.service_deceleration_ms2
        )
        if sheet.regenerative is False:
            self.table["braking"]["max_effort_kn"] = 0.0
        else:
            basis = "electric brake as strong as traction"
            self.put("vehicle.braking.max_effort_kn", sheet.electric_brake_kn, traction["max_effort_kn"], basis)
            self.put("vehicle.braking.max_power_kw", None, traction["max_power_kw"], basis)
        basis = f"friction brakes for {rate:g} m/s2 without the electric brake"
        self.put("vehicle.braking.friction_effort_kn", None, inertia_t * rate, basis)

    def _drive(self) -> None:
        sheet = self.sheet
        efficiency = "0.85 from the supply to the wheel, as of the metro of Liashenko, Yatsko 2025, (6)"
        self.put("drive.traction_efficiency", sheet.efficiency, 0.85, efficiency)
        given = None if sheet.regenerative is None else float(sheet.regenerative)
        self.put("drive.recuperation_factor", given, 1.0, "all braking energy returns to the supply")
        cars = 1 if sheet.kind == "freight" else sheet.car_number
        basis = f"20 kW for each of {cars} air-conditioned cars or a locomotive"
        self.put("vehicle.auxiliary_power_kw", sheet.auxiliary_power_kw, 20.0 * cars, basis)


def _sauthoff(sheet: DataSheet) -> tuple[dict[str, float], str]:
    air = 4.8 * (sheet.car_number + 2.7) * 0.0145
    terms = {"constant_n_per_kn": 1.9, "linear_n_per_kn_per_kmh": 0.0025}
    # of a head wind of 15 km/h, as the formula has it
    terms |= {"constant_n": air * 15.0**2, "linear_n_per_kmh": 2 * 15.0 * air, "quadratic_n_per_kmh2": air}
    cars = f"{sheet.car_number} cars" if sheet.cars else f"{sheet.car_number} cars of at most {CAR_LENGTH_M:g} m"
    return terms, f"Sauthoff for {cars}: (1.9 + 0.0025 V) N/kN + 0.0696 (n + 2.7) (V + 15)^2 N"


def _sncf(sheet: DataSheet) -> tuple[dict[str, float], str]:
    axles, area = sheet.axles or 4 * sheet.car_number, sheet.front_area_m2 or FRONT_AREA_M2
    per_kn = N_PER_DAN / STANDARD_GRAVITY_MS2
    terms = {
        "constant_n_per_kn": 0.9 * math.sqrt(10.0 / (sheet.mass_t / axles)) * per_kn,
        "linear_n_per_kn_per_kmh": 0.01 * per_kn,
        "quadratic_n_per_kmh2": N_PER_DAN * (9e-4 * area + 20e-6 * 10.0 * sheet.length_m),
    }
    return terms, (
        f"SNCF for TGV, {axles} axles, front {area:g} m2: 0.9 M sqrt(10/m) + 0.01 M V + (0.0009 S + 0.00002 p L) V^2"
        " daN, p = 10 m"
    )


def _strahl(_: DataSheet) -> tuple[dict[str, float], str]:
    terms = {"constant_n_per_kn": 2.0, "quadratic_n_per_kn_per_kmh2": (0.007 + 0.05) / 100}
    return terms, "Strahl for mixed freight trains: 2.0 + (0.007 + 0.05) (V / 10)^2 N/kN"


OSRD = "OSRD's example"
KINDS: Mapping[TrainKind, KindDefaults] = {
    "multiple_unit": KindDefaults(
        (0.10, "TTOBench, Stadler FLIRT"), (0.5, f"{OSRD} of a regional multiple unit"), _sauthoff
    ),
    "light_rail": KindDefaults((0.04, f"{OSRD} of a tram-train"), (0.7, f"{OSRD} of a tram-train"), _sauthoff),
    "high_speed": KindDefaults((0.04, f"{OSRD} of a high-speed train"), (0.5, f"{OSRD} of a high-speed train"), _sncf),
    "freight": KindDefaults((0.048, f"{OSRD} of a freight train"), (0.3, f"{OSRD} of a freight train"), _strahl),
}
"""Typical values of each kind: shares of the mass and decelerations of its rolling stock, tests/data/rolling_stocks."""
