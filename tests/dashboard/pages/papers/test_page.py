"""The page Papers: what it shows of the shipped comparison, and the figures that it rebuilds."""

from collections.abc import Iterator

import numpy as np
import panel as pn
import pytest

from railjoule.core import SolverError
from railjoule.core.validation import COMPARISONS, Comparison, Row, Table, Validation
from railjoule.core.validation.table import FigureData, Line, Panel, PaperFigure
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import THEMES
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.pages.papers.charts import draw_panel
from railjoule.dashboard.pages.papers.compute import ShippedTables
from railjoule.dashboard.pages.papers.page import COMPUTED, COMPUTED_BEFORE, Papers
from railjoule.dashboard.workbench import Workbench

# Panel warns once of how panel-material-ui calls it
pytestmark = pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")
TABLE = Table("One table", (Row("case", "W", "Wh", 2.0, 2.1, "Because.", "case"),), "Table 1")
SHIPPED = {"ftorek": Validation("ftorek", "", (TABLE,), ())}
TIME_S = np.linspace(0.0, 300.0, 7)
PANEL = Panel(
    "Time, s",
    "Speed, km/h",
    (
        Line("300 s", TIME_S, TIME_S),
        Line("330 s", TIME_S, TIME_S / 2),
        Line("330 s", TIME_S[:1], np.array([75.0]), is_printed=True),
    ),
)
CHANGES = {"timetable.travel_time_s": 330.0}
FIGURE = PaperFigure("Fig. 4", "Speed.", lambda: FigureData((PANEL, PANEL), "All agree."), "ftorek-300s", CHANGES)


@pytest.fixture
def papers(monkeypatch: pytest.MonkeyPatch) -> Iterator[Papers]:
    """The page in sight, with a paper of one table and a figure that costs nothing."""
    for name in list(COMPARISONS):
        monkeypatch.delitem(COMPARISONS, name)
    monkeypatch.setitem(
        COMPARISONS, "ftorek", lambda: Comparison("ftorek", "F", (lambda: TABLE, lambda: TABLE), (), (), (FIGURE,))
    )
    shipped = ShippedTables(SHIPPED, True)
    monkeypatch.setattr("railjoule.dashboard.pages.papers.page.shipped_tables", lambda: shipped)
    state = Workbench()
    works = PageWorks(state.pages["Papers"])
    state.page = "Papers"
    page = state.pages["Papers"]
    PageHost(state.pages["Papers"], Browser(started=True, charts_in_sight=["differences"]), Palette(dark=False))
    yield page
    works.end()


def test_what_is_shipped_is_shown(papers: Papers) -> None:
    texts = " ".join(pane.object for pane in papers.host.view.select(pn.pane.HTML))
    assert COMPUTED in texts
    assert COMPUTED_BEFORE not in texts
    assert "One table" in papers.sections["ftorek"].tables.object
    assert len(papers.host.plots["differences"].figure.renderers) == 1


@pytest.mark.parametrize("dark", [False, True])
def test_printed_points_have_the_colour_of_their_line(dark: bool) -> None:
    palette = Palette(dark)
    first, second, points = draw_panel(PANEL, "Fig. 4", palette).renderers
    assert first.glyph.line_color == THEMES["dark" if dark else "light"]["accent"]
    assert second.glyph.line_color == points.glyph.line_color != first.glyph.line_color
    assert list(points.data_source.data["y"]) == [75.0]
    palette.switch(not dark)
    assert first.glyph.line_color == THEMES["light" if dark else "dark"]["accent"]


def test_a_figure_is_computed_drawn_and_opened(papers: Papers) -> None:
    section = papers.sections["ftorek"]
    assert not len(section.figures)
    section.button.clicks += 1
    assert not papers.drawing
    ((_, panels, note, button),) = section.figures
    assert len(panels) == 2
    assert panels[0].object.renderers[0].glyph.line_color == THEMES["light"]["accent"]
    papers.host.palette.switch(dark=True)
    assert panels[0].object.renderers[0].glyph.line_color == THEMES["dark"]["accent"]
    assert "All agree." in note.object
    assert not section.button.visible
    button.clicks += 1
    desk = papers.desk
    assert desk.page == "Drive"
    assert desk.scenario.base.travel_time_s == 330.0
    assert desk.scenario.base.title.endswith("Fig. 4")


def test_figures_that_failed_are_computed_when_asked_for_again(papers: Papers, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken() -> FigureData:
        raise SolverError("It was not found.")

    bad = PaperFigure("Fig. 4", "Speed.", broken, "ftorek-300s", CHANGES)
    section = papers.sections["ftorek"]
    with monkeypatch.context() as failing:
        failing.setitem(COMPARISONS, "ftorek", lambda: Comparison("ftorek", "F", (), (), (), (bad,)))
        section.button.clicks += 1
    assert "It was not found." in papers.host.message.object
    assert not section.button.disabled
    section.button.clicks += 1
    assert len(section.figures) == 1
    assert papers.failure is None
