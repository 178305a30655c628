import pytest

from railjoule.core import ScenarioError
from railjoule.dashboard.state.workbench import Workbench

SHORT = {"line": {"sections": [{"length_m": 1000.0}]}, "timetable.travel_time_s": 75.0}


def test_a_scenario_that_was_left_and_is_taken_again_has_its_run_again(state: Workbench) -> None:
    state.page = "Drive"
    chosen = state.chosen
    for preset in ("liashenko-i", "ftorek-300s"):
        state.scenario.choose(preset)
    state.scenario.edit(SHORT)
    state.chosen = chosen
    assert state.pages["Motor"].run is None
    state.page = "Motor"
    assert state.pages["Motor"].run.scenario.title == state.scenario.base.title


def test_bad_limits_are_told_and_the_last_run_stays(state: Workbench) -> None:
    model = state.pages["Motor"]
    before = model.run
    model.max_current_a = 100.0
    assert isinstance(model.failure, ScenarioError)
    assert model.run is before
    model.max_current_a = 810.0
    assert model.failure is None


def test_an_edited_machine_is_taken_over_and_other_edits_leave_the_controller(state: Workbench) -> None:
    model = state.pages["Motor"]
    model.bandwidth_rads = 8.0
    state.scenario.edit({"solver.mesh_m": 4.0})
    assert model.bandwidth_rads == 8.0
    state.scenario.edit({"drive.machine.max_phase_voltage_v": 1500.0})
    assert model.max_phase_voltage_v == 1500.0
    assert model.run.voltage_limit_v == pytest.approx(1500.0)
