"""A second scenario beside that of the page, and the runs of both."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache

from railjoule.core import Scenario, Trajectory, load_scenario
from railjoule.core.scenario import parse_scenario, preset_names
from railjoule.dashboard.look.words import STRATEGY_WORDS
from railjoule.dashboard.work.runs import ProofRequest, Runs, RunsRequest, compute_proof, compute_runs

NOTHING, TRAIN, TIME, SCENARIO = "nothing", "train", "time", "scenario"
KINDS = (NOTHING, TRAIN, TIME, SCENARIO)
"""Parts of its own of a second scenario: none (there is none), the train, the travel time, or all."""
NAME = "second scenario"


@lru_cache(maxsize=8)
def named_scenario(source: str) -> Scenario:
    """Return the shipped scenario of a name, or that of a text; errors as `parse_scenario`."""
    return load_scenario(source) if source in preset_names("scenarios") else parse_scenario(source, NAME)


@dataclass(frozen=True)
class SecondScenario:
    """How a second scenario comes about from the first.

    Parameters
    ----------
    kind : str
        One of KINDS, not NOTHING.
    source : str
        Of a train the name of a shipped vehicle, of a scenario that of a shipped one; or the text of a scenario file.
    time_s : float
        Travel time, of the kind TIME [s].
    """

    kind: str
    source: str
    time_s: float

    def beside(self, first: Scenario) -> Scenario:
        """Return the second scenario.

        Raises
        ------
        ScenarioError
            If there is no such train or scenario, or it does not go with the first one's line.
        """
        if self.kind == TIME:
            return first.replace({"timetable.travel_time_s": self.time_s})
        if self.kind == SCENARIO:
            return named_scenario(self.source)
        # as the first train: the share of its capacity, the share that the supply takes back, and the time
        kept = {
            "drive.recuperation_factor": first.vehicle.drive.recuperation_factor,
            "timetable.travel_time_s": first.travel_time_s,
        }
        train: object = {"preset": self.source}
        if self.source not in preset_names("vehicles"):
            train = named_scenario(self.source).vehicle.model_dump(mode="json", exclude_none=True)
        second = first.replace({"vehicle": train, "drive": None, **kept})
        if not second.vehicle.has_capacity:
            return second
        return second.replace({"vehicle.load_factor": first.vehicle.load_share})


@dataclass(frozen=True, eq=False)
class Pair:
    """The runs of two scenarios by one strategy, each with those that it is measured against.

    Parameters
    ----------
    first, second : Runs
    strategy : str
        The strategy of both, where the second scenario is one that it takes.
    """

    first: Runs
    second: Runs
    strategy: str

    @property
    def runs(self) -> tuple[Trajectory, Trajectory]:
        """The two runs."""
        return self.first.runs[self.strategy], self.second.runs.get(self.strategy, self.second.best)

    @property
    def refusal(self) -> str:
        """Why the second run is not by the strategy of the first; empty where it is."""
        reason = self.second.refused.get(self.strategy)
        return "" if reason is None else f"{STRATEGY_WORDS[self.strategy]} refuses the second scenario: {reason}"


@dataclass(frozen=True)
class PairRequest:
    """The first runs, the second scenario, and the last pair, whose second runs may be those that are asked for."""

    first: Runs
    second: SecondScenario
    strategy: str
    known: Pair | None = field(default=None, compare=False)


def compute_pair(request: PairRequest) -> Iterator[Pair]:
    """Yield the runs of both scenarios, then again as the bounds of both tighten.

    Raises
    ------
    RailjouleError
        If the second scenario is none, or has no run.
    """
    scenario, strategy, known = request.second.beside(request.first.scenario), request.strategy, request.known
    if known is not None and known.second.scenario == scenario and strategy in known.second.runs:
        second = known.second
    else:
        second = compute_runs(RunsRequest(scenario, (strategy,)))
    pair = Pair(request.first, second, strategy)
    yield pair
    # as `solve` tightens them: else a bound could be looser in one column only because Drive has not shown it
    for name in ("first", "second"):
        runs: Runs = getattr(pair, name)
        if runs.to_prove is None:
            continue
        for proven in compute_proof(ProofRequest(runs.scenario, runs.to_prove)):
            bounded = runs.with_bound(proven.bound)
            pair = replace(pair, first=bounded) if name == "first" else replace(pair, second=bounded)
            yield pair
