"""Replanning: the plan of the rest of a run, from the state of a moving train.

A rest that cannot be kept is driven as fast as allowed. A stop noticed too late is made as soon as the brakes can. An
on-board computer has little time: its plans ahead use a strategy and a mesh that suffice for it.
"""

from dataclasses import replace

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive import make_drive
from railjoule.core.errors import (
    InfeasibleLineError,
    ScenarioError,
    SolverError,
    StrategyRefusedError,
    TimetableError,
)
from railjoule.core.motion import build_meshed_line
from railjoule.core.motion.driving import STANDING_SPEED2, brake_fully, braking_envelope
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.line import Station
from railjoule.core.simulation.leg import SAME_PLACE_M, Leg, leg_of
from railjoule.core.simulation.train_state import State, change_line, nodes_ahead, rest_scenario
from railjoule.core.strategies import run_strategy
from railjoule.core.task import prepare_task

# A train that learns of something while it brakes fully continues on another mesh, which may miss a stop by some
# decimetres, or a square of speed by some tenths of a percent, though it was just able to brake for them. So much
# does not count as noticed too late; larger values would hide a notice that did come too late.
ROUNDING_M, ROUNDING_RATIO = 0.5, 1e-2
# An overshoot below a centimetre is not mentioned.
NOTICEABLE_M = 0.01
REPLAN_S = 0.05
"""A plan ahead of an on-board computer is to take no longer [s]."""
# Measured with the shipped scenarios: interior points take 4 microseconds a cell, phases 0.5 ms, Bellman 1 ms
MAX_CELLS, SLOW_CELLS = 5000, {"phases": 60, "bellman": 32}
"""Cells of the mesh ahead, beside those that stops and borders add: in general, and of slow strategies."""


class Replanner:
    """Plans the rest of a run from a state.

    Parameters
    ----------
    allowed_time_s : float
        Time of the whole run, the accepted delay included [s].

    Attributes
    ----------
    notes : list of str
        Sentences on stops, limits and windows that the plans could not keep.
    is_fastest : bool
        Whether the last plan drives as fast as allowed, as the time is too short.
    """

    def __init__(self, allowed_time_s: float) -> None:
        self.allowed_time_s = allowed_time_s
        self.notes: list[str] = []
        self.is_fastest = False

    def drive_and_plan(self, leg: Leg, state: State) -> Leg:
        """Return a leg and the best run from its end."""
        end = float(leg.position_m[-1])
        if end >= state.scenario.line.length_m - SAME_PLACE_M:
            return leg
        after = State(end, float(leg.speed2[-1]), state.time_s + leg.duration_s, state.scenario)
        return leg.then(self.plan(after))

    def plan(self, state: State) -> Leg:
        """Return the best run from a state to the end, or the fastest if the time is too short."""
        rest = rest_scenario(state, self.allowed_time_s)
        nodes = nodes_ahead(state, rest.line.length_m)
        try:
            task = prepare_task(rest, state.speed_ms, position_m=nodes)
        except InfeasibleLineError:
            # a standing train has nothing to brake for: its line is infeasible for good
            if state.speed2 <= STANDING_SPEED2:
                raise
            return self._brake_at_once(state, nodes)
        try:
            return replace(leg_of(run_strategy(task, rest.strategy)), scenario=state.scenario)
        except ScenarioError:
            line, no_window = state.scenario.line, {"earliest_arrival_s": None, "latest_arrival_s": None}
            stations = tuple(station.model_copy(update=no_window) for station in line.stations)
            if stations == line.stations:
                raise
            # a window of arrival that this train cannot keep any more
            self.notes.append("The windows of arrival ahead cannot be kept any more, and are given up.")
            free = change_line(state.scenario, stations=stations)
            return replace(self.plan(replace(state, scenario=free)), scenario=state.scenario)
        except TimetableError:
            self.is_fastest = True
            return replace(leg_of(run_strategy(task, "fastest")), scenario=state.scenario)

    def _brake_at_once(self, state: State, nodes: FloatArray) -> Leg:
        """Brake fully until all that lies ahead can be kept again, or to a stand beyond a stop."""
        mesh = build_meshed_line(state.scenario, state.speed_ms, position_m=nodes)
        run, distance = brake_fully(mesh.data, state.speed2)
        stands = np.inf if np.isnan(distance) else state.position_m + distance
        stations = state.scenario.line.inner_stations
        missed = [station for station in stations if state.position_m < station.position_m < stands]
        if not missed:
            return self.drive_and_plan(self._slowed(state, nodes, run, braking_envelope(mesh)), state)
        if not np.isfinite(stands):
            raise InfeasibleLineError(
                f"From {state.position_m:.0f} m on, the brakes do not stop the train before the end of the line."
            )
        return self._beyond(state, np.append(nodes[nodes < stands - SAME_PLACE_M], stands), run, missed)

    def _slowed(self, state: State, nodes: FloatArray, run: FloatArray, envelope: FloatArray) -> Leg:
        """Return full braking until the limits ahead can be kept."""
        # the tolerance is that of comparing two sums of the same cells, one from each end
        slow = np.flatnonzero((run <= envelope * (1 + 1e-9)) & (run > 0))
        if not len(slow):
            raise InfeasibleLineError(
                f"From {state.position_m:.0f} m on, the brakes cannot keep the limits and stops ahead."
            )
        end = int(slow[0])
        if run[0] > envelope[0] * (1 + ROUNDING_RATIO):
            self.notes.append(f"A limit becomes known too late: the train is slow enough only at {nodes[end]:.0f} m.")
        return Leg(state.scenario, nodes[: end + 1], run[: end + 1], np.zeros(end + 1))

    def _beyond(self, state: State, places: FloatArray, run: FloatArray, missed: list[Station]) -> Leg:
        """Return full braking to a stand beyond stops, which are made there, and the rest."""
        overshoot = float(places[-1]) - missed[0].position_m
        if overshoot > ROUNDING_M:
            names = ", ".join(f"{station.position_m:.0f} m" for station in missed)
            self.notes.append(
                f"The stop at {names} becomes known too late: the train stands at {places[-1]:.1f} m, "
                f"{overshoot:.1f} m too far."
            )
        elif overshoot > NOTICEABLE_M:
            self.notes.append(
                f"The train overshoots its stop at {missed[0].position_m:.0f} m by {overshoot:.2f} m: its brakes "
                "cannot do more."
            )
        line = state.scenario.line
        made = Station(position_m=float(places[-1]), dwell_s=sum(station.dwell_s for station in missed))
        kept = [station for station in line.stations if station not in missed]
        # a train that learns of more while it brakes still stands there
        stations = tuple(sorted((*kept, made), key=lambda station: station.position_m))
        scenario = change_line(state.scenario, stations=stations)
        leg = Leg(scenario, places, np.append(run[: len(places) - 1], 0.0), dwell_at_end(places, made.dwell_s))
        return self.drive_and_plan(leg, replace(state, scenario=scenario))


