"""The motion and the flux that a closed loop follows: any planned run, its corners rounded.

Within a cell of a plan the acceleration is constant, so its speed is a polygon over time. Two moving averages, each
over half of a window centred at its instant, make acceleration continuous and jerk finite. They are differences of the
plan's own integrals, exact to rounding, without ringing or delay. The reference begins and ends half a window outside
the plan. The flux takes a second to build up, so its plan looks ahead.
"""

from typing import NamedTuple

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.induction.traction import TractionMachines, fill_flux_currents
from railjoule.core.motion import MeshedLine
from railjoule.core.physics.resistance import running_resistance
from railjoule.core.trajectory import Trajectory

# Time between two samples; within it the kernel goes on with the jerk. Much shorter than any window over which corners
# are rounded (0.02 s at least), so that the jerk is resolved; shorter still only takes more memory.
STEP_S = 0.002
# So many seconds are rounded on a clock of their own. Second differences of double integrals lose digits with the
# square of the clock's reading over the window: 10 s over 0.01 s leave ten of sixteen digits, an hour would leave five.
BLOCK_S = 10.0
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


class Reference(NamedTuple):
    """Samples of a planned run.

    Parameters
    ----------
    start_s, step_s : float
        Time of the first sample on the plan's clock, and between two [s].
    samples : array of shape (n, 6)
        Position, speed, acceleration, jerk, rotor flux of the inverse-gamma circuit and its rate
        [m, m/s, m/s2, m/s3, V s, V].
    planned_m : array of shape (n,)
        The plan's own position at the same times [m].
    """

    start_s: float
    step_s: float
    samples: FloatArray
    planned_m: FloatArray

    @property
    def time_s(self) -> FloatArray:
        """Times of the samples on the plan's clock [s]; shape (n,)."""
        time: FloatArray = self.start_s + self.step_s * np.arange(len(self.samples), dtype=np.float64)
        return time


def make_reference(planned: Trajectory, window_s: float, step_s: float = STEP_S) -> Reference:
    """Return a plan as a reference without corners, and without a flux.

    Parameters
    ----------
    planned : Trajectory
        The plan.
    window_s : float
        Over how long a corner is rounded [s].
    step_s : float
        Between two samples [s].
    """
    half = 0.5 * window_s
    time = planned.time_s[0] - half + step_s * np.arange(int(np.ceil((planned.travel_time_s + window_s) / step_s)) + 1)
    # samples in rows, as the kernel reads all six numbers of one instant
    samples, count = np.zeros((len(time), 6)), max(int(BLOCK_S / step_s), 1)
    for first in range(0, len(time), count):
        block = slice(first, first + count)
        samples[block, :4] = _rounded(planned, time[block], half)
    return Reference(float(time[0]), step_s, samples, planned_position_m(planned, time))


def planned_position_m(planned: Trajectory, time_s: FloatArray) -> FloatArray:
    """Return the position of a plan at times on its clock [m]; shape as the times'."""
    plan, first = _plan_between(planned, planned.time_s[0], planned.time_s[-1])
    position: FloatArray = planned.position_m[0] + plan.antiderivative()(time_s - planned.time_s[first])
    return position


def _plan_between(planned: Trajectory, from_s: float, to_s: float) -> tuple[scipy.interpolate.PPoly, int]:
    """Return the speed of a plan over an interval of time, and the node at which its clock begins.

    The train stands before the first node and after the last one.
    """
    first = max(int(np.searchsorted(planned.time_s, from_s, side="right")) - 1, 0)
    last = int(np.searchsorted(planned.time_s, to_s)) + 1
    time, speed = planned.time_s[first:last] - planned.time_s[first], planned.speed_ms[first:last]
    # cells that take no time are left out
    corner = np.append(True, np.diff(time) > 0)
    time, speed = time[corner], speed[corner]
    slope = np.diff(speed) / np.diff(time)
    borders = np.concatenate([[-1.0], time, [time[-1] + 1.0]])
    coefficients = np.array([[0.0, *slope, 0.0], [0.0, *speed]])
    return scipy.interpolate.PPoly(coefficients, borders), first


