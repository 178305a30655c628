import numpy as np
import pytest

from railjoule.core import ScenarioError
from railjoule.dashboard.charts.chart import Axis
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.robustness.robust_section import RobustSection
from railjoule.dashboard.pages.robustness.stop_table import stop_table
from railjoule.dashboard.pages.robustness.work import Robustness
from railjoule.dashboard.state.workbench import Workbench


@pytest.fixture(scope="module")
def state() -> Workbench:
    """A workbench whose page Robustness is in sight; all work is done in the test's own turn."""
    state = Workbench()
    state.scenario.choose("liashenko-0")
    Robustness(state)
    state.page = "Robustness"
    return state


def test_the_run_is_the_framed_cell(state: Workbench) -> None:
    model = state.robustness
    state.day.param.update(actual_load_percent=100.0, coordinate_error_m=10.0)
    cell = model.table.energy_kwh[-1, list(model.table.coordinate_error_m).index(10.0)]
    assert model.reality.following.actual.energy_kwh == pytest.approx(cell, rel=1e-12)


def test_another_reality_leaves_table_and_chance(state: Workbench) -> None:
    model = state.robustness
    table, chance, reality = model.table, model.chance, model.reality
    state.day.coordinate_error_m = -7.0
    assert model.reality is not reality
    assert model.table is table
    assert model.chance is chance


def test_what_the_train_knows_changes_the_table_alone(state: Workbench) -> None:
    model = state.robustness
    chance, reality = model.chance, model.reality
    model.knows = "both"
    assert model.table.over_replanned == pytest.approx(np.zeros(model.table.energy_kwh.shape), abs=1e-9)
    assert model.chance is chance
    assert model.reality is reality
    model.knows = "nothing"


def test_the_table_covers_both_directions_on_request(state: Workbench) -> None:
    model = state.robustness
    for both in (True, False):
        model.both_directions = both
        assert model.table.both_directions == both


def test_a_setting_out_of_order_is_told_and_the_last_run_stays(state: Workbench) -> None:
    model = state.robustness
    reality = model.reality
    state.day.stop_sensor_m = 290.0
    assert isinstance(model.failure, ScenarioError)
    assert model.reality is reality
    state.day.stop_sensor_m = 15.0
    assert model.failure is None
    with pytest.raises(ValueError, match=r"^At most 120, the vehicle's crush load\.$"):
        state.day.parse("actual_load_percent", "121")
    assert model.table.done == model.table.energy_kwh.size


def test_another_seed_draws_anew(state: Workbench) -> None:
    model = state.robustness
    before = model.chance.energy_kwh
    state.day.seed = 5
    assert not np.array_equal(model.chance.energy_kwh, before)


def test_the_stopping_errors_follow_the_fields_of_the_sensors(state: Workbench) -> None:
    model = state.robustness
    stops, chance = model.stops, model.chance
    state.day.sensor_deviation_m = 1.0
    assert model.stops.spread_with.deviation_m == pytest.approx(2 * stops.spread_with.deviation_m, rel=0.1)
    assert model.stops.spread_without.deviation_m == stops.spread_without.deviation_m
    assert model.chance is not chance
    text = stop_table(model.stops)
    assert words.number(model.stops.spread_with.half_width_m, 2) in text
    # an error of D3 is one of the stop, of the run in sight as of all that are drawn
    state.day.d3_error_m = 0.8
    assert model.reality.following.stop_error_m == pytest.approx(0.8, abs=1e-6)
    assert model.stops.spread_with.mean_m == pytest.approx(0.8, abs=0.1)
    state.day.param.update(sensor_deviation_m=0.5, d3_error_m=0.0)


def test_a_robust_plan_is_found_on_request_and_goes_with_its_settings(
    state: Workbench, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("railjoule.dashboard.pages.robustness.work.ROBUST_RUNS", 300)
    model = state.robustness
    section = RobustSection(Axis(Palette(dark=False)), Palette(dark=False), "")
    model.param.update(probability_percent=80.0, candidates=4)
    assert model.robust is None
    model.param.trigger("find_robust")
    found = model.robust.found
    assert not model.searching
    assert len(found.candidates) == 5
    assert found.checked[1].runs == 300
    assert found.checked[1].share_on_time > found.checked[0].share_on_time
    section.show(model.robust)
    section.speed.draw(found)
    section.candidates.draw(found)
    assert section.view.visible
    share = words.share(found.checked[1].share_on_time)
    assert f"the robust plan is on time in {share} %: enough." in section.text.object
    assert section.candidates.sources["robust"].data["x"] == [100 * found.chosen.drawn.share_on_time]
    # another position error is that of the run above, and not of the draws
    state.day.coordinate_error_m = 3.0
    assert model.robust.found is found
    model.probability_percent = 99.0
    assert model.robust is None
    model.param.trigger("find_robust")
    assert model.robust.refusal.startswith("probability = 0.99 is reached by none of 5 plans")
    assert model.failure is None
    section.show(model.robust)
    assert "is reached by none of 5 plans" in section.text.object
    state.day.seed = 6
    section.show(model.robust)
    assert not section.view.visible
