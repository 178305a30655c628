"""Efficiency over torque and speed of one motor, and its operating points in a run.

A gear that loses a share g of the power at the wheels makes the shaft carry F v (1 + g) in driving and F v (1 - g) in
braking, over all motors.

Source: Shtompel, Khvorost 2025, Figure 1 and (8)-(12), with the sign of the gear's loss in braking corrected.
"""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compilation import require_compiled
from railjoule.core.drive import make_drive
from railjoule.core.drive.geared import turns_per_metre
from railjoule.core.drive.induction.traction import traction_machines
from railjoule.core.drive.synchronous.drive import efficiency_maps, output_over_input, torque_envelope
from railjoule.core.errors import ScenarioError
from railjoule.core.motion import build_meshed_line
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.drive import GearedMotors, Synchronous
from railjoule.core.simulation.actual_vehicle import actual_vehicle
from railjoule.core.simulation.field_oriented import FieldOrientedRun
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import MS_PER_KMH

# odd, so that a map with equal ends has a line at no torque; finer ones look the same on a screen
TORQUES, SPEEDS = 121, 96
"""Of a map, braking and driving together."""
# power over speed is infinite at standstill, where the limits of effort and not of power hold
SLOWEST_SHARE = 1e-3
"""The slowest speed of efforts that are limited by power, over the greatest."""
ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class MotorMap:
    """Efficiencies over torque and speed of one motor; NaN where there is no such torque.

    Parameters
    ----------
    torque_nm : array of shape (n,)
        Torques of the shaft, rising [N m]; negative brakes.
    speed_rads : array of shape (m,)
        Its speeds, rising from 0 [rad/s].
    drive : array of shape (n, m)
        Of motor and inverter; only of the motor in a map of an induction machine.
    motor : array of shape (n, m), optional
        Only of the motor, where the model of the drive separates it.
    """

    torque_nm: FloatArray
    speed_rads: FloatArray
    drive: FloatArray
    motor: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class OperatingPoints:
    """Torques of the shaft of one motor [N m], negative where it brakes, and its speeds [rad/s]; both of shape (k,)."""

    torque_nm: FloatArray
    speed_rads: FloatArray


def motor_map(scenario: Scenario) -> MotorMap:
    """Return the efficiency map of a scenario's drive, the gear not included.

    Raises
    ------
    ScenarioError
        If its drive has no losses over torque and speed of a motor.
    """
    drive = _geared(scenario)
    require_compiled()
    top_rads = scenario.vehicle.traction.max_speed_kmh * MS_PER_KMH * turns_per_metre(drive)
    if not isinstance(drive, Synchronous):
        return _map_of_losses(scenario, drive, np.linspace(0.0, top_rads, SPEEDS))
    speed = np.linspace(0.0, min(top_rads, drive.max_speed_rads), SPEEDS)
    most, least = torque_envelope(drive, speed).max(), -torque_envelope(drive, speed, braking=True).max()
    maps = efficiency_maps(drive, np.linspace(least, most, TORQUES), speed)
    return MotorMap(maps.torque_nm, maps.speed_rads, maps.drive, maps.motor)


def operating_points(run: Trajectory) -> OperatingPoints:
    """Return the operating points of one motor in the cells of a run, at their mean speeds; errors as `motor_map`."""
    drive = _geared(run.scenario)
    duration, length = np.diff(run.time_s), np.diff(run.position_m)
    speed = np.divide(length, duration, out=np.zeros_like(duration), where=duration > 0)
    effort = run.tractive_effort_n - run.electric_braking_n
    # a drive that is off and a train at a station have no point in the map
    on = (effort != 0) & (speed > 0)
    torque = effort[on] / _effort_over_torque(drive, effort[on])
    return OperatingPoints(frozen_array(torque), frozen_array(speed[on] * turns_per_metre(drive)))


def induction_map(scenario: Scenario) -> MotorMap:
    """Return the efficiency of one machine up to the vehicle's largest speed, with the flux of `[simulation]`.

    NaN beyond current or voltage; inverter and gear are not included.

    Raises
    ------
    ScenarioError
        If its drive has no induction machine.
    """
    # with the supply voltage of the disturbance, which limits the machines
    vehicle = actual_vehicle(scenario).vehicle
    machines = traction_machines(vehicle.drive)
    speed = np.linspace(0.0, vehicle.traction.max_speed_kmh * MS_PER_KMH * machines.turns_per_metre, SPEEDS)
    # At full voltage a machine generates with more torque than it drives with: the drop across its stator then helps.
    most, least = (float(machines.max_torque_nm(speed, braking).max()) for braking in (False, True))
    torque = np.linspace(-least, most, TORQUES)
    efficiency = machines.efficiency(torque, speed, scenario.simulation.flux == "min_loss")
    return MotorMap(frozen_array(torque), frozen_array(speed), frozen_array(efficiency))


def machine_points(run: FieldOrientedRun) -> OperatingPoints:
    """Return torque of the shaft and speed of one machine at the samples of a run at which the train moves."""
    machines, moving = run.machines, run.speed_ms > 0
    # the map is over the torque of the shaft, so the friction of the motor is subtracted from the electromagnetic one
    torque = run.torque_nm[moving] - machines.machine.mechanical_loss_torque_nm
    return OperatingPoints(frozen_array(torque), frozen_array(run.speed_ms[moving] * machines.turns_per_metre))


def _geared(scenario: Scenario) -> GearedMotors:
    drive = scenario.vehicle.drive
    if not isinstance(drive, GearedMotors):
        raise ScenarioError(
            "This train's data have no losses over torque and speed of a motor, so there is no efficiency map."
        )
    return drive


def _map_of_losses(scenario: Scenario, parameters: GearedMotors, speed_rads: FloatArray) -> MotorMap:
    """Return the map of a drive with given losses of all motors, within the limits of the vehicle's effort."""
    drive, mesh = make_drive(parameters), build_meshed_line(scenario).data
    speed_ms = speed_rads / turns_per_metre(parameters)
    limit_speed_ms = np.maximum(speed_ms, SLOWEST_SHARE * speed_ms[-1])
    driving, braking = mesh.traction.effort_n(limit_speed_ms), mesh.braking.effort_n(limit_speed_ms)
    ends = np.array([-braking.max(), driving.max()])
    least, most = (ends / _effort_over_torque(parameters, ends)).tolist()
    torque = np.linspace(least, most, TORQUES)
    effort = (torque * _effort_over_torque(parameters, torque))[:, None]
    # at the ends of the map the effort is its own limit, which rounding may put on either side
    possible = (effort <= driving * (1 + ROUNDING)) & (effort >= -braking * (1 + ROUNDING))
    # some drives have no values beyond their limits: those points are computed at no effort and left out
    power = drive.electrical_power_w(np.where(possible, effort, 0.0), np.broadcast_to(speed_ms, possible.shape))
    shaft = torque[:, None] * speed_rads[None, :]
    loss = np.where(possible, power / parameters.motors - shaft, np.nan)
    return MotorMap(frozen_array(torque), frozen_array(speed_rads), frozen_array(output_over_input(shaft, loss)))


def _effort_over_torque(drive: GearedMotors, sign: FloatArray) -> FloatArray:
    """Return effort of the train over torque of one motor [N/(N m)]; negative signs brake."""
    shaft_over_wheel = np.where(sign < 0, 1 - drive.gear_loss_share, 1 + drive.gear_loss_share)
    return drive.motors * turns_per_metre(drive) / shaft_over_wheel
