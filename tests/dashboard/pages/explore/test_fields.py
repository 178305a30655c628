import math

import pytest

from railjoule.core import load_scenario
from railjoule.core.scenario import preset_names
from railjoule.core.studies.sweep import make_study
from railjoule.dashboard.pages.explore.fields import FIRST_VARIED, fields_that_vary, first_ranges

METRO = load_scenario("metro-with-limit")


@pytest.mark.parametrize("preset", preset_names("scenarios"))
def test_the_first_study_of_every_scenario_can_be_begun(preset: str) -> None:
    scenario = load_scenario(preset)
    over = {path: (low, high) for path, (low, high) in first_ranges(scenario).items()}
    assert set(over) <= set(FIRST_VARIED)
    assert len(over) == 5
    assert make_study(scenario, over, 8).sample == 8


def test_fields_are_called_as_in_the_editor_and_have_its_units() -> None:
    known = fields_that_vary(METRO)
    assert known["timetable.travel_time_s"].label == "Travel time, s"
    assert known["vehicle.load_factor"].label == "Load factor, \u2013"
    # a constant alone would say nothing beside those of other tables
    assert known["vehicle.resistance.constant_n_per_kn"].label == "Resistance: constant, N/kN"


def test_what_is_left_out_or_no_number_does_not_vary() -> None:
    known = fields_that_vary(METRO)
    assert METRO.vehicle.inertial_mass_kg is None
    assert "vehicle.inertial_mass_kg" not in known
    assert "vehicle.name" not in known
    assert "line.reverse" not in known


@pytest.mark.parametrize("preset", ["metro-with-limit", "tram-950m", "kharkiv-like-20kmh"])
def test_ranges_lie_within_bounds_and_on_their_sliders(preset: str) -> None:
    for field in fields_that_vary(load_scenario(preset)).values():
        low, high = field.first_range
        least, most = field.ends
        assert least <= low <= high <= most, field.path
        assert all(map(math.isfinite, (low, high, least, most))), field.path
        assert field.declared.least is None or low >= field.declared.least
        assert field.declared.most is None or high <= field.declared.most
        assert field.step > 0


def test_whole_numbers_vary_between_whole_numbers() -> None:
    motors = fields_that_vary(load_scenario("tram-950m"))["drive.motors"]
    assert motors.is_whole
    assert all(end.is_integer() for end in motors.first_range)
    assert motors.step == 1.0
