"""Studies without a page around them: everything is done in the test's own turn."""

import threading
from collections.abc import Callable
from typing import Any

import numpy as np
import param
import pytest
from panel.io.state import set_curdoc
from turns import Page

from railjoule.core import load_scenario
from railjoule.core.studies.sweep import SweepTable
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.pages.explore import compute
from railjoule.dashboard.pages.explore import study as studies
from railjoule.dashboard.pages.explore.compute import table_file
from railjoule.dashboard.pages.explore.fields import MOST_VARIED, fields_that_vary
from railjoule.dashboard.pages.explore.page import Explore
from railjoule.dashboard.pages.explore.ranges import InputRanges, Span
from railjoule.dashboard.pages.explore.running import Progress, Step
from railjoule.dashboard.work.study_pool import STUDY_THREADS
from railjoule.dashboard.workbench import Workbench

TIME, LOAD = "timetable.travel_time_s", "vehicle.load_factor"
RUNS, DONE = 24, 16
METRO = load_scenario("metro-with-limit")


class Desk:
    """A workbench with the page in sight."""

    def __init__(self) -> None:
        self.state = Workbench()
        self.state.scenario.choose("liashenko-i")
        self.model: Explore = self.state.pages["Explore"]
        self.work = PageWorks(self.model)
        self.model.param.update(over={TIME: [115.0, 150.0], LOAD: [0.0, 1.0]}, runs=RUNS)
        self.state.page = "Explore"

    def run(self) -> None:
        self.model.begin()
        assert self.model.refusal == ""
        assert self.model.progress.state == "done"

    @property
    def table(self) -> SweepTable:
        assert self.model.table is not None
        return self.model.table


@pytest.fixture(autouse=True)
def _short_preview(monkeypatch: pytest.MonkeyPatch) -> None:
    """Previews end with their first runs; tests/dashboard/pages/explore/test_compute.py has whole ones."""
    monkeypatch.setattr(compute, "PREVIEW_S", 0.0)
    monkeypatch.setattr(compute, "MOST_PREVIEW_S", 0.0)


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_a_preview_is_there_before_the_first_run(desk: Desk) -> None:
    assert desk.model.table is None
    assert desk.model.look.table.done == desk.model.preview.table.rows > 0  # type: ignore[union-attr]
    before = desk.model.look
    desk.model.over = {LOAD: [0.0, 0.5], TIME: [115.0, 150.0]}
    assert desk.model.look is not before
    assert desk.model.look.table.columns[LOAD].range == (0.0, 0.5)


def test_a_study_is_run_and_looked_at(desk: Desk) -> None:
    desk.run()
    model = desk.model
    assert model.progress.done == RUNS
    assert model.look.table.done == RUNS
    assert (*model.look.axes, model.look.asked.colour) == (TIME, "energy_kwh", LOAD)
    model.colour = "max_speed_kmh"
    assert model.look.asked.colour == "max_speed_kmh"
    model.select({TIME: (120.0, 130.0)})
    model.select({LOAD: (0.0, 0.5)})
    assert model.choice == {TIME: (120.0, 130.0), LOAD: (0.0, 0.5)}
    assert 0 < model.look.chosen < RUNS / 2


def test_the_map_shows_the_inputs_that_decide_most(desk: Desk) -> None:
    # fewer runs show no input that decides
    desk.model.param.update(over={"line.head_wind_kmh": [0.0, 1.0], LOAD: [0.0, 1.0], TIME: [115.0, 150.0]}, runs=60)
    desk.run()
    look, shares = desk.model.look, desk.model.shares
    assert shares.fields
    assert (look.asked.map_x, look.asked.map_y) == shares.fields[:2]


def test_other_settings_are_another_study_and_the_last_one_stays_until_it_begins(desk: Desk) -> None:
    desk.run()
    first = desk.model.shown_study
    desk.model.seed = 9
    assert desk.model.asked != desk.model.settings
    assert desk.model.shown_study is first
    desk.run()
    assert desk.model.shown_study is not first
    assert desk.model.asked == desk.model.settings


def test_a_study_goes_on_under_another_scenario_and_the_ranges_are_those_of_it(desk: Desk) -> None:
    desk.run()
    table = desk.model.table
    desk.state.scenario.choose("tram-950m")
    assert desk.model.table is table
    assert desk.model.over[TIME] != [115.0, 150.0]


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch) -> Page:
    """A page whose turns the test takes, in which no run is made."""

    def steps(sweep: Any, _stop: Any, _here: bool) -> Any:
        yield Step(sweep, Progress("done", 0, sweep.study.sample), sweep.to_table())

    monkeypatch.setattr(studies, "run_in_steps", steps)
    return Page()


