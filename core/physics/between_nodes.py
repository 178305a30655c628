"""Follow a run between the nodes of its mesh; its account takes effort and resistance at a cell's mean speed.

A train passes a cell under one of two controls: a constant effort where the largest effort F(v) permits it at every
speed in the cell, and otherwise a constant share u of F(v): at full power the power is constant, not the effort. The
net force N(v) depends only on the speed, so that the speed is monotone within the cell and exceeds no constant limit
that its nodes keep. With the speed as the variable the motion needs no steps; m resists acceleration:

    length  h = integral of m v dv / N(v)      time  integral of m dv / N(v)      energy  integral of m P(v) dv / N(v)

By the first of them the harmonic mean of N, weighted by v, is k (w1 - w0), with k and w as in `cell`. That is an
equation for the constant effort or for u, and nearly linear. A share above 1 is an effort that the train does not have.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import driving_power, generated_power, has_idle_losses, may_draw_while_braking
from railjoule.core.drive.line_power import line_power
from railjoule.core.physics.braking import electric_effort
from railjoule.core.physics.cell import NEARLY_AT_REST_MS, Cell, mean_speed, needed_force
from railjoule.core.physics.effort_limit import (
    EffortLimit,
    effort_range,
    limit_over_speed,
    max_effort,
)
from railjoule.core.physics.mesh_data import MeshData, Train, cell_at, limits_at, shared_by_cells
from railjoule.core.physics.resistance import running_resistance, starting_resistance
from railjoule.core.physics.stretches import NEXT_TO_NOTHING

ALLOWED_SHARE = 1e-3
"""A run whose efforts and speeds exceed their limits by less than this share is possible."""
# five points in each half integrate 1 / N to 3e-8 where N changes by a factor of two over the half
ABSCISSAE, WEIGHTS = np.polynomial.legendre.leggauss(5)
HALF = len(ABSCISSAE)
SPEED, WEIGHT, FORCE, RESISTANCE = range(4)
"""Rows of the points of a cell: speed [m/s], its weight [m/s], force of the control [N] and what resists [N]."""
# over so little the motion is uniform: the error goes with the square
SAME_SPEED = 1e-6
"""Speeds that differ by less than this share are equal."""
MAX_STEPS, EXACT = 40, 1e-12
# The error of a kink falls with the square of the parts. With four, 1e-7 of the energy of a fast run with induction
# motors remain, whose flux is weakened from a speed on; with one, 2e-6. With 32, 1e-8 remain of random runs.
FEW_PARTS, MANY_PARTS = 4, 32
"""Parts of each half of a cell for drives whose losses, and for cells whose power, have a kink over the speed."""


@njit(cache=True, error_model="numpy")
def _corner_speed(limit: EffortLimit, slow: float, fast: float) -> float:
    """Return the speed between two [m/s] at which a limit leaves its constant; their mean where it does not."""
    if limit.table.shape[0] == 0:
        corner = limit.power_w / limit.constant_n
        return corner if slow < corner < fast else mean_speed(slow, fast)
    is_constant = limit_over_speed(limit, slow)[0] > limit.constant_n
    if is_constant == (limit_over_speed(limit, fast)[0] > limit.constant_n):
        return mean_speed(slow, fast)
    for _ in range(MAX_STEPS):
        corner = mean_speed(slow, fast)
        if (limit_over_speed(limit, corner)[0] > limit.constant_n) == is_constant:
            slow = corner
        else:
            fast = corner
    return corner


@njit(cache=True, error_model="numpy")
def _resistance(cell: Cell, speed: float) -> float:
    """Return the resistance at a speed [m/s] within a cell [N]."""
    resistance = running_resistance(cell.constant_n, cell.linear, cell.quadratic, speed, speed * speed)
    if cell.starting_n > 0.0:
        resistance += starting_resistance(cell.starting_n, cell.starting_ends_ms, speed)
    return resistance


@njit(cache=True, error_model="numpy")
def _place_points(cell: Cell, start: float, corner: float, end: float, points: FloatArray) -> None:
    """Fill the points of a cell between two speeds [m/s], for a control that is a constant effort."""
    for i in range(2 * HALF):
        low, high = (start, corner) if i < HALF else (corner, end)
        half, at = 0.5 * (high - low), i % HALF
        v = mean_speed(low, high) + half * ABSCISSAE[at]
        points[SPEED, i], points[WEIGHT, i] = v, half * WEIGHTS[at]
        points[FORCE, i] = 1.0
        points[RESISTANCE, i] = _resistance(cell, v)


@njit(cache=True, error_model="numpy")
def _find_control(points: FloatArray, mean_force: float) -> float:
    """Return by which factor of its force the control gives a harmonic mean of the net force [N].

    The mean is concave in the factor. It is at most the arithmetic mean, and at least the weakest net force.
    """
    total = force = resistance = 0.0
    weakest, rises = math.nan, (mean_force > 0.0) == (points[FORCE, 0] > 0.0)
    for i in range(points.shape[1]):
        weight = points[WEIGHT, i] * points[SPEED, i]
        total += weight
        force += weight * points[FORCE, i]
        resistance += weight * points[RESISTANCE, i]
        enough = (mean_force + points[RESISTANCE, i]) / points[FORCE, i]
        if not (enough <= weakest if rises else enough >= weakest):
            weakest = enough
    factor = near = (mean_force * total + resistance) / force
    far = weakest
    for _ in range(MAX_STEPS):
        inverse = slope = 0.0
        opposes = False
        for i in range(points.shape[1]):
            net = factor * points[FORCE, i] - points[RESISTANCE, i]
            opposes = opposes or net * mean_force <= 0.0
            share = points[WEIGHT, i] * points[SPEED, i] / net
            inverse += share
            slope += share * points[FORCE, i] / net
        found = total / inverse
        step = factor - (found - mean_force) / (found * found * slope / total)
        if opposes or abs(found) < abs(mean_force):
            near = factor
        else:
            far = factor
        if not opposes and abs(step - factor) <= EXACT * abs(step):
            return step
        if opposes or not (step - near) * (step - far) < 0.0:
            step = 0.5 * (near + far)
        factor = step
    return factor


@njit(cache=True, error_model="numpy")
def _supply_power_w(
    train: Train, braking: EffortLimit, drive: FloatArray, is_off: bool, force: float, speed: float
) -> float:
    """Return the line power [W] of a force at the wheels [N]; of a drive that is off it is the work at the wheels."""
    if is_off:
        return max(force, 0.0) * speed
    if force >= 0.0:
        return line_power(driving_power(train.drive_kind, drive, force, speed)[0], train.recuperation_factor)
    strongest = max_effort(braking, speed)
    electric = electric_effort(train.drive_kind, drive, -force, speed, strongest, train.friction_effort_n)
    return line_power(-generated_power(train.drive_kind, drive, electric, speed)[0], train.recuperation_factor)


@njit(cache=True, error_model="numpy")
def _limits_beside(
    train: Train, traction: EffortLimit, braking: EffortLimit, effort: float
) -> tuple[EffortLimit, float, float]:
    """Return the limit of an effort, the largest effort of friction brakes beside it [N], and its sign."""
    return (traction, 0.0, 1.0) if effort >= 0.0 else (braking, train.friction_effort_n, -1.0)


@njit(cache=True, error_model="numpy")
def _control_cell(
    cell: Cell,
    train: Train,
    traction: EffortLimit,
    braking: EffortLimit,
    start_speed2: float,
    end_speed2: float,
    points: FloatArray,
) -> tuple[float, float, float, float]:
    """Return effort [N], share of the limit and its excess from node to node, and the limit's corner [m/s]."""
    start, end = math.sqrt(start_speed2), math.sqrt(end_speed2)
    v, slow, fast = mean_speed(start, end), max(min(start, end), NEARLY_AT_REST_MS), max(start, end)
    is_uniform = fast - slow <= SAME_SPEED * fast
    if is_uniform:
        effort = needed_force(cell, start_speed2, end_speed2, v)
    else:
        # the resistance has a corner where that of the start ends
        has_corner = cell.starting_n > 0.0 and min(start, end) < cell.starting_ends_ms < max(start, end)
        v = cell.starting_ends_ms if has_corner else v
        _place_points(cell, start, v, end, points)
        effort = _find_control(points, cell.inertia * (end_speed2 - start_speed2))
    limit, beside, sign = _limits_beside(train, traction, braking, effort)
    if cell.supply_share < 1.0:
        # friction is all that is left; without it an effort counts as a share of the drive's largest one elsewhere
        return effort, 0.0, max(abs(effort) - beside, 0.0) / (beside if beside > 0.0 else limit.constant_n), v
    if abs(effort) <= effort_range(limit, slow, fast)[0] + beside:
        return effort, 0.0, 0.0, v
    if is_uniform:
        share, corner = abs(effort) / (max_effort(limit, v) + beside), v
    else:
        corner = _corner_speed(limit, min(start, end), max(start, end))
        _place_points(cell, start, corner, end, points)
        for i in range(points.shape[1]):
            points[FORCE, i] = sign * (max_effort(limit, points[SPEED, i]) + beside)
        share = _find_control(points, cell.inertia * (end * end - start * start))
    return effort, share, max(share - 1.0, 0.0), corner


