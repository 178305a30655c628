"""A trajectory: one run as arrays over distance and time, with its energy balance."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from railjoule.core.advice import Instruction, advise
from railjoule.core.arrays import BoolArray, FloatArray, frozen_array, midpoints
from railjoule.core.check import CheckResult
from railjoule.core.citation import bibtex
from railjoule.core.drive import Drive
from railjoule.core.energy import Energy, share_above, supply_current_a
from railjoule.core.lower_bound import BELOW_SHARE, ON_TIME_S, Bound, Reference, Window
from railjoule.core.motion.line_profile import speed_limit_at
from railjoule.core.motion.meshed_line import MeshedLine, build_meshed_line
from railjoule.core.phases import Phase, RunData, find_phases
from railjoule.core.physics.energy_balance import SMALL_ENERGY_SHARE, CellBalance, run_balance
from railjoule.core.physics.mesh_data import (
    MeshData,
    electric_limit_n,
    friction_limits_n,
    recuperation_factors,
    tractive_limit_n,
)
from railjoule.core.scenario import Scenario
from railjoule.core.strategy import STRATEGIES
from railjoule.core.units import J_PER_KWH, MS_PER_KMH, N_PER_KN, W_PER_KW

if TYPE_CHECKING:
    import pandas

MEASURED, BY_HAND = "measured", "by hand"
"""Name of a measured run, in place of a strategy."""


@dataclass(frozen=True, eq=False)
class Trajectory:
    """One run. Arrays of nodes have shape (n + 1,), arrays of cells (n,); a dwell is a cell without length.

    Parameters
    ----------
    scenario : Scenario
        The scenario.
    strategy : str
        Strategy that produced the run.
    position_m, speed_ms, time_s, supply_energy_j : array of nodes
        Place [m], speed [m/s], time [s], and line energy so far, auxiliaries included [J].
    tractive_effort_n, electric_braking_n, friction_braking_n : array of cells
        Efforts at the wheels, all positive [N].
    max_effort_n : array of cells
        Largest tractive effort at the cell's speed [N].
    max_braking_n : array of cells
        Largest braking effort at the cell's speed, friction brakes included [N].
    supply_power_w : array of cells
        Power taken from the line, auxiliaries included; negative where energy goes back [W].
    current_a : array of cells or None
        Current of one motor, negative in braking [A], where the drive's model has one.
    supply_current_a : array of cells or None
        Current at the line, negative where energy goes back [A], where the vehicle's line voltage is known.
    gradient_permille : array of cells
        Mean gradient under the train.
    energy : Energy
        The account of the whole run.
    bound : Bound or None
        A proven lower bound of the scenario's energy, if one is known.
    reference : Reference or None
        The best known run within the time of the timetable, or within that of the run if it keeps to a time of its own;
        None where none was looked for.
    price_of_time_w : float or None
        By how much the optimum falls if the timetable is a second longer [J/s], if the strategy computes it.
    iterations : int
        Iterations of the solver; 0 where there are none.
    solve_time_s : float
        How long the strategy took [s].
    notes : tuple of str
        Sentences on what was simplified.
    check : CheckResult or None
        Result of the independent check, if requested.
    """

    scenario: Scenario
    strategy: str
    position_m: FloatArray
    speed_ms: FloatArray
    time_s: FloatArray
    supply_energy_j: FloatArray
    tractive_effort_n: FloatArray
    electric_braking_n: FloatArray
    friction_braking_n: FloatArray
    max_effort_n: FloatArray
    max_braking_n: FloatArray
    supply_power_w: FloatArray
    current_a: FloatArray | None
    gradient_permille: FloatArray
    energy: Energy
    bound: Bound | None = None
    reference: Reference | None = None
    price_of_time_w: float | None = None
    iterations: int = 0
    solve_time_s: float = 0.0
    notes: tuple[str, ...] = field(default=())
    check: CheckResult | None = None
    supply_current_a: FloatArray | None = None

    @property
    def effort_n(self) -> FloatArray:
        """Effort of each cell, braking negative [N]; shape (n,)."""
        return self.tractive_effort_n - self.electric_braking_n - self.friction_braking_n

    @property
    def nodes_m(self) -> FloatArray:
        """Nodes of the mesh [m], each once, also where the train stands; shape (m,)."""
        # where a train stands, two nodes share a place: a bound refers to the mesh without them
        nodes: FloatArray = self.position_m[self._moved]
        return nodes

    @property
    def node_speed_ms(self) -> FloatArray:
        """Speeds at `nodes_m` [m/s]; shape (m,)."""
        speeds: FloatArray = self.speed_ms[self._moved]
        return speeds

    @property
    def _moved(self) -> BoolArray:
        return np.append(True, np.diff(self.position_m) > 0)

    @property
    def energy_kwh(self) -> float:
        """Net energy at the line, auxiliaries included [kWh]."""
        return self.energy.net_kwh

    @property
    def travel_time_s(self) -> float:
        """Time of the whole run, dwells included [s]."""
        return float(self.time_s[-1] - self.time_s[0])

    def arrival_s(self, position_m: float) -> float:
        """Return the time from the start to the arrival at a node [s]."""
        # two nodes lie where the train stands for a while: it arrives at the first
        node = int(np.searchsorted(self.position_m, position_m - 1e-6))
        return float(self.time_s[min(node, len(self.time_s) - 1)] - self.time_s[0])

    @property
    def station_arrivals(self) -> tuple[tuple[str, float, float], ...]:
        """Name, position [m] and arrival [s] of each station between the ends and of the end; empty without one."""
        line = self.scenario.line.in_running_order()
        inner, end = line.inner_stations, line.end_station
        names = [station.name or f"station {number}" for number, station in enumerate(inner, 2)]
        names.append((end is not None and end.name) or "the end")
        places = zip(names, line.stops_m[1:], strict=True)
        return tuple((name, place, self.arrival_s(place)) for name, place in places) if inner else ()

    def keeps(self, window: Window) -> bool:
        """Return whether the train arrives within a window."""
        position_m, earliest_s, latest_s = window
        return earliest_s - ON_TIME_S <= self.arrival_s(position_m) <= latest_s + ON_TIME_S

    @property
    def distance_m(self) -> float:
        """Length of the run [m]."""
        return float(self.position_m[-1] - self.position_m[0])

    @property
    def max_speed_kmh(self) -> float:
        """Greatest speed [km/h]."""
        return float(np.max(self.speed_ms)) / MS_PER_KMH

    @property
    def lower_bound_kwh(self) -> float | None:
        """Energy that no run covered by the bound undercuts [kWh], if a bound is known."""
        return None if self.bound is None else self.bound.energy_j / J_PER_KWH

    @property
    def gap(self) -> float | None:
        """Energy over its bound minus 1, if a bound is known; over the size of the bound where it is negative.

        A bound near zero counts as a tenth of the kinetic energy at the mean speed.
        """
        if self.bound is None:
            return None
        vehicle = self.scenario.vehicle
        kinetic = 0.5 * vehicle.total_inertia_kg * (self.distance_m / self.travel_time_s) ** 2
        # the sign of the bound must not turn the sign of the gap, nor a bound near zero make it infinite
        scale = max(abs(self.bound.energy_j), SMALL_ENERGY_SHARE * kinetic)
        return (self.energy.net_j - self.bound.energy_j) / scale

    @property
    def is_proven(self) -> bool:
        """Whether the bound proves that no run needs less by more than `solver.tolerance`."""
        return self.gap is not None and -BELOW_SHARE <= self.gap <= self.scenario.solver.tolerance

    @property
    def is_below_bound(self) -> bool:
        """Whether the run needs less than its bound by more than rounding: its mesh is too coarse for its account."""
        return self.gap is not None and self.gap < -BELOW_SHARE

    @property
    def all_notes(self) -> tuple[str, ...]:
        """`notes`, and a sentence about a mesh that is too coarse."""
        if self.gap is None or not self.is_below_bound:
            return self.notes
        longest_m = float(np.diff(self.position_m).max())
        return (
            *self.notes,
            f"The mesh, with cells of up to {longest_m:.3g} m, is too coarse for this run: by its account it needs "
            f"{-100 * self.gap:.2g} % less than any driving of this train does. Make solver.mesh_m smaller.",
        )

    @property
    def above_kwh(self) -> float | None:
        """Energy less that of the best known run [kWh], if one is known."""
        return None if self.reference is None else self.energy_kwh - self.reference.energy_kwh

    @property
    def above_share(self) -> float | None:
        """The same as a share of what the best known run needs; None where that is next to nothing or negative."""
        share = np.nan if self.reference is None else share_above(self.energy.net_j, self.reference.energy_j)
        return None if np.isnan(share) else share

    @cached_property
    def run_data(self) -> RunData:
        """The run's arrays as its phases and its advice take them."""
        line, vehicle = self.scenario.line.in_running_order(), self.scenario.vehicle
        # at the middle of each cell: at a node the limits of both sides meet
        limit_kmh = speed_limit_at(line, midpoints(self.position_m), self.scenario.limits_last_m)
        # constant over the whole run, so the mean is the power itself, dwells included
        auxiliary_w = self.energy.auxiliary_j / self.travel_time_s
        return RunData(
            position_m=self.position_m,
            time_s=self.time_s,
            speed_ms=self.speed_ms,
            energy_j=self.supply_energy_j - auxiliary_w * (self.time_s - self.time_s[0]),
            effort_n=self.effort_n,
            max_effort_n=self.max_effort_n,
            max_braking_n=self.max_braking_n,
            limit_ms=np.minimum(limit_kmh, vehicle.traction.max_speed_kmh) * MS_PER_KMH,
            inertia_kg=vehicle.total_inertia_kg,
            max_deceleration_ms2=vehicle.braking.max_deceleration_ms2 or np.inf,
        )

    @cached_property
    def permitted_speed_ms(self) -> FloatArray | None:
        """Speed that limits and braking curves permit at each node [m/s]; None for a vehicle without a braking curve.

        Shape (n + 1,). At a stop, the first of both nodes has the end of a curve, the second what permits
        the start.
        """
        if self.scenario.vehicle.braking.permitted_deceleration is None:
            return None
        entry_ms, exit_ms = self.speed_ms[[0, -1]].tolist()
        data = build_meshed_line(self.scenario, entry_ms, exit_ms, self.nodes_m).data
        departing2, prescribed2 = data.limit_speed2, data.fixed_speed2
        arriving2 = np.where(prescribed2 >= 0, np.minimum(prescribed2, departing2), departing2)
        # before the first node lies no curve
        arriving2[0] = departing2[0]
        node = np.cumsum(self._moved) - 1
        return frozen_array(np.sqrt(np.where(self._moved, arriving2[node], departing2[node])))

    @cached_property
    def phases(self) -> tuple[Phase, ...]:
        """Driving phases in order."""
        return find_phases(self.run_data)

    def with_bound(self, bound: Bound | None) -> "Trajectory":
        """Return the same run with another bound, or with none if that does not cover it."""
        return replace(self, bound=bound if bound is not None and bound.covers(self) else None)

    @cached_property
    def advice(self) -> tuple[Instruction, ...]:
        """The driving advice for this run, an instruction for each phase."""
        return advise(self)

    def plot(self, axes: Any = None) -> Any:
        """Draw speed over distance with matplotlib; return the axes. As `railjoule.core.plots.plot_run`."""
        from railjoule.core.plots import plot_run  # noqa: PLC0415  (matplotlib is an extra)

        return plot_run(self, axes)

    def cite(self) -> str:
        """Return BibTeX entries of railjoule and of the paper that describes the run's strategy, if there is one."""
        strategy = STRATEGIES.get(self.strategy)
        return bibtex([strategy.source] if strategy is not None and strategy.source else [])

    def to_dataframe(self) -> "pandas.DataFrame":
        """Return the run as a table of its nodes, with the efforts and powers of the cells that begin there."""
        import pandas  # noqa: PLC0415  (slow to import, and rarely needed)

        columns: dict[str, Any] = {
            "position_m": self.position_m,
            "time_s": self.time_s,
            "speed_kmh": self.speed_ms / MS_PER_KMH,
            "effort_kn": _at_nodes(self.effort_n) / N_PER_KN,
            "line_power_kw": _at_nodes(self.supply_power_w) / W_PER_KW,
            "line_energy_kwh": self.supply_energy_j / J_PER_KWH,
            "gradient_permille": _at_nodes(self.gradient_permille),
        }
        if self.current_a is not None:
            columns["current_a"] = _at_nodes(self.current_a)
        if self.supply_current_a is not None:
            columns["line_current_a"] = _at_nodes(self.supply_current_a)
        return pandas.DataFrame(columns)


