"""The runs that Compare sets side by side: those of the scenario's strategies, and the pinned ones."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from railjoule.core import Trajectory
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.look import words
from railjoule.dashboard.work.runs import Runs
from railjoule.dashboard.workbench import Workbench

SIGNS: Mapping[str, str] = {"speed_limits": "Set speeds"}
"""Shorter names of strategies at their lines."""


@dataclass(frozen=True, eq=False)
class Contender:
    """A run among others.

    Parameters
    ----------
    key : str
        Its strategy, or the colour of its pin: the style of its line.
    name : str
        Its name in tables.
    sign : str
        Its name at its lines.
    run : Trajectory
        The run.
    """

    key: str
    name: str
    sign: str
    run: Trajectory

    @property
    def is_pinned(self) -> bool:
        """Whether it is a pinned run, which may have a scenario of its own."""
        return self.key not in STRATEGIES


def contenders(desk: Workbench, compared: Runs | None = None, only_ticked: bool = False) -> tuple[Contender, ...]:
    """Return the runs to compare: strategies in their order, then pins in theirs.

    Parameters
    ----------
    desk : Workbench
    compared : Runs, optional
        The runs of all strategies, which may belong to an earlier scenario: then they are left out.
    only_ticked : bool
        Whether strategies that are not ticked are left out.
    """
    runs = {} if desk.runs is None else dict(desk.runs.runs)
    if only_ticked:
        runs = {name: run for name, run in runs.items() if name in desk.drawn}
    elif compared is not None and desk.runs is not None and compared.scenario == desk.runs.scenario:
        runs = {**compared.runs, **runs}
    named = [
        Contender(name, words.STRATEGY_WORDS[name], SIGNS.get(name, words.STRATEGY_WORDS[name]), runs[name])
        for name in STRATEGIES
        if name in runs
    ]
    pinned = [Contender(pin.colour, f"{pin.number} {pin.name}", str(pin.number), pin.trajectory) for pin in desk.pins]
    return (*named, *pinned)


def find_reference(desk: Workbench, among: Sequence[Contender], chosen: str = "") -> Contender:
    """Return the run with which others are compared.

    It is the chosen one, else the run to which the list of strategies refers, else the first run.
    """
    best = None if desk.runs is None else desk.runs.best_known
    usual = next((contender for contender in among if contender.run is best), among[0])
    return next((contender for contender in among if contender.key == chosen), usual)
