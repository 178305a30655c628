"""The runs that Compare sets side by side: those of the scenario's strategies, and the pinned ones."""

from collections.abc import Mapping
from dataclasses import dataclass

from railjoule.core import Trajectory
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.look import words
from railjoule.dashboard.state.workbench import Workbench

SIGNS: Mapping[str, str] = {"speed_limits": "Set speeds"}
"""What stands at lines where the whole word has no room."""


@dataclass(frozen=True, eq=False)
class Contender:
    """A run among others.

    Parameters
    ----------
    key : str
        Its strategy, or the colour of its pin: what its line is drawn with.
    name : str
        What it is called in tables.
    sign : str
        What stands at its lines.
    run : Trajectory
        The run.
    """

    key: str
    name: str
    sign: str
    run: Trajectory


def contenders(state: Workbench) -> tuple[Contender, ...]:
    """Return the runs to compare: strategies in their order, then pins in theirs."""
    named = [
        Contender(name, words.STRATEGY_WORDS[name], SIGNS.get(name, words.STRATEGY_WORDS[name]), run)
        for name, run in strategy_runs(state).items()
    ]
    pinned = [Contender(pin.colour, f"{pin.number} {pin.name}", str(pin.number), pin.trajectory) for pin in state.pins]
    return (*named, *pinned)


def strategy_runs(state: Workbench) -> Mapping[str, Trajectory]:
    """Return the runs of the scenario's strategies: all that are known, or those that are ticked."""
    if state.runs is None:
        return {}
    runs = dict(state.runs.runs)
    if not state.compare_all:
        runs = {name: run for name, run in runs.items() if name in state.drawn}
    # they may be of the scenario before: all strategies take longer than those that are drawn
    elif state.compared is not None and state.compared.scenario == state.runs.scenario:
        runs = {**state.compared.runs, **runs}
    return {name: runs[name] for name in STRATEGIES if name in runs}


def reference_of(state: Workbench, among: tuple[Contender, ...]) -> Contender:
    """Return the run that others are compared with: the chosen one, else the last pin, else the first run."""
    keys = {contender.key: contender for contender in among}
    usual = state.pins[-1].colour if state.pins else among[0].key
    return keys.get(state.reference) or keys[usual]
