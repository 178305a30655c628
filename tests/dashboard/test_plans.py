import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc

from railjoule.dashboard.work.runs import FirstRuns, RunsRequest, compute_runs
from railjoule.dashboard.workbench import Plans, Workbench


@pytest.fixture
def plans() -> Plans:
    """The work of a workbench whose address has been read; it is done in the test's own turn."""
    plans = Plans(Workbench())
    plans.state.scenario.travel_time_s = 150.0
    assert plans.state.runs is None
    plans.begin()
    plans.ask()
    return plans


def test_runs_follow_the_scenario_and_what_is_drawn(plans: Plans) -> None:
    state = plans.state
    assert state.run.travel_time_s == pytest.approx(150.0, abs=1e-3)
    state.scenario.choose("ftorek-300s")
    state.ticked = ["optimal", "enoc"]
    assert list(state.runs.runs) == ["optimal", "enoc"]


def test_a_failure_keeps_the_runs(plans: Plans) -> None:
    before = plans.state.runs
    plans.state.scenario.travel_time_s = 20.0
    assert plans.state.failure is not None
    assert plans.state.runs is before
    plans.state.scenario.travel_time_s = 150.0
    assert plans.state.failure is None


def test_a_page_takes_what_another_has_computed_and_computes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("railjoule.dashboard.workbench.FIRST", FirstRuns())
    # as while a session is made, whose event loop others wait for
    with set_curdoc(Document()):
        first = Plans(Workbench())
        first.take_first()
        assert first.state.runs is None
        Plans(Workbench()).compute_first()
        second = Plans(Workbench())
        second.take_first()
        assert second.state.runs is not None


def test_the_chosen_strategy_is_drawn_even_if_not_ticked() -> None:
    assert Workbench(ticked=["fastest"], chosen="enoc").drawn == ("enoc", "fastest")


def test_where_the_chosen_strategy_refuses_the_optimum_is_shown() -> None:
    state = Workbench(chosen="eoc")
    state.runs = compute_runs(RunsRequest(state.scenario.scenario(), state.drawn))
    assert "eoc" in state.runs.refused
    assert state.run is state.runs.runs["optimal"]


def test_further_strategies_leave_what_is_shown_valid():
    state = Workbench(page="Drive")
    plans = Plans(state)
    state.runs = compute_runs(RunsRequest(state.scenario.scenario(), ("optimal",)))
    plans._mark(True)
    assert state.late == frozenset()
    state.scenario.travel_time_s += 5
    plans._mark(True)
    assert "Drive" in state.late
    plans._mark(False)
    assert state.late == frozenset()
