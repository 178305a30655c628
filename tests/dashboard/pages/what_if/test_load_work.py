import numpy as np
import pytest

from railjoule.core import ScenarioError
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.pages.what_if.load import stop_table
from railjoule.dashboard.workbench import Workbench


@pytest.fixture(scope="module")
def state() -> Workbench:
    """A workbench whose page What if is in sight; all work is done in the test's own turn."""
    state = Workbench()
    state.scenario.choose("liashenko-0")
    PageWorks(state.pages["What if"])
    state.page = "What if"
    return state


def test_the_run_is_the_framed_cell(state: Workbench) -> None:
    model = state.pages["What if"]
    state.day.param.update(actual_load_percent=100.0, coordinate_error_m=10.0)
    cell = model.table.energy_kwh[-1, list(model.table.coordinate_error_m).index(10.0)]
    assert model.reality.following.actual.energy_kwh == pytest.approx(cell, rel=1e-12)


def test_another_reality_leaves_the_table(state: Workbench) -> None:
    model = state.pages["What if"]
    table, reality = model.table, model.reality
    state.day.coordinate_error_m = -7.0
    assert model.reality is not reality
    assert model.table is table


def test_what_the_train_knows_changes_the_table_alone(state: Workbench) -> None:
    model = state.pages["What if"]
    reality = model.reality
    model.known = "both"
    assert model.table.over_replanned == pytest.approx(np.zeros(model.table.energy_kwh.shape), abs=1e-9)
    assert model.reality is reality
    model.known = "nothing"


def test_the_table_covers_both_directions_on_request(state: Workbench) -> None:
    model = state.pages["What if"]
    for both in (True, False):
        model.both_directions = both
        assert model.table.both_directions == both


def test_a_setting_out_of_order_is_told_and_the_last_run_stays(state: Workbench) -> None:
    model = state.pages["What if"]
    reality = model.reality
    state.day.stop_sensor_m = 290.0
    assert isinstance(model.failure, ScenarioError)
    assert model.reality is reality
    state.day.stop_sensor_m = 15.0
    assert model.failure is None
    with pytest.raises(ValueError, match=r"^At most 120, the vehicle's crush load\.$"):
        state.day.parse("actual_load_percent", "121")
    assert model.table.done == model.table.energy_kwh.size


def test_the_stopping_errors_follow_the_fields_of_the_sensors(state: Workbench) -> None:
    model = state.pages["What if"]
    stops = model.stops
    state.day.sensor_deviation_m = 1.0
    assert model.stops.spread_with.deviation_m == pytest.approx(2 * stops.spread_with.deviation_m, rel=0.1)
    assert model.stops.spread_without.deviation_m == stops.spread_without.deviation_m
    text = stop_table(model.stops)
    assert words.number(model.stops.spread_with.half_width_m, 2) in text
    # an error of D3 is one of the stop, of the run in sight as of all that are drawn
    state.day.d3_error_m = 0.8
    assert model.reality.following.stop_error_m == pytest.approx(0.8, abs=1e-6)
    assert np.nanmean(model.stops.table["stop_error_m"]) == pytest.approx(0.8, abs=0.1)
    state.day.param.update(sensor_deviation_m=0.5, d3_error_m=0.0)


def test_behind_another_tab_it_rests(state: Workbench) -> None:
    model = state.pages["What if"]
    reality = model.reality
    assert model.chance is None
    assert model.rides is None
    model.tab = "events"
    assert model.rides is not None
    state.day.coordinate_error_m = 4.0
    assert model.reality is reality
    model.tab = "load"
    assert model.reality is not reality
    assert model.chance is None


def test_a_failure_of_one_tab_is_not_told_on_another(state: Workbench) -> None:
    model = state.pages["What if"]
    state.day.stop_sensor_m = 290.0
    assert isinstance(model.failure, ScenarioError)
    model.tab = "events"
    assert model.failure is None
    model.tab = "load"
    assert isinstance(model.failure, ScenarioError)
    state.day.stop_sensor_m = 15.0
    assert model.failure is None


def test_the_first_run_stops_at_the_platform() -> None:
    """Without the target curve its headline was a saving of 1.8 % by a train 14.5 m beyond the platform."""
    state = Workbench()
    PageWorks(state.pages["What if"])
    state.page = "What if"
    reality = state.pages["What if"].reality
    assert abs(reality.following.stop_error_m) < 0.05
    assert reality.following.actual.energy_kwh > (reality.replanned_kwh or 0.0)


def test_a_press_on_a_cell_sets_the_conditions(state: Workbench) -> None:
    names = [plot.name for plot in state.pages["What if"].figures]
    view = PageHost(state.pages["What if"], Browser(started=True, charts_in_sight=names), Palette(dark=False))
    chart = view.plots["heatmap"]

    class Press:
        x, y = 0.2, 3.9

    chart._press(Press)
    assert (state.day.actual_load_percent, state.day.coordinate_error_m) == (100.0, -25.0)
    assert chart.sources["frame"].data == {"x": [0.0], "y": [4.0]}
    # figures of a tab are drawn once it is first open
    assert not view.plots["ride_speed"].is_drawn
    state.pages["What if"].tab = "events"
    assert view.plots["ride_speed"].is_drawn
    assert not view._error.visible
    state.pages["What if"].tab = "load"
