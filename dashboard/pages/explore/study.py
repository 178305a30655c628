"""Studies: the inputs and their ranges, the runs, their files, and a run that opens on Drive."""

import asyncio
import math
import threading
from collections.abc import Mapping
from io import BytesIO
from typing import Any

import numpy as np
import panel as pn
import param
from panel.viewable import Viewable

from railjoule.core import RailjouleError, Scenario
from railjoule.core.scenario import format_scenario
from railjoule.core.strategies import STRATEGIES
from railjoule.core.studies.sweep import METHODS, MemoryResults, Study, SweepFile, SweepTable
from railjoule.dashboard.keep.keeping import shown_name
from railjoule.dashboard.library_workarounds import SmallFile
from railjoule.dashboard.limits import LARGEST_STUDY_BYTES
from railjoule.dashboard.look import words
from railjoule.dashboard.page import Own, Page, Request, Section, study, work
from railjoule.dashboard.pages.explore import texts
from railjoule.dashboard.pages.explore.compute import (
    ENERGY,
    Look,
    LookRequest,
    Opened,
    Preview,
    Settings,
    Shares,
    compute_look,
    compute_shares,
    open_study,
    preview_steps,
    table_file,
)
from railjoule.dashboard.pages.explore.fields import COLUMNS, MOST_VARIED, first_ranges, study_columns, study_table
from railjoule.dashboard.pages.explore.ranges import InputRanges
from railjoule.dashboard.pages.explore.running import WAITS, Progress, State, Step, run_in_steps
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.state.draft import FIELD_KEYS
from railjoule.dashboard.state.kept import result, short
from railjoule.dashboard.state.numbers import TypedInteger
from railjoule.dashboard.state.recipes import SOLVE, PageRun, Program
from railjoule.dashboard.work.run_table import Column, RunTable
from railjoule.dashboard.work.study_pool import STUDY_THREADS

FIRST_RUNS, MOST_RUNS = 3000, 1_000_000
ROWS_AT_ONCE = 50
SLOW_ROWS = 100_000
"""From so many rows on, a figure takes longer than the answers to sliders may wait."""
METHOD_WORDS = {"Sobol sequence": "sobol", "Halton sequence": "halton", "At random": "random", "Grid": "grid"}
SUFFIX = ".nc"
STARTS, LOOKED_AT = ("over", "method", "strategy", "runs", "seed"), ("x", "y", "colour", "map_x", "map_y")
END = "A study ends with its page; a saved one can be opened again."
TOO_LARGE = (
    f"The file is larger than the {LARGEST_STUDY_BYTES / 1e6:g} MB that this page opens; Python's xarray reads it."
)
OTHER_SOLVER = "Computed by another version of railjoule: read-only."


def look_at(source: RunTable | SweepTable, asked: LookRequest) -> Look:
    """Return the figures of the rows of a study, or of another table of runs."""
    return compute_look(source if isinstance(source, RunTable) else study_table(source), asked)


def is_slow(source: Any, *_: Any) -> bool:
    """Return whether a table is so large that its figures take seconds."""
    return isinstance(source, Settings) or source.done > SLOW_ROWS


