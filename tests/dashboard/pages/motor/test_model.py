import pytest

from railjoule.core import ScenarioError, load_scenario
from railjoule.dashboard.pages.motor.page import Motor
from railjoule.dashboard.workbench import Workbench

SUBURBAN = load_scenario("ftorek-300s")


def open_motor(preset: str) -> Motor:
    desk = Workbench()
    desk.scenario.choose(preset)
    page: Motor = desk.pages["Motor"]
    page.take(desk.scenario.base)
    return page


@pytest.fixture
def model() -> Motor:
    return open_motor("ftorek-300s")


def test_the_values_of_a_file_come_back_as_they_were(model: Motor) -> None:
    # both limits of the vehicle's file
    assert (model.max_phase_voltage_v, model.max_current_a) == (1732.0, 810.0)
    again = SUBURBAN.replace(**model.changes)
    assert again.vehicle == SUBURBAN.vehicle
    assert again.simulation.kind == "field_oriented"
    detuned = SUBURBAN.replace(**{"simulation.rotor_resistance_factor": 1.5, "simulation.precompensator": False})
    model.take(detuned)
    assert SUBURBAN.replace(**model.changes).simulation.rotor_resistance_factor == 1.5
    assert not model.precompensator


def test_the_limits_of_a_tram_are_keys_of_its_drive() -> None:
    model, tram = open_motor("tram-950m"), load_scenario("tram-950m")
    assert model.max_phase_voltage_v == tram.vehicle.drive.max_phase_voltage_v
    assert tram.replace(**model.changes).vehicle == tram.vehicle
    model.max_phase_voltage_v = 250.0
    model.max_current_a = 140.0
    drive = tram.replace(**model.changes).vehicle.drive
    assert drive.max_phase_voltage_v == 250.0
    # braking has less of its own, and bends to a limit below that
    assert (drive.starting_current_a, drive.braking_current_a) == (140.0, 140.0)


def test_a_drive_without_machine_shows_the_example() -> None:
    page = open_motor("liashenko-ii")
    assert page.is_example
    # both limits of the example's file
    assert (page.max_phase_voltage_v, page.max_current_a) == (1732.0, 810.0)
    assert SUBURBAN.replace(**page.changes).vehicle == SUBURBAN.vehicle
    # the program that leaves the page is that of its own scenario
    assert page.page_run().changes == {"strategy": "optimal"}


def test_a_limit_that_the_train_cannot_start_with_is_refused_by_the_scenario(model: Motor) -> None:
    model.max_current_a = 100.0
    with pytest.raises(ScenarioError, match="max_current_a = 100"):
        SUBURBAN.replace(**model.changes)
