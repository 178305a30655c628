"""The charts below the speed: what they draw of a run."""

import numpy as np
import pytest

from railjoule.core import load_scenario, solve
from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.charts.quantities import EFFORT
from railjoule.dashboard.charts.run_charts import EffortChart
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.look.paint import Palette


def test_the_effort_is_drawn_below_the_adhesion_of_wet_rails() -> None:
    palette = Palette(dark=False)
    chart = EffortChart(120, Axis(palette), palette)
    chart.build()
    dry = load_scenario("liashenko-ii", {"vehicle.load_factor": 0.0})
    for scenario in (dry.replace(**{"line.rail_condition": "wet"}), dry):
        run = solve(scenario, "fastest")
        chart.draw(RunScene("fastest", {"fastest": run}, None, False, False, 800))
        # another name would make Bokeh 3.9.2 fail in the browser
        assert chart.figure.html_attributes["aria-label"] == EFFORT.words
        drawn, most = np.array(chart.sources["adhesion"].data["y"]), np.array(chart.sources["largest"].data["y"])
        if scenario is dry:
            assert len(drawn) == 0
            assert "adhesion" not in chart.caption
        else:
            nodes = len(run.speed_ms)
            law = 0.6 * (7.5 / (3.6 * run.speed_ms + 44) + 0.161) * 160e3 * 9.81 / 1e3
            assert (drawn[:nodes], drawn[nodes + 1 :]) == (pytest.approx(law), pytest.approx(-law))
            assert most.max() <= law.max()
            assert "adhesion on wet rails" in chart.caption
