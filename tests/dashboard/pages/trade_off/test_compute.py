import numpy as np
import pytest

from railjoule.core import StrategyRefusedError, load_scenario, solve
from railjoule.dashboard.app import Session
from railjoule.dashboard.pages.trade_off.compute import TradeOffRequest, compute_trade_off
from railjoule.dashboard.pages.trade_off.work import Frontiers
from railjoule.dashboard.shell.sidebar import EnocField
from railjoule.dashboard.state.workbench import Workbench


def test_the_trade_off_agrees_with_single_solutions() -> None:
    scenario = load_scenario("ftorek-300s")
    trade_off = compute_trade_off(TradeOffRequest(scenario, 400.0, wide_map=False, copper_weight=1.0))
    time = trade_off.frontier.travel_time_s[30]
    single = scenario.replace(**{"timetable.travel_time_s": float(time)})
    assert trade_off.frontier.energy_kwh[30] == pytest.approx(solve(single).energy_kwh, rel=1e-4)
    assert trade_off.enoc.energy_kwh[30] == pytest.approx(solve(single, strategy="enoc").energy_kwh, rel=1e-3)
    taken = np.isfinite(trade_off.enoc.energy_kwh)
    assert np.all(trade_off.enoc.energy_kwh[taken] >= trade_off.frontier.energy_kwh[taken] * (1 - 1e-4))
    assert trade_off.enoc.refused
    for refused, _ in trade_off.enoc.refused:
        with pytest.raises(StrategyRefusedError):
            solve(scenario.replace(**{"timetable.travel_time_s": refused}), strategy="enoc")
    lowest = np.nanmin(trade_off.enoc_map.energy_kwh, axis=0)
    assert np.all(trade_off.enoc_map.best_energy_kwh <= lowest * (1 + 1e-9))


def test_without_enoc_there_is_a_frontier_but_no_map() -> None:
    trade_off = compute_trade_off(
        TradeOffRequest(load_scenario("liashenko-i"), 200.0, wide_map=False, copper_weight=1.0)
    )
    assert trade_off.enoc_map is None
    assert "copper loss" in trade_off.refusal
    assert np.all(np.diff(trade_off.frontier.energy_kwh) < 0)


@pytest.fixture
def state() -> Workbench:
    """A workbench with the work of Trade-off; all work is done in the test's own turn."""
    state = Workbench()
    Frontiers(state)
    state.scenario.choose("ftorek-300s")
    return state


def test_another_map_is_asked_for(state: Workbench) -> None:
    state.page = "Trade-off"
    near = state.trade_off.enoc_map
    state.wide_map = True
    wide = state.trade_off.enoc_map
    assert wide.travel_time_s[-1] > near.travel_time_s[-1]


def test_the_acceleration_time_is_the_best_until_it_is_set() -> None:
    session = Session()
    state = session.state
    state.scenario.choose("ftorek-300s")
    state.page = "Trade-off"
    view, enoc = session.views["TradeOffView"], EnocField(state)
    assert enoc.field.suggested == pytest.approx(31.0, abs=0.05)
    assert not enoc.best.visible
    state.scenario.acceleration_time_s = 62.7
    assert "ENOC, as set" in view.table.object
    assert enoc.best.label == "Best for 300.0 s: 31.0 s"
    enoc.best.clicks += 1
    assert state.scenario.acceleration_time_s is None
    assert "ENOC, as set" not in view.table.object


def test_a_line_with_limits_shows_its_frontier_and_why_there_is_no_enoc() -> None:
    session = Session()
    session.state.page = "Trade-off"
    view = session.views["TradeOffView"]
    assert "ENOC needs a line without limits." in view.notes.object
    assert view.frontier.host.visible
    assert not view.right.visible
