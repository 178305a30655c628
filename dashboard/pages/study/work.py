"""The work behind the page Study: it estimates, runs, looks at, saves and opens studies."""

from collections.abc import Callable, Mapping
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
import panel as pn

from railjoule.core import RailjouleError, Scenario
from railjoule.core.scenario import format_scenario
from railjoule.core.strategies import STRATEGIES
from railjoule.core.studies.sweep import MemoryResults, Study, SweepFile, SweepTable
from railjoule.core.studies.sweep.table_files import read_study
from railjoule.dashboard.library_workarounds import make_turns
from railjoule.dashboard.pages.study.compute import (
    ENERGY,
    Estimate,
    EstimateRequest,
    Look,
    LookRequest,
    compute_estimate,
    compute_look,
    write_table,
)
from railjoule.dashboard.pages.study.model import COLUMNS, MOST_RUNS, ROWS_AT_ONCE, Brought, Progress, Saved, StudyModel
from railjoule.dashboard.pages.study.places import shape_of
from railjoule.dashboard.pages.study.running import Running
from railjoule.dashboard.state.draft import FIELD_KEYS
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.offered import OFFERED
from railjoule.dashboard.work.study_pool import LOOK_THREADS, LOOKS
from railjoule.dashboard.work.worker import Worker, without_page

if TYPE_CHECKING:
    from railjoule.dashboard.pages.study.charts import Drawn

PAGE = "Study"
SETTINGS = ("over", "method", "strategy", "runs", "seed")
LOOKED_AT = ("x", "y", "colour", "map_x", "map_y", "choice", "shown")
RASTER_PX = (440, 300)
OTHER_SOLVER = "Another version of railjoule made its runs: they can be looked at, and none can be added."
LOOK_LOST = "The process that draws studies ended unexpectedly; it is started again with the next change."
Result = TypeVar("Result")


def beside(here: bool, act: Callable[..., Result], *arguments: Any) -> Result:
    """Act in the process for what pages draw of studies, or `here`, where there is no page around it."""
    if here:
        return act(*arguments)
    try:
        return LOOKS.executor().submit(act, *arguments).result()
    except BrokenExecutor:
        LOOKS.renew()
        raise RailjouleError(LOOK_LOST) from None


@dataclass(frozen=True, eq=False)
class DrawRequest:
    """What is to be looked at, the figures that are there by their shape, and whether there is no page."""

    look: LookRequest
    shape: tuple[object, ...]
    dark: bool
    here: bool


@dataclass(frozen=True, eq=False)
class Shown:
    """What was looked at, and the figures where they are others than before."""

    look: Look
    drawn: "Drawn | None"


def look_and_draw(request: DrawRequest) -> Shown:
    """Return what is looked at, with figures where those of before have another shape; runs in a thread."""
    look = beside(request.here, compute_look, request.look)
    if look.runs is None or shape_of(look) == request.shape:
        return Shown(look, None)
    # HoloViews takes its time to load, and is loaded for this page alone
    from railjoule.dashboard.pages.study.charts import draw  # noqa: PLC0415

    return Shown(look, draw(request.look.table.study, look, request.dark))


def estimate(asked: tuple[EstimateRequest, bool]) -> Estimate:
    """Return how long a study takes; whether it is to be found out without another process comes second."""
    request, here = asked
    return beside(here, compute_estimate, request)


@dataclass(frozen=True)
class SaveRequest:
    """A table that is to be written for the browser."""

    table: SweepTable
    suffix: str
    name: str
    here: bool


def save(request: SaveRequest) -> Saved:
    """Return where the browser fetches a table from."""
    path = OFFERED.new_path(request.suffix)
    beside(request.here, write_table, request.table, path)
    return Saved(f"file/{OFFERED.offer(path, request.name)}", request.name)


@dataclass(frozen=True, eq=False)
class BeginRequest:
    """A study that is to begin, and the page's scenario."""

    settings: EstimateRequest
    base: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class Begun:
    """Where the rows of a study go, and what asked for it."""

    request: BeginRequest
    results: SweepFile


def make_results(request: BeginRequest) -> Begun:
    """Return the place for the rows of a study; errors as `make_study`."""
    return Begun(request, MemoryResults(request.settings.study()))


@dataclass(frozen=True, eq=False)
class Opened:
    """A study from a file, whether rows can be added, and its rows once more where they can."""

    table: SweepTable
    is_same_solver: bool
    results: MemoryResults


