"""A course of five cells at a random inner point, and its Lagrangian as a function of all variables at once."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from builders import COPPER_LOSS, plain_scenario

from railjoule.core.interior_point.cell import evaluate
from railjoule.core.interior_point.layout import DRAWN, DRAWN_POSITIVE, FRICTION_POSITIVE, Work, allocate
from railjoule.core.interior_point.start import prepare
from railjoule.core.strategies import Task, prepare_task

NODES = np.array([0.0, 60.0, 140.0, 200.0, 310.0, 400.0])
HILLY = {
    "line.sections": [{"length_m": 200.0, "gradient_permille": 20.0}, {"length_m": 200.0, "gradient_permille": -15.0}],
    "vehicle.resistance.linear_n_per_kmh": 80.0,
}
RISE_LIMITS = {"vehicle.traction.max_acceleration_ms2": 0.8, "vehicle.braking.max_deceleration_ms2": 0.7}
FRICTION = {"vehicle.braking.friction_effort_kn": 40.0}
AUXILIARIES = {"vehicle.auxiliary_power_kw": 60.0}
CASES = {
    "constant efficiency": {},
    "power limits": {"vehicle.traction.max_power_kw": 500.0, "vehicle.braking.max_power_kw": 400.0},
    "limits of acceleration": RISE_LIMITS,
    "copper loss that draws in braking": {"vehicle.drive": COPPER_LOSS},
    "friction brakes": FRICTION,
    "a stop with auxiliaries": {"line.stations": [{"position_m": 200.0}], **AUXILIARIES},
    "all at once": {
        "vehicle.drive": COPPER_LOSS,
        "vehicle.traction.curve": [[0, 100], [20, 95], [40, 60], [100, 30]],
        "vehicle.braking.max_power_kw": 400.0,
        **FRICTION,
        **AUXILIARIES,
        **RISE_LIMITS,
    },
}


@dataclass(frozen=True, eq=False)
class Lagrangian:
    """Energy, priced time and priced limits of a task; variables are w of the free nodes, then f, x, psi of the cells.

    Multipliers and slacks stay as they are. Every call leaves the work arrays at the point that it was asked for.
    """

    task: Task
    work: Work
    time_slack: float
    time_multiplier: float

    @property
    def free(self) -> np.ndarray:
        return np.flatnonzero(self.work.nodes.free)

    @property
    def point(self) -> np.ndarray:
        return self._joined([values for values, _ in self._variables()])

    @property
    def step(self) -> np.ndarray:
        return self._joined([steps for _, steps in self._variables()])

    def value(self, point: np.ndarray) -> float:
        energy, time = self._evaluate(point)
        return energy + self._time_price * time - self.of_limits("multiplier") @ self.limits(point)

    def time(self, point: np.ndarray) -> float:
        return self._evaluate(point)[1]

    def limits(self, point: np.ndarray) -> np.ndarray:
        """Return g of all limits in use, which must not be negative."""
        self._evaluate(point)
        return self.of_limits("residual") + self.of_limits("slack")

    def gradient(self, point: np.ndarray) -> np.ndarray:
        """Return the derivatives of `value` that the compiled code fills in."""
        self._evaluate(point)
        data, nodes, cells, z = self.task.course.data, self.work.nodes, self.work.cells, self.work.rows.multiplier
        at_floor, at_ceiling = self.work.bounds.multiplier
        parts = [nodes.gradient - at_floor + at_ceiling, cells.traction_gradient - cells.force_price]
        if self.work.used[FRICTION_POSITIVE] > 0:
            parts.append(cells.braking_gradient + cells.force_price)
        if self.work.used[DRAWN] > 0:
            parts.append(data.cell_length_m * (1 - data.recuperation_factor) - z[DRAWN] - z[DRAWN_POSITIVE])
        return self._joined(parts)

    def curvature(self, convex: bool) -> np.ndarray:
        """Return the second derivatives of `value` that the compiled code fills in, as a dense matrix.

        Sums over the cells of [[ff, fv], [fv, vv]] of traction and of electric braking, of what bends with the mean
        speed, and of what a concave mean speed adds to its nodes; `convex` takes the positive part of each.
        """
        work, size = self.work, len(self.point)
        traction = len(work.cells.traction)
        first, node_of = len(self.free), {node: place for place, node in enumerate(self.free)}
        friction = work.used[FRICTION_POSITIVE] > 0
        curve, total = work.curvature, np.zeros((size, size))
        for i in range(traction):
            speed, force = np.zeros(size), np.zeros(size)
            for node, by_speed, by_force in (
                (i, work.cells.speed_by_start[i], work.cells.force_by_start[i]),
                (i + 1, work.cells.speed_by_end[i], work.cells.force_by_end[i]),
            ):
                if node in node_of:
                    speed[node_of[node]] += by_speed
                    force[node_of[node]] += by_force
            driving = np.eye(size)[first + i]
            braking = np.eye(size)[first + traction + i] if friction else driving - force
            for effort, rows in ((driving, (0, 1, 2)), (braking, (3, 4, 5))):
                ff, fv, vv = curve[list(rows), i]
                block = np.array([[ff, fv], [fv, vv]])
                directions = np.array([effort, speed])
                total += directions.T @ (positive(block) if convex else block) @ directions
            total += (max(curve[6, i], 0.0) if convex else curve[6, i]) * np.outer(speed, speed)
            for node, bent in ((i, curve[7, i]), (i + 1, curve[8, i])):
                if node in node_of:
                    total[node_of[node], node_of[node]] += max(bent, 0.0) if convex else bent
        return total

    def of_limits(self, name: str) -> np.ndarray:
        """Return a field of the rows of all limits in use, in one array."""
        rows, bounds = self.work.rows, self.work.bounds
        return np.concatenate([getattr(rows, name)[rows.weight > 0], getattr(bounds, name)[:, self.free].ravel()])

    def differences(self, function: Callable[[np.ndarray], object]) -> np.ndarray:
        """Return the derivatives of a function at the present point by central differences, a column a variable."""
        point, columns = self.point, []
        for index, size in enumerate(np.maximum(np.abs(point), 0.1)):
            step = np.zeros(len(point))
            step[index] = 1e-5 * size
            columns.append((np.asarray(function(point + step)) - np.asarray(function(point - step))) / (2e-5 * size))
        self._evaluate(point)
        return np.stack(columns, axis=-1)

    @property
    def _time_price(self) -> float:
        data = self.task.course.data
        return self.time_multiplier + data.auxiliary_power_w / data.traction.constant_n

    def _variables(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return the arrays that hold the variables, and those that hold their steps."""
        nodes, cells, used = self.work.nodes, self.work.cells, self.work.used
        variables = [(nodes.speed2, nodes.speed2_step), (cells.traction, cells.traction_step)]
        if used[FRICTION_POSITIVE] > 0:
            variables.append((cells.braking, cells.braking_step))
        if used[DRAWN] > 0:
            variables.append((cells.drawn, cells.drawn_step))
        return variables

    def _joined(self, arrays: list[np.ndarray]) -> np.ndarray:
        return np.concatenate([arrays[0][self.free], *arrays[1:]])

    def _evaluate(self, point: np.ndarray) -> tuple[float, float]:
        """Move to a point; return its energy without auxiliaries, and its time."""
        nodes, *cells = [values for values, _ in self._variables()]
        nodes[self.free] = point[: len(self.free)]
        for values, part in zip(cells, np.split(point[len(self.free) :], len(cells)), strict=True):
            values[:] = part
        data = self.task.course.data
        energy, _, time, _ = evaluate(data, data.traction.constant_n, self._time_price, self.work)
        return energy, time


