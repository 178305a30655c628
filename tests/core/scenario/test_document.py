"""Scenarios as nested dictionaries: presets filled in and taken out again, keys changed."""

import pytest
from builders import COPPER_LOSS, HILLS, PLAIN, plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.errors import ScenarioError
from railjoule.core.scenario import Scenario, format_scenario, load_scenario, parse_scenario, to_document
from railjoule.core.scenario._base import is_misleading
from railjoule.core.scenario.document import change_document, merged, scenario_from_document
from railjoule.core.scenario.presets import preset_names


def numbers(low: float, high: float, **options: bool) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False, **options)


sections = st.lists(
    st.fixed_dictionaries(
        {"length_m": numbers(1, 5000)},
        optional={
            "gradient_permille": numbers(-200, 200),
            "speed_limit_kmh": numbers(0, 600, exclude_min=True),
            "curve_radius_m": numbers(0, 1e6),
        },
    ),
    min_size=1,
    max_size=5,
)
plain_signs = st.characters(exclude_categories=["Cs"]).filter(lambda sign: not is_misleading(sign))
changes = st.fixed_dictionaries(
    {},
    optional={
        "title": st.text(plain_signs, max_size=40),
        "strategy": st.sampled_from(["optimal", "eoc", "enoc", "fastest"]),
        "vehicle.tare_kg": numbers(1, 1e6),
        "vehicle.load_factor": numbers(0, 1),
        "vehicle.length_m": numbers(0, 5000, exclude_min=True),
        "vehicle.resistance.linear_n_per_kmh": numbers(0, 1e5),
        "vehicle.traction.max_power_kw": numbers(0, 1e5, exclude_min=True),
        "vehicle.traction.curve": st.just([[0, 80], [50.5, 60], [90, 20.25]]),
        "vehicle.braking.friction_effort_kn": numbers(0, 1e4),
        "vehicle.braking.curve": st.just([[0, 20], [10, 70.5], [90, 30]]),
        "vehicle.braking.permitted_deceleration": st.just([[0, 0.7], [60.5, 0.55]]),
        "drive.recuperation_factor": numbers(0, 1),
        "drive.braking_efficiency": numbers(0, 1, exclude_min=True),
        "line.name": st.text(plain_signs, max_size=40),
        "line.reverse": st.booleans(),
        "line.sections": sections,
        "timetable.average_speed_kmh": numbers(0, 600, exclude_min=True),
        "disturbance.coordinate_error_m": numbers(-10_000, 10_000),
        "disturbance.stops": st.just([{"position_m": 300.0, "duration_s": 5.0, "reaction": "driver"}]),
        "enoc.acceleration_time_s": numbers(0, 1000, exclude_min=True),
        "search.limits_kmh": st.lists(numbers(0, 600, exclude_min=True), max_size=3),
        "solver.mesh_m": numbers(0.001, 1000),
    },
)


@given(changes)
def test_round_trip_through_toml_is_exact(change):
    scenario = plain_scenario(change)
    assert parse_scenario(format_scenario(scenario)) == scenario


@pytest.mark.parametrize("name", preset_names("scenarios"))
@given(
    change=st.fixed_dictionaries(
        {},
        optional={
            "vehicle.load_factor": numbers(0, 1),
            "vehicle.traction.max_power_kw": numbers(1, 1e5),
            "drive.recuperation_factor": numbers(0, 1),
            "line.reverse": st.booleans(),
            "timetable.travel_time_s": numbers(1, 86400),
        },
    )
)
def test_round_trip_of_changed_presets_is_exact(name, change):
    scenario = load_scenario(name).replace(**change)
    assert parse_scenario(format_scenario(scenario)) == scenario


@pytest.mark.parametrize("name", preset_names("scenarios"))
def test_a_preset_is_written_as_its_name(name):
    scenario = load_scenario(name)
    document = to_document(scenario)
    assert document["vehicle"].keys() <= {"preset", "load_factor"}
    assert document["vehicle"]["preset"] == scenario.vehicle.preset
    assert ("preset" in document["line"]) == (scenario.line.preset is not None)


def test_a_preset_without_one_of_its_keys_is_written_in_full():
    scenario = load_scenario("liashenko-ii")
    bare = scenario.vehicle.traction.model_copy(update={"max_power_kw": None})
    changed = scenario.model_copy(update={"vehicle": scenario.vehicle.model_copy(update={"traction": bare})})
    assert "preset" not in to_document(changed)["vehicle"]
    again = parse_scenario(format_scenario(changed))
    assert again.vehicle == changed.vehicle.model_copy(update={"preset": None})


