"""All strategies of shipped scenarios drawn at once: no name lies on a line or on another name, or leaves its frame."""

from functools import cache
from itertools import combinations

import numpy as np
import pytest
from lines import sent

from railjoule.core import load_scenario
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.charts.figures import DistanceChart
from railjoule.dashboard.charts.names import LINE_HEIGHT, Box, Frame, text_width_px
from railjoule.dashboard.charts.run_charts import EnergyChart
from railjoule.dashboard.charts.run_lines import NAMES, RunLines
from railjoule.dashboard.charts.scene import RunChart, RunScene
from railjoule.dashboard.charts.speed import SpeedChart
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.compare.charts import PLOTS, Contender
from railjoule.dashboard.work.runs import Runs, RunsRequest, compute_runs

SCENARIOS = ("metro-with-limit", "tram-950m-stop", "ftorek-300s", "liashenko-ii")
WIDTHS = (640.0, 940.0, 1500.0)


@cache
def runs_of(name: str) -> Runs:
    return compute_runs(RunsRequest(load_scenario(name), tuple(STRATEGIES)))


def boxes(chart: DistanceChart, source: str, frame: Frame) -> dict[str, Box]:
    """Where the browser writes the names, from what it is sent."""
    data = chart.sources[source].data
    result = {}
    for x, y, text, align, dx, line in zip(
        *(data[key] for key in ("x", "y", "text", "align", "dx", "line")), strict=True
    ):
        width, height = text_width_px(text), 12 * LINE_HEIGHT
        left = float(frame.x_px(x)) + dx - (0.5 * width if align == "center" else 0.0)
        middle = float(frame.y_px(y))
        result[line] = left, middle - 0.5 * height, left + width, middle + 0.5 * height
    return result


def check(chart: RunLines, source: str, lines: tuple[str, ...]) -> dict[str, Box]:
    frame = chart.frame_now
    placed = boxes(chart, source, frame)
    for left, bottom, right, top in placed.values():
        assert left > -0.01
        assert bottom > -0.01
        assert right < frame.width_px + 0.01
        assert top < frame.height_px + 0.01
    for one, other in combinations(placed.values(), 2):
        # names at the ends of lines may touch
        beside = one[0] >= other[2] - 0.01 or other[0] >= one[2] - 0.01
        assert beside or one[1] >= other[3] - 0.01 or other[1] >= one[3] - 0.01
    for line in lines:
        source = chart.sources.get(line)
        x, y = sent(chart, line) if source is None else (np.asarray(source.data[key], dtype=float) for key in "xy")
        if not len(x):
            continue
        steps = np.linspace(0, len(x) - 1, 30 * len(x))
        along, up = (np.interp(steps, np.arange(len(x)), values) for values in (frame.x_px(x), frame.y_px(y)))
        for name, (left, bottom, right, top) in placed.items():
            on_it = (along > left) & (along < right) & (up > bottom) & (up < top)
            assert not on_it.any(), f"{name} lies on {line}"
    return placed


@pytest.mark.parametrize("over_time", [False, True])
@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("name", SCENARIOS)
def test_no_name_of_drive_lies_on_anything(name: str, width: float, over_time: bool) -> None:
    runs = runs_of(name)
    pinned = runs.runs["fastest"]
    palette = Palette(False)
    axis, lines = Axis(palette), tuple(STRATEGIES)
    charts: tuple[RunChart, ...] = (SpeedChart(250, axis, palette), EnergyChart(140, axis, palette))
    scene = RunScene("optimal", runs.runs, pinned, over_time, narrow=False, width_px=width)
    axis.fit(scene.end, roomy=True)
    counts = []
    for chart in charts:
        chart.width_px = width
        chart.build()
        chart.draw(scene)
        more = ("limit",) if isinstance(chart, SpeedChart) else ()
        placed = check(chart, "ends" if isinstance(chart, EnergyChart) else "names", (*lines, "pinned", *more))
        assert "optimal" in placed
        counts.append(len(placed))
    # at least the half of all names finds room, even where seven runs all but coincide
    assert min(counts) >= len(scene.named()) // 2


@pytest.mark.parametrize("over_time", [False, True])
@pytest.mark.parametrize("name", SCENARIOS)
def test_no_name_of_compare_lies_on_anything(name: str, over_time: bool) -> None:
    runs = runs_of(name)
    among = [Contender(key, key, key, run) for key, run in runs.runs.items()]
    palette = Palette(False)
    axis = Axis(palette)
    axis.fit(max(float((c.run.time_s if over_time else c.run.position_m)[-1]) for c in among), roomy=True)
    for plot in (plot for plot in PLOTS if NAMES in plot.above):
        chart = plot.made(axis, palette)
        chart.width_px = 940.0
        chart.build()
        chart.draw(among, among[0], over_time, narrow=False)
        assert check(chart, "names", tuple(STRATEGIES))
