import numpy as np
import pytest

from railjoule.core import Trajectory, load_scenario, solve
from railjoule.dashboard.charts.chart import Axis
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.charts.speed import BRAKING, BRAKING_WORDS, SpeedChart, last_descent
from railjoule.dashboard.look.paint import Palette

CURVE = {"vehicle.braking.permitted_deceleration": [[0, 0.5]]}


def drawn(chart: SpeedChart, run: Trajectory, over_time: bool = False) -> SpeedChart:
    scene = RunScene("fastest", {"fastest": run}, None, over_time, False, 900.0)
    chart.axis.fit(scene.end, roomy=True)
    chart.show(lambda: chart.draw(scene))
    return chart


@pytest.mark.parametrize("over_time", [False, True])
def test_the_braking_curve_lies_where_the_run_passes_it_and_has_its_name(over_time: bool) -> None:
    """At 0.5 m/s2, 100 m before the end of the line: 10 m/s."""
    run = solve(load_scenario("metro-with-limit", CURVE), "fastest")
    palette = Palette(False)
    chart = drawn(SpeedChart(290, Axis(palette), palette), run, over_time)
    data = chart.sources[BRAKING].data
    assert np.array_equal(data["x"], run.time_s if over_time else run.position_m)
    here = np.argmin(np.abs(run.position_m - (run.position_m[-1] - 100.0)))
    assert data["y"][here] == pytest.approx(3.6 * np.sqrt(2 * 0.5 * (run.position_m[-1] - run.position_m[here])))
    assert BRAKING_WORDS in chart.sources["names"].data["text"]
    assert BRAKING_WORDS in [told[0] for told in chart.told["sources"]]


def test_a_vehicle_without_one_takes_it_away_again() -> None:
    palette = Palette(False)
    chart = drawn(SpeedChart(290, Axis(palette), palette), solve(load_scenario("metro-with-limit", CURVE), "fastest"))
    drawn(chart, solve(load_scenario("metro-with-limit"), "fastest"))
    assert list(chart.sources[BRAKING].data["x"]) == []
    assert BRAKING_WORDS not in chart.sources["names"].data["text"]
    assert BRAKING_WORDS not in [told[0] for told in chart.told["sources"]]


def test_the_name_of_a_braking_curve_stands_where_it_falls() -> None:
    x = np.arange(6.0)
    assert [part.tolist() for part in last_descent((x, np.array([9.0, 9.0, 5.0, 8.0, 4.0, 0.0])))] == [
        [3, 4, 5],
        [8, 4, 0],
    ]
    # a run that leaves the line at its limit
    level = np.array([9.0, 7.0, 9.0, 9.0, 9.0, 9.0])
    assert last_descent((x, level))[1].tolist() == level.tolist()