def _rounded(planned: Trajectory, time_s: FloatArray, half_s: float) -> FloatArray:
    """Return position, speed, acceleration and jerk of the rounded plan; shape (n, 4).

    The clock starts at zero shortly before: integrals over hours would leave nothing of a difference over tenths of a
    second.
    """
    speed, first = _plan_between(planned, time_s[0] - half_s, time_s[-1] + half_s)
    local = time_s - planned.time_s[first]
    # Two moving averages over half of the window each are the second difference of the double integral over half_s^2.
    # Of the double and single integral of position, of position and speed, it gives the rounded position and its first
    # three derivatives.
    rounded = np.empty((len(time_s), 4))
    for column, integrals in enumerate((3, 2, 1, 0)):
        curve = speed.antiderivative(integrals)
        before, at, after = (curve(local + shift) for shift in (-half_s, 0.0, half_s))
        rounded[:, column] = (after - 2 * at + before) / half_s**2
    rounded[:, 0] += planned.position_m[first]
    return rounded


def plan_flux(reference: Reference, mesh: MeshedLine, machines: TractionMachines, min_loss: bool) -> float:
    """Fill the flux of a reference and its rate; return the least flux that the voltage allows over the rated one.

    Parameters
    ----------
    reference : Reference
        The motion that the train follows.
    mesh : MeshedLine
        Train and line as the control assumes them.
    machines : TractionMachines
        The machines, with the supply voltage that they have.
    min_loss : bool
        Whether the flux is that of least loss; else the rated one as long as the voltage allows it.
    """
    speed, rated = reference.samples[::COARSE, 1], machines.machine.magnetising_current_a
    torque = _torque_nm(reference.samples[::COARSE], mesh, machines)
    voltage = (1 - VOLTAGE_RESERVE) * machines.machine.max_phase_voltage_v
    machine = machines.machine._replace(max_phase_voltage_v=voltage)
    rotor_rads = machine.pole_pairs * machines.turns_per_metre * speed
    found = np.empty(len(speed))
    fill_flux_currents(machine, False, torque, rotor_rads, found)
    half = max(round(0.5 * WINDOW_S / (COARSE * reference.step_s)), 1)
    # Each of the averaged values is the least of a window that reaches the instant itself, so their average exceeds
    # nowhere the flux that the voltage allows: it goes down ahead. With the largest it goes up ahead of the torque.
    within = _spread(scipy.ndimage.minimum_filter1d(found, 2 * half + 1, mode="nearest"), half)
    current = within
    if min_loss:
        fill_flux_currents(machine, True, torque, rotor_rads, found)
        requested = np.maximum(found, LOWEST_FLUX_FRACTION * rated)
        current = np.minimum(
            _spread(scipy.ndimage.maximum_filter1d(requested, 2 * half + 1, mode="nearest"), half), within
        )
    flux = machines.circuit.magnetising_inductance_h * current
    time, coarse = reference.time_s, reference.time_s[::COARSE]
    reference.samples[:, 4] = np.interp(time, coarse, flux)
    reference.samples[:, 5] = np.interp(time, coarse, np.gradient(flux, coarse))
    return float(within.min() / rated)


def _torque_nm(samples: FloatArray, mesh: MeshedLine, machines: TractionMachines) -> FloatArray:
    """Return the electromagnetic torque of each machine along samples of a reference [N m]."""
    data, speed = mesh.data, np.maximum(samples[:, 1], 0.0)
    cell = np.clip(np.searchsorted(mesh.position_m, samples[:, 0], side="right") - 1, 0, mesh.cell_count - 1)
    running = running_resistance(
        data.resistance_constant_n, data.resistance_linear, data.resistance_quadratic[cell], speed, speed * speed
    )
    # at a stand friction holds, it does not push back
    against = np.where(speed > 0, running + mesh.curve_force_n[cell], 0.0)
    force = 2 * data.half_inertia_kg * samples[:, 2] + against + mesh.gradient_force_n[cell]
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
