"""The actual vehicle: its load and running resistance, and the supply voltage and rails under actual conditions."""

from typing import Any

from railjoule.core.scenario import Scenario, Vehicle
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.scenario.drive import DriveParameters
from railjoule.core.scenario.resistance import Davis, Resistance, ResistanceFormula, SpecificResistance
from railjoule.core.scenario.vehicle import Braking, Traction

# Terms of the weight and absolute ones; the curves' constant is a matter of the track and is not among them.
SPECIFIC_TERMS = tuple(SpecificResistance.model_fields)
ABSOLUTE_TERMS = ("constant_n", "linear_n_per_kmh", "quadratic_n_per_kmh2")
STARTING_TERMS = ("starting_n_per_kn", "starting_n")

NO_JERK_LIMIT = "Plan and actual run are those of a train without vehicle.max_jerk_ms3, which only single runs keep."


def actual_vehicle(scenario: Scenario) -> Scenario:
    """Return a scenario with the vehicle and rails of its disturbance.

    At a lower line voltage the largest efforts stay, but are left at a lower speed: the power falls by the same
    factor, and so do the speeds of a tabulated curve of effort and the voltage of induction and synchronous motors.

    Parameters
    ----------
    scenario : Scenario
        With its disturbance.
    """
    # the timetable is that of the planned train
    scenario = scenario.with_fixed_time()
    disturbance, vehicle, line = scenario.disturbance, scenario.vehicle, scenario.line
    vehicle = actually_loaded(vehicle, disturbance)
    if disturbance.resistance_factor != 1:
        vehicle = changed(vehicle, resistance=_times(vehicle.resistance, disturbance.resistance_factor))
    if disturbance.line_voltage_factor != 1:
        vehicle = at_voltage(vehicle, disturbance.line_voltage_factor)
    if disturbance.rail_condition is not None:
        # what is known of the day holds on all of the line
        line = line.model_copy(update={"rail_condition": disturbance.rail_condition, "rail_conditions": ()})
    return scenario.model_copy(update={"vehicle": vehicle, "line": line})


def actually_loaded(vehicle: Vehicle, disturbance: Disturbance) -> Vehicle:
    """Return a vehicle with the load of a disturbance, or as it is where that has none."""
    if not disturbance.has_load:
        return vehicle
    return vehicle.with_load(disturbance.actual_load_factor, disturbance.actual_load_t)


def _times(resistance: Resistance, factor: float) -> Resistance:
    """Return a running resistance with all its terms but that of curves multiplied."""
    kinds = tuple(
        kind.model_copy(update={name: factor * getattr(kind, name) for name in SPECIFIC_TERMS})
        for kind in resistance.car_kinds
    )
    # Davis coefficients and formulas are among the sums
    terms = dict(zip((*SPECIFIC_TERMS, *ABSOLUTE_TERMS), (*resistance.specific, *resistance.absolute), strict=True))
    starting = {name: getattr(resistance, name) for name in STARTING_TERMS}
    of_load = {name: factor * term for name, term in resistance.load.model_dump(exclude_none=True).items()}
    update: dict[str, Any] = {name: factor * term for name, term in (terms | starting).items()}
    load = resistance.load.model_copy(update=of_load)
    no_others = {"davis": Davis(), "formula": ResistanceFormula()}
    return resistance.model_copy(update={**update, **no_others, "car_kinds": kinds, "load": load})


def changed(vehicle: Vehicle, **fields: float | Resistance | Traction | Braking | DriveParameters) -> Vehicle:
    """Return a copy with other values, which were validated before."""
    return vehicle.model_copy(update=fields)


def at_voltage(vehicle: Vehicle, factor: float) -> Vehicle:
    """Return a vehicle with the limits that it has at a line voltage, as a share of the nominal one."""
    traction, braking = vehicle.traction, vehicle.braking
    # The motor's voltage limits its speed at a given effort, so at a lower one the knees of all curves come at a
    # proportionally lower speed: power over speed falls by the same factor.
    if vehicle.line_voltage_v is not None:
        vehicle = changed(vehicle, line_voltage_v=factor * vehicle.line_voltage_v)
    return changed(
        vehicle,
        traction=traction.model_copy(update=_at_lower_speed(traction, factor)),
        braking=braking.model_copy(update=_at_lower_speed(braking, factor)),
        drive=vehicle.drive.at_voltage(factor),
    )


def _at_lower_speed(limits: Traction | Braking, factor: float) -> dict[str, Any]:
    """Return the limits of effort of one direction that vary with speed, all at another speed by a factor."""
    power, curve, breakdown = limits.max_power_kw, limits.curve, limits.breakdown_speed_kmh
    return {
        "max_power_kw": None if power is None else factor * power,
        "curve": None if curve is None else tuple((factor * speed, effort) for speed, effort in curve),
        # beyond it the effort then falls with the square of the voltage, as the pull-out torque does
        "breakdown_speed_kmh": None if breakdown is None else factor * breakdown,
    }


def voltage_notes(vehicle: Vehicle) -> tuple[str, ...]:
    """Return in a sentence which efforts of a vehicle another line voltage leaves as they are, if there are any."""
    if vehicle.drive.knows_voltage:
        return ()
    traction, braking = vehicle.traction, vehicle.braking
    # what such a drive has instead of a voltage: a power or a curve that can be scaled
    untouched = []
    if traction.max_power_kw is None and traction.curve is None:
        untouched.append("tractive effort")
    if braking.max_power_kw is None and braking.curve is None and braking.max_effort_kn != 0:
        untouched.append("electric braking")
    if not untouched:
        return ()
    return (
        "This train's data give no line voltage and no power or curve of effort to scale with it: the "
        f"{' and the '.join(untouched)} stay{'s' if len(untouched) == 1 else ''} as at nominal voltage.",
    )


def notes_on(scenario: Scenario) -> tuple[str, ...]:
    """Return sentences on the parts of a disturbance that have no effect on the vehicle."""
    voltage = voltage_notes(scenario.vehicle) if scenario.disturbance.line_voltage_factor != 1 else ()
    return voltage if scenario.vehicle.max_jerk_ms3 is None else (*voltage, NO_JERK_LIMIT)
