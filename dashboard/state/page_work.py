"""What the pieces of work behind the pages share: when they ask, what they forget, and where their errors go."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any, ClassVar, Generic, TypeVar

import panel as pn
import param
from panel.io.state import set_curdoc

from railjoule.core import RailjouleError
from railjoule.core.compiled import MODE
from railjoule.dashboard.state.page_model import PageModel
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.worker import LONG_THREADS, Study, Worker, nobody

Model = TypeVar("Model", bound=PageModel)
Request = TypeVar("Request")
Result = TypeVar("Result")


class Items:
    """Listens to the models that a list holds, to each of them once.

    Parameters
    ----------
    act : callable
        Called with each change.
    """

    def __init__(self, act: Callable[..., object]) -> None:
        self._act = act
        self._known: list[param.Parameterized] = []

    def follow(self, items: Iterable[param.Parameterized], names: Callable[[Any], Iterable[str]]) -> None:
        """Listen to those that are new, and to the named parameters of each alone."""
        # who has gone is not unwatched: a watcher is stored with its model, and goes with it
        self._known, before = list(items), self._known
        for item in self._known:
            if not any(item is known for known in before):
                item.param.watch(self._act, list(names(item)))


class PageWork(Generic[Model]):
    """The work behind one page: it asks while the page is in sight, and for nothing twice.

    Parameters
    ----------
    state : Workbench
    model : PageModel
        Holds what the page asks for, and the results.
    """

    page: ClassVar[str] = ""
    at_rest: ClassVar[Mapping[str, Any]] = {}
    """What the model says where nothing is under way."""

    def __init__(self, state: Workbench, model: Model) -> None:
        self.state, self.model = state, model
        self._studies: list[Study[Any, Any]] = []
        self._asked: dict[str, object] = {}
        # counts the ends, so that a timer of `after` that was started before one does nothing
        self._quiet, self._ends = False, 0
        # before any other watcher of the work: what is asked for next is asked for anew
        state.scenario.param.watch(self.forget, ["preset", "opened"])

    def worker(
        self,
        compute: Callable[[Request], Result],
        deliver: Callable[[Result], None],
        fail: Callable[[RailjouleError], None] | None = None,
        *,
        marked: bool = False,
        is_slow: Callable[[Request], bool] = lambda _: False,
    ) -> Worker[Request, Result]:
        """Return a worker of the page, whose results are dropped when their scenario has gone.

        Parameters
        ----------
        compute, deliver, is_slow
            As for `Worker`.
        fail : callable, optional
            Takes an error, where it is not the page's.
        marked : bool
            Whether the page is marked as late while it waits.
        """
        mark = self.state.marks(self.page) if marked else nobody
        return Worker(compute, deliver, fail or self.take_failure, mark, is_slow, self.state.scenario.identity)

    def study(
        self,
        steps: Callable[[Request], Iterator[Result]],
        deliver: Callable[[Result, bool], None],
        fail: Callable[[RailjouleError], None] | None = None,
        *,
        marked: bool = False,
        threads: ThreadPoolExecutor = LONG_THREADS,
    ) -> Study[Request, Result]:
        """Return a study of the page, which ends with it; parameters as for `worker` and `Study`."""
        mark = self.state.marks(self.page) if marked else nobody
        made = Study(steps, deliver, fail or self.take_failure, mark, threads)
        self._studies.append(made)
        return made

    @property
    def in_sight(self) -> bool:
        """Whether the page is, and the solver is compiled: what a page asks for takes minutes without."""
        return bool(self.state.page == self.page) and MODE.is_compiled

    @contextmanager
    def quiet(self) -> Iterator[None]:
        """Change the model without hearing of it; nobody else's watchers are kept from it."""
        # a quiet change may stand within another one
        before, self._quiet = self._quiet, True
        try:
            yield
        finally:
            self._quiet = before

    def is_new(self, request: object, kind: str = "") -> bool:
        """Return whether a request differs from the last one of its kind, and take it for that from now on."""
        before, self._asked[kind] = self._asked.get(kind), request
        return before != request

    def forget(self, *_: Any) -> None:
        """Forget what was asked for: what comes of it is dropped, as the scenario has gone."""
        self._asked.clear()

    def rest(self) -> None:
        """Stop the studies of a page out of sight, as they delay the page in sight; its return begins them again."""
        if any(study.busy for study in self._studies):
            self.end()
            self.forget()

    def take_failure(self, failure: RailjouleError) -> None:
        """Tell the page why a request failed."""
        self.model.param.update(failure=failure, **self.at_rest)

    def after(self, milliseconds: int, act: Callable[[], None]) -> None:
        """Act once the work was not ended for some time; without a page around it at once."""
        document, ends = pn.state.curdoc, self._ends
        if document is None:
            act()
            return

        def begin() -> None:
            if ends == self._ends:
                with set_curdoc(document):
                    act()

        document.add_timeout_callback(begin, milliseconds)

    def end(self, *_: Any) -> None:
        """End what is under way; what has come of it stands."""
        self._ends += 1
        for study in self._studies:
            study.stop()
