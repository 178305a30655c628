"""Study: which of the scenario's numbers decide the energy, over many runs; any of them opens on Drive."""

import json
import math
from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core.parquet import has_parquet
from railjoule.dashboard.charts.chart import Chart, dragged
from railjoule.dashboard.charts.figures import FinishedChart
from railjoule.dashboard.charts.sketches import SketchKind, shapes
from railjoule.dashboard.look import words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.theme import study_css
from railjoule.dashboard.pages.page import PageView
from railjoule.dashboard.pages.study.columns import Column, columns_of
from railjoule.dashboard.pages.study.compute import ENERGY, RESULTS, Listed, Look, Shares
from railjoule.dashboard.pages.study.model import ROWS_AT_ONCE, Progress
from railjoule.dashboard.pages.study.places import ALONG_X, ALONG_Y, MAP, RUNS, colours_for, shape_of
from railjoule.dashboard.pages.study.rows import StudyFiles, StudyRows, lowest_words, ranked_fields
from railjoule.dashboard.pages.study.settings import START, STUDY_SUFFIX, duration_words
from railjoule.dashboard.pages.study.work import PAGE, Studies
from railjoule.dashboard.parts import html as parts

if TYPE_CHECKING:
    from railjoule.dashboard.pages.study.charts import Drawn, StudyFigure

HEIGHTS = {RUNS: (400, 470, 300), ALONG_X: (44, 50, 30), ALONG_Y: (400, 470, 300), MAP: (260, 300, 240)}
"""Of each chart [px]: in usual, wide and narrow windows."""
EMPTY = "Choose fields and a number of runs beside the page, or open a saved study."
SO_FAR = "figures show the runs done so far"
FORMER = "Figures of the former settings."
INDICES = "Sobol\u2019 indices"
TOO_FEW = "too few runs yet"
WELL_EXPLAINED = 0.99
"""Below this share of the spread it is told how much the indices explain."""
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
  .rj-chart-study_along_x, .rj-chart-study_along_y, .study-corner { display: none; } }
