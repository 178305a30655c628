import pytest

from railjoule.core import ScenarioError
from railjoule.dashboard.pages.line.work import WholeLines
from railjoule.dashboard.state.workbench import Workbench


@pytest.fixture
def state() -> Workbench:
    """A workbench whose page Line is in sight; all work is done in the test's own turn."""
    state = Workbench(page="Line")
    WholeLines(state)
    state.scenario.choose("metro-10-stations")
    return state


def test_a_line_is_run_in_three_ways(state: Workbench) -> None:
    runs = state.line.runs
    assert runs is not None
    assert list(runs.runs) == ["optimum", "proportional", "equal"]
    assert min(line.run.energy_kwh for line in runs.runs.values()) == runs.best.run.energy_kwh


def test_a_dwell_changes_the_scenario_of_every_page(state: Workbench) -> None:
    before = state.line.runs
    state.line.stations[1].dwell_s = 60.0
    assert state.scenario.scenario().line.stations[2].dwell_s == 60
    assert state.line.runs is not None
    assert before is not None
    assert state.line.runs.best.run.energy_kwh > before.best.run.energy_kwh
    state.scenario.restore()
    assert state.line.stations[1].dwell_s == 30
    assert state.line.runs.best.run.energy_kwh == pytest.approx(before.best.run.energy_kwh, rel=1e-9)


def test_an_arrival_is_fixed_where_the_optimum_has_it(state: Workbench) -> None:
    model = state.line
    assert model.runs is not None
    free = model.runs.best.run.energy_kwh
    model.stations[4].fixed = True
    assert model.runs.best.run.energy_kwh == pytest.approx(free, rel=1e-6)
    model.stations[4].arrival_s = 510.0
    assert model.runs.best.legs[4].arrival_s == pytest.approx(510, abs=1e-3)
    assert model.runs.best.run.energy_kwh > free


def test_an_arrival_that_cannot_be_kept_is_told_and_the_last_runs_stay(state: Workbench) -> None:
    model = state.line
    before = model.runs
    model.stations[4].param.update(fixed=True)
    kept = model.runs
    model.stations[4].arrival_s = 100.0
    assert isinstance(model.failure, ScenarioError)
    assert "Central" in str(model.failure)
    assert model.runs is kept
    model.stations[4].fixed = False
    assert model.failure is None
    assert model.runs is not None
    assert before is not None
    assert model.runs.best.run.energy_kwh == pytest.approx(before.best.run.energy_kwh)


def test_a_line_without_stations_has_nothing_to_share(state: Workbench) -> None:
    state.scenario.choose("liashenko-ii")
    assert state.line.runs is None
    assert state.line.failure is None


def test_nothing_is_computed_out_of_sight() -> None:
    state = Workbench(page="Drive")
    WholeLines(state)
    state.scenario.choose("metro-10-stations")
    assert state.line.runs is None
    state.page = "Line"
    assert state.line.runs is not None
