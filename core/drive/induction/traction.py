"""The induction machines of a train, of a drive of machines or beside a drive with copper loss.

The T circuit has a leakage on each side of the mutual inductance. The inverse-gamma circuit has all of it on the
stator's side; with k = M / L_W its rotor flux is k times that of the T circuit, and

    leakage L_S - k M      magnetising inductance k M      rotor resistance k^2 R_W:

with k times the flux, the rotor has 1 / k of the current for the same torque, and the same loss. Both behave alike at
the stator's terminals and at the shaft. Source: Slemon 1989, "Modelling of induction machines for electric drives",
(16)-(20).

The flux of a machine is the rated one as long as the voltage carries it, or that of least loss; both are given by the
current Ix that makes them in steady state. Without torque only the voltage bounds it.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.geared import turns_per_metre
from railjoule.core.drive.induction.drive import machine_from
from railjoule.core.drive.induction.limits import max_torque_nm
from railjoule.core.drive.induction.machine import Machine, phase_voltage_v, steady_state, torque_constant
from railjoule.core.drive.induction.min_loss import best_ratio
from railjoule.core.drive.induction.voltage import pull_out_ratio, ratio_within_voltage, value, voltage_quartic
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.drive import CopperLoss, DriveParameters, Induction, InductionMachine

# a torque on the limit itself, which a search finds to 5e-10, counts as carried
ALLOWED_EXCESS = 1e-6


class InverseGammaCircuit(NamedTuple):
    """A machine with all leakage on the stator's side: resistances [ohm] and inductances [H]."""

    stator_resistance_ohm: float
    rotor_resistance_ohm: float
    magnetising_inductance_h: float
    leakage_inductance_h: float


class TractionMachines(NamedTuple):
    """Equal induction machines that turn the wheels of a train.

    Parameters
    ----------
    machine : Machine
        One of them.
    circuit : InverseGammaCircuit
        The same machine with all leakage on the stator's side.
    motors : int
        Their number.
    turns_per_metre : float
        Angle of a rotor over the distance of the train [1/m].
    gear_efficiency : float
        Of the gear, in driving and in braking.
    driving_current_a : float
        Largest current of one machine in driving, amplitude per phase [A].
    braking_current_a : float
        Largest current of one machine in braking, amplitude per phase [A].
    """

    machine: Machine
    circuit: InverseGammaCircuit
    motors: int
    turns_per_metre: float
    gear_efficiency: float
    driving_current_a: float
    braking_current_a: float

    def max_torque_nm(self, speed_rads: FloatArray, braking: bool = False) -> FloatArray:
        """Return the greatest torque of the shaft, without sign, within current and voltage [N m].

        Parameters
        ----------
        speed_rads : array of shape (n,)
            Speeds of the rotor [rad/s].
        braking : bool
            Whether the machine generates.
        """
        current = self.braking_current_a if braking else self.driving_current_a
        sign, machine = -1.0 if braking else 1.0, self.machine
        torque = [
            max_torque_nm(machine, sign, current, machine.magnetising_current_a, machine.pole_pairs * speed)
            for speed in np.asarray(speed_rads, dtype=float)
        ]
        # friction takes from the torque that drives, and adds to the one that brakes
        return np.maximum(np.array(torque) - sign * machine.mechanical_loss_torque_nm, 0.0)

    def efficiency(self, torque_nm: FloatArray, speed_rads: FloatArray, min_loss: bool) -> FloatArray:
        """Return output over input power of one machine, shape (n, m); NaN beyond current or voltage.

        Parameters
        ----------
        torque_nm : array of shape (n,)
            Torques of the shaft, negative where it brakes [N m].
        speed_rads : array of shape (m,)
            Speeds of the rotor [rad/s].
        min_loss : bool
            Whether the flux is that of least loss; else the rated one as long as the voltage carries it.
        """
        limits = self.driving_current_a, self.braking_current_a
        found = np.empty((len(torque_nm), len(speed_rads)))
        torque, speed = np.array(torque_nm, dtype=float), np.array(speed_rads, dtype=float)
        fill_efficiency(self.machine, min_loss, *limits, torque, speed, found)
        return found


def traction_machines(drive: DriveParameters) -> TractionMachines:
    """Return the induction machines of a drive.

    Raises
    ------
    ScenarioError
        If it has none.
    """
    parameters: Induction | InductionMachine
    if isinstance(drive, Induction):
        # a tram has a current for starting and one for braking, a single machine one for both
        gear, parameters = drive.gear_efficiency, drive
        currents = drive.starting_current_a, drive.braking_current_a
    elif not isinstance(drive, CopperLoss):
        model = getattr(drive, "model", "")
        raise ScenarioError(
            f"drive.model = '{model}' has no induction machine; 'induction' and 'copper_loss' may have one."
        )
    elif drive.machine is None:
        raise ScenarioError("drive.machine is missing: this drive has only the resistance of its motors.")
    else:
        gear, parameters = 1.0, drive.machine
        currents = drive.machine.max_current_a, drive.machine.max_current_a
    machine = machine_from(parameters)
    return TractionMachines(machine, inverse_gamma(machine), drive.motors, turns_per_metre(drive), gear, *currents)


