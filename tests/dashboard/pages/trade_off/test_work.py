import pytest

from railjoule.dashboard.pages.trade_off.work import Frontiers
from railjoule.dashboard.state.workbench import Workbench


@pytest.fixture
def state() -> Workbench:
    """A workbench with the work of Trade-off; all work is done in the test's own turn."""
    state = Workbench()
    Frontiers(state)
    state.scenario.choose("ftorek-300s")
    return state


def test_the_frontier_follows_the_scenario_while_its_page_is_in_sight(state: Workbench) -> None:
    assert state.trade_off is None
    state.page = "Trade-off"
    first = state.trade_off
    assert first is not None
    assert state.trade_off_duration_s > 0
    state.scenario.recuperation_percent = 90.0
    assert state.trade_off is not first
    state.page, second = "Drive", state.trade_off
    state.scenario.recuperation_percent = 10.0
    assert state.trade_off is second


def test_another_map_is_asked_for(state: Workbench) -> None:
    state.page = "Trade-off"
    near = state.trade_off.enoc_map
    state.wide_map = True
    wide = state.trade_off.enoc_map
    assert wide.travel_time_s[-1] > near.travel_time_s[-1]
