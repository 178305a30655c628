"""The drive of a train with induction machines, for arrays of effort and speed."""

import math
from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compiled import njit
from railjoule.core.drive.drive import Drive
from railjoule.core.drive.geared import NEGLIGIBLE_SHARE
from railjoule.core.drive.geared_parameters import turns_per_metre
from railjoule.core.drive.induction.limits import corner_speed, fill_efforts, fill_full_current
from railjoule.core.drive.induction.machine import MECHANICAL_LOSS, Machine, iron_loss_coefficients
from railjoule.core.drive.induction.power import (
    GEAR,
    MOTORS,
    NEGLIGIBLE,
    TURNS,
    operating_point,
)
from railjoule.core.drive.kinds import INDUCTION
from railjoule.core.drive.line_power import resistor_power
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.drive import Induction, InductionMachine
from railjoule.core.units import H_PER_MH

LOSS_KINDS = ("copper", "iron", "mechanical", "gear", "standstill_brake")
# the rows that `_fill_losses` fills: the losses by kind, then the current
COPPER, IRON, MECHANICAL, GEAR_LOSS, STANDSTILL, CURRENT = range(len(LOSS_KINDS) + 1)


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
        current: FloatArray = self._machines(effort_n, speed_ms)[CURRENT].reshape(shape)
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

    def _efforts_n(self, speed_ms: FloatArray, current_a: float, braking: bool, rated_flux: bool) -> FloatArray:
        speed = np.asarray(speed_ms, dtype=float)
        effort = np.empty(speed.size)
        fill_efforts(self.parameters, braking, current_a, rated_flux, speed.ravel(), effort)
        return effort.reshape(speed.shape)

    def _machines(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        effort, speed = np.broadcast_arrays(np.asarray(effort_n, float), np.asarray(speed_ms, float))
        found = np.zeros((CURRENT + 1, effort.size))
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
    # at rest the voltage binds least: the largest effort of all
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


def machine_from(parameters: Induction | InductionMachine) -> Machine:
    """Return the numbers of one machine that the parameters of a scenario describe, those of a drive or of it alone."""
    if isinstance(parameters, Induction):
        magnetising_a, friction_nm = parameters.rated_magnetising_current_a, parameters.mechanical_loss_torque_nm
    else:
        # a drive that knows only its copper loses nothing at the shaft
        magnetising_a, friction_nm = parameters.magnetising_current_a, 0.0
    hysteresis_ws, eddy_ws2 = iron_loss_coefficients(
        parameters.hysteresis_loss_w, parameters.eddy_loss_w, parameters.rated_frequency_hz
    )
    return Machine(
        stator_resistance_ohm=parameters.stator_resistance_ohm,
        rotor_resistance_ohm=parameters.rotor_resistance_ohm,
        stator_inductance_h=parameters.stator_inductance_mh * H_PER_MH,
        rotor_inductance_h=parameters.rotor_inductance_mh * H_PER_MH,
        mutual_inductance_h=parameters.mutual_inductance_mh * H_PER_MH,
        magnetising_current_a=magnetising_a,
        hysteresis_loss_ws=hysteresis_ws,
        eddy_loss_ws2=eddy_ws2,
        mechanical_loss_torque_nm=friction_nm,
        max_phase_voltage_v=parameters.max_phase_voltage_v,
        pole_pairs=float(parameters.pole_pairs),
    )


def kernel_parameters(parameters: Induction) -> list[float]:
    """Return the numbers in the order of `railjoule.core.drive.induction.power.PARAMETERS`."""
    return [
        *machine_from(parameters),
        float(parameters.motors),
        turns_per_metre(parameters),
        parameters.gear_efficiency,
        float(parameters.standstill_brake),
        # the negligible effort: a share of the largest one, which takes the other numbers to compute
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
            # machines that are off take nothing of a braking effort: the standstill brake turns all of it into heat
            found[STANDSTILL, i] = max(-work, 0.0)
            continue
        found[COPPER, i] = motors * (state.stator_copper_w + state.rotor_copper_w)
        found[IRON, i] = motors * state.iron_w
        # lost at the rotor itself: the gear has no part in it
        found[MECHANICAL, i] = motors * parameters[MECHANICAL_LOSS] * parameters[TURNS] * speed[i]
        # driving, motors give work / eta; braking, they get eta times the work
        found[GEAR_LOSS, i] = work * (1.0 / gear - 1.0) if work > 0.0 else -work * (1.0 - gear)
        found[CURRENT, i] = math.copysign(math.hypot(flux_current, torque_current), torque_current)
