"""The drive of a train with induction machines, for arrays of effort and speed."""

import math
from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compiled import njit
from railjoule.core.drive.drive import Drive
from railjoule.core.drive.induction.limits import corner_speed, fill_efforts, fill_full_current
from railjoule.core.drive.induction.power import (
    GEAR,
    MECHANICAL_LOSS,
    MOTORS,
    NEGLIGIBLE,
    TURNS,
    idle_power,
    operating_point,
)
from railjoule.core.drive.kinds import INDUCTION
from railjoule.core.drive.line_power import resistor_power
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.drive import Induction
from railjoule.core.units import H_PER_MH

NEGLIGIBLE_SHARE = 1e-7
"""An effort below this share of the largest one is rounding, and the machines are off."""
LOSS_KINDS = ("copper", "iron", "mechanical", "gear", "standstill_brake")


@dataclass(frozen=True, eq=False)
class InductionDrive(Drive):
    """A drive of induction machines whose flux is always that of least loss.

    Parameters
    ----------
    starting_current_a, braking_current_a : float
        Largest current of one machine, driving and braking; amplitude per phase [A].
    """

    starting_current_a: float
    braking_current_a: float

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> dict[str, FloatArray]:
        """Return the losses by kind [W]: those of machines and gear, of the standstill brake, of brake resistors."""
        power = self.electrical_power_w(effort_n, speed_ms)
        found = self._machines(effort_n, speed_ms)
        losses = {kind: found[index].reshape(power.shape) for index, kind in enumerate(LOSS_KINDS)}
        return losses | {"brake_resistors": resistor_power(power, self.recuperation_factor)}

    def current_a(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the current of one machine, amplitude per phase and negative where it generates [A]."""
        shape = np.broadcast(effort_n, speed_ms).shape
        current: FloatArray = self._machines(effort_n, speed_ms)[len(LOSS_KINDS)].reshape(shape)
        return current

    def effort_limit_n(self, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the largest effort [N] that current, voltage and rated flux allow; shape as the argument's."""
        return self.effort_at_current_n(
            self.braking_current_a if braking else self.starting_current_a, speed_ms, braking
        )

    def weakening_limit_n(self, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the least of that which the voltage allows with either of the two other limits.

        Over the ratio of the currents each of the limits of flux, current and voltage holds an effort in an interval,
        and three intervals meet where each two of them do (Helly). So the least of three limits, each of a pair, is the
        limit of all; that of flux and current is the constant one, the two others vary with speed. Where the pull-out
        lies at a smaller ratio than full current at rated flux, flux and voltage bind without the current.
        """
        current = self.braking_current_a if braking else self.starting_current_a
        with_current = self._efforts_n(speed_ms, current, braking, False)
        return np.minimum(with_current, self._efforts_n(speed_ms, np.inf, braking, True))

    def corner_speed_ms(self, current_a: float, braking: bool = False) -> float:
        """Return the speed [m/s] up to which the voltage carries a current at rated flux; 0 if it never does."""
        return float(corner_speed(self.parameters, braking, current_a))

    def effort_at_current_n(self, current_a: float, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the largest effort [N] of machines that carry at most a current [A]; shape as the speeds'."""
        return self._efforts_n(speed_ms, current_a, braking, True)

    def full_current_start(self, speed_ms: FloatArray, current_a: float) -> tuple[FloatArray, FloatArray]:
        """Return effort [N] and line power [W] of a start that holds a current at all speeds, as Rawicki's does.

        Shapes as the speeds'. Beyond the pull-out it wastes what `effort_at_current_n` saves; where the voltage does
        not carry the current, both are negative.
        """
        speed = np.asarray(speed_ms, dtype=float)
        effort, power = np.empty(speed.size), np.empty(speed.size)
        fill_full_current(self.parameters, current_a, speed.ravel(), effort, power)
        return effort.reshape(speed.shape), power.reshape(speed.shape)

    def idle_power_w(self, speed_ms: FloatArray) -> FloatArray:
        """Return what the machines take that are on without effort [W]; zero only when they are off."""
        speed = np.asarray(speed_ms, dtype=float)
        return np.array([idle_power(self.parameters, v)[0] for v in speed.ravel()]).reshape(speed.shape)

    def _efforts_n(self, speed_ms: FloatArray, current_a: float, braking: bool, rated_flux: bool) -> FloatArray:
        speed = np.asarray(speed_ms, dtype=float)
        effort = np.empty(speed.size)
        fill_efforts(self.parameters, braking, current_a, rated_flux, speed.ravel(), effort)
        return effort.reshape(speed.shape)

    def _machines(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        effort, speed = np.broadcast_arrays(np.asarray(effort_n, float), np.asarray(speed_ms, float))
        found = np.zeros((len(LOSS_KINDS) + 1, effort.size))
        _fill_losses(self.parameters, effort.ravel(), speed.ravel(), found)
        return found


def make_induction_drive(parameters: Induction) -> InductionDrive:
    """Return the drive that the validated parameters of a scenario describe.

    Raises
    ------
    ScenarioError
        If the machines cannot even turn themselves.
    """
    numbers = np.array(kernel_parameters(parameters))
    standing, largest = np.zeros(1), np.empty(1)
    fill_efforts(numbers, False, parameters.starting_current_a, True, standing, largest)
    if largest[0] <= 0:
        raise ScenarioError(
            f"drive.mechanical_loss_torque_nm = {parameters.mechanical_loss_torque_nm:g} must be below what the motor "
            f"gives at drive.starting_current_a = {parameters.starting_current_a:g}."
        )
    numbers[NEGLIGIBLE] = NEGLIGIBLE_SHARE * largest[0]
    return InductionDrive(
        kind=INDUCTION,
        parameters=frozen_array(numbers),
        recuperation_factor=parameters.recuperation_factor,
        loss_kind="machine",
        amperes_per_newton=None,
        starting_current_a=parameters.starting_current_a,
        braking_current_a=parameters.braking_current_a,
    )


def kernel_parameters(parameters: Induction) -> list[float]:
    """Return the numbers in the order of `railjoule.core.drive.induction.power.PARAMETERS`."""
    rated_rads = 2 * math.pi * parameters.rated_frequency_hz
    return [
        parameters.stator_resistance_ohm,
        parameters.rotor_resistance_ohm,
        parameters.stator_inductance_mh * H_PER_MH,
        parameters.rotor_inductance_mh * H_PER_MH,
        parameters.mutual_inductance_mh * H_PER_MH,
        parameters.rated_magnetising_current_a,
        parameters.hysteresis_loss_w / rated_rads,
        parameters.eddy_loss_w / rated_rads**2,
        parameters.mechanical_loss_torque_nm,
        parameters.max_phase_voltage_v,
        float(parameters.pole_pairs),
        float(parameters.motors),
        parameters.gear_ratio / (0.5 * parameters.wheel_diameter_m),
        parameters.gear_efficiency,
        float(parameters.standstill_brake),
        0.0,
    ]


@njit(cache=True, nogil=True)
def _fill_losses(parameters: FloatArray, effort: FloatArray, speed: FloatArray, found: FloatArray) -> None:
    """Fill the rows of `found` with the losses of all machines [W] and the current of one [A]; shape (6, n)."""
    motors, gear = parameters[MOTORS], parameters[GEAR]
    for i in range(effort.shape[0]):
        state, flux_current, torque_current, on = operating_point(parameters, effort[i], speed[i])
        work = effort[i] * speed[i]
        if not on:
            found[4, i] = max(-work, 0.0)
            continue
        found[0, i] = motors * (state.stator_copper_w + state.rotor_copper_w)
        found[1, i] = motors * state.iron_w
        found[2, i] = motors * parameters[MECHANICAL_LOSS] * parameters[TURNS] * speed[i]
        found[3, i] = work * (1.0 / gear - 1.0) if work > 0.0 else -work * (1.0 - gear)
        found[5, i] = math.copysign(math.hypot(flux_current, torque_current), torque_current)