@njit(cache=True, error_model="numpy")
def _count_parts(train: Train, braking: EffortLimit, drive: FloatArray, effort: float, slow: float) -> int:
    """Return in how many parts each half of a cell is integrated whose slowest speed [m/s] is above zero."""
    if effort < 0.0 and may_draw_while_braking(train.drive_kind):
        # the line's power has a kink where the drive begins to draw, and the brakes share the effort differently there
        strongest = max_effort(braking, slow)
        electric = electric_effort(train.drive_kind, drive, -effort, slow, strongest, train.friction_effort_n)
        spares = electric < min(-effort, strongest)
        if spares or generated_power(train.drive_kind, drive, electric, slow)[0] <= 0.0:
            return MANY_PARTS
    return FEW_PARTS if has_idle_losses(train.drive_kind) else 1


@njit(cache=True, error_model="numpy")
def _integrate_cell(
    cell: Cell,
    train: Train,
    traction: EffortLimit,
    braking: EffortLimit,
    drive: FloatArray,
    start_speed2: float,
    end_speed2: float,
    effort: float,
    share: float,
    corner: float,
) -> tuple[float, float]:
    """Return the time [s] and line energy [J] of a cell under a control that `_control_cell` has found."""
    start, end = math.sqrt(start_speed2), math.sqrt(end_speed2)
    v, slow = mean_speed(start, end), max(min(start, end), NEARLY_AT_REST_MS)
    # a drive that a solver leaves next to no effort is off, as in `action_of_cell`
    by_mean_speed = needed_force(cell, start_speed2, end_speed2, v)
    is_off = cell.supply_share < 1.0 or abs(by_mean_speed) <= NEXT_TO_NOTHING * traction.constant_n
    if abs(end - start) <= SAME_SPEED * v:
        time = cell.length_m / v
        return time, time * _supply_power_w(train, braking, drive, is_off, effort, v)
    limit, beside, sign = _limits_beside(train, traction, braking, effort)
    parts = 1 if is_off else _count_parts(train, braking, drive, effort, slow)
    time = energy = 0.0
    for part in range(2 * parts):
        low, high, number = (start, corner, part) if part < parts else (corner, end, part - parts)
        half = 0.5 * (high - low) / parts
        for i in range(HALF):
            v = low + half * (2.0 * number + 1.0 + ABSCISSAE[i])
            force = effort if share == 0.0 else sign * share * (max_effort(limit, v) + beside)
            resistance = _resistance(cell, v)
            # m = 2 k h
            passed = 2.0 * cell.inertia * cell.length_m * half * WEIGHTS[i] / (force - resistance)
            time += passed
            energy += passed * _supply_power_w(train, braking, drive, is_off, force, v)
    return time, energy


