from typing import Any

import pytest

from railjoule.core import Scenario
from railjoule.dashboard import app
from railjoule.dashboard.app import Session
from railjoule.dashboard.server.options import ServerOptions


@pytest.fixture
def session() -> Session:
    return Session()


def test_a_page_opens_with_a_proven_optimum(session: Session) -> None:
    run = session.state.run
    assert run.strategy == "optimal"
    assert run.is_proven


def test_a_move_reads_no_file_and_makes_its_scenario_once(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    session.state.page = "Drive"
    session.state.scenario.edit({"vehicle.auxiliary_power_kw": 30.0})
    made, replace = [], Scenario.replace

    def counted(scenario: Scenario, **changes: Any) -> Scenario:
        made.append(changes)
        return replace(scenario, **changes)

    def refuse(*_: Any) -> None:
        raise AssertionError("a file was read")

    monkeypatch.setattr(Scenario, "replace", counted)
    monkeypatch.setattr("railjoule.core.scenario.document.parse_scenario", refuse)
    for time_s in (140.0, 141.0):
        session.shell.sidebar.travel_time.value = time_s
        assert session.state.runs.scenario.travel_time_s == time_s
    assert [changes["timetable.travel_time_s"] for changes in made] == [140.0, 141.0]


def test_pages_share_nothing() -> None:
    one, other = Session(), Session()
    one.state.scenario.load_percent = 77.0
    assert other.state.scenario.load_percent != 77.0


@pytest.mark.parametrize(
    ("link", "at_once"),
    [
        ("", True),
        ("?v=1&preset=tram-950m&travel_time_s=95", True),
        ("?v=1&ticked=optimal,bellman", False),
        ('?v=1&edits={"solver.mesh_m":0.25}', False),
    ],
)
def test_only_short_runs_of_shipped_scenarios_are_waited_for(
    monkeypatch: pytest.MonkeyPatch, link: str, at_once: bool
) -> None:
    monkeypatch.setattr("railjoule.dashboard.app.address_query", lambda: link)
    monkeypatch.setattr("panel.state.onload", lambda _: None)
    assert (Session().state.runs is not None) == at_once


@pytest.mark.parametrize(
    ("address", "told"), [("127.0.0.1", False), ("::1", False), ("0.0.0.0", True), ("192.0.2.7", True)]
)
def test_a_server_that_others_reach_says_that_there_is_no_login(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, address: str, told: bool
) -> None:
    monkeypatch.setattr(app.events, "write_down", lambda: None)
    monkeypatch.setattr(app, "make_server", lambda _: None)
    monkeypatch.setattr(app, "run", lambda _: None)
    app.serve(ServerOptions(address=address))
    assert ("There is no login" in caplog.text) is told