def _at_nodes(values: FloatArray) -> FloatArray:
    """Give each node the value of the cell that begins there, the last node that of the last cell."""
    # a table has one row a node, and no cell begins at the last one
    return np.append(values, values[-1])


def make_trajectory(
    scenario: Scenario, mesh: MeshedLine, strategy: str, speed2: FloatArray, **details: Any
) -> Trajectory:
    """Return the run that squares of speed over a meshed line describe, with its energy account.

    Parameters
    ----------
    scenario : Scenario
        The scenario.
    mesh : MeshedLine
        The mesh and what holds on it.
    strategy : str
        Strategy that produced the run.
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2].
    **details
        Further fields of the trajectory.
    """
    data, account = mesh.data, run_balance(mesh.data, speed2)
    # standing is a cell with time and without length, its node there twice: so all sums over cells hold, and a chart
    # over time shows the stop
    stops = np.flatnonzero(mesh.dwell_s > 0)
    current = mesh.drive.current_a(supplied_effort_n(data, account), account.mean_speed_ms)
    max_effort = tractive_limit_n(data, account.mean_speed_ms)
    # friction is the same at all speeds, and adds to what the electric brake has
    max_braking = electric_limit_n(data, account.mean_speed_ms) + friction_limits_n(data)
    cells, durations = CellBalance(*(np.insert(values, stops, 0.0) for values in account)), durations_s(mesh, account)
    power = cells.supply_power_w + data.auxiliary_power_w
    position, speed = (np.insert(values, stops, values[stops]) for values in (mesh.position_m, np.sqrt(speed2)))
    return Trajectory(
        scenario=scenario,
        strategy=strategy,
        position_m=frozen_array(position),
        speed_ms=frozen_array(speed),
        time_s=frozen_array(np.append(0.0, np.cumsum(durations))),
        supply_energy_j=frozen_array(np.append(0.0, np.cumsum(power * durations))),
        tractive_effort_n=frozen_array(cells.tractive_effort_n),
        electric_braking_n=frozen_array(cells.electric_braking_n),
        friction_braking_n=frozen_array(cells.friction_braking_n),
        max_effort_n=frozen_array(np.insert(max_effort, stops, 0.0)),
        max_braking_n=frozen_array(np.insert(max_braking, stops, 0.0)),
        supply_power_w=frozen_array(power),
        current_a=None if current is None else frozen_array(np.insert(current, stops, 0.0)),
        gradient_permille=frozen_array(np.insert(mesh.gradient_permille, stops, 0.0)),
        energy=energy_balance(mesh, speed2, account),
        supply_current_a=supply_current_a(power, scenario.vehicle.line_voltage_v),
        **details,
    )


