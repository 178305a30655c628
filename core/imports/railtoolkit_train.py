"""Trains of railtoolkit's schema: a formation of vehicles becomes one vehicle."""

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Any

import numpy as np
from pydantic import Field, model_validator

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import ScenarioError
from railjoule.core.imports.findings import Foreign, Notes
from railjoule.core.imports.vehicle import ImportedVehicle, imported_vehicle
from railjoule.core.scenario._base import Number
from railjoule.core.scenario._sentences import show, shown_list, validated
from railjoule.core.units import KG_PER_T, MS_PER_KMH, N_PER_KN

# at which the coefficients of rolling and air resistance are given: TrainRuns.jl, after Wende 2003, p. 151
REFERENCE_KMH = 100.0
# for a file without one: TrainRuns.jl, after Bruenger, Dahlhaus 2014, p. 74
USUAL_DECELERATION_MS2, FREIGHT_DECELERATION_MS2 = 0.375, 0.225
# an integer may have more digits than a number with a point can hold
MAX_FORCE_N = 1e12
OLD_KEYS = {
    **{
        key: f"resistance.{key}" for key in ("rotation_mass", "base_resistance", "rolling_resistance", "air_resistance")
    },
    "tractive_effort": "traction.tractive_effort",
    "a_braking": "brakes.deceleration",
}
"""Keys of a vehicle in 2022.05, and where they stand since."""
Positive = Annotated[Number, Field(gt=0)]
NotNegative = Annotated[Number, Field(ge=0)]


class Pair(Foreign):
    """A force [kN] at a speed [km/h]; version 2022.05 has lists of km/h and N."""

    speed: NotNegative
    force: NotNegative

    @model_validator(mode="before")
    @classmethod
    def _from_list(cls, pair: Any) -> Any:
        if isinstance(pair, list) and len(pair) == 2 and type(pair[1]) in {int, float} and abs(pair[1]) < MAX_FORCE_N:
            return {"speed": pair[0], "force": pair[1] / N_PER_KN}
        return pair


class RailVehicle(Foreign):
    """A vehicle of a formation [m, t, km/h, kN, kW, m/s2, per mille]; keys of tables within it have dots.

    Running resistance is that on driving axles, on others, and of the air. An electric brake has a force, and the speed
    from which its power limits it.
    """

    id: str = Field(max_length=200)
    vehicle_type: str | None = None
    length: Positive
    mass: Positive
    load_limit: NotNegative = 0.0
    mass_traction: NotNegative | None = None
    speed_limit: Positive | None = None
    power_type: str | None = None
    rotation_mass: Number = Field(1.0, ge=1, alias="resistance.rotation_mass")
    base_resistance: NotNegative | None = Field(None, alias="resistance.base_resistance")
    rolling_resistance: NotNegative = Field(0.0, alias="resistance.rolling_resistance")
    air_resistance: NotNegative = Field(0.0, alias="resistance.air_resistance")
    rated_power: NotNegative | None = Field(None, alias="traction.rated_power")
    initial_tractive_force: NotNegative | None = Field(None, alias="traction.initial_tractive_force")
    tractive_effort: tuple[Pair, ...] | None = Field(
        None, min_length=2, max_length=1000, alias="traction.tractive_effort"
    )
    deceleration: Number = Field(0.0, alias="brakes.deceleration")
    brake_force: NotNegative | None = Field(None, alias="brakes.electrodynamic_brake.max_brake_force")
    brake_speed: NotNegative = Field(0.0, alias="brakes.electrodynamic_brake.speed_power_limit")
    service_brake: NotNegative = Field(0.0, alias="brakes.friction_brake.service_brake_effort")

    @model_validator(mode="before")
    @classmethod
    def _without_tables(cls, vehicle: Any) -> Any:
        if not isinstance(vehicle, dict):
            return vehicle
        return _flat({OLD_KEYS.get(str(key), key): value for key, value in vehicle.items()})

    @property
    def is_driven(self) -> bool:
        """Whether it has an effort."""
        return any(one is not None for one in (self.rated_power, self.initial_tractive_force, self.tractive_effort))


