"""The figures of a lesson that asks for a guess, in a report: drawn as before the guess, with what comes after it."""

from functools import partial
from typing import Any

import numpy as np
from bokeh.models import Model

from railjoule.dashboard.charts.chart import Chart
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.learn.charts import LessonSpeedChart
from railjoule.dashboard.pages.learn.compute import LessonResult
from railjoule.dashboard.pages.learn.guesses import GUESSES
from railjoule.dashboard.pages.learn.lesson_view import LINES, SPEED_HEIGHTS, more_charts


class LessonCharts:
    """The figures of one lesson.

    Parameters
    ----------
    result : LessonResult
    palette : Palette
    """

    def __init__(self, result: LessonResult, palette: Palette) -> None:
        name = result.request.lesson
        self.compared = GUESSES[name].compared
        """Whether the speeds are there before the guess: of the run that the optimum is compared with."""
        self.speed = LessonSpeedChart(name, LINES[name], SPEED_HEIGHTS[0], palette)
        self.more = more_charts(name, palette)
        self._draws = [partial(chart.draw, result) for chart in self.more]
        for chart in self.charts:
            chart.build()
        self.later = self._drawn_speeds(result)
        """What a browser needs to have the optimum among the speeds, and to have it there no more."""
        self.draw_more()

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts, that of the speeds first."""
        return self.speed, *self.more

    @property
    def roots(self) -> list[Model]:
        """What Bokeh draws of each chart; the captions of those that stand alone are of the document."""
        assert self.speed.content is not None
        figures = [chart.figure for chart in self.more if chart.figure is not None]
        return [self.speed.content.object, *figures]

    def draw_more(self) -> None:
        """Draw what is for after the guess, in the colours of the palette."""
        for draw in self._draws:
            draw()

    def _drawn_speeds(self, result: LessonResult) -> dict[str, Any]:
        """Draw the speeds, the optimum's columns left empty; return these and the ends of the axis without and with."""
        chart = self.speed
        if not self.compared:
            chart.draw(result)
            return {}
        chart.draw(result, revealed=False)
        without = chart.y_range.end
        chart.draw(result)
        source, high = chart.axis.columns("first").source, chart.y_range.end
        columns = {name: np.round(np.asarray(values, dtype=float), 3).tolist() for name, values in source.data.items()}
        source.data = {name: [] for name in columns}
        chart.set_range(0, without)
        return {"source": source.id, "columns": columns, "range": chart.y_range.id, "ends": [without, high]}
