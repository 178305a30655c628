"""The work of the page without a page around it: all of it is done in the test's own turn."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from panel.io.state import set_curdoc
from turns import Page

from railjoule.core.studies.sweep import SweepTable
from railjoule.dashboard.pages.study import work
from railjoule.dashboard.pages.study.model import Brought, StudyModel
from railjoule.dashboard.pages.study.work import Studies
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.offered import OFFERED

TIME, LOAD = "timetable.travel_time_s", "vehicle.load_factor"


class Desk:
    """A workbench with the page in sight."""

    def __init__(self) -> None:
        self.state = Workbench()
        self.state.scenario.choose("liashenko-i")
        self.work = Studies(self.state)
        self.model: StudyModel = self.state.study
        self.model.take(self.state.scenario.base)
        self.model.param.update(over={TIME: [115.0, 150.0], LOAD: [0.0, 1.0]}, runs=60)
        self.state.page = "Study"

    def run(self) -> None:
        self.model.param.trigger("start")
        assert self.model.refusal == ""
        assert self.model.progress.state == "done"


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_a_study_is_run_looked_at_and_drawn(desk: Desk) -> None:
    desk.run()
    model = desk.model
    assert model.progress.done == 60
    assert model.look is not None
    assert model.look.done == 60
    assert model.look.request[:3] == (TIME, "energy_kwh", LOAD)
    assert model.drawn is not None
    drawn = model.drawn
    model.colour = "max_speed_kmh"
    assert model.look.request[2] == "max_speed_kmh"
    assert model.drawn is not drawn


def test_the_map_shows_the_fields_that_decide_most(desk: Desk) -> None:
    desk.model.over = {"line.head_wind_kmh": [0.0, 1.0], LOAD: [0.0, 1.0], TIME: [115.0, 150.0]}
    desk.run()
    assert desk.model.look is not None
    assert desk.model.look.shares is not None
    assert desk.model.map_axes() == desk.model.look.shares.fields[:2]
    assert desk.model.look.request[3:] == desk.model.look.shares.fields[:2]


def test_other_settings_are_another_study_and_the_last_one_stays_until_it_begins(desk: Desk) -> None:
    desk.run()
    first = desk.model.study
    desk.model.seed = 9
    assert desk.model.asked != desk.model.current
    assert desk.model.study is first
    desk.run()
    assert desk.model.study is not first
    assert desk.model.asked == desk.model.current


class NoRun:
    """Stands for the runs of a study: none is made."""

    def __init__(self, *_: Any) -> None:
        pass

    def begin(self) -> None:
        pass

    def stop(self) -> None:
        pass


@pytest.fixture
def page(monkeypatch: pytest.MonkeyPatch) -> Page:
    """A page whose turns the test takes, which draws in threads alone and makes no run."""
    monkeypatch.setattr(work, "beside", lambda _here, act, *arguments: act(*arguments))
    monkeypatch.setattr(work, "Running", NoRun)
    return Page()


def take_turns_until(page: Page, holds: Callable[[], bool]) -> None:
    while not holds():
        page.take_turn()


def test_results_belong_to_the_settings_that_were_asked_for(desk: Desk, page: Page) -> None:
    """Settings that change while the study is being made (dashboard.md, D1)."""
    model, asked = desk.model, desk.model.current
    with set_curdoc(page.document):
        model.param.trigger("start")
        desk.state.scenario.travel_time_s += 5
        model.param.update(runs=80, seed=7)
    take_turns_until(page, lambda: model.study is not None)
    assert model.study is not None
    assert model.study.sample == 60
    assert model.asked == asked
    assert model.asked != model.current
    # and a run of it is opened over the scenario of then
    assert desk.work._base is not None
    assert desk.work._base["travel_time_s"] == desk.state.scenario.travel_time_s - 5


def test_a_double_click_asks_once(desk: Desk, page: Page, monkeypatch: pytest.MonkeyPatch) -> None:
    made, make = [], work.make_results
    monkeypatch.setattr(desk.work.beginner, "_compute", lambda request: made.append(request) or make(request))
    with set_curdoc(page.document):
        desk.model.param.trigger("start")
        assert desk.model.progress.is_under_way
        desk.model.param.trigger("start")
    take_turns_until(page, lambda: desk.model.study is not None)
    assert len(made) == 1


def test_a_study_that_was_stopped_before_it_began_does_not(desk: Desk, page: Page) -> None:
    with set_curdoc(page.document):
        desk.model.param.trigger("start")
        desk.model.param.trigger("stop")
    page.take_turn()
    assert desk.model.study is None
    assert desk.model.progress.state == "none"


def test_a_study_that_cannot_be_begun_leaves_the_last_one(desk: Desk) -> None:
    desk.run()
    first = desk.model.study
    desk.model.over = {LOAD: [0.0, 7.0]}
    desk.model.param.trigger("start")
    assert "load_factor" in desk.model.refusal
    assert desk.model.study is first
    assert desk.model.progress.done == 60


def test_a_run_is_opened_where_the_page_has_another_scenario_by_now(desk: Desk) -> None:
    desk.run()
    table, study = desk.work.table, desk.model.study
    assert table is not None
    assert study is not None
    desk.state.scenario.choose("tram-950m")
    desk.model.wanted_run = 3
    opened = desk.state.scenario.scenario()
    assert opened.vehicle.name == study.scenario.vehicle.name
    assert opened.travel_time_s == pytest.approx(float(table.samples[TIME][3]), abs=0.06)


def test_a_row_that_is_not_there_opens_nothing(desk: Desk) -> None:
    desk.run()
    desk.model.wanted_run = 4711
    assert desk.state.page == "Study"


def saved_study(desk: Desk) -> bytes:
    """Return the file of a study as the browser fetches it."""
    desk.model.wanted_file = ".nc"
    assert desk.model.saved is not None
    assert desk.model.saved.name == "study.nc"
    file = OFFERED.take(desk.model.saved.place.removeprefix("file/"))
    assert file is not None
    content = file.path.read_bytes()
    file.drop()
    return content


def test_a_study_that_was_saved_before_its_end_goes_on(desk: Desk) -> None:
    desk.run()
    whole = desk.work.table
    assert whole is not None
    half = SweepTable(
        whole.study,
        whole.index[:40],
        {name: values[:40] for name, values in whole.samples.items()},
        {name: values[:40] for name, values in whole.columns.items()},
        {row: reason for row, reason in whole.reasons.items() if row < 40},
        1.0,
    )
    desk.work.table = half
    other = Desk()
    other.model.brought = Brought("study.nc", saved_study(desk))
    assert (other.model.progress.state, other.model.progress.done, other.model.may_go_on) == ("stopped", 40, True)
    other.model.param.trigger("resume")
    assert other.model.progress.state == "done"
    assert other.work.table is not None
    assert np.array_equal(other.work.table.columns["energy_kwh"], whole.columns["energy_kwh"], equal_nan=True)


def test_a_study_of_another_version_is_looked_at_only(desk: Desk) -> None:
    desk.run()
    content = saved_study(desk)
    version = str(desk.model.study.identity["solver"]).encode()  # type: ignore[union-attr]
    desk.model.brought = Brought("study.nc", content.replace(version, b"x" * len(version)))
    assert desk.model.refusal == ""
    assert not desk.model.may_go_on
    assert desk.model.progress.told.startswith("Another version of railjoule made its runs")


def test_a_file_without_a_study_leaves_the_one_that_is_shown(desk: Desk) -> None:
    desk.run()
    first = desk.model.study
    desk.model.brought = Brought("other.nc", b"CDF")
    assert desk.model.refusal == "other.nc does not contain a study of railjoule; a study is saved as a .nc file."
    assert desk.model.study is first
