"""The plan with the least expected energy among those that are on time with a chosen probability.

Only trains that are not heavier can follow a plan for one load on time, and without a reserve each delay on the way
makes the run late. A candidate assumes a load and a running resistance and arrives a little before its timetable. All
candidates are followed under the same draws of `railjoule.core.studies.montecarlo`, so that their differences do not
depend on a draw. Further draws then check the chosen plan and the plan of the scenario.

The question is that of Chen, Li, Zhang, Tian, Robust optimization of energy-saving train trajectories under passenger
load uncertainty, 2022, doi 10.1109/TTE.2022.3194698 (reference 27 of Liashenko, Yatsko 2025); the method is
railjoule's.
"""

from collections.abc import Iterator
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compilation import require_compiled
from railjoule.core.errors import InfeasibleLineError, RailjouleError, ScenarioError, SolverError, TimetableError
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.simulation.actual_vehicle import actual_vehicle
from railjoule.core.simulation.disturbances import LATE_S
from railjoule.core.simulation.following import plan_for, plannable_task
from railjoule.core.studies.montecarlo import QUANTITIES, draw, drawn_runs, has_dwell_scatter
from railjoule.core.studies.rows import all_rows
from railjoule.core.studies.table import StudyTable
from railjoule.core.trajectory import Trajectory

PROBABILITY, CANDIDATES, MAX_CANDIDATES = 0.9, 24, 1000
CONFIDENCE = 0.95
"""Confidence of all intervals."""
CHECK_RATIO = 5
"""The check has this many times the draws of the search, which are `montecarlo.runs` in all."""
RESERVE_RANGE = 2.0
"""The largest reserve of a candidate over the one by which the scenario's plan would be on time."""


class UnreachedProbabilityError(RailjouleError):
    """No candidate is on time with the chosen probability."""


@dataclass(frozen=True, eq=False)
class DrawnRuns:
    """The runs of one plan under the draws.

    Parameters
    ----------
    energy_kwh, lateness_s : array of shape (runs,)
        Energy [kWh] and arrival after the timetable [s]; NaN where the train stops on its way.
    accepted_s : float
        Largest lateness of a train that is on time [s].
    """

    energy_kwh: FloatArray
    lateness_s: FloatArray
    accepted_s: float

    @property
    def runs(self) -> int:
        """Number of draws."""
        return len(self.energy_kwh)

    @property
    def on_time(self) -> int:
        """Number of runs on time; a train that stops on its way is not."""
        return int(np.sum(self.lateness_s <= self.accepted_s + LATE_S))

    @property
    def share_on_time(self) -> float:
        """Share of the runs on time."""
        return self.on_time / self.runs

    @property
    def share_interval(self) -> tuple[float, float]:
        """Exact (Clopper, Pearson) 95 % interval of the probability of being on time."""
        from scipy.stats import binomtest  # noqa: PLC0415  (slow to import)

        interval = binomtest(self.on_time, self.runs).proportion_ci(CONFIDENCE, "exact")
        return float(interval.low), float(interval.high)

    @property
    def expected_kwh(self) -> float:
        """Mean energy of the runs that reach the end [kWh]; NaN where none does."""
        reached = self.energy_kwh[np.isfinite(self.energy_kwh)]
        return float(reached.mean()) if len(reached) else np.nan

    def late_quantile_s(self, probability: float) -> float:
        """Return the lateness [s] that is not exceeded with a probability; infinite where the train does not arrive."""
        known = np.where(np.isnan(self.lateness_s), np.inf, self.lateness_s)
        return float(np.quantile(known, probability, method="higher"))


@dataclass(frozen=True, eq=False)
class Candidate:
    """A plan and its runs under the draws of the search.

    Parameters
    ----------
    load_factor, resistance_factor : float
        The load and the running resistance that the plan assumes.
    reserve_s : float
        Time before the timetable at which it arrives [s].
    plan : Trajectory
    drawn : DrawnRuns
    """

    load_factor: float
    resistance_factor: float
    reserve_s: float
    plan: Trajectory
    drawn: DrawnRuns