"""
SELECT: dict[str, Any] = {"size": "small", "margin": (6, 8, 2, 0), "sizing_mode": "stretch_width", "min_width": 120}
# the name of a field is told whole
SELECT["sx"] = {"& .MuiSelect-select": {"whiteSpace": "normal !important", "lineHeight": "1.2 !important"}}


class StudyChart(FinishedChart):
    """A figure of a study: it comes finished, and takes numbers as long as its shape is the same."""

    def __init__(self, name: str, title: str, kind: SketchKind) -> None:
        # before its sketch is made
        self.kind, self.title = kind, title
        super().__init__(name, "", HEIGHTS[name][0])
        self._made: StudyFigure | None = None
        self._look: Look | None = None
        self._columns: Mapping[str, Column] = {}
        self._dark = self._filled_dark = False
        self._filled: Look | None = None

    def take(self, made: "StudyFigure | None", look: Look, columns: Mapping[str, Column], dark: bool) -> None:
        """Show a figure with what is looked at."""
        self._made, self._look, self._columns, self._dark = made, look, columns, dark
        if made is not None:
            self.show(self._draw)

    def _draw(self) -> None:
        from railjoule.dashboard.pages.study.charts import fill  # noqa: PLC0415  (loaded by now, by who drew it)

        made, look = self._made, self._look
        if made is None or look is None:
            return
        is_new = made.figure is not self.figure
        changed = is_new or self._filled_dark != self._dark
        if changed:
            made.palette.switch(self._dark)
            self._filled_dark = self._dark
        if look is not self._filled or changed:
            fill(made, self.name, look, self._columns)
            self._filled = look
        if is_new:
            self.draw(made.figure)


class StudyView(PageView):
    """The page of studies."""

    page = PAGE
    works = (Studies,)
    heights = HEIGHTS

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        self.model = model = self.state.study
        self._charts: tuple[StudyChart, ...] = ()
        self._drawn: Drawn | None = None
        self._joined: object = None
        self._quiet = False
        self.status = self._pane()
        self.stop, self.resume = (
            pmui.Button(label=label, variant="outlined", size="small", margin=(0, 0, 0, 6), visible=False, on_click=act)
            for label, act in (
                ("Stop", lambda _: model.param.trigger("stop")),
                ("Resume", lambda _: model.param.trigger("resume")),
            )
        )
        suffixes = {"Save study": STUDY_SUFFIX, "CSV": ".csv", **({"Parquet": ".parquet"} if has_parquet() else {})}
        self.saves = {
            suffix: pmui.Button(
                label=label,
                variant="text",
                size="small",
                margin=(0, 0, 0, 4),
                visible=False,
                on_click=partial(self._want_file, suffix),
            )
            for label, suffix in suffixes.items()
        }
        self.files = StudyFiles()
        self.run = pmui.Button(
            label=START,
            variant="contained",
            size="small",
            margin=(0, 20),
            width=90,
            on_click=lambda _: model.param.trigger("start"),
        )
        self.empty = parts.stack(self._pane(_empty_html()), self.run)
        buttons = pn.Row(*self.saves.values(), self.stop, self.resume, self.files, margin=0)
        self.head = parts.stack(self.status, buttons, css=HEAD_CSS)
        self.legend, self.indices = self._pane(), self._pane()
        self.selects = {
            name: pmui.Select(label=label, options={}, **SELECT)
            for name, label in {
                "y": "Upwards",
                "x": "To the right",
                "colour": "Colour",
                "map_y": "Map, upwards",
                "map_x": "Map, to the right",
            }.items()
        }
        for name, select in self.selects.items():
            select.param.watch(partial(self._choose_column, name), "value")
        self.runs = StudyChart(RUNS, "runs of the study", "map")
        self.along_x = StudyChart(ALONG_X, "histogram of what lies to the right", "bars")
        self.along_y = StudyChart(ALONG_Y, "histogram of what lies upwards", "bars")
        self.map = StudyChart(MAP, "median energy over two fields", "map")
        corner = parts.html_pane(css_classes=["study-corner"])
        margins = parts.stack(self.along_x.host, corner, self.runs.host, self.along_y.host, css=MARGINS_CSS)
        left = parts.stack(self._row("y", "x", "colour"), self.legend, margins)
        # on a narrow screen what decides comes first
        right = parts.stack(self._row("map_y", "map_x"), self.map.host, self.indices, css_classes=["study-shares"])
        self.rows = StudyRows(model)
        self.body = parts.stack(parts.stack(left, right, css=BODY_CSS), self.rows)
        self.shows(self._show_state, (model, ["progress", "current", "asked", "study", "may_go_on", "saving"]))
        self.shows(self._show_columns, (model, ["study", "look", "x", "y", "colour", "map_x", "map_y"]))
        self.shows(self._show_look, (model, ["look", "drawn", "failure"]))
        self.shows(self._show_choice, (model, ["choice"]))
        self.shows(self._fetch, (model, ["saved"]))
        return parts.stack(self.heading, self.message, self.head, self.empty, self.figures, self.body)

    @staticmethod
    def _pane(text: str = "") -> Any:
        pane = parts.html_pane(text)
        pane.stylesheets = [*pane.stylesheets, study_css()]
        return pane

    def _row(self, *names: str) -> Viewable:
        made = [self.selects[name] for name in names]
        return pn.Row(*made, margin=0, sizing_mode="stretch_width", stylesheets=[parts.WRAP_CSS])

    @property
    def charts(self) -> tuple[Chart, ...]:
        """The charts of the study that is shown."""
        return self._charts

    # ---- what the user asks for

    def _want_file(self, suffix: str, _: Any) -> None:
        self.model.wanted_file = suffix

    def _choose_column(self, name: str, event: Any) -> None:
        if not self._quiet and event.new:
            setattr(self.model, name, event.new)

    def _hear_choice(self, _attribute: str, _old: Any, new: Any) -> None:
        """Take the rectangle that was dragged over the runs."""
        ends = _ends_of(new)
        look = self.model.look
        if ends is not None and look is not None:
            left, right, bottom, top = ends
            x, y = look.request[:2]
            with pn.io.hold():
                self.model.param.update(choice={x: (left, right), y: (bottom, top)}, shown=ROWS_AT_ONCE)

    # ---- what is shown

    def _show_state(self) -> None:
        model, progress = self.model, self.model.progress
        there = model.study is not None
        self.empty.visible = not there
        self.figures.visible = self.body.visible = there and model.look is not None
        self.head.visible = there
        self.run.disabled = progress.is_under_way
        self.stop.visible = progress.is_under_way
        self.stop.disabled = progress.state == "stopping"
        self.resume.visible = progress.state in {"stopped", "failed"} and model.may_go_on
        for suffix, button in self.saves.items():
            # the file names the version of the solver, which is another one where the study may not go on
            button.visible = there and progress.done > 0 and (model.may_go_on or suffix != STUDY_SUFFIX)
            button.disabled = model.saving
        former = model.asked is not None and model.current is not None and model.asked != model.current
        self.status.object = status_html(progress, former) if there else ""
        title = (self.state.scenario.edited if model.study is None else model.study.scenario).title
        count = 0 if model.study is None else len(model.study.fields)
        varied = f"{count} {'field' if count == 1 else 'fields'} varied at once" if there else ""
        self.heading.object = parts.heading(self.page, title, varied, "")

    def _show_columns(self) -> None:
        """Offer the columns of the study that is shown."""
        study = self.model.study
        if study is None:
            return
        columns = columns_of(study)
        everything = {_named(column): name for name, column in columns.items()}
        fields = {word: name for word, name in everything.items() if name not in RESULTS}
        chosen = dict(zip(("x", "y", "colour"), self.model.axes(), strict=True))
        chosen |= dict(zip(("map_x", "map_y"), self.model.map_axes(), strict=True))
        self._quiet = True
        for name, select in self.selects.items():
            options = fields if name.startswith("map") else everything
            if select.options != options or select.value != chosen[name]:
                select.param.update(options=options, value=chosen[name])
        self._quiet = False

    def _show_look(self) -> None:
        model, look = self.model, self.model.look
        self.tell(model.failure, "Shown: what was drawn last." if look is not None else "")
        if look is None or model.study is None:
            self._take_charts(())
            return
        self.figures.visible = self.body.visible = True
        columns = columns_of(model.study)
        self.figures.object = parts.figures(figures_of(look, columns))
        self.legend.object = legend_html(look, columns, self.state.dark)
        self.indices.object = indices_html(look, columns)
        self.rows.show()
        drawn: Any = model.drawn
        if drawn is None:
            return
        charts = {RUNS: self.runs, ALONG_X: self.along_x, ALONG_Y: self.along_y, MAP: self.map}
        self._take_charts(tuple(chart for name, chart in charts.items() if name in drawn.figures))
        self.map.host.visible = self.selects["map_x"].visible = self.selects["map_y"].visible = MAP in drawn.figures
        if drawn.shape == shape_of(look):
            for name, chart in charts.items():
                chart.take(drawn.figures.get(name), look, columns, self.state.dark)
            self._join(drawn)
        self._show_choice()

    def _take_charts(self, charts: tuple[StudyChart, ...]) -> None:
        if charts != self._charts:
            self._charts = charts
            self.queue.take(charts)
            self._fit()

    def _join(self, drawn: "Drawn") -> None:
        """Let a rectangle be dragged over the runs."""
        if drawn is self._joined:
            return
        self._joined = drawn
        made = drawn.figures.get(RUNS)
        if made is not None and made.box is not None:
            dragged(made.figure, "drag_choice", box=made.box)
            made.box.on_change("tags", self._hear_choice)

    def _show_choice(self) -> None:
        """Draw the rectangle of the choice, where it lies over the axes that are shown."""
        look, drawn = self.model.look, self.model.drawn
        if look is None or drawn is None or RUNS not in drawn.figures:
            return
        box, choice = drawn.figures[RUNS].box, self.model.choice
        x, y = look.request[:2]
        if x in choice and y in choice:
            (left, right), (bottom, top) = choice[x], choice[y]
            box.update(left=left, right=right, bottom=bottom, top=top, visible=True)
        elif box.visible:
            box.visible = False

    def _fetch(self) -> None:
        saved = self.model.saved
        if saved is not None:
            # once
            self.model.saved = None
            self.files.fetch(saved)


def _ends_of(tags: Any) -> tuple[float, float, float, float] | None:
    """Return the rectangle that the browser tells, left and right, bottom and top; None where it is none."""
    try:
        ends = json.loads(str(tags[0]))
    except (ValueError, IndexError, TypeError, RecursionError):
        return None
    if not isinstance(ends, list) or len(ends) != 4 or not all(type(end) in {int, float} for end in ends):
        return None
    left, right, bottom, top = map(float, ends)
    known = all(map(math.isfinite, (left, right, bottom, top)))
    return (left, right, bottom, top) if known and left <= right and bottom <= top else None


def _named(column: Column) -> str:
    return f"{column.quantity}, {column.unit}".rstrip(", ")


def _empty_html() -> Markup:
    return markup(
        '<div class="study-empty"><p>{}</p><svg viewBox="0 0 100 100" preserveAspectRatio="none" aria-hidden="true">{}'
        "</svg></div>",
        EMPTY,
        shapes("map"),
    )


def status_html(progress: Progress, former: bool) -> Markup:
    """Return how far a study is."""
    count = markup("<span><b>{}</b> of {} runs</span>", words.number(progress.done, 0), words.number(progress.runs, 0))
    pieces = [count]
    if progress.state == "running" and progress.per_s:
        pieces.append(markup("<span><b>{}</b> runs a second</span>", words.number(progress.per_s, 0)))
        pieces.append(markup("<span><b>{}</b> left</span>", duration_words(progress.left_s or 0.0)))
    state = {
        "running": "" if progress.per_s else "starting",
        "stopping": "stopping after the runs that are under way",
        "stopped": "stopped",
        "done": "done",
    }.get(progress.state, "")
    if state:
        pieces.append(markup("<span>{}</span>", state))
    if progress.told:
        pieces.append(
            markup('<span role="{}">{}</span>', "alert" if progress.state == "failed" else "status", progress.told)
        )
    pieces.append(markup('<span class="push"></span>'))
    if former:
        pieces.append(markup("<span>{}</span>", FORMER))
    elif progress.is_under_way and progress.done:
        pieces.append(markup("<span>{}</span>", SO_FAR))
    return markup(
        '<div class="study-status"><progress aria-label="{}" max="{}" value="{}"></progress><p>{}</p></div>',
        "Runs of the study that are done",
        max(progress.runs, 1),
        progress.done,
        joined(pieces),
    )


def figures_of(look: Look, columns: Mapping[str, Column]) -> list[Markup]:
    """Return the row of numbers."""
    ranked, energy = ranked_fields(look, columns), columns[ENERGY]
    shares = look.shares
    if shares is None:
        decides = parts.figure("Decides most", words.UNKNOWN, "", TOO_FEW, kind="main", whole=look.shares_refusal)
    else:
        name = columns[shares.fields[0]].quantity
        share = words.number(100 * shares.first[0], 0)
        decides = parts.figure(
            f"{name} decides", share, "%", "of the spread in energy", "main", term="Sobol\u2019 indices"
        )

    def of(run: Listed | None, detail: str = "") -> tuple[str, str, str]:
        if run is None:
            return words.UNKNOWN, "", "no run yet"
        number = run.values[list(columns).index(ENERGY)]
        return energy.show(number), "kWh", detail or lowest_words(columns, run.values, ranked)

    without = look.done - look.driven
    kept = words.number(100 * look.driven / look.done, 1) if look.done else words.UNKNOWN
    return [
        decides,
        parts.figure("Lowest", *of(look.lowest)),
        parts.figure("Median", *of(look.median, f"of {words.number(look.driven, 0)} runs")),
        parts.figure("Highest", *of(look.highest)),
        parts.figure(
            "Can be driven",
            kept,
            "%",
            f"{words.number(without, 0)} of {words.number(look.done, 0)} without a run",
            whole=look.reason,
        ),
    ]


def legend_html(look: Look, columns: Mapping[str, Column], dark: bool) -> Markup:
    """Return the title of the figure of the runs, with its colours."""
    x, y, colour = (columns[name] for name in look.request[:3])
    low, high = (colour.show(end) for end in look.colour_ends)
    return markup(
        '<div class="legend"><span>{}, over {}</span><span class="push"></span><span class="scale">{} {}'
        '<i style="background:linear-gradient(to right,{})"></i>{}</span></div>',
        _named(y),
        x.within_sentence,
        colour.within_sentence,
        low,
        ",".join(colours_for(dark)),
        f"{high} {colour.unit}".rstrip(),
    )


def indices_html(look: Look, columns: Mapping[str, Column]) -> Markup:
    """Return what each field decides, as bars with their numbers."""
    title = markup(
        '<div class="titled"><h2>What decides the energy: Sobol\u2019 indices, %{}</h2></div>',
        info("Sobol\u2019 indices"),
    )
    if look.shares is None:
        told = look.shares_refusal[:1].upper() + look.shares_refusal[1:]
        return markup('<div class="block">{}<p class="note">{}</p></div>', title, told or TOO_FEW)
    keys = Markup('<div class="keys"><span><i class="filled"></i>alone</span><span><i></i>with the others</span></div>')
    note = ""
    if look.shares.explained < WELL_EXPLAINED:
        note = f"The polynomial behind them explains {words.share(look.shares.explained)} % of the spread."
    return markup(
        '<div class="block">{}<div class="shares">{}</div>{}{}</div>',
        title,
        joined(_bars(look.shares, columns)),
        keys,
        parts.note_paragraphs([note] if note else []),
    )


def _bars(shares: Shares, columns: Mapping[str, Column]) -> list[Markup]:
    return [
        markup(
            '<span>{}</span><span class="bar" title="alone {} %, with the others {} %"><u style="width:{}%"></u>'
            '<i style="width:{}%"></i></span><span><b>{}</b> <span class="muted">\u00b1 {}</span></span>',
            columns[name].quantity,
            words.number(100 * first),
            words.number(100 * total),
            f"{100 * min(max(total, 0.0), 1.0):.2f}",
            f"{100 * min(max(first, 0.0), 1.0):.2f}",
            words.number(100 * first),
            words.number(100 * error),
        )
        for name, first, total, error in zip(shares.fields, shares.first, shares.total, shares.error, strict=True)
    ]
