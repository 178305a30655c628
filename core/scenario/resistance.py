"""Running resistance as files give it: terms of the weight and absolute ones, Davis coefficients in any unit, formulas.

All of them add up. The sums are in N per kN of weight, in N, and in km/h: `Resistance.specific` and `absolute`.

References: W. J. Davis, General Electric Review 29, 1926, in the form of Hay, Railroad Engineering, 1982; AREA, Manual
for Railway Engineering, chapter 16, 1970 (the modified Davis formula); Sauthoff 1932, in newtons as the open solver
ms-eetc has it.
"""

from typing import Literal, NamedTuple, Self

from pydantic import Field, model_validator

from railjoule.core.scenario._base import Count, Number, Part
from railjoule.core.units import N_PER_KN, STANDARD_GRAVITY_MS2

LBF_N = 0.45359237 * 9.80665
"""A pound-force [N]."""
KMH_PER_MPH = 1.609344
FOOT_M = 0.3048
N_PER_KN_IN_LB_PER_TON = N_PER_KN / 2000
"""A pound of force on a short ton, of 2000 lb, is a 2000th of the weight [N/kN]."""
FORCES_N = {"N": 1.0, "daN": 10.0, "kN": N_PER_KN, "kgf": 9.80665, "lbf": LBF_N}
"""Units of absolute Davis coefficients [N]."""
PER_WEIGHT = {
    "N/kN": 1.0,
    "kgf/t": 1.0,
    "lb/ton": N_PER_KN_IN_LB_PER_TON,
    "N/t": 1.0 / STANDARD_GRAVITY_MS2,
    "daN/t": 10.0 / STANDARD_GRAVITY_MS2,
}
"""Units of those over the weight or the mass of the train [N/kN]; a kilogram-force on a tonne is a thousandth."""
SPEEDS_KMH = {"km/h": 1.0, "m/s": 3.6, "mph": KMH_PER_MPH}
Terms = tuple[float, float, float]
"""Terms constant, linear and quadratic in the speed in km/h."""


class SpecificResistance(Part):
    """Running resistance over weight, speed in km/h."""

    # Bounds of numbers in this file stop slips of units - tonnes for kilograms, metres for millimetres - and not
    # unusual trains: each is above what the heaviest and fastest trains have.
    constant_n_per_kn: Number = Field(0.0, ge=0, le=100, description="Specific, constant [N per kN of weight].")
    linear_n_per_kn_per_kmh: Number = Field(0.0, ge=0, le=10, description="Specific, linear in speed.")
    quadratic_n_per_kn_per_kmh2: Number = Field(0.0, ge=0, le=1, description="Specific, quadratic in speed.")


class CarKind(SpecificResistance):
    """Cars of a train that run alike, as its motor cars do; what they have beside what all cars have."""

    cars: Count = Field(ge=1, le=200, description="How many of the vehicle's equally heavy cars are of this kind.")


class LoadResistance(Part):
    """Specific terms of the weight of the load, where they are not those of the train; an empty one is the train's."""

    constant_n_per_kn: Number | None = Field(None, ge=0, le=100, description="Of the load's weight, constant [N/kN].")
    linear_n_per_kn_per_kmh: Number | None = Field(None, ge=0, le=10, description="Of the load's weight, linear.")
    quadratic_n_per_kn_per_kmh2: Number | None = Field(None, ge=0, le=1, description="Of the load's weight, quadratic.")


