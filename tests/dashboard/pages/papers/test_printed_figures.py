"""Rebuilt figures: what is computed is drawn, printed points in the colour of their line, and opened."""

import numpy as np
import pytest

from railjoule.core.validation import COMPARISONS, Comparison
from railjoule.core.validation.table import FigureData, Line, Panel, PaperFigure
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import THEMES
from railjoule.dashboard.pages.papers.panels import draw_panel
from railjoule.dashboard.pages.papers.printed_figures import PrintedFigures
from railjoule.dashboard.pages.papers.work import Papers
from railjoule.dashboard.state.workbench import Workbench

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


@pytest.mark.parametrize("dark", [False, True])
def test_printed_points_have_the_colour_of_their_line(dark: bool) -> None:
    palette = Palette(dark)
    first, second, points = draw_panel(PANEL, "Fig. 4", palette).renderers
    tokens = THEMES["dark" if dark else "light"]
    assert first.glyph.line_color == tokens["accent"]
    assert second.glyph.line_color == points.glyph.line_color != first.glyph.line_color
    assert list(points.data_source.data["y"]) == [75.0]
    palette.switch(not dark)
    assert first.glyph.line_color == THEMES["light" if dark else "dark"]["accent"]


def test_a_figure_is_computed_drawn_and_opened(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(COMPARISONS, "ftorek", lambda: Comparison("ftorek", "F", (), (), (), (FIGURE,)))
    state = Workbench()
    work = Papers(state)
    shown = PrintedFigures(state, "ftorek", (FIGURE,), lambda: state.papers.param.update(draw="ftorek"))
    assert state.papers.figures == {}
    shown.button.clicks += 1
    assert state.papers.drawing == ""
    shown.show(state.papers.figures["ftorek"], state.papers.drawing)
    assert len(shown.bodies[0]) == 2
    assert "All agree." in shown.notes[0].object
    shown.buttons[0].clicks += 1
    assert state.page == "Drive"
    assert state.scenario.base.travel_time_s == 330.0
    assert state.scenario.base.title.endswith("Fig. 4")
    work.end()
