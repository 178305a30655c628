"""The run in closed loop as a trajectory: over distance, in cells between its samples, with its account of energy."""

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.drive.induction.traction import TractionMachines
from railjoule.core.drive.line_power import line_power, resistor_power
from railjoule.core.energy import Energy
from railjoule.core.line_current import line_current_a
from railjoule.core.motion import Course
from railjoule.core.physics.course_data import CourseData
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.field_oriented import states as column
from railjoule.core.simulation.field_oriented.plant import CREEP_MS
from railjoule.core.simulation.field_oriented.record import Record
from railjoule.core.trajectory import Trajectory

# Efforts are read off the vehicle's limits at no less than this speed, where a cell has no length.
SLOWEST_MS = 1e-3


def driven_trajectory(
    real: Scenario, strategy: str, course: Course, machines: TractionMachines, record: Record
) -> Trajectory:
    """Return the run as a trajectory.

    A trajectory goes over distance, so it cannot go back: a train that rolls back is drawn as standing where it was
    farthest until it is there again. Times and energies are those of the run, and a note of the run says so.

    Parameters
    ----------
    real : Scenario
        With the vehicle as it is.
    strategy : str
        That of the plan.
    course : Course
        The track under it.
    machines, record : TractionMachines, Record
        The machines as they are, and what they did.
    """
    data, states = course.data, record.states
    time = record.time_s - record.time_s[0]
    position = np.maximum.accumulate(record.position_m)
    middle, duration = 0.5 * (position[1:] + position[:-1]), np.diff(time)
    mean_speed = np.maximum(np.diff(position) / duration, SLOWEST_MS)
    force = _wheel_force_n(machines, record)
    effort = 0.5 * (force[1:] + force[:-1])
    line = states[:, column.DRAWN] - _recuperated_j(data, record) + data.auxiliary_power_w * time
    cell = np.clip(np.searchsorted(course.position_m, middle, side="right") - 1, 0, course.cell_count - 1)
    current_q = record.state(column.CURRENT_Q)
    power_w = np.diff(line) / duration
    return Trajectory(
        scenario=real,
        strategy=strategy,
        position_m=frozen_array(position),
        speed_ms=frozen_array(np.maximum(record.state(column.SPEED), 0.0)),
        time_s=frozen_array(time),
        line_energy_j=frozen_array(line),
        tractive_effort_n=frozen_array(np.maximum(effort, 0.0)),
        electric_braking_n=frozen_array(np.maximum(-effort, 0.0)),
        friction_braking_n=frozen_array(np.zeros_like(effort)),
        largest_effort_n=frozen_array(data.traction.effort_n(mean_speed)),
        largest_braking_n=frozen_array(data.braking.effort_n(mean_speed) + data.friction_effort_n),
        line_power_w=frozen_array(power_w),
        current_a=frozen_array(0.5 * (current_q[1:] + current_q[:-1])),
        gradient_permille=frozen_array(course.gradient_permille[cell]),
        energy=_energy(data, machines, record),
        line_current_a=line_current_a(power_w, real.vehicle.line_voltage_v),
    )


def _wheel_force_n(machines: TractionMachines, record: Record) -> FloatArray:
    """Return the force of all machines at the wheels at each sample [N]; as the integration has it, for arrays."""
    direction = np.clip(record.state(column.SPEED) / CREEP_MS, -1, 1)
    torque = record.outputs[:, column.TORQUE] - machines.machine.mechanical_loss_torque_nm * direction
    gear = np.where(torque > 0, machines.gear_efficiency, 1 / machines.gear_efficiency)
    force: FloatArray = machines.motors * machines.turns_per_metre * torque * gear
    return force


def _recuperated_j(data: CourseData, record: Record) -> FloatArray:
    """Return what the supply has taken back so far [J].

    The rule of recuperation is linear on either side of zero, and the kernel integrates generated power apart from
    drawn, so it may be asked for the integral.
    """
    recuperated: FloatArray = -line_power(-record.state(column.RETURNED), data.recuperation_factor)
    return recuperated


def _energy(data: CourseData, machines: TractionMachines, record: Record) -> Energy:
    """Return the account of the whole run."""
    final, speed = record.final, record.state(column.SPEED)
    return Energy(
        traction_j=final(column.DRAWN),
        recuperated_j=float(_recuperated_j(data, record)[-1]),
        auxiliary_j=data.auxiliary_power_w * float(record.time_s[-1] - record.time_s[0]),
        running_resistance_j=final(column.RUNNING),
        curve_resistance_j=final(column.CURVE),
        losses_j={
            "copper": final(column.STATOR) + final(column.ROTOR),
            "magnetising": final(column.MAGNETISING),
            "iron": final(column.IRON),
            "mechanical": final(column.MECHANICAL),
            "gear": final(column.GEAR),
            "brake_resistors": float(resistor_power(-final(column.RETURNED), data.recuperation_factor)),
        },
        kinetic_j=float(data.half_inertia_kg * (speed[-1] ** 2 - speed[0] ** 2)),
        potential_j=final(column.CLIMB),
        magnetic_field_j=float(record.field_energy_j(machines)[-1]),
    )
