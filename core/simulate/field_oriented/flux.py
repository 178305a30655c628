"""The flux that the motor control asks for along a reference: it takes a second to build up, so it looks ahead."""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.drive.induction.flux import fill_flux_currents
from railjoule.core.drive.induction.traction import TractionMachines
from railjoule.core.motion import Course
from railjoule.core.physics.resistance import running_resistance
from railjoule.core.simulate.field_oriented.reference import Reference

VOLTAGE_RESERVE = 0.02
"""Share of the voltage that is kept for the control."""
LEAST_FLUX_SHARE = 0.2
"""Of the rated flux, so that the machine is ready."""
COARSE = 10
"""Samples of the reference from one flux to the next."""
WINDOW_S = 1.2
"""Over how long a change of the flux is spread."""


@dataclass(frozen=True, eq=False)
class FluxPlan:
    """Flux linkages of the rotor in the inverse-gamma circuit at the samples of a reference; shape (n,).

    Parameters
    ----------
    flux_vs, rate_v : array
        Flux and its derivative [V s, V].
    weakest_share : float
        Least flux that the voltage allows over the rated one; 1 where it carries the rated flux all the way.
    """

    flux_vs: FloatArray
    rate_v: FloatArray
    weakest_share: float


def plan_flux(reference: Reference, course: Course, machines: TractionMachines, least_loss: bool) -> FluxPlan:
    """Return the flux along a reference.

    Parameters
    ----------
    reference : Reference
        What the train follows.
    course : Course
        What the control knows of train and line.
    machines : TractionMachines
        The machines, with the voltage that they find.
    least_loss : bool
        Whether the flux is that of least loss; else the rated one as long as the voltage carries it.
    """
    speed, rated = reference.speed_ms[::COARSE], machines.machine.magnetising_current_a
    torque = _torque_nm(reference, course, machines)
    voltage = (1 - VOLTAGE_RESERVE) * machines.machine.max_phase_voltage_v
    machine = machines.machine._replace(max_phase_voltage_v=voltage)
    rotor_rads = machine.pole_pairs * machines.turns_per_metre * speed
    found = np.empty_like(speed)
    fill_flux_currents(machine, False, torque, rotor_rads, found)
    half = max(round(0.5 * WINDOW_S / (COARSE * reference.step_s)), 1)
    within = _spread(minimum_filter1d(found, 2 * half + 1, mode="nearest"), half)
    current = within
    if least_loss:
        fill_flux_currents(machine, True, torque, rotor_rads, found)
        wanted = np.maximum(found, LEAST_FLUX_SHARE * rated)
        current = np.minimum(_spread(maximum_filter1d(wanted, 2 * half + 1, mode="nearest"), half), within)
    flux = machines.circuit.magnetising_inductance_h * current
    time, coarse = reference.time_s, reference.time_s[::COARSE]
    rate = np.gradient(flux, coarse)
    return FluxPlan(
        flux_vs=frozen_array(np.interp(time, coarse, flux)),
        rate_v=frozen_array(np.interp(time, coarse, rate)),
        weakest_share=float(within.min() / rated),
    )


def _torque_nm(reference: Reference, course: Course, machines: TractionMachines) -> FloatArray:
    """Return the electromagnetic torque of each machine along a reference [N m]."""
    data = course.data
    speed = np.maximum(reference.speed_ms[::COARSE], 0.0)
    places = reference.position_m[::COARSE]
    cell = np.clip(np.searchsorted(course.position_m, places, side="right") - 1, 0, course.cell_count - 1)
    running = running_resistance(
        data.resistance_constant_n, data.resistance_linear, data.resistance_quadratic[cell], speed, speed * speed
    )
    moving = np.where(speed > 0, running + course.curve_force_n[cell], 0.0)
    inertia = 2 * data.half_inertia_kg * reference.acceleration_ms2[::COARSE]
    force = inertia + moving + course.gradient_force_n[cell]
    gear = np.where(force > 0, 1 / machines.gear_efficiency, machines.gear_efficiency)
    shaft: FloatArray = force * gear / (machines.motors * machines.turns_per_metre)
    return shaft + machines.machine.mechanical_loss_torque_nm


def _spread(values: FloatArray, half: int) -> FloatArray:
    """Return a twofold moving average, which changes no value by more than the extremes near by."""
    once = uniform_filter1d(values, half | 1, mode="nearest")
    spread: FloatArray = uniform_filter1d(once, half | 1, mode="nearest")
    return spread