def inverse_gamma(machine: Machine) -> InverseGammaCircuit:
    """Return the circuit of a machine with all leakage on the stator's side."""
    k = machine.mutual_inductance_h / machine.rotor_inductance_h
    magnetising_h = k * machine.mutual_inductance_h
    return InverseGammaCircuit(
        stator_resistance_ohm=machine.stator_resistance_ohm,
        rotor_resistance_ohm=k * k * machine.rotor_resistance_ohm,
        magnetising_inductance_h=magnetising_h,
        leakage_inductance_h=machine.stator_inductance_h - magnetising_h,
    )


@njit(cache=True, nogil=True)
def fill_efficiency(
    machine: Machine,
    min_loss: bool,
    driving_current_a: float,
    braking_current_a: float,
    torque_nm: FloatArray,
    speed_rads: FloatArray,
    efficiency: FloatArray,
) -> None:
    """Fill the efficiencies of `TractionMachines.efficiency`; 0 where nothing comes out."""
    for j in range(speed_rads.shape[0]):
        rotor_rads = machine.pole_pairs * speed_rads[j]
        for i in range(torque_nm.shape[0]):
            # friction takes its torque from the shaft in both directions
            torque = torque_nm[i] + machine.mechanical_loss_torque_nm
            flux_current_a = flux_current(machine, min_loss, torque, rotor_rads)
            torque_current = torque / (torque_constant(machine) * flux_current_a)
            state = steady_state(machine, flux_current_a, torque_current, rotor_rads)
            max_a = driving_current_a if torque >= 0.0 else braking_current_a
            current, voltage = math.hypot(flux_current_a, torque_current) / max_a, phase_voltage_v(state)
            shaft = torque_nm[i] * speed_rads[j]
            if max(current, voltage / machine.max_phase_voltage_v) > 1.0 + ALLOWED_EXCESS:
                efficiency[i, j] = np.nan
            elif shaft > 0.0:
                efficiency[i, j] = shaft / state.input_power_w
            elif shaft < 0.0 and state.input_power_w < 0.0:
                efficiency[i, j] = state.input_power_w / shaft
            else:
                efficiency[i, j] = 0.0


# a torque below this share of that at Ix = Iy = Imu counts as none: kappa = 0 would leave the ratio, and the flux, open
MIN_STRENGTH_SHARE = 1e-6


@njit(cache=True)
def flux_current(machine: Machine, min_loss: bool, torque_nm: float, rotor_rads: float) -> float:
    """Return the Ix that a torque gets [A].

    Parameters
    ----------
    machine : Machine
    min_loss : bool
        Whether it is the one with which the torque loses least; else the largest one up to the rated one with which the
        voltage carries the torque, or that of the pull-out torque if none does.
    torque_nm : float
        Electromagnetic torque, negative where it generates [N m].
    rotor_rads : float
        Electrical angular frequency of the rotor [rad/s].
    """
    sign = 1.0 if torque_nm >= 0.0 else -1.0
    rated2 = machine.magnetising_current_a * machine.magnetising_current_a
    strength = max(sign * torque_nm / torque_constant(machine), MIN_STRENGTH_SHARE * rated2)
    if min_loss:
        best, _ = best_ratio(machine, sign, strength, rotor_rads)
        return min(math.sqrt(strength / best), machine.magnetising_current_a)
    quartic = voltage_quartic(machine, sign, rotor_rads)
    # at rated flux q = kappa / Imu^2, which the voltage carries where kappa D <= U_m^2 q, as `voltage` derives
    ratio, voltage2 = strength / rated2, machine.max_phase_voltage_v * machine.max_phase_voltage_v
    if strength * value(quartic, ratio) <= voltage2 * ratio:
        return machine.magnetising_current_a
    bound = ratio_within_voltage(quartic, strength, voltage2, ratio)
    if bound < 0.0:
        # U_m^2 = Ix^2 D(q)
        pull_out = pull_out_ratio(quartic)
        return min(machine.max_phase_voltage_v / math.sqrt(value(quartic, pull_out)), machine.magnetising_current_a)
    return math.sqrt(strength / bound)


@njit(cache=True, nogil=True)
def fill_flux_currents(
    machine: Machine, min_loss: bool, torque_nm: FloatArray, rotor_rads: FloatArray, flux_current_a: FloatArray
) -> None:
    """Fill the currents Ix [A] of `flux_current` for torques [N m] at frequencies [rad/s]; all of shape (n,)."""
    for i in range(torque_nm.shape[0]):
        flux_current_a[i] = flux_current(machine, min_loss, torque_nm[i], rotor_rads[i])
