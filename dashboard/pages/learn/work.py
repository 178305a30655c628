"""The work behind the page Learn: one worker a lesson, so that no slider waits for another."""

from functools import partial
from typing import Any

from railjoule.dashboard.pages.learn.compute import LessonRequest, LessonResult, compute_lesson
from railjoule.dashboard.pages.learn.model import LESSONS, LearnModel
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
        state.param.watch(self._ask_all, "page")
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