def test_another_drive_replaces_all_keys_but_the_recuperation_factor():
    drive = {key: value for key, value in COPPER_LOSS.items() if key != "recuperation_factor"}
    scenario = plain_scenario({f"drive.{key}": value for key, value in drive.items()})
    assert scenario.vehicle.drive.model == "copper_loss"
    assert scenario.vehicle.drive.recuperation_factor == PLAIN["vehicle"]["drive"]["recuperation_factor"]
    assert parse_scenario(format_scenario(scenario)) == scenario


def test_drive_table_lies_over_the_vehicles():
    base = {**PLAIN, "drive": {"recuperation_factor": 0.25}}
    scenario = scenario_from_document(base)
    assert scenario.vehicle.drive.recuperation_factor == 0.25
    assert scenario.vehicle.drive.traction_efficiency == 0.85


def test_both_paths_to_the_drive_mean_the_same():
    by_drive = plain_scenario({"drive.recuperation_factor": 0.75})
    by_vehicle = plain_scenario({"vehicle.drive.recuperation_factor": 0.75})
    assert by_drive == by_vehicle
    assert by_drive.vehicle.drive.recuperation_factor == 0.75


@pytest.mark.parametrize(
    ("key", "value", "dropped"),
    [
        ("timetable.average_speed_kmh", 40.0, "timetable.travel_time_s"),
        ("vehicle.inertial_mass_kg", 2e5, "vehicle.rotating_mass_factor"),
    ],
)
def test_one_of_two_alternatives_replaces_the_other(key, value, dropped):
    changed = change_document(PLAIN, {key: value})
    table, name = dropped.split(".")
    assert name not in changed[table]
    assert name in PLAIN[table]
    assert isinstance(scenario_from_document(changed), Scenario)


def test_none_takes_a_key_away():
    changed = change_document(PLAIN, {"vehicle.traction.max_power_kw": None, "vehicle.braking.no_such_key": None})
    assert "max_power_kw" not in changed["vehicle"]["traction"]
    assert changed["vehicle"]["braking"] == PLAIN["vehicle"]["braking"]


def test_changes_do_not_touch_their_arguments():
    sections = [{"length_m": 500.0}]
    changed = change_document(PLAIN, {"line.sections": sections})
    changed["line"]["sections"][0]["length_m"] = 1.0
    assert sections == [{"length_m": 500.0}]
    assert PLAIN["line"] == {"sections": [{"length_m": 2000.0}]}
    base = {"vehicle": {"traction": {"max_effort_kn": 1.0}}}
    assert merged(base, {"vehicle": {"traction": {"max_speed_kmh": 2.0}}}) == {
        "vehicle": {"traction": {"max_effort_kn": 1.0, "max_speed_kmh": 2.0}}
    }
    assert base == {"vehicle": {"traction": {"max_effort_kn": 1.0}}}


def test_with_gives_a_changed_copy():
    scenario = plain_scenario({"line.sections": HILLS})
    changed = scenario.replace(**{"vehicle.load_factor": 0.3, "drive.recuperation_factor": 1.0})
    assert (changed.vehicle.load_factor, changed.vehicle.drive.recuperation_factor) == (0.3, 1.0)
    assert (scenario.vehicle.load_factor, scenario.vehicle.drive.recuperation_factor) == (0.0, 0.5)
    assert changed.line == scenario.line


def test_frozen_all_the_way_down():
    scenario = plain_scenario()
    for part, name in ((scenario, "title"), (scenario.vehicle, "tare_kg"), (scenario.line.sections[0], "length_m")):
        with pytest.raises(ValueError, match="frozen"):
            setattr(part, name, 1)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"timetable.travel_time_s.more": 1}, "timetable.travel_time_s.more: travel_time_s is not a table."),
        ({"": 1}, "unknown key"),
        ({"vehicle..x": 1}, "unknown key vehicle."),
        ({"vehicle": 3}, "vehicle = 3 must be a table"),
        ({"drive": 3}, "drive = 3 must be a table"),
        ({"line": [1]}, "line = [1] must be a table"),
        ({"vehicle.preset": 3}, "preset = 3 must be the name of one of the vehicles"),
        (
            {"line.preset": "../vehicles/metro-81-7036"},
            "there is no preset '../vehicles/metro-81-7036' among the lines",
        ),
        ({"vehicle.preset": "metro-81-7037"}, "did you mean 'metro-81-7036'?"),
    ],
)
def test_changes_that_cannot_be_made(change, sentence):
    with pytest.raises(ScenarioError) as error:
        plain_scenario(change)
    assert sentence in str(error.value)
