"""Trains of railtoolkit's schema: a formation of vehicles becomes one vehicle."""

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from railjoule.core.errors import ChoiceError, ScenarioError
from railjoule.core.imports.findings import Finding, Notes
from railjoule.core.imports.foreign import Foreign, checked, unknown_keys
from railjoule.core.imports.parts import checked_vehicle
from railjoule.core.imports.source_file import shown_list
from railjoule.core.imports.vehicle import KG_PER_T, ImportedVehicle, questions, short_numbers
from railjoule.core.scenario._base import Number
from railjoule.core.scenario._sentences import show
from railjoule.core.units import MS_PER_KMH, N_PER_KN

# at which the coefficients of rolling and air resistance are given: TrainRuns.jl, after Wende 2003, p. 151
REFERENCE_KMH = 100.0
# where a file tells none: TrainRuns.jl, after Bruenger, Dahlhaus 2014, p. 74
USUAL_DECELERATION_MS2 = 0.375
# an integer may have more digits than a number with a point can hold
LARGEST_FORCE_N = 1e12
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


def read_train(document: Mapping[str, Any], source: str, wanted: str | None, notes: Notes) -> ImportedVehicle:
    """Return the vehicle that a formation of a file makes.

    Parameters
    ----------
    document : mapping
        What the file holds.
    source : str
        The file.
    wanted : str or None
        The id of a train or vehicle; by default the only train, or without trains the only vehicle.
    notes : Notes
        What was noticed so far.

    Raises
    ------
    ChoiceError
        If there are several and none is named.
    ScenarioError
        If anything is wrong with the file.
    """
    file = checked(RollingStock, {**document, "vehicles": _nested(document.get("vehicles"))}, source)
    notes.unused += unknown_keys(file, source)
    train, formation = _formation(file, source, wanted, notes)
    for vehicle in {vehicle.id: vehicle for vehicle in formation}.values():
        where = f"{source}: vehicle {vehicle.id}"
        notes.unused += unknown_keys(vehicle, where)
        notes.unused += _unused_parts(vehicle, where)
        if vehicle.traction and vehicle.power_type not in {"electric", None}:
            sentence = f"{where} is {vehicle.power_type}: its efforts are taken, and its energy counts as electric."
            notes.findings.append(Finding("question", sentence))
    masses_t = _loaded_masses_t(train, formation, source, notes)
    mass_kg = KG_PER_T * sum(masses_t)
    rotating = _rotating_mass_factor(formation, masses_t)
    table = short_numbers(
        {
            "name": (train.name or train.id)[:200],
            "tare_kg": mass_kg,
            "rotating_mass_factor": rotating,
            "length_m": sum(vehicle.length for vehicle in formation),
            "resistance": _resistance(formation, masses_t, source, notes),
            "traction": {"max_speed_kmh": _speed_limit(formation, source), **_traction(formation, source)},
            "braking": _braking(formation, (1 + rotating) * mass_kg, source, notes),
            "drive": {"model": "constant_efficiency", "traction_efficiency": 1.0},
        }
    )
    notes.findings.append(Finding("assumption", f"{source}: it tells no losses: a drive without losses."))
    checked_one = checked_vehicle(table, source)
    notes.findings += questions(checked_one, source)
    return ImportedVehicle(
        source,
        {"vehicle": table},
        checked_one,
        findings=tuple(notes.findings),
        unused=tuple(notes.unused),
    )


def _nested(vehicles: Any) -> Any:
    """Return vehicles whose keys stand in tables, also where version 2022.05 has them beside each other."""
    if not isinstance(vehicles, list):
        return vehicles
    return [_nested_vehicle(vehicle) if isinstance(vehicle, dict) else vehicle for vehicle in vehicles]


