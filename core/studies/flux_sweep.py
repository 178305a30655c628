"""Losses, voltage, efficiency and power factor of induction motors that hold a speed, over the current of their flux.

On level track the effort is the running resistance. Many pairs of flux and slip give that effort at one speed; less
flux takes less voltage and less magnetising current, and more torque current.

Source: Rawicki, (33)-(43).
"""

import math
from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.drive.induction.machine import SteadyState, phase_voltage_v, steady_state, torque_constant
from railjoule.core.drive.induction.traction import flux_current, traction_machines
from railjoule.core.errors import ScenarioError
from railjoule.core.physics.resistance import (
    resistance_coefficients,
    running_resistance,
    starting_resistance,
    starting_terms,
)
from railjoule.core.scenario import Vehicle
from railjoule.core.units import MS_PER_KMH

POINTS = 121
FIRST_SHARE = 0.5
"""The sweep begins at this share of the flux current of minimum loss: below, losses grow as its inverse square."""


@dataclass(frozen=True)
class FluxPoint:
    """One motor in steady state with one flux.

    Parameters
    ----------
    flux_current_a, torque_current_a : float
        Currents along and across the flux, amplitudes per phase [A].
    phase_voltage_v : float
        Amplitude per phase [V].
    input_power_w : float
        Power at the terminals, iron loss included [W].
    loss_w : float
        Input power less the power of the shaft [W].
    efficiency : float
        Power of the shaft over input power, (43).
    power_factor : float
        Input power over apparent power, as in `power_factor`.
    """

    flux_current_a: float
    torque_current_a: float
    phase_voltage_v: float
    input_power_w: float
    loss_w: float
    efficiency: float
    power_factor: float


@dataclass(frozen=True)
class FluxSweep:
    """One motor of a train that holds a speed on level track, with different fluxes.

    Parameters
    ----------
    speed_ms, effort_n : float
        Speed [m/s] and tractive effort of the train [N].
    max_phase_voltage_v : float
        Voltage limit, amplitude per phase [V].
    points : tuple of FluxPoint
        Over rising flux, up to the rated one, whether or not the voltage allows it.
    min_loss, within_voltage, rated : FluxPoint
        With the flux of minimum loss, the largest flux that the voltage allows, and the rated flux.
    """

    speed_ms: float
    effort_n: float
    max_phase_voltage_v: float
    points: tuple[FluxPoint, ...]
    min_loss: FluxPoint
    within_voltage: FluxPoint
    rated: FluxPoint

    def values(self, name: str) -> FloatArray:
        """Return one quantity of all points, by its name in `FluxPoint`; shape (n,)."""
        return frozen_array([getattr(point, name) for point in self.points])


def sweep_flux(vehicle: Vehicle, speed_ms: float) -> FluxSweep:
    """Compute a motor's steady state over its flux while the train holds a speed on level track.

    Parameters
    ----------
    vehicle : Vehicle
        With induction motors.
    speed_ms : float
        Speed [m/s].

    Raises
    ------
    ScenarioError
        If the drive has no induction machine, or the speed is not above 0 and at most the vehicle's maximum.
    """
    top_kmh = vehicle.traction.max_speed_kmh
    if not 0 < speed_ms <= top_kmh * MS_PER_KMH:
        raise ScenarioError(
            f"cruise_speed_kmh = {speed_ms / MS_PER_KMH:g} must be above 0 and at most the vehicle's {top_kmh:g} km/h."
        )
    machines = traction_machines(vehicle.drive)
    machine = machines.machine
    effort = running_resistance(*resistance_coefficients(vehicle), speed_ms, speed_ms**2)
    effort += starting_resistance(*starting_terms(vehicle), speed_ms)
    shaft_nm = effort / (machines.motors * machines.turns_per_metre * machines.gear_efficiency)
    shaft_w = shaft_nm * machines.turns_per_metre * speed_ms
    rotor_rads = machine.pole_pairs * machines.turns_per_metre * speed_ms
    torque_nm = shaft_nm + machine.mechanical_loss_torque_nm
    best = flux_current(machine, True, torque_nm, rotor_rads)

    def at(flux_current_a: float) -> FluxPoint:
        torque_current = torque_nm / (torque_constant(machine) * flux_current_a)
        state = steady_state(machine, flux_current_a, torque_current, rotor_rads)
        return FluxPoint(
            flux_current_a=flux_current_a,
            torque_current_a=torque_current,
            phase_voltage_v=phase_voltage_v(state),
            input_power_w=state.input_power_w,
            loss_w=state.input_power_w - shaft_w,
            efficiency=shaft_w / state.input_power_w,
            power_factor=power_factor(state, flux_current_a, torque_current),
        )

    currents = np.linspace(FIRST_SHARE * best, machine.magnetising_current_a, POINTS).tolist()
    return FluxSweep(
        speed_ms=speed_ms,
        effort_n=effort,
        max_phase_voltage_v=machine.max_phase_voltage_v,
        points=tuple(map(at, currents)),
        min_loss=at(best),
        within_voltage=at(flux_current(machine, False, torque_nm, rotor_rads)),
        rated=at(machine.magnetising_current_a),
    )


def power_factor(state: SteadyState, flux_current_a: float, torque_current_a: float) -> float:
    """Return input power over apparent power of a machine's three phases; negative where it generates.

    Parameters
    ----------
    state : SteadyState
        With these currents.
    flux_current_a, torque_current_a : float
        Amplitudes per phase [A].
    """
    # three phases of sinusoidal amplitudes carry 3/2 of the product
    apparent = 1.5 * phase_voltage_v(state) * math.hypot(flux_current_a, torque_current_a)
    return state.input_power_w / apparent
