from dataclasses import replace

import numpy as np
import pytest
from bokeh.document import Document

from railjoule.core import Trajectory, load_scenario, solve
from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.charts.speed import BRAKING, BRAKING_WORDS, SpeedChart
from railjoule.dashboard.look.paint import Palette

CURVE = {"vehicle.braking.permitted_deceleration": [[0, 0.5]]}
# the last two lie so close that one word serves both
NEUTRAL = [{"from_m": 300.0, "to_m": 400.0}, {"from_m": 1500.0, "to_m": 1510.0}, {"from_m": 1520.0, "to_m": 1530.0}]
POINTS = [{"position_m": 300.0, "speed_kmh": 32.5}, {"name": "Junction", "position_m": 1500.0, "speed_kmh": 45.0}]


def new_chart() -> SpeedChart:
    palette = Palette(False)
    return SpeedChart(290, Axis(palette), palette)


def shown(run: Trajectory, over_time: bool = False, chart: SpeedChart | None = None) -> tuple[SpeedChart, RunScene]:
    chart = chart or new_chart()
    scene = RunScene(run.strategy, {run.strategy: run}, None, over_time, False, 900.0)
    chart.axis.fit(scene.end, roomy=True)
    chart.show(lambda: chart.draw(scene))
    return chart, scene


@pytest.mark.parametrize("over_time", [False, True])
def test_the_braking_curve_lies_where_the_run_passes_it_and_has_its_name(over_time: bool) -> None:
    """At 0.5 m/s2, 100 m before the end of the line: 10 m/s."""
    run = solve(load_scenario("metro-with-limit", CURVE), "fastest")
    chart, _ = shown(run, over_time)
    data = chart.sources[BRAKING].data
    assert np.array_equal(data["x"], run.time_s if over_time else run.position_m)
    here = np.argmin(np.abs(run.position_m - (run.position_m[-1] - 100.0)))
    assert data["y"][here] == pytest.approx(3.6 * np.sqrt(2 * 0.5 * (run.position_m[-1] - run.position_m[here])))
    assert BRAKING_WORDS in chart.sources["names"].data["text"]
    assert BRAKING_WORDS in [entry[0] for entry in chart.cursor_data["sources"]]


def test_a_vehicle_without_one_takes_it_away_again() -> None:
    chart, _ = shown(solve(load_scenario("metro-with-limit", CURVE), "fastest"))
    shown(solve(load_scenario("metro-with-limit"), "fastest"), chart=chart)
    assert list(chart.sources[BRAKING].data["x"]) == []
    assert BRAKING_WORDS not in chart.sources["names"].data["text"]
    assert BRAKING_WORDS not in [entry[0] for entry in chart.cursor_data["sources"]]


@pytest.mark.parametrize("over_time", [False, True])
def test_neutral_sections_lie_where_the_front_has_no_power_and_passing_points_on_the_run(over_time: bool) -> None:
    changes = {"line.neutral_sections": NEUTRAL, "line.passing_points": POINTS}
    run = solve(load_scenario("metro-with-limit", changes))
    chart, scene = shown(run, over_time)
    bands = chart.sources["neutral"].data
    for side, key in (("left", "from_m"), ("right", "to_m")):
        assert np.interp(bands[side], scene.x(run), run.position_m) == pytest.approx([one[key] for one in NEUTRAL])
    # at the foot, out of the way of the lines
    heights = np.array(bands["top"])
    assert 0 < heights.min() <= heights.max() < 0.1 * chart.y_range.end
    words = chart.sources["neutral_signs"].data
    assert list(words["text"]) == ["neutral", "neutral"]
    assert list(words["x"]) == [bands["left"][0], bands["left"][1]]
    told = "Without traction power: 300 to 400 m, 1,500 to 1,510 m, 1,520 to 1,530 m."
    assert told in chart.alternative(scene).replace("\u202f", ",").replace("\u2009", ",")
    passes = chart.sources["passes"].data
    assert list(passes["text"]) == ["pass 32.5", "Junction 45"]
    # as the points ask for
    assert np.interp(passes["x"], scene.x(run), run.speed_ms * 3.6) == pytest.approx([32.5, 45.0], abs=1e-5)
    assert list(passes["y"]) == [32.5, 45.0]


def test_the_tint_above_the_limits_of_several_runs_is_sent_once_over_time() -> None:
    """Bokeh sends columns as they are at the end of a message: a second change would meet columns of other lengths."""
    scenario = load_scenario("metro-with-limit")
    runs = {name: solve(scenario, name) for name in ("optimal", "fastest")}
    chart = new_chart()
    scene = RunScene("optimal", runs, None, False, False, 900.0)
    chart.axis.fit(scene.end, roomy=True)
    chart.show(lambda: chart.draw(scene))
    assert len(chart.sources["forbidden"].data["left"]) == 3
    document, events = Document(), []
    document.add_root(chart.content.object)
    document.on_change(events.append)
    chart.draw(replace(scene, over_time=True))
    assert len(chart.sources["forbidden"].data["left"]) == 0
    assert sum(getattr(event, "model", None) is chart.sources["forbidden"] for event in events) == 1


def test_a_line_without_neutral_sections_has_no_band() -> None:
    chart, scene = shown(solve(load_scenario("metro-with-limit")))
    assert len(chart.sources["neutral"].data["left"]) == len(chart.sources["neutral_signs"].data["x"]) == 0
    assert "traction power" not in chart.alternative(scene)


def test_a_line_in_reverse_has_them_from_its_other_end() -> None:
    """Its length is 2300 m."""
    changes = {"line.neutral_sections": NEUTRAL[:1], "line.passing_points": POINTS[:1], "line.reverse": True}
    sources = shown(solve(load_scenario("metro-with-limit", changes)))[0].sources
    assert list(sources["passes"].data["x"]) == [2000.0]
    assert (list(sources["neutral"].data["left"]), list(sources["neutral"].data["right"])) == ([1900], [2000])
