"""A page as one class: its fields and results are parameters, `@work` computes results, `@shows` draws them.

    class Speeds(Page):
        page = "Speeds"
        kept = ("factor",)
        factor = keyed(SomeOptions, "factor", "Factor", digits=2)
        table = result(Table, "The latest result.")

        @work("scenario", "factor", into="table")
        def _table(self) -> Request:
            return compute_table, self.desk.scenario.scenario(), self.factor

        def layout(self) -> Viewable:
            return html_pane(...)

        @shows("table")
        def _show(self) -> None: ...

A name of a source is a parameter of the page (`factor`), one of the desk (`desk.chosen`), or `scenario`: all that a run
depends on. `PageWorks` computes what pages ask for, in threads, while they are in sight; `PageHost` draws them.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from types import FunctionType
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import param
from panel.viewable import Viewable

from railjoule.core import RailjouleError, Scenario
from railjoule.dashboard.charts.plot import AnyPlot
from railjoule.dashboard.look.theme import padded
from railjoule.dashboard.state.kept import result
from railjoule.dashboard.state.numbers import TypedParameters
from railjoule.dashboard.state.recipes import SOLVE, PageRun
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.work.worker import LONG_THREADS

if TYPE_CHECKING:
    from concurrent.futures import ThreadPoolExecutor

    from railjoule.dashboard.page_host import PageHost
    from railjoule.dashboard.page_work import PageWorks
    from railjoule.dashboard.parts.tabs import PageTabs
    from railjoule.dashboard.workbench import Workbench

BODY_CSS = padded("4px 20px 0 14px", "4px 10px 0 6px")
"""Of charts that take the whole width of a page."""
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


class Page(TypedParameters):
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
    halves_from_px: ClassVar[int | None] = None
    """From this width of the window on, figures stand in two columns; None where there is one."""
    full_width: ClassVar[tuple[str, ...]] = ()
    """Names of figures that have the width of the page where others have halves of it."""
    rail_px: ClassVar[int] = 0
    """Width of the parts beside the figures in wide windows [px]."""

    failure = result(RailjouleError, "Why the last request failed.")

    tabs: "PageTabs"
    """Its tabs, where it has any."""
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

    def begin_work(self, works: "PageWorks") -> None:
        """Begin work that no change of a source asks for, with workers of `works`."""

    def layout(self) -> Viewable:
        """Make the parts of the page, and return them laid out; `self.host` has its figures."""
        raise NotImplementedError

    def is_open(self, tab: str) -> bool:
        """Return whether a tab is open; a page without tabs has an empty one, which always is."""
        return not tab or tab == getattr(self, "tab", "")

    def is_shown(self, tab: str) -> bool:
        """Return whether the parts of a tab can be drawn: it is open, and they are made."""
        return self.is_open(tab) and (not tab or self.tabs.is_made(tab))

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

    def sources(self, names: Iterable[str]) -> list[tuple[param.Parameterized, list[str]]]:
        """Return the objects that have some sources, each once with its parameters."""
        found: dict[int, tuple[param.Parameterized, list[str]]] = {}
        for name in names:
            of, _, last = name.rpartition(".")
            source: Any = self
            for step in of.split(".") if of else ():
                source = getattr(source, step)
            last_ones = [last]
            if name == "scenario":
                source, last_ones = self.desk.scenario, list(RUN_FIELDS)
            found.setdefault(id(source), (source, []))[1].extend(last_ones)
        return list(found.values())

    @property
    def results(self) -> tuple[str, ...]:
        """The parameters that take results."""
        return tuple(work.into for _, work in self.methods("work"))
