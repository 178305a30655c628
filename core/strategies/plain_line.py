"""A line as Ftorek's strategies model it, with one resistance, and the checks of runs from formulas."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.kinds import COPPER_LOSS
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.motion import MeshedLine
from railjoule.core.physics.cell import mean_speed
from railjoule.core.physics.mesh_data import electric_limit_n, tractive_limit_n
from railjoule.core.physics.resistance import running_resistance
from railjoule.core.task import Task
from railjoule.core.units import MS_PER_KMH, N_PER_KN, distinct_numbers

ALLOWED_EXCESS = 1e-6
"""Share by which a run may exceed a limit; of an effort, a share of the maximum tractive effort."""
# It is ten times the share of a step of dynamic programming: these runs come from formulas, and their forces are
# differences of squares of speed, whose rounding grows as cells get short.

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
        The simplifications.
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
        """Return the resistance at speeds [m/s], line included [N]; shape as the argument's."""
        return running_resistance(self.constant_n, self.linear, self.quadratic, speed_ms, np.square(speed_ms))


def plain_line(task: Task) -> PlainLine:
    """Model a task's line with one resistance, or refuse it.

    Raises
    ------
    StrategyRefusedError
        If the run has planned stops, passing points, neutral sections, limits of traction or adhesion by place, or a
        lower limit of speed than the vehicle's, or the drive no copper loss.
    """
    mesh, scenario, data = task.mesh, task.scenario, task.mesh.data
    if scenario.line.inner_stations:
        raise StrategyRefusedError("needs a line without stops between its ends.")
    require_line_without(task, "passing_points", "neutral_sections", "traction_limits", "rail_conditions")
    is_limited = np.min(plain_limits_ms(mesh)) < scenario.vehicle.traction.max_speed_kmh * MS_PER_KMH * (1 - SAME)
    for is_refused, needs in (
        (is_limited, "line without limits"),
        (data.starting_n > 0, "train without vehicle.resistance.starting_n_per_kn and starting_n"),
        (data.drive_kind != COPPER_LOSS or data.drive_parameters[0] <= 0, "drive with copper loss"),
        (
            np.ptp(data.resistance_quadratic) > SAME * data.resistance_quadratic[0],
            "line without tunnels, or one that lies in a tunnel from end to end",
        ),
    ):
        if is_refused:
            raise StrategyRefusedError(f"needs a {needs}.")
    # over a closed distance the mean force does the work of the true one; only the places differ
    line_force = float(np.average(data.line_force_n, weights=data.cell_length_m))
    notes = []
    if np.ptp(data.line_force_n) > SAME * max(1.0, abs(line_force)):
        mean = float(np.average(mesh.gradient_permille, weights=data.cell_length_m))
        has_gradients = np.ptp(mesh.gradient_force_n) > 0
        gradients = f"Gradients are replaced by their mean, {mean:.2f} per mille."
        notes.append(gradients if has_gradients else "Curves are replaced by their mean resistance.")
    if scenario.vehicle.drive.recuperation_factor < 1:
        notes.append("The plan assumes that all the energy generated in braking is recuperated.")
    return PlainLine(
        distance_m=mesh.length_m,
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
        Energy so far, copper loss and work at the shaft [J].
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
        """Maximum of the energy so far [J]."""
        return float(np.max(self.energy_j))


def plain_limits_ms(mesh: MeshedLine) -> FloatArray:
    """Return the limits of a mesh [m/s] without a braking curve of the vehicle; shape (n,) with one, else (n + 1,).

    Whether a run keeps such a curve shows once there is a run.
    """
    return mesh.cell_limit_ms if _has_braking_curve(mesh) else np.sqrt(mesh.data.limit_speed2)


def _has_braking_curve(mesh: MeshedLine) -> bool:
    return bool(np.isfinite(mesh.permitted_deceleration_ms2))


def require_line_without(task: Task, *names: str) -> None:
    """Raise StrategyRefusedError if a line has any of the tables that are named, such as `passing_points`."""
    for name in names:
        if getattr(task.scenario.line, name):
            raise StrategyRefusedError(f"needs a line without {name.replace('_', ' ')}.")


def check_feasible(mesh: MeshedLine, speed2: FloatArray) -> None:
    """Refuse a run that needs more effort, speed or acceleration than available.

    Raises
    ------
    StrategyRefusedError
        With the first place where it does.
    """
    check_speeds(mesh, speed2)
    for does, cell, reached, limit in broken_efforts(mesh, speed2):
        # a missing brake has a negligible effort
        available = limit if limit >= ALLOWED_EXCESS * mesh.data.traction.constant_n else 0.0
        needed, most = distinct_numbers(reached / N_PER_KN, available / N_PER_KN, EFFORT_DIGITS)
        place = mesh.position_m[cell]
        raise StrategyRefusedError(f"{does} with {needed} kN at {place:.0f} m, where at most {most} kN are available.")
    check_accelerations(mesh, speed2)


def check_speeds(mesh: MeshedLine, speed2: FloatArray) -> None:
    """Refuse a run that is faster than limits or a braking curve permit; errors as `check_feasible`."""
    permitted2 = mesh.data.limit_speed2
    over = np.flatnonzero(speed2 > permitted2 * (1 + ALLOWED_EXCESS))
    if not len(over):
        return
    node = int(over[0])
    speed_kmh, limit_kmh = (float(np.sqrt(of[node])) / MS_PER_KMH for of in (speed2, permitted2))
    needed, allowed = distinct_numbers(speed_kmh, limit_kmh)
    # of both cells that meet at the node
    limit_ms = np.min(mesh.cell_limit_ms[max(node - 1, 0) : node + 1])
    if _has_braking_curve(mesh) and permitted2[node] < limit_ms**2 * (1 - SAME):
        raise StrategyRefusedError(
            f"needs {needed} km/h at {mesh.position_m[node]:.0f} m, but the permitted deceleration "
            f"(vehicle.braking.permitted_deceleration) permits only {allowed} km/h there."
        )
    raise StrategyRefusedError(f"needs {needed} km/h, but the limit is {allowed} km/h.")


def check_accelerations(mesh: MeshedLine, speed2: FloatArray) -> None:
    """Refuse a run that accelerates or slows down more than is allowed; errors as `check_feasible`."""
    for does, cell, reached, limit in broken_accelerations(mesh, speed2):
        by, allowed = distinct_numbers(reached, limit, EFFORT_DIGITS)
        place = mesh.position_m[cell]
        raise StrategyRefusedError(f"{does} by {by} m/s2 at {place:.0f} m, but the limit is {allowed} m/s2.")


class BrokenLimit(NamedTuple):
    """The first cell in which a run breaks a limit, and its action there; efforts in N, accelerations in m/s2."""

    does: str
    cell: int
    reached: float
    limit: float


def broken_efforts(mesh: MeshedLine, speed2: FloatArray) -> list[BrokenLimit]:
    """Return the limits of tractive and braking effort that a run breaks by more than rounding."""
    data, speed = mesh.data, np.sqrt(speed2)
    mean, force = mean_speed(speed[:-1], speed[1:]), mesh.net_force_n(speed2)
    braking_n = electric_limit_n(data, mean) + data.friction_effort_n
    allowed_n = ALLOWED_EXCESS * data.traction.constant_n
    return [
        *_broken("pulls", force, tractive_limit_n(data, mean), allowed_n),
        *_broken("brakes", -force, braking_n, allowed_n),
    ]


def broken_accelerations(mesh: MeshedLine, speed2: FloatArray) -> list[BrokenLimit]:
    """Return the limits of acceleration and deceleration that a run breaks by more than rounding."""
    # dv/dt = v dv/dx = d(v^2 / 2)/dx, exact in a cell, over which the square of speed is linear
    acceleration = 0.5 * np.diff(speed2) / mesh.data.cell_length_m
    up, down = mesh.data.max_acceleration_ms2, mesh.data.max_deceleration_ms2
    return [
        *_broken("accelerates", acceleration, np.full_like(acceleration, up), ALLOWED_EXCESS * up),
        *_broken("slows down", -acceleration, np.full_like(acceleration, down), ALLOWED_EXCESS * down),
    ]


def _broken(does: str, reached: FloatArray, limit: FloatArray, allowed: float) -> list[BrokenLimit]:
    """Return the first of the cells in which a limit is exceeded by more than allowed."""
    over = np.flatnonzero(reached > limit + allowed)[:1].tolist()
    return [BrokenLimit(does, cell, float(reached[cell]), float(limit[cell])) for cell in over]
