"""Explore: which numbers of the scenario decide the energy, over many runs; any of them opens on Drive."""

import math
from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core.parquet import has_parquet
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.theme import explore_css, parts_css
from railjoule.dashboard.page import shows
from railjoule.dashboard.pages.explore import texts
from railjoule.dashboard.pages.explore.charts import (
    ALONG_X,
    ALONG_Y,
    MAP,
    OTHER_HEIGHTS,
    PLOTS,
    RUNS,
    HistogramChart,
    histogram_name,
)
from railjoule.dashboard.pages.explore.compute import Look
from railjoule.dashboard.pages.explore.ranges import Span, typed_ends
from railjoule.dashboard.pages.explore.study import ROWS_AT_ONCE, STARTS, SUFFIX, Studies
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import button
from railjoule.dashboard.work.run_table import Ends

INTRO = "Choose inputs and ranges on the left, then Run. The preview below shows the first {} of {} runs."
PREVIEWED = "This is a preview; all runs give closer numbers."
FORMER = "Shown: results of the previous settings."
SO_FAR = "The figures show the runs done so far."
HINT = "Drag over a figure to select runs, or type the ends of the selection; press a point to choose its run."
HEAD_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) auto; gap: 0 12px; padding: 0 20px; align-items: start; }
@media (max-width: 899px) { :host { padding: 0 14px; grid-template-columns: minmax(0, 1fr); } }
"""
BODY_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1.75fr) minmax(0, 1fr); column-gap: 24px;
  padding: 10px 20px 0 14px; align-items: start; }
@media (max-width: 1099px) { :host { grid-template-columns: minmax(0, 1fr); padding: 8px 12px 0; } }
@media (max-width: 599px) { .study-shares { order: -1; } }
"""
MARGINS_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) 150px; align-items: end; }
@media (max-width: 599px) { :host { grid-template-columns: minmax(0, 1fr); }
  .rj-chart-explore_along_x, .rj-chart-explore_along_y, .study-corner { display: none; } }
"""
OTHERS_CSS = """
:host { display: grid; grid-template-columns: repeat(auto-fill, minmax(230px, 1fr)); gap: 4px 16px;
  padding: 4px 20px 0 14px; align-items: start; }
