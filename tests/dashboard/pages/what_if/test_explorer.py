"""Explore the draws: opened by hand, dropped when closed or when the draws are renewed; nothing of it stays."""

import gc
import subprocess
import sys
from typing import Any

import holoviews as hv
import pytest
from builders import plain_scenario

from railjoule.core.studies.montecarlo import monte_carlo
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.look.tokens import DARK
from railjoule.dashboard.pages.what_if.explorer import CLOSE, OPEN, Explorer
from railjoule.dashboard.state.workbench import Workbench


def drawn(seed: int) -> StudyTable:
    return monte_carlo(plain_scenario().replace(**{"montecarlo.runs": 60, "montecarlo.seed": seed}))


@pytest.fixture(scope="module")
def tables() -> tuple[StudyTable, StudyTable]:
    return drawn(1), drawn(2)


def explorer_of(table: StudyTable | None) -> Explorer:
    state = Workbench()
    state.pages["What if"].chance = table
    made = Explorer(state.pages["What if"], lambda: None)
    made.follow()
    return made


def press(explorer: Explorer) -> None:
    explorer.button.clicks += 1


def test_nothing_is_there_before_it_is_opened_and_after_it_is_closed(tables: tuple[Any, Any]) -> None:
    explorer = explorer_of(tables[0])
    assert (explorer.charts, list(explorer.place), explorer.button.label) == ((), [], OPEN)
    press(explorer)
    assert explorer.button.label == CLOSE
    assert explorer.charts[0].name == "draws"
    assert len(explorer.charts) > 4
    assert all(chart.is_drawn for chart in explorer.charts)
    press(explorer)
    assert (explorer.charts, list(explorer.place), explorer.button.label) == ((), [], OPEN)


def test_draws_that_are_renewed_are_drawn_once_all_are_there(tables: tuple[Any, Any]) -> None:
    explorer = explorer_of(tables[0])
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
    explorer = explorer_of(None)
    press(explorer)
    assert list(explorer.place) == [explorer.waiting]


def test_axes_that_would_be_one_change_places(tables: tuple[Any, Any]) -> None:
    explorer = explorer_of(tables[0])
    press(explorer)
    explorer.x.value = "extra"
    assert (explorer.x.value, explorer.y.value) == ("extra", "load")
    f = explorer.charts[0].figure
    assert (f.xaxis[0].axis_label, f.yaxis[0].axis_label) == ("Extra energy, %", "Load, %")


def test_its_figures_follow_the_theme(tables: tuple[Any, Any]) -> None:
    explorer = explorer_of(tables[0])
    press(explorer)
    explorer.state.dark = True
    explorer.follow()
    for chart in explorer.charts:
        assert chart.figure.renderers[1].glyph.fill_color == DARK["driven"]


def registries() -> dict[str, int]:
    """Return how much HoloViews keeps for the whole process."""
    gc.collect()
    kept = hv.core.options.Store
    alive = gc.get_objects()
    return {
        "options": len(kept._custom_options["bokeh"]),
        "references": len(kept._weakrefs),
        "streams": len(hv.streams.Stream.registry),
        # by its type: a proxy of what has gone, left by another test, cannot be asked what it is
        "plots": sum(issubclass(type(one), hv.plotting.Plot) for one in alive),
        "explorers": sum(type(one) is Explorer for one in alive),
    }


def test_pages_that_come_and_go_leave_nothing_in_the_registries(tables: tuple[Any, Any]) -> None:
    before = registries()
    for _ in range(4):
        explorer = explorer_of(tables[0])
        press(explorer)
        explorer.x.value = "resistance"
        press(explorer)
        press(explorer)
        # the last one is left open, as a page is that its reader just leaves
        del explorer
    assert registries() == before


LATE = """
import sys
from railjoule.dashboard.app import VIEWS, Session
session = Session()
for page in VIEWS:
    if page != "Papers":
        session.state.page = page
        session.views[VIEWS[page].__name__]
assert "holoviews" not in sys.modules, "loaded too early"
"""


@pytest.mark.nightly
def test_no_page_loads_holoviews_before_it_is_asked_for() -> None:
    found = subprocess.run([sys.executable, "-c", LATE], capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr[-2000:]
