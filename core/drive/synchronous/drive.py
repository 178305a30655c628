"""From the numbers of a synchronous machine and its inverter to maps of efficiency, and to the drive of a train."""

import math
from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.drive.geared_parameters import turns_per_metre
from railjoule.core.drive.loss_map.drive import LossMap, MapDrive, make_map_drive
from railjoule.core.drive.synchronous.harmonics import Winding, side_bands
from railjoule.core.drive.synchronous.losses import (
    CONDUCTION,
    KINDS,
    MOTOR_KINDS,
    LossNumbers,
    fill_envelope,
    fill_map,
    fill_points,
)
from railjoule.core.drive.synchronous.machine import Machine
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.drive import Synchronous
from railjoule.core.units import H_PER_MH, M_PER_MM

LOSS_KINDS = ("copper", "iron", "mechanical", "harmonics", "conduction", "switching")
ACCOUNT_KINDS = (*LOSS_KINDS[:CONDUCTION], "inverter")
"""The same in the energy account, where the inverter's conduction and switching are one kind."""
# Of the shipped motor, a table four times as fine each way changes the power by 1e-6 in the median, by 0.4 % at worst.
TABLE_TORQUES, TABLE_SPEEDS = 36, 41
# just inside the envelope, where a search still finds the torque, and a little further in, for the slope of the losses
EDGE_SHARE, INNER_SHARE = 1 - 1e-6, 0.95


@dataclass(frozen=True, eq=False)
class EfficiencyMaps:
    """Efficiencies of one motor, and of it with its inverter; not a number where they have no such torque.

    Parameters
    ----------
    torque_nm : array of shape (n,)
        Torques of the shaft [N m]; negative brakes.
    speed_rads : array of shape (m,)
        Its speeds [rad/s].
    motor, drive : array of shape (n, m)
        Output over input; zero where the motor gives no power, or takes some to brake.
    losses_w : array of shape (n, m, 6)
        Losses [W] by `LOSS_KINDS`.
    """

    torque_nm: FloatArray
    speed_rads: FloatArray
    motor: FloatArray
    drive: FloatArray
    losses_w: FloatArray


