"""The path of a search for limits: which limits it looked at, and what they cost."""

import numpy as np
from bokeh.models import LinearColorMapper
from bokeh.transform import transform

from railjoule.core.arrays import FloatArray
from railjoule.core.limit_search.search import LimitSearch
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.charts.chart import columns, nice_range, xy
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.charts.line_names import Name
from railjoule.dashboard.charts.surface import CIVIDIS
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette

DEAR = 0.75
"""Colours and the axis of energy end at this quantile: the dearest limits of an even search say little."""


class SearchPlaneChart(LoneChart):
    """Limits of two neighbouring sections, as the search drew them and as it drove them."""

    kind = "map"

    def __init__(self, height: int, palette: Palette) -> None:
        caption = "Search: set speeds of two sections, km/h; dark: less energy, hollow: first samples"
        super().__init__("search_plane", caption, height, palette)

    def build(self) -> None:
        """Make the figure."""
        self.frame(ticks=5)
        edge = {"line_color": "ink3"}
        self.glyphs(
            "scatter", "asked", "x", "y", paint={"line_color": "groundline"}, size=4, fill_color=None, line_width=1
        )
        self.mapper = LinearColorMapper(palette=list(CIVIDIS), low=0, high=1)
        self.source("driven", "x", "y", "energy")
        by_energy = transform("energy", self.mapper)
        dots = self.glyphs("scatter", "driven", "x", "y", paint=edge, size=6.5, fill_color=by_energy)
        # the cheapest would vanish in the dark
        dots.glyph.line_width = 0.7
        self.line("path", "ink3", line_width=1)
        self.source("ends", "x", "y", "marker")
        self.dots("ends", "speed_limits", marker="marker", size=11, line_width=2)
        self.add_names(size=11)

    def draw(self, search: LimitSearch, first: int, before: int = 0) -> None:
        """Draw the search in the limits of a section and the next one.

        `first` counts from 0 within the search, `before` are the sections of the line before those of the search.
        """
        assert self.figure is not None
        if len(search.best.limits_ms) < 2:
            self.clear()
            return
        pair = slice(first, first + 2)
        asked, driven = (limits_of(search, name)[:, pair] for name in ("unscaled_ms", "limits_ms"))
        energy = energies_kwh(search)
        known, samples = np.isfinite(energy), stages(search) == "sample"
        self.figure.xaxis.axis_label = f"Section {before + first + 1}, km/h"
        self.figure.yaxis.axis_label = f"Section {before + first + 2}, km/h"
        self.put("asked", **xy(*asked[samples].T))
        self.put("driven", **columns(x=driven[known, 0], y=driven[known, 1], energy=energy[known]))
        if known.any():
            # 1e-9: where all trips cost the same, the colours must still span something
            self.mapper.update(low=float(energy[known].min()), high=float(np.quantile(energy[known], DEAR)) + 1e-9)
        self.put("path", **xy(*driven[known & ~samples].T))
        start, end = driven[int(np.argmin(np.where(samples, energy, np.inf)))], search.best.limits_ms[pair] / MS_PER_KMH
        self.put("ends", x=[start[0], end[0]], y=[start[1], end[1]], marker=["circle", "diamond"])
        # two points closer than 2 km/h lie over each other: one name tells both
        near = float(np.abs(start - end).max()) < 2
        top = 1.04 * float(max(asked.max(), driven[known].max() if known.any() else 0.0))
        self.set_ranges((0.0, top), (0.0, top))
        ink, place = self.palette.tokens["ink2"], (float(end[0]), float(end[1]))
        names = [Name("found", "found", ink, point=place)]
        if not near:
            names.append(Name("first", "best of the first search", ink, point=(float(start[0]), float(start[1]))))
        self.place_names({}, names, [self.frame_now.dot(*place, 6)], size=11)


class SearchPathChart(LoneChart):
    """Energy of each trip that the search looked at, and the best so far."""

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("search_path", "Search: energy of each trip, kWh, and the best so far", height, palette)

    def build(self) -> None:
        """Make the figure."""
        self.frame(ticks=4, digits=1, x_title="Trip")
        for name, token in (("sample", "groundline"), ("refine", "speed_limits")):
            self.glyphs("scatter", name, "x", "y", paint={"fill_color": token}, size=4.5, line_color=None)
        self.glyphs("step", "best", "x", "y", paint={"line_color": "accent"}, mode="after", line_width=2)
        self.source("border", "x", "y", "text", "align", "offset")
        self.hairlines("border", "line2")
        self.grounded_signs("border", "ink2", 11, text_align="align", x_offset="offset", text_baseline="top")

    def draw(self, search: LimitSearch) -> None:
        """Draw the energies in the order in which they were looked at."""
        energy, stage = energies_kwh(search), stages(search)
        number = np.arange(1.0, len(energy) + 1)
        known = np.isfinite(energy)
        if not known.any():
            self.clear()
            return
        is_sample = stage == "sample"
        for name, chosen in (("sample", known & is_sample), ("refine", known & ~is_sample)):
            self.put(name, **xy(number[chosen], energy[chosen]))
        best = np.minimum.accumulate(np.where(known, energy, np.inf))
        begun = np.isfinite(best)
        self.put("best", **xy(number[begun], best[begun]))
        low, high = nice_range(float(best[-1]), float(np.quantile(energy[known], DEAR)) + 1e-3)
        self.set_ranges((0.0, len(energy) + 1.0), (low, high))
        samples = int(is_sample.sum())
        aside = samples > 0.5 * len(energy)
        self.put(
            "border",
            x=[samples + 0.5],
            y=[high],
            text=[f"{samples} evenly spread, then {len(energy) - samples} of a simplex"],
            align=["right" if aside else "left"],
            offset=[-5 if aside else 5],
        )


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
        f"{len(energy)} combinations tried, {late} of them not in time; the best of the first {len(first)} needs "
        f"{words.energy(float(first.min()))} kWh, the best of all {words.energy(float(known.min()))} kWh."
    )
