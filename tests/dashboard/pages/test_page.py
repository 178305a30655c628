"""An error of this program in one part of a page costs that part alone."""

import logging

import pytest

from railjoule.dashboard.app import Session
from railjoule.dashboard.charts.chart import NOT_DRAWN
from railjoule.dashboard.charts.run_charts import EffortChart
from railjoule.dashboard.page_host import NOT_SHOWN, PageHost
from railjoule.dashboard.pages.drive.page import Drive
from railjoule.dashboard.shell.shell import NOT_OPENED


class PlantedError(Exception):
    """An error of the program, as one that nobody foresaw."""


def fail(*_: object) -> None:
    raise PlantedError


@pytest.fixture
def session() -> Session:
    return Session()


@pytest.fixture
def traced(caplog: pytest.LogCaptureFixture) -> pytest.LogCaptureFixture:
    """The log, whose planted tracebacks can be counted."""
    caplog.set_level(logging.WARNING)
    return caplog


def planted(traced: pytest.LogCaptureFixture) -> int:
    return sum(record.exc_info is not None and record.exc_info[0] is PlantedError for record in traced.records)


def drive(session: Session) -> PageHost:
    view = session.views["Drive"]
    assert isinstance(view, PageHost)
    return view


def shown(session: Session) -> str:
    return str(drive(session).figures.object)


def test_a_page_that_is_made_late_draws_what_is_there(session: Session) -> None:
    assert "Drive" not in session.views
    session.state.page = "Drive"
    assert all(chart.is_drawn for chart in drive(session).charts if chart.host.visible)
    assert "7.8" in shown(session)


def test_a_chart_that_fails_costs_no_other(
    session: Session, monkeypatch: pytest.MonkeyPatch, traced: pytest.LogCaptureFixture
) -> None:
    with monkeypatch.context() as broken:
        broken.setattr(EffortChart, "draw", fail)
        session.state.page = "Drive"
        for travel_time_s in (180.0, 190.0):
            session.state.scenario.travel_time_s = travel_time_s
        scenes = drive(session).plots
        assert not scenes["effort"].is_drawn
        assert NOT_DRAWN.split("\u2019")[0] in scenes["effort"].host[0].object
        assert scenes["speed"].is_drawn
        assert scenes["energy"].is_drawn
        assert f"{session.state.run.travel_time_s:.1f}" in shown(session)
        assert planted(traced) == 1
    session.state.scenario.travel_time_s = 200.0
    assert drive(session).plots["effort"].is_drawn


def test_a_part_that_fails_is_told_in_one_sentence(
    session: Session, monkeypatch: pytest.MonkeyPatch, traced: pytest.LogCaptureFixture
) -> None:
    session.state.page = "Drive"
    view = drive(session)
    with monkeypatch.context() as broken:
        broken.setattr(session.state.pages["Drive"], "_show_texts", fail)
        for travel_time_s in (180.0, 190.0):
            session.state.scenario.travel_time_s = travel_time_s
        assert view._error.visible
        assert NOT_SHOWN in view._error.object
        assert planted(traced) == 1
        session.state.page = "What if"
        assert isinstance(session.views["What if"], PageHost)
        session.state.page = "Drive"
    session.state.scenario.travel_time_s = 200.0
    assert not view._error.visible
    assert "200.0" in shown(session)


def test_a_page_that_cannot_be_opened_is_tried_again(
    session: Session, monkeypatch: pytest.MonkeyPatch, traced: pytest.LogCaptureFixture
) -> None:
    with monkeypatch.context() as broken:
        broken.setattr(Drive, "layout", fail)
        for page in ("Drive", "Start", "Drive"):
            session.state.page = page
        (text,) = session.shell._made["Drive"]
        assert NOT_OPENED in text.object
        assert planted(traced) == 1
        session.state.page = "Compare"
        assert "Compare" in session.views
    session.state.page = "Drive"
    assert "7.8" in shown(session)
