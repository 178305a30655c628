"""What Ftorek's strategies know of a line: its length, and one resistance for all of it."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.kinds import COPPER_LOSS
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.motion import Course
from railjoule.core.physics.cell import mean_speed
from railjoule.core.physics.course_data import electric_limit_n, tractive_limit_n
from railjoule.core.physics.resistance import running_resistance
from railjoule.core.task import Task
from railjoule.core.units import MS_PER_KMH, N_PER_KN, distinct_numbers

ALLOWED_EXCESS = 1e-6
"""By which share a run may pass a limit: of the limit itself, of an effort as a share of the greatest tractive one."""
# It is ten times what a step of dynamic programming may: these runs come from formulas, and their forces are
# differences of squares of speed, whose rounding grows as cells get short

# Lengths and resistances that differ by less, relatively, are the same: sums over a mesh round their last digits
SAME = 1e-9
# Digits of an effort or an acceleration in a refusal; more where two numbers would read the same
EFFORT_DIGITS = 3


@dataclass(frozen=True)
class PlainLine:
    """A line without limits and stops, its gradients taken as their mean.

    Parameters
    ----------
    distance_m : float
        Length [m].
    inertia_kg : float
        Mass that resists acceleration [kg].
    constant_n, linear, quadratic : float
        Resistance A + B v + C v^2, the mean force of the line in A [N, N s/m, N s2/m2].
    loss_coefficient : float
        Copper loss over effort squared [W/N2].
    notes : tuple of str
        What was simplified.
    initial_speed_ms, final_speed_ms : float
        Speeds at the ends [m/s], omega_0 and omega_m of (10).
    """

    distance_m: float
    inertia_kg: float
    constant_n: float
    linear: float
    quadratic: float
    loss_coefficient: float
    notes: tuple[str, ...]
    initial_speed_ms: float = 0.0
    final_speed_ms: float = 0.0

    def resistance_n(self, speed_ms: FloatArray) -> FloatArray:
        """Return what resists at speeds [m/s], line included [N]; shape as the argument's."""
        return running_resistance(self.constant_n, self.linear, self.quadratic, speed_ms, np.square(speed_ms))


def plain_line(task: Task) -> PlainLine:
    """Return what is left of a task's line, or refuse it.

    Raises
    ------
    StrategyRefusedError
        If the run has planned stops, passing points, neutral sections or a lower limit than the vehicle's, or the drive
        no copper loss.
    """
    course, scenario = task.course, task.scenario
    data = course.data
    if scenario.line.inner_stations:
        raise StrategyRefusedError("needs a line without stops between its ends.")
    require_no_passing_points(task)
    require_no_neutral_sections(task)
    if np.min(plain_limits_ms(course)) < scenario.vehicle.traction.max_speed_kmh * MS_PER_KMH * (1 - SAME):
        raise StrategyRefusedError("needs a line without limits.")
    if data.drive_kind != COPPER_LOSS or data.drive_parameters[0] <= 0:
        raise StrategyRefusedError("needs a drive with copper loss.")
    if np.ptp(data.resistance_quadratic) > SAME * data.resistance_quadratic[0]:
        raise StrategyRefusedError("needs a line without tunnels, or one that lies in a tunnel from end to end.")
    # over a closed distance the mean force does the work of the true one; what differs is where
    line_force = float(np.average(data.line_force_n, weights=data.cell_length_m))
    notes = []
    if np.ptp(data.line_force_n) > SAME * max(1.0, abs(line_force)):
        notes.append(_note_on_the_mean(course))
    if scenario.vehicle.drive.recuperation_factor < 1:
        notes.append("The plan assumes that all the energy generated in braking is recuperated.")
    return PlainLine(
        distance_m=course.length_m,
        inertia_kg=2 * data.half_inertia_kg,
        constant_n=data.resistance_constant_n + line_force,
        linear=data.resistance_linear,
        quadratic=float(data.resistance_quadratic[0]),
        loss_coefficient=float(data.drive_parameters[0]),
        notes=tuple(notes),
        initial_speed_ms=task.end_speeds_ms[0],
        final_speed_ms=task.end_speeds_ms[1],
    )


@dataclass(frozen=True, eq=False)
class SampledRun:
    """A run over a plain line as samples over time, arrays of shape (m,).

    Parameters
    ----------
    time_s, position_m, speed_ms, acceleration_ms2, effort_n : array
        Samples of the run; a jump of the effort is two samples at one time.
    energy_j : array
        Energy taken so far, copper loss and work at the shaft [J].
    shaft_energy_j : float
        Work against resistance over the whole run [J].
    """

    time_s: FloatArray
    position_m: FloatArray
    speed_ms: FloatArray
    acceleration_ms2: FloatArray
    effort_n: FloatArray
    energy_j: FloatArray
    shaft_energy_j: float

    @property
    def total_energy_j(self) -> float:
        """Energy of the whole run, all braking energy returned [J]."""
        return float(self.energy_j[-1])

    @property
    def peak_energy_j(self) -> float:
        """Most energy taken at any time [J]."""
        return float(np.max(self.energy_j))


def plain_limits_ms(course: Course) -> FloatArray:
    """Return the limits of a course [m/s] without a braking curve of the vehicle; shape (n,) with one, else (n + 1,).

    Whether a run keeps such a curve shows once there is a run.
    """
    return course.cell_limit_ms if _has_braking_curve(course) else np.sqrt(course.data.largest_speed2)


