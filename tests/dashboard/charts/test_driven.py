import numpy as np
import pytest

from railjoule.core import load_scenario
from railjoule.core.simulation.following import simulate_following
from railjoule.dashboard.charts.driven import BRAKING, PLACE, reality_words
from railjoule.dashboard.charts.plot import CurveChart
from railjoule.dashboard.look.paint import Palette


@pytest.fixture(scope="module")
def following():
    changes = {"disturbance.coordinate_error_m": 10.0, "simulation.speed_error": 0.01}
    return simulate_following(load_scenario("liashenko-ii").replace(**changes))


def test_the_error_of_the_place_grows_and_falls_at_the_sensors(following):
    chart = CurveChart(PLACE, 150, Palette(dark=False))
    chart.build()
    chart.draw(following)
    error = np.asarray(chart.sources["error"].data["y"])
    assert error[0] == pytest.approx(10.0)
    # 1 % of the 1000 m to D1, which stands 300 m before the stop at 1300 m
    assert (error[1], error[2]) == (pytest.approx(20.0, abs=0.2), pytest.approx(0.0, abs=1e-9))
    assert abs(error[-1]) < 0.1
    assert list(chart.sources["sensors"].data["text"]) == ["D1", "D2", "D3"]
    assert np.all(np.diff(chart.sources["error"].data["x"]) >= 0)


def test_the_last_metres_show_the_sensors_where_they_stand(following):
    chart = CurveChart(BRAKING, 240, Palette(dark=False))
    chart.build()
    chart.draw(following)
    assert list(chart.sources["sensors"].data["x"]) == pytest.approx([-300.0, -180.0, -15.0])
    # v = sqrt(2 d s) at 300 m and 0.6 m/s2, (11) of Liashenko 2025, in km/h
    assert chart.sources["target"].data["y"][0] == pytest.approx(3.6 * np.sqrt(2 * 0.6 * 300), rel=1e-9)


def test_reality_in_words():
    assert reality_words(0.25, -5.0) == "load 25\u00a0%, \u22125\u00a0m"
