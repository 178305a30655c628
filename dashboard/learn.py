"""The work behind the page Learn: one worker a lesson, so that no slider waits for another."""

from functools import partial
from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.models.learn import LESSONS
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.store import LessonRequest, LessonResult, Worker, compute_lesson

PAGE = "Learn"


class Learn:
    """Asks for what the lessons of one page show, while it is in sight."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.learn
        self.workers = {lesson.name: Worker(compute_lesson, self._take, self._take_failure) for lesson in LESSONS}
        state.param.watch(self._ask_all, "page")
        for lesson in LESSONS:
            self.model.param.watch(partial(self._ask, lesson.name), lesson.name)

    def _ask_all(self, *_: Any) -> None:
        for name in self.workers:
            if name not in self.model.shown:
                self._ask(name)

    def _ask(self, name: str, *_: Any) -> None:
        if self.state.page == PAGE:
            self.workers[name].ask(LessonRequest(name, float(getattr(self.model, name))))

    def _take(self, result: LessonResult) -> None:
        self.model.param.update(shown={**self.model.shown, result.request.lesson: result}, failure=None)

    def _take_failure(self, failure: RailjouleError) -> None:
        self.model.failure = failure
