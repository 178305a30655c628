"""The induction machines of a train, from whichever kind of drive has them: circuit, limits, gear."""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.geared_parameters import turns_per_metre
from railjoule.core.drive.induction.circuit import InverseGammaCircuit, inverse_gamma_of, t_circuit_of_machine
from railjoule.core.drive.induction.drive import machine_from
from railjoule.core.drive.induction.efficiency import fill_efficiency
from railjoule.core.drive.induction.limits import greatest_torque_nm
from railjoule.core.drive.induction.machine import Machine
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario.drive import CopperLoss, DriveParameters, Induction


@dataclass(frozen=True)
class TractionMachines:
    """Equal induction machines that turn the wheels of a train.

    Parameters
    ----------
    machine : Machine
        The numbers of one.
    motors : int
        How many there are.
    turns_per_metre : float
        Angle of a rotor over the distance of the train [1/m].
    gear_efficiency : float
        What the gear lets through of the power, in driving and in braking.
    driving_current_a, braking_current_a : float
        Largest currents of one machine, amplitude per phase [A].
    """

    machine: Machine
    motors: int
    turns_per_metre: float
    gear_efficiency: float
    driving_current_a: float
    braking_current_a: float

    @property
    def circuit(self) -> InverseGammaCircuit:
        """Return the inverse-gamma circuit of one machine."""
        return inverse_gamma_of(t_circuit_of_machine(self.machine))

    @property
    def rated_flux_vs(self) -> float:
        """Return the rated flux linkage of the rotor in the T circuit [V s]."""
        # in steady state the rotor's flux is M Ix: its current has no part along x
        return self.machine.mutual_inductance_h * self.machine.magnetising_current_a

    def greatest_torque_nm(self, speed_rads: FloatArray, braking: bool = False) -> FloatArray:
        """Return the greatest torque of the shaft, without sign, that current and voltage carry [N m].

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
            greatest_torque_nm(machine, sign, current, machine.magnetising_current_a, machine.pole_pairs * speed)
            for speed in np.asarray(speed_rads, dtype=float)
        ]
        # friction takes from the torque that drives, and adds to the one that brakes
        return np.maximum(np.array(torque) - sign * machine.mechanical_loss_torque_nm, 0.0)

    def efficiency(self, torque_nm: FloatArray, speed_rads: FloatArray, least_loss: bool) -> FloatArray:
        """Return output over input power of one machine; NaN where current or voltage do not carry a torque.

        Parameters
        ----------
        torque_nm : array of shape (n,)
            Torques of the shaft, negative where it brakes [N m].
        speed_rads : array of shape (m,)
            Speeds of the rotor [rad/s].
        least_loss : bool
            Whether the flux is that of least loss; else the rated one as long as the voltage carries it.

        Returns
        -------
        array of shape (n, m)
        """
        found = np.empty((len(torque_nm), len(speed_rads)))
        fill_efficiency(
            self.machine,
            least_loss,
            self.driving_current_a,
            self.braking_current_a,
            np.array(torque_nm, dtype=float),
            np.array(speed_rads, dtype=float),
            found,
        )
        return found


def traction_machines(drive: DriveParameters) -> TractionMachines:
    """Return the induction machines of a drive.

    Raises
    ------
    ScenarioError
        If it has none.
    """
    if isinstance(drive, Induction):
        return TractionMachines(
            machine=machine_from(drive),
            motors=drive.motors,
            turns_per_metre=turns_per_metre(drive),
            gear_efficiency=drive.gear_efficiency,
            # of a tram the currents are those of starting and braking, of a bare machine one for both
            driving_current_a=drive.starting_current_a,
            braking_current_a=drive.braking_current_a,
        )
    if not isinstance(drive, CopperLoss):
        model = getattr(drive, "model", "")
        raise ScenarioError(
            f"drive.model = '{model}' has no induction machine; 'induction' and 'copper_loss' may have one."
        )
    if drive.machine is None:
        raise ScenarioError("drive.machine is missing: of its motors this drive knows only the resistance.")
    return TractionMachines(
        machine=machine_from(drive.machine),
        motors=drive.motors,
        turns_per_metre=turns_per_metre(drive),
        gear_efficiency=1.0,
        driving_current_a=drive.machine.max_current_a,
        braking_current_a=drive.machine.max_current_a,
    )
