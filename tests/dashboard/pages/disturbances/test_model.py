import pytest

from railjoule.core import load_scenario
from railjoule.core.simulation.disturbances import simulate_disturbances
from railjoule.dashboard.actual.event import KINDS
from railjoule.dashboard.pages.disturbances.model import DisturbancesModel


def test_no_event_is_invented() -> None:
    model = DisturbancesModel()
    model.take(load_scenario("tram-950m-stop"))
    model.take(load_scenario("liashenko-ii"))
    assert model.events == []


def test_the_events_of_a_file_are_taken_over() -> None:
    model = DisturbancesModel()
    scenario = load_scenario("tram-950m-stop")
    model.take(scenario)
    (stop,) = scenario.replace(**model.changes).disturbance.stops
    assert (stop.position_m, stop.duration_s, stop.noticed_at_m) == (300.0, 5.0, 70.11)


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_dropped_can_be_driven(kind: str) -> None:
    model = DisturbancesModel()
    model.drop(kind, 500.4)
    (event,) = model.events
    assert event.position_m == 500.0
    scenario = load_scenario("liashenko-ii").replace(**model.changes)
    assert len(scenario.disturbance.events) == 1
    assert simulate_disturbances(scenario, "computer").actual.distance_m == pytest.approx(1300)
