"""Learn: lessons that are played, and five short ones with live figures, each of which asks for a guess first."""

from functools import partial

from panel.viewable import Viewable

from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.pages.learn.compute import LessonResult
from railjoule.dashboard.pages.learn.draw_speed import DrawSpeed
from railjoule.dashboard.pages.learn.drive_it import DriveIt
from railjoule.dashboard.pages.learn.lesson_view import HEIGHTS, LessonView
from railjoule.dashboard.pages.learn.model import GUESS_FIELDS, LESSONS, guess_field
from railjoule.dashboard.pages.learn.played_form import PlayedForm
from railjoule.dashboard.pages.learn.share_out import ShareOut
from railjoule.dashboard.pages.learn.work import Learn
from railjoule.dashboard.pages.page import PageView
from railjoule.dashboard.parts import html as parts

PAGE = "Learn"


class LearnView(PageView):
    """The page of lessons."""

    page = PAGE
    works = (Learn,)
    heights = HEIGHTS

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        self.lessons = {lesson.name: LessonView(lesson, self.state, self.palette) for lesson in LESSONS}
        self._shown: dict[str, tuple[LessonResult, bool]] = {}
        heading = parts.html_pane(
            parts.heading(
                self.page,
                "Eight lessons",
                "three to play, five to guess: then move a slider, the figures follow",
                "",
            )
        )
        self.drive_it, self.share_out = DriveIt(self.state), ShareOut(self.state)
        self.draw_speed = DrawSpeed(self.state)
        self.shows(self._show, (self.state.learn, ["shown", "failure", "lesson", *GUESS_FIELDS]))
        played = (self.drive_it, self.share_out, self.draw_speed)
        for lesson in played:
            more = ["driven"] if lesson is self.drive_it else []
            self.shows(partial(self._show_played, lesson), (self.state.learn, [lesson.result, "failure", *more]))
        return parts.stack(heading, self.message, *played, *(lesson.view for lesson in self.lessons.values()))

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return tuple(chart for lesson in self.lessons.values() for chart in lesson.charts)

    def redraw(self) -> None:
        """Draw everything again, also the lessons whose sliders have not moved."""
        self._shown = {}
        super().redraw()

    def _show_played(self, lesson: PlayedForm) -> None:
        if self.state.learn.failure is not None:
            lesson.refuse()
        lesson.show()

    def _show(self) -> None:
        learn = self.state.learn
        self.tell(learn.failure, "Shown: the last slider position that could be computed.")
        for name, lesson in self.lessons.items():
            result = learn.shown.get(name)
            lesson.ask(result)
            # compared by identity, as results are
            shown = result, getattr(learn, guess_field(name)) is not None
            if result is not None and self._shown.get(name) != shown:
                self._shown[name] = (result, shown[1])
                lesson.show(*self._shown[name])
