import numpy as np
import pytest

from railjoule.core import load_scenario
from railjoule.core.studies import monte_carlo_steps, sensitivity
from railjoule.dashboard.charts.plot import CurveChart
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.words import MINUS
from railjoule.dashboard.pages.what_if.chance_charts import chance_table, histogram
from railjoule.dashboard.pages.what_if.heat_map import (
    MEASURES,
    HeatMapChart,
    cell_colour,
    percent_difference,
    printed_table,
)


@pytest.mark.parametrize("dark", [False, True])
def test_more_is_warm_and_less_is_cool(dark: bool) -> None:
    palette = Palette(dark)
    assert cell_colour(0.0, 10.0, palette) == palette.costs[0] == palette.savings[0]
    assert cell_colour(10.0, 10.0, palette) == palette.costs[-1]
    # a saving of 5.0 % looked like 5.2 % more
    assert cell_colour(-10.0, 10.0, palette) == palette.savings[-1] != palette.costs[-1]
    assert cell_colour(np.nan, 10.0, palette) == palette.tokens["ground"]
    assert cell_colour(0.0, 0.0, palette) == palette.costs[0]


def test_the_printed_table_stands_only_beside_its_own_case() -> None:
    scenario, measure = load_scenario("liashenko-i"), MEASURES["over_replanned"]
    shown = printed_table(sensitivity(scenario), measure)
    assert "Table 5" in shown
    # the printed 5.4 at +25 m and half load (Liashenko 2025, Table 5)
    assert ">5.4<" in shown
    assert printed_table(sensitivity(scenario, [0.5], [0.0], both_directions=False), measure) == ""
    other = scenario.replace(**{"vehicle.load_factor": 0.6})
    assert printed_table(sensitivity(other, [0.5], [0.0]), measure) == ""


def test_the_printed_table_has_the_measure_that_is_shown() -> None:
    """Table 7 at full load without a position error: printed 24.4 %, by (12) 23.0 %, otherwise 0.07 %."""
    table = sensitivity(load_scenario("liashenko-iii"))
    by_plan, by_load, other = (
        printed_table(table, MEASURES[key]) for key in ("overconsumption", "over_replanned", "delay_s")
    )
    assert f'+23.0 <span class="muted">24.4</span> <span class="open">{MINUS}1.4</span>' in by_plan
    assert f'+0.07 <span class="muted">24.4</span> <span class="open">{MINUS}24.3</span>' in by_load
    assert other == by_plan
    # the same whichever is shown, as `railjoule validate` has them
    spread = "13.3 percentage points against the plan, which is (12) of the paper, 16.0 above a plan for this load"
    assert spread in by_plan
    assert spread in by_load


def test_beside_a_plan_that_gives_energy_back_cells_tell_kilowatt_hours() -> None:
    """Over so long a time the train rolls to its end and gives back what it brakes: no share of that means anything."""
    scenario = load_scenario("metro-with-limit", {"timetable.travel_time_s": 9999.0})
    table = sensitivity(scenario, [0.5, 1.0], [0.0, 10.0], both_directions=False)
    assert table.planned_energy_kwh < 0
    for measure in (MEASURES["over_replanned"], MEASURES["overconsumption"]):
        assert all(text.endswith(" kWh") for text in measure.texts(table))
    assert (
        MEASURES["overconsumption"].texts(table)[0]
        == comparisons.above(table.energy_kwh[0, 0], table.planned_energy_kwh).cell
    )


def test_a_cell_that_misses_timetable_or_stop_is_no_saving() -> None:
    """At full load and +10 m the train is 3.2 s late and stops 14.5 m too far (walk_engineer.md, F8)."""
    table = sensitivity(
        load_scenario("metro-with-limit", {"simulation.target_braking": False}),
        [0.0, 1.0],
        [0.0, 10.0],
        both_directions=False,
    )
    measure = MEASURES["over_replanned"]
    assert table.over_replanned[1, 1] == pytest.approx(-0.018, abs=5e-4)
    assert (table.delay_s[1, 1], table.stop_error_m[1, 1]) == pytest.approx((3.2, 14.5), abs=0.05)
    assert measure.texts(table)[3] == "late"
    assert np.isnan(measure.drawn(table)[1, 1])
    # an empty train, which is in time, does save beside the plan for half a load
    in_time = MEASURES["overconsumption"]
    assert in_time.texts(table)[0].startswith(MINUS)
    assert in_time.drawn(table)[0, 0] == in_time.values(table)[0, 0] < 0
    # how late it is stays a number
    assert MEASURES["delay_s"].texts(table)[3] == "+3.2"


def test_cells_that_are_not_computed_yet_stay_empty() -> None:
    chosen: list[tuple[float, float]] = []
    chart = HeatMapChart(300, Palette(dark=False))
    chart.choose = lambda load, error: chosen.append((load, error))
    chart.build()
    table = sensitivity(load_scenario("liashenko-0"), both_directions=False)
    chart.draw(table, MEASURES["over_replanned"], 1.0, 5.0)
    assert list(chart.sources["cells"].data["text"]).count("") == 0
    assert chart.sources["frame"].data == {"x": [3.5], "y": [4.0]}
    assert chart.sources["plan"].data["x"] == [3]
    chart.draw(table, MEASURES["over_replanned"], 1.2, 5.0)
    assert np.isnan(chart.sources["frame"].data["y"]).all()  # a crush load has no row

    class Press:
        x, y = 5.2, 0.9

    chart._press(Press)
    assert chosen == [(0.25, 20.0)]


def test_a_histogram_marks_its_quantiles() -> None:
    chart = CurveChart(histogram("more", "More, %", "More, %", percent_difference), 190, Palette(dark=False))
    chart.build()
    chart.draw(np.append(np.linspace(0.0, 100.0, 1001), np.nan))
    assert np.allclose(chart.sources["marks"].data["x"], [5.0, 50.0, 95.0])
    assert chart.sources["signs"].data["text"][1] == "median: +50.0"
    chart.draw(np.array([np.nan]))
    assert chart.sources["bars"].data["top"] == []


def test_the_table_tells_the_earliest_and_the_latest_arrival() -> None:
    _, full = monte_carlo_steps(load_scenario("liashenko-0").replace(**{"montecarlo.runs": 30}))
    assert full.delay_s.min() < -0.05
    shown = chance_table(full)
    assert f">earliest {words.delay(full.delay_s.min())}<" in shown
    assert f">latest {words.delay(full.delay_s.max())}<" in shown
