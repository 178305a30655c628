import numpy as np
import pytest

from railjoule.core import StrategyRefusedError, load_scenario, solve
from railjoule.dashboard.pages.trade_off.compute import TradeOffRequest, compute_trade_off


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


def test_single_points_of_enoc_agree_with_its_runs() -> None:
    scenario = load_scenario("ftorek-300s")
    trade_off = compute_trade_off(TradeOffRequest(scenario, 400.0, wide_map=False, copper_weight=1.0))
    for ramp in (None, 62.7):
        run = solve(scenario.replace(**{"enoc.acceleration_time_s": ramp}), strategy="enoc")
        point = trade_off.enoc_point(300.0, ramp)
        assert point.energy_kwh == pytest.approx(run.energy_kwh, rel=1e-3)
        assert point.max_speed_kmh == pytest.approx(run.max_speed_kmh, rel=1e-3)
    times, _, energies = trade_off.printed_points()
    # Ftorek 2025, Table 2
    assert energies[np.flatnonzero(times == 300.0)] == pytest.approx([4.407], abs=5e-4)


def test_without_enoc_there_is_a_frontier_but_no_map() -> None:
    trade_off = compute_trade_off(
        TradeOffRequest(load_scenario("liashenko-i"), 200.0, wide_map=False, copper_weight=1.0)
    )
    assert trade_off.enoc_map is None
    assert trade_off.enoc_point(200.0) is None
    assert "copper loss" in trade_off.refusal
    assert np.all(np.diff(trade_off.frontier.energy_kwh) < 0)
