"""The samples of a closed-loop run, by name."""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.induction.traction import TractionMachines
from railjoule.core.simulation.field_oriented import states as column
from railjoule.core.simulation.field_oriented.integration import Extremes


@dataclass(frozen=True, eq=False)
class Record:
    """What the integration filled, on the plan's clock; arrays of shape (n,).

    Parameters
    ----------
    time_s : array
        Times of the samples [s].
    states : array of shape (n, STATES)
        Columns as in `railjoule.core.simulation.field_oriented.states`.
    outputs : array of shape (n, OUTPUTS)
        Likewise.
    extremes : Extremes
        Of all steps, samples or not.
    planned_m : array
        The plan's own position [m].
    delay_s : float
        How much later than planned the train arrives [s].
    """

    time_s: FloatArray
    states: FloatArray
    outputs: FloatArray
    extremes: Extremes
    planned_m: FloatArray
    delay_s: float

    def state(self, name: int) -> FloatArray:
        """Return one state at all samples; `name` is one of the columns."""
        return self.states[:, name]

    def final(self, name: int) -> float:
        """Return one state at the end."""
        return float(self.states[-1, name])

    @property
    def position_m(self) -> FloatArray:
        """True position [m]."""
        return self.state(column.POSITION)

    @property
    def tracking_error_m(self) -> FloatArray:
        """How far the train is behind its plan [m]."""
        return self.planned_m - self.position_m

    @property
    def rotor_flux_vs(self) -> FloatArray:
        """Amplitude of the true rotor flux of the inverse-gamma circuit [V s]."""
        flux: FloatArray = np.hypot(self.state(column.FLUX_D), self.state(column.FLUX_Q))
        return flux

    @property
    def losses_j(self) -> FloatArray:
        """What all machines have lost so far, friction apart [J]."""
        losses: FloatArray = sum(
            (self.state(name) for name in (column.STATOR, column.ROTOR, column.MAGNETISING, column.IRON)),
            start=np.zeros(len(self.time_s)),
        )
        return losses

    def field_energy_j(self, machines: TractionMachines) -> FloatArray:
        """Return what the magnetic fields of all machines hold more than at the start [J]."""
        circuit = machines.circuit
        current2 = self.state(column.CURRENT_D) ** 2 + self.state(column.CURRENT_Q) ** 2
        flux2 = self.state(column.FLUX_D) ** 2 + self.state(column.FLUX_Q) ** 2
        per_machine = circuit.leakage_inductance_h * current2 + flux2 / circuit.magnetising_inductance_h
        # half of it is the energy of one phase's amplitudes, and amplitudes of three phases count 3/2 times
        stored: FloatArray = 0.75 * machines.motors * (per_machine - per_machine[0])
        return stored