def open_study(brought: Brought) -> Opened:
    """Return the study of a file; errors as `read_study`."""
    table, is_same_solver = read_study(brought.content, brought.name, MOST_RUNS)
    if ENERGY not in table.columns:
        raise RailjouleError(f"{brought.name}: the column {ENERGY} is missing, without which a study is not shown.")
    results = MemoryResults(table.study)
    for chunk in table.chunks():
        results.append(chunk, 0.0)
    return Opened(table, is_same_solver, results)


class Studies(PageWork[StudyModel]):
    """Has the studies of one page made, one at a time, and looks at the one that is shown."""

    page = PAGE

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.study)
        self.results: SweepFile | None = None
        self.table: SweepTable | None = None
        self._running: Running | None = None
        # what begins, and how far the study before it was
        self._beginning: tuple[BeginRequest, Progress] | None = None
        self._base: Mapping[str, Any] | None = None
        self._shape: tuple[object, ...] = ()
        model = self.model

        def of_study() -> object:
            return model.study

        self.estimator: Worker[tuple[EstimateRequest, bool], Estimate] = Worker(
            estimate,
            self._take_estimate,
            self._refuse,
            threads=LOOK_THREADS,
        )
        self.beginner: Worker[BeginRequest, Begun] = Worker(
            make_results, self._begin, self._refuse_beginning, threads=LOOK_THREADS
        )
        self.looker: Worker[DrawRequest, Shown] = Worker(
            look_and_draw, self._take_look, self.take_failure, about=of_study, threads=LOOK_THREADS
        )
        self.saver: Worker[SaveRequest, Saved] = Worker(
            save, self._take_saved, self._refuse_file, about=of_study, threads=LOOK_THREADS
        )
        self.opener: Worker[Brought, Opened] = Worker(open_study, self._take_opened, self._refuse, threads=LOOK_THREADS)
        state.scenario.param.watch(self._settle, list(RUN_FIELDS))
        model.param.watch(self._settle, list(SETTINGS))
        model.param.watch(self._look, list(LOOKED_AT))
        state.param.watch(self._appear, ["page", "dark"])
        for event, act in {"start": self._start, "stop": self._stop, "resume": self._go_on}.items():
            model.param.watch(act, event)
        model.param.watch(self._save, "wanted_file")
        model.param.watch(self._open_run, "wanted_run")
        model.param.watch(self._open_study, "brought")

    # ---- what is asked for

    def _settle(self, *_: Any) -> None:
        """Follow the settings: what they ask for, and how long it takes."""
        if not self.in_sight:
            return
        model = self.model
        over = tuple((path, float(low), float(high)) for path, (low, high) in model.over.items())
        request = EstimateRequest(
            self.state.scenario.scenario(), over, model.runs, model.method, model.seed, model.strategy, COLUMNS
        )
        if self.is_new(request, "estimate"):
            model.param.update(current=request, refusal="")
            self.estimator.ask((request, pn.state.curdoc is None))

    def _appear(self, *_: Any) -> None:
        if self.in_sight:
            self._settle()
            self._look()

    def _take_estimate(self, estimate: Estimate) -> None:
        self.model.estimate = estimate

    def _refuse(self, failure: RailjouleError) -> None:
        self.model.refusal = str(failure)

    # ---- runs

    def _start(self, *_: Any) -> None:
        request = self.model.current
        if request is None or self.model.progress.is_under_way:
            return
        begin = BeginRequest(request, self.state.scenario.keep())
        self._beginning = begin, self.model.progress
        # from now on: it must not be asked for twice
        self.model.param.update(refusal="", progress=Progress("waiting", 0, request.sample))
        self.beginner.ask(begin)

    def _begin(self, begun: Begun) -> None:
        request, results = begun.request, begun.results
        if self._beginning is None or self._beginning[0] is not request:
            # stopped before it began
            return
        self._beginning = None
        self._show_results(results)
        self._base = request.base
        self.model.asked = request.settings
        self._run()

    def _refuse_beginning(self, failure: RailjouleError) -> None:
        self._stay()
        self._refuse(failure)

    def _stay(self) -> None:
        """Leave the study that is shown as it was before another one was asked for."""
        if self._beginning is not None:
            self.model.progress = self._beginning[1]
            self._beginning = None

    def _show_results(self, results: SweepFile) -> None:
        """Show another study, and let go of the one before."""
        self._let_go()
        self.results, self.table, self._shape, self._base = results, None, (), None
        self.model.param.update(
            study=results.study,
            asked=None,
            look=None,
            drawn=None,
            choice={},
            shown=ROWS_AT_ONCE,
            failure=None,
            refusal="",
            may_go_on=True,
        )

    def _let_go(self) -> None:
        """End what runs."""
        running, self._running, self.results = self._running, None, None
        if running is not None:
            running.stop()

    def _run(self) -> None:
        assert self.results is not None
        document = pn.state.curdoc
        turn = without_page if document is None else make_turns(document)
        running: Running

        def hear(progress: Progress, table: SweepTable | None) -> None:
            if running is self._running:
                with pn.io.hold():
                    self._hear(progress, table)

        running = self._running = Running(self.results, hear, turn)
        if document is None:
            running.do(here=True)
        else:
            running.begin()

    def _hear(self, progress: Progress, table: SweepTable | None) -> None:
        if table is not None:
            self.table = table
            self._look()
        self.model.progress = progress

    def _stop(self, *_: Any) -> None:
        if self._beginning is not None:
            self._stay()
        elif self._running is not None and self.model.progress.is_under_way:
            progress = self.model.progress
            self.model.progress = Progress("stopping", progress.done, progress.runs, progress.per_s)
            self._running.stop()

    def _go_on(self, *_: Any) -> None:
        if self.results is not None and not self.model.progress.is_under_way and self.model.may_go_on:
            self._run()

    # ---- what is looked at

    def _look(self, *_: Any) -> None:
        model, table = self.model, self.table
        if table is None or model.study is None or not self.in_sight:
            return
        choice = {name: (low, high) for name, (low, high) in model.choice.items()}
        request = LookRequest(table, *model.axes(), *model.map_axes(), choice, model.shown, RASTER_PX)
        self.looker.ask(DrawRequest(request, self._shape, self.state.dark, pn.state.curdoc is None))

    def _take_look(self, shown: Shown) -> None:
        ranked_before = self.model.map_axes()
        if shown.drawn is not None:
            self._shape = shown.drawn.shape
            self.model.drawn = shown.drawn
        self.model.param.update(look=shown.look, failure=None)
        # once it is known which fields decide, the map shows these
        if self.model.map_axes() != ranked_before:
            self._look()

    # ---- what leaves the page

    def _save(self, *_: Any) -> None:
        suffix, table = self.model.wanted_file, self.table
        if suffix is None:
            return
        self.model.wanted_file = None
        if table is not None and not self.model.saving:
            self.model.param.update(saving=True, refusal="")
            self.saver.ask(SaveRequest(table, suffix, f"study{suffix}", pn.state.curdoc is None))

    def _take_saved(self, saved: Saved) -> None:
        self.model.param.update(saved=saved, saving=False)

    def _refuse_file(self, failure: RailjouleError) -> None:
        self.model.param.update(refusal=str(failure), saving=False)

    def _open_run(self, *_: Any) -> None:
        """Show a run of the study on Drive: its scenario takes the place of the page's, in one step."""
        row, table, study = self.model.wanted_run, self.table, self.model.study
        if row is None or table is None or study is None:
            return
        self.model.wanted_run = None
        place = int(np.searchsorted(table.index, row))
        if place >= table.rows or table.index[place] != row:
            return
        values = {field.name: field.value(float(table.samples[field.name][place])) for field in study.fields}
        try:
            with pn.io.hold():
                self._lay(study, values)
        except RailjouleError as refusal:
            self._refuse(refusal)
            return
        if study.strategy in STRATEGIES:
            self.state.chosen = study.strategy
        self.state.page = "Drive"

    def _lay(self, study: Study, values: Mapping[str, Any]) -> None:
        scenario, base = self.state.scenario, self._base
        if base is None or any(base[name] != getattr(scenario, name) for name in ("preset", "toml")):
            # opened from a file, or the page has another scenario by now
            row: Scenario = study.scenario.replace(**values)
            scenario.open(format_scenario(row), study.scenario.title)
            return
        edits = {**base["edits"], **{path: number for path, number in values.items() if path not in FIELD_KEYS}}
        fields = {field: base[field] for field in FIELD_KEYS.values()}
        for path, number in values.items():
            if path in FIELD_KEYS:
                fields[FIELD_KEYS[path]] = number if path.endswith("_s") else 100 * number
        scenario.lay({"edits": edits, **fields})

    # ---- a study from a file

    def _open_study(self, *_: Any) -> None:
        brought = self.model.brought
        if brought is not None:
            self.model.param.update(brought=None, refusal="")
            self.opener.ask(brought)

    def _take_opened(self, opened: Opened) -> None:
        self._stay()
        self._show_results(opened.results)
        table = self.table = opened.table
        done, runs = table.rows, table.study.sample
        message = "" if opened.is_same_solver else OTHER_SOLVER
        self.model.param.update(
            progress=Progress("done" if done == runs else "stopped", done, runs, None, message),
            may_go_on=opened.is_same_solver,
        )
        self._look()

    def end(self, *_: Any) -> None:
        """End the study: it ends with its page."""
        super().end()
        self._stay()
        self._let_go()
