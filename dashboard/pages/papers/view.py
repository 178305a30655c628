"""Papers: what the four papers print beside what this version computes."""

from collections.abc import Callable
from functools import partial
from io import StringIO
from typing import Any

import panel as pn
import panel_material_ui as pmui
from bokeh.plotting import figure as Figure  # noqa: N812  (parts have figures too)
from panel.viewable import Viewable

from railjoule.core import RailjouleError
from railjoule.core.citation import printed_numbers
from railjoule.core.validation import COMPARISONS
from railjoule.core.validation.papers import citation
from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.charts.figures import FinishedChart
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.pages.page import PageView
from railjoule.dashboard.pages.papers.compute import PaperTables
from railjoule.dashboard.pages.papers.names import AUTHORS
from railjoule.dashboard.pages.papers.printed_figures import PrintedFigures
from railjoule.dashboard.pages.papers.tables import figure_cells, paper_html, tables_csv
from railjoule.dashboard.pages.papers.work import Papers
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.worker import Worker

FILES = {
    "ftorek": "ftorek-2025",
    "liashenko": "liashenko-2025",
    "rawicki": "rawicki-2013",
    "shtompel": "shtompel-2025",
}
"""What holds the printed numbers of each paper."""
PAPER_CSS = ":host { border-top: 1px solid var(--rj-line); padding: 12px 20px 14px; } " + (
    "@media (max-width: 899px) { :host { padding: 10px 14px; } }"
)
TABLE_CSS = """
.tables { max-width: 1180px; }
.scroll { overflow-x: auto; }
.claims td, .claims th { text-align: left; white-space: normal; vertical-align: top; min-width: 90px; }
.claims td:nth-child(2), .claims td:nth-child(5) { min-width: 220px; }
td:nth-child(2), th:nth-child(2) { text-align: left; }
td:nth-child(1), td:nth-child(2) { white-space: normal; min-width: 82px; }
td:nth-child(6), th:nth-child(6) { text-align: left; padding-left: 14px; }
details { margin-top: 8px; border-top: 1px solid var(--rj-line); padding-top: 4px; }
summary { cursor: pointer; min-height: 26px; line-height: 26px; font-weight: 600; }
summary span { font-weight: 400; color: var(--rj-ink3); }
ol { margin: 4px 0 0; padding-left: 22px; font-size: 12px; color: var(--rj-ink2); max-width: 90ch; }
.citation { max-width: 90ch; color: var(--rj-ink2); margin-top: 2px; }
"""
CHART_CSS = ":host { padding: 4px 20px 12px 14px; } @media (max-width: 899px) { :host { padding: 4px 12px 12px; } }"
HEIGHTS = {"differences": (330, 420, 320)}
"""Of the chart [px]: in usual, wide and narrow windows."""
CAPTION = "Ours less printed, in % of the printed number; percentages in percentage points, %"
COMPUTED = "Computed with the code, vehicles, lines and scenarios of this version."
COMPUTED_BEFORE = (
    "Computed before the last change of code, vehicles, lines or scenarios; it is being computed again, step by step."
)
SMALL: dict[str, Any] = {"size": "small", "margin": (6, 8, 4, 0)}


def draw_differences(request: tuple[tuple[PaperTables, ...], bool]) -> tuple[Figure, Palette]:
    """Return the figure of all differences, and its colours; in a thread, as HoloViews takes its time to load."""
    from railjoule.dashboard.pages.papers.differences import difference_figure  # noqa: PLC0415

    return difference_figure(*request)