@njit(cache=True, error_model="numpy", nogil=True)
def _follow_run(mesh: MeshData, speed2: FloatArray) -> FloatArray:
    """Return effort, share, excess, time and energy of all cells, of shape (5, n)."""
    n = mesh.cell_length_m.shape[0]
    rows, points = np.empty((5, n)), np.empty((4, 2 * HALF))
    shared = shared_by_cells(mesh)
    for i in range(n):
        cell, start, end = cell_at(mesh, i), speed2[i], speed2[i + 1]
        train, traction, braking, drive = limits_at(shared, i)
        effort, share, excess, corner = _control_cell(cell, train, traction, braking, start, end, points)
        time, energy = _integrate_cell(cell, train, traction, braking, drive, start, end, effort, share, corner)
        rows[0, i], rows[1, i], rows[2, i], rows[3, i], rows[4, i] = effort, share, excess, time, energy
    return rows


@njit(cache=True, error_model="numpy", nogil=True)
def slow_to_possible(mesh: MeshData, speed2: FloatArray) -> FloatArray:
    """Return squares of speed lowered until no cell exceeds an effort, as far as prescribed speeds allow.

    A pass forward lowers the speeds that traction does not reach, a pass backward those that brakes cannot slow down.
    Both follow the exact motion, where `passes.slowed_to_reach` takes the mean speed of a cell. The run takes longer.

    Parameters
    ----------
    mesh : MeshData
        The discretised line and the train.
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2].
    """
    n = mesh.cell_length_m.shape[0]
    lowered, points = speed2.copy(), np.empty((4, 2 * HALF))
    shared = shared_by_cells(mesh)
    for number in range(2 * n):
        is_braking = number >= n
        i = 2 * n - 1 - number if is_braking else number
        node, cell = i if is_braking else i + 1, cell_at(mesh, i)
        train, traction, braking, _ = limits_at(shared, i)
        for _ in range(MAX_STEPS):
            start, end = lowered[i], lowered[i + 1]
            effort, _, excess, _ = _control_cell(cell, train, traction, braking, start, end, points)
            if (effort < 0.0) != is_braking or excess <= EXACT or mesh.fixed_speed2[node] >= 0.0:
                break
            # the force is too much by about this, and falls by k with the square of the speed
            beyond = abs(effort) * excess / (1.0 + excess)
            if cell.supply_share < 1.0 and not (effort < 0.0 < train.friction_effort_n):
                # nothing is left there, so that all of the effort is too much
                beyond = abs(effort)
            lowered[node] = max(lowered[node] - beyond / cell.inertia, 0.0)
    return lowered