def _flat(table: Mapping[Any, Any], prefix: str = "") -> dict[str, Any]:
    """Return a table without tables in it, whose keys follow a dot, and without empty entries."""
    flat: dict[str, Any] = {}
    for key, value in table.items():
        if value is not None:
            flat |= _flat(value, f"{prefix}{key}.") if isinstance(value, dict) else {f"{prefix}{key}": value}
    return flat


class Train(Foreign):
    """A formation of vehicles by their ids, and how full each is."""

    id: str = Field(max_length=200)
    name: str = ""
    formation: tuple[str, ...] | None = Field(None, min_length=1, max_length=500)
    loading_factor: tuple[Annotated[Number, Field(ge=0, le=1)], ...] | None = None


class RollingStock(Foreign):
    """A file of trains and vehicles."""

    trains: tuple[Train, ...] = Field((), max_length=1000)
    vehicles: tuple[RailVehicle, ...] = Field(min_length=1, max_length=1000)


def read_train(document: Mapping[str, Any], wanted: str | None, notes: Notes) -> ImportedVehicle:
    """Make a vehicle of a formation of a file.

    Parameters
    ----------
    document : mapping
        The content of the file.
    wanted : str or None
        The id of a train or vehicle; by default the only train, or without trains the only vehicle.
    notes : Notes
        Findings so far.

    Raises
    ------
    ChoiceError
        If there are several and none is named.
    ScenarioError
        If anything is wrong with the file.
    """
    file = validated(RollingStock, document, notes.source)
    notes.add_unknown_keys(file)
    train, formation = _formation(file, wanted, notes)
    for vehicle in {vehicle.id: vehicle for vehicle in formation}.values():
        _note_parts(vehicle, notes)
    tare_t, max_load_t = sum(one.mass for one in formation), sum(one.load_limit for one in formation)
    loads_t = _loads_t(train, formation, notes)
    # a vehicle gives the inertia of its rotating parts as a share of its empty mass
    inertia_t = sum(vehicle.mass * vehicle.rotation_mass for vehicle in formation)
    limits = [vehicle.speed_limit for vehicle in formation if vehicle.speed_limit is not None]
    if not limits:
        raise ScenarioError(f"{notes.source}: speed_limit is missing in all vehicles of the train.")
    table = {
        "name": (train.name or train.id)[:200],
        "tare_kg": KG_PER_T * tare_t,
        "inertial_mass_kg": KG_PER_T * inertia_t,
        "max_load_t": max_load_t or None,
        "load_t": sum(loads_t) or None,
        "length_m": sum(vehicle.length for vehicle in formation),
        "resistance": _resistance(formation, loads_t, notes),
        "traction": {"max_speed_kmh": min(limits), **_traction(formation, notes.source)},
        "braking": _braking(formation, KG_PER_T * (inertia_t + max_load_t), _usual_deceleration(formation), notes),
    }
    return imported_vehicle(table, notes)


def _formation(file: RollingStock, wanted: str | None, notes: Notes) -> tuple[Train, list[RailVehicle]]:
    """Select a train and its vehicles, one by one; a single vehicle is a train too."""
    vehicles = {vehicle.id: vehicle for vehicle in file.vehicles}
    trains = {train.id: train for train in file.trains}
    what = "train" if trains and wanted not in vehicles.keys() - trains.keys() else "vehicle"
    if what == "vehicle":
        trains = {name: Train(id=name, name=name, formation=(name,)) for name in vehicles}
    names = list(trains)
    train = trains[names[notes.chosen(names, wanted, what)]]
    notes.add_unknown_keys(train, f"train {train.id}: ")
    if train.formation is None:
        raise ScenarioError(f"{notes.source}: train {train.id} has no formation, and so neither masses nor efforts.")
    if missing := [one for one in train.formation if one not in vehicles]:
        raise ScenarioError(f"{notes.source}: train {train.id}: the vehicle {show(missing[0])} is not in the file.")
    others = [other for other in vehicles if other not in train.formation]
    if others and what == "train":
        notes.add_unused(f"vehicles not read: {shown_list(others)}.")
    return train, [vehicles[one] for one in train.formation]


