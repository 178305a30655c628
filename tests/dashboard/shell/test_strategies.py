"""The list of strategies: rows for those with numbers, one line for those that refuse, a word for those under way."""

import re
from functools import cache

import pytest
from markup import plain

from railjoule.core import load_scenario
from railjoule.dashboard.look.theme import number_css, strategies_css
from railjoule.dashboard.shell.strategies import PLAIN_SCENARIO, StrategyList, refusal_lines
from railjoule.dashboard.work.runs import Runs, RunsRequest, compute_runs
from railjoule.dashboard.workbench import Workbench


@cache
def runs() -> Runs:
    return compute_runs(RunsRequest(load_scenario("metro-with-limit"), ("optimal", "eoc", "enoc")))


def listed(state: Workbench) -> StrategyList:
    state.param.update(ticked=["optimal", "eoc", "enoc"], runs=runs())
    return StrategyList(state)


def test_strategies_that_refuse_share_a_line_with_the_reason_and_a_scenario_that_they_take() -> None:
    shown = listed(Workbench())
    title = load_scenario(PLAIN_SCENARIO).title
    assert plain(shown.refusals) == f"EOC, ENOC: needs a line without limits. Open {title} Leave out"
    assert {"eoc", "enoc"} <= set(shown.hidden)
    shown._handle_msg({"kind": "leave"})
    assert shown.state.ticked == ["optimal"]
    assert shown.refusals == ""
    shown._handle_msg({"kind": "open"})
    assert shown.state.scenario.preset == PLAIN_SCENARIO
    # every strategy takes that one
    assert refusal_lines({}) == ""


def test_a_chosen_strategy_that_refuses_keeps_its_row() -> None:
    shown = listed(Workbench(chosen="eoc"))
    assert "eoc" not in shown.hidden
    assert plain(shown.refusals).startswith("ENOC: ")
    assert "needs a line without limits" in shown.results["eoc"]


def test_only_a_strategy_under_way_is_computing() -> None:
    state = Workbench()
    shown = listed(state)
    state.ticked = [*state.ticked, "phases"]
    assert plain(shown.results["phases"]) == "computing ..."
    assert "computing" not in shown.results["optimal"]


def test_bellman_has_a_row_where_it_is_drawn_or_the_optimum_is_not_proven() -> None:
    state = Workbench()
    shown = listed(state)
    assert runs().is_proven
    assert "bellman" in shown.hidden
    state.chosen = "bellman"
    assert "bellman" not in shown.hidden


@pytest.mark.parametrize("css", [strategies_css(), number_css()], ids=["strategies", "number"])
def test_a_component_can_be_hidden(css: str) -> None:
    # Bokeh hides a component by a rule of its host, which a later one would undo
    assert not re.search(r":host\s*\{[^}]*\bdisplay\b", css)
