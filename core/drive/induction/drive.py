"""The drive of a train with induction machines, for arrays of effort and speed.

Driving, F = n x (T - T_m) eta; braking, F = n x (T - T_m) / eta with T < 0; x = gear ratio over wheel radius. Rawicki,
(3), (23)-(24), (33). An electric brake whose machines would need supply power, near standstill or at less than their
own friction, does not brake: the standstill brake of the train does, where there is one. Else the power counts in full.
"""

import math
from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compiled import njit
from railjoule.core.drive.drive import Drive
from railjoule.core.drive.geared import (
    BRAKING_SHARE,
    DRIVING_SHARE,
    FRICTION,
    MOTORS,
    NEGLIGIBLE,
    NEGLIGIBLE_SHARE,
    STANDSTILL_BRAKE,
    TURNS,
    turns_per_metre,
)
from railjoule.core.drive.induction.limits import corner_speed, fill_efforts, fill_full_current
from railjoule.core.drive.induction.machine import Machine, make_machine, steady_state, torque_constant
from railjoule.core.drive.induction.min_loss import best_ratio
from railjoule.core.drive.kinds import INDUCTION
from railjoule.core.drive.line_power import resistor_power
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.drive import Induction, InductionMachine
from railjoule.core.units import H_PER_MH

LOSS_KINDS = ("copper", "iron", "mechanical", "gear", "standstill_brake")
# the rows that `_fill_losses` fills: the losses by kind, then the current
COPPER, IRON, MECHANICAL, GEAR_LOSS, STANDSTILL, CURRENT = range(len(LOSS_KINDS) + 1)


