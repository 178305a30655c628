"""The work behind the page Trade-off: what is asked for when, and where its results go."""

from typing import Any

from railjoule.dashboard.pages.trade_off.compute import TradeOff, TradeOffRequest, compute_trade_off
from railjoule.dashboard.state.page_work import PageWork
from railjoule.dashboard.state.workbench import Workbench


class Frontiers(PageWork[Workbench]):
    """Asks for the frontier, and for ENOC's map, while their page is in sight."""

    page = "Trade-off"

    def __init__(self, state: Workbench) -> None:
        super().__init__(state, state)
        self.trade_off = self.worker(compute_trade_off, self._take, marked=True)
        state.scenario.param.watch(self._ask, ["load_percent", "recuperation_percent", "edits", "travel_time_range_s"])
        state.param.watch(self._ask, ["page", "wide_map", "copper_weight"])

    def _ask(self, *_: Any) -> None:
        if self.in_sight:
            state, scenario = self.state, self.state.scenario
            longest_s = scenario.travel_time_range_s[1]
            request = TradeOffRequest(scenario.scenario(), longest_s, state.wide_map, state.copper_weight)
            self.trade_off.ask(request)

    def _take(self, trade_off: TradeOff) -> None:
        self.state.param.update(trade_off=trade_off, trade_off_duration_s=self.trade_off.last_duration_s)
