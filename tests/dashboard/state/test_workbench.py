from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.runs import RunsRequest, compute_runs


def test_the_chosen_strategy_is_drawn_even_if_not_ticked() -> None:
    state = Workbench(ticked=["fastest"], chosen="enoc")
    assert state.drawn == ("enoc", "fastest")


def test_where_the_chosen_strategy_refuses_the_optimum_is_shown() -> None:
    state = Workbench(chosen="eoc")
    state.runs = compute_runs(RunsRequest(state.scenario.scenario(), state.drawn))
    assert "eoc" in state.runs.refused
    assert state.run is state.runs.runs["optimal"]
