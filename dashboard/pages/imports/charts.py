"""The charts of Import: the line that was read, with what its tables leave open hatched."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.imports import ImportedLine, ImportedTable
from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.core.scenario import Line
from railjoule.dashboard.charts.chart import Axis, DistanceChart, columns, xy
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.imports.compute import Reading

Gap = tuple[float, float]
"""Where it begins and ends, from the start of the run [m]."""
WORD_PX, SIGN_PX = 7.2, 5.0
"""How wide a letter is, and how much of it a sign needs that may stand out over its stretch."""
ROOM_SHARE, LEAST_RELIEF_M = 0.3, 1.0
SIDES = ("left", "right", "bottom", "top")
HATCHED = {"line_color": "line2", "hatch_color": "warn"}
LEAST_M = 0.001
"""A shorter stretch is left by rounding."""
SHARPEST_1_PER_KM = 0.5
"""Curvature to which the axis reaches at least."""


class ImportedHeight(DistanceChart):
    """Height with the gradients above it; what no row describes is hatched."""

    unit = "m"

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("import_height", f"Height, m, with gradients, {words.PER_MILLE}", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        self.frame(ticks=3)
        self.source("height", "x", "y", "base")
        self.glyphs("varea", "height", "x", "base", "y", paint={"fill_color": "ground"})
        self.line("height", "groundline", line_width=1.4)
        self.glyphs("quad", "gaps", *SIDES, paint=HATCHED, fill_color=None, hatch_pattern="/", hatch_alpha=0.7)
        self.signs("gradients", "ink2", text_align="center", text_baseline="top", y_offset=2)

    def draw(self, line: Line, gaps: Sequence[Gap]) -> None:
        """Draw the line in running order."""
        x, y = section_borders(line), height_profile(line)
        relief = max(float(np.ptp(y)), LEAST_RELIEF_M)
        low, high = float(y.min()) - 0.15 * relief, float(y.max()) + ROOM_SHARE * relief
        self.set_range(low, high)
        self.put("height", **columns(x=x, y=y, base=np.full(len(x), low)))
        self.put("gaps", **spans(gaps, low, high))
        stretches = alike(line, [one.gradient_permille for one in line.sections])
        signs = [(0.5 * (a + b), words.signed(g, 0 if g == round(g) else 1), b - a) for a, b, g in stretches]
        metres = float(x[-1]) / self.width_px
        fitting = [(at, text) for at, text, room in signs if (len(text) * WORD_PX + 4) * metres < room]
        places = np.array([at for at, _ in fitting])
        self.put("gradients", **xy(places, np.full(len(fitting), high)), text=[text for _, text in fitting])


class ImportedLimits(DistanceChart):
    """Speed limits as steps; where there is none, nothing is drawn, and what no row describes is hatched."""

    unit = "km/h"
    stepped = True

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("import_limits", "Speed limits, km/h", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        self.frame(ticks=3)
        self.glyphs("quad", "gaps", *SIDES, paint=HATCHED, fill_color=None, hatch_pattern="/", hatch_alpha=0.7)
        self.glyphs("quad", "forbidden", *SIDES, paint={"fill_color": "ground"}, line_color=None)
        self.line("limits", "limit", line_width=1.8)
        self.signs("signs", "limit", text_align="center", text_baseline="top", y_offset=3)

    def draw(self, line: Line, gaps: Sequence[Gap]) -> None:
        """Draw the limits of the sections in running order."""
        x = section_borders(line)
        steps = alike(line, [one.speed_limit_kmh or np.inf for one in line.sections])
        there = [step for step in steps if np.isfinite(step[2])]
        top = 1.2 * max((limit for _, _, limit in there), default=100.0)
        self.set_range(0, top)
        self.put("gaps", **spans(gaps, 0.0, top))
        left, right, bottom = (np.array([step[k] for step in there]) for k in range(3))
        self.put("forbidden", **columns(left=left, right=right, bottom=bottom, top=np.full(len(there), top)))
        ends = np.array([end for step in steps for end in step[:2]])
        values = np.array([limit if np.isfinite(limit) else np.nan for _, _, limit in steps])
        self.put("limits", **xy(ends, np.repeat(values, 2)))
        metres = float(x[-1]) / self.width_px
        signs = [(0.5 * (a + b), limit) for a, b, limit in there if b - a > 3 * WORD_PX * metres]
        at, value = (np.array([sign[k] for sign in signs]) for k in range(2))
        self.put("signs", **xy(at, value), text=[f"{limit:g}" for _, limit in signs])


class ImportedCurves(DistanceChart):
    """Curvature of the curves, with their radii; tunnels and neutral sections as bands."""

    unit = "1/km"
    stepped = True
    digits = 2

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__(
            "import_curves", "Curvature, 1/km, with radii, m; tunnels and neutral sections", height, axis, palette
        )

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(with_axis=True, ticks=2, digits=1)
        f.xaxis.axis_label = "Distance, m"
        self.glyphs("quad", "bands", *SIDES, paint={"fill_color": "grid", "line_color": "line2"})
        paint = {"fill_color": "ground", "line_color": "groundline"}
        self.glyphs("quad", "curves", *SIDES, paint=paint)
        self.signs("radii", "ink2", text_align="center", text_baseline="bottom", y_offset=-2)
        self.signs("names", "ink3", text_align="center", text_baseline="top", y_offset=2)

    def draw(self, imported: ImportedLine) -> None:
        """Draw what the line has of them."""
        line = imported.line.in_running_order()
        curves = [one for one in alike(line, [section.curve_radius_m for section in line.sections]) if one[2]]
        left, right, radius = (np.array([one[k] for one in curves]) for k in range(3))
        bend = 1000 / radius
        top = 1.6 * max([*bend.tolist(), SHARPEST_1_PER_KM])
        self.set_range(0, top)
        self.put("curves", **columns(left=left, right=right, bottom=np.zeros(len(left)), top=bend))
        metres = line.length_m / self.width_px
        texts = [words.number(one, 0) for one in radius]
        room = right - left
        fits = np.array([len(text) * SIGN_PX * metres < wide for text, wide in zip(texts, room, strict=True)], bool)
        signed = [text for text, fit in zip(texts, fits, strict=True) if fit]
        self.put("radii", **xy((0.5 * (left + right))[fits], bend[fits]), text=signed)
        bands = [(one.from_m, one.to_m, "tunnel") for one in imported.tunnels]
        bands += [(one.from_m, one.to_m, "neutral") for one in line.neutral_sections]
        self.put("bands", **spans([(a, b) for a, b, _ in bands], 0.0, top))
        named = [(0.5 * (a + b), name) for a, b, name in bands if b - a > len(name) * WORD_PX * metres]
        self.put("names", **xy(np.array([at for at, _ in named]), np.full(len(named), top)), text=[n for _, n in named])


def alike(line: Line, values: Sequence[float]) -> list[tuple[float, float, float]]:
    """Return begin and end [m] of stretches over which a value of the sections stays the same, with the value."""
    stretches: list[tuple[float, float, float]] = []
    for (start, end), value in zip(pairwise(section_borders(line).tolist()), values, strict=True):
        if stretches and stretches[-1][2] == value:
            stretches[-1] = (stretches[-1][0], end, value)
        else:
            stretches.append((start, end, value))
    return stretches


def spans(stretches: Sequence[Gap], low: float, high: float) -> dict[str, FloatArray | list[float]]:
    """Return the columns of bands from `low` to `high`."""
    left, right = (np.array([stretch[k] for stretch in stretches]) for k in range(2))
    size = len(stretches)
    return columns(left=left, right=right, bottom=np.full(size, low), top=np.full(size, high))


def gaps_of(reading: Reading, kind: str) -> list[Gap]:
    """Return where the table of a kind says nothing of the line, from the start of the run; nothing where none is."""
    line = reading.line
    table = next((one for one in reading.tables if one.kind == kind), None)
    if line is None or table is None:
        return []
    length = line.line.length_m
    found = open_stretches(table, line.begin_m, line.begin_m + length)
    placed = [(start - line.begin_m, end - line.begin_m) for start, end in found]
    return [(length - end, length - start) for start, end in reversed(placed)] if line.is_reversed else placed


def open_stretches(table: ImportedTable, begin_m: float, end_m: float) -> list[Gap]:
    """Return the chainages between which no row of a table lies [m]."""
    found, reached = [], begin_m
    for one in table.intervals:
        start = min(one.from_m, end_m)
        if start - reached > LEAST_M:
            found.append((reached, start))
        reached = max(reached, one.to_m)
    if end_m - reached > LEAST_M:
        found.append((reached, end_m))
    return found