class Davis(Part):
    """Davis coefficients a + b v + c v^2 in the units of a data sheet."""

    a: Number = Field(0.0, ge=0, le=1e6, description="Constant coefficient, in `unit`.")
    b: Number = Field(0.0, ge=0, le=1e5, description="Coefficient of the speed, in `unit` and `speed_unit`.")
    c: Number = Field(0.0, ge=0, le=1e4, description="Coefficient of the square of the speed, as b.")
    unit: Literal["N", "daN", "kN", "kgf", "lbf", "N/kN", "N/t", "daN/t", "kgf/t", "lb/ton"] = Field(
        "N", description="Unit of the resistance; lb/ton counts short tons of 2000 lb."
    )
    speed_unit: Literal["km/h", "m/s", "mph"] = Field("km/h", description="Unit of the speed.")

    @property
    def terms(self) -> Terms:
        """The coefficients in N or N/kN, speed in km/h."""
        force, kmh = {**FORCES_N, **PER_WEIGHT}[self.unit], SPEEDS_KMH[self.speed_unit]
        return force * self.a, force * self.b / kmh, force * self.c / kmh**2


class _Formula(NamedTuple):
    """A published formula; the resistance of its air is `air` times the cars, or times their area [m2].

    Parameters
    ----------
    specific : Terms
        Over the weight [N/kN].
    per_axle_n : float
        Of each axle [N].
    air_n_per_kmh2 : float
        Of the air [N/(km/h)2].
    takes_area : bool
        Whether the air counts per square metre of `frontal_area_m2`.
    further_cars : float
        Cars that the end of the train counts for.
    wind_kmh : float
        Speed of the air against the train that the formula includes [km/h].
    """

    specific: Terms
    per_axle_n: float = 0.0
    air_n_per_kmh2: float = 0.0
    takes_area: bool = False
    further_cars: float = 0.0
    wind_kmh: float = 0.0


def _american(constant: float, per_axle: float, linear: float, air: float, takes_area: bool = False) -> _Formula:
    """Return a formula in lb/ton with the axle load in tons, mph and square feet.

    Its terms b/w and k V^2 / (w n) count for each axle and for each car, whatever their weight.
    """
    lb_per_ton = N_PER_KN_IN_LB_PER_TON
    specific = constant * lb_per_ton, linear * lb_per_ton / KMH_PER_MPH, 0.0
    by_air = air * LBF_N / KMH_PER_MPH**2 / (FOOT_M**2 if takes_area else 1.0)
    return _Formula(specific, per_axle * LBF_N, by_air, takes_area)


FORMULAS = {
    "davis-1926-locomotive": _american(1.3, 29.0, 0.03, 0.0024, True),
    "davis-1926-passenger": _american(1.3, 29.0, 0.03, 0.00034, True),
    "davis-1926-freight": _american(1.3, 29.0, 0.045, 0.0005, True),
    "area-1970-conventional": _american(0.6, 20.0, 0.01, 0.07),
    "area-1970-containers": _american(0.6, 20.0, 0.01, 0.0935),
    "area-1970-trailers": _american(0.6, 20.0, 0.01, 0.16),
    "sauthoff-1932": _Formula((1.9, 0.0025, 0.0), 0.0, 0.048 * 1.45, False, 2.7, 15.0),
}
"""Formulas of running resistance by name; the first word of each names its source above."""


