"""Limits of a single piece of work; larger requests are refused in a sentence before they begin.

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
    """Limits of one piece of work.

    Parameters
    ----------
    name : str
        The owner of the limits, for the messages of refusal.
    row_count : int
        Rows of any list in a scenario.
    cell_count : int
        Cells of any mesh, and time steps of a run with a cell for each step.
    strategy_cells : mapping
        Cells of the mesh by strategy, for strategies with a lower limit.
    idling_cells : int
        Cells for the optimum of a drive with idle losses: its time grows with their square.
    chain_boxes : int
        Boxes of speed of a proof for such a drive: about 0.2 kB each.
    loop_time_s : float
        Longest plan for a closed-loop simulation [s]; memory grows with it.
    loop_steps : int
        Time steps of such a simulation.
    """

    name: str
    row_count: int
    cell_count: int
    strategy_cells: Mapping[str, int] = field(hash=False)
    idling_cells: int
    chain_boxes: int
    loop_time_s: float
    loop_steps: int


# One person waits up to half a minute for one answer. The limits follow from memory and from the times above.
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
"""Smaller, because all visitors of a server share its threads, and rows are checked at each move of a slider."""
# a context variable, as dozens of functions would have to pass an argument on
_CURRENT: ContextVar[Budget] = ContextVar("budget", default=LIBRARY)


def current_budget() -> Budget:
    """Return the current budget: the one of the library, or of the enclosing `within`."""
    return _CURRENT.get()


@contextmanager
def within(budget: Budget) -> Iterator[None]:
    """Set the budget of all computations in a block, only in this thread."""
    token = _CURRENT.set(budget)
    try:
        yield
    finally:
        _CURRENT.reset(token)


def rounded_up(value: float) -> float:
    """Round a positive number up to two digits, for a recommendation."""
    # upwards, because the recommended mesh must be accepted
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(value / unit) * unit:.3g}")
