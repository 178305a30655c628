"""Efficiency of a train's induction machine over torque and speed, and where in it a run in closed loop works."""

import numpy as np

from railjoule.core.arrays import frozen_array
from railjoule.core.drive.induction.traction import traction_machines
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.actual_vehicle import actual_vehicle
from railjoule.core.simulation.field_oriented import FieldOrientedRun
from railjoule.core.studies.motor_map import SPEEDS, TORQUES, MotorMap, OperatingPoints
from railjoule.core.units import MS_PER_KMH


def induction_map(scenario: Scenario) -> MotorMap:
    """Return the efficiency of one machine up to the vehicle's largest speed, with the flux of its `[simulation]`.

    Not a number where current or voltage do not carry a torque; inverter and gear are not included.

    Raises
    ------
    ScenarioError
        If its drive has no induction machine.
    """
    # with the line voltage of the disturbance, which limits what the machines can do
    vehicle = actual_vehicle(scenario).vehicle
    machines = traction_machines(vehicle.drive)
    speed = np.linspace(0.0, vehicle.traction.max_speed_kmh * MS_PER_KMH * machines.turns_per_metre, SPEEDS)
    most = float(machines.greatest_torque_nm(speed).max())
    # at full voltage a machine generates with more torque than it drives with, as the drop across its stator then
    # helps
    least = -float(machines.greatest_torque_nm(speed, braking=True).max())
    torque = np.linspace(least, most, TORQUES)
    efficiency = machines.efficiency(torque, speed, scenario.simulation.flux == "least_loss")
    return MotorMap(frozen_array(torque), frozen_array(speed), frozen_array(efficiency), None)


def machine_points(run: FieldOrientedRun) -> OperatingPoints:
    """Return torque of the shaft and speed of one machine at the samples of a run at which the train moves."""
    machines = run.machines
    moving = run.speed_ms > 0
    # the map is over the torque of the shaft, so the friction of the motor comes off the electromagnetic one
    torque = run.torque_nm[moving] - machines.machine.mechanical_loss_torque_nm
    return OperatingPoints(frozen_array(torque), frozen_array(run.speed_ms[moving] * machines.turns_per_metre))
