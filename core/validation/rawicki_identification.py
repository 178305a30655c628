"""Identify the numbers of Rawicki's tram that are not printed, from 24 of phases and four of the nameplate.

Free are eleven numbers; stator and rotor inductance are taken as equal. Each printed phase is driven with a trial tram
from its first printed speed to its last: the start at full current, braking at full braking current, the cruise for its
printed time. Sought is the least sum of squares of relative differences. Of the nameplate, voltage, current, power
and power factor at rated flux and slip count with half the weight of the phases, as they do not fit together better
than to one percent; its efficiency is printed as '90,6.8%' and left out.
"""

import math
from dataclasses import dataclass
from functools import reduce
from operator import getitem
from typing import Any

import numpy as np
from scipy.optimize import least_squares

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.drive import make_drive
from railjoule.core.drive.induction.machine import make_machine, phase_voltage_v, steady_state
from railjoule.core.phase_planning.planner import PhasePlanner
from railjoule.core.phase_planning.search import between
from railjoule.core.phase_planning.tables import PhaseModel
from railjoule.core.scenario import Vehicle
from railjoule.core.scenario.options import PhasesOptions
from railjoule.core.studies.flux_sweep import power_factor
from railjoule.core.units import J_PER_KWH, MS_PER_KMH, W_PER_KW

# The nameplate contradicts itself by a per cent, the phases only by their last digits: it must not pull them off what
# is printed, and without it the inductances would be free.
NAMEPLATE_WEIGHT = 0.5
# one direction is all but flat: steps must be far above rounding, and derivatives of second order
LEAST_SQUARES_OPTIONS = {"ftol": 1e-13, "xtol": 1e-13, "gtol": 1e-13, "jac": "3-point", "diff_step": 1e-4}
# round numbers of a tram of that size, so that nothing of the result is put in by hand
FIRST_GUESS = {
    "rotating_mass_factor": 0.15,
    "resistance.constant_n": 1500.0,
    "resistance.quadratic_n_per_kmh2": 0.55,
    "drive.mechanical_loss_torque_nm": 4.0,
    "drive.stator_resistance_ohm": 0.1,
    "drive.rotor_resistance_ohm": 0.1,
    "drive.stator_inductance_mh": 30.0,
    "drive.mutual_inductance_mh": 29.4,
    "drive.rated_magnetising_current_a": 25.0,
    "drive.starting_current_a": 200.0,
    "drive.braking_current_a": 150.0,
}
"""The free numbers, by their keys in a vehicle file, and round values to begin with."""

Printed = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Identification:
    """The numbers that fit the printed ones best; p parameters.

    Parameters
    ----------
    names : tuple of str
        Keys of the parameters in a vehicle file.
    values : array of shape (p,)
        Their values, each in its key's unit.
    covariance : array of shape (p, p)
        Of their relative errors, if the differences that stay were independent errors of the printed numbers.
    """

    names: tuple[str, ...]
    values: FloatArray
    covariance: FloatArray

    def uncertainty_percent(self, *names: str) -> float:
        """Return the standard error of a parameter, or of the product of several."""
        sum_of = np.isin(self.names, names).astype(float)
        return 100 * float(np.sqrt(sum_of @ self.covariance @ sum_of))


def identify(base: Vehicle, paper: Printed) -> Identification:
    """Return the numbers that a vehicle must have to drive the printed phases.

    Parameters
    ----------
    base : Vehicle
        With the printed and chosen numbers; its free numbers do not matter.
    paper : dict
        The printed numbers.
    """
    names, guess = tuple(FIRST_GUESS), np.array(list(FIRST_GUESS.values()))
    phases, plate = paper["phase"], paper["nameplate"]
    printed = np.concatenate([printed_values(phases), nameplate_values(plate)])
    # the last four are those of the nameplate
    weights = np.where(np.arange(len(printed)) < len(printed) - 4, 1.0, NAMEPLATE_WEIGHT)

    def differences(factors: FloatArray) -> FloatArray:
        vehicle = with_numbers(base, dict(zip(names, (factors * guess).tolist(), strict=True)))
        computed = np.concatenate([driven_values(vehicle, phases), machine_values(vehicle, plate)])
        percent: FloatArray = 100 * (computed / printed - 1)
        return weights * percent

    # in factors of the first guess, as the parameters span from 0.1 ohm to 1500 N; x_scale is the size of a first step
    fit = least_squares(differences, np.ones(len(guess)), x_scale=0.05, **LEAST_SQUARES_OPTIONS)
    freedom = len(printed) - len(guess)
    # s^2 (J^T J)^-1 with s^2 = 2 cost / freedom, of the factors; divided by them on return, that of relative errors
    covariance = np.linalg.inv(fit.jac.T @ fit.jac) * (2 * fit.cost / freedom)
    return Identification(
        names=names,
        values=frozen_array(fit.x * guess),
        covariance=frozen_array(covariance / np.outer(fit.x, fit.x)),
    )


