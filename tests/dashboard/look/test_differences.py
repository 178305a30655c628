import pytest

from railjoule.core import load_scenario
from railjoule.dashboard.look.differences import difference_words
from railjoule.dashboard.look.key_names import without_keys


def test_the_same_scenario_differs_by_nothing() -> None:
    assert difference_words(load_scenario("tram-950m"), load_scenario("tram-950m")) == ()


def test_fields_of_the_page_are_told_in_words() -> None:
    base = load_scenario("metro-with-limit")
    changes = {
        "timetable.travel_time_s": 181.5,
        "vehicle.load_factor": 0.7,
        "drive.recuperation_factor": 0.0,
        "line.reverse": True,
        "solver.mesh_m": 2.5,
    }
    assert difference_words(base.replace(**changes), base) == (
        "travel time 181.5 s instead of 170.0 s",
        "load 70 % instead of 50 %",
        "recuperation 0 % instead of 40 %",
        "run in reverse yes instead of no",
        "mesh 2.5 m instead of 5 m",
    )


def test_lists_are_told_as_a_whole() -> None:
    base = load_scenario("metro-with-limit")
    assert difference_words(base.replace(**{"line.speed_limits": []}), base) == ("different speed limits",)


def test_a_key_of_a_table_within_a_table_has_the_name_of_both() -> None:
    base = load_scenario("metro-with-limit")
    other = base.replace(**{"vehicle.resistance.constant_n": 4000.0, "vehicle.braking.max_deceleration_ms2": None})
    sentences = difference_words(other, base)
    assert sentences[0].startswith("resistance constant 4000 N instead of ")
    assert all("_" not in sentence and "." not in sentence.replace("0.", "") for sentence in sentences)


def test_another_vehicle_is_told_by_its_name_and_many_differences_are_counted() -> None:
    told = difference_words(load_scenario("tram-950m"), load_scenario("metro-with-limit"))
    assert told[0].startswith("vehicle ")
    assert not any("tare_kg" in sentence for sentence in told)


@pytest.mark.parametrize(
    ("sentence", "shown"),
    [
        (
            "disturbance.coordinate_error_m = 500 must be less than the shortest distance between two stops, 300 m.",
            "Position error = 500 m must be less than the shortest distance between two stops, 300 m.",
        ),
        (
            "takes at most 1,000 cells, and solver.mesh_m = 0.01 makes 130,000.",
            "takes at most 1,000 cells, and mesh = 0.01 m makes 130,000.",
        ),
        (
            "the neutral section from 3 to 5 m (line.neutral_sections), friction brakes of at most 3 kN",
            "the neutral section from 3 to 5 m, friction brakes of at most 3 kN",
        ),
        ("search.limits_kmh[1] = 900 must be at most 80.", "Limits[1] = 900 km/h must be at most 80."),
        ("drive.machine is missing.", "Machine is missing."),
        ("line.csv: row 3 (a.line.toml) has no place.", "line.csv: row 3 (a.line.toml) has no place."),
    ],
)
def test_a_field_stands_in_the_place_of_its_key(sentence: str, shown: str) -> None:
    assert without_keys(sentence) == shown