class Studies(Page):
    """Studies over ranges of the scenario's numbers, without their figures."""

    kept = (*STARTS, *LOOKED_AT)
    passing = ("choice", "listed", "refusal", "note", "may_go_on")
    follows_scenario = False
    choices = {"method": METHOD_WORDS, "strategy": {words.strategy(name): name for name in STRATEGIES}}  # noqa: RUF012

    over = param.Dict(default={}, doc="The inputs by their key in the file, each with the ends of its range.")
    method = param.Selector(default="sobol", objects=list(METHODS), label="Sampling", doc="How the runs are drawn.")
    strategy = param.Selector(default="optimal", objects=list(STRATEGIES), label="Strategy", doc="Of all runs.")
    runs = TypedInteger("Runs", default=FIRST_RUNS, bounds=(1, MOST_RUNS))
    seed = TypedInteger("Seed", default=1, bounds=(0, 2**31))
    x = param.String(default="", doc="Column of the horizontal axis; empty for the first input.")
    y = param.String(default=ENERGY, doc="Column of the vertical axis.")
    colour = param.String(default="", doc="Column of the colours; empty for the second input.")
    map_x = param.String(default="", doc="Input of the map's columns; empty for the one that decides most.")
    map_y = param.String(default="", doc="Input of the map's rows; empty for the one that decides next.")

    preview = result(Preview, "The first runs of the study that the settings ask for.")
    look = result(Look, "The figures of the table.")
    shares = result(Shares, "The share of each input in the spread.")
    opened = result(Opened, "The study of a file.")
    brought = result(tuple, "Name and content of the file of a study that is to be opened.")
    table = result(SweepTable, "The rows of the study that is shown.")
    draws = result(RunTable, "Runs of another page, which are shown in place of a study.")
    step = result(Step, "The last step of the study.")
    start = param.Event(doc="Compute the runs that are missing.")
    asked = result(Settings, "The settings of the study that is shown; None where it was opened from a file.")
    progress = param.ClassSelector(class_=Progress, default=Progress(), doc="Of the study that is shown.")
    choice = param.Dict(default={}, doc="Ends of the selection, by column.")
    listed = param.Integer(default=ROWS_AT_ONCE, doc="How many of the selected runs are listed.")
    refusal = param.String(default="", doc="Why a study was not begun or opened.")
    note = param.String(default="", doc="The saved study.")
    may_go_on = param.Boolean(default=True, doc="Whether a study that has stopped can go on.")

    def __init__(self, desk: Any, **params: Any) -> None:
        super().__init__(desk, **params)
        self.sweep: SweepFile | None = None
        self._stop = threading.Event()
        self._base: Mapping[str, Any] = {}
        self.take(desk.scenario.base)
        # a study is of its own scenario and goes on; the ranges are those of the present one
        desk.scenario.follow(lambda _: None, self.take)
        self.param.watch(self._take_step, "step")
        self.param.watch(self._take_opened, "opened")
        self.param.watch(lambda *_: self.param.update(choice={}, listed=ROWS_AT_ONCE), "draws")

    # ---- settings

    def take(self, scenario: Scenario) -> None:
        """Begin with the ranges of a scenario."""
        self.param.update(over=first_ranges(scenario), strategy=scenario.strategy, refusal="")

    def checked(self, field: str, value: Any) -> Any:
        """Return a value as `Kept.checked`; each range is checked as well."""
        value = super().checked(field, value)
        if field == "over":
            if len(value) > MOST_VARIED:
                raise ValueError(f"must have at most {MOST_VARIED} fields")
            for path, ends in value.items():
                if not _is_range(ends):
                    raise ValueError(f"has {short(path)}, which must have two finite numbers")
        return value

    @property
    def settings(self) -> Settings:
        """The study that the fields ask for."""
        over = tuple((path, float(low), float(high)) for path, (low, high) in self.over.items())
        scenario = self.desk.scenario.scenario()
        return Settings(scenario, over, self.runs, self.method, self.seed, self.strategy, COLUMNS)

    @property
    def shown_study(self) -> Study | None:
        """The study that is shown, once one has begun."""
        return None if self.sweep is None else self.sweep.study

    def page_run(self) -> PageRun:
        """Return the study that is shown as a program; before there is one, the plan."""
        study = self.shown_study
        if study is None:
            return PageRun(SOLVE, {"strategy": self.desk.chosen_now})
        over = {field.name: (field.low, field.high) for field in study.fields}
        body = (
            f"table = sweep(scenario, {over!r}, {study.sample}, {study.method!r}, seed={study.seed}, "
            f"columns={study.columns!r})\nprint(table.to_dataframe())\n"
        )
        note = "The page shows a study of many runs, whose ranges no scenario file has; study sweep takes them."
        return PageRun(Program({"sweep": "railjoule.core.studies.sweep"}, body, ""), {"strategy": study.strategy}, note)

    # ---- what it computes

    @property
    def rows(self) -> RunTable | SweepTable | None:
        """The table that is shown: that of another page, of the study, or of its preview."""
        preview = None if self.preview is None else self.preview.table
        return next((rows for rows in (self.draws, self.table, preview) if rows is not None), None)

    @property
    def columns(self) -> Mapping[str, Column]:
        """The columns of the table that is shown."""
        rows = self.rows
        return rows.columns if isinstance(rows, RunTable) else {} if rows is None else study_columns(rows.study)

    @study("scenario", *STARTS, into="preview")
    def _preview(self) -> Request:
        return preview_steps, self.settings

    @work("scenario", "table", "preview", "draws", into="shares", is_slow=is_slow)
    def _shares(self) -> Request:
        return (compute_shares, self.rows) if isinstance(self.rows, SweepTable) else None

    @work(
        "scenario", "table", "preview", "draws", "shares", "choice", "listed", *LOOKED_AT, into="look", is_slow=is_slow
    )
    def _look(self) -> Request:
        rows, axes = self.rows, self.axes()
        if rows is None or not axes:
            return None
        return look_at, rows, LookRequest(**axes, choice=self.choice, listed=self.listed)

    @work("brought", into="opened", is_slow=lambda *_: True)
    def _opened(self) -> Request:
        return None if self.brought is None else (open_study, *self.brought, MOST_RUNS)

    def axes(self) -> dict[str, str]:
        """Return the columns of axes, colours and map: the chosen ones, else the first, or those that decide most."""
        columns = self.columns
        if not columns:
            return {}
        inputs = [name for name, column in columns.items() if column.range is not None]
        ranked = [] if self.shares is None else [name for name in self.shares.fields if name in inputs]
        answer = ENERGY if self.draws is None else self.draws.answer
        x = self.x if self.x in columns else inputs[0]
        y = self.y if self.y in columns else answer
        colour = self.colour if self.colour in columns else inputs[min(1, len(inputs) - 1)]
        ranked = ranked or inputs
        map_x = self.map_x if self.map_x in inputs else ranked[0]
        others = [name for name in (self.map_y, *ranked) if name in inputs and name != map_x]
        return {"x": x, "y": y, "colour": colour, "map_x": map_x, "map_y": others[0] if others else map_x}

    # ---- runs

    def begin(self, *_: Any) -> None:
        """Begin the study that the settings ask for, unless one is under way."""
        if self.progress.is_under_way:
            return
        settings = self.settings
        try:
            results = MemoryResults(settings.study())
        except RailjouleError as refusal:
            self.refusal = str(refusal)
            return
        self._base = self.desk.scenario.keep()
        self._show_results(results, asked=settings)
        self.go_on()

    def _show_results(self, results: SweepFile, **more: Any) -> None:
        """Show another study in place of the present one."""
        self._stop.set()
        self.sweep = results
        first: dict[str, Any] = {"asked": None, "table": None, "draws": None, "choice": {}, "listed": ROWS_AT_ONCE}
        self.param.update(**{**first, "refusal": "", "note": "", "may_go_on": True, **more})

    def go_on(self, *_: Any) -> None:
        """Compute the runs that are missing, once no other study of this server runs."""
        if self.sweep is not None and not self.progress.is_under_way and self.may_go_on:
            self.progress = Progress("waiting", self.sweep.done, self.sweep.study.sample, None, WAITS)
            self.param.trigger("start")

    @study(into="step", start="start", threads=STUDY_THREADS)
    def _steps(self) -> Request:
        self._stop = threading.Event()
        return run_in_steps, self.sweep, self._stop, pn.state.curdoc is None

    def _take_step(self, *_: Any) -> None:
        step = self.step
        # the last steps of a study that was replaced may still be on their way
        if step is not None and step.sweep is self.sweep:
            self.param.update(progress=step.progress, **({} if step.table is None else {"table": step.table}))

    def stop(self, *_: Any) -> None:
        """Begin no further runs; the completed ones stay."""
        progress = self.progress
        self._stop.set()
        if progress.is_under_way:
            state: State = "stopped" if progress.state == "waiting" else "stopping"
            self.progress = Progress(state, progress.done, progress.runs, progress.per_s)

    def _take_opened(self, *_: Any) -> None:
        opened = self.opened
        if opened is None:
            return
        self.brought = None
        if opened.results is None:
            self.refusal = opened.refusal
            return
        done, runs = opened.table.rows, opened.results.study.sample
        message = "" if opened.is_same_solver else OTHER_SOLVER
        progress = Progress("done" if done == runs else "stopped", done, runs, None, message)
        self._base = {}
        self._show_results(opened.results, table=opened.table, progress=progress, may_go_on=opened.is_same_solver)

    async def _file(self, suffix: str) -> BytesIO:
        """Return the file of the rows so far."""
        table = self.table
        button = self.saves[suffix]
        # the same file twice would be no change, and not be saved
        button.data = None
        try:
            file = await asyncio.to_thread(table_file, table, suffix)
        except RailjouleError as refusal:
            self.note = str(refusal)
            raise
        runs = f"{words.number(table.rows, 0)} of {words.number(table.study.sample, 0)} runs"
        self.note = f"Saved to your downloads: {button.filename}, {runs}."
        return file

    # ---- a run on Drive

    def open_run(self, row: int | None) -> None:
        """Show a run of the study on Drive: its scenario takes the place of the page's, in one step."""
        table = self.rows
        if row is None or not isinstance(table, SweepTable):
            return
        place, study = int(np.searchsorted(table.index, row)), table.study
        if place >= table.rows or table.index[place] != row:
            return
        values = {field.name: field.value(float(table.samples[field.name][place])) for field in study.fields}
        try:
            with pn.io.hold():
                self._lay(study, values)
        except RailjouleError as refusal:
            self.refusal = str(refusal)
            return
        if study.strategy in STRATEGIES:
            self.desk.chosen = study.strategy
        self.desk.page = "Drive"

    def _lay(self, study: Study, values: Mapping[str, Any]) -> None:
        scenario, base = self.desk.scenario, self._base or self.desk.scenario.keep()
        if study is self.shown_study and (
            not self._base or any(base[name] != getattr(scenario, name) for name in ("preset", "toml"))
        ):
            # opened from a file, or the page has another scenario by now
            scenario.open(format_scenario(study.scenario.replace(**values)), study.scenario.title)
            return
        edits = {**base["edits"], **{path: number for path, number in values.items() if path not in FIELD_KEYS}}
        fields = {field: base[field] for field in FIELD_KEYS.values()}
        for path, number in values.items():
            if path in FIELD_KEYS:
                fields[FIELD_KEYS[path]] = number if path.endswith("_s") else 100 * number
        scenario.lay({"edits": edits, **fields})

    # ---- the sidebar

    def layout_start(self) -> Viewable:
        """Return the estimate, and the button that opens a study."""
        self.estimate = parts.html_pane()
        file = SmallFile(
            refuse=lambda: self.param.update(refusal=TOO_LARGE),
            label="Open a study",
            uploaded_label="Open a study",
            accept=SUFFIX,
            max_file_size=LARGEST_STUDY_BYTES,
            icon="folder_open",
            variant="text",
            size="small",
            margin=(4, 8, 8, 8),
        )

        def bring(event: Any) -> None:
            if event.new:
                self.brought = (shown_name(str(file.filename)), event.new)
                # so that the page does not keep the bytes
                file.clear()

        file.param.watch(bring, "value")
        self.param.watch(self._show_estimate, ["preview", "asked", "progress", "refusal", *STARTS])
        self._show_estimate()
        return parts.stack(self.estimate, file)

    fields = (
        Own(lambda page: InputRanges(page).view),
        Section("Runs"),
        "method",
        "strategy",
        "runs",
        "seed",
        Own(layout_start),
    )

    def _show_estimate(self, *_: Any) -> None:
        preview = self.preview
        same = self.asked is not None and self.asked == self.settings
        refusal = self.refusal or ("" if preview is None else preview.refusal)
        if refusal:
            said = parts.markup('<p class="error" role="alert" style="color:var(--rj-bad)">{}</p>', refusal)
        elif same and not self.progress.is_under_way:
            said = parts.markup('<p class="muted">Change an input, the runs or the seed to run again.</p>')
        else:
            known = preview is not None and not preview.refusal
            about = f"About {texts.duration_words(preview.seconds)} on this computer. " if known else ""
            said = parts.markup('<p class="muted">{}{}</p>', about, END)
        self.estimate.object = parts.markup('<div style="padding:6px 16px 0;font-size:12px">{}</div>', said)


def _is_range(ends: Any) -> bool:
    numbers = isinstance(ends, list) and len(ends) == 2 and all(type(end) in {int, float} for end in ends)
    return numbers and all(map(math.isfinite, ends))