@media (max-width: 899px) { :host { padding: 4px 12px 0; } }
"""
ENDS_CSS = ":host { display: grid; grid-template-columns: repeat(auto-fit, minmax(180px, 260px)); gap: 0 12px; }"
ROWS_CSS = ":host { padding: 14px 20px 20px; } @media (max-width: 899px) { :host { padding: 12px 14px 20px; } }"
SELECT: dict[str, Any] = {"size": "small", "margin": (6, 8, 2, 0), "sizing_mode": "stretch_width", "min_width": 120}
# the name of a quantity is shown whole
SELECT["sx"] = {"& .MuiSelect-select": {"whiteSpace": "normal !important", "lineHeight": "1.2 !important"}}
AXES = {"y": "Vertical axis", "x": "Horizontal axis", "colour": "Colour", "map_y": "Map rows", "map_x": "Map columns"}


class Explore(Studies):
    """A table of runs: of a study, of its preview, or of another page."""

    page = "Explore"
    figures = PLOTS

    def layout(self) -> Viewable:
        """Make the parts of the page, and return them laid out."""
        plots = self.host.plots
        self.finding, self.status, self.legend, self.indices, self.intro, self.list = (
            parts.html_pane(stylesheets=[parts_css(), explore_css()]) for _ in range(6)
        )
        acts = {"Stop": self.stop, "Resume": self.go_on, "Close the draws": lambda _: self.param.update(draws=None)}
        self.buttons = {label: button(label, act, margin=(0, 0, 0, 6)) for label, act in acts.items()}
        suffixes = {SUFFIX: "Save study", ".csv": "CSV", **({".parquet": "Parquet"} if has_parquet() else {})}
        self.saves = {suffix: self._download(suffix, label) for suffix, label in suffixes.items()}
        head = parts.stack(self.status, pn.Row(*self.saves.values(), *self.buttons.values(), margin=0), css=HEAD_CSS)
        self.selects = {name: pmui.Select(label=label, options={}, **SELECT) for name, label in AXES.items()}
        for name, select in self.selects.items():
            select.param.watch(partial(self._choose_column, name), "value")
        plots[ALONG_X].x_range, plots[ALONG_Y].y_range = plots[RUNS].x_range, plots[RUNS].y_range
        for name in (RUNS, ALONG_X, ALONG_Y):
            plots[name].select = self.select
        plots[RUNS].pick = self._pick
        self._others: dict[str, Any] = {}
        corner = parts.html_pane(css_classes=["study-corner"])
        margins = parts.stack(plots[ALONG_X].host, corner, plots[RUNS].host, plots[ALONG_Y].host, css=MARGINS_CSS)
        left = parts.stack(self._row("y", "x", "colour"), self.legend, margins)
        self.map_part = parts.stack(self._row("map_y", "map_x"), plots[MAP].host)
        # on a narrow screen what decides comes first
        right = parts.stack(self.map_part, self.indices, css_classes=["study-shares"])
        self.others = parts.stack(css=OTHERS_CSS)
        self.body = parts.stack(
            parts.stack(left, right, css=BODY_CSS), self._layout_selection(), self.others, self._layout_rows()
        )
        self.run = button("Run", self.begin, variant="contained", margin=(0, 20, 6, 20))
        return parts.stack(self.finding, self.intro, self.run, head, self.host.figures, self.body)

    def _download(self, suffix: str, label: str) -> pmui.FileDownload:
        made = pmui.FileDownload(
            callback=partial(self._file, suffix),
            filename=f"study{suffix}",
            label=label,
            icon="download",
            size="small",
            margin=(0, 0, 0, 4),
        )
        # as an argument it makes Panel warn
        made.variant = "text"
        return made

    def _row(self, *names: str) -> Viewable:
        made = [self.selects[name] for name in names]
        return pn.Row(*made, margin=0, sizing_mode="stretch_width", stylesheets=[parts.WRAP_CSS])

    def _layout_selection(self) -> Viewable:
        self.spans = {axis: Span(partial(self._take_span, axis)) for axis in ("y", "x")}
        self.clear = button("Clear selection", lambda _: self._choose({}), variant="text", margin=(8, 0, 0, 0))
        self.span_names = {axis: parts.html_pane() for axis in self.spans}
        fields = [
            parts.stack(self.span_names[axis], typed_ends(span, f"Selection, {AXES[axis].lower()}", 2))
            for axis, span in self.spans.items()
        ]
        return parts.stack(
            parts.html_pane(parts.note_paragraphs([HINT])),
            parts.stack(*fields, self.clear, css=ENDS_CSS),
            css=ROWS_CSS.replace("20px;", "0;", 1),
        )

    def _layout_rows(self) -> Viewable:
        self.chosen_run = pmui.Select(label="Run", options={}, size="small", width=260, margin=(0, 8, 0, 0))
        self.open_button = button("Open on Drive", lambda _: self.open_run(self.chosen_run.value))
        self.more = button(
            f"Next {ROWS_AT_ONCE}",
            lambda _: self.param.update(listed=self.listed + ROWS_AT_ONCE),
            variant="text",
            margin=0,
        )
        self.opening = pn.FlexBox(self.chosen_run, self.open_button, gap="8px", margin=(0, 0, 8, 0))
        return parts.stack(self.opening, self.list, self.more, css=ROWS_CSS)

    # ---- what the user asks for

    def _choose(self, choice: dict[str, Ends]) -> None:
        with pn.io.hold():
            self.param.update(choice=choice, listed=ROWS_AT_ONCE)

    def select(self, ends: dict[str, Ends]) -> None:
        """Select the runs between ends of some columns, and within those of the other columns as before."""
        self._choose({**self.choice, **ends})

    def _take_span(self, axis: str, ends: tuple[float | None, float | None]) -> None:
        name = self.axes()[axis]
        typed = (far if end is None else end for far, end in zip((-math.inf, math.inf), ends, strict=True))
        others = {column: bounds for column, bounds in self.choice.items() if column != name}
        self._choose(others if ends == (None, None) else {**others, name: (next(typed), next(typed))})

    def _choose_column(self, name: str, event: Any) -> None:
        if event.new and event.new != self.axes().get(name):
            setattr(self, name, event.new)

    def _pick(self, row: int) -> None:
        """Choose a run that was pressed."""
        label = f"Run {words.number(row, 0)}"
        with pn.io.hold():
            self.chosen_run.param.update(options={label: row, **self.chosen_run.options}, value=row)

    # ---- drawing

    @shows("progress", "asked", "preview", "table", "draws", "note", "may_go_on", *STARTS, "scenario")
    def _show_state(self) -> None:
        progress, there, own = self.progress, self.sweep is not None, self.draws is None
        under_way = progress.is_under_way
        self.buttons["Stop"].param.update(visible=own and under_way, disabled=progress.state == "stopping")
        self.buttons["Resume"].visible = own and progress.state in {"stopped", "failed"} and self.may_go_on
        self.buttons["Close the draws"].visible = not own
        for suffix, save in self.saves.items():
            # a file names the version of the solver, which is another one where the study may not go on
            save.visible = own and self.table is not None and (self.may_go_on or suffix != SUFFIX)
        note = self.note
        if not note and self.asked is not None and self.asked != self.settings:
            note = FORMER
        if not note and under_way and progress.done:
            note = SO_FAR
        self.status.object = texts.status_html(progress, note) if own and there else ""
        self.intro.visible, self.run.visible = own and not there, own
        is_done = self.asked is not None and self.asked == self.settings
        self.run.param.update(label="Run again" if there else "Run", disabled=under_way or is_done)
        preview = None if self.preview is None else self.preview.table
        runs = "" if preview is None else words.number(preview.rows, 0)
        sentence = INTRO.format(runs, words.number(self.runs, 0)) if runs else INTRO.partition(" The")[0]
        self.intro.object = texts.intro_html(sentence, not runs)
        self._show_heading()

    def _show_heading(self) -> None:
        study, title = self.shown_study, self.desk.scenario.edited.title
        varied = ""
        if self.draws is not None:
            varied = self.draws.title
        elif study is not None:
            title, count = study.scenario.title, len(study.fields)
            varied = f"{count} {'input' if count == 1 else 'inputs'} varied together"
        self.host.heading.object = parts.heading(self.page, title, varied, "")

    @shows("look", "shares", "failure", "draws", "desk.dark")
    def _show_look(self) -> None:
        look = self.look
        self.host.tell(self.failure, "Shown: the figures before the change." if look is not None else "")
        if look is None:
            # the figures of before stay until the next ones come
            self.host.figures.visible = self.body.visible = bool(self.legend.object)
            return
        self.host.figures.visible = self.body.visible = True
        shares = self.shares if self.draws is None else None
        # those of another table may still be on their way
        if shares is not None and not set(shares.fields) <= set(look.table.columns):
            shares = None
        note = PREVIEWED if self.table is None else ""
        self.finding.object = texts.finding_html(shares, look.table.columns, note)
        self.host.figures.object = parts.figures(texts.number_figures(look, shares))
        self._offer(look)
        self._show_selection(look)
        if not len(look.table.rows):
            return
        self.legend.object = texts.legend_html(look, self.desk.dark)
        self.indices.object = "" if shares is None else texts.indices_html(shares, look.table.columns)
        self.map_part.visible = look.medians is not None
        self.host.draw(PLOTS, look)
        self._draw_others(look)

    def _offer(self, look: Look) -> None:
        """Offer the columns of the table, and the runs that are listed."""
        table = look.table
        everything = {column.label: name for name, column in table.columns.items()}
        inputs = {word: name for word, name in everything.items() if name in table.inputs}
        for name, select in self.selects.items():
            options, value = inputs if name.startswith("map") else everything, getattr(look.asked, name)
            if select.options != options or select.value != value:
                select.param.update(options=options, value=value)
        self.list.object = texts.rows_html(look)
        listed = {f"Run {words.number(row, 0)}": int(row) for row in table.rows[list(look.listed)]}
        self.opening.visible = self.draws is None and bool(listed)
        if self.chosen_run.options != listed:
            rows, chosen = list(listed.values()), self.chosen_run.value
            self.chosen_run.param.update(options=listed, value=chosen if chosen in rows else next(iter(rows), None))
        self.more.visible = look.chosen > len(look.listed)

    def _show_selection(self, look: Look) -> None:
        choice, columns = look.asked.choice, look.table.columns
        for axis, span in self.spans.items():
            name = getattr(look.asked, axis)
            ends = choice.get(name, (None, None))
            span.set(*(None if end is None or math.isinf(end) else end for end in ends))
            self.span_names[axis].object = parts.markup('<div class="row"><span>{}</span></div>', columns[name].label)
        self.clear.disabled = not choice

    def _draw_others(self, look: Look) -> None:
        """Draw the histograms of the columns that are on neither axis."""
        names = [name for name in look.table.columns if name not in look.axes]
        if list(self._others) != names:
            columns, dark = look.table.columns, self.desk.dark
            self._others = {
                name: self._others.get(name)
                # colours of its own, which go with it
                or HistogramChart(histogram_name(name), columns[name].label, "", OTHER_HEIGHTS[0], Palette(dark))
                for name in names
            }
            self.host.heights = {
                **self.host.heights,
                **{chart.name: OTHER_HEIGHTS for chart in self._others.values()},
            }
            for chart in self._others.values():
                chart.select = self.select
            self.host.take_charts(self._others.values())
            self.others[:] = [chart.host for chart in self._others.values()]
        for name, chart in self._others.items():
            if chart.palette.tokens is not self.host.palette.tokens:
                chart.palette.switch(self.desk.dark)
            chart.show(partial(chart.draw, look, name))
