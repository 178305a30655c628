"""The problem of `railjoule.core.interior_point.layout` in CasADi's symbols, which derives it.

The power of a drive comes from the kernels' own formula, so that the energies of two solvers are comparable.
"""

import importlib
from collections.abc import Callable
from typing import Any

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.drive.geared import constant_efficiency_power, copper_loss_power
from railjoule.core.drive.kernels import may_draw_while_braking
from railjoule.core.drive.kinds import CONSTANT_EFFICIENCY, COPPER_LOSS
from railjoule.core.drive.line_power import smooth_supply_power
from railjoule.core.physics.cell import duration, mean_speed, needed_force
from railjoule.core.physics.effort_limit import EffortLimit
from railjoule.core.physics.mesh_data import MeshData, cells_of

# Formulas that are plain arithmetic take symbols as they are. Induction and map drives search or look up, which CasADi
# cannot trace: they have no outside oracle here.
DRIVES = {CONSTANT_EFFICIENCY: constant_efficiency_power, COPPER_LOSS: copper_loss_power}


class Program:
    """Variables, constraints and objective of one meshed line, scaled as in `layout`.

    Parameters
    ----------
    data : MeshData
        The discretised line and train.
    running_time_s : float
        Time allowed without dwells [s].
    reachable_speed2 : array of shape (n + 1,)
        No run is faster [m2/s2]; limits over speed that only faster runs reach are left out.
    own_braking : bool
        Whether the braking effort is a variable even where no friction brake makes it one.
    """

    def __init__(self, data: MeshData, running_time_s: float, reachable_speed2: FloatArray, own_braking: bool) -> None:
        self.casadi: Any = importlib.import_module("casadi")
        self.data, self.scale = data, data.traction.constant_n
        # prescribed speeds are numbers in the program and no variables with equal bounds, which have no inside
        self.free: BoolArray = np.isnan(data.fixed_speed2)
        self.has_braking = own_braking or data.friction_effort_n > 0
        self.may_draw = bool(may_draw_while_braking(data.drive_kind)) and data.recuperation_factor < 1
        cells = len(data.cell_length_m)
        symbol = self.casadi.MX.sym
        self.speed2 = symbol("w", int(self.free.sum()))
        self.traction = symbol("f", cells)
        self.braking = symbol("x", cells if self.has_braking else 0)
        self.drawn = symbol("psi", cells if self.may_draw else 0)
        self._constraints: list[tuple[Any, float, float | FloatArray]] = []
        self.objective = self._formulate(running_time_s, np.sqrt(reachable_speed2))

    def solver(self, options: dict[str, Any]) -> Any:
        """Return IPOPT for this program."""
        program = {
            "x": self.casadi.vertcat(self.speed2, self.traction, self.braking, self.drawn),
            "f": self.objective,
            "g": self.casadi.vertcat(*[expression for expression, _, _ in self._constraints]),
        }
        # a table is looked up at an index that the point decides, which CasADi cannot expand into scalars
        # expanded programs are evaluated faster, so they are where that is possible
        tables = len(self.data.traction.table) + len(self.data.braking.table)
        return self.casadi.nlpsol("optimum", "ipopt", program, {**options, "expand": tables == 0})

    def bounds(self, slowest_speed2: FloatArray) -> dict[str, FloatArray]:
        """Return the bounds of variables and constraints, by the names that the solver has for them.

        Parameters
        ----------
        slowest_speed2 : array of shape (n + 1,)
            Floor of the squares of speed [m2/s2].
        """
        data, cells = self.data, np.ones(len(self.data.cell_length_m))
        high = [data.limit_speed2[self.free], data.supply_share]
        if self.has_braking:
            high.append(data.supply_share * (data.braking.constant_n / self.scale))
        if self.may_draw:
            high.append(cells * np.inf)
        # efforts and drawn power are positive, and all but the speeds begin at 0
        others = np.zeros(sum(len(part) for part in high[1:]))
        counts = [expression.numel() for expression, _, _ in self._constraints]
        return {
            "lbx": np.append(slowest_speed2[self.free], others),
            "ubx": np.concatenate(high),
            "lbg": np.repeat([low for _, low, _ in self._constraints], counts),
            "ubg": np.concatenate(
                [np.broadcast_to(top, count) for (_, _, top), count in zip(self._constraints, counts, strict=True)]
            ),
        }

    def start(self, speed2: FloatArray, force_n: FloatArray) -> FloatArray:
        """Return a start near squares of speed at the nodes and the net forces of the cells that they need [N]."""
        force = force_n / self.scale
        driving = np.maximum(force, 0.0)
        # IPOPT moves a start inside of its bounds anyway; a little effort everywhere keeps driving and braking off
        # their corners
        traction = driving + 0.1 * np.maximum(1 - driving, 0.0)
        parts = [speed2[self.free], np.minimum(traction, 1.0)]
        if self.has_braking:
            parts.append(np.maximum(traction - force, 0.0) / 2)
        if self.may_draw:
            # above 0, as it is a slack of the draw in braking and must not begin at its bound
            parts.append(np.full(len(force), 1e-2))
        return np.concatenate(parts)

    def _formulate(self, running_time_s: float, reachable_speed: FloatArray) -> Any:
        """Gather the constraints and return the scaled energy."""
        data, h, sum_of = self.data, self.data.cell_length_m, self.casadi.sum1
        w = self._speed2_at_nodes()
        speed = self.casadi.sqrt(w)
        v = mean_speed(speed[:-1], speed[1:])
        cells = cells_of(data)
        acceleration_force = cells.inertia / self.scale * (w[1:] - w[:-1])
        force = needed_force(cells, w[:-1], w[1:], v) / self.scale
        # without friction brakes the balance of forces gives the braking effort: one variable and one equation fewer a
        # cell
        braking = self.braking if self.has_braking else self.traction - force
        top_speed = 0.5 * (reachable_speed[1:] + reachable_speed[:-1])
        self._limit_over_speed(self.traction, data.traction, v, top_speed)
        self._limit_over_speed(braking, data.braking, v, top_speed)
        if self.has_braking:
            self._keep(self.traction - force - braking, 0.0, data.friction_effort_n / self.scale)
        else:
            self._keep(braking, 0.0, data.supply_share * (data.braking.constant_n / self.scale))
        if np.isfinite([data.max_acceleration_ms2, data.max_deceleration_ms2]).any():
            inertia = 2 * data.half_inertia_kg / self.scale
            self._keep(acceleration_force, -inertia * data.max_deceleration_ms2, inertia * data.max_acceleration_ms2)
        # an inequality and no equation, as in our own formulation: an optimum that is early would show in both
        time = sum_of(duration(h, v))
        self._keep(time, -np.inf, running_time_s)
        return sum_of(h * self._energy_per_metre(v, braking)) + data.auxiliary_power_w / self.scale * time

    def _keep(self, expression: Any, low: float, high: float | FloatArray) -> None:
        self._constraints.append((expression, low, high))

    def _speed2_at_nodes(self) -> Any:
        """Return the squares of speed at all nodes, the prescribed ones as numbers."""
        ca, place = self.casadi, np.flatnonzero(self.free)
        pattern = ca.Sparsity.triplet(len(self.free), len(place), place.tolist(), list(range(len(place))))
        return ca.mtimes(ca.DM(pattern, 1.0), self.speed2) + ca.DM(np.where(self.free, 0.0, self.data.fixed_speed2))

    def _energy_per_metre(self, v: Any, braking: Any) -> Any:
        """Return the line energy of the cells over their length, without auxiliaries."""
        power, parameters = _formula(DRIVES[self.data.drive_kind]), self.data.drive_parameters
        taken = power(parameters, False, self.traction * self.scale, v)[0] / v / self.scale
        generated = -power(parameters, True, braking * self.scale, v)[0] / v / self.scale
        if self.may_draw:
            self._keep(self.drawn + generated, 0.0, np.inf)
        return smooth_supply_power(
            taken, generated, self.drawn if self.may_draw else 0.0, self.data.recuperation_factor
        )

    def _limit_over_speed(self, effort: Any, limit: EffortLimit, v: Any, top_speed: FloatArray) -> None:
        """Keep an effort under its limit that varies with speed."""
        if len(limit.table):
            self._keep(self._tabulated(limit, v) / self.scale - effort, 0.0, np.inf)
            return
        # v appears in the denominator: where the limit cannot bind, leaving it out spares IPOPT a nonlinear row
        binding = np.flatnonzero(limit.power_w < limit.constant_n * top_speed).tolist()
        if binding:
            self._keep(limit.power_w / self.scale / v[binding] - effort[binding], 0.0, np.inf)

    def _tabulated(self, limit: EffortLimit, v: Any) -> Any:
        """Return a tabulated limit [N], piece by piece a cubic."""
        ca = self.casadi
        piece = ca.low(limit.table[:, 0].tolist(), v)
        start, c0, c1, c2, c3 = (ca.MX(ca.DM(np.ascontiguousarray(column))).nz[piece] for column in limit.table.T)
        x = v - start
        return ((c3 * x + c2) * x + c1) * x + c0


def _formula(kernel: Callable[..., Any]) -> Callable[..., Any]:
    """Return the Python function behind a compiled one: arithmetic, which takes symbols as well."""
    # numba keeps the Python function; of a plain one there is only itself
    formula: Callable[..., Any] = getattr(kernel, "py_func", kernel)
    return formula
