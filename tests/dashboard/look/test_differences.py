from railjoule.core import load_scenario
from railjoule.dashboard.look.differences import difference_words


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
    assert difference_words(base.with_(**changes), base) == (
        "travel time 181.5 s instead of 170.0 s",
        "load 70 % instead of 50 %",
        "recuperation 0 % instead of 40 %",
        "run in reverse yes instead of no",
        "solver.mesh_m 2.5 instead of 5",
    )


def test_lists_are_told_as_a_whole() -> None:
    base = load_scenario("metro-with-limit")
    other = base.with_(**{"line.speed_limits": []})
    assert difference_words(other, base) == ("different line.speed_limits",)


def test_another_vehicle_is_told_by_its_name_and_many_differences_are_counted() -> None:
    told = difference_words(load_scenario("tram-950m"), load_scenario("metro-with-limit"))
    assert told[0].startswith("vehicle ")
    assert not any("tare_kg" in sentence for sentence in told)
