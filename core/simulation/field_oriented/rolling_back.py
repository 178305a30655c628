"""Why a train rolls back for good: on a gradient that its machines do not hold; no brake is part of the loop."""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.induction.machine import torque_constant
from railjoule.core.drive.induction.traction import TractionMachines
from railjoule.core.motion import Course
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.drive import Induction
from railjoule.core.units import N_PER_KN

ROLLED_BACK_M = 0.01
"""Rolling back by less is how the last samples approach the end [m]."""


def starting_effort_n(machines: TractionMachines) -> float:
    """Return the force of all machines at the wheels of a standing train [N], at their rated flux."""
    flux_current = machines.machine.magnetising_current_a
    torque_current = math.sqrt(max(machines.driving_current_a**2 - flux_current**2, 0.0))
    torque = torque_constant(machines.machine) * flux_current * torque_current
    return _force_per_torque(machines) * (torque - machines.machine.mechanical_loss_torque_nm)


def starting_current_a(machines: TractionMachines, effort_n: float) -> float:
    """Return the current that gives a standing train an effort [A], at their rated flux."""
    flux_current = machines.machine.magnetising_current_a
    torque = effort_n / _force_per_torque(machines) + machines.machine.mechanical_loss_torque_nm
    return math.hypot(flux_current, torque / (torque_constant(machines.machine) * flux_current))


def stranded_sentence(scenario: Scenario, machines: TractionMachines, course: Course, position_m: FloatArray) -> str:
    """Return why a train rolls back, or stands, and what would let it start there; empty where its effort is enough.

    Parameters
    ----------
    scenario : Scenario
        The simulated scenario.
    machines, course : TractionMachines, Course
        Those that the train really has.
    position_m : array of shape (n,)
        Positions of the train [m].
    """
    place = max(float(np.max(position_m)), 0.0)
    rolls_back = place - position_m[-1] > ROLLED_BACK_M
    cell = int(np.clip(np.searchsorted(course.position_m, place, side="right") - 1, 0, course.cell_count - 1))
    needed = float(course.gradient_force_n[cell] + course.curve_force_n[cell]) + course.data.resistance_constant_n
    effort, amperes = starting_effort_n(machines), machines.driving_current_a
    if effort >= needed and not rolls_back:
        return ""
    key = "starting_current_a" if isinstance(scenario.vehicle.drive, Induction) else "machine.max_current_a"
    limit = (
        f"with {amperes:g} A and {machines.machine.max_phase_voltage_v:g} V its machines do not hold it."
        if effort >= needed
        else f"with drive.{key} = {amperes:g} its machines pull with {effort / N_PER_KN:.1f} kN at most. Use more than "
        f"{math.ceil(starting_current_a(machines, needed))} A, or a lighter train."
    )
    return (
        f"At {place:.0f} m, on a gradient of {course.gradient_permille[cell]:.4g} per mille, the train "
        f"{'rolls back' if rolls_back else 'comes to a stand'}: to start there takes {needed / N_PER_KN:.1f} kN, and "
        f"{limit}"
    )


def _force_per_torque(machines: TractionMachines) -> float:
    """Return the force at the wheels over the torque of each shaft [1/m], in driving."""
    return machines.motors * machines.turns_per_metre * machines.gear_efficiency
