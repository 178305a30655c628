import numpy as np
import pytest

from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.charts.plot import CurveChart
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.learn.charts import PRICE, make_plane_plot, make_speed_plot, price_curves
from railjoule.dashboard.pages.learn.compute import LessonResult, compute_lesson
from railjoule.dashboard.pages.learn.lessons import LESSONS


@pytest.fixture(scope="module")
def result() -> LessonResult:
    return compute_lesson("multiplier", 200.0)


def test_the_phase_plane_marks_the_switches(result: LessonResult) -> None:
    chart = CurveChart(make_plane_plot(LESSONS[1]), 250, Palette(False))
    chart.show(lambda: chart.draw(result))
    assert chart.sources["bands"].data["top"][:2] == pytest.approx([0.0, 1 / 0.85])
    coast = next(phase for phase in result.runs["optimum"].phases if phase.phase == "coast")
    # the formula beside the run that the solver found
    assert chart.sources["marks"].data["x"][1] == pytest.approx(coast.end_ms * 3.6, rel=5e-3)


def test_the_tangent_has_the_price_as_its_slope(result: LessonResult) -> None:
    chart, frontier = CurveChart(PRICE, 200, Palette(False)), result.frontier
    assert frontier is not None
    curves, x_ends, y_ends = price_curves(result, frontier)
    chart.show(lambda: chart.draw(curves, x_ends=x_ends, y_ends=y_ends))
    x, y = chart.sources["tangent"].data["x"], chart.sources["tangent"].data["y"]
    time, energy = chart.sources["curve"].data["x"], chart.sources["curve"].data["y"]
    slope = (y[1] - y[0]) / (x[1] - x[0])
    k = int(np.searchsorted(time, 200.0))
    assert slope == pytest.approx((energy[k] - energy[k - 1]) / (time[k] - time[k - 1]), rel=0.1)


def test_a_run_that_is_to_be_guessed_is_not_in_the_figure(result: LessonResult) -> None:
    palette = Palette(False)
    chart = make_speed_plot(next(one for one in LESSONS if one.name == "multiplier")).made(Axis(palette), palette)
    first = chart.axis.columns("first").source
    chart.show(lambda: chart.draw(result, revealed=False))
    chart.axis.settle_over(False)
    assert not any(len(column) for column in first.data.values())
    assert [name for name, *_ in chart.cursor_data["sources"]] == ["with one more second"]
    chart.show(lambda: chart.draw(result))
    chart.axis.settle_over(False)
    assert max(first.data["speed"]) == pytest.approx(result.runs["optimum"].max_speed_kmh, rel=1e-6)
    chart.forget()
    assert not any(len(column) for line in chart.lines for column in chart.axis.columns(line).source.data.values())
