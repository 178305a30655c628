import numpy as np

from railjoule.core import load_scenario
from railjoule.core.studies import monte_carlo_steps
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.robustness.chance_charts import HistogramChart, chance_table
from railjoule.dashboard.pages.robustness.heat_map import percent_difference


def test_a_histogram_marks_its_quantiles() -> None:
    chart = HistogramChart("more", "More, %", "More, %", percent_difference, 190, Palette(dark=False))
    chart.build()
    chart.draw(np.append(np.linspace(0.0, 100.0, 1001), np.nan))
    assert np.allclose(chart.sources["marks"].data["x"], [5.0, 50.0, 95.0])
    assert chart.sources["signs"].data["text"][1] == "median: +50.0"
    chart.draw(np.array([np.nan]))
    assert chart.sources["bars"].data["top"] == []


def test_the_table_says_how_many_runs_there_are() -> None:
    empty, full = monte_carlo_steps(load_scenario("liashenko-0").with_(**{"montecarlo.runs": 30}))
    assert "0 of 30 runs, seed 1." in chance_table(empty)
    shown = chance_table(full)
    assert "30 of 30 runs, seed 1." in shown
    assert "Delay at the stop, s" in shown


def test_the_table_tells_the_earliest_and_the_latest_arrival() -> None:
    _, full = monte_carlo_steps(load_scenario("liashenko-0").with_(**{"montecarlo.runs": 30}))
    assert full.delay_s.min() < -0.05
    shown = chance_table(full)
    assert f">earliest {words.delay(full.delay_s.min())}<" in shown
    assert f">latest {words.delay(full.delay_s.max())}<" in shown
