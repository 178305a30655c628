"""Everything that a report tells: the runs, optima over other travel times, reality, the table of loads and errors."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from railjoule.core import RailjouleError, Scenario, Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.bounds import with_tighter_bound
from railjoule.core.lower_bound import Bound
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.simulation.actual_run import actual_run
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.field_oriented import FieldOrientedRun, simulate_field_oriented
from railjoule.core.simulation.following import Following, simulate_following
from railjoule.core.strategies import STRATEGIES, Task, prepare_task, run_strategy
from railjoule.core.studies.sensitivity_table import sensitivity_steps
from railjoule.core.studies.table import StudyTable
from railjoule.core.studies.tradeoff import coarsened, frontier_times
from railjoule.dashboard.pages.trade_off.compute import EnocMap, compute_enoc_map
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.work.refusals import named_refusals
from railjoule.dashboard.work.runs import Runs, RunsRequest, compute_runs, tightened_runs

OPTIMA_COUNT = 40
MAX_CELLS = 500
"""Optima over more cells are meshed anew with longer ones: all of them lie in the report's file."""
Reality = DisturbedRun | Following | FieldOrientedRun
RUNS_SHARE, OPTIMA_SHARE, REALITY_SHARE = 0.2, 0.7, 0.75
"""How much of the work is done after each step, about."""


@dataclass(frozen=True)
class ReportRequest:
    """What a report is to tell.

    Parameters
    ----------
    scenario : Scenario
    strategy : str or None
        Whose numbers come first; the scenario's own where None.
    bound : Bound or None
        What is already proven of the scenario's plan.
    prove_seconds : float or None
        As for `railjoule.core.solve`.
    note : str
        What its reader must know of the page that it comes from; empty where there is nothing.
    pinned : tuple of (str, Trajectory)
        Runs that stand beside those of the scenario, with their names.
    contents : Contents
        Which sections it shall have: what none of them tells is not computed.
    """

    scenario: Scenario
    strategy: str | None = None
    bound: Bound | None = None
    prove_seconds: float | None = None
    note: str = ""
    pinned: tuple[tuple[str, Trajectory], ...] = ()
    contents: Contents = field(default_factory=Contents)


@dataclass(frozen=True, eq=False)
class Findings:
    """Everything that a report tells.

    Parameters
    ----------
    scenario : Scenario
        What was asked for.
    runs : Runs
        Of all strategies that take the scenario.
    optima : tuple of Trajectory
        Optima over rising travel times, that of the timetable among them; empty where there is none.
    reality : DisturbedRun or Following or FieldOrientedRun or None
        What becomes of the plan under the scenario's disturbance, if it has one, or in closed loop, if it asks so.
    reality_refusal : str
        Why it could not be computed; empty where it could or was not asked for.
    table : StudyTable or None
        Overconsumption over load and coordinate error.
    table_refusal : str
        Why there is no table.
    enoc_map : EnocMap or None
        ENOC's energy over travel time and acceleration time, where it takes the scenario.
    share : float
        How much of the work is done, 0 to 1.
    note, pinned, contents
        As of the request.
    """

    scenario: Scenario
    runs: Runs
    optima: tuple[Trajectory, ...] = ()
    reality: Reality | None = None
    reality_refusal: str = ""
    table: StudyTable | None = None
    table_refusal: str = ""
    enoc_map: EnocMap | None = None
    share: float = RUNS_SHARE
    note: str = ""
    pinned: tuple[tuple[str, Trajectory], ...] = ()
    contents: Contents = field(default_factory=Contents)

    @property
    def run(self) -> Trajectory:
        """The run whose numbers come first: that of the scenario's strategy, else the best one."""
        return self.runs.runs.get(self.scenario.strategy, self.runs.best)


def compute_findings(request: ReportRequest) -> Iterator[Findings]:
    """Yield what a report tells as it becomes complete; the last one has all of it.

    Raises
    ------
    RailjouleError
        If the timetable cannot be kept, or the line not be run over.
    """
    scenario = request.scenario
    if request.strategy is not None and request.strategy != scenario.strategy:
        scenario = scenario.replace(strategy=request.strategy)
    runs = compute_runs(RunsRequest(scenario, tuple(STRATEGIES)))
    runs = tightened_runs(runs, request.bound, request.prove_seconds)
    contents = request.contents
    enoc_map = compute_enoc_map(scenario) if contents.has("trade-off") else None
    findings = Findings(scenario, runs, enoc_map=enoc_map, note=request.note, pinned=request.pinned, contents=contents)
    yield findings
    # the slider of the result goes over them, too
    if contents.has("result", "trade-off"):
        # one by one, as the work can be stopped between two steps alone
        for optima, share in _optima(findings):
            findings = replace(findings, optima=optima, share=RUNS_SHARE + (OPTIMA_SHARE - RUNS_SHARE) * share)
            yield findings
    if contents.has("reality"):
        try:
            findings = replace(findings, reality=_reality(scenario), share=REALITY_SHARE)
        # it costs this section, not the report
        except RailjouleError as refusal:
            findings = replace(findings, reality_refusal=str(refusal), share=REALITY_SHARE)
        yield findings
    if contents.has("robustness"):
        yield from _with_table(findings)
    else:
        yield replace(findings, share=1.0)


def _with_table(findings: Findings) -> Iterator[Findings]:
    """Yield findings with as much of the table of loads and errors as there is."""
    try:
        with named_refusals(findings.scenario):
            for table in sensitivity_steps(findings.scenario):
                done = table.done / table.energy_kwh.size
                findings = replace(findings, table=table, share=REALITY_SHARE + (1 - REALITY_SHARE) * done)
                yield findings
    except RailjouleError as refusal:
        yield replace(findings, table=None, table_refusal=str(refusal), share=1.0)


def _optima(findings: Findings) -> Iterator[tuple[tuple[Trajectory, ...], float]]:
    """Yield the optima so far, and their share of all."""
    if "optimal" not in findings.runs.runs:
        return
    task = coarsened(prepare_task(findings.scenario), MAX_CELLS)
    times, bound = optima_times(task), findings.runs.best.bound
    optima: tuple[Trajectory, ...] = ()
    for k, time in enumerate(times.tolist(), 1):
        try:
            # a task's time is without dwells
            run = run_strategy(replace(task, running_time_s=time - task.dwell_s), "optimal")
        except RailjouleError:
            continue
        # asked for another time, it is not late
        run = replace(run, scenario=run.scenario.replace(**{"timetable.travel_time_s": time}))
        # what is proven of the timetable's own time holds for all that take no longer
        optima = (*optima, run if bound is None else with_tighter_bound(run, bound))
        yield optima, k / len(times)


def optima_times(task: Task) -> FloatArray:
    """Return travel times for the optima of a task, its own among them, all dwells included [s]."""
    # the own time lies within, with a tenth beyond it
    share = max(2.0, 1.1 * task.running_time_s / task.shortest_time_s)
    own = task.running_time_s + task.dwell_s
    # the own time besides, as it is seldom one of the frontier's: the report's slider begins there
    return np.union1d(frontier_times(task, OPTIMA_COUNT - 1, share), [own])


def _reality(scenario: Scenario) -> Reality | None:
    in_closed_loop = scenario.simulation.kind == "field_oriented"
    if scenario.disturbance == Disturbance() and not in_closed_loop:
        return None
    with named_refusals(scenario):
        if in_closed_loop:
            return simulate_field_oriented(scenario)
        if scenario.disturbance.events:
            return actual_run(scenario).disturbed
        return simulate_following(scenario)
