"""The flux requested of the motor control along a reference: it takes a second to build up, so it looks ahead."""

from dataclasses import dataclass

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.drive.induction.flux import fill_flux_currents
from railjoule.core.drive.induction.traction import TractionMachines
from railjoule.core.motion import Course
from railjoule.core.physics.resistance import running_resistance
from railjoule.core.simulation.field_oriented.reference import Reference

# Fraction of the voltage that steady state leaves to the control: Ls di/dt of a changing torque needs some. More
# weakens the flux sooner, with more current for the same torque; without any, the control is at its limit all along.
VOLTAGE_RESERVE = 0.02
# Least flux over the rated one. With less, a coasting train would lose still less, and wait longer for its torque.
LOWEST_FLUX_FRACTION = 0.2
# Samples of the reference from one flux to the next, 20 ms: the flux changes over tenths of a second.
COARSE = 10
# Time over which a change of the flux is spread; assumed. A change by D then has a rate of at most D over half of it,
# and takes D / (Rr 0.6 s) of current: beside the D / Lm that keeps the flux it counts as the rotor's time constant over
# 0.6 s, 0.9 for Ftorek's machine and 0.4 for the tram's. A shorter window takes more current, which torque then lacks;
# a longer one keeps a higher or weaker flux than needed, and its loss, for longer.
WINDOW_S = 1.2


@dataclass(frozen=True, eq=False)
class FluxPlan:
    """Flux linkages of the rotor in the inverse-gamma circuit at the samples of a reference; shape (n,).

    Parameters
    ----------
    flux_vs, rate_v : array
        Flux and its derivative [V s, V].
    lowest_fraction : float
        Least flux that the voltage allows over the rated one; 1 where it allows the rated flux all along.
    """

    flux_vs: FloatArray
    rate_v: FloatArray
    lowest_fraction: float


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
        Whether the flux is that of least loss; else the rated one as long as the voltage allows it.
    """
    speed, rated = reference.speed_ms[::COARSE], machines.machine.magnetising_current_a
    torque = _torque_nm(reference, course, machines)
    voltage = (1 - VOLTAGE_RESERVE) * machines.machine.max_phase_voltage_v
    machine = machines.machine._replace(max_phase_voltage_v=voltage)
    rotor_rads = machine.pole_pairs * machines.turns_per_metre * speed
    found = np.empty_like(speed)
    fill_flux_currents(machine, False, torque, rotor_rads, found)
    half = max(round(0.5 * WINDOW_S / (COARSE * reference.step_s)), 1)
    # Each of the averaged values is the least of a window that reaches the instant itself, so their average exceeds
    # nowhere what the voltage allows: the flux goes down ahead. With the largest it goes up ahead of the torque.
    within = _spread(scipy.ndimage.minimum_filter1d(found, 2 * half + 1, mode="nearest"), half)
    current = within
    if least_loss:
        fill_flux_currents(machine, True, torque, rotor_rads, found)
        requested = np.maximum(found, LOWEST_FLUX_FRACTION * rated)
        current = np.minimum(
            _spread(scipy.ndimage.maximum_filter1d(requested, 2 * half + 1, mode="nearest"), half), within
        )
    flux = machines.circuit.magnetising_inductance_h * current
    time, coarse = reference.time_s, reference.time_s[::COARSE]
    rate = np.gradient(flux, coarse)
    return FluxPlan(
        flux_vs=frozen_array(np.interp(time, coarse, flux)),
        rate_v=frozen_array(np.interp(time, coarse, rate)),
        lowest_fraction=float(within.min() / rated),
    )


def _torque_nm(reference: Reference, course: Course, machines: TractionMachines) -> FloatArray:
    """Return the electromagnetic torque of each machine along a reference [N m]."""
    data = course.data
    speed = np.maximum(reference.speed_ms[::COARSE], 0.0)
    positions = reference.position_m[::COARSE]
    cell = np.clip(np.searchsorted(course.position_m, positions, side="right") - 1, 0, course.cell_count - 1)
    running = running_resistance(
        data.resistance_constant_n, data.resistance_linear, data.resistance_quadratic[cell], speed, speed * speed
    )
    # at a stand friction holds, it does not push back
    against = np.where(speed > 0, running + course.curve_force_n[cell], 0.0)
    inertia = 2 * data.half_inertia_kg * reference.acceleration_ms2[::COARSE]
    force = inertia + against + course.gradient_force_n[cell]
    gear = np.where(force > 0, 1 / machines.gear_efficiency, machines.gear_efficiency)
    shaft: FloatArray = force * gear / (machines.motors * machines.turns_per_metre)
    return shaft + machines.machine.mechanical_loss_torque_nm


def _spread(values: FloatArray, half: int) -> FloatArray:
    """Return a twofold moving average, which stays within the extremes of its window.

    Twice, so that the rate of the flux, and with it the current that makes it, has no jumps.
    """
    # the filters need odd lengths to be centred
    once = scipy.ndimage.uniform_filter1d(values, half | 1, mode="nearest")
    spread: FloatArray = scipy.ndimage.uniform_filter1d(once, half | 1, mode="nearest")
    return spread
