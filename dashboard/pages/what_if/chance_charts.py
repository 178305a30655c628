"""Random draws of the conditions: histograms with their quantiles, energy over load, and a table of the runs."""

from collections.abc import Callable
from functools import partial
from operator import methodcaller

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.charts.axis import nice_range, xy
from railjoule.dashboard.charts.chart import Layer, no_grid
from railjoule.dashboard.charts.names import rows_of, text_width_px
from railjoule.dashboard.charts.plot import CurveChart, Plot
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.pages.what_if.heat_map import MEASURES, Measure
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.work.run_table import Column, RunTable

BINS = 36
SIGN_PX, ROW_PX = 11, 14.0
QUANTILES = {0.05: "5 %", 0.5: "median", 0.95: "95 %"}
SHOWN = (0.003, 0.997)
"""Share of the values that is drawn."""
MAX_POINTS = 2000


def finite(values: FloatArray) -> FloatArray:
    """Return the values of runs that reached the end."""
    return values[np.isfinite(values)]


def draw_histogram(show: Callable[[float], str], chart: CurveChart, values: FloatArray) -> None:
    """Draw the histogram of the values so far, with 5 %, median and 95 % as hairlines."""
    values = finite(values)
    if not len(values):
        chart.clear()
        return
    low, high = np.quantile(values, SHOWN)
    # where chance changes nothing, all values are one
    low, high = nice_range(float(low), float(max(high, low + 1e-3)))
    counts, edges = np.histogram(values, bins=BINS, range=(low, high))
    most = float(max(counts.max(), 1))
    chart.put("bars", left=edges[:-1].tolist(), right=edges[1:].tolist(), top=counts.tolist())
    chart.x_range.update(start=low, end=high)
    _mark(chart, show, np.quantile(values, list(QUANTILES)).tolist(), (low, high), most)


def _mark(
    chart: CurveChart, show: Callable[[float], str], places: list[float], ends: tuple[float, float], most: float
) -> None:
    """Draw the quantiles, their words in as many rows as they need above the bars."""
    texts = [f"{word}: {show(place)}" for word, place in zip(QUANTILES.values(), places, strict=True)]
    frame = chart.frame_over(ends, (0.0, most))
    spans = []
    for place, text in zip(places, texts, strict=True):
        width = text_width_px(text, SIGN_PX)
        left = float(frame.x_px(np.array(place))) - 0.5 * width
        left = min(max(left, 0.0), max(frame.width_px - width, 0.0))
        spans.append((left, left + width))
    rows = rows_of(spans)
    room_px = ROW_PX * (max(rows) + 1) + ROW_PX
    # the bars get the frame less the rows of words above them
    per_px = most / max(frame.height_px - room_px, ROW_PX)
    chart.y_range.update(start=0, end=most + room_px * per_px)
    levels = [most + (ROW_PX * row + 0.4 * ROW_PX) * per_px for row in rows]
    scale = (ends[1] - ends[0]) / frame.width_px
    chart.put("marks", x=places, y=levels)
    chart.put("signs", x=[ends[0] + 0.5 * (left + right) * scale for left, right in spans], y=levels, text=texts)


def histogram(name: str, caption: str, quantity: str, show: Callable[[float], str]) -> Plot:
    """Return the histogram of a quantity; `show` formats a value."""
    bars = {"fill_color": "line2", "line_color": "surface"}
    layers: tuple[Layer, ...] = (
        no_grid,
        lambda chart: chart.figure.yaxis[0].update(visible=False),
        methodcaller("glyphs", "quad", "bars", "left", "right", 0, "top", paint=bars, line_width=1),
        methodcaller("glyphs", "segment", "marks", "x", 0, "x", "y", paint={"line_color": "ink"}, line_width=1.2),
        methodcaller("signs", "signs", "ink2", SIGN_PX, text_align="center", y_offset=-2, text_baseline="bottom"),
    )
    draws = partial(draw_histogram, show)
    heights = 190, 220, 170
    return Plot(name, caption, {}, heights, quantity, ticks=2, sketch="bars", layers=layers, draws=draws)


