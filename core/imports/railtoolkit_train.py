"""Trains of railtoolkit's schema: a formation of vehicles becomes one vehicle."""

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from railjoule.core.errors import ChoiceError, ScenarioError
from railjoule.core.imports.findings import Foreign, Notes, unknown_keys
from railjoule.core.imports.vehicle import KG_PER_T, ImportedVehicle, imported_vehicle
from railjoule.core.scenario._base import Number
from railjoule.core.scenario._sentences import show, shown_list, validated
from railjoule.core.units import MS_PER_KMH, N_PER_KN

# at which the coefficients of rolling and air resistance are given: TrainRuns.jl, after Wende 2003, p. 151
REFERENCE_KMH = 100.0
# for a file without one: TrainRuns.jl, after Bruenger, Dahlhaus 2014, p. 74
USUAL_DECELERATION_MS2 = 0.375
# an integer may have more digits than a number with a point can hold
MAX_FORCE_N = 1e12
FLAT_KEYS = {
    "resistance": ("rotation_mass", "base_resistance", "rolling_resistance", "air_resistance"),
    "traction": ("tractive_effort",),
    "brakes": ("a_braking",),
}
"""Keys of a vehicle in 2022.05, by the table that they stand in since."""
Positive = Annotated[Number, Field(ge=0)]


class Pair(Foreign):
    """A force [kN] at a speed [km/h]."""

    speed: Positive
    force: Positive


class Resistance(Foreign):
    """Coefficients of running resistance [per mille]: on driving axles, on others, of the air."""

    rotation_mass: Annotated[Number, Field(ge=1)] | None = None
    base_resistance: Positive | None = None
    rolling_resistance: Positive | None = None
    air_resistance: Positive | None = None


class Traction(Foreign):
    """Tractive effort as a table, or as force and power [kN, kW]."""

    rated_power: Positive | None = None
    initial_tractive_force: Positive | None = None
    tractive_effort: tuple[Pair, ...] | None = Field(None, min_length=2, max_length=1000)


class ElectrodynamicBrake(Foreign):
    """An electric brake: its force [kN], and the speed from which its power limits it [km/h]."""

    max_brake_force: Positive | None = None
    speed_power_limit: Positive | None = None


class FrictionBrake(Foreign):
    """A friction brake by its force in service [kN]."""

    service_brake_effort: Positive | None = None


class Brakes(Foreign):
    """Brakes by their forces, or by the deceleration [m/s2], which is negative."""

    deceleration: Number | None = None
    electrodynamic_brake: ElectrodynamicBrake | None = None
    friction_brake: FrictionBrake | None = None


class RailVehicle(Foreign):
    """A vehicle of a formation [m, t, km/h]."""

    id: str = Field(max_length=200)
    length: Annotated[Number, Field(gt=0)]
    mass: Annotated[Number, Field(gt=0)]
    load_limit: Positive = 0.0
    mass_traction: Positive | None = None
    speed_limit: Annotated[Number, Field(gt=0)] | None = None
    power_type: str | None = None
    resistance: Resistance = Resistance()
    traction: Traction | None = None
    brakes: Brakes = Brakes()


class Train(Foreign):
    """A formation of vehicles by their ids, and how full each is."""

    id: str = Field(max_length=200)
    name: str = ""
    formation: tuple[str, ...] | None = Field(None, min_length=1, max_length=500)
    loading_factor: tuple[Annotated[Number, Field(ge=0, le=1)], ...] | None = None


class RollingStock(Foreign):
    """A file of trains and vehicles."""

    schema_version: str
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
    file = validated(RollingStock, {**document, "vehicles": _nested(document.get("vehicles"))}, notes.source)
    notes.add_unused(unknown_keys(file))
    train, formation = _formation(file, wanted, notes)
    for vehicle in {vehicle.id: vehicle for vehicle in formation}.values():
        _note_unused_parts(vehicle, notes)
        if vehicle.traction and vehicle.power_type not in {"electric", None}:
            sentence = f"is {vehicle.power_type}: its efforts are taken, and its energy counts as electric."
            notes.add("question", f"vehicle {vehicle.id} {sentence}")
    masses_t = _loaded_masses_t(train, formation, notes)
    mass_kg = KG_PER_T * sum(masses_t)
    # a vehicle gives its share of its empty mass, as no load rotates
    rotating_t = sum(vehicle.mass * ((vehicle.resistance.rotation_mass or 1.0) - 1) for vehicle in formation)
    rotating = rotating_t / sum(masses_t)
    limits = [vehicle.speed_limit for vehicle in formation if vehicle.speed_limit is not None]
    if not limits:
        raise ScenarioError(f"{notes.source}: speed_limit is missing in all vehicles of the train.")
    table = {
        "name": (train.name or train.id)[:200],
        "tare_kg": mass_kg,
        "rotating_mass_factor": rotating,
        "length_m": sum(vehicle.length for vehicle in formation),
        "resistance": _resistance(formation, masses_t, notes),
        "traction": {"max_speed_kmh": min(limits), **_traction(formation, notes.source)},
        "braking": _braking(formation, (1 + rotating) * mass_kg, notes),
        "drive": {"model": "constant_efficiency", "traction_efficiency": 1.0},
    }
    notes.add("assumption", "it tells no losses: a drive without losses.")
    return imported_vehicle(table, notes)


