"""What the workbench computes: the only place of the dashboard that asks the core to solve.

Work runs in a few threads of this process, as the core's kernels release the interpreter; each page has at
most one piece of each kind of work under way, and of what it asks meanwhile only the last is done.
"""

import logging
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from typing import Generic, TypeVar

import numpy as np
import panel as pn
from bokeh.document import Document

from railjoule.core import RailjouleError, Scenario, StrategyRefusedError, Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.scenario import StrategyName
from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.core.strategies.enoc import (
    EnocCoefficients,
    best_acceleration_time,
    enoc_coefficients,
    enoc_energy,
    enoc_surface,
)
from railjoule.core.strategies.plain_line import plain_line
from railjoule.core.studies.tradeoff import Frontier, energy_time_frontier, enoc_frontier, frontier_times
from railjoule.core.units import J_PER_KWH

LOG = logging.getLogger(__name__)
THREADS = ThreadPoolExecutor(max_workers=2, thread_name_prefix="railjoule")

Wish = TypeVar("Wish")
Result = TypeVar("Result")


@dataclass(frozen=True, eq=False)
class Runs:
    """The runs of several strategies over one scenario.

    Parameters
    ----------
    scenario : Scenario
        What was asked for.
    shortest_time_s : float
        Shortest possible time, dwells included [s].
    cell_count : int
        Cells of the mesh.
    runs : mapping
        The runs by strategy, each with the bound of the optimum.
    refused : mapping
        Why a strategy does not take the scenario.
    """

    scenario: Scenario
    shortest_time_s: float
    cell_count: int
    runs: Mapping[StrategyName, Trajectory]
    refused: Mapping[StrategyName, str]


@dataclass(frozen=True)
class RunsWish:
    """A scenario and the strategies to run on it."""

    scenario: Scenario
    strategies: tuple[StrategyName, ...]


def compute_runs(wish: RunsWish) -> Runs:
    """Return the runs of the wished strategies; the optimum, which proves the bound, is always among them.

    Raises
    ------
    RailjouleError
        If the timetable cannot be kept, or the line not be run over.
    """
    task = prepare_task(wish.scenario)
    task.require_timetable()
    runs: dict[StrategyName, Trajectory] = {}
    refused: dict[StrategyName, str] = {}
    for name in dict.fromkeys(("optimal", *wish.strategies)):
        try:
            runs[name] = run_strategy(task, name)
        except StrategyRefusedError as refusal:
            refused[name] = str(refusal)
    bound = runs["optimal"].bound if "optimal" in runs else None
    return Runs(
        scenario=wish.scenario,
        shortest_time_s=task.shortest_travel_time_s,
        cell_count=task.course.cell_count,
        runs={name: run.with_bound(bound) for name, run in runs.items()},
        refused=refused,
    )


class Worker(Generic[Wish, Result]):
    """Does the last wish of one page in a thread, and delivers results in the order in which they were asked.

    Parameters
    ----------
    compute : callable
        Turns a wish into a result; runs in a thread.
    deliver : callable
        Takes a result into the page; runs in the page's own turn.
    fail : callable
        Takes an error that the user can mend.
    """

    def __init__(
        self,
        compute: Callable[[Wish], Result],
        deliver: Callable[[Result], None],
        fail: Callable[[RailjouleError], None],
    ) -> None:
        self._compute, self._deliver, self._fail = compute, deliver, fail
        self._document: Document | None = None
        self._wish: Wish | None = None
        self._running = False
        self.last_duration_s = 0.0

    def ask(self, wish: Wish) -> None:
        """Ask for a result; a wish that waits is forgotten."""
        self._document = pn.state.curdoc
        if self._document is None:
            self.do(wish)
        elif self._running:
            self._wish = wish
        else:
            self._start(wish)

    def do(self, wish: Wish) -> None:
        """Compute and deliver in the caller's own turn."""
        self._settle(self._timed(wish))

    def _start(self, wish: Wish) -> None:
        self._running = True
        THREADS.submit(self._timed, wish).add_done_callback(self._hand_over)

    def _timed(self, wish: Wish) -> Result | RailjouleError:
        started = time.perf_counter()
        try:
            return self._compute(wish)
        except RailjouleError as error:
            return error
        finally:
            self.last_duration_s = time.perf_counter() - started

    def _hand_over(self, future: "Future[Result | RailjouleError]") -> None:
        if self._document is not None:
            self._document.add_next_tick_callback(partial(self._finish, future))

    def _finish(self, future: "Future[Result | RailjouleError]") -> None:
        self._running = False
        error = future.exception()
        if error is None:
            self._settle(future.result())
        else:
            LOG.error("a computation failed", exc_info=error)
            self._fail(RailjouleError("Something went wrong in the computation; the server's log has the details."))
        if self._wish is not None:
            wish, self._wish = self._wish, None
            self._start(wish)

    def _settle(self, outcome: Result | RailjouleError) -> None:
        with pn.io.hold():
            if isinstance(outcome, RailjouleError):
                self._fail(outcome)
            else:
                self._deliver(outcome)


