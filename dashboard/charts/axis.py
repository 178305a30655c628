"""The axis that figures share, and the columns that the browser is sent.

Of a run there is one source, whose columns all charts over the same axis draw. Each column is sent once however many
charts draw it, and only when it has changed. Columns that no chart in sight draws are not sent at all: they keep
their values, as nobody sees them before their chart is drawn again.
"""

from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
from bokeh.models import (
    ColumnDataSource,
    CustomJS,
    Range1d,
    Span,
)

from railjoule.core.arrays import FloatArray
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.scripts import function

SHORT_COLUMN = 40
"""Columns up to this length travel as lists within the message: beside it they would cost two frames more."""
# Bokeh paints nothing beyond the frame of a figure, so that the room must be within it
END_LABEL_SHARE = 0.125
"""Share of the axis beyond the last stop that is kept free for labels at the ends of lines."""


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


class Axis:
    """The x axis that all charts of a page share: its range, its cursor and the columns of the runs over it.

    Parameters
    ----------
    palette : Palette
    kind : type
        In which numbers the columns are sent.
    """

    def __init__(self, palette: Palette, kind: type[np.floating[Any]] = np.float32) -> None:
        # with bounds, so that neither a pan nor a zoom leads away from the line
        self.range = Range1d(0, 1, bounds=(0, 1))
        self.cursor = Span(dimension="height", line_alpha=0.55, line_width=1)
        self.follow = CustomJS(
            args={"captions": [], "sources": {}, "range": self.range},
            code=function("cursor", "follow({captions, sources, range}, cb_obj)"),
        )
        self._charts: dict[str, dict[str, Any]] = {}
        self._sources: dict[str, ColumnDataSource] = {}
        self._kind = kind
        self._runs: dict[str, RunColumns] = {}
        self.extent = (0.0, 1.0)
        """The ends of the whole axis, the room for labels included."""
        self.end = 1.0
        """End of the longest run: no ticks lie beyond it."""
        self._settled = 0
        self.range.js_on_change("tags", self.follow)
        palette.paint(self.cursor, line_color="ink")

    def fit(self, end: float, roomy: bool) -> None:
        """Show everything up to `end`, unless that is what the axis already spans: then its zoom stays."""
        self.end = end
        extent = (0.0, end * (1 + END_LABEL_SHARE) if roomy else end)
        # up to rounding: the end is computed again with each run
        if np.allclose(extent, self.extent, rtol=1e-9):
            return
        self.extent = extent
        # bounds first: the browser clips the ends to the bounds that it has
        self.range.update(bounds=extent, reset_start=extent[0], reset_end=extent[1], start=extent[0], end=extent[1])

    def add(self, name: str, chart: dict[str, Any]) -> None:
        """Let the cursor write into one more chart's caption, once `settle` is called."""
        self._charts[name] = chart

    def columns(self, run: str) -> RunColumns:
        """Return the columns of the run of a name, which all charts over this axis share."""
        if run not in self._runs:
            self._runs[run] = RunColumns(self._kind)
        return self._runs[run]

    def settle_over(self, time: bool) -> None:
        """Settle an axis of times [s] or of places [m]."""
        self.settle(*("s", 1) if time else ("m", 0))

    def settle(self, unit: str, digits: int) -> None:
        """Send the columns that charts have taken; tell the cursor all charts, and the unit of its place.

        To be called last within a batch of changes: each column goes once for all charts, and the browser must know all
        charts by then. The tags of the range (a count, the unit, the end of the ticks) are what assets/scripts reads:
        a changed tag calls the cursor, and a saved table has its unit from there.
        """
        for run in self._runs.values():
            run.send()
        captions = [chart["caption"] for chart in self._charts.values()]
        for index, chart in enumerate(self._charts.values()):
            self._describe(chart, place=None if index else [unit, digits])
        args = {"captions": captions, "sources": dict(self._sources), "range": self.range}
        # the browser compiles the callback again whenever its arguments are set, and Bokeh searches the whole document
        if args != self.follow.args:
            self.follow.args = args
        else:
            # a change of the range paints all its figures again; a chart that has just come needs it for no other
            self._settled += 1
        self.range.tags = [self._settled, unit, self.end]

    def _describe(self, chart: Mapping[str, Any], place: list[Any] | None) -> None:
        """Write what the cursor reads in a chart into the tags of its caption: words and numbers, no models.

        A source is named there by its id. The callback keeps each source that was ever read, so that its arguments
        stay the same when a run comes or goes.
        """
        self._sources |= {source.id: source for _, source, *_ in chart["sources"]}
        read = [[word, source.id, *rest] for word, source, *rest in chart["sources"]]
        described = {key: value for key, value in chart.items() if key != "caption"} | {"sources": read, "place": place}
        if chart["caption"].tags != [described]:
            chart["caption"].tags = [described]


def nice_range(low: float, high: float, share: float = 0.06) -> tuple[float, float]:
    """Return ends of an axis that leave some room around values."""
    # where all values are one, the axis must still have a height
    room = share * max(high - low, 1e-9)
    return low - room, high + room


def clear(source: ColumnDataSource) -> None:
    """Empty a source without changing its columns."""
    if any(len(column) for column in source.data.values()):
        source.data = {key: [] for key in source.data}


def same(one: Any, other: Any) -> bool:
    """Return whether two columns hold the same; pictures, which are long, count as different."""
    if len(one) != len(other) or any(isinstance(value, np.ndarray) for column in (one, other) for value in column[:1]):
        return False
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return np.array_equal(one, other)
    return list(one) == list(other)


def columns(**arrays: FloatArray) -> dict[str, FloatArray | list[float]]:
    """Return the columns of a source; short ones as lists, which travel within the message instead of beside it."""
    return {
        name: [*map(_nine_digits, array)] if len(array) <= SHORT_COLUMN else array for name, array in arrays.items()
    }


def _nine_digits(number: float) -> float:
    # a millimetre in a thousand kilometres; all digits would take twice as many letters
    return float(f"{number:.9g}")


def xy(x: FloatArray, y: FloatArray) -> dict[str, FloatArray | list[float]]:
    """Return the columns of a line."""
    return columns(x=np.asarray(x), y=np.asarray(y))


def points(places: Collection[tuple[float, float]]) -> dict[str, list[float]]:
    """Return the columns of a few points."""
    return {"x": [x for x, _ in places], "y": [y for _, y in places]}
