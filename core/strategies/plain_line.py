"""What Ftorek's strategies know of a line: its length, and one resistance for all of it."""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.kinds import COPPER_LOSS
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.motion import Course
from railjoule.core.physics.resistance import running_resistance
from railjoule.core.task import Task
from railjoule.core.units import MS_PER_KMH

ALLOWED_EXCESS = 1e-6


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
    """

    distance_m: float
    inertia_kg: float
    constant_n: float
    linear: float
    quadratic: float
    loss_coefficient: float
    notes: tuple[str, ...]

    def resistance_n(self, speed_ms: FloatArray) -> FloatArray:
        """Return what resists at speeds [m/s], line included [N]; shape as the argument's."""
        return running_resistance(self.constant_n, self.linear, self.quadratic, speed_ms, np.square(speed_ms))


def plain_line(task: Task) -> PlainLine:
    """Return what is left of a task's line, or refuse it.

    Raises
    ------
    StrategyRefusedError
        If the run has planned stops, moving ends or a lower limit than the vehicle's, or the drive no copper loss.
    """
    course, scenario = task.course, task.scenario
    data = course.data
    if scenario.line.inner_stations:
        raise StrategyRefusedError("needs a line without stops between its ends.")
    if data.fixed_speed2[0] > 0 or data.fixed_speed2[-1] > 0:
        raise StrategyRefusedError("needs a run that starts and ends at rest.")
    vehicle_limit = (scenario.vehicle.traction.max_speed_kmh * MS_PER_KMH) ** 2
    if np.min(data.largest_speed2) < vehicle_limit * (1 - 1e-9):
        raise StrategyRefusedError("needs a line without limits.")
    if data.drive_kind != COPPER_LOSS or data.drive_parameters[0] <= 0:
        raise StrategyRefusedError("needs a drive with copper loss.")
    if np.ptp(data.resistance_quadratic) > 1e-9 * data.resistance_quadratic[0]:
        raise StrategyRefusedError("needs a line without tunnels, or one that lies in a tunnel from end to end.")
    line_force = float(np.average(data.line_force_n, weights=data.cell_length_m))
    notes = []
    if np.ptp(data.line_force_n) > 1e-9 * max(1.0, abs(line_force)):
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
    )


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
    over = np.flatnonzero(speed2 > data.largest_speed2 * (1 + ALLOWED_EXCESS))
    if len(over):
        raise StrategyRefusedError(
            f"needs {np.sqrt(speed2[over[0]]) / MS_PER_KMH:.1f} km/h, but only "
            f"{np.sqrt(data.largest_speed2[over[0]]) / MS_PER_KMH:.1f} is allowed."
        )
    mean_speed = 0.5 * (np.sqrt(speed2[1:]) + np.sqrt(speed2[:-1]))
    force = course.net_force_n(speed2)
    for excess, words in (
        (force - data.traction.effort_n(mean_speed), "pulls"),
        (-force - data.braking.effort_n(mean_speed) - data.friction_effort_n, "brakes"),
    ):
        over = np.flatnonzero(excess > ALLOWED_EXCESS * data.traction.constant_n)
        if len(over):
            cell = over[0]
            raise StrategyRefusedError(
                f"{words} with {abs(force[cell]) / 1e3:.0f} kN at {course.position_m[cell]:.0f} m, "
                f"{excess[cell] / 1e3:.1f} kN more than available."
            )
    rise = 0.5 * np.diff(speed2) / data.cell_length_m
    for reached, limit, words in (
        (rise, data.max_acceleration_ms2, "accelerates"),
        (-rise, data.max_deceleration_ms2, "slows down"),
    ):
        over = np.flatnonzero(reached > limit * (1 + ALLOWED_EXCESS))
        if len(over):
            place = course.position_m[over[0]]
            raise StrategyRefusedError(
                f"{words} by {reached[over[0]]:.2f} m/s2 at {place:.0f} m, but only {limit:.2f} is allowed."
            )
