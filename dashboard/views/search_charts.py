"""The path of a search for limits: which limits it looked at, and what they cost."""

import numpy as np
from bokeh.models import ColumnDataSource, LinearColorMapper, Range1d
from bokeh.transform import transform

from railjoule.core.arrays import FloatArray
from railjoule.core.limit_search.search import LimitSearch
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.views.charts import Chart, clear, columns, nice_range, text_style, write_names, xy
from railjoule.dashboard.views.figures import captioned, empty_figure
from railjoule.dashboard.views.line_names import Name, name_source, placed_names
from railjoule.dashboard.views.surface import CIVIDIS

DEAR = 0.75
"""Colours and the axis of energy end at this quantile: the dearest limits of an even search say little."""


class SearchPlaneChart(Chart):
    """Limits of two neighbouring sections, as the search drew them and as it drove them."""

    kind = "map"

    def __init__(self, height: int, palette: Palette) -> None:
        text = "Search: set speeds of two sections, km/h; dark: less energy, hollow: first samples"
        super().__init__("search_plane", text, height)
        self.palette, self.x_range, self.y_range = palette, Range1d(0, 1), Range1d(0, 1)

    def build(self) -> None:
        """Make the figure."""
        f = empty_figure(self.height, self.x_range, self.y_range, self.words, self.palette, ticks=5)
        self.figure = f
        self.asked, self.driven = (
            ColumnDataSource({"x": [], "y": []}),
            ColumnDataSource({"x": [], "y": [], "energy": []}),
        )
        self.path, self.ends = ColumnDataSource({"x": [], "y": []}), ColumnDataSource({"x": [], "y": [], "marker": []})
        self.signs = name_source()
        hollow = f.scatter("x", "y", source=self.asked, size=4, fill_color=None, line_width=1)
        self.palette.paint(hollow.glyph, line_color="groundline")
        self.mapper = LinearColorMapper(palette=list(CIVIDIS), low=0, high=1)
        dots = f.scatter("x", "y", source=self.driven, size=6.5, fill_color=transform("energy", self.mapper))
        # the cheapest would vanish in the dark
        dots.glyph.line_width = 0.7
        self.palette.paint(dots.glyph, line_color="ink3")
        path = f.line("x", "y", source=self.path, line_width=1)
        self.palette.paint(path.glyph, line_color="ink3")
        ends = f.scatter("x", "y", source=self.ends, marker="marker", size=11, line_width=2)
        self.palette.paint(ends.glyph, fill_color="speed_limits", line_color="surface")
        write_names(f, self.signs, 11)
        self.content = captioned(self.words, f)

    def draw(self, search: LimitSearch, first: int) -> None:
        """Draw the search in the limits of a section and the next one; `first` counts from 0."""
        assert self.figure is not None
        if len(search.best.limits_ms) < 2:
            for source in (self.asked, self.driven, self.path, self.ends, self.signs):
                clear(source)
            return
        pair = slice(first, first + 2)
        asked, driven = (limits_of(search, name)[:, pair] for name in ("unscaled_ms", "limits_ms"))
        energy = energies_kwh(search)
        known, samples = np.isfinite(energy), stages(search) == "sample"
        self.figure.xaxis.axis_label = f"Section {first + 1}, km/h"
        self.figure.yaxis.axis_label = f"Section {first + 2}, km/h"
        self.asked.data = xy(*asked[samples].T)
        self.driven.data = columns(x=driven[known, 0], y=driven[known, 1], energy=energy[known])
        if known.any():
            self.mapper.update(low=float(energy[known].min()), high=float(np.quantile(energy[known], DEAR)) + 1e-9)
        self.path.data = xy(*driven[known & ~samples].T)
        start, end = driven[int(np.argmin(np.where(samples, energy, np.inf)))], search.best.limits_ms[pair] / MS_PER_KMH
        self.ends.data = {"x": [start[0], end[0]], "y": [start[1], end[1]], "marker": ["circle", "diamond"]}
        near = float(np.abs(start - end).max()) < 2
        top = 1.04 * float(max(asked.max(), driven[known].max() if known.any() else 0.0))
        self.x_range.update(start=0, end=top)
        self.y_range.update(start=0, end=top)
        ink, place = self.palette.tokens["ink2"], (float(end[0]), float(end[1]))
        names = [Name("found", "found", ink, point=place)]
        if not near:
            names.append(Name("first", "best of the first search", ink, point=(float(start[0]), float(start[1]))))
        frame = self.frame_over((0.0, top), (0.0, top))
        self.signs.data = placed_names(frame, {}, names, [frame.dot(*place, 6)], 11)


