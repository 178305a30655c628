"""A page as one class: its fields and results are parameters, `@work` computes results, `@shows` draws them.

    class Speeds(Page):
        page = "Speeds"
        kept = ("factor",)
        factor = keyed(SomeOptions, "factor", "Factor", digits=2)
        table = result(Table, "What has been computed last.")

        @work("scenario", "factor", into="table")
        def _table(self) -> Request:
            return compute_table, self.desk.scenario.scenario(), self.factor

        def layout(self) -> Viewable:
            return html_pane(...)

        @shows("table")
        def _show(self) -> None: ...

A name of a source is a parameter of the page (`factor`), one of the desk (`desk.chosen`), or `scenario`: all that a run
depends on. `PageWorks` computes what pages ask for, in threads, while they are in sight, and draws nothing; that does
`railjoule.dashboard.pages.host`.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from types import FunctionType
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import param
from panel.viewable import Viewable

from railjoule.core import RailjouleError, Scenario
from railjoule.dashboard.charts.plot import AnyPlot
from railjoule.dashboard.state.numbers import TypedParameters
from railjoule.dashboard.state.page_model import PageModel
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.program import SOLVE, PageRun
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.work.worker import LONG_THREADS

if TYPE_CHECKING:
    from concurrent.futures import ThreadPoolExecutor

    from railjoule.dashboard.pages.host import PageHost
    from railjoule.dashboard.state.workbench import Workbench

Request = tuple[Any, ...] | None
"""A function and its arguments, which must tell by `==` whether they ask for the same; None where nothing is asked."""
Method = TypeVar("Method", bound=Callable[..., Any])


@dataclass(frozen=True)
class Work:
    """A piece of work of a page: see `work` and `study`."""

    prepare: str
    names: tuple[str, ...]
    into: str
    marked: bool = False
    is_slow: Callable[..., bool] = lambda *_: False
    only_last: bool = True
    clears: bool = False
    start: str = ""
    busy: str = ""
    threads: "ThreadPoolExecutor | None" = None
    rest_ms: int = 0
    tab: str = ""
    only_whole: bool = False


@dataclass(frozen=True)
class Section:
    """A heading among the fields of the sidebar, and what is said beside it."""

    title: str
    aside: str = ""


@dataclass(frozen=True)
class Hint:
    """A sentence among the fields of the sidebar, with the sign that explains a term of the glossary."""

    sentence: str
    term: str


@dataclass(frozen=True)
class Own:
    """A part of the sidebar, made from the page."""

    make: Callable[[Any], Viewable]


def work(
    *names: str,
    into: str,
    marked: bool = False,
    is_slow: Callable[..., bool] = lambda *_: False,
    only_last: bool = True,
    clears: bool = False,
    tab: str = "",
) -> Callable[[Method], Method]:
    """Compute a result in a thread whenever a source changes while the page is in sight.

    The method returns a `Request`. The same request is not made twice in a row; of those that wait only the last is
    computed; results of another scenario than the present one are dropped.

    Parameters
    ----------
    *names : str
        The sources.
    into : str
        The parameter that takes the result; None where nothing is asked for.
    marked : bool
        Whether the page turns grey while it waits for it.
    is_slow : callable
        Whether a request takes seconds; called with the arguments of the request.
    only_last : bool
        Whether a result is dropped when another one has been asked for since; else it is shown until that comes.
    clears : bool
        Whether an error takes the last result away; else that stays, with the error above it.
    tab : str
        The tab that shows it, where a page has tabs: it rests while another one is open.
    """

    def decorate(prepare: Method) -> Method:
        prepare.work = Work(  # type: ignore[attr-defined]
            prepare.__name__, names, into, marked, is_slow, only_last, clears, tab=tab
        )
        return prepare

    return decorate


def study(
    *names: str,
    into: str,
    busy: str = "",
    start: str = "",
    marked: bool = False,
    threads: "ThreadPoolExecutor" = LONG_THREADS,
    rest_ms: int = 0,
    tab: str = "",
    only_whole: bool = False,
) -> Callable[[Method], Method]:
    """Compute a result step by step: the function of the method's request yields one more complete at each step.

    It begins again when a source changes, as `work` does. If an event starts it by hand, a source that changes ends
    it and takes its result away.

    Parameters
    ----------
    *names : str
        The sources.
    into, marked
        As for `work`.
    busy : str
        The parameter that is True while it is under way; setting it to False stops the study.
    start : str
        The event that starts it.
    threads : executor
    rest_ms : int
        It begins again only when no source has changed for this time [ms].
    tab
        As for `work`; a study that was started by hand goes on behind another tab.
    only_whole : bool
        Whether the page takes only the result of the last step.
    """

    def decorate(prepare: Method) -> Method:
        prepare.work = Work(  # type: ignore[attr-defined]
            prepare.__name__,
            names,
            into,
            marked,
            start=start,
            busy=busy,
            threads=threads,
            rest_ms=rest_ms,
            tab=tab,
            only_whole=only_whole,
        )
        return prepare

    return decorate


def shows(*names: str, tab: str = "") -> Callable[[Method], Method]:
    """Call a method when the page is drawn, and whenever a source changes while it is in sight.

    A method that fails is reported above the page, and the others go on. One of a tab waits until that is open.
    """

    def decorate(draw: Method) -> Method:
        draw.shown, draw.tab = names, tab  # type: ignore[attr-defined]
        return draw

    return decorate


class Page(TypedParameters, PageModel):
    """A page of the dashboard.

    A subclass names its fields in `kept`, lists in `fields` those in the sidebar, describes its figures in
    `figures` and lays them out in `layout`.

    Parameters
    ----------
    desk : Workbench
        The scenario that all pages work on, its runs and pins.
    """

    page: ClassVar[str] = ""
    """Its name, one of PAGES."""
    fields: ClassVar[tuple[str | Section | Hint | Own, ...]] = ()
    """Its part of the sidebar while it is in sight: headings, parameters, hints and parts of its own."""
    choices: ClassVar[Mapping[str, Mapping[str, Any]]] = {}
    """The choices of its selectors, by the words for them."""
    figures: ClassVar[tuple[AnyPlot, ...]] = ()
    follows_scenario: ClassVar[bool] = True
    """Whether its results belong to the scenario, and go with it."""
    works: ClassVar[tuple[Callable[..., Any], ...]] = ()
    """Further work behind it, as a `PageView` has it."""
    halves_from_px: ClassVar[int | None] = None
    """From this width of the window on, figures stand in two columns; None where there is one."""
    full_width: ClassVar[tuple[str, ...]] = ()
    """Names of figures that have the width of the page where others have halves of it."""
    rail_px: ClassVar[int] = 0
    """Width of the parts beside the figures in wide windows [px]."""

    host: "PageHost"
    """Its view, once it is drawn."""

    def __init__(self, desk: "Workbench", **params: Any) -> None:
        super().__init__(**params)
        self.desk = desk

    # ---- the description of a page

    def part(self, scenario: Scenario) -> object:
        """Return the part of a scenario that its fields begin with: an edit of it resets them."""
        return None

    def take(self, scenario: Scenario) -> None:
        """Give the fields the values of a scenario."""

    def page_run(self) -> PageRun:
        """Return the program of what it computes: for the report, the copied command and the link."""
        return PageRun(SOLVE, {"strategy": self.desk.chosen_now})

    def layout(self) -> Viewable:
        """Make the parts of the page, and return them laid out; `self.host` has its figures."""
        raise NotImplementedError

    def is_open(self, tab: str) -> bool:
        """Return whether a tab is open; a page without tabs has an empty one, which always is."""
        return not tab or tab == getattr(self, "tab", "")

    def is_shown(self, tab: str) -> bool:
        """Return whether the parts of a tab can be drawn: it is open, and they are made."""
        return self.is_open(tab)

    def goes_on(self, into: str) -> bool:
        """Return whether a study was asked for by hand, and so continues out of sight."""
        return False

    def is_over_time(self, axis: str) -> bool:
        """Return whether the shared axis of a name is one of times; else it is one of places."""
        return True

    # ---- what is known of all pages

    @classmethod
    def methods(cls, mark: str) -> Iterator[tuple[str, Any]]:
        """Yield the names of its decorated methods, in the order of the class, and what they are decorated with."""
        for kind in reversed(cls.__mro__):
            for name, method in vars(kind).items():
                # param's own attribute has the parameters under their names, which may be that of a mark
                if isinstance(method, FunctionType) and hasattr(method, mark):
                    yield name, getattr(method, mark)

    def source(self, name: str) -> tuple[param.Parameterized, list[str]]:
        """Return the object that has a source, and its parameters."""
        if name == "scenario":
            return self.desk.scenario, list(RUN_FIELDS)
        of, dot, last = name.rpartition(".")
        if not dot:
            return self, [name]
        found: Any = self
        for step in of.split("."):
            found = getattr(found, step)
        return found, [last]

    @property
    def results(self) -> tuple[str, ...]:
        """The parameters that take results."""
        return tuple(work.into for _, work in self.methods("work"))


class PageWorks(PageWork[Page]):
    """Computes what a page asks for."""

    def __init__(self, page: Page) -> None:
        self.page = page.page  # type: ignore[misc]
        super().__init__(page.desk, page)
        self.of, self.specs = page, tuple(spec for _, spec in page.methods("work"))
        self.jobs: dict[str, Any] = {}
        self._failures: dict[str, RailjouleError] = {}
        self._part: object = None
        for spec in self.specs:
            self.jobs[spec.into] = self._study(spec) if spec.threads is not None else self._worker(spec)
        # before what is asked for: another scenario, or an edit of what the fields begin with, changes the fields first
        page.desk.scenario.param.watch(self._follow_edits, "edits")
        page.desk.param.watch(self._ask_all, "page")
        if "tab" in page.param:
            page.param.watch(self._ask_all, "tab")
        for spec in self.specs:
            self._listen(spec)
        self.forget()

    def _listen(self, spec: Work) -> None:
        ask = partial(self._end_study, spec) if spec.start else partial(self._ask, spec)
        sources: dict[int, tuple[param.Parameterized, list[str]]] = {}
        for source, names in map(self.of.source, spec.names):
            sources.setdefault(id(source), (source, []))[1].extend(names)
        for source, names in sources.values():
            source.param.watch(ask, names)
        if spec.start:
            self.of.param.watch(partial(self._start, spec), spec.start)
        if spec.busy:
            self.of.param.watch(partial(self._stop_by_hand, spec), spec.busy)

    def _worker(self, spec: Work) -> Any:
        return self.worker(
            named(compute_request, spec.into),
            partial(self._take, spec),
            partial(self._fail, spec),
            marked=spec.marked,
            is_slow=lambda request: spec.is_slow(*request[1:]),
        )

    def _study(self, spec: Work) -> Any:
        assert spec.threads is not None
        return self.study(
            named(steps_of_request, spec.into),
            partial(self._take_step, spec),
            partial(self._fail_study, spec),
            marked=spec.marked,
            threads=spec.threads,
        )

    # ---- asking

    def _ask_all(self, *_: Any) -> None:
        self.rest()
        self.of.param.update(**self._change_of_failure())
        for spec in self.specs:
            if not spec.start:
                self._ask(spec)

    def rest(self) -> None:
        """Stop the studies out of sight, except for those started by hand; they begin again once they are in sight."""
        for one in self.specs:
            by_hand = one.start or self.of.goes_on(one.into)
            if self._is_seen(one) or one.threads is None or by_hand or not self.jobs[one.into].busy:
                continue
            self.jobs[one.into].stop()
            self._asked.pop(one.into, None)
            self._set_busy(one, False)

    def _is_seen(self, one: Work) -> bool:
        return self.in_sight and self.of.is_open(one.tab)

    def _ask(self, spec: Work, *_: Any) -> None:
        if not self._is_seen(spec) or self._quiet:
            return
        request = getattr(self.of, spec.prepare)()
        if not self.is_new(request, spec.into):
            return
        if request is None:
            self._failures.pop(spec.into, None)
            self.of.param.update(**{spec.into: None, **self._change_of_failure()})
            if spec.threads is not None:
                self.jobs[spec.into].stop()
            self._set_busy(spec, False)
            return
        self._set_busy(spec, True)
        if spec.rest_ms:
            self.jobs[spec.into].stop()
            self.after(spec.rest_ms, partial(self._ask_rested, spec, request))
        else:
            self.jobs[spec.into].ask(request)

    def _ask_rested(self, spec: Work, request: Request) -> None:
        """Ask for what was asked for last; a page that has left sight asks again when it returns."""
        if self._asked.get(spec.into) != request:
            return
        if self.in_sight:
            self.jobs[spec.into].ask(request)
        else:
            del self._asked[spec.into]

    def _start(self, spec: Work, *_: Any) -> None:
        request = getattr(self.of, spec.prepare)()
        if request is not None:
            self._asked[spec.into] = request
            self._set_busy(spec, True)
            self.jobs[spec.into].ask(request)

    def _end_study(self, spec: Work, *_: Any) -> None:
        """End a study that was started by hand: what it is about has changed."""
        self.jobs[spec.into].stop()
        self.of.param.update(**{spec.into: None, **({spec.busy: False} if spec.busy else {})})

    def _stop_by_hand(self, spec: Work, event: Any) -> None:
        if not event.new and self.jobs[spec.into].busy:
            self.jobs[spec.into].stop()

    def _set_busy(self, spec: Work, busy: bool) -> None:
        if spec.busy:
            setattr(self.of, spec.busy, busy)

    # ---- taking

    def _take(self, spec: Work, answer: tuple[Request, Any], **more: Any) -> None:
        request, found = answer
        asked = self._asked.get(spec.into)
        if asked is None or (spec.only_last and request != asked):
            return
        self._failures.pop(spec.into, None)
        self.of.param.update(**{spec.into: found, **self._change_of_failure(), **more})

    def _take_step(self, spec: Work, answer: tuple[Request, Any], last: bool) -> None:
        # as one change, so that parts that show both are drawn once
        if last or not spec.only_whole:
            self._take(spec, answer, **({spec.busy: False} if last and spec.busy else {}))

    def _fail(self, one: Work, failure: RailjouleError) -> None:
        # again as the last one, which is the one that is shown
        self._failures.pop(one.into, None)
        self._failures[one.into] = failure
        idle = {one.busy: False} if one.busy else {}
        self.of.param.update(**self._change_of_failure(), **idle, **({one.into: None} if one.clears else {}))

    def _fail_study(self, one: Work, failure: RailjouleError) -> None:
        # the same can be asked for once more
        self._asked.pop(one.into, None)
        self._fail(one, failure)

    @property
    def _idle(self) -> dict[str, bool]:
        return {spec.busy: False for spec in self.specs if spec.busy}

    def _change_of_failure(self) -> dict[str, RailjouleError | None]:
        """Return the last failure of what is in sight, where the page shows another one."""
        seen = {one.into for one in self.specs if self.of.is_open(one.tab)}
        last = next((failure for into, failure in reversed(self._failures.items()) if into in seen), None)
        return {} if last is self.of.failure else {"failure": last}

    # ---- another scenario

    def forget(self, *events: Any) -> None:
        """Take over another scenario: what was found or asked for of the one before goes."""
        # events come with another scenario, none where the page rests
        if not hasattr(self, "of") or (events and not self.of.follows_scenario):
            return
        super().forget()
        with self.quiet():
            self.end()
            self._failures.clear()
            self.of.param.update(failure=None, **dict.fromkeys(self.of.results), **self._idle)
            self._take_over(self.state.scenario.base)

    def _follow_edits(self, *_: Any) -> None:
        scenario = self.state.scenario.edited
        # an edit of anything else leaves what was set on the page
        if self._part != self.of.part(scenario):
            with self.quiet():
                self._take_over(scenario)

    def _take_over(self, scenario: Scenario) -> None:
        self._part = self.of.part(scenario)
        self.of.take(scenario)


def named(compute: Callable[..., Any], into: str) -> Callable[..., Any]:
    """Return a function under the name of the result that it computes: so the log calls it."""

    def computed(request: tuple[Any, ...]) -> Any:
        return compute(request)

    computed.__name__ = into
    return computed


def compute_request(request: tuple[Any, ...]) -> tuple[Request, Any]:
    """Return a request and what its function makes of its arguments."""
    function, *arguments = request
    return request, function(*arguments)


def steps_of_request(request: tuple[Any, ...]) -> Iterator[tuple[Request, Any]]:
    """Yield a request with each step of what its function makes of its arguments."""
    function, *arguments = request
    for found in function(*arguments):
        yield request, found
