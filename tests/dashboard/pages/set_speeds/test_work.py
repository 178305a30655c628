import numpy as np
import pytest

from railjoule.core import ScenarioError
from railjoule.dashboard.workbench import Workbench


def test_the_search_sets_the_limits(state: Workbench) -> None:
    model = state.pages["Set speeds"]
    assert model.run is model.path
    assert model.limits_kmh == pytest.approx(model.run.limits_kmh)
    assert model.found
    # the latest arrival that the window allows: 2400 m less 96 m of train at 40 km/h and 1 % more, (15)
    assert model.run.run.travel_time_s == pytest.approx(1.01 * 207.36, abs=1e-3)
    # `railjoule solve kharkiv-like-40kmh`
    assert model.run.run.energy_kwh == pytest.approx(8.72, abs=5e-3)
    assert model.storage is model.motor_map is None
    model.tab = "losses"
    assert model.storage is not None
    assert model.motor_map is not None


def test_a_typed_limit_is_driven_and_the_search_s_path_stays(state: Workbench) -> None:
    model = state.pages["Set speeds"]
    path = model.path
    model.sections[1].limit_kmh = 40.0
    assert not model.found
    assert model.path is path
    assert model.run.limits_kmh[1] == pytest.approx(40.0)
    model.found = True
    assert model.run is not None
    assert model.limits_kmh == pytest.approx(path.limits_kmh)  # type: ignore[union-attr]


def test_a_step_that_moves_brings_trips_alone(state: Workbench) -> None:
    model = state.pages["Set speeds"]
    before = model.run
    model.move([60.0, 30.0], [900.0])
    assert model.run is before
    quick = model.trip.energy_kwh
    model.moving = False
    assert model.trip is None
    assert model.run.run.energy_kwh == pytest.approx(quick, rel=1e-3)
    assert model.run.borders_m.tolist() == [900.0]


def test_another_count_of_sections_is_searched_anew(state: Workbench) -> None:
    model = state.pages["Set speeds"]
    model.section_count = 3
    assert model.borders_m == (800.0, 1600.0)
    assert model.run is model.path
    assert len(model.run.limits_kmh) == 3


def test_found_limits_follow_the_timetable_and_given_ones_stay(state: Workbench) -> None:
    model = state.pages["Set speeds"]
    before = model.limits_kmh
    state.scenario.travel_time_s = 250.0
    assert model.limits_kmh != before
    model.sections[0].limit_kmh = 50.0
    given = model.limits_kmh
    state.scenario.travel_time_s = 207.4
    assert model.limits_kmh == given


def test_free_borders_are_found_once(state: Workbench) -> None:
    model = state.pages["Set speeds"]
    model.free_borders = True
    found = model.run
    assert model.borders_m == pytest.approx(found.borders_m)
    state.page = "Drive"
    state.page = "Set speeds"
    assert model.run is found


def test_bad_borders_are_told_and_the_last_run_stays(state: Workbench) -> None:
    model = state.pages["Set speeds"]
    model.sections[0].limit_kmh = 50.0
    before = model.run
    model.sections[0].to_m = 5000.0
    assert isinstance(model.failure, ScenarioError)
    assert "must lie before the end of the line" in str(model.failure)
    assert model.run is before
    model.sections[0].to_m = 1000.0
    assert model.failure is None


def test_a_storage_that_is_named_counts(state: Workbench) -> None:
    model = state.pages["Set speeds"]
    model.tab = "losses"
    most = model.storage.chosen.saved_kwh
    model.storage_size_kwh = 0.2
    assert model.storage.chosen.storage.size_kwh == 0.2
    assert 0 < model.storage.chosen.saved_kwh < most
    assert np.interp(0.2, model.storage.size_kwh, model.storage.saved_kwh) == pytest.approx(
        model.storage.chosen.saved_kwh, rel=0.02
    )
