from dataclasses import replace

import numpy as np
import pytest
from bokeh.models import HoverTool

from railjoule.core.studies.sweep import SweepTable
from railjoule.dashboard.charts.chart import check_complete
from railjoule.dashboard.look.tokens import DARK, LIGHT
from railjoule.dashboard.pages.study import compute
from railjoule.dashboard.pages.study.charts import SCALES, apart, coloured, draw, fill, short_numbers
from railjoule.dashboard.pages.study.columns import columns_of, digits_for
from railjoule.dashboard.pages.study.compute import ENERGY, LookRequest, Raster, compute_look
from railjoule.dashboard.pages.study.places import ALONG_X, ALONG_Y, FIGURES, MAP, RUNS, shape_of

X, LOAD, RECUPERATION = "timetable.travel_time_s", "vehicle.load_factor", "drive.recuperation_factor"


def asked(table: SweepTable) -> LookRequest:
    return LookRequest(table, X, ENERGY, LOAD, LOAD, RECUPERATION, {}, 10, (40, 30))


def test_all_figures_show_the_runs(table: SweepTable) -> None:
    look = compute_look(asked(table))
    drawn = draw(table.study, look, dark=False)
    assert set(drawn.figures) == set(FIGURES)
    assert drawn.shape == shape_of(look)
    for made in drawn.figures.values():
        check_complete(made.figure)
    points = drawn.figures[RUNS].sources["points"].data
    assert np.allclose(points["x"], table.samples[X])
    assert np.allclose(points["y"], table.columns[ENERGY])
    assert points["row"].tolist() == table.index.tolist()
    assert any(isinstance(tool, HoverTool) for tool in drawn.figures[RUNS].figure.tools)
    assert drawn.figures[RUNS].figure.xaxis[0].axis_label == "Travel time, s"
    assert sum(drawn.figures[ALONG_X].sources["bars"].data["top"]) <= 200
    assert drawn.figures[ALONG_Y].sources["signs"].data["t"][1].startswith("median ")
    assert len(drawn.figures[MAP].sources["signs"].data["text"]) == 25


def test_more_runs_are_put_into_the_figures_that_are_there(table: SweepTable) -> None:
    few = replace(
        table,
        index=table.index[:80],
        samples={name: values[:80] for name, values in table.samples.items()},
        columns={name: values[:80] for name, values in table.columns.items()},
    )
    first, then = compute_look(asked(few)), compute_look(asked(table))
    assert shape_of(first) == shape_of(then)
    drawn, columns = draw(table.study, first, dark=False), columns_of(table.study)
    for name, made in drawn.figures.items():
        fill(made, name, then, columns)
    assert len(drawn.figures[RUNS].sources["points"].data["x"]) == 200
    ends = drawn.figures[RUNS].figure.y_range
    assert (ends.start, ends.end) == then.ends[1]
    beside = drawn.figures[ALONG_Y].figure.y_range
    assert (beside.start, beside.end) == then.ends[1]


def test_a_raster_has_other_figures_and_tells_its_pixels(table: SweepTable, monkeypatch: pytest.MonkeyPatch) -> None:
    points = compute_look(asked(table))
    monkeypatch.setattr(compute, "MAX_POINTS", 100)
    look = compute_look(asked(table))
    assert shape_of(look) != shape_of(points)
    made = draw(table.study, look, dark=True).figures[RUNS]
    assert made.sources["seen"].data["image"][0].shape == (30, 40)
    known = made.sources["known"].data
    assert isinstance(look.runs, Raster)
    assert known["count"][0].sum() == look.runs.count.sum() > 190
    hover = next(tool for tool in made.figure.tools if isinstance(tool, HoverTool))
    assert "@{count}" in str(hover.tooltips)


def test_pixels_are_coloured_by_the_mean_and_seen_where_a_run_is() -> None:
    raster = Raster(np.array([[0.0, np.nan], [1.0, 1.0]]), np.array([[1, 0], [1, 100]]))
    pixels = coloured(raster, (0.0, 1.0), SCALES[False]).view(np.uint8).reshape(2, 2, 4)
    assert pixels[0, 0, :3].tolist() == SCALES[False][0].tolist()
    assert pixels[1, 1, :3].tolist() == SCALES[False][-1].tolist()
    assert pixels[0, 1, 3] == 0
    assert 100 < pixels[0, 0, 3] < pixels[1, 1, 3] == 255


def test_figures_wear_the_colours_of_the_theme(table: SweepTable) -> None:
    look = compute_look(asked(table))
    made = draw(table.study, look, dark=True).figures[ALONG_X]
    assert made.figure.renderers[0].glyph.fill_color == DARK["line2"]
    made.palette.switch(False)
    assert made.figure.renderers[0].glyph.fill_color == LIGHT["line2"]


def test_signs_do_not_lie_over_each_other() -> None:
    moved = apart([1.0, 1.001, 9.0], (0.0, 10.0), 0.05)
    assert moved == [1.0, 1.5, 9.0]


def test_numbers_at_the_map_have_no_more_decimals_than_they_need() -> None:
    assert short_numbers(np.array([0.1, 0.3, 0.5])) == ["0.1", "0.3", "0.5"]
    assert short_numbers(np.array([180.0, 190.0])) == ["180", "190"]


def test_fields_come_first_with_units_and_results_as_the_other_pages_call_them(table: SweepTable) -> None:
    columns = columns_of(table.study)
    assert [column.words for column in columns.values()][:4] == [
        "Travel time, s",
        "Load factor, \u2013",
        "Recuperation factor, \u2013",
        "Energy, kWh",
    ]
    assert columns["timetable.travel_time_s"].told(151.25) == "151.2 s"
    assert columns["vehicle.load_factor"].told(0.5) == "0.500"
    # a joule in each second is 1/3600 Wh
    assert columns["price_of_time_w"].scale == pytest.approx(1 / 3600)


@pytest.mark.parametrize(("span", "digits"), [(80.0, 1), (1.0, 3), (2000.0, 0), (0.0, 2), (1e-12, 9)])
def test_decimals_tell_parts_of_a_span_apart(span: float, digits: int) -> None:
    assert digits_for(span) == digits
