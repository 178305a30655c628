"""A run in closed loop: signals, extremes, energies and notes."""

from dataclasses import dataclass
from typing import Literal, NamedTuple

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.induction.traction import TractionMachines
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.leg import DrivenPlan
from railjoule.core.units import J_PER_KWH


class Saturation(NamedTuple):
    """An interval of time in which a limit of the inverter was active.

    Parameters
    ----------
    start_s, end_s : float
        On the plan's clock [s].
    what : str
        Which limit.
    lag_m : float
        Greatest distance of the train behind the plan in this interval, negative ahead of it [m].
    """

    start_s: float
    end_s: float
    what: Literal["current", "voltage"]
    lag_m: float


@dataclass(frozen=True, eq=False)
class FieldOrientedRun(DrivenPlan):
    """A plan and its run by the machines; arrays of shape (n,), on the plan's clock.

    The clock begins half of `reference_window_s` before the plan. Currents, flux, voltage and torque are those of one
    machine, currents along and across the flux that its control assumes; powers and energies those of all.

    Parameters
    ----------
    scenario : Scenario
        The simulated scenario.
    machines : TractionMachines
        The true machines.
    time_s, position_m, speed_ms : array
        Time, true position and speed [s, m, m/s].
    tracking_error_m : array
        Distance of the train behind the planned position [m].
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
    supply_power_w : array
        Taken from the supply, auxiliaries included [W].
    energy_by_input_power_j : array
        Energy so far, as the integral of the machines' input power [J].
    energy_by_parts_j : array
        Energy so far, as the sum of its parts [J].
    magnetising_so_far_j : array
        Copper loss of the magnetising current in the stator so far; the paper's energy leaves it out [J].
    parts_j : dict of str to float
        Those parts at the end: shaft, stator_copper, rotor_copper, magnetising, iron, and the energy stored in the
        magnetic fields, which is no loss [J].
    max_tracking_error_m : float
        Largest distance from the planned position [m].
    max_current_a : float
        Largest current of a phase [A].
    max_torque_current_a, min_torque_current_a : float
        Extremes of i_q [A].
    max_phase_voltage_v : float
        Largest amplitude of the voltage [V].
    delay_s : float
        Delay at the point a tenth of a metre before the end [s]; where the train overruns its end, delay of its stand.
    saturated : tuple of Saturation
        Intervals in which a limit was active.
    notes : tuple of str
        Sentences on results and assumptions of the run.
    """

    scenario: Scenario
    machines: TractionMachines
    time_s: FloatArray
    position_m: FloatArray
    speed_ms: FloatArray
    tracking_error_m: FloatArray
    flux_current_a: FloatArray
    torque_current_a: FloatArray
    rotor_flux_vs: FloatArray
    phase_voltage_v: FloatArray
    voltage_limit_v: float
    torque_nm: FloatArray
    supply_power_w: FloatArray
    energy_by_input_power_j: FloatArray
    energy_by_parts_j: FloatArray
    magnetising_so_far_j: FloatArray
    parts_j: dict[str, float]
    max_tracking_error_m: float
    max_current_a: float
    max_torque_current_a: float
    min_torque_current_a: float
    max_phase_voltage_v: float
    delay_s: float
    saturated: tuple[Saturation, ...]
    notes: tuple[str, ...]

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
        """Loss of the magnetising current in the stator [kWh]."""
        return self.parts_j["magnetising"] / J_PER_KWH

    @property
    def paper_energy_kwh(self) -> float:
        """Energy as in the paper, which leaves out the magnetising loss [kWh]."""
        return self.energy_by_input_power_kwh - self.magnetising_loss_kwh

    @property
    def stop_error_m(self) -> float:
        """How far beyond the end of its plan the train came to stand [m], even where it rolled back."""
        return float(self.position_m[-1] - self.planned.position_m[-1])