def _has_braking_curve(course: Course) -> bool:
    return bool(np.isfinite(course.permitted_deceleration_ms2))


def require_no_passing_points(task: Task) -> None:
    """Raise StrategyRefusedError if the train passes a place at a given speed."""
    if task.scenario.line.passing_points:
        raise StrategyRefusedError("needs a line without passing points.")


def require_no_neutral_sections(task: Task) -> None:
    """Raise StrategyRefusedError if a part of the line has no traction power."""
    if task.scenario.line.neutral_sections:
        raise StrategyRefusedError("needs a line without neutral sections.")


def _note_on_the_mean(course: Course) -> str:
    if not np.ptp(course.gradient_force_n):
        return "Curves are replaced by their mean resistance."
    mean = float(np.average(course.gradient_permille, weights=course.data.cell_length_m))
    return f"Gradients are replaced by their mean, {mean:.2f} per mille."


def check_feasible(course: Course, speed2: FloatArray) -> None:
    """Refuse a run that needs more effort, speed or acceleration than available.

    Raises
    ------
    StrategyRefusedError
        With the first place where it does.
    """
    data = course.data
    check_speeds(course, speed2)
    for broken in broken_efforts(course, speed2):
        # what stands for a missing brake is none
        negligible = broken.limit < ALLOWED_EXCESS * data.traction.constant_n
        available = 0.0 if negligible else broken.limit
        needed, most = distinct_numbers(broken.reached / N_PER_KN, available / N_PER_KN, EFFORT_DIGITS)
        place = course.position_m[broken.cell]
        raise StrategyRefusedError(
            f"{broken.does} with {needed} kN at {place:.0f} m, where at most {most} kN are available."
        )
    check_accelerations(course, speed2)


def check_speeds(course: Course, speed2: FloatArray) -> None:
    """Refuse a run that is faster than limits or a braking curve permit; errors as `check_feasible`."""
    permitted2 = course.data.largest_speed2
    over = np.flatnonzero(speed2 > permitted2 * (1 + ALLOWED_EXCESS))
    if not len(over):
        return
    node = int(over[0])
    speed_kmh, limit_kmh = (float(np.sqrt(of[node])) / MS_PER_KMH for of in (speed2, permitted2))
    needed, allowed = distinct_numbers(speed_kmh, limit_kmh)
    # of both cells that meet at the node
    limit_ms = np.min(course.cell_limit_ms[max(node - 1, 0) : node + 1])
    if _has_braking_curve(course) and permitted2[node] < limit_ms**2 * (1 - SAME):
        raise StrategyRefusedError(
            f"needs {needed} km/h at {course.position_m[node]:.0f} m, but the permitted deceleration "
            f"(vehicle.braking.permitted_deceleration) allows only {allowed} km/h there."
        )
    raise StrategyRefusedError(f"needs {needed} km/h, but only {allowed} km/h is allowed.")


def check_accelerations(course: Course, speed2: FloatArray) -> None:
    """Refuse a run that accelerates or slows down more than is allowed; errors as `check_feasible`."""
    for broken in broken_accelerations(course, speed2):
        place = course.position_m[broken.cell]
        by, allowed = distinct_numbers(broken.reached, broken.limit, EFFORT_DIGITS)
        raise StrategyRefusedError(f"{broken.does} by {by} m/s2 at {place:.0f} m, but only {allowed} m/s2 is allowed.")


class BrokenLimit(NamedTuple):
    """The first cell in which a run breaks a limit, and what it does there; efforts in N, accelerations in m/s2."""

    does: str
    cell: int
    reached: float
    limit: float


def broken_efforts(course: Course, speed2: FloatArray) -> list[BrokenLimit]:
    """Return which of the limits of tractive and braking effort a run breaks by more than rounding."""
    data = course.data
    speed = np.sqrt(speed2)
    mean = mean_speed(speed[:-1], speed[1:])
    force = course.net_force_n(speed2)
    pulls = force - tractive_limit_n(data, mean), force, "pulls"
    brakes = -force - electric_limit_n(data, mean) - data.friction_effort_n, -force, "brakes"
    broken = []
    for excess, effort, does in (pulls, brakes):
        over = np.flatnonzero(excess > ALLOWED_EXCESS * data.traction.constant_n)
        if len(over):
            cell = int(over[0])
            broken.append(BrokenLimit(does, cell, abs(float(effort[cell])), abs(float(effort[cell])) - excess[cell]))
    return broken


def broken_accelerations(course: Course, speed2: FloatArray) -> list[BrokenLimit]:
    """Return which of the limits of acceleration and deceleration a run breaks by more than rounding."""
    data = course.data
    # dv/dt = v dv/dx = d(v^2 / 2)/dx, exact in a cell, over which the square of speed is linear
    acceleration = 0.5 * np.diff(speed2) / data.cell_length_m
    speeds_up = acceleration, data.max_acceleration_ms2, "accelerates"
    slows_down = -acceleration, data.max_deceleration_ms2, "slows down"
    broken = []
    for reached, limit, does in (speeds_up, slows_down):
        over = np.flatnonzero(reached > limit * (1 + ALLOWED_EXCESS))
        if len(over):
            broken.append(BrokenLimit(does, int(over[0]), float(reached[over[0]]), limit))
    return broken