def positive(block: np.ndarray) -> np.ndarray:
    """Return the positive semidefinite part of a symmetric matrix."""
    values, vectors = np.linalg.eigh(block)
    return vectors @ np.diag(np.maximum(values, 0)) @ vectors.T


@pytest.fixture(params=CASES)
def lagrangian(request) -> Lagrangian:
    """Point, multipliers and slacks lie apart from what one another ask for, as they do on the way to an optimum."""
    task = prepare_task(plain_scenario({**HILLY, **CASES[request.param]}), position_m=NODES)
    task = replace(task, running_time_s=1.3 * task.shortest_time_s)
    data, work, rng = task.course.data, allocate(len(NODES) - 1, 0), np.random.default_rng(1)
    time_slack, time_multiplier, _ = prepare(
        data, data.traction.constant_n, task.greatest_speed2, task.shortest_time_s, task.running_time_s, work
    )
    for rows in (work.rows, work.bounds):
        rows.multiplier[:] *= rng.uniform(1, 10, rows.multiplier.shape)
        rows.slack[:] *= np.where(rows.weight > 0, rng.uniform(0.5, 2, rows.slack.shape), 1.0)
    problem = Lagrangian(task, work, time_slack, 3 * time_multiplier)
    problem.time(problem.point * rng.uniform(0.98, 1.02, len(problem.point)))
    return problem
