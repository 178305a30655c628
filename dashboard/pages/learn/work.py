"""The work behind the page Learn: one worker a lesson, so that no slider waits for another."""

from functools import partial
from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.pages.learn.by_hand import TryRequest, TryResult, judge
from railjoule.dashboard.pages.learn.compute import LessonRequest, LessonResult, compute_lesson
from railjoule.dashboard.pages.learn.drawing import DrawingRequest, DrawingResult, judge_drawing
from railjoule.dashboard.pages.learn.model import LESSONS, LearnModel
from railjoule.dashboard.pages.learn.slack import SlackRequest, SlackResult, judge_slack
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.worker import Worker


class Learn(PageWork[LearnModel]):
    """Asks for what the lessons of one page show, while it is in sight."""

    page = "Learn"

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state.learn)
        # lessons have scenarios of their own: their results hold whatever becomes of the one beside the pages
        self.workers = {lesson.name: Worker(compute_lesson, self._take, self.take_failure) for lesson in LESSONS}
        self.judge = Worker(judge, self._take_try, self.take_failure)
        self.slack = Worker(judge_slack, self._take_slack, self._take_no_slack)
        self.drawing = Worker(judge_drawing, self._take_drawing, self._take_no_drawing)
        state.param.watch(self._ask_all, "page")
        # once kernels are compiled, the first runs come
        state.param.watch(self._open_played, ["page", "runs"])
        # the same try may come twice
        self.model.param.watch(self._judge, "finished", onlychanged=False)
        self.model.param.watch(self._judge_slack, "sharing", onlychanged=False)
        self.model.param.watch(self._judge_drawing, "sketched", onlychanged=False)
        for lesson in LESSONS:
            self.model.param.watch(partial(self._ask, lesson.name), lesson.name)

    def _ask_all(self, *_: Any) -> None:
        for name in self.workers:
            if name not in self.model.shown:
                self._ask(name)

    def _ask(self, name: str, *_: Any) -> None:
        if self.in_sight:
            self.workers[name].ask(LessonRequest(name, float(getattr(self.model, name))))

    def _take(self, result: LessonResult) -> None:
        self.model.param.update(shown={**self.model.shown, result.request.lesson: result}, failure=None)

    def _judge(self, *_: Any) -> None:
        self.judge.ask(TryRequest(self.model.finished))

    def _open_played(self, *_: Any) -> None:
        if self.in_sight and self.model.tried is None:
            self.judge.ask(TryRequest())
        if self.in_sight and self.model.slack is None:
            self.slack.ask(SlackRequest(begun=self.model.shared))
        if self.in_sight and self.model.drawing is None:
            self.drawing.ask(DrawingRequest(begun=self.model.drawn))

    def _take_try(self, result: TryResult) -> None:
        driven = result.request.commands or self.model.driven
        self.model.param.update(tried=result, driven=driven, failure=None)

    def _judge_slack(self, *_: Any) -> None:
        self.slack.ask(SlackRequest(self.model.sharing, self.model.sharing))

    def _take_slack(self, result: SlackResult) -> None:
        shared = result.request.judged or self.model.shared
        # what a link asked for in vain is told until something is judged
        told = {"failure": None} if result.request.judged else {}
        self.model.param.update(slack=result, shared=shared, **told)

    def _take_no_slack(self, failure: RailjouleError) -> None:
        self.take_failure(failure)
        if self.model.slack is None:
            self.model.shared = ""
            self.slack.ask(SlackRequest())

    def _judge_drawing(self, *_: Any) -> None:
        self.drawing.ask(DrawingRequest(self.model.sketched, self.model.sketched))

    def _take_drawing(self, result: DrawingResult) -> None:
        drawn = result.request.judged or self.model.drawn
        told = {"failure": None} if result.request.judged else {}
        self.model.param.update(drawing=result, drawn=drawn, **told)

    def _take_no_drawing(self, failure: RailjouleError) -> None:
        self.take_failure(failure)
        if self.model.drawing is None:
            self.model.drawn = ""
            self.drawing.ask(DrawingRequest())