def _nested_vehicle(vehicle: Mapping[str, Any]) -> dict[str, Any]:
    flat = {key for keys in FLAT_KEYS.values() for key in keys}
    nested = {key: value for key, value in vehicle.items() if key not in flat}
    for table, keys in FLAT_KEYS.items():
        entries = {key: vehicle[key] for key in keys if key in vehicle}
        if "a_braking" in entries:
            entries = {"deceleration": entries["a_braking"]}
        if isinstance(pairs := entries.get("tractive_effort"), list):
            entries["tractive_effort"] = [_pair(pair) for pair in pairs]
        if entries:
            nested[table] = entries
    return nested


def _pair(pair: Any) -> Any:
    """Return a pair of km/h and N as a table with kN."""
    if isinstance(pair, list) and len(pair) == 2 and type(pair[1]) in {int, float} and abs(pair[1]) < LARGEST_FORCE_N:
        return {"speed": pair[0], "force": pair[1] / N_PER_KN}
    return pair


def _formation(file: RollingStock, source: str, wanted: str | None, notes: Notes) -> tuple[Train, list[RailVehicle]]:
    """Return a train and its vehicles, one by one."""
    vehicles = {vehicle.id: vehicle for vehicle in file.vehicles}
    trains = {train.id: train for train in file.trains}
    if wanted is None and len(trains or vehicles) > 1:
        raise ChoiceError(source, "train" if trains else "vehicle", tuple(trains or vehicles))
    name = wanted if wanted is not None else next(iter(trains or vehicles))
    if name in trains:
        train = trains[name]
    elif name in vehicles:
        train = Train(id=name, name=name, formation=(name,))
    else:
        known = shown_list([*trains, *vehicles])
        raise ScenarioError(f"{source}: there is no train or vehicle with the id {show(name)}, only {known}.")
    if train.formation is None:
        raise ScenarioError(f"{source}: train {train.id} has no formation, and so neither masses nor efforts.")
    missing = [one for one in train.formation if one not in vehicles]
    if missing:
        raise ScenarioError(f"{source}: train {train.id}: the vehicle {show(missing[0])} is not in the file.")
    others = [other for other in trains if other != name]
    others += [other for other in vehicles if other not in train.formation]
    if others:
        notes.unused.append(f"{source}: trains and vehicles: {shown_list(others)}.")
    notes.unused += unknown_keys(train, f"{source}: train {train.id}")
    return train, [vehicles[one] for one in train.formation]


def _unused_parts(vehicle: RailVehicle, where: str) -> list[str]:
    """Return in words what the tables of a vehicle tell beside what is read, or twice."""
    brakes, traction = vehicle.brakes, vehicle.traction
    parts = {
        "resistance": vehicle.resistance,
        "traction": traction,
        "brakes": brakes,
        "brakes.electrodynamic_brake": brakes.electrodynamic_brake,
        "brakes.friction_brake": brakes.friction_brake,
    }
    told = [line for name, part in parts.items() if part for line in unknown_keys(part, f"{where}: {name}")]
    if traction and traction.tractive_effort:
        twice = [name for name in ("rated_power", "initial_tractive_force") if getattr(traction, name) is not None]
        told += [f"{where}: traction: {shown_list(twice)}, beside tractive_effort."] if twice else []
    if brakes.deceleration and brakes.friction_brake and brakes.friction_brake.service_brake_effort:
        told.append(f"{where}: brakes: service_brake_effort, beside deceleration.")
    return told


def _loaded_masses_t(train: Train, formation: Sequence[RailVehicle], source: str, notes: Notes) -> list[float]:
    """Return the mass of each vehicle with its load [t]."""
    empty = [vehicle.mass for vehicle in formation]
    if train.loading_factor is None:
        if total := sum(vehicle.load_limit for vehicle in formation):
            notes.unused.append(f"{source}: load_limit: the train is empty, and may carry {total:g} t.")
        return empty
    if len(train.loading_factor) != len(formation):
        raise ScenarioError(
            f"{source}: train {train.id}: loading_factor has {len(train.loading_factor)} entries for "
            f"{len(formation)} vehicles."
        )
    loads = [share * one.load_limit for share, one in zip(train.loading_factor, formation, strict=True)]
    notes.findings.append(Finding("assumption", f"{source}: vehicle.tare_kg includes its load of {sum(loads):g} t."))
    return [mass + load for mass, load in zip(empty, loads, strict=True)]