def take_turns_until(page: Page, holds: Callable[[], bool]) -> None:
    while not holds():
        page.take_turn()


def test_results_belong_to_the_settings_that_were_asked_for(desk: Desk, page: Page) -> None:
    """Settings that change once a study was begun (dashboard.md, D1)."""
    model, asked = desk.model, desk.model.settings
    with set_curdoc(page.document):
        model.begin()
        desk.state.scenario.travel_time_s += 5
        model.param.update(runs=RUNS + 1, seed=7)
    take_turns_until(page, lambda: model.progress.state == "done")
    assert model.shown_study.sample == RUNS
    assert model.asked == asked
    assert model.asked != model.settings
    # and a run of it is opened over the scenario of then
    assert model._base["travel_time_s"] == desk.state.scenario.travel_time_s - 5


def test_a_double_click_begins_once(desk: Desk, page: Page) -> None:
    with set_curdoc(page.document):
        desk.model.begin()
        assert desk.model.progress.state == "waiting"
        first = desk.model.sweep
        desk.model.begin()
        desk.model.go_on()
    assert desk.model.sweep is first
    take_turns_until(page, lambda: desk.model.progress.state == "done")


def test_a_study_that_is_stopped_while_it_waits_has_no_run(desk: Desk, page: Page) -> None:
    go_on = threading.Event()
    STUDY_THREADS.submit(go_on.wait)
    try:
        with set_curdoc(page.document):
            desk.model.begin()
            assert desk.model.progress.state == "waiting"
            desk.model.stop()
        assert desk.model.progress.state == "stopped"
    finally:
        go_on.set()


def test_the_last_steps_of_a_study_that_was_replaced_are_dropped(desk: Desk) -> None:
    desk.run()
    late = Step(desk.model.sweep, Progress("stopping", 1, RUNS))  # type: ignore[arg-type]
    desk.model.brought = ("study.nc", table_file(desk.table, ".nc").getvalue())
    desk.model.step = late
    assert desk.model.progress.state == "done"


def test_a_study_that_cannot_be_begun_leaves_the_last_one(desk: Desk) -> None:
    desk.run()
    first = desk.model.shown_study
    desk.model.over = {LOAD: [0.0, 7.0]}
    desk.model.begin()
    assert "load_factor" in desk.model.refusal
    assert desk.model.shown_study is first
    assert desk.model.progress.done == RUNS


def test_a_run_is_opened_over_the_scenario_of_the_study(desk: Desk) -> None:
    desk.run()
    desk.model.open_run(3)
    assert desk.state.page == "Drive"
    assert desk.state.scenario.travel_time_s == pytest.approx(float(desk.table.samples[TIME][3]))
    assert desk.state.scenario.load_percent == pytest.approx(100 * float(desk.table.samples[LOAD][3]))


def test_a_run_is_opened_where_the_page_has_another_scenario_by_now(desk: Desk) -> None:
    desk.run()
    table = desk.table
    desk.state.scenario.choose("tram-950m")
    desk.model.open_run(3)
    opened = desk.state.scenario.scenario()
    assert opened.vehicle.name == table.study.scenario.vehicle.name
    assert opened.travel_time_s == pytest.approx(float(table.samples[TIME][3]), abs=0.06)


def test_a_row_that_is_not_there_opens_nothing(desk: Desk) -> None:
    desk.run()
    desk.model.open_run(4711)
    assert desk.state.page == "Explore"


def test_a_study_that_was_saved_before_its_end_goes_on(desk: Desk) -> None:
    desk.run()
    whole = desk.table
    half = SweepTable(
        whole.study,
        whole.index[:DONE],
        {name: values[:DONE] for name, values in whole.samples.items()},
        {name: values[:DONE] for name, values in whole.columns.items()},
        {row: reason for row, reason in whole.reasons.items() if row < DONE},
        1.0,
    )
    other = Desk()
    other.model.brought = ("study.nc", table_file(half, ".nc").getvalue())
    assert (other.model.progress.state, other.model.progress.done, other.model.may_go_on) == ("stopped", DONE, True)
    # its scenario is another one than that of the page
    assert other.model.shown_study is not None
    other.model.go_on()
    assert other.model.progress.state == "done"
    assert np.array_equal(other.table.columns["energy_kwh"], whole.columns["energy_kwh"], equal_nan=True)


