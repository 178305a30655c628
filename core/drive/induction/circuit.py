"""The two equivalent circuits of an induction machine, and how one becomes the other.

The T circuit has a leakage on each side of the mutual inductance. The inverse-gamma circuit has all of it on the
stator's side; with k = M / L_W its rotor flux is k times that of the T circuit, and

    leakage L_S - k M      magnetising inductance k M      rotor resistance k^2 R_W.

Both behave alike at the stator's terminals and at the shaft. Source: Slemon 1989, "Modelling of induction machines for
electric drives", (16)-(20).
"""

from dataclasses import dataclass

from railjoule.core.drive.induction.machine import Machine


@dataclass(frozen=True)
class TCircuit:
    """A machine with leakage on both sides, all seen from the stator.

    Parameters
    ----------
    stator_resistance_ohm, rotor_resistance_ohm : float
        R_S, R_W [ohm].
    mutual_inductance_h, stator_leakage_h, rotor_leakage_h : float
        M, and what the inductances of stator and rotor have beyond it [H].
    """

    stator_resistance_ohm: float
    rotor_resistance_ohm: float
    mutual_inductance_h: float
    stator_leakage_h: float
    rotor_leakage_h: float

    @property
    def flux_ratio(self) -> float:
        """Return k = M / L_W, the rotor flux of the inverse-gamma circuit over that of this one."""
        return self.mutual_inductance_h / (self.mutual_inductance_h + self.rotor_leakage_h)


@dataclass(frozen=True)
class InverseGammaCircuit:
    """The same machine with all leakage on the stator's side.

    Parameters
    ----------
    stator_resistance_ohm, rotor_resistance_ohm : float
        Resistances [ohm].
    magnetising_inductance_h, leakage_inductance_h : float
        Inductances [H].
    """

    stator_resistance_ohm: float
    rotor_resistance_ohm: float
    magnetising_inductance_h: float
    leakage_inductance_h: float


def inverse_gamma_of(circuit: TCircuit) -> InverseGammaCircuit:
    """Return the inverse-gamma circuit of a T circuit."""
    # with k times the flux, the rotor has 1 / k of the current for the same torque: k^2 R_W loses the same
    k, mutual = circuit.flux_ratio, circuit.mutual_inductance_h
    return InverseGammaCircuit(
        stator_resistance_ohm=circuit.stator_resistance_ohm,
        rotor_resistance_ohm=k * k * circuit.rotor_resistance_ohm,
        magnetising_inductance_h=k * mutual,
        # L_S - k M with L_S = M + its leakage
        leakage_inductance_h=circuit.stator_leakage_h + (1 - k) * mutual,
    )


def t_circuit_of_machine(machine: Machine) -> TCircuit:
    """Return the T circuit of a machine whose inductances include the mutual one."""
    mutual = machine.mutual_inductance_h
    return TCircuit(
        stator_resistance_ohm=machine.stator_resistance_ohm,
        rotor_resistance_ohm=machine.rotor_resistance_ohm,
        mutual_inductance_h=mutual,
        stator_leakage_h=machine.stator_inductance_h - mutual,
        rotor_leakage_h=machine.rotor_inductance_h - mutual,
    )
