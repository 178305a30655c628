import re

import pytest
from lines import sent

from railjoule.dashboard.app import Session
from railjoule.dashboard.pages.compare.view import CompareView
from railjoule.dashboard.pages.compare.work import PAGE


@pytest.fixture(scope="module")
def session() -> Session:
    """A page with one pinned run, turned to Compare."""
    session = Session()
    session.state.pin()
    session.state.page = PAGE
    return session


@pytest.fixture
def view(session: Session) -> CompareView:
    view = session.views["CompareView"]
    assert isinstance(view, CompareView)
    return view


def text(markup: str) -> str:
    return " ".join(re.sub(r"<[^>]+>", " ", markup).split())


def test_all_strategies_are_run_only_while_the_page_is_in_sight(session: Session) -> None:
    state = session.state
    assert list(state.compared.runs) == ["optimal", "fastest", "phases", "bellman", "speed_limits"]
    assert set(state.compared.refused) == {"eoc", "enoc"}
    before = state.compared
    state.page = "Drive"
    state.scenario.load_percent = 60.0
    assert state.compared is before
    state.page = PAGE
    assert state.compared.scenario.vehicle.load_factor == 0.6


def test_the_table_and_the_words_follow_the_scenario(session: Session, view: CompareView) -> None:
    session.state.scenario.load_percent = 60.0
    table = text(view.table.object)
    assert "Bellman" in table
    assert "1 Optimal, 170.0 s, load 50 %, recuperation 40 %" in table
    assert "EOC: needs a line without limits." in table
    view.reference.value = "optimal"
    assert session.state.reference == "optimal"
    assert "load 50 % instead of 60 %" in text(view.differences.object)
    session.state.reference = ""


def test_the_fastest_run_does_not_press_the_energies_of_others_together(session: Session, view: CompareView) -> None:
    chart = next(chart for chart in view.compared if chart.name == "compared_energy")
    most = max(run.supply_energy_j.max() / 3.6e6 for name, run in session.state.runs.runs.items() if name != "fastest")
    assert most < chart.y_range.end < 1.5 * most
    assert len(sent(chart, "fastest")[0]) == 0
    session.state.reference = "fastest"
    assert len(sent(chart, "fastest")[0]) > 0
    session.state.reference = ""