def durations_s(mesh: MeshedLine, cells: CellBalance) -> FloatArray:
    """Return the times of a run's cells and dwells in their order [s]; a dwell is a cell without length."""
    stops = np.flatnonzero(mesh.dwell_s > 0)
    return np.insert(cells.duration_s, stops, mesh.dwell_s[stops])


def supplied_effort_n(data: MeshData, cells: CellBalance) -> FloatArray:
    """Return the electric efforts that take power, braking negative [N]; shape (n,).

    The drive is off in a neutral section. Solvers leave a billionth of the largest effort there, which would cost a
    drive with idle losses all of them.
    """
    return np.where(data.supply_share < 1, 0.0, cells.tractive_effort_n - cells.electric_braking_n)


def drive_by_place(mesh: MeshedLine, with_dwells: bool = False) -> Drive:
    """Return a meshed line's drive with the recuperation factor of each cell, and of dwells, which generate nothing."""
    factors: Any = recuperation_factors(mesh.data)
    if not len(mesh.data.places.recuperation_factor):
        return mesh.drive
    if with_dwells:
        factors = np.insert(factors, np.flatnonzero(mesh.dwell_s > 0), 0.0)
    return replace(mesh.drive, recuperation_factor=factors)


def supply_energies_j(mesh: MeshedLine, cells: CellBalance) -> tuple[float, float, float]:
    """Return the energies of traction, recuperation and auxiliaries at the supply [J]."""
    duration = cells.duration_s
    # a cell takes or gives, never both: its power is constant
    taken = float(np.maximum(cells.supply_power_w, 0.0) @ duration)
    given = float(np.maximum(-cells.supply_power_w, 0.0) @ duration)
    return taken, given, mesh.data.auxiliary_power_w * float(np.sum(duration) + np.sum(mesh.dwell_s))


