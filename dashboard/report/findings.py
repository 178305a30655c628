"""The results in a report: the runs, optima over other travel times, the actual run, the table of loads and errors."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from railjoule.core import RailjouleError, Scenario, Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.bounds import with_tighter_bound
from railjoule.core.lower_bound import Bound
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.simulation.actual_run import actual_run, is_followed
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.field_oriented import FieldOrientedRun, simulate_field_oriented
from railjoule.core.simulation.following import Following, simulate_following
from railjoule.core.strategies import STRATEGIES, Task, prepare_task, run_strategy
from railjoule.core.studies.sensitivity_table import sensitivity_steps
from railjoule.core.studies.table import StudyTable
from railjoule.core.studies.tradeoff import coarsened, frontier_times
from railjoule.dashboard.pages.trade_off.compute import EnocMap, compute_enoc_map
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.work.pair import Pair, PairRequest, SecondScenario, compute_pair
from railjoule.dashboard.work.runs import Runs, RunsRequest, compute_runs, named_refusals, tightened_runs

OPTIMA_COUNT = 40
MAX_CELLS = 500
"""A mesh with more cells gets longer ones for the optima: all of them are in the report's file."""
Reality = DisturbedRun | Following | FieldOrientedRun
RUNS_SHARE, OPTIMA_SHARE, REALITY_SHARE = 0.2, 0.7, 0.75
"""Share of the work after each step, about."""


@dataclass(frozen=True, eq=False)
class ReportRequest:
    """A requested report: results that none of its sections shows are not computed.

    Parameters
    ----------
    bound : Bound or None
        A lower bound of the scenario's plan that is known already.
    prove_seconds : float or None
        As for `railjoule.core.solve`.
    note : str
        A remark on the page that the report comes from; may be empty.
    pinned : tuple of (str, Trajectory)
        Runs beside those of the scenario, with their names.
    second : SecondScenario or None
        A second scenario to stand beside the first.
    """

    scenario: Scenario
    bound: Bound | None = None
    prove_seconds: float | None = None
    note: str = ""
    pinned: tuple[tuple[str, Trajectory], ...] = ()
    second: SecondScenario | None = None
    contents: Contents = field(default_factory=Contents)


@dataclass(frozen=True, eq=False, kw_only=True)
class Findings(ReportRequest):
    """A request with its results.

    Parameters
    ----------
    pair : Pair or None
        The runs of both scenarios, where there is a second one.
    optima : tuple of Trajectory
        Optima over rising travel times, that of the timetable among them; empty where there is none.
    reality : DisturbedRun or Following or FieldOrientedRun or None
        The run under the scenario's disturbance, if it has one, or in closed loop, if it requests it.
    table : StudyTable or None
        Extra energy over load and position error.
    refusals : mapping of str to str
        Reasons for missing results, by section.
    share : float
        Share of the work that is done, 0 to 1.
    """

    runs: Runs
    pair: Pair | None = None
    optima: tuple[Trajectory, ...] = ()
    reality: Reality | None = None
    table: StudyTable | None = None
    refusals: Mapping[str, str] = field(default_factory=dict)
    enoc_map: EnocMap | None = None
    share: float = RUNS_SHARE

    @property
    def run(self) -> Trajectory:
        """The run whose numbers come first: that of the scenario's strategy, else the best one."""
        return self.runs.runs.get(self.scenario.strategy, self.runs.best)

    @property
    def own(self) -> int:
        """Index of the timetable's own optimum; 0 where there are no optima."""
        # the nearest: an optimum that gains nothing by waiting takes less time than it is allowed
        times = np.array([run.travel_time_s for run in self.optima])
        return int(np.argmin(np.abs(times - self.scenario.travel_time_s))) if len(times) else 0

    def refused(self, section: str, refusal: RailjouleError, share: float) -> "Findings":
        """Return the findings with the reason for a missing result: it costs one section, not the report."""
        return replace(self, refusals={**self.refusals, section: str(refusal)}, share=share)


def compute_findings(request: ReportRequest) -> Iterator[Findings]:
    """Yield the results as they become complete; the last ones have all.

    Raises
    ------
    RailjouleError
        If the timetable cannot be kept, or the line not be run over.
    """
    scenario, contents = request.scenario, request.contents
    runs = compute_runs(RunsRequest(scenario, tuple(STRATEGIES)))
    runs = tightened_runs(runs, request.bound, request.prove_seconds)
    enoc_map = compute_enoc_map(scenario) if contents.has("trade-off") else None
    findings = Findings(**vars(request), runs=runs, enoc_map=enoc_map)
    yield findings
    if contents.has("second") and request.second is not None:
        try:
            *_, pair = compute_pair(PairRequest(runs, request.second, findings.run.strategy))
            findings = replace(findings, pair=pair)
        except RailjouleError as refusal:
            findings = findings.refused("second", refusal, RUNS_SHARE)
        yield findings
    # the slider of the result moves over them, too
    if contents.has("result", "trade-off"):
        # one by one, as the work can only be stopped between two steps
        for optima, share in _optima(findings):
            findings = replace(findings, optima=optima, share=RUNS_SHARE + (OPTIMA_SHARE - RUNS_SHARE) * share)
            yield findings
    if contents.has("reality"):
        try:
            findings = replace(findings, reality=_reality(scenario), share=REALITY_SHARE)
        except RailjouleError as refusal:
            findings = findings.refused("reality", refusal, REALITY_SHARE)
        yield findings
    if not contents.has("robustness"):
        yield replace(findings, share=1.0)
        return
    try:
        with named_refusals(scenario):
            for table in sensitivity_steps(scenario):
                done = table.done / table.energy_kwh.size
                yield replace(findings, table=table, share=REALITY_SHARE + (1 - REALITY_SHARE) * done)
    except RailjouleError as refusal:
        yield findings.refused("robustness", refusal, 1.0)


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
        # a run that was computed for another time is not late
        run = replace(run, scenario=run.scenario.replace(**{"timetable.travel_time_s": time}))
        # the bound of the timetable's own time holds for all runs that take no longer
        optima = (*optima, run if bound is None else with_tighter_bound(run, bound))
        yield optima, k / len(times)


def optima_times(task: Task) -> FloatArray:
    """Return travel times for the optima of a task, its own among them, all dwells included [s]."""
    # the own time lies within, with a tenth beyond it
    share = max(2.0, 1.1 * task.running_time_s / task.shortest_time_s)
    own = task.running_time_s + task.dwell_s
    # the own time is rarely one of the frontier's, and the report's slider begins there
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
        # as on the pages: a train that meets what was planned drives its plan, without target braking curves
        return simulate_following(scenario) if is_followed(scenario) else None
