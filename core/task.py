"""A scenario made ready for any strategy: its meshed line, its shortest time, the time that it may take."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.budget import current_budget
from railjoule.core.errors import InfeasibleLineError, StrategyRefusedError, TimetableError
from railjoule.core.motion import MeshedLine, build_meshed_line, max_speeds, running_time
from railjoule.core.motion.mesh import enough_words
from railjoule.core.motion.meshed_line import train_extent
from railjoule.core.motion.passes import MOVED
from railjoule.core.physics.mesh_data import at_place
from railjoule.core.scenario import Scenario
from railjoule.core.units import MS_PER_KMH, N_PER_KN, plain_number

# the barrier of an interior point needs room: a time that only rounding keeps above the shortest has none
MIN_SLACK = 1e-9
"""A timetable must exceed the shortest time by this share, or an interior point has no strictly feasible start."""
# a state that is found within the rounding of a run may lie that much above its limit, and is no request of a file
SAME_SPEED2 = 1e-6
"""A square of speed may exceed its limit by this share."""


@dataclass(frozen=True, eq=False)
class Task:
    """Input of every strategy.

    Parameters
    ----------
    scenario : Scenario
        The scenario.
    mesh : MeshedLine
        The mesh and what holds on it.
    fastest_speed2 : array of shape (n + 1,)
        Greatest feasible squares of speed at the nodes [m2/s2]: the fastest run.
    shortest_time_s, running_time_s : float
        Time of that run, and time allowed, without dwells [s].
    can_be_remeshed : bool
        Whether its scenario over other nodes is the same problem: not of a part of a line, nor under further limits.
    """

    scenario: Scenario
    mesh: MeshedLine
    fastest_speed2: FloatArray
    shortest_time_s: float
    running_time_s: float
    can_be_remeshed: bool = True

    @property
    def position_m(self) -> FloatArray:
        """Nodes of the mesh [m]; shape (n + 1,)."""
        return self.mesh.position_m

    @cached_property
    def fastest_speed_ms(self) -> FloatArray:
        """Speeds of the fastest run at the nodes [m/s]; shape (n + 1,)."""
        return frozen_array(np.sqrt(self.fastest_speed2))

    @cached_property
    def dwell_s(self) -> float:
        """Time for which the train stands [s]."""
        return float(self.mesh.dwell_s.sum())

    @property
    def dwell_energy_j(self) -> float:
        """Energy of the auxiliaries during dwells [J]."""
        # separate from the rest, as no strategy can change it: the solver never sees a dwell
        return self.mesh.data.auxiliary_power_w * self.dwell_s

    @property
    def end_speeds_ms(self) -> tuple[float, float]:
        """Speeds at both ends [m/s]; 0 where an end is free."""
        initial, final = np.sqrt(np.nan_to_num(self.mesh.data.fixed_speed2[[0, -1]])).tolist()
        return initial, final

    @property
    def least_switching_s(self) -> float:
        """For how long the drive stays on or off at least [s]; 0 where it may be switched in any cell."""
        return self.scenario.vehicle.drive.stays_for_s

    @property
    def travel_time_s(self) -> float:
        """Time allowed for the whole run, dwells included [s]."""
        return self.running_time_s + self.dwell_s

    @property
    def shortest_travel_time_s(self) -> float:
        """Shortest possible time of the whole run, dwells included [s]."""
        return self.shortest_time_s + self.dwell_s

    @property
    def has_slack(self) -> bool:
        """Whether the timetable is longer than the shortest possible time."""
        return self.running_time_s > self.shortest_time_s * (1 + MIN_SLACK)

    def require_timetable(self) -> None:
        """Raise TimetableError unless the timetable is longer than the shortest possible time."""
        if not self.has_slack:
            raise TimetableError(self.travel_time_s, self.shortest_travel_time_s, self.scenario.travel_time_key)

    def require_few_cells(self, max_cells: int) -> None:
        """Raise StrategyRefusedError if the mesh has more than `max_cells` cells."""
        # a sentence with the mesh that would do, as the count also depends on sections and cars
        if self.mesh.cell_count <= max_cells:
            return
        line, mesh = self.scenario.line.in_running_order(), self.scenario.solver.mesh_m
        # each car adds a node where it passes a border, which no longer mesh removes: so many the message must leave
        crossings = (len(line.sections) - 1) * train_extent(self.scenario).crossing_points
        raise StrategyRefusedError(
            f"takes at most {max_cells:,} cells, and solver.mesh_m = {mesh:g} makes {self.mesh.cell_count:,}"
            f"{enough_words(line, max_cells, crossings, self.scenario.limits_last_m)}"
        )

    def require_budget(self, strategy: str) -> None:
        """Raise StrategyRefusedError if the mesh has more cells than the current budget gives a strategy."""
        budget = current_budget()
        self.require_few_cells(budget.strategy_cells.get(strategy, budget.cell_count))


def prepare_task(
    scenario: Scenario,
    initial_speed_ms: float | None = None,
    final_speed_ms: float | None = None,
    position_m: FloatArray | None = None,
) -> Task:
    """Return the task of a scenario.

    Parameters
    ----------
    scenario : Scenario
        The scenario.
    initial_speed_ms, final_speed_ms : float, optional
        Speeds at the ends of the run [m/s]; those of the timetable where absent.
    position_m : array of shape (n + 1,), optional
        Nodes [m] instead of those that the scenario's mesh length gives.

    Raises
    ------
    ScenarioError
        If the mesh would need too many cells, or a limit of effort is missing.
    InfeasibleLineError
        If no run passes the line at all.
    """
    return task_over(scenario, build_meshed_line(scenario, initial_speed_ms, final_speed_ms, position_m))


def task_over(scenario: Scenario, mesh: MeshedLine) -> Task:
    """Return the task of a scenario over a meshed line of its own; errors as `prepare_task`."""
    _require_speeds_within_limits(mesh)
    # the fastest run first: it shows whether there is any run at all, and bounds the speeds of all others
    speed2, obstacle, braking = max_speeds(mesh.data)
    if obstacle != MOVED:
        raise InfeasibleLineError(_obstacle_sentence(mesh, obstacle, braking))
    shortest = running_time(mesh.data.cell_length_m, speed2)
    dwell = float(mesh.dwell_s.sum())
    return Task(scenario, mesh, speed2, shortest, scenario.travel_time_s - dwell)


def task_over_nodes(task: Task, position_m: FloatArray) -> Task:
    """Return a task that can be remeshed over other nodes [m], with its time; errors as `prepare_task`."""
    other = prepare_task(task.scenario, *task.end_speeds_ms, position_m)
    return replace(other, running_time_s=task.running_time_s)


def _require_speeds_within_limits(mesh: MeshedLine) -> None:
    """Refuse a speed that is prescribed where the line or the vehicle allows less."""
    data = mesh.data
    over = np.flatnonzero(data.fixed_speed2 > data.limit_speed2 * (1 + SAME_SPEED2))
    if len(over):
        node = int(over[0])
        asked, limit = (float(np.sqrt(of[node])) / MS_PER_KMH for of in (data.fixed_speed2, data.limit_speed2))
        raise InfeasibleLineError(
            f"The train is to run at {asked:.5g} km/h at {mesh.position_m[node]:.0f} m, where the "
            f"limit is {limit:.5g} km/h."
        )


def _obstacle_sentence(mesh: MeshedLine, cell: int, braking: bool) -> str:
    """Return why no run passes a cell."""
    data, curve = at_place(mesh.data, mesh.data.place[cell]), mesh.curve_force_n[cell] / N_PER_KN
    where = f"At {mesh.position_m[cell]:.0f} m, on a gradient of {mesh.gradient_permille[cell]:.4g} per mille"
    too_fast = "cannot slow the train down for what lies ahead."
    friction_kn = data.friction_effort_n / N_PER_KN
    if data.supply_share[cell] < 1:
        powered = np.flatnonzero(data.supply_share >= 1)
        # nodes: after the last cell before it that has power, and before the first one behind it
        start = mesh.position_m[int(np.max(powered[powered < cell], initial=-1)) + 1]
        end = mesh.position_m[int(np.min(powered[powered > cell], initial=mesh.cell_count))]
        where += f" in the neutral section from {start:.0f} to {end:.0f} m (line.neutral_sections)"
        if braking:
            return f"{where}, friction brakes of at most {round(friction_kn, 3):.4g} kN {too_fast}"
        if data.fixed_speed2[cell] == 0:
            return f"{where}, the train stands and cannot start: it has no traction power there."
        return f"{where}, the train comes to a stand: it has no traction power there, and its momentum is not enough."
    if braking:
        effort = round(data.braking.constant_n / N_PER_KN + friction_kn, 3)
        return f"{where}, the brakes of at most {effort:.4g} kN {too_fast}"
    starting = float(data.starting_n)
    if starting > 0 and data.fixed_speed2[cell] == 0:
        needed = (starting + data.resistance_constant_n + data.line_force_n[cell]) / N_PER_KN
        most = at_place(data, data.place[cell]).traction.constant_n / N_PER_KN
        return (
            f"{where}, the train stands and cannot start: that takes more than {needed:.4g} kN, of which "
            f"{plain_number(starting / N_PER_KN, 4)} kN are its starting resistance, and its effort is at most "
            f"{most:.4g} kN."
        )
    # the curve may be the only reason
    resisting = f" and in a curve that resists with {plain_number(curve, 4)} kN" if curve > 0 else ""
    return (
        f"{where}{resisting}, the train comes to a stand: its effort of at most "
        f"{data.traction.constant_n / N_PER_KN:.4g} kN and its momentum are not enough."
    )
