import numpy as np
import pytest

from railjoule.core import load_scenario, solve
from railjoule.dashboard.charts.chart import Axis
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.charts.speed import SpeedChart
from railjoule.dashboard.look.paint import Palette

# the last two lie so close that one word serves both
SECTIONS = [{"from_m": 300.0, "to_m": 400.0}, {"from_m": 1500.0, "to_m": 1510.0}, {"from_m": 1520.0, "to_m": 1530.0}]


def shown(run, over_time):
    palette = Palette(False)
    chart = SpeedChart(290, Axis(palette), palette)
    scene = RunScene("optimal", {"optimal": run}, None, over_time, False, 900.0)
    chart.axis.fit(scene.end, roomy=True)
    chart.show(lambda: chart.draw(scene))
    return chart, scene


@pytest.mark.parametrize("over_time", [False, True])
def test_bands_lie_where_the_front_has_no_power(over_time: bool) -> None:
    run = solve(load_scenario("metro-with-limit", {"line.neutral_sections": SECTIONS}))
    chart, scene = shown(run, over_time)
    bands = chart.sources["neutral"].data
    for side, key in (("left", "from_m"), ("right", "to_m")):
        assert np.interp(bands[side], scene.x(run), run.position_m) == pytest.approx([one[key] for one in SECTIONS])
    # at the foot, out of the way of the lines
    heights = np.array(bands["top"])
    assert 0 < heights.min() <= heights.max() < 0.1 * chart.y_range.end
    words = chart.sources["neutral_signs"].data
    assert list(words["text"]) == ["neutral", "neutral"]
    assert list(words["x"]) == [bands["left"][0], bands["left"][1]]
    told = "Without traction power: 300 to 400 m, 1,500 to 1,510 m, 1,520 to 1,530 m."
    assert told in chart.alternative(scene).replace("\u202f", ",").replace("\u2009", ",")


def test_a_line_without_them_has_no_band() -> None:
    chart, scene = shown(solve(load_scenario("metro-with-limit")), False)
    assert len(chart.sources["neutral"].data["left"]) == len(chart.sources["neutral_signs"].data["x"]) == 0
    assert "traction power" not in chart.alternative(scene)


def test_a_line_in_reverse_has_them_from_its_other_end() -> None:
    chart, _ = shown(
        solve(load_scenario("metro-with-limit", {"line.neutral_sections": SECTIONS[:1], "line.reverse": True})), False
    )
    # of 2300 m
    assert (list(chart.sources["neutral"].data["left"]), list(chart.sources["neutral"].data["right"])) == (
        [1900],
        [2000],
    )
