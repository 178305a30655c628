"""How much work may be asked for at once; what asks for more is refused in a sentence before it begins.

Time and memory of all strategies grow with the cells of the mesh. Measured on one busy core with the shipped vehicles:
at the bounds of `LIBRARY` they take 5 to 30 s and at most 0.5 GB, a closed loop 0.9 GB; at those of `PAGE` 1 to 8 s.
"""

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Budget:
    """What one piece of work may take.

    Parameters
    ----------
    name : str
        Who sets it, as the sentences of refusal call it.
    row_count : int
        Rows of any list in a scenario.
    cell_count : int
        Cells of any mesh, and steps of time of a run that makes a cell of each.
    strategy_cells : mapping
        Cells of the mesh by strategy, where one takes fewer.
    idling_cells : int
        Cells for the optimum of a drive that takes power idling: its time grows with their square.
    chain_boxes : int
        Boxes of speed of a proof for such a drive: each takes some 0.2 kB.
    loop_time_s : float
        Longest plan that is driven in closed loop [s]; memory grows with it.
    loop_steps : int
        Steps of time of such a run.
    """

    name: str
    row_count: int
    cell_count: int
    strategy_cells: Mapping[str, int] = field(hash=False)
    idling_cells: int
    chain_boxes: int
    loop_time_s: float
    loop_steps: int


# One person waits for one answer, who can wait half a minute. What limits is memory and the patience of a
# terminal, see the times above.
LIBRARY = Budget(
    name="railjoule",
    row_count=100_000,
    cell_count=200_000,
    strategy_cells={"bellman": 20_000, "speed_limits": 20_000, "phases": 20_000},
    idling_cells=10_000,
    chain_boxes=12_000_000,
    loop_time_s=10_000.0,
    loop_steps=20_000_000,
)
# what all visitors of a server can ask for at the same time without stopping it for the others
PAGE = Budget(
    name="the page",
    row_count=5_000,
    cell_count=20_000,
    strategy_cells={"bellman": 5_000, "speed_limits": 5_000, "phases": 5_000},
    idling_cells=5_000,
    chain_boxes=6_000_000,
    loop_time_s=2_500.0,
    loop_steps=5_000_000,
)
"""Smaller, as all pages of a server share its threads, and rows are checked again at each move of a slider."""
# a context variable and no argument: the bounds belong to who asks, and dozens of functions lie between
_CURRENT: ContextVar[Budget] = ContextVar("budget", default=LIBRARY)


def current_budget() -> Budget:
    """Return the budget that holds here: that of the library, unless `within` names another."""
    return _CURRENT.get()


@contextmanager
def within(budget: Budget) -> Iterator[None]:
    """Let a budget hold for all that is computed in a block, in this thread alone."""
    token = _CURRENT.set(budget)
    try:
        yield
    finally:
        _CURRENT.reset(token)


def rounded_up(value: float) -> float:
    """Return a number of two digits to recommend that is not below a value above 0."""
    # two digits are enough for a recommendation, and upwards, as the recommended mesh must be accepted
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(value / unit) * unit:.3g}")