def with_numbers(base: Vehicle, numbers: dict[str, float]) -> Vehicle:
    """Return a vehicle with other values for keys of its file; the rotor's inductance follows the stator's."""
    document = base.model_dump(exclude_none=True)
    for key, value in numbers.items():
        *tables, last = key.split(".")
        reduce(getitem, tables, document)[last] = value
    # at the terminals only M^2 / Lr and Rr / Lr show, so with both free the fit would have no single minimum
    document["drive"]["rotor_inductance_mh"] = document["drive"]["stator_inductance_mh"]
    return Vehicle.model_validate(document)


def printed_values(phases: list[Printed]) -> FloatArray:
    """Return the printed numbers of phases, in the order of `driven_values`."""
    return np.array([phase[name] for phase in phases for name in value_names(phase)])


def value_names(phase: Printed) -> tuple[str, ...]:
    """Return which of a phase's numbers count."""
    names = () if phase["phase"] == "cruise" else ("distance_m", "duration_s")
    return (*names, "energy_kwh") if "energy_kwh" in phase else names


def driven_values(vehicle: Vehicle, phases: list[Printed]) -> FloatArray:
    """Return distances [m], times [s] and energies [kWh] of phases with a recuperation factor of 1."""
    planner = printed_planner(vehicle, 1.0)
    model = planner.model
    tables = {"start": model.table("start"), "coast": model.coasting, "brake": model.braking}
    values: list[float] = []
    for phase in phases:
        low, high = sorted((float(phase["start_ms"]), float(phase["end_ms"])))
        if phase["phase"] == "cruise":
            numbers = 0.0, 0.0, planner.cruise_power_w(high) * phase["duration_s"]
        else:
            numbers = between(tables[phase["phase"]], low, high)
        named = dict(zip(("duration_s", "distance_m", "energy_kwh"), numbers, strict=True))
        named["energy_kwh"] /= J_PER_KWH
        values += [named[name] for name in value_names(phase)]
    return np.array(values)


def printed_planner(vehicle: Vehicle, recuperation_factor: float, **options: Any) -> PhasePlanner:
    """Return the planner of a vehicle on level track whose starts hold their current, as printed."""
    drive = vehicle.drive.model_copy(update={"recuperation_factor": recuperation_factor})
    # not validated again: the values come from a vehicle and a factor of 0 or 1
    changed = vehicle.model_copy(update={"drive": drive})
    top_speed = vehicle.traction.max_speed_kmh * MS_PER_KMH
    return PhasePlanner(PhaseModel(changed, make_drive(drive), 0.0, top_speed, True), PhasesOptions(**options))


def nameplate_values(plate: Printed) -> FloatArray:
    """Return amplitudes of voltage [V] and current [A] of a phase, power [W] and power factor of a nameplate."""
    return np.array(
        [
            plate["voltage_v"] * math.sqrt(2 / 3),
            plate["current_a"] * math.sqrt(2),
            W_PER_KW * plate["power_kw"],
            plate["power_factor"],
        ]
    )


def machine_values(vehicle: Vehicle, plate: Printed) -> FloatArray:
    """Return the same of a vehicle's motor at rated flux, frequency and speed."""
    machine = make_machine(make_drive(vehicle.drive).parameters)
    shaft_rads = plate["speed_rpm"] * 2 * math.pi / 60
    rotor_rads = machine.pole_pairs * shaft_rads
    slip = 2 * math.pi * plate["frequency_hz"] - rotor_rads
    flux_current = machine.magnetising_current_a
    torque_current = slip * machine.rotor_inductance_h / machine.rotor_resistance_ohm * flux_current
    state = steady_state(machine, flux_current, torque_current, rotor_rads)
    voltage, current = phase_voltage_v(state), math.hypot(flux_current, torque_current)
    power = (state.torque_nm - machine.mechanical_loss_torque_nm) * shaft_rads
    return np.array([voltage, current, power, power_factor(state, flux_current, torque_current)])
