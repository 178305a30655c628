from itertools import pairwise

import pytest
from lines import sent

from railjoule.core import load_scenario
from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.line.charts import (
    SPEED,
    LegBars,
    SlackChart,
    fitting,
    grip_columns,
)
from railjoule.dashboard.pages.line.compute import LineRuns, compute_line
from railjoule.dashboard.pages.line.texts import figure_cells, legs_table, missed_words, sharing_words

STATIONS = (
    {"name": "A", "position_m": 0},
    {"name": "<b>B</b>", "position_m": 900, "dwell_s": 20},
    {"name": "C", "position_m": 2300},
)


def runs_with(**times: object) -> LineRuns:
    """Return the runs over a line with one station between its ends, which has these keys too."""
    start, middle, end = STATIONS
    changes = {"line.stations": [start, {**middle, **times}, end], "timetable.travel_time_s": 230.0}
    return compute_line(load_scenario("metro-with-limit", changes))


@pytest.fixture(scope="module")
def runs() -> LineRuns:
    return runs_with()


@pytest.fixture(scope="module")
def given() -> LineRuns:
    return runs_with(arrival_s=90.0)


def test_a_given_timetable_is_a_second_bar_and_goes_again(runs: LineRuns, given: LineRuns) -> None:
    palette = Palette(False)
    bars = LegBars("supplements", "s", 120, Axis(palette), palette, lambda leg: leg.supplement_s, words.time)
    bars.show(lambda: bars.draw(given, "given", 900.0))
    for one, other in pairwise([bars.sources[sharing].data for sharing in ("optimum", "given")]):
        assert all(a < b for a, b in zip(one["right"], other["left"], strict=True))
    # a number stands at the end of the optimum's own bar, as high as that
    signs, optimum = bars.sources["signs"].data, bars.sources["optimum"].data
    assert list(signs["text"]) == [words.time(leg.supplement_s) for leg in given.best.legs]
    assert list(signs["x"]) == list(optimum["right"])
    assert list(signs["y"]) == list(optimum["top"])
    bars.draw(given, "given", 60.0)
    assert list(bars.sources["signs"].data["text"]) == []
    bars.draw(runs, "equal", 900.0)
    assert list(bars.sources["given"].data["top"]) == []


def test_a_station_can_be_dragged_until_a_leg_beside_it_has_nothing_left(given: LineRuns) -> None:
    grips = grip_columns(given)
    first, second = given.runs["given"].legs
    assert (grips["name"], grips["time"]) == (["<b>B</b>"], pytest.approx([90.0], abs=1e-4))
    assert grips["low"] == pytest.approx([0.1])
    assert grips["high"] == pytest.approx([first.supplement_s + second.supplement_s - 0.1])


def test_without_a_given_timetable_stations_are_dragged_from_the_optimum(runs: LineRuns) -> None:
    assert grip_columns(runs)["rest"] == [runs.best.legs[0].supplement_s]


def test_what_the_browser_has_dragged_is_taken_and_a_drawing_meanwhile_leaves_it(given: LineRuns) -> None:
    palette, moves, released = Palette(False), [], []
    chart = SlackChart(140, Axis(palette), palette)
    chart.move, chart.release = lambda *move: moves.append(move), lambda: released.append(True)
    chart.show(lambda: chart.draw(given, "equal", 900.0))
    assert len(chart.sources["given"].data["top"]) == len(chart.sources["equal"].data["top"]) == 2
    top = chart.y_range.end
    chart.sources["moved"].data = {"number": [0], "time": [92.5]}
    assert moves == [(0, 92.5)]
    later = runs_with(arrival_s=105.0)
    chart.moving = True
    chart.draw(later, "equal", 900.0)
    assert chart.y_range.end == top
    assert chart.sources["grips"].data["time"] == pytest.approx([90.0], abs=1e-4)
    chart.moving = False
    chart.draw(later, "equal", 900.0)
    assert chart.y_range.end > top
    assert chart.sources["grips"].data["time"] == pytest.approx([105.0], abs=1e-4)
    # what is emptied is no move
    assert moves == [(0, 92.5)]


