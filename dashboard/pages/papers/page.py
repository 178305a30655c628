"""Papers: printed numbers, claims and figures of the papers beside those of railjoule."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from io import StringIO
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
from panel.viewable import Viewable

from railjoule.core.scenario import load_scenario
from railjoule.core.scenario.document import format_scenario
from railjoule.core.validation import COMPARISONS, Validation
from railjoule.core.validation.table import FigureData, PaperFigure
from railjoule.dashboard.browser import one_message
from railjoule.dashboard.look.markup import joined, markup
from railjoule.dashboard.look.theme import padded, parts_css
from railjoule.dashboard.page import Page, Request, shows, study
from railjoule.dashboard.pages.papers.charts import DIFFERENCES, draw_panel
from railjoule.dashboard.pages.papers.compute import AUTHORS, shipped_tables
from railjoule.dashboard.pages.papers.tables import (
    finding,
    overview_html,
    paper_html,
    reasons_html,
    refuted_html,
    tables_csv,
)
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.tabs import PageTabs
from railjoule.dashboard.state.kept import result
from railjoule.dashboard.state.recipes import PageRun, Program

VALIDATION = Program(
    {"PAPERS": "railjoule.core.validation"},
    "for paper, compute in PAPERS.items():\n    print(paper, compute())\n",
    "validate",
    of_scenario=False,
)
PAPER_CSS = padded("12px 20px 14px", "10px 14px")
OVERVIEW = "overview"
TABLE_CSS = """
.tables { max-width: 1180px; }
.scroll { overflow-x: auto; }
.claims td, .claims th { text-align: left; white-space: normal; vertical-align: top; min-width: 90px; }
.claims td:nth-child(2), .claims td:nth-child(5), .refuted td:nth-child(3) { min-width: 220px; }
.rows td:nth-child(2), .rows th:nth-child(2) { text-align: left; }
.rows td:nth-child(1), .rows td:nth-child(2) { white-space: normal; min-width: 82px; }
.refuted, .reasons { margin-top: 18px; }
.reasons td:nth-child(3) { min-width: 220px; }
.reasons td:nth-child(2) { min-width: 60px; }
@media (max-width: 599px) {
  .refuted thead { display: none; }
  .refuted tr { display: block; padding: 7px 0; border-top: 1px solid var(--rj-line); }
  .refuted td, .refuted tr + tr td { display: block; padding: 0; border: 0; }
  .refuted td:first-child { color: var(--rj-ink3); }
  .refuted td:last-child { font-weight: 600; }
}
details { margin-top: 8px; border-top: 1px solid var(--rj-line); padding-top: 4px; }
summary { cursor: pointer; min-height: 26px; line-height: 26px; font-weight: 600; }
summary span { font-weight: 400; color: var(--rj-ink3); }
ol { margin: 4px 0 0; padding-left: 22px; font-size: 12px; color: var(--rj-ink2); max-width: 90ch; }
.citation { max-width: 90ch; color: var(--rj-ink2); margin-top: 2px; }
"""
CHART_CSS = padded("4px 20px 12px 14px", "4px 12px 12px")
PANELS_CSS = """
:host { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(420px, 100%), 1fr)); gap: 4px 16px; }
"""
"""As many panels beside each other as are at least 420 px wide."""
COMPUTED = "Computed with the code, vehicles, lines and scenarios of this version."
COMPUTED_BEFORE = "Computed before the last change of code, vehicles, lines or scenarios."
AGAIN = "The command railjoule validate computes all numbers again."
SMALL: dict[str, Any] = {"size": "small", "margin": (6, 8, 4, 0)}


@dataclass(frozen=True, eq=False)
class RebuiltFigures:
    """The data of the figures of a paper that are computed so far, in their order."""

    paper: str
    figures: tuple[FigureData, ...] = ()


def rebuild_figures(name: str) -> Iterator[RebuiltFigures]:
    """Compute the figures of a paper, and yield them with each that is added."""
    done = RebuiltFigures(name)
    for printed in COMPARISONS[name]().figures:
        done = RebuiltFigures(name, (*done.figures, printed.compute()))
        yield done


class Papers(Page):
    """The comparison with the papers; no scenario changes it."""

    page = "Papers"
    kept = ("tab",)
    passing = ("drawn_paper", "drawing")
    follows_scenario = False
    figures = (DIFFERENCES,)

    tab = param.Selector(default=OVERVIEW, objects=[OVERVIEW, *COMPARISONS], doc="The tab in sight.")
    drawn_paper = param.String(default="", doc="The paper whose figures were requested last.")
    drawing = param.Boolean(default=False, doc="Whether its figures are being computed.")
    rebuilt = result(RebuiltFigures, "Its figures so far.")

    def page_run(self) -> PageRun:
        """Return the comparison as a program."""
        return PageRun(VALIDATION, {"strategy": self.desk.chosen_now})

    # ---- what it computes

    @study("drawn_paper", into="rebuilt", busy="drawing")
    def _rebuilt(self) -> Request:
        return (rebuild_figures, self.drawn_paper) if self.drawn_paper else None

    # ---- what it shows

    def layout(self) -> Viewable:
        """Make the parts of the page, and return them laid out."""
        shipped = shipped_tables()
        self.host.heading.object = parts.heading(self.page, "Four papers", "and the numbers of railjoule", "")
        self.sections = {name: PaperSection(self, name, paper) for name, paper in shipped.papers.items()}
        makers = {name: partial(parts.stack, section.view) for name, section in self.sections.items()}
        titles = {OVERVIEW: "Overview", **{name: AUTHORS[name] for name in makers}}
        self.tabs = PageTabs(self, titles, {OVERVIEW: self._layout_overview, **makers})
        return parts.stack(parts.html_pane(finding(shipped.papers.values())), self.tabs.view)

    def _layout_overview(self) -> Viewable:
        shipped = shipped_tables()
        origin = parts.note_paragraphs([COMPUTED if shipped.is_current else COMPUTED_BEFORE, AGAIN])
        pieces = (overview_html(shipped.papers), reasons_html(shipped.papers)), (refuted_html(shipped.papers), origin)
        sheets = [parts_css(), TABLE_CSS, PAPER_CSS]
        first, last = (parts.html_pane(joined(texts), stylesheets=sheets) for texts in pieces)
        return parts.stack(first, parts.stack(self.host.plots["differences"].host, css=CHART_CSS), last)

    @shows("failure")
    def _show(self) -> None:
        self.host.tell(self.failure, "")

    @shows(tab=OVERVIEW)
    def _show_differences(self) -> None:
        if not self.host.plots["differences"].is_drawn:
            self.host.draw([DIFFERENCES], tuple(shipped_tables().papers.values()))

    @shows("rebuilt", "drawing", "drawn_paper")
    def _show_figures(self) -> None:
        for name, section in self.sections.items():
            section.show_figures(self.rebuilt if self.rebuilt and self.rebuilt.paper == name else None)

    def draw(self, paper: str, *_: Any) -> None:
        """Request the figures of a paper."""
        # after a failure the name is the same, which is no change
        self.drawn_paper = paper
        self.param.trigger("drawn_paper")


class PaperSection:
    """One paper: its citation, claims, tables and figures."""

    def __init__(self, page: Papers, name: str, paper: Validation) -> None:
        self.page, self.name = page, name
        comparison = COMPARISONS[name]()
        self._printed, self._drawn = comparison.figures, tuple[FigureData, ...]()
        self.download = pmui.FileDownload(
            callback=lambda: StringIO(tables_csv(paper.tables)),
            filename=f"{name}.csv",
            label=f"{AUTHORS[name]} as CSV",
            variant="text",
            **SMALL,
        )
        title = markup('<h2>{}</h2><p class="citation small">{}</p>', AUTHORS[name], comparison.citation)
        styles = [parts_css(), TABLE_CSS]
        self.tables = parts.html_pane(paper_html(paper), stylesheets=styles)
        self.button = pmui.Button(
            label=f"Draw the figures of {AUTHORS[name]}",
            variant="outlined",
            on_click=partial(page.draw, name),
            visible=bool(comparison.figures),
            **SMALL,
        )
        self.status = parts.html_pane()
        self.figures = parts.stack()
        tools = pn.FlexBox(self.button, self.download, margin=0)
        self.view = parts.stack(
            parts.html_pane(title, stylesheets=styles),
            tools,
            self.status,
            self.figures,
            self.tables,
            css=PAPER_CSS,
        )

    def show_figures(self, rebuilt: RebuiltFigures | None) -> None:
        """Show the figures that are computed; None where none of this paper were computed last."""
        computing = self.page.drawing and self.page.drawn_paper == self.name
        if rebuilt is not None:
            self._drawn = rebuilt.figures
        shown = len(self.figures)
        if shown < len(self._drawn):
            pairs = list(zip(self._printed, self._drawn, strict=False))[shown:]
            with one_message():
                self.figures.extend([self._figure(printed, one) for printed, one in pairs])
        self.button.disabled = self.page.drawing
        self.button.visible = len(self._drawn) < len(self._printed)
        left = f"{len(self._printed) - len(self._drawn)} more to compute."
        self.status.object = parts.note_paragraphs([left] if computing else [])

    def _figure(self, printed: PaperFigure, rebuilt: FigureData) -> Viewable:
        """Return a printed figure that is computed, and the way to its scenario."""
        template = '<h3 style="font-weight:600">{}</h3><p class="muted small">{}</p>'
        heading = parts.html_pane(markup(template, printed.place, printed.caption))
        drawn = [draw_panel(panel, printed.place, self.page.host.palette) for panel in rebuilt.panels]
        panels = [pn.pane.Bokeh(panel, margin=0, sizing_mode="stretch_width") for panel in drawn]
        note = parts.html_pane(parts.note_paragraphs([rebuilt.note] if rebuilt.note else []))
        button = pmui.Button(
            label=f"Open {printed.place} in the workbench",
            variant="text",
            size="small",
            margin=(0, 0, 4, -6),
            on_click=partial(self._open, printed),
        )
        return parts.stack(heading, parts.stack(*panels, css=PANELS_CSS), note, button)

    def _open(self, printed: PaperFigure, *_: object) -> None:
        scenario = load_scenario(printed.scenario).replace(**printed.changes)
        title = f"{scenario.title}, {printed.place}" if printed.changes else scenario.title
        self.page.desk.scenario.open(format_scenario(scenario.model_copy(update={"title": title})), title)
        self.page.desk.page = "Drive"
