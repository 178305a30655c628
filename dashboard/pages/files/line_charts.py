"""Preview of the line that was read: height, speed limits, curves; gaps of its tables are hatched."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from operator import methodcaller
from typing import Any

import numpy as np

from railjoule.core.imports import ImportedLine, ImportedTable
from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.core.scenario import Line
from railjoule.dashboard.charts.axis import columns, xy
from railjoule.dashboard.charts.chart import Layer
from railjoule.dashboard.charts.names import text_width_px
from railjoule.dashboard.charts.quantities import POSITION
from railjoule.dashboard.charts.run_lines import Curve, Heights, RunLines, RunPlot
from railjoule.dashboard.charts.track import as_steps
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.files.compute import Reading

Gap = tuple[float, float]
"""Its begin and end, from the start of the run [m]."""
Sign = tuple[float, float, float, str]
"""Begin and end of its stretch [m], the value at which it is written, and its text."""
SIGN_PX, ROOM_PX = 11, 4
ROOM_SHARE, LEAST_RELIEF_M = 0.3, 1.0
SIDES = ("left", "right", "bottom", "top")
HATCHED = {"line_color": "line2", "hatch_color": "warn"}
LEAST_M = 0.001
"""A shorter stretch is left by rounding."""
SHARPEST_1_PER_KM = 0.5
"""Curvature to which the axis reaches at least."""


@dataclass(frozen=True, eq=False)
class Preview:
    """The contents of a chart.

    Parameters
    ----------
    curve : pair of array
        Not a number where there is no value.
    base : float
        The area between it and the curve is tinted.
    ends : tuple of float
        Of the y axis.
    gaps : sequence
        Hatched stretches.
    bands : sequence
        Begin, end and name of each.
    signs : sequence
        Those that have room are written above their values; at the upper end of the axis below it.
    """

    curve: Curve
    base: float
    ends: tuple[float, float]
    gaps: Sequence[Gap] = ()
    bands: Sequence[tuple[float, float, str]] = ()
    signs: Sequence[Sign] = ()


def draw_preview(chart: RunLines, preview: Preview) -> None:
    """Draw a preview over the line."""
    (low, high), (x, y) = preview.ends, preview.curve
    chart.set_range(low, high)
    chart.put("curve", **xy(x, y))
    chart.put("area", **columns(x=x, low=np.full(len(x), preview.base), high=np.nan_to_num(y, nan=preview.base)))
    for name, stretches in (("bands", preview.bands), ("gaps", preview.gaps)):
        left, right = (np.array([stretch[k] for stretch in stretches]) for k in range(2))
        size = len(stretches)
        chart.put(name, **columns(left=left, right=right, bottom=np.full(size, low), top=np.full(size, high)))
    texts = [*preview.signs, *((begin, end, high, name) for begin, end, name in preview.bands)]
    px = chart.width_px / float(x[-1])
    # above its value a text may stand out at both sides
    fits = [
        (begin, end, at, text)
        for begin, end, at, text in texts
        if text_width_px(text, SIGN_PX) * (1.0 if at >= high else 0.5) + ROOM_PX < (end - begin) * px
    ]
    for name, signs in (
        ("signs", [sign for sign in fits if sign[2] < high]),
        ("names", [sign for sign in fits if sign[2] >= high]),
    ):
        places = np.array([0.5 * (begin + end) for begin, end, _, _ in signs])
        chart.put(name, **xy(places, np.array([at for _, _, at, _ in signs])), text=[text for *_, text in signs])


def preview_plot(
    name: str, caption: str, unit: str, heights: Heights, token: str = "groundline", digits: int = 0, last: bool = False
) -> RunPlot:
    """Return the figure of a preview; `token` is the colour of its curve."""
    layers: tuple[Layer, ...] = (
        methodcaller("glyphs", "varea", "area", "x", "low", "high", paint={"fill_color": "ground"}),
        methodcaller("glyphs", "quad", "bands", *SIDES, paint={"fill_color": "grid", "line_color": "line2"}),
        methodcaller(
            "glyphs", "quad", "gaps", *SIDES, paint=HATCHED, fill_color=None, hatch_pattern="/", hatch_alpha=0.7
        ),
        methodcaller("line", "curve", token, line_width=1.6),
        methodcaller("signs", "signs", "ink2", SIGN_PX, text_align="center", y_offset=-2),
        methodcaller("signs", "names", "ink2", SIGN_PX, text_align="center", text_baseline="top", y_offset=2),
        methodcaller("follow_line", "curve"),
    )
    quantity = replace(POSITION, name=name, words=caption, unit=unit, digits=digits)
    look: dict[str, Any] = {
        "ticks": 3,
        "digits": min(digits, 1),
        "last": last,
        "axis": "line",
        "above": layers,
        "draws": draw_preview,
    }
    return RunPlot(name, quantity, {}, heights, **look)


HEIGHT = preview_plot("import_height", f"Height, m, with gradients, {words.PER_MILLE}", "m", (150, 170, 130))
LIMITS = preview_plot("import_limits", "Speed limits, km/h", "km/h", (130, 150, 120), "limit")
CURVES = preview_plot(
    *("import_curves", "Curvature, 1/km, with radii, m; tunnels and neutral sections", "1/km", (120, 130, 120)),
    digits=2,
    last=True,
)
LINE_PLOTS = (HEIGHT, LIMITS, CURVES)


def previews(reading: Reading, imported: ImportedLine) -> dict[str, Preview]:
    """Return the contents of the charts of the line that was read."""
    line = imported.line.in_running_order()
    return {
        HEIGHT.name: height_preview(line, find_gaps(reading, "gradients")),
        LIMITS.name: limits_preview(line, find_gaps(reading, "limits")),
        CURVES.name: curves_preview(line, imported),
    }


def height_preview(line: Line, gaps: Sequence[Gap]) -> Preview:
    """Return the height of a line with its gradients."""
    y = height_profile(line)
    relief = max(float(np.ptp(y)), LEAST_RELIEF_M)
    low, high = float(y.min()) - 0.15 * relief, float(y.max()) + ROOM_SHARE * relief
    stretches = alike(line, [one.gradient_permille for one in line.sections])
    signs = [(a, b, high, words.tenths(g, words.signed)) for a, b, g in stretches]
    return Preview((section_borders(line), y), low, (low, high), gaps, signs=signs)


def limits_preview(line: Line, gaps: Sequence[Gap]) -> Preview:
    """Return the speed limits as steps; where there is none, there is no value."""
    limits = [one.speed_limit_kmh or np.nan for one in line.sections]
    top = 1.2 * max((limit for limit in limits if limit > 0), default=100.0)
    signs = [(a, b, limit, words.tenths(limit)) for a, b, limit in alike(line, limits) if limit > 0]
    return Preview(as_steps(section_borders(line), np.array(limits)), top, (0.0, top), gaps, signs=signs)


def curves_preview(line: Line, imported: ImportedLine) -> Preview:
    """Return the curvature with the radii; tunnels and neutral sections as bands."""
    radii = [section.curve_radius_m for section in line.sections]
    bends = np.array([1000 / radius if radius else 0.0 for radius in radii])
    top = 1.6 * max(float(bends.max()), SHARPEST_1_PER_KM)
    bands = [(one.from_m, one.to_m, "tunnel") for one in imported.tunnels]
    bands += [(one.from_m, one.to_m, "neutral") for one in line.neutral_sections]
    signs = [(a, b, 1000 / radius, words.number(radius, 0)) for a, b, radius in alike(line, radii) if radius]
    return Preview(as_steps(section_borders(line), bends), 0.0, (0.0, top), bands=bands, signs=signs)


def alike(line: Line, values: Sequence[float]) -> list[tuple[float, float, float]]:
    """Return begin and end [m] of stretches over which a value of the sections stays the same, with the value."""
    stretches: list[tuple[float, float, float]] = []
    for (start, end), value in zip(pairwise(section_borders(line).tolist()), values, strict=True):
        if stretches and stretches[-1][2] == value:
            stretches[-1] = (stretches[-1][0], end, value)
        else:
            stretches.append((start, end, value))
    return stretches


def find_gaps(reading: Reading, kind: str) -> list[Gap]:
    """Return the gaps in the table of a kind, from the start of the run [m]; none without such a table."""
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
