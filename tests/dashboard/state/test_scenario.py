import pytest

from railjoule.core import RailjouleError, ScenarioError, load_scenario
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.state.scenario import ScenarioModel


@pytest.fixture
def model() -> ScenarioModel:
    return ScenarioModel()


def test_sliders_change_the_keys_of_the_file(model: ScenarioModel) -> None:
    model.param.update(travel_time_s=140.0, load_percent=30.0, recuperation_percent=70.0)
    assert dict(model.changes) == {
        "timetable.travel_time_s": 140.0,
        "vehicle.load_factor": 0.3,
        "drive.recuperation_factor": 0.7,
    }
    scenario = model.scenario()
    assert scenario.travel_time_s == 140.0
    assert scenario.vehicle.load_factor == 0.3
    assert scenario.vehicle.drive.recuperation_factor == 0.7


def test_a_file_is_opened_and_left_again(model: ScenarioModel) -> None:
    text = format_scenario(load_scenario("ftorek-300s").replace(**{"timetable.travel_time_s": 320.0}))
    model.open(text, "mine.toml")
    assert model.travel_time_s == 320.0
    assert model.scenario().travel_time_s == 320.0
    model.choose("liashenko-i")
    assert model.opened is None
    assert model.scenario() == load_scenario("liashenko-i")


def test_a_bad_file_changes_nothing(model: ScenarioModel) -> None:
    before = model.scenario()
    with pytest.raises(RailjouleError, match=r"^mine\.toml: "):
        model.open("railjoule = 99", "mine.toml")
    assert model.scenario() == before


NO_TIME = "is not a time: write seconds, min:s or h:min:s, such as 150, 2:30 or 1:02:03."


@pytest.mark.parametrize(
    ("field", "text", "sentence"),
    [
        ("travel_time_s", "soon", f"Travel time: 'soon' {NO_TIME}"),
        ("travel_time_s", "86401", "At most 86400."),
        ("load_percent", "\u22121", "At least 0."),
        ("recuperation_percent", "101", "At most 100."),
    ],
)
def test_what_is_no_value_is_refused_with_its_bound(model: ScenarioModel, field: str, text: str, sentence: str) -> None:
    with pytest.raises(ValueError, match=f"^{sentence}$"):
        model.parse(field, text)


def test_edited_keys_lie_under_the_sliders(model: ScenarioModel) -> None:
    model.load_percent = 30.0
    model.edit({"vehicle.auxiliary_power_kw": 40.0, "vehicle.load_factor": 0.6})
    assert dict(model.edits) == {"vehicle.auxiliary_power_kw": 40.0}
    assert model.load_percent == 60.0
    assert model.scenario().vehicle.auxiliary_power_kw == 40.0
    model.take_back("vehicle.auxiliary_power_kw")
    assert dict(model.changes) == {"vehicle.load_factor": 0.6}


@pytest.mark.parametrize("changes", [{"vehicle.load_factor": 2.0}, {"vehicle.tare_kg": 1e9}, {"vehicle.wings": 2}])
def test_an_edit_out_of_bounds_changes_nothing(model: ScenarioModel, changes: dict[str, float]) -> None:
    model.edit({"vehicle.auxiliary_power_kw": 40.0})
    before = model.scenario()
    with pytest.raises(RailjouleError):
        model.edit({**changes, "vehicle.auxiliary_power_kw": 10.0})
    assert model.scenario() == before


def test_another_scenario_leaves_no_edit_behind(model: ScenarioModel) -> None:
    seen: list[str] = []
    model.param.watch(lambda *_: seen.append(model.scenario().title), ["preset", "opened", "edits"])
    model.edit({"vehicle": {"preset": "tram-105n"}, "drive": None})
    model.edit({"drive.gear_ratio": 7.0})
    model.choose("liashenko-i")
    assert dict(model.changes) == {}
    assert seen[-1] == load_scenario("liashenko-i").title


def test_followers_hear_of_other_scenarios_and_of_their_part_alone(model: ScenarioModel) -> None:
    heard: list[float] = []
    model.follow(lambda scenario: scenario.search, lambda scenario: heard.append(scenario.search.time_window))
    model.edit({"vehicle.auxiliary_power_kw": 40.0})
    assert heard == []
    model.edit({"search.time_window": 0.05})
    model.take_back("search.time_window")
    assert heard == [0.05, 0.01]
    model.choose("liashenko-i")
    assert len(heard) == 3


def test_a_load_that_the_vehicle_does_not_carry_is_left_out() -> None:
    model = ScenarioModel()
    values = {**model.keep(), "load_percent": 150.0, "travel_time_s": 155.0}
    with pytest.raises(
        ScenarioError, match=r"load_percent = 150 must be at most 120, the crush load of the vehicle\.$"
    ):
        model.lay(values)
    assert (model.load_percent, model.travel_time_s) == (50.0, 155.0)
    model.lay({**values, "edits": {"vehicle.crush_load_factor": 1.6}})
    assert model.load_percent == 150.0
