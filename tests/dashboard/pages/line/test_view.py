import pytest
from lines import sent

from railjoule.core import load_scenario
from railjoule.dashboard.charts.chart import Axis
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.line.charts import LegBars, LineSpeedChart, fitting, supplement_s
from railjoule.dashboard.pages.line.compute import LineRequest, LineRuns, compute_line
from railjoule.dashboard.pages.line.view import figure_cells, legs_table


@pytest.fixture(scope="module")
def runs() -> LineRuns:
    stations = [
        {"name": "A", "position_m": 0},
        {"name": "<b>B</b>", "position_m": 900, "dwell_s": 20},
        {"name": "C", "position_m": 2300},
    ]
    scenario = load_scenario("metro-with-limit", {"line.stations": stations, "timetable.travel_time_s": 230.0})
    return compute_line(LineRequest(scenario, ()))


def test_the_bars_are_the_supplements_side_by_side(runs: LineRuns) -> None:
    palette = Palette(False)
    bars = LegBars("supplements", "s", 120, Axis(palette), palette, supplement_s, words.time)
    bars.show(lambda: bars.draw(runs, 900.0))
    for sharing, line in runs.runs.items():
        assert list(bars.sources[sharing].data["top"]) == pytest.approx([leg.supplement_s for leg in line.legs])
    left, right = bars.sources["optimum"].data, bars.sources["equal"].data
    assert all(a < b for a, b in zip(left["right"], right["left"], strict=True))
    assert left["left"][0] > 0
    assert right["right"][0] < 900 < left["left"][1]


def test_only_the_chosen_other_is_drawn(runs: LineRuns) -> None:
    palette = Palette(False)
    chart = LineSpeedChart(230, Axis(palette), palette)
    chart.show(lambda: chart.draw(runs, "equal", 900.0))
    assert len(sent(chart, "equal")[0]) > 100
    assert len(sent(chart, "proportional")[0]) == 0
    chart.draw(runs, "proportional", 900.0)
    assert len(sent(chart, "equal")[0]) == 0


def test_texts_name_the_stations_and_escape_them(runs: LineRuns) -> None:
    table = legs_table(runs)
    assert "A \u2013 &lt;b&gt;B&lt;/b&gt;" in table
    assert "<b>B" not in table
    assert "same on every leg" in "".join(figure_cells(runs))


def test_names_that_would_touch_are_left_out() -> None:
    stops = [(0.0, "First"), (10.0, "Second"), (500.0, "Third"), (1000.0, "Fourth")]
    assert [name for _, name, _ in fitting(stops, 1.0)] == ["First", "Fourth", "Third"]