@dataclass(frozen=True, eq=False)
class SynchronousDrive(MapDrive):
    """A drive that divides the losses of its motors and inverters into kinds.

    Parameters
    ----------
    machine : Synchronous
        One of its motors with its inverter.
    """

    machine: Synchronous

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> dict[str, FloatArray]:
        """Return the losses by kind [W]: of motors, their inverters, gears, and brake resistors.

        The table of the drive has the sum of the kinds of motor and inverter; their shares are those of the formulas.
        """
        losses = super().losses_w(effort_n, speed_ms)
        whole = losses.pop(self.loss_kind)
        shares = self._loss_shares(*np.broadcast_arrays(np.asarray(effort_n, float), np.asarray(speed_ms, float)))
        parts = [*shares[:CONDUCTION], shares[CONDUCTION:].sum(axis=0)]
        kinds = {kind: whole * part for kind, part in zip(ACCOUNT_KINDS, parts, strict=True)}
        return kinds | losses

    def _loss_shares(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the share of each kind of `LOSS_KINDS` in the losses of motor and inverter; shape (6, ...)."""
        turns = turns_per_metre(self.machine)
        gear = np.where(effort_n < 0, 1 - self.gear_loss_share, 1 + self.gear_loss_share)
        torque = effort_n * gear / (self.machine.motors * turns)
        losses = np.empty((effort_n.size, KINDS))
        fill_points(*_numbers(self.machine), torque.ravel(), (turns * speed_ms).ravel(), losses)
        # a machine at rest without friction, current or voltage loses nothing
        total = np.maximum(losses.sum(axis=1, keepdims=True), np.finfo(float).tiny)
        return np.moveaxis((losses / total).reshape(*effort_n.shape, KINDS), -1, 0)


def efficiency_maps(parameters: Synchronous, torque_nm: FloatArray, speed_rads: FloatArray) -> EfficiencyMaps:
    """Return the efficiency maps of a motor and of its drive, the gear not included.

    Parameters
    ----------
    parameters : Synchronous
    torque_nm : array of shape (n,)
        Torques of the shaft [N m]; negative brakes.
    speed_rads : array of shape (m,)
        Its speeds, none below 0 [rad/s].
    """
    torque, speed = np.asarray(torque_nm, dtype=float), np.asarray(speed_rads, dtype=float)
    losses = np.empty((len(torque), len(speed), KINDS))
    fill_map(*_numbers(parameters), torque, speed, losses)
    shaft = torque[:, None] * speed[None, :]
    return EfficiencyMaps(
        torque_nm=frozen_array(torque),
        speed_rads=frozen_array(speed),
        motor=frozen_array(output_over_input(shaft, losses[..., :MOTOR_KINDS].sum(axis=-1))),
        drive=frozen_array(output_over_input(shaft, losses.sum(axis=-1))),
        losses_w=frozen_array(losses),
    )


def torque_envelope(parameters: Synchronous, speed_rads: FloatArray, braking: bool = False) -> FloatArray:
    """Return the greatest torques of the shaft [N m], without sign, at speeds [rad/s]; shape (m,)."""
    machine, numbers, *_ = _numbers(parameters)
    speed = np.asarray(speed_rads, dtype=float)
    torque = np.empty(len(speed))
    fill_envelope(machine, numbers, -1.0 if braking else 1.0, _most_nm(machine), speed, torque)
    return torque


@lru_cache(maxsize=8)
def make_synchronous_drive(parameters: Synchronous) -> SynchronousDrive:
    """Return the drive that uses the map of its machine; kept for the next call.

    Raises
    ------
    ScenarioError
        If the machine has no torque left at its largest speed.
    """
    speed = np.linspace(0.0, parameters.max_speed_rads, TABLE_SPEEDS)
    envelopes = torque_envelope(parameters, speed), torque_envelope(parameters, speed, braking=True)
    if envelopes[0].min() <= 0:
        raise ScenarioError(
            f"drive.max_speed_rads = {parameters.max_speed_rads:g} must be below the speed at which the motor has no "
            "torque left."
        )
    driving, braking = (
        _loss_map(parameters, speed, envelope, sign) for envelope, sign in zip(envelopes, (1.0, -1.0), strict=True)
    )
    drive = make_map_drive(
        driving,
        braking,
        parameters.motors,
        turns_per_metre(parameters),
        parameters.gear_loss_share,
        parameters.recuperation_factor,
        envelopes,
    )
    return SynchronousDrive(**{field.name: getattr(drive, field.name) for field in fields(drive)}, machine=parameters)


def _loss_map(parameters: Synchronous, speed: FloatArray, envelope: FloatArray, sign: float) -> LossMap:
    """Return the map of losses in one direction; beyond the envelope they go on in a straight line of torque squared.

    Nobody drives there, but the last piece of the table within the envelope reaches across it.
    """
    torque = np.linspace(0.0, envelope.max(), TABLE_TORQUES)
    losses = np.empty((len(torque), len(speed), KINDS))
    fill_map(*_numbers(parameters), sign * torque, speed, losses)
    loss = losses.sum(axis=-1)
    edge, inner = np.empty((1, 1, KINDS)), np.empty((1, 1, KINDS))
    for j, most in enumerate(envelope):
        beyond = torque > most * EDGE_SHARE
        if not beyond.any():
            continue
        two = most * np.array([EDGE_SHARE, INNER_SHARE])
        for place, values in zip(two, (edge, inner), strict=True):
            fill_map(*_numbers(parameters), sign * np.array([place]), speed[j : j + 1], values)
        # losses rise about with the square of the current, and so of the torque
        slope = (edge.sum() - inner.sum()) / (two[0] ** 2 - two[1] ** 2)
        loss[beyond, j] = edge.sum() + max(slope, 0.0) * (torque[beyond] ** 2 - two[0] ** 2)
    return LossMap(torque, speed, loss)


def output_over_input(shaft_w: FloatArray, loss_w: FloatArray) -> FloatArray:
    """Return output over input: driving, shaft over shaft and loss; braking, what is generated over the shaft's.

    Parameters
    ----------
    shaft_w : array of shape (n, m)
        Power of the shaft [W]; negative brakes.
    loss_w : array of shape (n, m)
        What is lost there [W]; not a number where there is no such torque.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        driving = shaft_w / (shaft_w + loss_w)
        braking = np.maximum(-shaft_w - loss_w, 0.0) / -shaft_w
    known = np.where(shaft_w > 0, driving, np.where(shaft_w < 0, braking, 0.0))
    return np.where(np.isnan(loss_w), np.nan, known)


def _most_nm(machine: Machine) -> float:
    """Return a torque that the current cannot exceed [N m]."""
    saliency = machine.quadrature_inductance_h - machine.direct_inductance_h
    # each current at its largest at once, which no split of it can be
    flux = machine.magnet_flux_vs + saliency * machine.max_current_a
    return 1.5 * machine.pole_pairs * flux * machine.max_current_a


@lru_cache(maxsize=8)
def _numbers(parameters: Synchronous) -> tuple[Machine, LossNumbers, Winding, FloatArray]:
    """Return what the kernels take; harmonics meet both inductances in turn: squares of their currents are averaged."""
    direct, quadrature = parameters.direct_inductance_mh * H_PER_MH, parameters.quadrature_inductance_mh * H_PER_MH
    blocks = parameters.modulation == "six_step"
    machine = Machine(
        pole_pairs=float(parameters.pole_pairs),
        magnet_flux_vs=parameters.magnet_flux_vs,
        direct_inductance_h=direct,
        quadrature_inductance_h=quadrature,
        stator_resistance_ohm=parameters.stator_resistance_ohm,
        max_current_a=parameters.max_current_a,
        # amplitude of the fundamental: 2 / pi of the link in whole blocks, 1 / sqrt(3) of it by space vectors
        max_phase_voltage_v=parameters.link_voltage_v * (2 / math.pi if blocks else 1 / math.sqrt(3)),
    )
    numbers = LossNumbers(
        rated_rads=2 * math.pi * parameters.rated_frequency_hz,
        rated_flux_vs=parameters.rated_flux_vs,
        hysteresis_loss_w=parameters.hysteresis_loss_w,
        eddy_loss_w=parameters.eddy_loss_w,
        mechanical_loss_torque_nm=parameters.mechanical_loss_torque_nm,
        ventilation_loss_w_per_rads3=parameters.ventilation_loss_w_per_rads3,
        link_voltage_v=parameters.link_voltage_v,
        switching_frequency_hz=parameters.switching_frequency_hz,
        device_threshold_v=parameters.device_threshold_v,
        device_resistance_ohm=parameters.device_resistance_ohm,
        switching_energy_j_per_av=parameters.switching_energy_j
        / (parameters.switching_current_a * parameters.switching_voltage_v),
    )
    winding = Winding(
        stator_resistance_ohm=parameters.stator_resistance_ohm,
        # currents go as 1 / L, losses as their square: the mean of both 1 / L^2; an infinite L lets no harmonic pass
        harmonic_inductance_h=math.sqrt(2 / (direct**-2 + quadrature**-2)) if parameters.harmonic_losses else math.inf,
        conductor_height_m=parameters.conductor_height_mm * M_PER_MM,
        conductor_layers=float(parameters.conductor_layers),
    )
    return machine, numbers, winding, side_bands()