def _nested(vehicles: Any) -> Any:
    """Nest the keys of vehicles in tables, also if they stand beside each other as in version 2022.05."""
    if not isinstance(vehicles, list):
        return vehicles
    flat = {key for keys in FLAT_KEYS.values() for key in keys}
    nested = []
    for vehicle in vehicles:
        if not isinstance(vehicle, dict):
            nested.append(vehicle)
            continue
        tables = {name: {key: vehicle[key] for key in keys if key in vehicle} for name, keys in FLAT_KEYS.items()}
        if "a_braking" in tables["brakes"]:
            tables["brakes"] = {"deceleration": vehicle["a_braking"]}
        if isinstance(pairs := tables["traction"].get("tractive_effort"), list):
            tables["traction"]["tractive_effort"] = [_pair(pair) for pair in pairs]
        others = {key: value for key, value in vehicle.items() if key not in flat}
        nested.append(others | {name: entries for name, entries in tables.items() if entries})
    return nested


def _pair(pair: Any) -> Any:
    """Return a pair of km/h and N as a table with kN."""
    if isinstance(pair, list) and len(pair) == 2 and type(pair[1]) in {int, float} and abs(pair[1]) < MAX_FORCE_N:
        return {"speed": pair[0], "force": pair[1] / N_PER_KN}
    return pair


def _formation(file: RollingStock, wanted: str | None, notes: Notes) -> tuple[Train, list[RailVehicle]]:
    """Select a train and its vehicles, one by one."""
    source = notes.source
    vehicles = {vehicle.id: vehicle for vehicle in file.vehicles}
    trains = {train.id: train for train in file.trains}
    if wanted is None and len(trains or vehicles) > 1:
        raise ChoiceError(source, "train" if trains else "vehicle", tuple(trains or vehicles))
    name = wanted if wanted is not None else next(iter(trains or vehicles))
    if name not in {*trains, *vehicles}:
        known = shown_list([*trains, *vehicles])
        raise ScenarioError(f"{source}: there is no train or vehicle with the id {show(name)}, only {known}.")
    train = trains[name] if name in trains else Train(id=name, name=name, formation=(name,))
    if train.formation is None:
        raise ScenarioError(f"{source}: train {train.id} has no formation, and so neither masses nor efforts.")
    missing = [one for one in train.formation if one not in vehicles]
    if missing:
        raise ScenarioError(f"{source}: train {train.id}: the vehicle {show(missing[0])} is not in the file.")
    others = [other for other in trains if other != name]
    others += [other for other in vehicles if other not in train.formation]
    if others:
        notes.add_unused(f"trains and vehicles: {shown_list(others)}.")
    notes.add_unused(unknown_keys(train, f"train {train.id}: "))
    return train, [vehicles[one] for one in train.formation]


def _note_unused_parts(vehicle: RailVehicle, notes: Notes) -> None:
    """Note the contents of a vehicle that are not used, or given twice."""
    brakes, traction = vehicle.brakes, vehicle.traction
    where = f"vehicle {vehicle.id}: "
    for name, part in (
        ("", vehicle),
        ("resistance: ", vehicle.resistance),
        ("traction: ", traction),
        ("brakes: ", brakes),
        ("brakes.electrodynamic_brake: ", brakes.electrodynamic_brake),
        ("brakes.friction_brake: ", brakes.friction_brake),
    ):
        notes.add_unused(unknown_keys(part, where + name) if part else "")
    if traction and traction.tractive_effort:
        twice = [name for name in ("rated_power", "initial_tractive_force") if getattr(traction, name) is not None]
        notes.add_unused(f"{where}traction: {shown_list(twice)}, beside tractive_effort." if twice else "")
    if brakes.deceleration and brakes.friction_brake and brakes.friction_brake.service_brake_effort:
        notes.add_unused(f"{where}brakes: service_brake_effort, beside deceleration.")


def _loaded_masses_t(train: Train, formation: Sequence[RailVehicle], notes: Notes) -> list[float]:
    """Compute the mass of each vehicle with its load [t]."""
    factors = train.loading_factor
    if factors is None:
        if total := sum(vehicle.load_limit for vehicle in formation):
            notes.add_unused(f"load_limit: the train is empty, and may carry {total:g} t.")
        return [vehicle.mass for vehicle in formation]
    if len(factors) != len(formation):
        raise ScenarioError(
            f"{notes.source}: train {train.id}: loading_factor has {len(factors)} entries for {len(formation)} "
            "vehicles."
        )
    loads = [share * one.load_limit for share, one in zip(factors, formation, strict=True)]
    notes.add("assumption", f"vehicle.tare_kg includes its load of {sum(loads):g} t.")
    return [vehicle.mass + load for vehicle, load in zip(formation, loads, strict=True)]