class PapersView(PageView):
    """The page of validation tables."""

    page = "Papers"
    works = (Papers,)
    heights = HEIGHTS

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        self.model = self.state.papers
        self.progress_words = parts.html_pane()
        self.progress = pmui.LinearProgress(value=0, width=320, height=4, margin=(10, 8))
        self.stop = pmui.Button(
            label="Stop", variant="outlined", on_click=lambda _: self.model.param.trigger("stop"), **SMALL
        )
        self.all = pmui.Button(
            label="Compute all four again",
            variant="outlined",
            on_click=lambda _: self._ask(tuple(COMPARISONS)),
            **SMALL,
        )
        self.sections = {
            name: PaperSection(self.state, name, partial(self._ask, (name,)), partial(self._draw, name))
            for name in COMPARISONS
        }
        heading = parts.html_pane(
            parts.heading(self.page, "Four papers", "and what this version computes beside their numbers", "")
        )
        self.busy = pn.FlexBox(
            self.progress, self.stop, self.progress_words, align_items="center", margin=0, visible=False
        )
        self.differences = FinishedChart("differences", CAPTION, HEIGHTS["differences"][0])
        self._drawn: tuple[Figure, Palette] | None = None
        self._of: tuple[PaperTables, ...] = ()
        # by the threads for single runs of seconds: short requests do not wait for it
        self._drawing: Worker[tuple[tuple[PaperTables, ...], bool], tuple[Figure, Palette]] = Worker(
            draw_differences, self._take_differences, self._fail_differences, is_slow=lambda _: True
        )
        self.origin = parts.html_pane()
        bar = parts.stack(self.origin, self.all, self.busy, styles={"padding": "0 20px 8px"})
        self.shows(self._show, (self.model, ["results", "under_way", "is_current", "asked", "failure"]))
        self.shows(self._show_figures, (self.model, ["figures", "drawing"]))
        self.shows(self._show_differences, (self.model, ["results", "asked"]))
        chart = parts.stack(self.differences.host, css=CHART_CSS)
        sections = (section.view for section in self.sections.values())
        return parts.stack(heading, self.message, self.figures, bar, chart, *sections)

    @property
    def charts(self) -> tuple[Chart, ...]:
        """The chart of all differences."""
        return (self.differences,)

    def _ask(self, names: tuple[str, ...], *_: Any) -> None:
        self.model.compare = list(names)

    def _show(self) -> None:
        model = self.model
        self.tell(model.failure, "")
        busy = bool(model.asked)
        self.busy.visible = busy
        self.all.disabled = busy
        if busy:
            self._tell_progress()
        self.origin.object = parts.note_paragraphs([COMPUTED if model.is_current else COMPUTED_BEFORE])
        if model.results:
            self.figures.object = parts.figures(figure_cells(model.results.values()))
        for name, section in self.sections.items():
            section.show(model.results.get(name), busy)

    def _draw(self, name: str) -> None:
        self.model.draw = name

    def _show_figures(self) -> None:
        for name, section in self.sections.items():
            section.figures.show(self.model.figures.get(name, ()), self.model.drawing)

    def _show_differences(self) -> None:
        """Draw what is compared anew, but not after each table; and follow the theme."""
        papers = tuple(self.model.results.values())
        if self._drawn is not None:
            self._drawn[1].switch(self.state.dark)
        if papers and papers != self._of and not self.model.asked:
            self._of = papers
            self._drawing.ask((papers, self.state.dark))

    def _take_differences(self, drawn: tuple[Figure, Palette]) -> None:
        self._drawn = drawn
        drawn[1].switch(self.state.dark)
        self.differences.show(partial(self.differences.draw, drawn[0]))

    def _fail_differences(self, _: RailjouleError) -> None:
        self.differences.fail()

    def _tell_progress(self) -> None:
        asked = self.model.asked
        now = [self.model.under_way[name] for name in asked if name in self.model.under_way]
        share = sum(paper.done_count / paper.step_count for paper in now) / len(asked)
        self.progress.value = int(100 * share)
        last = next((paper for paper in now if not paper.complete), None)
        text = "" if last is None else f"{AUTHORS[last.name]}: step {last.done_count + 1} of {last.step_count}"
        self.progress_words.object = parts.markup('<p role="status" class="muted small">{}</p>', text)


class PaperSection:
    """One paper: its citation, a button, its claims, tables and figures."""

    def __init__(self, state: Workbench, name: str, ask: Callable[..., None], draw: Callable[[], None]) -> None:
        self.name = name
        self._paper: PaperTables | None = None
        self.button = pmui.Button(label=f"Compute {AUTHORS[name]} again", variant="outlined", on_click=ask, **SMALL)
        self.download = pmui.FileDownload(
            callback=self._csv,
            filename=f"{FILES[name]}.csv",
            label=f"{AUTHORS[name]} as CSV",
            variant="text",
            visible=False,
            **SMALL,
        )
        styles = [parts_css(), TABLE_CSS]
        cited = citation(printed_numbers(FILES[name]))
        title = markup('<h2>{}</h2><p class="citation small">{}</p>', AUTHORS[name], cited)
        self.tables = parts.html_pane(stylesheets=styles)
        tools = pn.FlexBox(self.button, self.download, margin=0)
        self.figures = PrintedFigures(state, name, COMPARISONS[name]().figures, draw)
        self.view = parts.stack(
            parts.html_pane(title, stylesheets=styles), tools, self.tables, self.figures.view, css=PAPER_CSS
        )

    def show(self, paper: PaperTables | None, busy: bool) -> None:
        """Show the tables that are done."""
        self.button.disabled = busy
        if paper is None or paper is self._paper:
            return
        self._paper = paper
        self.download.visible = bool(paper.validation.tables)
        self.tables.object = paper_html(paper)

    def _csv(self) -> StringIO:
        tables = self._paper.validation.tables if self._paper is not None else ()
        return StringIO(tables_csv(tables))