def test_a_study_of_another_version_is_looked_at_only(desk: Desk) -> None:
    desk.run()
    content = table_file(desk.table, ".nc").getvalue()
    version = str(desk.table.study.identity["solver"]).encode()
    desk.model.brought = ("study.nc", content.replace(version, b"x" * len(version)))
    assert desk.model.refusal == ""
    assert not desk.model.may_go_on
    assert desk.model.progress.message == "Computed by another version of railjoule: read-only."


def test_a_file_without_a_study_leaves_the_one_that_is_shown(desk: Desk) -> None:
    desk.run()
    first = desk.model.shown_study
    desk.model.brought = ("other.nc", b"CDF")
    assert desk.model.refusal == "other.nc does not contain a study of railjoule; a study is saved as a .nc file."
    assert desk.model.shown_study is first


def test_the_draws_of_another_page_take_the_place_of_a_study_until_they_are_closed(desk: Desk) -> None:
    desk.run()
    look = desk.model.look
    desk.model.select({TIME: (120.0, 130.0)})
    desk.state.turn_to("Explore", draws=look.table)
    assert desk.state.page == "Explore"
    assert desk.model.rows is look.table
    assert desk.model.choice == {}
    assert desk.model.shares is None
    desk.model.open_run(3)
    assert desk.state.page == "Explore"
    desk.model.draws = None
    assert desk.model.rows is desk.model.table


# ---- ranges


@pytest.fixture
def taken() -> list[Any]:
    return []


def test_the_ends_of_a_range_are_typed_as_people_write_numbers(taken: list[Any]) -> None:
    span = Span(taken.append, fields_that_vary(METRO)[TIME])
    span.set(173.0, 238.0)
    assert taken == []
    assert span.parse_or_none("high", "1\u202f000,5") == 1000.5
    assert span.parse_or_none("low", "2:55") == 175.0
    span.low = 175.0
    assert taken == [(175.0, 238.0)]


@pytest.mark.parametrize(
    ("path", "end", "text", "sentence"),
    [
        (LOAD, "high", "7", "At most"),
        (LOAD, "low", "-1", "At least"),
        (LOAD, "low", "much", "Not a number."),
        (LOAD, "low", "", "Not a number."),
        (LOAD, "low", "0.9", "The range 0.9 to 0.5 begins above its end."),
        (TIME, "low", "soon", "is not a time"),
    ],
)
def test_a_wrong_end_is_refused_in_a_sentence(path: str, end: str, text: str, sentence: str) -> None:
    span = Span(lambda _: None, fields_that_vary(METRO)[path])
    span.set(0.1, 0.5)
    with pytest.raises(ValueError, match=sentence):
        span.parse_or_none(end, text)


def test_an_end_of_a_selection_may_be_empty(taken: list[Any]) -> None:
    span = Span(taken.append)
    assert span.parse_or_none("low", " ") is None
    span.set(1.0, 2.0)
    span.low = None
    assert taken == [(None, 2.0)]


def test_a_selection_is_typed_and_may_be_open_at_one_end(desk: Desk) -> None:
    desk.run()
    desk.model._take_span("x", (120.0, None))
    assert desk.model.choice == {TIME: (120.0, np.inf)}
    assert 0 < desk.model.look.chosen < RUNS
    desk.model._take_span("x", (None, None))
    assert desk.model.choice == {}


def test_inputs_are_added_and_removed_by_their_names(desk: Desk) -> None:
    ranges = InputRanges(desk.model)
    assert list(ranges.rows) == [TIME, LOAD]
    assert ranges.rows[LOAD].slider.value == (0.0, 1.0)
    ranges.inputs.value = [LOAD, "vehicle.tare_kg"]
    assert list(desk.model.over) == [LOAD, "vehicle.tare_kg"]
    assert list(ranges.rows) == [LOAD, "vehicle.tare_kg"]
    with param.edit_constant(ranges.rows[LOAD].slider):
        ranges.rows[LOAD].slider.value_throttled = (0.25, 0.5)
    assert desk.model.over[LOAD] == [0.25, 0.5]
    desk.model.over = {LOAD: [0.0, 0.5]}
    assert (ranges.rows[LOAD].span.low, ranges.inputs.value) == (0.0, [LOAD])
    assert ranges.inputs.max_items == MOST_VARIED


@pytest.mark.parametrize(
    "over", [{LOAD: 3}, {LOAD: [1]}, {LOAD: [0, "1"]}, {LOAD: [0, float("nan")]}, {f"x{k}": [0, 1] for k in range(9)}]
)
def test_the_ranges_of_a_link_are_checked(desk: Desk, over: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="must have"):
        desk.model.checked("over", over)
    assert desk.model.checked("over", {LOAD: [0, 1]}) == {LOAD: [0, 1]}
