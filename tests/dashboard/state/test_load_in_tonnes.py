"""The field Load of a vehicle without passengers is in tonnes."""

import pytest

from railjoule.core.scenario import format_scenario
from railjoule.dashboard.look import words
from railjoule.dashboard.state.scenario import ScenarioModel
from tests.builders import plain_scenario


@pytest.fixture
def freight() -> ScenarioModel:
    model = ScenarioModel()
    changes = {"vehicle.max_load_t": 60.0, "vehicle.tare_kg": 80e3, "timetable.travel_time_s": 180.0}
    model.open(format_scenario(plain_scenario(changes)), "freight.toml")
    return model


def test_tonnes_are_typed_and_bounded(freight: ScenarioModel) -> None:
    assert freight.loads_in_tonnes
    assert freight.parse_or_none("load_t", "30") == 30.0
    with pytest.raises(ValueError, match=r"^At most 60, what the vehicle can carry\.$"):
        freight.parse("load_t", "61")
    freight.load_t = 30.0
    assert dict(freight.changes) == {"vehicle.load_t": 30.0}
    assert freight.scenario().vehicle.total_mass_kg == 110e3
    assert freight.planned_load_percent == 50.0
    assert words.vehicle_load(freight.scenario().vehicle) == "load 30 t"
    freight.load_t = None
    assert not freight.changes


def test_a_passenger_train_has_its_share() -> None:
    model = ScenarioModel()
    assert not model.loads_in_tonnes
    assert model.load_t is None