def _rotating_mass_factor(formation: Sequence[RailVehicle], masses_t: Sequence[float]) -> float:
    """Return rotating masses over the loaded mass: a vehicle gives its share of its empty mass, as no load rotates."""
    rotating = sum(vehicle.mass * ((vehicle.resistance.rotation_mass or 1.0) - 1) for vehicle in formation)
    return rotating / sum(masses_t)


def _resistance(
    formation: Sequence[RailVehicle], masses_t: Sequence[float], source: str, notes: Notes
) -> dict[str, float]:
    """Return resistance over weight: one per mille of the weight is one newton a kilonewton.

    The coefficients of a vehicle are per mille of its loaded weight, as TrainRuns.jl takes them.
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
        sentence = f"{source}: no base_resistance of {shown_list(list(Counter(silent)))}: none is taken."
        notes.findings.append(Finding("question", sentence))
    told = f"{source}: coefficients of rolling and air resistance are taken as those at {REFERENCE_KMH:g} km/h."
    notes.findings.append(Finding("assumption", told))
    return {
        "constant_n_per_kn": float(terms[0]),
        "linear_n_per_kn_per_kmh": float(terms[1]) / REFERENCE_KMH,
        "quadratic_n_per_kn_per_kmh2": float(terms[2]) / REFERENCE_KMH**2,
    }


def _speed_limit(formation: Sequence[RailVehicle], source: str) -> float:
    limits = [vehicle.speed_limit for vehicle in formation if vehicle.speed_limit is not None]
    if not limits:
        raise ScenarioError(f"{source}: speed_limit is missing in all vehicles of the train.")
    return min(limits)


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


def _braking(formation: Sequence[RailVehicle], inertia_kg: float, source: str, notes: Notes) -> dict[str, float]:
    """Return electric brakes by their forces, and friction brakes by theirs or by the deceleration they give."""
    electric = [vehicle.brakes.electrodynamic_brake for vehicle in formation if vehicle.brakes.electrodynamic_brake]
    known = [brake for brake in electric if brake.max_brake_force is not None]
    effort = sum(brake.max_brake_force or 0.0 for brake in known)
    # the force stays up to that speed, and from there on the power
    limits = [(one.max_brake_force or 0.0) * one.speed_power_limit for one in known if one.speed_power_limit]
    braking = {"max_effort_kn": effort}
    if effort and len(limits) == len(known):
        braking["max_power_kw"] = sum(limits) * MS_PER_KMH
    if not known:
        told = f"{source}: it tells of no electric brake, and nothing goes back."
        notes.findings.append(Finding("assumption", told))
    decelerations = _decelerations(formation)
    if decelerations:
        braking["max_deceleration_ms2"] = min(decelerations)
    if services := _friction_forces(formation):
        braking["friction_effort_kn"] = services
        return braking
    braking["friction_effort_kn"] = inertia_kg * min(decelerations, default=USUAL_DECELERATION_MS2) / N_PER_KN
    if not decelerations:
        told = f"{source}: it tells of no friction brake: one for {USUAL_DECELERATION_MS2} m/s2 is assumed."
        notes.findings.append(Finding("assumption", told))
    return braking


def _decelerations(formation: Sequence[RailVehicle]) -> list[float]:
    return [abs(one.brakes.deceleration) for one in formation if one.brakes.deceleration]


def _friction_forces(formation: Sequence[RailVehicle]) -> float:
    """Return the force of all friction brakes [kN]; 0 where decelerations go before them, or there are none."""
    if _decelerations(formation):
        return 0.0
    return sum(one.brakes.friction_brake.service_brake_effort or 0.0 for one in formation if one.brakes.friction_brake)