def _note_parts(vehicle: RailVehicle, notes: Notes) -> None:
    """Note the contents of a vehicle that are not used, or given twice, and an engine of another kind."""
    where = f"vehicle {vehicle.id}"
    notes.add_unknown_keys(vehicle, f"{where}: ")
    twice = [name for name in ("rated_power", "initial_tractive_force") if getattr(vehicle, name) is not None]
    if vehicle.tractive_effort and twice:
        notes.add_unused(f"{where}: traction: {shown_list(twice)}, beside tractive_effort.")
    if vehicle.deceleration and vehicle.service_brake:
        notes.add_unused(f"{where}: brakes: service_brake_effort, beside deceleration.")
    if vehicle.is_driven and vehicle.power_type not in {"electric", None}:
        sentence = f"is {vehicle.power_type}: its efforts are taken, and its energy counts as electric."
        notes.add("question", f"{where} {sentence}")


def _loads_t(train: Train, formation: Sequence[RailVehicle], notes: Notes) -> list[float]:
    """Return the load of each vehicle [t]; an empty train's are 0."""
    if (factors := train.loading_factor) is None:
        if total := sum(vehicle.load_limit for vehicle in formation):
            notes.add("assumption", f"the train is empty; vehicle.load_t loads it with up to {total:g} t.")
        return [0.0] * len(formation)
    if len(factors) != len(formation):
        raise ScenarioError(
            f"{notes.source}: train {train.id}: loading_factor has {len(factors)} entries for {len(formation)} "
            "vehicles."
        )
    return [share * one.load_limit for share, one in zip(factors, formation, strict=True)]


def _resistance(formation: Sequence[RailVehicle], loads_t: Sequence[float], notes: Notes) -> dict[str, Any]:
    """Compute resistance over weight: one per mille of the weight is one newton a kilonewton.

    The coefficients of a vehicle are per mille of its loaded weight, as in TrainRuns.jl: the mean over the empty masses
    is that of the empty train, the mean over the loads that of the load, which only some of the vehicles carry.
    """
    # on driving axles the base, on carrying ones the rolling coefficient; a load is spread over the axles as the empty
    # mass is
    rows = [
        (
            one.base_resistance or 0.0,
            one.rolling_resistance,
            one.air_resistance,
            one.is_driven,
            1.0 if one.mass_traction is None else min(one.mass_traction / one.mass, 1.0),
        )
        for one in formation
    ]
    base, rolling, air, is_driven, share = np.array(rows).T
    constant = np.where(is_driven, base * share + rolling * (1 - share), base)
    terms = np.column_stack([constant, np.where(is_driven, 0.0, rolling), air])
    if silent := [one.id for one in formation if one.base_resistance is None]:
        notes.add("question", f"no base_resistance of {shown_list(list(Counter(silent)))}: none is taken.")
    notes.add("assumption", f"coefficients of rolling and air resistance are taken as those at {REFERENCE_KMH:g} km/h.")
    # an empty train may be loaded later: then all of its vehicles are as full as each other
    carried = loads_t if any(loads_t) else [one.load_limit for one in formation]
    table: dict[str, Any] = _specific(np.average(terms, axis=0, weights=[one.mass for one in formation]))
    if any(carried):
        table["load"] = _specific(np.average(terms, axis=0, weights=carried))
    return table


def _specific(terms: FloatArray) -> dict[str, float]:
    """Return the keys of specific terms, constant and linear and quadratic at the reference speed [per mille]."""
    return {
        "constant_n_per_kn": float(terms[0]),
        "linear_n_per_kn_per_kmh": float(terms[1]) / REFERENCE_KMH,
        "quadratic_n_per_kn_per_kmh2": float(terms[2]) / REFERENCE_KMH**2,
    }


