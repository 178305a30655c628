import numpy as np
import pytest

from railjoule.core import load_scenario, solve
from railjoule.dashboard.charts.chart import Axis
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.charts.speed import SpeedChart
from railjoule.dashboard.look.paint import Palette


@pytest.mark.parametrize("over_time", [False, True])
def test_passing_points_lie_on_the_line_of_the_run(over_time: bool) -> None:
    points = [{"position_m": 300.0, "speed_kmh": 32.5}, {"name": "Junction", "position_m": 1500.0, "speed_kmh": 45.0}]
    run = solve(load_scenario("metro-with-limit", {"line.passing_points": points}))
    palette = Palette(False)
    chart = SpeedChart(290, Axis(palette), palette)
    scene = RunScene("optimal", {"optimal": run}, None, over_time, False, 900.0)
    chart.axis.fit(scene.end, roomy=True)
    chart.show(lambda: chart.draw(scene))
    data = chart.sources["passes"].data
    assert list(data["text"]) == ["pass 32.5", "Junction 45"]
    # as `passing_points` ask for
    assert np.interp(data["x"], scene.x(run), run.speed_ms * 3.6) == pytest.approx([32.5, 45.0], abs=1e-6)
    assert list(data["y"]) == [32.5, 45.0]


def test_a_line_in_reverse_has_them_from_its_other_end() -> None:
    changes = {"line.passing_points": [{"position_m": 300.0, "speed_kmh": 32.5}], "line.reverse": True}
    run = solve(load_scenario("metro-with-limit", changes))
    palette = Palette(False)
    chart = SpeedChart(290, Axis(palette), palette)
    chart.show(lambda: chart.draw(RunScene("optimal", {"optimal": run}, None, False, False, 900.0)))
    # of 2300 m
    assert list(chart.sources["passes"].data["x"]) == [2000.0]
