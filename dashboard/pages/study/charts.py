"""The figures of a study, made by HoloViews: the runs, histograms beside them, and a map of medians.

HoloViews makes a figure once for each choice of axes and colours, in a thread; what comes while the study runs is put
into the figure's columns, so that it costs the page as little as any other chart.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import holoviews as hv
import numpy as np
from bokeh.models import BoxAnnotation, ColumnDataSource, FixedTicker, Range1d
from bokeh.plotting import figure

from railjoule.core.arrays import FloatArray
from railjoule.core.studies.sweep import Study
from railjoule.dashboard.charts.chart import text_style
from railjoule.dashboard.charts.elements import figure_of
from railjoule.dashboard.charts.figures import dress_alone, ink_on
from railjoule.dashboard.charts.surface import CIVIDIS
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import DARK
from railjoule.dashboard.pages.study.columns import Column, columns_of, digits_for
from railjoule.dashboard.pages.study.compute import CELLS, Histogram, Look, Medians, Points, Raster
from railjoule.dashboard.pages.study.places import ALONG_X, ALONG_Y, FIGURES, MAP, RUNS, colours_for, shape_of

LEVELS = 256
# a run in a pixel by itself is still seen
LEAST_ALPHA = 0.45
QUANTILE_WORDS = "5 %", "median", "95 %"
BOTTOM_PX = 46
"""Numbers and title of the lower axis: the histogram beside it ends where the frame of the runs does."""
TIP_CSS = (
    ":host { --tooltip-color: var(--rj-surface) !important; --tooltip-border: var(--rj-line2) !important; "
    "--tooltip-arrow-color: var(--rj-line2) !important; opacity: 1 !important; } "
    "div.told { font: 12px/1.45 var(--rj-font); color: var(--rj-ink2); } "
    "div.told b { color: var(--rj-ink); font-weight: 600; }"
)


@dataclass(frozen=True, eq=False)
class StudyFigure:
    """A figure, and where its numbers go.

    Parameters
    ----------
    figure : figure
    sources : mapping
        Its columns, by name.
    palette : Palette
        The colours that it alone wears.
    box : BoxAnnotation or None
        Where the choice lies.
    """

    figure: figure
    sources: Mapping[str, ColumnDataSource]
    palette: Palette
    box: BoxAnnotation | None = None


@dataclass(frozen=True, eq=False)
class Drawn:
    """All figures of one choice of axes and colours."""

    shape: tuple[object, ...]
    figures: Mapping[str, StudyFigure]


def draw(study: Study, look: Look, dark: bool) -> Drawn:
    """Return the figures; they stand in no document yet, so any thread may make them."""
    columns = columns_of(study)
    x, y, colour, map_x, map_y = (columns[name] for name in look.request)
    made = {
        RUNS: _runs(look, x, y, colour, Palette(dark)),
        ALONG_X: _histogram(look.along_x, x, Palette(dark), upright=True),
        ALONG_Y: _histogram(look.along_y, y, Palette(dark), upright=False),
        MAP: _medians(look.medians, map_x, map_y, Palette(dark)),
    }
    drawn = Drawn(shape_of(look), {name: one for name, one in made.items() if one is not None})
    for name in FIGURES:
        if name in drawn.figures:
            fill(drawn.figures[name], name, look, columns)
    return drawn


def fill(into: StudyFigure, name: str, look: Look, columns: Mapping[str, Column]) -> None:
    """Put what is looked at into a figure of the same shape."""
    if name == RUNS:
        _fill_runs(into, look)
    elif name in {ALONG_X, ALONG_Y}:
        upright = name == ALONG_X
        told = look.along_x if upright else look.along_y
        if told is not None:
            ends = look.ends[0 if upright else 1]
            _fill_histogram(into, told, ends, columns[look.request[0 if upright else 1]], upright)
    elif look.medians is not None:
        _fill_medians(into, look.medians)


# ---- the runs


def _runs(look: Look, x: Column, y: Column, colour: Column, palette: Palette) -> StudyFigure:
    told = (("Run", "@row"), (x.words, "@x{0,0.00}"), (y.words, "@y{0,0.00}"), (colour.words, "@colour{0,0.00}"))

    def points() -> hv.Points:
        nothing: dict[str, Any] = {name: np.zeros(1) for name in ("x", "y", "colour", "row")}
        drawn = hv.Points(nothing, ["x", "y"], ["colour", "row"])
        return drawn.opts(color="colour", size=3, line_color=None, hover_tooltips=_tip(told), **common)

    def raster() -> hv.Overlay:
        places = [np.linspace(low, high, 2) for low, high in look.ends]
        nothing = np.zeros((2, 2))
        seen = hv.RGB((*places, *[nothing] * 4), vdims=["R", "G", "B", "A"]).opts(backend="bokeh")
        counted = (("Runs here", "@count"), (f"Mean {colour.within_sentence}, {colour.unit}".rstrip(", "), "@image"))
        # not seen, but what is told beneath the mouse
        known = hv.Image((*places, nothing, nothing), ["x", "y"], ["mean", "count"])
        return hv.Overlay([seen, known.opts(alpha=0, hover_tooltips=_tip(counted), **common)])

    common: dict[str, Any] = {
        "backend": "bokeh",
        "cmap": list(CIVIDIS),
        "tools": ["hover"],
        "default_tools": [],
        "responsive": True,
        "min_height": 100,
    }
    is_raster = isinstance(look.runs, Raster)
    f = figure_of(raster if is_raster else points)
    _dress(f, f"{y.words}, over {x.within_sentence}, {x.unit}", palette, keeps_hover=True)
    f.xaxis.axis_label, f.yaxis.axis_label = x.words, None
    for axis, (low, high) in zip((f.xaxis[0], f.yaxis[0]), look.ends, strict=True):
        axis.formatter.args = {"digits": digits_for(40 * (high - low))}
    f.min_border_bottom = BOTTOM_PX
    box = BoxAnnotation(visible=False, fill_alpha=0.12, line_alpha=0.9, line_width=2)
    palette.paint(box, fill_color="accent", line_color="accent")
    f.add_layout(box)
    names = ("seen", "known") if is_raster else ("points",)
    sources = {name: one.data_source for name, one in zip(names, f.renderers, strict=True)}
    return StudyFigure(f, sources, palette, box)


def _fill_runs(into: StudyFigure, look: Look) -> None:
    f, runs, dark = into.figure, look.runs, into.palette.tokens is DARK
    _set_range(f.x_range, look.ends[0])
    _set_range(f.y_range, look.ends[1])
    if isinstance(runs, Points):
        mapper = f.renderers[0].glyph.fill_color.transform
        mapper.update(low=look.colour_ends[0], high=look.colour_ends[1], palette=list(colours_for(dark)))
        numbers = {name: np.asarray(getattr(runs, name), dtype=np.float32) for name in ("x", "y", "colour")}
        _put(into.sources["points"], **numbers, color=numbers["colour"], row=runs.row.astype(np.int32))
    elif isinstance(runs, Raster):
        (left, right), (bottom, top) = look.ends
        place = {"x": [left], "y": [bottom], "dw": [right - left], "dh": [top - bottom]}
        _put(into.sources["seen"], image=[coloured(runs, look.colour_ends, SCALES[dark])], **place)
        mean, count = runs.mean.astype(np.float32), runs.count.astype(np.float32)
        _put(into.sources["known"], image=[mean], count=[count], **place)


def coloured(raster: Raster, ends: tuple[float, float], scale: Any) -> Any:
    """Return a raster as pixels: colour of a scale by the mean, opacity by the count; shape (rows, columns)."""
    low, high = ends
    share = np.clip((np.nan_to_num(raster.mean, nan=low) - low) / max(high - low, 1e-12), 0.0, 1.0)
    most = max(float(raster.count.max()), 1.0)
    alpha = LEAST_ALPHA + (1 - LEAST_ALPHA) * np.log1p(raster.count) / np.log1p(most)
    pixels = np.empty((*raster.count.shape, 4), dtype=np.uint8)
    pixels[..., :3] = scale[(share * (LEVELS - 1)).astype(int)]
    pixels[..., 3] = np.where(raster.count > 0, 255 * alpha, 0)
    return pixels.view(np.uint32)[..., 0]


def _scale(colours: tuple[str, ...]) -> Any:
    known = np.array([[int(colour[k : k + 2], 16) for k in (1, 3, 5)] for colour in colours], dtype=float)
    places = np.linspace(0, len(colours) - 1, LEVELS)
    return np.column_stack([np.interp(places, np.arange(len(colours)), part) for part in known.T]).astype(np.uint8)


SCALES = {dark: _scale(colours_for(dark)) for dark in (False, True)}
"""The colours of runs in `LEVELS` steps, by whether the sheet is dark; shape (LEVELS, 3)."""


def _tip(told: tuple[tuple[str, str], ...]) -> Markup:
    """Return what stands beneath the mouse, with the names of columns in the place of their values."""
    lines = joined(markup("<div>{}: <b>{}</b></div>", word, number) for word, number in told)
    return markup('<div class="told"><style>{}</style>{}</div>', Markup(TIP_CSS), lines)


# ---- histograms


def _histogram(told: Histogram | None, column: Column, palette: Palette, upright: bool) -> StudyFigure | None:
    if told is None:
        return None

    def element() -> hv.Histogram:
        return hv.Histogram((told.edges, told.counts)).opts(
            backend="bokeh",
            invert_axes=not upright,
            default_tools=[],
            responsive=True,
            min_height=20,
            xlabel="",
            ylabel="",
        )

    f = figure_of(element)
    _dress(f, f"How often: {column.words}", palette)
    f.xaxis.visible = f.yaxis.visible = False
    f.ygrid.visible = False
    f.xaxis.axis_label, f.yaxis.axis_label = column.words, column.words
    (bars,) = f.renderers
    palette.paint(bars.glyph, fill_color="line2", line_color="surface")
    bars.glyph.line_width = 0.5
    sources = {"bars": bars.data_source}
    if upright:
        # the same left and right borders as the figure of the runs, whose numbers stand there
        f.min_border_bottom = 0
    else:
        f.update(min_border_left=2, min_border_right=2, min_border_bottom=BOTTOM_PX)
        marks, signs = (ColumnDataSource({"x": [], "y": [], "end": []}), ColumnDataSource({"x": [], "y": [], "t": []}))
        line = f.segment("x", "y", "end", "y", source=marks, line_width=1.2)
        palette.paint(line.glyph, line_color="ink")
        text = f.text("x", "y", "t", source=signs, text_baseline="middle", x_offset=4, **text_style(11))
        palette.paint(text.glyph, text_color="ink2")
        sources |= {"marks": marks, "signs": signs}
    return StudyFigure(f, sources, palette)


def _fill_histogram(
    into: StudyFigure, told: Histogram, ends: tuple[float, float], column: Column, upright: bool
) -> None:
    f, most = into.figure, float(max(told.counts.max(), 1))
    # bars that lie on their side have the same columns
    _put(into.sources["bars"], left=told.edges[:-1], right=told.edges[1:], top=told.counts)
    if upright:
        _set_range(f.x_range, ends)
        _set_range(f.y_range, (0.0, 1.04 * most))
        return
    _set_range(f.y_range, ends)
    _set_range(f.x_range, (0.0, 2.6 * most))
    places = [place for place in told.places if ends[0] <= place <= ends[1]]
    named = [
        f"{word} {column.show(place)}"
        for word, place in zip(QUANTILE_WORDS, told.places, strict=True)
        if place in places
    ]
    _put(into.sources["marks"], x=[0.0] * len(places), y=places, end=[1.12 * most] * len(places))
    _put(into.sources["signs"], x=[1.12 * most] * len(places), y=apart(places, ends), t=named)


def apart(places: list[float], ends: tuple[float, float], least: float = 0.055) -> list[float]:
    """Return places for signs, moved up where two would lie over each other; `least` is a share of the axis."""
    moved: list[float] = []
    for place in places:
        moved.append(max(place, moved[-1] + least * (ends[1] - ends[0])) if moved else place)
    return moved


# ---- the map


def _medians(told: Medians | None, x: Column, y: Column, palette: Palette) -> StudyFigure | None:
    if told is None:
        return None
    middles = [(edges[1:] + edges[:-1]) / 2 for edges in (told.x_edges, told.y_edges)]

    def element() -> hv.QuadMesh:
        # in equal steps, as cells are: what stands at the axes says where they lie
        places = np.arange(CELLS + 1) - 0.5
        return hv.QuadMesh((places, places, np.zeros((CELLS, CELLS))), ["x", "y"], ["kwh"]).opts(
            backend="bokeh", cmap=list(CIVIDIS), default_tools=[], responsive=True, min_height=100, colorbar=False
        )

    f = figure_of(element)
    _dress(f, f"Median energy, kWh: {y.within_sentence} over {x.within_sentence}", palette)
    f.ygrid.visible = False
    for axis, column, places in zip((f.xaxis[0], f.yaxis[0]), (x, y), middles, strict=True):
        labels = dict(enumerate(short_numbers(places)))
        axis.update(
            ticker=FixedTicker(ticks=list(labels)),
            major_label_overrides=labels,
            axis_label=column.words,
            axis_line_color=None,
        )
    cells = f.renderers[0].data_source
    glyph = f.renderers[0].glyph
    glyph.update(fill_color="fill", line_width=2)
    palette.paint(glyph, line_color="surface")
    signs = ColumnDataSource({"x": [], "y": [], "text": [], "ink": []})
    style: dict[str, Any] = {"text_align": "center", "text_baseline": "middle", **text_style(12)}
    f.text("x", "y", "text", source=signs, text_color="ink", **style)
    return StudyFigure(f, {"cells": cells, "signs": signs}, palette)


def short_numbers(places: FloatArray) -> list[str]:
    """Return numbers with as few decimals as tell a thousandth of their span apart."""
    within = 1e-3 * float(np.ptp(places))
    digits = next((d for d in range(10) if np.all(np.abs(np.round(places, d) - places) <= within)), 9)
    return [words.number(float(place), digits) for place in places]


def _fill_medians(into: StudyFigure, told: Medians) -> None:
    kwh = told.kwh
    known = kwh[np.isfinite(kwh)]
    low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
    rows, columns = (index.ravel() for index in np.indices(kwh.shape))
    fills = [_colour(number, low, high, into.palette) for number in kwh.ravel()]
    edges: dict[str, Any] = {
        "left": columns - 0.5,
        "right": columns + 0.5,
        "bottom": rows - 0.5,
        "top": rows + 0.5,
    }
    _put(into.sources["cells"], **edges, kwh=kwh.ravel(), fill=fills)
    texts = [words.number(number, 1 if high >= 10 else 2) for number in kwh.ravel()]
    _put(into.sources["signs"], x=columns, y=rows, text=texts, ink=[ink_on(fill) for fill in fills])


def _colour(number: float, low: float, high: float, palette: Palette) -> str:
    if not np.isfinite(number):
        return palette.tokens["ground"]
    red, green, blue = SCALES[False][int((number - low) / max(high - low, 1e-12) * (LEVELS - 1))]
    return f"#{red:02x}{green:02x}{blue:02x}"


# ---- what they share


def _dress(f: figure, name: str, palette: Palette, keeps_hover: bool = False) -> None:
    dress_alone(f, name, palette, ticks=5, keeps_hover=keeps_hover)


def _set_range(ends: Range1d, wanted: tuple[float, float]) -> None:
    if (ends.start, ends.end) != wanted:
        ends.update(start=wanted[0], end=wanted[1])


def _put(source: ColumnDataSource, **columns: Any) -> None:
    source.data = columns