def dwell_at_end(nodes: FloatArray, dwell_s: float) -> FloatArray:
    """Return dwells [s] of a leg that stands only at its last node; shape of the nodes."""
    dwell = np.zeros(len(nodes))
    dwell[-1] = dwell_s
    return dwell


def plan_quickly(state: State, allowed_time_s: float) -> tuple[Leg, str, list[str]]:
    """Return the plan from a state to the end, its strategy, and sentences on what it cannot keep.

    Parameters
    ----------
    state : State
    allowed_time_s : float
        Time of the whole run, the accepted delay included [s].

    Raises
    ------
    InfeasibleLineError
        If the line ahead cannot be driven.
    """
    scenario, stand_in = state.scenario, strategy_for_all_lines(state.scenario)
    own = scenario.strategy if scenario.strategy in {"phases", "fastest"} else stand_in
    refusals: list[StrategyRefusedError | SolverError] = []
    for strategy in dict.fromkeys((own, stand_in)):
        # cells so long that the plan takes REPLAN_S at most
        cells = SLOW_CELLS.get(strategy, MAX_CELLS)
        mesh_m = max(scenario.solver.mesh_m, (scenario.line.length_m - state.position_m) / cells)
        solver = scenario.solver.model_copy(update={"mesh_m": mesh_m})
        quick = scenario.model_copy(update={"strategy": strategy, "solver": solver})
        planner = Replanner(allowed_time_s)
        try:
            leg = planner.plan(replace(state, scenario=quick))
        except (StrategyRefusedError, SolverError) as refusal:
            refusals.append(refusal)
        else:
            return leg, "fastest" if planner.is_fastest else strategy, planner.notes
    raise refusals[-1]


def strategy_for_all_lines(scenario: Scenario) -> str:
    """Return the fast strategy that takes every line."""
    # the optimum of a drive with idle losses decides where it is on, which takes a tenth of a second and more
    return "bellman" if make_drive(scenario.vehicle.drive).has_idle_losses else "optimal"
