"""The work behind the page Measured runs: files are read and computed in threads, and shown as they come."""

from functools import cache, partial
from importlib.resources import files as resources
from typing import Any

from railjoule.core import RailjouleError
from railjoule.core.errors import ChoiceError
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.pages.measured_runs.columns import RunFile, read_run_file, run_sheets
from railjoule.dashboard.pages.measured_runs.compute import (
    Measured,
    RunsRequest,
    compute_measured,
    fitted_changes,
)
from railjoule.dashboard.pages.measured_runs.model import EXAMPLE_SCENARIO, MeasuredRunsModel
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.scenario import PLAN_FIELDS
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.worker import Worker

REST_MS = 150
"""What changes at once, as several files that are dropped, is computed once."""
PAGE = "Measured runs"
EXAMPLE_FILES = ("metro-0714.csv", "metro-1742.csv")
"""Two drivers' runs over one line: the folder has those of other lines too."""


@cache
def example_files() -> tuple[RunFile, ...]:
    """Return the example runs, which never change."""
    folder = resources("railjoule.assets") / "recordings"
    return tuple(read_run_file(name, (folder / name).read_bytes(), is_example=True) for name in EXAMPLE_FILES)


def read_brought(brought: tuple[str, bytes]) -> tuple[RunFile, ...]:
    """Return a file, given by its name and content, as a table, or each sheet of a workbook as one.

    Raises
    ------
    RailjouleError
        As `read_run_file`; of a workbook with several sheets if none of them names a speed.
    """
    try:
        return (read_run_file(*brought),)
    except ChoiceError as several:
        return run_sheets(*brought, several.names)


class MeasuredRuns(PageWork[MeasuredRunsModel]):
    """Reads files, and asks for what they show while the page is in sight."""

    page = PAGE

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.measured_runs)
        model = self.model
        self._reading: set[object] = set()
        self.study_of_runs = self.study(compute_measured, self._take, marked=True)
        state.scenario.param.watch(self._ask, list(PLAN_FIELDS))
        state.param.watch(self._ask, "page")
        model.param.watch(self._show_example, "example")
        model.param.watch(self._ask, ["files", "answers", "begins_at_m", "shown", "coasting_only"])
        model.param.watch(self._read, "brought")

    def _show_example(self, *_: Any) -> None:
        """Have the example runs among the files, or not: a link or a step back says so."""
        model = self.model
        others = tuple(file for file in model.files if not file.is_example)
        model.files = (*example_files(), *others) if model.example else others

    def _read(self, *_: Any) -> None:
        """Read what was brought, each file in a thread of its own turn."""
        brought, self.model.brought = self.model.brought, ()
        for name, content in brought:
            reading = object()
            self._reading.add(reading)
            self.model.reading = len(self._reading)
            # a worker each: of what one is asked meanwhile, it does the last alone
            Worker(read_brought, partial(self._add, reading), partial(self._refuse, reading)).ask((name, content))

    def _add(self, reading: object, files: tuple[RunFile, ...]) -> None:
        self._reading.discard(reading)
        self.model.reading = len(self._reading)
        for file in files:
            self.model.add(file)

    def _refuse(self, reading: object, failure: RailjouleError) -> None:
        # also where a file that was read could not be taken: it counts once
        self._reading.discard(reading)
        self.model.param.update(reading=len(self._reading), refusal=str(failure))

    def _ask(self, *_: Any) -> None:
        model = self.model
        if not self.in_sight:
            self.rest()
            return
        if not model.files:
            self.end()
            self.forget()
            model.param.update(measured=None, failure=None)
            return
        try:
            scenario = self.state.scenario.scenario()
        except RailjouleError as failure:
            self.take_failure(failure)
            return
        request = RunsRequest(
            model.files,
            # from a link they may be anything
            tuple(sorted((str(header), str(text)) for header, text in model.answers.items())),
            scenario.model_copy(update={"timetable": self.state.scenario.base.timetable}),
            model.begins_at_m,
            model.shown,
            model.coasting_only,
        )
        if self.is_new(request):
            self.end()
            self.after(REST_MS, lambda: self.study_of_runs.ask(request))

    def _take(self, measured: Measured, last: bool) -> None:
        self.model.param.update(measured=measured, failure=None)


def use_fit(state: Workbench) -> None:
    """Give the scenario's train the fitted values, as one change; what cannot be is told on the page."""
    measured = state.measured_runs.measured
    if measured is None or measured.fit is None:
        return
    try:
        state.scenario.edit(fitted_changes(measured.fit))
    except RailjouleError as failure:
        state.measured_runs.failure = failure


def open_on_drive(state: Workbench) -> None:
    """Take the stretch, the stops and the time of the shown run as the scenario, and turn to Drive."""
    measured = state.measured_runs.measured
    run = None if measured is None else measured.shown.run
    if run is None:
        return
    name = run.recording.name
    title = f"{run.scenario.title}, {name}" if run.scenario.title else name
    try:
        state.scenario.open(format_scenario(run.scenario.model_copy(update={"title": title})), name)
    except RailjouleError as failure:
        state.measured_runs.failure = failure
    else:
        state.page = "Drive"


def try_example(state: Workbench) -> None:
    """Show the example runs on the line on which they were made."""
    if state.scenario.opened is not None or state.scenario.preset != EXAMPLE_SCENARIO:
        state.scenario.choose(EXAMPLE_SCENARIO)
    state.measured_runs.param.update(example=True, shown=example_files()[0].name, refusal="")
