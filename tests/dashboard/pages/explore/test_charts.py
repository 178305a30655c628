"""The figures of a table of runs: what they draw, and the selection that is dragged over them."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from railjoule.core.studies.sweep import SweepTable
from railjoule.dashboard.charts.dress import check_complete
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import DARK, LIGHT
from railjoule.dashboard.pages.explore import compute
from railjoule.dashboard.pages.explore.charts import (
    ALONG_X,
    ALONG_Y,
    MAP,
    PLOTS,
    RUNS,
    SCALES,
    HistogramChart,
    coloured,
    short_numbers,
    spread_signs,
)
from railjoule.dashboard.pages.explore.compute import ENERGY, Look, LookRequest, Raster, compute_look
from railjoule.dashboard.pages.explore.fields import study_columns, study_table
from railjoule.dashboard.work.run_table import digits_for

X, LOAD, RECUPERATION = "timetable.travel_time_s", "vehicle.load_factor", "drive.recuperation_factor"


def look_at(table: SweepTable, **choice: tuple[float, float]) -> Look:
    asked = LookRequest(X, ENERGY, LOAD, LOAD, RECUPERATION, choice, 10)
    return compute_look(study_table(table), asked)


def drawn(look: Look, dark: bool = False) -> dict[str, Any]:
    charts = {plot.name: plot.made(None, Palette(dark)) for plot in PLOTS}  # type: ignore[arg-type]
    for chart in charts.values():
        chart.build()
        chart.draw(look)
        check_complete(chart.figure)
    return charts


def test_all_figures_show_the_runs(table: SweepTable) -> None:
    charts = drawn(look_at(table))
    points = charts[RUNS].sources["points"].data
    assert np.allclose(points["x"], table.samples[X])
    assert np.allclose(points["y"], table.columns[ENERGY])
    assert points["row"].tolist() == table.index.tolist()
    assert len(charts[RUNS].sources["others"].data["x"]) == 0
    assert charts[RUNS].figure.xaxis[0].axis_label == "Travel time, s"
    assert charts[RUNS].figure.html_attributes["aria-label"] == "Runs over two axes"
    assert sum(charts[ALONG_X].sources["all"].data["top"]) <= 200
    assert sum(charts[ALONG_X].sources["selected"].data["top"]) == 0
    assert charts[ALONG_Y].sources["signs"].data["text"][1].startswith("median ")
    assert len(charts[MAP].sources["signs"].data["text"]) == 25


def test_a_selection_is_drawn_in_all_figures(table: SweepTable) -> None:
    low, high = np.quantile(table.columns[ENERGY], (0.2, 0.6)).tolist()
    look = look_at(table, **{ENERGY: (low, high)})
    charts = drawn(look)
    assert len(charts[RUNS].sources["points"].data["x"]) == look.chosen
    assert len(charts[RUNS].sources["others"].data["x"]) == 200 - look.chosen
    box = charts[RUNS].box
    assert (box.bottom, box.top, box.visible) == (low, high, True)
    # at the edges of the frame
    assert not {type(box.left), type(box.right)} & {int, float}
    assert not charts[ALONG_X].box.visible
    selected, every = (charts[ALONG_X].sources[name].data["top"] for name in ("selected", "all"))
    assert 0 < selected.sum() == look.chosen
    assert np.all(selected <= every)


def test_a_rectangle_selects_runs_by_the_columns_of_its_figure(table: SweepTable) -> None:
    charts = drawn(look_at(table))
    found: list[Any] = []
    for name in (RUNS, ALONG_X, ALONG_Y):
        charts[name].select = found.append
        charts[name]._take(SimpleNamespace(geometry={"type": "rect", "x0": 5.0, "x1": 2.0, "y0": 3.0, "y1": 4.0}))
    assert found == [{X: (2.0, 5.0), ENERGY: (3.0, 4.0)}, {X: (2.0, 5.0)}, {ENERGY: (3.0, 4.0)}]


def test_a_press_picks_the_next_run(table: SweepTable) -> None:
    chart = drawn(look_at(table))[RUNS]
    picked: list[int] = []
    chart.pick = picked.append
    chart._pick(SimpleNamespace(x=table.samples[X][17] + 1e-6, y=table.columns[ENERGY][17]))
    assert picked == [17]


def test_a_raster_shows_where_the_runs_are(table: SweepTable, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compute, "MAX_POINTS", 100)
    monkeypatch.setattr(compute, "RASTER_PX", (40, 30))
    look = look_at(table)
    chart = drawn(look, dark=True)[RUNS]
    assert chart.sources["seen"].data["image"][0].shape == (30, 40)
    assert chart.sources["known"].data["count"][0].sum() == look.raster.count.sum() > 190
    assert "@{count}" in str(chart.tips[1].tooltips) or "@count" in str(chart.tips[1].tooltips)
    assert len(chart.sources["points"].data["x"]) == 0


def test_pixels_are_coloured_by_the_mean_and_seen_where_a_run_is() -> None:
    raster = Raster(np.array([[0.0, np.nan], [1.0, np.nan]]), np.array([[1, 0], [100, 0]]), np.array([[0, 0], [0, 3]]))
    pixels = coloured(raster, (0.0, 1.0), SCALES[False], "#010203").view(np.uint8).reshape(2, 2, 4)
    assert pixels[0, 0, :3].tolist() == SCALES[False][0].tolist()
    assert pixels[1, 0, :3].tolist() == SCALES[False][-1].tolist()
    assert pixels[0, 1, 3] == 0
    assert pixels[1, 1].tolist() == [1, 2, 3, 255]
    assert 100 < pixels[0, 0, 3] < pixels[1, 0, 3] == 255


def test_a_histogram_has_the_colours_of_the_theme(table: SweepTable) -> None:
    chart = HistogramChart("explore_load", "Load factor", "", 100, Palette(dark=True))
    chart.build()
    chart.draw(look_at(table), LOAD)
    assert chart.figure.renderers[0].glyph.fill_color == DARK["line2"]
    chart.palette.switch(False)
    assert chart.figure.renderers[0].glyph.fill_color == LIGHT["line2"]


def test_signs_do_not_lie_over_each_other() -> None:
    assert spread_signs([1.0, 1.001, 9.0], (0.0, 10.0), 0.05) == [1.0, 1.5, 9.0]


def test_numbers_at_the_map_have_no_more_decimals_than_they_need() -> None:
    assert short_numbers(np.array([0.1, 0.3, 0.5])) == ["0.1", "0.3", "0.5"]
    assert short_numbers(np.array([180.0, 190.0])) == ["180", "190"]


def test_inputs_come_first_with_units_and_results_as_the_other_pages_call_them(table: SweepTable) -> None:
    columns = study_columns(table.study)
    assert [column.words for column in columns.values()][:4] == [
        "Travel time, s",
        "Load factor, \u2013",
        "Recuperation factor, \u2013",
        "Energy, kWh",
    ]
    assert columns[X].with_unit(151.25) == "151.2 s"
    assert columns[LOAD].with_unit(0.5) == "0.500"
    # a joule in each second is 1/3600 Wh
    assert np.allclose(study_table(table).values["price_of_time_w"], table.columns["price_of_time_w"] / 3600)


@pytest.mark.parametrize(("span", "digits"), [(80.0, 1), (1.0, 3), (2000.0, 0), (0.0, 2), (1e-12, 9)])
def test_decimals_tell_parts_of_a_span_apart(span: float, digits: int) -> None:
    assert digits_for(span) == digits