def chance_table(table: StudyTable) -> str:
    """Return quantiles and ends of all results of the runs so far, and how many runs there are."""
    rows = []
    for key, measure in RESULTS.items():
        reached = finite(measure.values(table))
        if len(reached):
            places = (reached.min(), *np.quantile(reached, list(QUANTILES)), reached.max())
            cells = [measure.show(float(place)) for place in places]
            if key == "delay_s":
                cells[0], cells[-1] = f"earliest {cells[0]}", f"latest {cells[-1]}"
            rows.append(((measure.words, *cells), False))
    seed, stuck = table.scenario.montecarlo.seed, int(np.isnan(table.energy_kwh).sum())
    text = f"{words.number(table.done, 0)} of {words.number(table.scenario.montecarlo.runs, 0)} runs, seed {seed}."
    text += f" In {words.number(stuck, 0)} of them the train comes to a stand." if stuck else ""
    quantiles = parts.table("Monte Carlo", ("Result", "least", *QUANTILES.values(), "most"), rows)
    return parts.inset(quantiles, parts.note_paragraphs([text, *_missed_words(table)]))


def _missed_words(table: StudyTable) -> list[str]:
    """Return a sentence on runs that need less than a plan for their load only by a miss; empty if none."""
    known = table.replanned_kwh
    missed = int(comparisons.is_false_saving(table.energy_kwh, known, table.delay_s, table.stop_error_m).sum())
    count = f"{words.number(missed, 0)} of the runs need"
    return [f"{count} less than a plan for their load, but arrive late or miss the stop: no saving."] if missed else []


def draw_scatter(chart: CurveChart, table: StudyTable) -> None:
    """Draw the energy of the runs so far over the load that each carried, and that of plans for the actual load."""
    done = np.isfinite(table.energy_kwh)
    load = 100 * table["load_factor"][done]
    energy = table.energy_kwh[done]
    if not len(load):
        chart.clear()
        return
    chart.put("points", **xy(load[:MAX_POINTS], energy[:MAX_POINTS]))
    order = np.argsort(load)[:: max(1, len(load) // 60)]
    knowing = table.replanned_kwh[done][order]
    chart.put("line", **xy(load[order], knowing))
    low, high = nice_range(float(min(knowing.min(), energy.min())), float(np.quantile(energy, SHOWN[1])))
    chart.set_ranges((0.0, 100.0), (low, high))


SCATTER = Plot(
    "scatter",
    "Energy, kWh, over load; blue: planned for that load",
    heights=(220, 260, 200),
    x_title="Load, %",
    digits=1,
    sketch="map",
    layers=(
        methodcaller(
            *("glyphs", "scatter", "points", "x", "y"),
            paint={"fill_color": "driven"},
            size=3.5,
            fill_alpha=0.35,
            line_color=None,
        ),
        methodcaller("line", "line", "accent", line_width=1.8),
    ),
    draws=draw_scatter,
)


# ---- the draws as a table of runs


def _drawn(name: str, title: str, show: Callable[[float], str], scale: float = 1.0) -> Measure:
    return Measure(title, lambda table: scale * table[name], show)


INPUTS = {
    "load": _drawn("load_factor", "Load, %", partial(words.number, digits=0), 100),
    "error": _drawn("coordinate_error_m", "Position error, m", words.signed),
    "resistance": _drawn("resistance_factor", "Running resistance, %", words.number, 100),
    "voltage": _drawn("line_voltage_factor", "Supply voltage, %", words.number, 100),
    "departure": _drawn("departure_delay_s", "Departure delay, s", words.time),
    "speed": _drawn("speed_error", "Speed error, %", partial(words.signed, digits=2), 100),
    **{name: _drawn(f"{name}_error_m", f"{name.upper()}'s place, m", words.stop_error) for name in ("d1", "d2", "d3")},
}
RESULTS = {"energy": Measure("Energy, kWh", lambda table: table.energy_kwh, words.energy), **MEASURES}
"""Inputs and results of the random runs."""


def draws_table(table: StudyTable) -> RunTable | None:
    """Return the draws that reached the end, with the quantities in which they differ; None where none varies."""
    reached = np.flatnonzero(np.isfinite(table.energy_kwh))
    columns, values = {}, {}
    for name, measure in {**INPUTS, **RESULTS}.items():
        found = measure.values(table)[reached]
        if len(np.unique(found)) > 1 and np.all(np.isfinite(found)):
            ends = (float(found.min()), float(found.max())) if name in INPUTS else None
            columns[name], values[name] = Column(measure.words, measure.show, ends), found
    if not values.keys() & INPUTS.keys() or "energy" not in values:
        return None
    title = f"{words.number(table.done, 0)} random draws of What if"
    return RunTable(title, columns, values, reached, table.done, "energy", "The train comes to a stand.")