@dataclass(frozen=True, eq=False)
class EnocMap:
    """ENOC's energy over travel time and acceleration time, with its valley.

    Parameters
    ----------
    travel_time_s : array of shape (m,)
        Travel times [s].
    acceleration_time_s : array of shape (k,)
        Acceleration times [s].
    energy_kwh : array of shape (k, m)
        Energies [kWh]; NaN where the ramps do not fit.
    best_acceleration_s, best_energy_kwh : array of shape (m,)
        The valley: the best acceleration time for each travel time [s], and its energy [kWh].
    """

    travel_time_s: FloatArray
    acceleration_time_s: FloatArray
    energy_kwh: FloatArray
    best_acceleration_s: FloatArray
    best_energy_kwh: FloatArray


@dataclass(frozen=True)
class TradeOffWish:
    """A scenario, the longest time to look at [s], and what ENOC's map shall show."""

    scenario: Scenario
    longest_time_s: float
    wide_map: bool
    copper_weight: float


@dataclass(frozen=True, eq=False)
class TradeOff:
    """The energy-time frontier of a scenario and, on plain lines, ENOC's map.

    Parameters
    ----------
    scenario : Scenario
        What was asked for; its own travel time does not matter.
    frontier : Frontier
        The optima.
    enoc : Frontier or None
        ENOC's energy with its best acceleration time at the frontier's times, and which of them it refuses.
    coefficients : EnocCoefficients or None
        ENOC's closed form, to ask for single points.
    enoc_map : EnocMap or None
        Its map, with the copper weight asked for.
    refusal : str
        Why there is no ENOC; empty where there is.
    """

    scenario: Scenario
    frontier: Frontier
    enoc: Frontier | None
    coefficients: EnocCoefficients | None
    enoc_map: EnocMap | None
    refusal: str


MAP_SIZE = 80
NARROW_MAP_S = ((1.2, 2.5), (15.0, 110.0))
"""Travel times of the map as multiples of the shortest time, and acceleration times [s], for real timetables."""
WIDE_MAP_S = ((600.0, 5000.0), (10.0, 250.0))
"""The same for Figure 6a of Ftorek 2025 [s]."""


def compute_trade_off(wish: TradeOffWish) -> TradeOff:
    """Return the frontier of a scenario and, on plain lines, ENOC's curve and map.

    Raises
    ------
    RailjouleError
        If the line cannot be run over at all.
    """
    task = prepare_task(wish.scenario)
    share = max(2.0, (wish.longest_time_s - task.dwell_s) / task.shortest_time_s)
    frontier = energy_time_frontier(task, frontier_times(task, longest_share=share))
    try:
        line = plain_line(task)
    except StrategyRefusedError as refusal:
        return TradeOff(wish.scenario, frontier, None, None, None, str(refusal))
    weighted = replace(line, loss_coefficient=line.loss_coefficient * wish.copper_weight)
    (first, last), ramps = WIDE_MAP_S if wish.wide_map else NARROW_MAP_S
    unit = 1.0 if wish.wide_map else task.shortest_time_s
    times = np.linspace(first * unit, last * unit, MAP_SIZE)
    return TradeOff(
        scenario=wish.scenario,
        frontier=frontier,
        enoc=enoc_frontier(task, frontier.travel_time_s),
        coefficients=enoc_coefficients(line),
        enoc_map=_enoc_map(enoc_coefficients(weighted), times, ramps),
        refusal="",
    )


def _enoc_map(coefficients: EnocCoefficients, times: FloatArray, ends: tuple[float, float]) -> EnocMap:
    ramps = np.linspace(*ends, MAP_SIZE)
    best = np.array([best_acceleration_time(coefficients, time) for time in times])
    energies = enoc_energy(coefficients, times, best) / J_PER_KWH
    return EnocMap(times, ramps, enoc_surface(coefficients, times, ramps) / J_PER_KWH, best, energies)