def test_the_verdict_has_the_figure_of_the_row_above_and_says_when_it_is_too_little(given: LineRuns) -> None:
    best, other = given.best.run.energy_kwh, given.runs["given"].run.energy_kwh
    assert (other / best - 1) < 0.01
    (sentence,) = sharing_words(given)
    assert f"the present timetable costs {100 * (other / best - 1):.2f} % more: less than 1.0 %" in sentence
    far = runs_with(arrival_s=105.0)
    more = far.runs["given"].run.energy_kwh / far.best.run.energy_kwh - 1
    assert more > 0.05
    optimal = f"Compared with the optimal supplement, {words.energy(far.best.run.energy_kwh)} kWh"
    assert sharing_words(far) == [f"{optimal}, the present timetable costs {100 * more:.1f} % more."]
    assert any(f">+{100 * more:.1f}<" in cell for cell in figure_cells(far))


def test_a_given_timetable_that_cannot_be_kept_is_told() -> None:
    runs = runs_with(arrival_s=20.0)
    assert "given" not in runs.runs
    verdict, refused = sharing_words(runs)
    assert " and " in verdict
    assert refused.startswith("The present timetable is not shown. The arrival at <b>B</b> after 20.0 s must be later")


def test_a_window_that_a_rule_misses_is_told() -> None:
    runs = runs_with(earliest_arrival_s=120.0, arrival_s=110.0)
    assert runs.best.legs[0].arrival_s == pytest.approx(120.0, abs=1e-4)
    told = missed_words(runs)
    assert [sentence.partition(":")[0] for sentence in told] == [
        "Proportional supplement",
        "Equal supplement",
        "Present timetable",
    ]
    assert told[2].endswith("It arrives at <b>B</b> after 110.0 s, and was to arrive no earlier than 120.0 s.")


def test_the_table_ends_with_sums(given: LineRuns) -> None:
    table = legs_table(given, "given")
    shortest = sum(leg.shortest_time_s for leg in given.best.legs)
    assert f"<td>All legs<td>2\u202f300<td>{shortest:.1f}<td>" in table
    for sharing in ("optimum", "given"):
        legs = given.runs[sharing].legs
        supplement = words.number(sum(leg.supplement_s for leg in legs))
        assert f"<td>{supplement}<td>{words.energy(sum(leg.energy_j for leg in legs) / 3.6e6)}" in table
    # the optimum has one price, the given timetable one for each leg
    (best,) = {words.price(leg.price_of_time_w) for leg in given.best.legs}
    for leg in given.runs["given"].legs:
        assert f"<td>{best}<td>{words.price(leg.price_of_time_w)}" in table
    # a rule has none
    assert legs_table(given, "equal").count("Wh/s") == 1


def test_only_the_chosen_other_is_drawn(runs: LineRuns) -> None:
    palette = Palette(False)
    chart = SPEED.made(Axis(palette), palette)
    chart.show(lambda: chart.draw(runs, "equal", 900.0))
    assert len(sent(chart, "equal")[0]) > 100
    assert len(sent(chart, "proportional")[0]) == 0
    chart.draw(runs, "proportional", 900.0)
    assert len(sent(chart, "equal")[0]) == 0


def test_texts_name_the_stations_and_escape_them(runs: LineRuns) -> None:
    table = legs_table(runs, "equal")
    assert "A \u2013 &lt;b&gt;B&lt;/b&gt;" in table
    assert "<b>B" not in table
    assert "same on every leg" in "".join(figure_cells(runs))


def test_names_that_would_touch_are_left_out() -> None:
    stops = [(0.0, "First"), (10.0, "Second"), (500.0, "Third"), (1000.0, "Fourth")]
    assert [name for _, name, _ in fitting(stops, 1.0)] == ["First", "Fourth", "Third"]
