"""Runs as HoloViews objects, for notebooks: `pip install 'railjoule[notebook]'`.

A notebook shows them after `holoviews.extension("bokeh", inline=True)`. All that a call returns is made by that call,
so what one reader of a served notebook zooms or hides changes nothing for another.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping
from itertools import cycle
from typing import Any

import holoviews as hv
import holoviews.plotting.bokeh  # options are known only once their backend is
import numpy as np
from bokeh.plotting import figure

from railjoule.core import Trajectory
from railjoule.dashboard.charts.axis import nice_range
from railjoule.dashboard.charts.dress import add_zero, dress, dress_legends, line_style
from railjoule.dashboard.charts.quantities import EFFORT, ENERGY, POSITION, SPEED, Quantity
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import FONT, PIN_DASHES, line_width
from railjoule.dashboard.look.words import strategy

HEIGHT_PX = 190
COMPARED_HEIGHT_PX = 320
TICKS = 4

Runs = Mapping[str, Trajectory] | Iterable[Trajectory]


def to_holoviews(run: Trajectory, *, dark: bool = False) -> hv.Layout:
    """Return speed, energy so far and effort of a run over distance, one below the other with one zoom for all.

    Parameters
    ----------
    run : Trajectory
        As `solve` returns it.
    dark : bool
        Whether it wears the colours of the dark theme.
    """
    name, line = strategy(run.strategy), {"color": Palette(dark).tokens[run.strategy], **line_style("optimal")}
    rows = [
        _curve(run, quantity, name).opts(backend="bokeh", **line, **_frame([run], quantity, HEIGHT_PX, dark))
        for quantity in (SPEED, ENERGY, EFFORT)
    ]
    return hv.Layout(rows).cols(1)


def compare(runs: Runs, quantity: Quantity = SPEED, *, dark: bool = False) -> hv.Overlay:
    """Return one quantity of several runs over distance, with their names in the legend.

    The first run of a strategy has the strategy's colour and dash, further ones those of pinned runs, by turns.

    Parameters
    ----------
    runs : mapping of str to Trajectory, or iterable of Trajectory
        The runs by their names; without names they have those of their strategies.
    quantity : Quantity
        Their quantity, one of `railjoule.dashboard.charts.quantities`.
    dark : bool
        As in `to_holoviews`.

    Raises
    ------
    ValueError
        If there is no run, a name is empty, or two runs without names have the same strategy.
    """
    named = _named(runs)
    lines = _lines(named.values(), Palette(dark))
    curves = [
        _curve(run, quantity, name).opts(backend="bokeh", **line)
        for (name, run), line in zip(named.items(), lines, strict=True)
    ]
    frame = _frame(named.values(), quantity, COMPARED_HEIGHT_PX, dark)
    return hv.Overlay(curves).opts(backend="bokeh", show_legend=True, legend_position="right", **frame)


def _named(runs: Runs) -> dict[str, Trajectory]:
    """Return runs by the names that they are drawn with."""
    named: dict[str, Trajectory] = {}
    pairs = runs.items() if isinstance(runs, Mapping) else ((strategy(run.strategy), run) for run in runs)
    for name, run in pairs:
        if name in named:
            raise ValueError(f"runs: two have the strategy {run.strategy!r}; give a dict of the runs by name.")
        if not name.strip():
            raise ValueError("runs: a name is empty; each run needs one for the legend.")
        named[name] = run
    if not named:
        raise ValueError("runs: there is none; at least one run is needed.")
    return named


def _lines(runs: Iterable[Trajectory], palette: Palette) -> Iterator[dict[str, Any]]:
    """Yield colour, dash and width of each run's line."""
    seen: set[str] = set()
    pins = cycle(PIN_DASHES.items())
    for run in runs:
        if run.strategy in seen:
            token, dash = next(pins)
            yield {"color": palette.tokens[token], "line_dash": dash, "line_width": line_width(token)}
        else:
            seen.add(run.strategy)
            yield {"color": palette.tokens[run.strategy], **line_style(run.strategy)}


def _curve(run: Trajectory, quantity: Quantity, name: str) -> hv.Curve:
    """Return a quantity of a run over distance; one that is constant in each cell as steps."""
    axes = [hv.Dimension(one.name, label=one.words) for one in (POSITION, quantity)]
    curve = hv.Curve((POSITION.values(run), quantity.values(run)), *axes, label=name)
    quantities = [(one.words, f"@{one.name}{{{0:.{one.digits}f}}}") for one in (POSITION, quantity)]
    # a node has the value of the cell before it
    steps = "steps-pre" if quantity.stepped else "linear"
    return curve.opts(
        backend="bokeh", interpolation=steps, tools=["hover"], hover_tooltips=[("Run", "$label"), *quantities]
    )


def _frame(runs: Collection[Trajectory], quantity: Quantity, height_px: int, dark: bool) -> dict[str, Any]:
    """Return the options of a figure; the quantity stands above it, as an axis of this height has no room for it."""
    values = np.concatenate([quantity.values(run) for run in runs])
    low, high = nice_range(float(np.min(values)), float(np.max(values)))

    def dressed(plot: Any, _: object) -> None:
        # a palette keeps what it has painted: one a figure, or none would ever be freed
        _dress(plot.state, quantity, Palette(dark))

    return {
        "responsive": True,
        "height": height_px,
        "ylim": (max(low, 0.0) if np.min(values) >= 0 else low, high),
        "title": quantity.words,
        "ylabel": "",
        "hooks": [dressed],
    }


def _dress(f: figure, quantity: Quantity, palette: Palette) -> None:
    """Give a figure the look of the page's charts, on a ground of its own: a notebook may be light or dark."""
    # ticks are a digit coarser than values that are read off
    dress(f, palette, TICKS, max(0, quantity.digits - 1))
    palette.paint(f, background_fill_color="surface", border_fill_color="surface")
    f.outline_line_color = None
    f.title.update(text_font=FONT, text_font_size="12px", text_font_style="normal")
    palette.paint(f.title, text_color="ink2")
    dress_legends(f, palette)
    if quantity is EFFORT:
        add_zero(f, palette)
