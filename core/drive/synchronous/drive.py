"""The efficiency maps of a synchronous machine with its inverter, and the drive of a train."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray, frozen_array
from railjoule.core.drive.geared import BRAKING_SHARE, DRIVING_SHARE, MOTORS, TURNS
from railjoule.core.drive.loss_map import LossMap, MapDrive, map_fields
from railjoule.core.drive.synchronous.losses import (
    CONDUCTION,
    KINDS,
    MOTOR_KINDS,
    LossNumbers,
    Winding,
    fill_envelope,
    fill_points,
    side_bands,
)
from railjoule.core.drive.synchronous.machine import Machine
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.drive import Synchronous
from railjoule.core.units import H_PER_MH, M_PER_MM

LOSS_KINDS = ("copper", "iron", "mechanical", "harmonics", "conduction", "switching")
ACCOUNT_KINDS = (*LOSS_KINDS[:CONDUCTION], "inverter")
"""The kinds in the energy balance, in which the inverter's conduction and switching are one."""
# Of the shipped motor, a table four times as fine each way changes the power by 1e-6 in the median, by 0.4 % at worst.
TABLE_TORQUES, TABLE_SPEEDS = 36, 41
# just inside the envelope, where a search still finds the torque, and a little further in, for the slope of the losses
EDGE_SHARE, INNER_SHARE = 1 - 1e-6, 0.95


@dataclass(frozen=True, eq=False)
class EfficiencyMaps:
    """Efficiencies of one motor, and of it with its inverter; NaN beyond current or voltage.

    Parameters
    ----------
    torque_nm : array of shape (n,)
        Torques of the shaft [N m], negative in braking.
    speed_rads : array of shape (m,)
        Its speeds [rad/s].
    motor : array
        Output over input of the motor, shape (n, m); zero where it gives no power, or takes some to brake.
    drive : array of shape (n, m)
        Output over input of motor and inverter.
    losses_w : array of shape (n, m, 6)
        Losses by `LOSS_KINDS` [W].
    """

    torque_nm: FloatArray
    speed_rads: FloatArray
    motor: FloatArray
    drive: FloatArray
    losses_w: FloatArray


@dataclass(frozen=True, eq=False, kw_only=True)
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
        effort, head = np.asarray(effort_n, float), self.parameters
        gear = np.where(effort < 0, head[BRAKING_SHARE], head[DRIVING_SHARE])
        torque = effort * gear / (head[MOTORS] * head[TURNS])
        kinds, _ = _losses_w(self.machine, torque, head[TURNS] * np.asarray(speed_ms, float))
        # a machine at rest without friction, current or voltage loses nothing
        shares = kinds / np.maximum(kinds.sum(axis=-1, keepdims=True), np.finfo(float).tiny)
        parts = [*np.moveaxis(shares[..., :CONDUCTION], -1, 0), shares[..., CONDUCTION:].sum(axis=-1)]
        return {kind: whole * part for kind, part in zip(ACCOUNT_KINDS, parts, strict=True)} | losses


def efficiency_maps(parameters: Synchronous, torque_nm: FloatArray, speed_rads: FloatArray) -> EfficiencyMaps:
    """Return the efficiency maps of a motor and of it with its inverter, the gear not included.

    Parameters
    ----------
    parameters : Synchronous
    torque_nm : array of shape (n,)
        Torques of the shaft [N m]; negative brakes.
    speed_rads : array of shape (m,)
        Its speeds, none below 0 [rad/s].
    """
    torque, speed = np.asarray(torque_nm, dtype=float), np.asarray(speed_rads, dtype=float)
    losses, feasible = _losses_w(parameters, torque[:, None], speed)
    losses[~feasible] = np.nan
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
    saliency = machine.quadrature_inductance_h - machine.direct_inductance_h
    # both currents at their largest together, which no split of the current can be
    flux = machine.magnet_flux_vs + saliency * machine.max_current_a
    max_nm = 1.5 * machine.pole_pairs * flux * machine.max_current_a
    fill_envelope(machine, numbers, -1.0 if braking else 1.0, max_nm, speed, torque)
    return torque


@lru_cache(maxsize=8)
def make_synchronous(parameters: Synchronous) -> SynchronousDrive:
    """Return the drive with the loss map of its machine; cached.

    Raises
    ------
    ScenarioError
        If the machine has no torque left at its largest speed.
    """
    speed = np.linspace(0.0, parameters.max_speed_rads, TABLE_SPEEDS)
    most = torque_envelope(parameters, speed), torque_envelope(parameters, speed, braking=True)
    if most[0].min() <= 0:
        raise ScenarioError(
            f"drive.max_speed_rads = {parameters.max_speed_rads:g} must be below the speed at which the motor has no "
            "torque left."
        )
    driving, braking = (_loss_map(parameters, speed, *side) for side in zip(most, (1.0, -1.0), strict=True))
    return SynchronousDrive(**map_fields(parameters, driving, braking, speed, most), machine=parameters)


def _loss_map(parameters: Synchronous, speed: FloatArray, envelope: FloatArray, sign: float) -> LossMap:
    """Return the map of losses in one direction; beyond the envelope they are a straight line of torque squared.

    No run drives there, but the last piece of the table within the envelope reaches across it.
    """
    torque = np.linspace(0.0, envelope.max(), TABLE_TORQUES)
    # losses rise about with the square of the current, and so of the torque
    ends = envelope * np.array([[EDGE_SHARE], [INNER_SHARE]])
    edge, inner = _losses_w(parameters, sign * ends, speed)[0].sum(axis=-1)
    with np.errstate(invalid="ignore"):
        slope = np.maximum((edge - inner) / (ends[0] ** 2 - ends[1] ** 2), 0.0)
    beyond = torque[:, None] > ends[0]
    within = _losses_w(parameters, sign * torque[:, None], speed)[0].sum(axis=-1)
    return LossMap(torque, speed, np.where(beyond, edge + slope * (torque[:, None] ** 2 - ends[0] ** 2), within))


def _losses_w(parameters: Synchronous, torque_nm: FloatArray, speed_rads: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return the losses of a motor by `LOSS_KINDS` [W], shape (..., 6), and whether current and voltage allow them."""
    torque, speed = np.broadcast_arrays(torque_nm, speed_rads)
    losses, feasible = np.empty((torque.size, KINDS)), np.empty(torque.size, dtype=bool)
    fill_points(*_numbers(parameters), torque.ravel(), speed.ravel(), losses, feasible)
    return losses.reshape(*torque.shape, KINDS), feasible.reshape(torque.shape)


def output_over_input(shaft_w: FloatArray, loss_w: FloatArray) -> FloatArray:
    """Return output over input: driving, shaft over shaft and loss; braking, generated over shaft power.

    Parameters
    ----------
    shaft_w : array of shape (n, m)
        Power of the shaft [W]; negative brakes.
    loss_w : array of shape (n, m)
        Losses [W]; NaN where there is no such torque.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        driving = shaft_w / (shaft_w + loss_w)
        braking = np.maximum(-shaft_w - loss_w, 0.0) / -shaft_w
    known = np.where(shaft_w > 0, driving, np.where(shaft_w < 0, braking, 0.0))
    return np.where(np.isnan(loss_w), np.nan, known)


@lru_cache(maxsize=8)
def _numbers(parameters: Synchronous) -> tuple[Machine, LossNumbers, Winding, FloatArray]:
    """Return the arguments of the kernels.

    Harmonics meet both inductances in turn, so the squares of their currents are averaged.
    """
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