class ResistanceFormula(Part):
    """A published formula of running resistance with its inputs; the weight is that of the train with its load."""

    name: (
        Literal[
            "davis-1926-locomotive",
            "davis-1926-passenger",
            "davis-1926-freight",
            "area-1970-conventional",
            "area-1970-containers",
            "area-1970-trailers",
            "sauthoff-1932",
        ]
        | None
    ) = Field(None, description="Name of a published formula.")
    axles: Count | None = Field(None, ge=2, le=4000, description="Number of axles of the train.")
    cars: Count | None = Field(None, ge=1, le=1000, description="Number of cars of the train.")
    frontal_area_m2: Number | None = Field(None, gt=0, le=30, description="Frontal area of a car [m2].")

    @model_validator(mode="after")
    def _has_its_inputs(self) -> Self:
        needed = {"axles": False, "cars": False, "frontal_area_m2": False}
        if self.name is not None:
            formula = FORMULAS[self.name]
            needed = {"axles": formula.per_axle_n > 0, "cars": True, "frontal_area_m2": formula.takes_area}
        for key, is_needed in needed.items():
            if is_needed and getattr(self, key) is None:
                raise ValueError(f"name = '{self.name}' needs {key}")
            if not is_needed and getattr(self, key) is not None:
                beside = f"with name = '{self.name}'" if self.name else "without name"
                raise ValueError(f"{key} has no effect {beside}")
        return self

    @property
    def specific(self) -> Terms:
        """Terms over the weight [N/kN]."""
        return FORMULAS[self.name].specific if self.name else (0.0, 0.0, 0.0)

    @property
    def absolute(self) -> Terms:
        """Absolute terms [N]."""
        if self.name is None:
            return 0.0, 0.0, 0.0
        formula = FORMULAS[self.name]
        air = formula.air_n_per_kmh2 * ((self.cars or 0) + formula.further_cars) * (self.frontal_area_m2 or 1.0)
        wind = formula.wind_kmh
        return formula.per_axle_n * (self.axles or 0) + air * wind**2, 2 * air * wind, air


class Resistance(SpecificResistance):
    """Running resistance: specific terms times weight plus absolute terms, speed in km/h."""

    car_kinds: tuple[CarKind, ...] = Field(
        (), max_length=20, description="Kinds of cars with specific terms of their own, added to those of all cars."
    )
    constant_n: Number = Field(0.0, ge=0, le=1e6, description="Absolute, constant [N].")
    linear_n_per_kmh: Number = Field(0.0, ge=0, le=1e5, description="Absolute, linear in speed.")
    quadratic_n_per_kmh2: Number = Field(0.0, ge=0, le=1e4, description="Absolute, quadratic in speed.")
    curve_constant_m_n_per_kn: Number = Field(
        0.0, ge=0, le=5000, description="Curve resistance times radius, per weight [N m/kN]."
    )
    # journal bearings and cold oil: the resistance falls from this to nothing while the train starts
    starting_n_per_kn: Number = Field(0.0, ge=0, le=200, description="More at rest, specific [N per kN of weight].")
    starting_n: Number = Field(0.0, ge=0, le=1e6, description="More at rest, absolute [N].")
    starting_ends_at_kmh: Number | None = Field(
        None, gt=0, le=50, description="Speed at which the starting resistance has fallen evenly to nothing [km/h]."
    )
    davis: Davis = Davis()
    formula: ResistanceFormula = ResistanceFormula()
    load: LoadResistance = LoadResistance()

    @model_validator(mode="after")
    def _starting_ends(self) -> Self:
        more = self.starting_n_per_kn > 0 or self.starting_n > 0
        if more and self.starting_ends_at_kmh is None:
            raise ValueError("starting_n_per_kn and starting_n need starting_ends_at_kmh, the speed at which they end")
        if not more and self.starting_ends_at_kmh is not None:
            raise ValueError("starting_ends_at_kmh has no effect without starting_n_per_kn or starting_n")
        return self

    @property
    def specific(self) -> Terms:
        """Sums of the terms over weight that all cars have [N/kN]."""
        own = self.constant_n_per_kn, self.linear_n_per_kn_per_kmh, self.quadratic_n_per_kn_per_kmh2
        return _sums(own, self._davis(PER_WEIGHT), self.formula.specific)

    @property
    def absolute(self) -> Terms:
        """Sums of the absolute terms [N]."""
        own = self.constant_n, self.linear_n_per_kmh, self.quadratic_n_per_kmh2
        return _sums(own, self._davis(FORCES_N), self.formula.absolute)

    def _davis(self, units: dict[str, float]) -> Terms:
        return self.davis.terms if self.davis.unit in units else (0.0, 0.0, 0.0)


def _sums(*terms: Terms) -> Terms:
    constant, linear, quadratic = map(sum, zip(*terms, strict=True))
    return constant, linear, quadratic