def _resistance(formation: Sequence[RailVehicle], masses_t: Sequence[float], notes: Notes) -> dict[str, float]:
    """Compute resistance over weight: one per mille of the weight is one newton a kilonewton.

    The coefficients of a vehicle are per mille of its loaded weight, as in TrainRuns.jl.
    """
    terms = np.zeros(3)
    for vehicle, mass in zip(formation, masses_t, strict=True):
        base, rolling, air = (
            getattr(vehicle.resistance, f"{name}_resistance") or 0.0 for name in ("base", "rolling", "air")
        )
        if vehicle.traction:  # on driving axles the base, on carrying ones the rolling coefficient
            # a load is spread over the axles as the empty mass is
            driven = 1.0 if vehicle.mass_traction is None else min(vehicle.mass_traction / vehicle.mass, 1.0)
            terms += mass * np.array([base * driven + rolling * (1 - driven), 0.0, air])
        else:
            terms += mass * np.array([base, rolling, air])
    terms /= sum(masses_t)
    silent = [one.id for one in formation if one.resistance.base_resistance is None]
    if silent:
        notes.add("question", f"no base_resistance of {shown_list(list(Counter(silent)))}: none is taken.")
    notes.add("assumption", f"coefficients of rolling and air resistance are taken as those at {REFERENCE_KMH:g} km/h.")
    return {
        "constant_n_per_kn": float(terms[0]),
        "linear_n_per_kn_per_kmh": float(terms[1]) / REFERENCE_KMH,
        "quadratic_n_per_kn_per_kmh2": float(terms[2]) / REFERENCE_KMH**2,
    }


def _traction(formation: Sequence[RailVehicle], source: str) -> dict[str, Any]:
    """Return the efforts of all driven vehicles together."""
    driven = [vehicle for vehicle in formation if vehicle.traction is not None]
    if not driven:
        raise ScenarioError(f"{source}: no vehicle of the train has a tractive effort.")
    tables = [vehicle.traction.tractive_effort for vehicle in driven if vehicle.traction]
    with_table = [table for table in tables if table is not None]
    if with_table and len(with_table) < len(tables):
        raise ScenarioError(f"{source}: tractive_effort is missing in some driven vehicles of the train.")
    if with_table:
        for vehicle, table in zip(driven, with_table, strict=True):
            if any(later.speed <= earlier.speed for earlier, later in pairwise(table)):
                raise ScenarioError(f"{source}: vehicle {vehicle.id}: tractive_effort must have rising speeds.")
        speeds = sorted({pair.speed for table in with_table for pair in table})
        total = np.zeros(len(speeds))
        for table in with_table:
            total += np.interp(speeds, [pair.speed for pair in table], [pair.force for pair in table])
        return {"curve": [[speed, float(force)] for speed, force in zip(speeds, total, strict=True)]}
    efforts = {}
    for key, name in (("max_effort_kn", "initial_tractive_force"), ("max_power_kw", "rated_power")):
        values = [getattr(vehicle.traction, name) for vehicle in driven]
        if None in values:
            raise ScenarioError(f"{source}: traction has neither tractive_effort nor {name} in all driven vehicles.")
        efforts[key] = sum(values)
    return efforts


def _braking(formation: Sequence[RailVehicle], inertia_kg: float, notes: Notes) -> dict[str, float]:
    """Compute electric brakes by their forces, and friction brakes by theirs or by the deceleration they give."""
    electric = [vehicle.brakes.electrodynamic_brake for vehicle in formation if vehicle.brakes.electrodynamic_brake]
    known = [brake for brake in electric if brake.max_brake_force is not None]
    effort = sum(brake.max_brake_force or 0.0 for brake in known)
    # the force stays up to that speed, and from there on the power
    limits = [(one.max_brake_force or 0.0) * one.speed_power_limit for one in known if one.speed_power_limit]
    braking = {"max_effort_kn": effort}
    if effort and len(limits) == len(known):
        braking["max_power_kw"] = sum(limits) * MS_PER_KMH
    if not known:
        notes.add("assumption", "it tells of no electric brake, and nothing goes back.")
    decelerations = [abs(one.brakes.deceleration) for one in formation if one.brakes.deceleration]
    friction = [vehicle.brakes.friction_brake for vehicle in formation if vehicle.brakes.friction_brake]
    services = sum(brake.service_brake_effort or 0.0 for brake in friction)
    if decelerations:
        braking["max_deceleration_ms2"] = min(decelerations)
    elif services:
        return {**braking, "friction_effort_kn": services}
    else:
        what = f"one for {USUAL_DECELERATION_MS2} m/s2 is assumed"
        notes.add("assumption", f"it tells of no friction brake: {what}.")
    braking["friction_effort_kn"] = inertia_kg * min(decelerations, default=USUAL_DECELERATION_MS2) / N_PER_KN
    return braking
