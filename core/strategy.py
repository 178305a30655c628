"""The registry of strategies: what each is called, how it is drawn, and the function that computes its run.

A strategy is one file in `core/strategies/` that calls `register`. The command line, the pages, the charts, the
glossary and the reports read the registry. It stands outside that folder because scenarios check the names of
strategies, and strategies need scenarios.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from railjoule.core.errors import ScenarioError

if TYPE_CHECKING:
    from railjoule.core.task import Task
    from railjoule.core.trajectory import Trajectory

Dash = str | tuple[int, ...]
"""Pattern of a line: `solid`, or lengths of strokes and gaps [px]."""
GREY = ("#66707D", "#8F9AA8")
"""Colours of a strategy that names none, on a light and on a dark ground."""


@dataclass(frozen=True, kw_only=True)
class Strategy:
    """A way of driving: a function from a task to a run, and how people see it.

    Parameters
    ----------
    name : str
        The key in scenario files and on the command line.
    run : callable
        Computes a `Trajectory` from a `Task`. It raises `StrategyRefusedError` for a scenario that it cannot run, and
        lists its simplifications in the `notes` of the trajectory.
    order : int
        Strategies are listed in rising order.
    label : str
        The name in text; by default made from `name`.
    colour : (str, str)
        Colours of its line on a light and on a dark ground. Their distance in CIELAB from those of all others
        should be at least 20 (16 on the dark ground), for all three kinds of colour blindness.
    dash : str or tuple of int
        Pattern of its line.
    help : str
        Glossary entry of at most 35 words.
    applies_to : str
        Which scenarios it accepts.
    source : str
        Name of the paper in `assets/papers` that describes it; empty where none does.
    labels : tuple of str
        Other labels on the pages that the glossary entry explains.
    is_light : bool
        Whether pure Python runs it within a second or two, before the solver is compiled.
    seconds_per_cell : float
        How long it takes for each cell of the mesh, as far as that is more than the optimum takes [s].
    """

    name: str
    run: "Callable[[Task], Trajectory]"
    order: int = 100
    label: str = ""
    colour: tuple[str, str] = GREY
    dash: Dash = (6, 2)
    help: str = ""
    applies_to: str = "every scenario"
    source: str = ""
    labels: tuple[str, ...] = ()
    is_light: bool = False
    seconds_per_cell: float = 0.0

    def __post_init__(self) -> None:
        if not self.label:
            object.__setattr__(self, "label", self.name.replace("_", " ").capitalize())


STRATEGIES: dict[str, Strategy] = {}
"""The strategies by name, in the order in which they are shown."""


def register(strategy: Strategy) -> Strategy:
    """Add a strategy to those that scenarios, the command line and the pages can name.

    Raises
    ------
    ScenarioError
        If another strategy has this name.
    """
    if strategy.name in STRATEGIES:
        raise ScenarioError(f"strategy {strategy.name!r} is already registered; choose another name.")
    ordered = sorted((*STRATEGIES.values(), strategy), key=lambda one: one.order)
    # one dictionary for the whole program: others hold a reference to it
    STRATEGIES.clear()
    STRATEGIES.update({one.name: one for one in ordered})
    return strategy


def require_strategy(name: str) -> None:
    """Raise ValueError, with the names of all strategies, for a name that is none of them."""
    if name not in STRATEGIES:
        *others, last = (repr(known) for known in STRATEGIES)
        raise ValueError(f"= {name!r} must be {', '.join(others)} or {last}")
