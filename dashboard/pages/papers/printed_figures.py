"""Printed figures of a paper, one under the other: their printed numbers as points, those of railjoule as lines."""

from collections.abc import Callable, Sequence
from functools import partial

import panel as pn
import panel_material_ui as pmui
from bokeh.plotting import figure as Figure  # noqa: N812  (a paper's figure is another thing)
from panel.viewable import Viewable

from railjoule.core import RailjouleError
from railjoule.core.scenario import load_scenario
from railjoule.core.scenario.document import format_scenario
from railjoule.core.validation.table import FigureData, PaperFigure
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.papers.names import AUTHORS
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.worker import Worker

Request = tuple[tuple[tuple[int, PaperFigure, FigureData], ...], bool]
"""Figures to draw, each with its number, and whether in dark colours."""
Drawn = dict[int, tuple[list[Figure], Palette]]

BODY_CSS = """
:host { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(420px, 100%), 1fr)); gap: 4px 16px; }
"""
"""As many panels beside each other as are at least 420 px wide."""
NOT_DRAWN = "The figures could not be drawn: a program error, which the server\u2019s log describes."


def draw_figures(request: Request) -> Drawn:
    """Return the panels of figures, and their colours; in a thread, as HoloViews takes its time to load."""
    from railjoule.dashboard.pages.papers.panels import draw_panel  # noqa: PLC0415

    figures, dark = request
    drawn: Drawn = {}
    for number, printed, data in figures:
        palette = Palette(dark)
        drawn[number] = [draw_panel(panel, printed.place, palette) for panel in data.panels], palette
    return drawn


class PrintedFigures:
    """The figures of one paper: a button that computes them, and a place for each.

    Parameters
    ----------
    state : Workbench
    name : str
        The paper's, as on the command line.
    figures : sequence of PaperFigure
    ask : callable
        Called when the figures are to be computed.
    """

    def __init__(self, state: Workbench, name: str, figures: Sequence[PaperFigure], ask: Callable[[], None]) -> None:
        self._state, self._name, self._figures = state, name, tuple(figures)
        self._drawn: Drawn = {}
        self._asked: set[int] = set()
        self._worker: Worker[Request, Drawn] = Worker(draw_figures, self._take, self._fail, is_slow=lambda _: True)
        self.button = pmui.Button(
            label=f"Draw the figures of {AUTHORS[name]}",
            variant="outlined",
            size="small",
            margin=(6, 8, 4, 0),
            on_click=lambda _: ask(),
        )
        self.status = parts.html_pane(visible=False)
        self.bodies = [parts.stack(visible=False, css=BODY_CSS) for _ in self._figures]
        self.notes = [parts.html_pane(visible=False) for _ in self._figures]
        self.buttons = [self._opener(printed) for printed in self._figures]
        places = (self._place(number) for number in range(len(self._figures)))
        self.view = parts.stack(self.button, self.status, *places)
        self.view.visible = bool(self._figures)

    def show(self, done: tuple[FigureData, ...], computing: str) -> None:
        """Draw the figures that are computed; `computing` is the paper whose figures are under way."""
        self.button.disabled = bool(computing)
        self.status.visible = computing == self._name
        self.status.object = parts.note_paragraphs([f"{len(self._figures) - len(done)} more to compute."])
        for _, palette in self._drawn.values():
            palette.switch(self._state.dark)
        for note, data in zip(self.notes, done, strict=False):
            note.object, note.visible = parts.note_paragraphs([data.note]), bool(data.note)
        due = tuple((k, self._figures[k], data) for k, data in enumerate(done) if k not in self._drawn)
        if due and {k for k, *_ in due} != self._asked:
            self._asked = {k for k, *_ in due}
            self._worker.ask((due, self._state.dark))

    def _opener(self, printed: PaperFigure) -> pmui.Button:
        return pmui.Button(
            label=f"Open {printed.place} in the workbench",
            variant="text",
            size="small",
            margin=(0, 0, 4, -6),
            on_click=partial(self._open, printed),
        )

    def _place(self, number: int) -> Viewable:
        printed = self._figures[number]
        template = '<h3 style="font-weight:600">{}</h3><p class="muted small">{}</p>'
        heading = parts.html_pane(markup(template, printed.place, printed.caption))
        return parts.stack(heading, self.bodies[number], self.notes[number], self.buttons[number])

    def _open(self, printed: PaperFigure, _: object) -> None:
        scenario = load_scenario(printed.scenario).replace(**printed.changes)
        title = f"{scenario.title}, {printed.place}" if printed.changes else scenario.title
        self._state.scenario.open(format_scenario(scenario.model_copy(update={"title": title})), title)
        self._state.page = "Drive"

    def _take(self, drawn: Drawn) -> None:
        with pn.io.hold():
            for number, (panels, palette) in drawn.items():
                palette.switch(self._state.dark)
                self.bodies[number][:] = [
                    pn.pane.Bokeh(panel, margin=0, sizing_mode="stretch_width") for panel in panels
                ]
                self.bodies[number].visible = True
        self._drawn |= drawn
        self._asked = set()

    def _fail(self, _: RailjouleError) -> None:
        self.status.object = parts.note_paragraphs([NOT_DRAWN])
        self.status.visible = True