@dataclass(frozen=True)
class LargestExcess:
    """The largest excess of a limit by a run.

    Parameters
    ----------
    share : float
        Effort or speed over its limit, less 1; 0 where the run keeps all limits.
    cell : int
        Number of the cell.
    start_m : float
        Start of the cell, from the start of the run [m].
    kind : str
        Which limit it is.
    """

    share: float
    cell: int
    start_m: float
    kind: Literal["traction", "braking", "speed"]


@dataclass(frozen=True, eq=False)
class RunBetweenNodes:
    """A run within the cells of its mesh; all arrays have shape (n,).

    Parameters
    ----------
    effort_n : array
        Constant effort [N] that leads from node to node, negative in braking.
    limit_share : array
        Share of the largest effort that leads from node to node where the constant effort would exceed the largest one
        within the cell; 0 elsewhere.
    excess_share : array
        By which share the train would have to exceed its largest effort.
    duration_s, supply_energy_j : array
        Time [s], and line energy without auxiliaries [J].
    speed_excess_share : array
        By which share the speed exceeds its limit at an end of the cell.
    cell_length_m : array
        Lengths of the cells [m].
    """

    effort_n: FloatArray
    limit_share: FloatArray
    excess_share: FloatArray
    duration_s: FloatArray
    supply_energy_j: FloatArray
    speed_excess_share: FloatArray
    cell_length_m: FloatArray

    @cached_property
    def max_excess(self) -> LargestExcess:
        """The largest excess of a limit."""
        cell = int(np.argmax(np.maximum(self.excess_share, self.speed_excess_share)))
        of_effort, of_speed = float(self.excess_share[cell]), float(self.speed_excess_share[cell])
        start_m = float(self.cell_length_m[:cell].sum())
        if of_speed > of_effort:
            return LargestExcess(of_speed, cell, start_m, "speed")
        return LargestExcess(of_effort, cell, start_m, "traction" if self.effort_n[cell] >= 0.0 else "braking")

    @property
    def is_possible(self) -> bool:
        """Whether the run keeps all limits up to `ALLOWED_SHARE`."""
        return self.max_excess.share <= ALLOWED_SHARE

    @property
    def total_s(self) -> float:
        """Time of the run without dwells [s]."""
        return float(self.duration_s.sum())

    @property
    def total_j(self) -> float:
        """Line energy of the run without auxiliaries [J]."""
        return float(self.supply_energy_j.sum())


def follow_between_nodes(mesh: MeshData, speed2: FloatArray) -> RunBetweenNodes:
    """Follow a run between its nodes.

    Parameters
    ----------
    mesh : MeshData
        The discretised line and the train.
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2], no two neighbours zero.
    """
    effort, share, excess, duration, energy = _follow_run(mesh, speed2)
    speed_excess = np.maximum(np.sqrt(speed2 / np.maximum(mesh.limit_speed2, NEARLY_AT_REST_MS)) - 1.0, 0.0)
    over = np.maximum(speed_excess[:-1], speed_excess[1:])
    return RunBetweenNodes(effort, share, excess, duration, energy, over, mesh.cell_length_m)
