"""What the work behind every page does alike: when it asks, what it drops, and when its page is marked as late.

The test takes the place of each job's computation, and records what the job delivers. A work that is added to a page is
held to the same.
"""

import threading
from itertools import cycle

import pytest
from panel.io.state import set_curdoc
from turns import PATIENCE_S, Page

from railjoule.dashboard.page_list import page_classes
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.pages.what_if.compute import compute_reality
from railjoule.dashboard.work import worker
from railjoule.dashboard.work.runs import RunsRequest, compute_runs
from railjoule.dashboard.work.worker import Worker, nobody
from railjoule.dashboard.workbench import Plans, Workbench

WORKS = [name for name, page in page_classes().items() if any(page.methods("work"))]
"""The pages that compute."""
OWN_ABOUT = {"Explore", "Learn", "Papers", "Start"}
"""What they compute is of no scenario, or belongs to the study that was begun with it."""
ONCE = {"Learn", "Start"}
"""What they ask for does not follow the sliders."""
BY_HAND = {"Papers"}
"""They ask for nothing without a press of a button; tests/dashboard/pages/papers has that."""
PRESETS = {"Drive": "tram-950m-recuperating", "Line": "metro-10-stations", "Motor": "ftorek-300s"}
GO_ON = {"Drive.further_proof", "Explore.step", "Papers.rebuilt", "What if.robust", "Start.cards"}
"""Studies that were asked for by hand, and the cards, each of which is computed once for all pages of the process."""


ON_REQUEST = {"Compare.pair", "Files.effects"}
"""Studies that a new page asks for nothing: a second scenario or a data sheet comes first. Their pages have tests."""


class Job:
    """A worker or study whose computation waits for the test; it delivers what it was asked for."""

    def __init__(self, job):
        self.job, self.asked, self.delivered = job, [], []
        self.may_go_on = threading.Event()
        self.may_go_on.set()
        if isinstance(job, Worker):
            job._compute, job._deliver, job._is_slow = self.compute, self.delivered.append, lambda _: False
        else:
            job._steps, job._deliver = self.steps, lambda result, _last: self.delivered.append(result)

    def compute(self, request):
        self.asked.append(request)
        assert self.may_go_on.wait(PATIENCE_S)
        return request

    def steps(self, request):
        yield self.compute(request)

    @property
    def is_marked(self):
        return self.job._late._mark is not nobody


class Desk:
    """A workbench with one work, out of its page's sight, that has something to ask for."""

    def __init__(self, name):
        self.state, self.page, self.name = Workbench(page="Help"), Page(), name
        if name in PRESETS:
            self.state.scenario.choose(PRESETS[name])
        self.work = Plans(self.state) if name == "Plans" else PageWorks(self.state.pages[name])
        found = {"runs": self.work.runs} if name == "Plans" else self.work.jobs
        self.jobs = {name: Job(job) for name, job in found.items()}
        self.state.day.on = True
        if name == "Drive":
            # a run whose bound can be tightened
            self.state.runs = compute_runs(RunsRequest(self.state.scenario.scenario(), ("optimal",)))
        if name == "What if":
            # tables and curves follow from these
            self.state.day.add_stop()
            page = self.state.pages["What if"]
            compute, *asked = page._rides()
            page.param.update(reality=compute_reality(*page._reality()[1:]), rides=compute(*asked))
        if name == "Files":
            page = self.state.pages["Files"]
            page.tab = "runs"
            page.try_example()
            compute, *asked = page._read()
            *_, page.reading = compute(*asked)

    @property
    def asked(self):
        return sum(len(job.asked) for job in self.jobs.values())

    def show(self, name):
        """Turn to the page, and to the tab that shows what a job computes."""
        if self.name == "What if":
            self.work.of.tab = next(one.tab for _, one in self.work.of.methods("work") if one.into == name)
        self.state.page = self.name

    def move(self):
        self.state.scenario.load_percent += 1.0

    def wait_for_timers(self):
        for timer in self.page.document.session_callbacks:
            self.page.document.remove_timeout_callback(timer)
            timer.callback()

    def take_turns(self, job):
        """Let a job end, and take the page's turns until it has."""
        job.may_go_on.set()
        running = job.job._running if isinstance(job.job, Worker) else job.job.busy
        while running or self.page.is_due:
            self.page.take_turn()
            running = job.job._running if isinstance(job.job, Worker) else job.job.busy


@pytest.fixture(params=[name for name in WORKS if name not in BY_HAND])
def desk(request):
    desk = Desk(request.param)
    yield desk
    for job in desk.jobs.values():
        job.may_go_on.set()
    desk.work.end()


def test_it_asks_while_its_page_is_in_sight_and_for_what_has_changed_meanwhile(desk):
    desk.move()
    assert desk.asked == 0
    desk.state.page = desk.name
    first = desk.asked
    assert first > 0
    desk.state.page = "Help"
    desk.move()
    assert desk.asked == first
    if desk.name not in ONCE:
        desk.state.page = desk.name
        assert desk.asked > first


@pytest.mark.parametrize("desk", [name for name in WORKS if name not in OWN_ABOUT], indirect=True)
def test_what_comes_for_a_scenario_that_has_gone_is_dropped(desk):
    for job, other in zip(desk.jobs.values(), cycle(("liashenko-0", "liashenko-ii")), strict=False):
        job.may_go_on.clear()
        with set_curdoc(desk.page.document):
            job.job.ask("of the scenario before")
            desk.state.scenario.choose(other)
        desk.take_turns(job)
        assert job.delivered == []
        with set_curdoc(desk.page.document):
            job.job.ask("of this one")
        desk.take_turns(job)
        assert set(job.delivered) == {"of this one"}


def test_studies_rest_while_nobody_sees_them(desk):
    for name, job in desk.jobs.items():
        if isinstance(job.job, Worker) or f"{desk.name}.{name}" in GO_ON | ON_REQUEST:
            continue
        desk.show(name)
        job.may_go_on.clear()
        with set_curdoc(desk.page.document):
            job.job.ask("in sight")
            desk.state.page = "Help"
        assert not job.job.busy, name
        before = desk.asked
        desk.take_turns(job)
        desk.show(name)
        assert desk.asked > before, name
        desk.state.page = "Help"


@pytest.mark.parametrize("page", ["Plans", *WORKS])
def test_a_page_is_late_until_what_it_waits_for_has_come(page, monkeypatch):
    monkeypatch.setattr(worker, "LATE_MS", 0)
    desk = Desk(page)
    for name, job in desk.jobs.items():
        if not job.is_marked:
            continue
        job.may_go_on.clear()
        with set_curdoc(desk.page.document):
            job.job.ask("late")
        assert desk.state.late == frozenset()
        desk.wait_for_timers()
        assert ("Drive" if page == "Plans" else page) in desk.state.late, name
        desk.take_turns(job)
        assert desk.state.late == frozenset()


def test_every_page_that_computes_has_a_mark_or_none_by_intent():
    """A page without one waits for nothing that a slider changes, or shows by itself how far it is."""
    marked = {name for name in WORKS if any(job.is_marked for job in Desk(name).jobs.values())}
    assert set(WORKS) - marked == {"Explore", "Learn", "Papers", "Start"}