@dataclass(frozen=True, eq=False)
class RobustPlan:
    """The candidates so far, and at the end the robust plan with its check.

    Parameters
    ----------
    scenario : Scenario
        The timetable, the train, and in `montecarlo` the distributions.
    probability : float
        Smallest probability of an arrival on time.
    asked : int
        Number of candidates besides the scenario's own plan.
    candidates : tuple of Candidate
        The scenario's own plan first.
    refused : int
        Candidates that are infeasible for the assumed load and resistance.
    chosen : Candidate or None
        The robust plan; None until all candidates are known.
    checked : tuple of DrawnRuns or None
        The scenario's own plan and the robust one under other draws; None until the search has ended.
    """

    scenario: Scenario
    probability: float
    asked: int
    candidates: tuple[Candidate, ...]
    refused: int = 0
    chosen: Candidate | None = None
    checked: tuple[DrawnRuns, DrawnRuns] | None = None

    @property
    def nominal(self) -> Candidate:
        """The scenario's own plan."""
        return self.candidates[0]

    @property
    def is_held(self) -> bool:
        """Whether the robust plan is on time with the probability under the draws of the check, too."""
        return self.checked is not None and self.checked[1].share_on_time >= self.probability

    @property
    def extra_kwh(self) -> tuple[float, float]:
        """Expected energy of the robust plan minus that of the scenario's plan, and its error [kWh].

        The error is half of the 95 % interval of the mean difference of runs under the same draws.
        """
        assert self.checked is not None
        difference = self.checked[1].energy_kwh - self.checked[0].energy_kwh
        difference = difference[np.isfinite(difference)]
        if len(difference) < 2:
            return np.nan, np.nan
        from scipy.stats import norm  # noqa: PLC0415  (slow to import)

        error = norm.ppf(0.5 + 0.5 * CONFIDENCE) * difference.std(ddof=1) / len(difference) ** 0.5
        return float(difference.mean()), float(error)

    def to_table(self) -> StudyTable:
        """Return the candidates as a table, the scenario's own plan first."""
        columns = {
            "load_factor": [one.load_factor for one in self.candidates],
            "resistance_factor": [one.resistance_factor for one in self.candidates],
            "reserve_s": [one.reserve_s for one in self.candidates],
            "planned_kwh": [one.plan.energy_kwh for one in self.candidates],
            "expected_kwh": [one.drawn.expected_kwh for one in self.candidates],
            "share_on_time": [one.drawn.share_on_time for one in self.candidates],
            "share_low": [one.drawn.share_interval[0] for one in self.candidates],
            "share_high": [one.drawn.share_interval[1] for one in self.candidates],
            "is_chosen": [int(one is self.chosen) for one in self.candidates],
        }
        attributes = {
            "title": self.scenario.title,
            "strategy": self.scenario.strategy,
            "probability": self.probability,
            "accepted_delay_s": self.scenario.disturbance.accepted_delay_s,
            "seed": self.scenario.montecarlo.seed,
        }
        return StudyTable(self.scenario, {"candidate": range(len(self.candidates))}, columns, attributes)


def find_robust_plan(
    scenario: Scenario,
    probability: float = PROBABILITY,
    candidates: int = CANDIDATES,
    executor: Executor | None = None,
) -> RobustPlan:
    """Return the plan with the least expected energy that is on time with a probability.

    Parameters
    ----------
    scenario : Scenario
        The timetable, in `montecarlo` the distributions, the seed and the number of draws of the check, and in
        `disturbance.accepted_delay_s` the lateness that counts as on time.
    probability : float
        Smallest probability of an arrival on time: the lower end of its 95 % interval in the search reaches it.
    candidates : int
        Number of plans besides the scenario's own.
    executor : Executor, optional
        Executor of the runs; by default this thread.

    Raises
    ------
    ScenarioError
        If the probability or the number of candidates is out of its bounds, or a distribution has nothing within its.
    UnreachedProbabilityError
        If no candidate is on time with the probability.
    RailjouleError
        As in `railjoule.core.solve` for the scenario's plan.
    """
    *_, last = robust_plan_steps(scenario, probability, candidates, executor)
    return last