@dataclass(frozen=True, eq=False, kw_only=True)
class InductionDrive(Drive):
    """A drive of induction machines whose flux is always that of least loss.

    Parameters
    ----------
    starting_current_a : float
        Largest current of one machine in driving, amplitude per phase [A].
    braking_current_a : float
        Largest current of one machine in braking, amplitude per phase [A].
    """

    starting_current_a: float
    braking_current_a: float

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> dict[str, FloatArray]:
        """Return the losses by kind [W]: of machines and gear, of the standstill brake, of brake resistors."""
        power, found = self.electrical_power_w(effort_n, speed_ms), self._machines(effort_n, speed_ms)
        losses = dict(zip(LOSS_KINDS, found, strict=False))
        return losses | {"brake_resistors": resistor_power(power, self.recuperation_factor)}

    def current_a(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the current of one machine, amplitude per phase and negative where it generates [A]."""
        current: FloatArray = self._machines(effort_n, speed_ms)[CURRENT]
        return current

    def effort_limit_n(self, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the largest effort [N] within current, voltage and rated flux; shape as the argument's."""
        current = self.braking_current_a if braking else self.starting_current_a
        return self.effort_at_current_n(current, speed_ms, braking)

    def weakening_limit_n(self, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the largest effort [N] within the voltage and either of the two other limits, whichever is less.

        Over the ratio of the currents each of the limits of flux, current and voltage allows an effort in an interval,
        and three intervals meet where each two of them do (Helly). So the least of three limits, each of a pair, is the
        limit of all; that of flux and current is the constant one, the two others vary with speed. If the
        pull-out lies at a smaller ratio than full current at rated flux, flux and voltage bind without the current.
        """
        current = self.braking_current_a if braking else self.starting_current_a
        with_current = self.effort_at_current_n(current, speed_ms, braking, rated_flux=False)
        return np.minimum(with_current, self.effort_at_current_n(np.inf, speed_ms, braking))

    def corner_speed_ms(self, current_a: float, braking: bool = False) -> float:
        """Return the speed [m/s] up to which the voltage carries a current at rated flux; 0 if it never does."""
        return float(corner_speed(self.parameters, braking, current_a))

    def effort_at_current_n(
        self, current_a: float, speed_ms: FloatArray, braking: bool = False, rated_flux: bool = True
    ) -> FloatArray:
        """Return the largest effort [N] of machines that carry at most a current [A]; shape as the speeds'.

        The flux is at most the rated one, unless `rated_flux` is False: then only current and voltage count.
        """
        speed = np.asarray(speed_ms, dtype=float)
        effort = np.empty(speed.size)
        fill_efforts(self.parameters, braking, current_a, rated_flux, speed.ravel(), effort)
        return effort.reshape(speed.shape)

    def full_current_start(self, speed_ms: FloatArray, current_a: float) -> tuple[FloatArray, FloatArray]:
        """Return effort [N] and supply power [W] of a start that holds a current at all speeds, as Rawicki's does.

        Shapes as the speeds'. Beyond the pull-out it wastes power that `effort_at_current_n` saves; where the voltage
        does not carry the current, both are negative.
        """
        speed = np.asarray(speed_ms, dtype=float)
        found = np.empty((2, speed.size))
        fill_full_current(self.parameters, current_a, speed.ravel(), *found)
        effort, power = found.reshape(2, *speed.shape)
        return effort, power

    def _machines(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        effort, speed = np.broadcast_arrays(np.asarray(effort_n, float), np.asarray(speed_ms, float))
        found = np.zeros((CURRENT + 1, effort.size))
        _fill_losses(self.parameters, effort.ravel(), speed.ravel(), found)
        return found.reshape(CURRENT + 1, *effort.shape)


def make_induction(parameters: Induction) -> InductionDrive:
    """Return the drive of validated parameters of a scenario.

    Raises
    ------
    ScenarioError
        If the machines cannot turn themselves.
    """
    gear, friction_nm = parameters.gear_efficiency, parameters.mechanical_loss_torque_nm
    brake = float(parameters.standstill_brake)
    head = [parameters.motors, turns_per_metre(parameters), 1 / gear, gear, 0.0, friction_nm, brake]
    numbers = np.array([*head, *machine_from(parameters)])
    # at rest the voltage binds least: the largest effort of all
    standing, largest = np.zeros(1), np.empty(1)
    fill_efforts(numbers, False, parameters.starting_current_a, True, standing, largest)
    if largest[0] <= 0:
        raise ScenarioError(
            f"drive.mechanical_loss_torque_nm = {friction_nm:g} must be below what the motor "
            f"gives at drive.starting_current_a = {parameters.starting_current_a:g}."
        )
    numbers[NEGLIGIBLE] = NEGLIGIBLE_SHARE * largest[0]
    return InductionDrive(
        kind=INDUCTION,
        parameters=frozen_array(numbers),
        recuperation_factor=parameters.recuperation_factor,
        loss_kind="machine",
        starting_current_a=parameters.starting_current_a,
        braking_current_a=parameters.braking_current_a,
    )


def machine_from(parameters: Induction | InductionMachine) -> Machine:
    """Return the machine of a scenario's parameters, those of a drive or of a single machine."""
    if isinstance(parameters, Induction):
        magnetising_a, friction_nm = parameters.rated_magnetising_current_a, parameters.mechanical_loss_torque_nm
    else:
        # a drive with only copper loss loses nothing at the shaft
        magnetising_a, friction_nm = parameters.magnetising_current_a, 0.0
    rated_rads = 2 * math.pi * parameters.rated_frequency_hz
    return Machine(
        stator_resistance_ohm=parameters.stator_resistance_ohm,
        rotor_resistance_ohm=parameters.rotor_resistance_ohm,
        stator_inductance_h=parameters.stator_inductance_mh * H_PER_MH,
        rotor_inductance_h=parameters.rotor_inductance_mh * H_PER_MH,
        mutual_inductance_h=parameters.mutual_inductance_mh * H_PER_MH,
        magnetising_current_a=magnetising_a,
        hysteresis_loss_ws=parameters.hysteresis_loss_w / rated_rads,
        eddy_loss_ws2=parameters.eddy_loss_w / rated_rads**2,
        mechanical_loss_torque_nm=friction_nm,
        max_phase_voltage_v=parameters.max_phase_voltage_v,
        pole_pairs=float(parameters.pole_pairs),
    )


@njit(cache=True, nogil=True)
def _fill_losses(parameters: FloatArray, effort: FloatArray, speed: FloatArray, found: FloatArray) -> None:
    """Fill the rows of `found`, zero so far, with the losses of all machines [W] and the current of one [A].

    Efforts are signed [N], speeds in [m/s]; shapes (n,) and (6, n).
    """
    machine, motors, turns = make_machine(parameters), parameters[MOTORS], parameters[TURNS]
    for i in range(effort.shape[0]):
        work, share = effort[i] * speed[i], parameters[DRIVING_SHARE if effort[i] > 0.0 else BRAKING_SHARE]
        torque = parameters[FRICTION] + effort[i] * share / (motors * turns)
        sign = 1.0 if torque >= 0.0 else -1.0
        strength, rotor_rads = sign * torque / torque_constant(machine), machine.pole_pairs * turns * speed[i]
        ratio, _ = best_ratio(machine, sign, strength, rotor_rads)
        # kappa = Ix |Iy| = q Ix^2
        flux_current = math.sqrt(strength / ratio)
        state = steady_state(machine, flux_current, sign * ratio * flux_current, rotor_rads)
        draws = effort[i] < 0.0 and state.input_power_w > 0.0 and parameters[STANDSTILL_BRAKE] > 0.0
        if draws or abs(effort[i]) <= parameters[NEGLIGIBLE]:
            # machines that are off do not brake: the standstill brake dissipates the whole work
            found[STANDSTILL, i] = max(-work, 0.0)
            continue
        found[COPPER, i] = motors * (state.stator_copper_w + state.rotor_copper_w)
        found[IRON, i] = motors * state.iron_w
        # lost at the rotor itself, not in the gear
        found[MECHANICAL, i] = motors * parameters[FRICTION] * turns * speed[i]
        found[GEAR_LOSS, i] = work * (share - 1.0)
        found[CURRENT, i] = math.copysign(math.hypot(flux_current, ratio * flux_current), torque)