def energy_balance(mesh: MeshedLine, speed2: FloatArray, cells: CellBalance) -> Energy:
    """Return the energy account of a run from those of its cells.

    Parameters
    ----------
    mesh : MeshedLine
        The mesh and what holds on it.
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2].
    cells : CellAccount
        Result of `run_balance`.
    """
    data, length, duration = mesh.data, mesh.data.cell_length_m, cells.duration_s
    losses = {
        kind: float(power @ duration)
        for kind, power in drive_by_place(mesh).losses_w(supplied_effort_n(data, cells), cells.mean_speed_ms).items()
    }
    # force times distance is exact in a cell, as the force is constant there
    losses["friction_brakes"] = float(cells.friction_braking_n @ length)
    traction_j, recuperated_j, auxiliary_j = supply_energies_j(mesh, cells)
    return Energy(
        traction_j=traction_j,
        recuperated_j=recuperated_j,
        auxiliary_j=auxiliary_j,
        running_resistance_j=float(mesh.running_resistance_n(speed2) @ length),
        curve_resistance_j=float(mesh.curve_force_n @ length),
        losses_j=losses,
        kinetic_j=float(data.half_inertia_kg * (speed2[-1] - speed2[0])),
        potential_j=float(mesh.gradient_force_n @ length),
    )