def _traction(formation: Sequence[RailVehicle], source: str) -> dict[str, Any]:
    """Return the efforts of all driven vehicles together."""
    driven = [vehicle for vehicle in formation if vehicle.is_driven]
    if not driven:
        raise ScenarioError(f"{source}: no vehicle of the train has a tractive effort.")
    tables = [vehicle.tractive_effort for vehicle in driven]
    with_table = [table for table in tables if table is not None]
    if with_table and len(with_table) < len(tables):
        raise ScenarioError(f"{source}: tractive_effort is missing in some driven vehicles of the train.")
    if with_table:
        for vehicle, table in zip(driven, with_table, strict=True):
            if any(later.speed < earlier.speed for earlier, later in pairwise(table)):
                raise ScenarioError(f"{source}: vehicle {vehicle.id}: tractive_effort must have rising speeds.")
        return {"curve": _sum_of_tables(with_table)}
    efforts = {}
    for key, name in (("max_effort_kn", "initial_tractive_force"), ("max_power_kw", "rated_power")):
        values = [getattr(vehicle, name) for vehicle in driven]
        if None in values:
            raise ScenarioError(f"{source}: traction has neither tractive_effort nor {name} in all driven vehicles.")
        efforts[key] = sum(values)
    return efforts


def _sum_of_tables(tables: Sequence[Sequence[Pair]]) -> list[list[float]]:
    """Return the sum of efforts over speed [km/h, kN]; where one of them has a step, so has the sum."""
    speeds = sorted({pair.speed for table in tables for pair in table})
    steps = {one.speed for table in tables for one, other in pairwise(table) if one.speed == other.speed}
    # a step has one sum on each side
    places = [(speed, end) for speed in speeds for end in ((0.0, np.inf) if speed in steps else (speed,))]
    sums = [
        sum(
            np.interp(np.nextafter(speed, end), [pair.speed for pair in table], [pair.force for pair in table])
            for table in tables
        )
        for speed, end in places
    ]
    return [[speed, float(total)] for (speed, _), total in zip(places, sums, strict=True)]


def _usual_deceleration(formation: Sequence[RailVehicle]) -> float:
    """Return the deceleration of a train whose file has none [m/s2]: with wagons and no passengers that of freight."""
    kinds = {vehicle.vehicle_type for vehicle in formation}
    is_freight = "freight" in kinds and not kinds & {"passenger", "multiple unit"}
    return FREIGHT_DECELERATION_MS2 if is_freight else USUAL_DECELERATION_MS2


def _braking(formation: Sequence[RailVehicle], inertia_kg: float, usual_ms2: float, notes: Notes) -> dict[str, float]:
    """Compute electric brakes by their forces, and friction brakes by theirs or by the deceleration they give."""
    forces = [vehicle.brake_force for vehicle in formation if vehicle.brake_force is not None]
    # the force stays up to that speed, and from there on the power
    powers = [(one.brake_force or 0.0) * one.brake_speed for one in formation if one.brake_speed]
    braking = {"max_effort_kn": sum(forces)}
    if sum(forces) and len(powers) == len(forces):
        braking["max_power_kw"] = sum(powers) * MS_PER_KMH
    if not forces:
        notes.add("assumption", "no electric brake is given, and nothing is recuperated.")
    decelerations = [abs(one.deceleration) for one in formation if one.deceleration]
    services = sum(vehicle.service_brake for vehicle in formation)
    if decelerations:
        braking["max_deceleration_ms2"] = min(decelerations)
    elif services:
        return {**braking, "friction_effort_kn": services}
    else:
        what = f"one for {usual_ms2} m/s2 with the largest load is assumed"
        notes.add("assumption", f"no friction brake is given: {what}.")
        # or the brake of the largest load would stop an empty train far sooner
        braking["max_deceleration_ms2"] = usual_ms2
    braking["friction_effort_kn"] = inertia_kg * min(decelerations, default=usual_ms2) / N_PER_KN
    return braking
