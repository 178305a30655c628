"""A run in closed loop: its samples, extremes, energies and notes."""

from dataclasses import dataclass
from typing import Literal, NamedTuple

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.induction.traction import TractionMachines
from railjoule.core.energy import share_above
from railjoule.core.scenario import Scenario
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH


class Saturation(NamedTuple):
    """A stretch of time in which a limit of the inverter held the machines back.

    Parameters
    ----------
    start_s, end_s : float
        On the plan's clock [s].
    what : str
        Which limit.
    lag_m : float
        How far the train was behind the plan at most meanwhile, negative where it was ahead [m].
    """

    start_s: float
    end_s: float
    what: Literal["current", "voltage"]
    lag_m: float


@dataclass(frozen=True, eq=False)
class FieldOrientedRun:
    """A plan and how the machines drove it; arrays of shape (n,), on the plan's clock.

    The clock begins half of `reference_window_s` before the plan. Currents, flux, voltage and torque are those of one
    machine, currents along and across the flux that its control assumes; powers and energies those of all.

    Parameters
    ----------
    scenario : Scenario
        What was simulated.
    planned, actual : Trajectory
        The run as planned, and as driven.
    machines : TractionMachines
        As they really are.
    time_s, position_m, speed_ms : array
        Time, true position and speed [s, m, m/s].
    reference_position_m, tracking_error_m : array
        The planned position at that time, and how far the train is behind it [m].
    flux_current_a, torque_current_a : array
        Currents i_d and i_q, amplitudes per phase [A].
    rotor_flux_vs : array
        True flux linkage of the rotor in the T circuit [V s].
    phase_voltage_v : array
        Amplitude of the voltage of a phase [V].
    voltage_limit_v : float
        Its limit [V].
    torque_nm : array
        Electromagnetic torque of one machine [N m].
    line_power_w : array
        Taken from the line, auxiliaries included [W].
    energy_by_input_power_j : array
        Energy so far, as the integral of the machines' input power [J].
    energy_by_parts_j : array
        The same as the sum of its parts [J].
    magnetising_so_far_j : array
        Copper loss of the magnetising current in the stator so far; the paper's account leaves that out [J].
    parts_j : dict of str to float
        Those parts at the end: shaft, stator_copper, rotor_copper, magnetising, iron, and what is stored in the
        magnetic fields, which is no loss [J].
    max_tracking_error_m, final_error_m : float
        Largest distance from the planned position, and how far beyond its end the train stands [m].
    max_current_a : float
        Largest current of a phase [A].
    max_torque_current_a, min_torque_current_a : float
        Extremes of i_q [A].
    max_phase_voltage_v : float
        Largest amplitude of the voltage [V].
    delay_s : float
        How much later than planned it passes the point a tenth of a metre before its end [s]; where it overruns its
        end, how much later it stands.
    saturated : tuple of Saturation
        When limits held the machines back.
    notes : tuple of str
        Sentences on what the run shows and takes for granted.
    """

    scenario: Scenario
    planned: Trajectory
    actual: Trajectory
    machines: TractionMachines
    time_s: FloatArray
    position_m: FloatArray
    speed_ms: FloatArray
    reference_position_m: FloatArray
    tracking_error_m: FloatArray
    flux_current_a: FloatArray
    torque_current_a: FloatArray
    rotor_flux_vs: FloatArray
    phase_voltage_v: FloatArray
    voltage_limit_v: float
    torque_nm: FloatArray
    line_power_w: FloatArray
    energy_by_input_power_j: FloatArray
    energy_by_parts_j: FloatArray
    magnetising_so_far_j: FloatArray
    parts_j: dict[str, float]
    max_tracking_error_m: float
    final_error_m: float
    max_current_a: float
    max_torque_current_a: float
    min_torque_current_a: float
    max_phase_voltage_v: float
    delay_s: float
    saturated: tuple[Saturation, ...]
    notes: tuple[str, ...]

    @property
    def magnetising_loss_j(self) -> float:
        """What the current that makes the flux loses in the stator [J]; the paper's account leaves it out."""
        return self.parts_j["magnetising"]

    @property
    def energy_by_input_power_kwh(self) -> float:
        """Energy as the integral of the machines' input power [kWh]."""
        return float(self.energy_by_input_power_j[-1]) / J_PER_KWH

    @property
    def energy_by_parts_kwh(self) -> float:
        """Energy as the sum of its parts [kWh]."""
        return float(self.energy_by_parts_j[-1]) / J_PER_KWH

    @property
    def magnetising_loss_kwh(self) -> float:
        """The same as `magnetising_loss_j` [kWh]."""
        return self.magnetising_loss_j / J_PER_KWH

    @property
    def paper_energy_kwh(self) -> float:
        """Energy in the paper's account, which leaves out the magnetising loss [kWh]."""
        return self.energy_by_input_power_kwh - self.magnetising_loss_kwh

    @property
    def stop_error_m(self) -> float:
        """How far beyond its end the train stands [m]."""
        return self.final_error_m

    @property
    def overconsumption(self) -> float:
        """Fraction by which the energy lies above that of the plan; NaN where that is no measure."""
        return share_above(self.actual.energy.net_j, self.planned.energy.net_j)
