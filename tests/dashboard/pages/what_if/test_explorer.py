"""Explore the draws: opened by hand, dropped when closed or when the draws are renewed; nothing of it stays."""

from typing import Any

import numpy as np
import pytest
from builders import plain_scenario

from railjoule.core.studies.montecarlo import monte_carlo
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.look.tokens import DARK, LIGHT
from railjoule.dashboard.pages.what_if.explorer import BINS, CLOSE, OPEN, Explorer, varied
from railjoule.dashboard.state.workbench import Workbench


def drawn(seed: int) -> StudyTable:
    return monte_carlo(plain_scenario().replace(**{"montecarlo.runs": 60, "montecarlo.seed": seed}))


@pytest.fixture(scope="module")
def tables() -> tuple[StudyTable, StudyTable]:
    return drawn(1), drawn(2)


def open_explorer(table: StudyTable | None) -> Explorer:
    state = Workbench()
    state.pages["What if"].chance = table
    made = Explorer(state.pages["What if"], lambda: None)
    made.follow()
    return made


def press(explorer: Explorer) -> None:
    explorer.button.clicks += 1


def test_nothing_is_there_before_it_is_opened_and_after_it_is_closed(tables: tuple[Any, Any]) -> None:
    explorer = open_explorer(tables[0])
    assert (explorer.charts, list(explorer.place), explorer.button.label) == ((), [], OPEN)
    press(explorer)
    assert explorer.button.label == CLOSE
    assert explorer.charts[0].name == "draws"
    assert len(explorer.charts) > 4
    assert all(chart.is_drawn for chart in explorer.charts)
    press(explorer)
    assert (explorer.charts, list(explorer.place), explorer.button.label) == ((), [], OPEN)


def test_draws_that_are_renewed_are_drawn_once_all_are_there(tables: tuple[Any, Any]) -> None:
    explorer = open_explorer(tables[0])
    press(explorer)
    explorer.y.value = "late" if "late" in explorer.y.options.values() else "energy"
    chosen = explorer.y.value
    first = explorer.charts[0].figure
    explorer.model.param.update(drawing=True, chance=tables[1])
    explorer.follow()
    assert explorer.charts == ()
    assert list(explorer.place) == [explorer.waiting]
    explorer.model.drawing = False
    explorer.follow()
    assert explorer.charts[0].figure not in {None, first}
    # the axes stay as they were chosen
    assert (explorer.x.value, explorer.y.value) == ("load", chosen)


def test_without_draws_it_says_so() -> None:
    explorer = open_explorer(None)
    press(explorer)
    assert list(explorer.place) == [explorer.waiting]


def test_axes_that_would_be_one_change_places(tables: tuple[Any, Any]) -> None:
    explorer = open_explorer(tables[0])
    press(explorer)
    explorer.x.value = "extra"
    assert (explorer.x.value, explorer.y.value) == ("extra", "load")
    points = explorer.charts[0]
    assert points.figure.xaxis[0].axis_label == "Extra energy, %"
    assert points.caption == "Load, %, over extra energy"


def test_its_figures_follow_the_theme(tables: tuple[Any, Any]) -> None:
    explorer = open_explorer(tables[0])
    press(explorer)
    explorer.state.dark = True
    explorer.follow()
    for chart in explorer.charts:
        assert chart.figure.renderers[1].glyph.fill_color == DARK["driven"]


def test_points_and_a_histogram_of_each_other_column(tables: tuple[Any, Any]) -> None:
    explorer = open_explorer(tables[0])
    press(explorer)
    columns = varied(tables[0])
    charts = {chart.name: chart for chart in explorer.charts}
    assert charts.keys() == {"draws", *(f"draws_{name}" for name in columns.keys() - {"load", "extra"})}
    for chart in charts.values():
        every, brushed = chart.figure.renderers[:2]
        assert (every.glyph.fill_color, brushed.glyph.fill_color) == (LIGHT["line2"], LIGHT["driven"])
        assert brushed.data_source is chart.sources["brushed"]
    points = charts["draws"]
    assert points.columns == ("load", "extra")
    assert points.caption == "Extra energy, %, over load"
    np.testing.assert_allclose(points.sources["brushed"].data["load"], columns["load"])
    counts = np.array(charts["draws_energy"].sources["brushed"].data["top"])
    # of the values this part is drawn: all but 0.3 % at both ends
    assert len(counts) == BINS
    assert len(columns["energy"]) - 2 <= counts.sum() <= len(columns["energy"])


def test_brushes_of_histograms_outlast_another_axis(tables: tuple[Any, Any]) -> None:
    explorer = open_explorer(tables[0])
    press(explorer)
    low, high = np.quantile(varied(tables[0])["resistance"], (0.2, 0.6)).tolist()
    explorer._brushing.set({"draws_resistance": {"resistance": (low, high)}})
    assert not explorer.reset.disabled
    assert "running resistance" in explorer.words.object
    explorer.y.value = "energy"
    assert explorer._brushing.brushes == {"draws_resistance": {"resistance": (low, high)}}
    explorer.reset.clicks += 1
    assert explorer.reset.disabled
    assert explorer._brushing.brushes == {}