class SearchPathChart(Chart):
    """Energy of each trip that the search looked at, and the best so far."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("search_path", "Search: energy of each trip, kWh, and the best so far", height)
        self.palette, self.x_range, self.y_range = palette, Range1d(0, 1), Range1d(0, 1)

    def build(self) -> None:
        """Make the figure."""
        f = empty_figure(self.height, self.x_range, self.y_range, self.words, self.palette, ticks=4, digits=1)
        self.figure = f
        f.xaxis.axis_label = "Trip"
        self.sources = {name: ColumnDataSource({"x": [], "y": []}) for name in ("sample", "refine", "best")}
        for name, token in (("sample", "groundline"), ("refine", "speed_limits")):
            points = f.scatter("x", "y", source=self.sources[name], size=4.5, line_color=None)
            self.palette.paint(points.glyph, fill_color=token)
        best = f.step("x", "y", source=self.sources["best"], mode="after", line_width=2)
        self.palette.paint(best.glyph, line_color="accent")
        self.border = ColumnDataSource({"x": [], "y": [], "text": [], "align": [], "offset": []})
        line = f.vspan("x", source=self.border, line_width=1)
        self.palette.paint(line.glyph, line_color="line2")
        sign = f.text(
            "x",
            "y",
            "text",
            source=self.border,
            text_align="align",
            x_offset="offset",
            text_baseline="top",
            background_fill_alpha=0.8,
            padding=1,
            **text_style(11),
        )
        self.palette.paint(sign.glyph, text_color="ink2", background_fill_color="surface")
        self.content = captioned(self.words, f)

    def draw(self, search: LimitSearch) -> None:
        """Draw the energies in the order in which they were looked at."""
        energy, stage = energies_kwh(search), stages(search)
        number = np.arange(1.0, len(energy) + 1)
        known = np.isfinite(energy)
        if not known.any():
            for source in (*self.sources.values(), self.border):
                clear(source)
            return
        for name in ("sample", "refine"):
            chosen = known & (stage == name)
            self.sources[name].data = xy(number[chosen], energy[chosen])
        best = np.minimum.accumulate(np.where(known, energy, np.inf))
        begun = np.isfinite(best)
        self.sources["best"].data = xy(number[begun], best[begun])
        low, high = nice_range(float(best[-1]), float(np.quantile(energy[known], DEAR)) + 1e-3)
        self.x_range.update(start=0, end=len(energy) + 1)
        self.y_range.update(start=low, end=high)
        samples = int((stage == "sample").sum())
        aside = samples > 0.5 * len(energy)
        self.border.data = {
            "x": [samples + 0.5],
            "y": [high],
            "text": [f"{samples} evenly spread, then {len(energy) - samples} of a simplex"],
            "align": ["right" if aside else "left"],
            "offset": [-5 if aside else 5],
        }


def limits_of(search: LimitSearch, name: str) -> FloatArray:
    """Return limits of all trips [km/h]; shape (trips, sections)."""
    return np.array([getattr(one, name) for one in search.evaluations]) / MS_PER_KMH


def energies_kwh(search: LimitSearch) -> FloatArray:
    """Return energies of all trips [kWh]; infinite where late."""
    return np.array([one.energy_j for one in search.evaluations]) / J_PER_KWH


def stages(search: LimitSearch) -> "np.ndarray[tuple[int], np.dtype[np.str_]]":
    """Return in which part of the search each trip was looked at."""
    return np.array([one.stage for one in search.evaluations])


def search_words(search: LimitSearch) -> str:
    """Tell what a search looked at, for those who cannot see its charts."""
    energy = energies_kwh(search)
    known = energy[np.isfinite(energy)]
    late = len(energy) - len(known)
    if not len(known):
        return "None of the combinations tried arrives in time."
    first = energy[stages(search) == "sample"]
    return (
        f"{len(energy)} combinations tried, {late} of them late; the best of the first {len(first)} needs "
        f"{words.energy(float(first.min()))} kWh, the best of all {words.energy(float(known.min()))} kWh."
    )
