"""What the browser is sent of a run: one source, whose columns all charts over the same axis draw.

Each column is sent once however many charts draw it, and only when it has changed. What no chart in sight draws is not
sent at all: its column keeps what it had, as nobody sees it before its chart is drawn anew.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource

from railjoule.core.arrays import FloatArray

SHORT_COLUMN = 40
"""Columns up to this length travel as lists within the message: beside it they would cost two frames more."""


class RunColumns:
    """The source of one run.

    Parameters
    ----------
    kind : type
        In which numbers are sent: float32 has seven digits, more than any figure or caption shows, at half the size.
    """

    def __init__(self, kind: type[np.floating[Any]]) -> None:
        self.source = ColumnDataSource()
        self._kind = kind
        self._run: object = None
        self._taken: dict[str, FloatArray] = {}

    def declare(self, *names: str) -> None:
        """Have columns of these names, so that a line may be drawn from them; they are filled when they are drawn."""
        missing = {name: self._unfilled() for name in names if name not in self.source.data}
        if missing:
            self.source.data.update(missing)

    def take(self, run: object, columns: Mapping[str, FloatArray]) -> None:
        """Take columns of a run, to be sent with the next `send`; those taken of an earlier run no longer count."""
        if run is not self._run:
            self._run, self._taken = run, {}
        self._taken.update(columns)

    def send(self) -> None:
        """Send what has changed of what was taken."""
        if not self._taken:
            return
        known = self.source.data
        count = len(next(iter(self._taken.values())))
        taken = {name: np.asarray(values, dtype=self._kind) for name, values in self._taken.items()}
        changed: dict[str, Any] = {
            name: short(values)
            for name, values in taken.items()
            if name not in known or not np.array_equal(known[name], values, equal_nan=True)
        }
        # all columns of a source must be of one length, also those that no chart in sight draws: bytes are smallest
        for name, column in known.items():
            if name not in taken and len(column) != count:
                changed[name] = self._unfilled(count)
        self._taken = {}
        if changed:
            known.update(changed)

    def forget(self) -> None:
        """Have nothing in any column, on the page too: nobody is to find there what is no longer shown."""
        self._run, self._taken = None, {}
        if any(len(column) for column in self.source.data.values()):
            self.source.data = {name: [] for name in self.source.data}

    def _unfilled(self, count: int | None = None) -> Any:
        if count is None:
            count = len(next(iter(self.source.data.values()), ()))
        return short(np.zeros(count, dtype=np.int8))


def short(column: Any) -> Any:
    """Return a column as it travels best: a short one as a list."""
    return column.tolist() if len(column) <= SHORT_COLUMN else column