def robust_plan_steps(
    scenario: Scenario,
    probability: float = PROBABILITY,
    candidates: int = CANDIDATES,
    executor: Executor | None = None,
) -> Iterator[RobustPlan]:
    """Yield `find_robust_plan` after each candidate, then its result; arguments and errors as there."""
    if not 0 < probability < 1:
        raise ScenarioError(f"probability = {probability:g} must lie between 0 and 1.")
    if not 1 <= candidates <= MAX_CANDIDATES:
        raise ScenarioError(f"candidates = {candidates:g} must lie between 1 and {MAX_CANDIDATES:,}.")
    if has_dwell_scatter(scenario):
        raise ScenarioError("montecarlo.dwell_delay_s has no effect in a robust plan: remove it.")
    require_compiled()
    options = scenario.montecarlo
    search = _draw(scenario, max(1, options.runs // CHECK_RATIO), options.seed)
    nominal = plan_for(scenario)
    first = Candidate(scenario.vehicle.load_share, 1.0, 0.0, nominal, _follow(nominal, scenario, search, executor))
    found = RobustPlan(scenario, probability, candidates, (first,))
    yield found
    for assumed in _assumptions(found, search, candidates):
        plan = _candidate_plan(scenario, *assumed)
        if plan is None:
            found = replace(found, refused=found.refused + 1)
            continue
        candidate = Candidate(*assumed, plan, _follow(plan, scenario, search, executor))
        found = replace(found, candidates=(*found.candidates, candidate))
        yield found
    chosen = _choose(found)
    # the next seed draws other numbers, independent of those of the search
    check = _draw(scenario, options.runs, options.seed + 1)
    checked = [_follow(plan, scenario, check, executor) for plan in dict.fromkeys((nominal, chosen.plan))]
    yield replace(found, chosen=chosen, checked=(checked[0], checked[-1]))


def _draw(scenario: Scenario, runs: int, seed: int) -> dict[str, FloatArray]:
    options = scenario.montecarlo.model_copy(update={"runs": runs, "seed": seed})
    return draw(scenario.model_copy(update={"montecarlo": options}))


def _follow(plan: Trajectory, scenario: Scenario, drawn: dict[str, FloatArray], executor: Executor | None) -> DrawnRuns:
    """Return the runs of a plan under draws."""
    rows = all_rows(drawn_runs(plan, scenario), np.column_stack([drawn[name] for name in QUANTITIES]), executor)
    energy, delay, _ = rows.values.T
    # delays are against the plan, and the timetable is the same for all plans
    late = delay + plan.travel_time_s - scenario.travel_time_s
    return DrawnRuns(frozen_array(energy), frozen_array(late), scenario.disturbance.accepted_delay_s)


def _assumptions(found: RobustPlan, drawn: dict[str, FloatArray], count: int) -> list[tuple[float, float, float]]:
    """Return assumed load, resistance factor and reserve [s] of each candidate.

    Halton points fill the three dimensions evenly: the first two as quantiles of their draws, the reserve up to twice
    the one with which the scenario's plan would be on time.
    """
    from scipy.stats import qmc  # noqa: PLC0415  (slow to import)

    scenario, first = found.scenario, found.nominal.drawn
    needed = max(first.late_quantile_s(found.probability) - first.accepted_s, 0.0)
    available = max(scenario.travel_time_s - plannable_task(scenario).shortest_travel_time_s, 0.0)
    # the first point is 0 0 0
    shares = qmc.Halton(3, scramble=False).random(count + 1)[1:]
    loads = np.quantile(drawn["load_factor"], shares[:, 0])
    factors = np.quantile(drawn["resistance_factor"], shares[:, 1])
    reserves = shares[:, 2] * min(RESERVE_RANGE * needed, available)
    return list(zip(loads.tolist(), factors.tolist(), reserves.tolist(), strict=True))


def _candidate_plan(
    scenario: Scenario, load_factor: float, resistance_factor: float, reserve_s: float
) -> Trajectory | None:
    """Return the plan of a candidate, or None if there is none."""
    assumed = Disturbance(actual_load_factor=load_factor, resistance_factor=resistance_factor)
    train = actual_vehicle(scenario.model_copy(update={"disturbance": assumed})).vehicle
    timetable = scenario.timetable.with_travel_time(scenario.travel_time_s - reserve_s)
    try:
        return plan_for(scenario.model_copy(update={"vehicle": train, "timetable": timetable}))
    except (InfeasibleLineError, TimetableError, SolverError):
        return None


def _choose(found: RobustPlan) -> Candidate:
    """Return the candidate with the least expected energy of those on time.

    Raises
    ------
    UnreachedProbabilityError
        If there is none.
    """
    on_time = [one for one in found.candidates if one.drawn.share_interval[0] >= found.probability]
    if on_time:
        return min(on_time, key=lambda one: one.drawn.expected_kwh)
    best = max(found.candidates, key=lambda one: one.drawn.on_time).drawn
    raise UnreachedProbabilityError(
        f"probability = {found.probability:g} is reached by none of {len(found.candidates)} plans: the best one is on "
        f"time in {best.on_time:,} of {best.runs:,} runs ({best.share_on_time:.3g}; at 95 % confidence at least "
        f"{best.share_interval[0]:.3g}). Use a longer timetable.travel_time_s, a larger disturbance.accepted_delay_s, "
        "a lower probability, or more candidates or montecarlo.runs."
    )
