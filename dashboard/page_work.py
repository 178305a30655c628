"""Computes what a page asks for, in threads, while it is in sight; draws nothing."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import panel as pn
from panel.io.state import set_curdoc

from railjoule.core import RailjouleError, Scenario
from railjoule.core.compiled import MODE
from railjoule.dashboard.page import Page, Request, Work
from railjoule.dashboard.work.worker import LONG_THREADS, Study, Worker, nobody, nothing


class PageWorks:
    """The work behind one page: it asks while the page is in sight, and for nothing twice."""

    def __init__(self, page: Page) -> None:
        self.of, self.desk, self.specs = page, page.desk, tuple(spec for _, spec in page.methods("work"))
        self.jobs: dict[str, Any] = {}
        """Workers and studies, by the results that they compute."""
        self._asked: dict[str, object] = {}
        self._failures: dict[str, RailjouleError] = {}
        self._part: object = None
        # counts the ends, so that a timer of `after` that was started before one does nothing
        self._quiet, self._ends = False, 0
        # first of all watchers: what is asked for next is asked for again
        self.desk.scenario.param.watch(self.forget, ["preset", "opened"])
        for spec in self.specs:
            self.jobs[spec.into] = self._study(spec) if spec.threads is not None else self._worker(spec)
        # before what is asked for: another scenario, or an edit of what the fields begin with, changes the fields first
        self.desk.scenario.param.watch(self._follow_edits, "edits")
        self.desk.param.watch(self._ask_all, "page")
        if "tab" in page.param:
            page.param.watch(self._ask_all, "tab")
        for spec in self.specs:
            self._listen(spec)
        page.begin_work(self)
        self.forget()

    def worker(
        self,
        name: str,
        compute: Callable[[Any], Any],
        deliver: Callable[[Any], None],
        fail: Callable[[RailjouleError], None],
        *,
        marked: bool = False,
        is_slow: Callable[[Any], bool] = lambda _: False,
    ) -> Worker[Any, Any]:
        """Return a worker of the page, whose results are dropped when their scenario has gone.

        Parameters
        ----------
        name : str
            The key in `jobs`.
        compute, deliver, fail, is_slow
            As for `Worker`.
        marked : bool
            Whether the page turns grey while it waits.
        """
        # a study of another scenario stays on its page, which asks for the same figures only once
        about = self.desk.scenario.identity if self.of.follows_scenario else nothing
        made = Worker(compute, deliver, fail, self._mark(marked), is_slow, about)
        self.jobs[name] = made
        return made

    def _worker(self, spec: Work) -> Worker[Any, Any]:
        return self.worker(
            spec.into,
            named(compute_request, spec.into),
            partial(self._take, spec),
            partial(self._fail, spec),
            marked=spec.marked,
            is_slow=lambda request: spec.is_slow(*request[1:]),
        )

    def _study(self, spec: Work) -> Study[Any, Any]:
        steps, take, fail = (
            named(steps_of_request, spec.into),
            partial(self._take_step, spec),
            partial(self._fail_study, spec),
        )
        return Study(steps, take, fail, self._mark(spec.marked), spec.threads or LONG_THREADS)

    def _mark(self, marked: bool) -> Callable[[bool], None]:
        return self.desk.marks(self.of.page) if marked else nobody

    def _listen(self, spec: Work) -> None:
        ask = partial(self._end_study, spec) if spec.start else partial(self._ask, spec)
        for source, names in self.of.sources(spec.names):
            source.param.watch(ask, names)
        if spec.start:
            self.of.param.watch(partial(self._start, spec), spec.start)
        if spec.busy:
            self.of.param.watch(partial(self._stop_by_hand, spec), spec.busy)

    @property
    def in_sight(self) -> bool:
        """Whether the page is, and the solver is compiled: what a page asks for takes minutes without."""
        return bool(self.desk.page == self.of.page) and MODE.is_compiled

    @contextmanager
    def quiet(self) -> Iterator[None]:
        """Change the page without hearing of it; nobody else's watchers are kept from it."""
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

    def after(self, milliseconds: int, act: Callable[[], None]) -> None:
        """Act once the work was not ended for some time; without a page around it immediately."""
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
        """End the studies under way; what has come of them stands."""
        self._ends += 1
        for job in self.jobs.values():
            if isinstance(job, Study):
                job.stop()

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
        # events come with another scenario, none at the beginning
        if events and not self.of.follows_scenario:
            return
        self._asked.clear()
        with self.quiet():
            self.end()
            self._failures.clear()
            self.of.param.update(failure=None, **dict.fromkeys(self.of.results), **self._idle)
            self._take_over(self.desk.scenario.base)

    def _follow_edits(self, *_: Any) -> None:
        scenario = self.desk.scenario.edited
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
