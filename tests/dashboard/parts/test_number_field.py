import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc

from railjoule.dashboard.browser import Browser
from railjoule.dashboard.day import Day
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.pages.line.model import StationModel
from railjoule.dashboard.parts.number_field import LoadField, NumberField
from railjoule.dashboard.shell.sidebar import Sidebar
from railjoule.dashboard.state.scenario import ScenarioModel
from railjoule.dashboard.workbench import Workbench


@pytest.fixture
def model() -> ScenarioModel:
    return ScenarioModel()


@pytest.fixture
def field(model: ScenarioModel) -> NumberField:
    return NumberField(model, "recuperation_percent")


def test_the_field_is_as_the_model_declares_it(field: NumberField) -> None:
    assert (field.label, field.unit, field.digits) == ("Recuperation, %", "%", 0)
    assert (field.start, field.end, field.step) == (0, 100, 1)
    assert "data-term" in field.info


def test_all_that_follows_a_slider_goes_as_one_message(model: ScenarioModel, field: NumberField) -> None:
    document, held = Document(), []
    model.param.watch(lambda _: held.append(document.callbacks.hold_value), "recuperation_percent")
    with set_curdoc(document):
        field.value = 41
        field.type("42")
    assert held == ["combine", "combine"]


def test_what_the_browser_says_is_not_said_back(model: ScenarioModel, field: NumberField) -> None:
    root = field.get_root(Document())
    changes: list[str] = []
    for name in sorted(root.data.properties() - {"name", "tags", "subscribed_events"}):
        root.data.on_change(name, lambda attribute, _old, _new: changes.append(attribute))
    root.data.value = 41
    assert model.recuperation_percent == 41
    assert changes == ["value"]
    model.recuperation_percent = 42
    assert changes == ["value", "value"]
    assert root.data.value == 42


def test_a_bad_text_is_explained_and_changes_nothing(model: ScenarioModel, field: NumberField) -> None:
    before = model.recuperation_percent
    for count, text in enumerate(("<b>", "101", "nan"), 1):
        field.type(text)
        assert (model.recuperation_percent, field.answers) == (before, count)
        assert field.refusal == ("At most 100." if text == "101" else "Not a number.")
    # the number that is there is an answer too
    field.type(f"{before:g}")
    assert (field.refusal, field.answers) == ("", 4)
    field.type("-1")
    model.recuperation_percent = before + 1
    assert field.refusal == ""


def test_a_number_beyond_the_slider_widens_it(model: ScenarioModel) -> None:
    field = NumberField(model, "travel_time_s", ends=(50.0, 200.0))
    field.type("500")
    assert (model.travel_time_s, field.end) == (500.0, 500.0)
    model.travel_time_s = 100.0
    # the rail does not move under the hand that moves the thumb
    assert field.end == 500.0
    field.set_ends((60.0, 90.0))
    assert (field.start, field.end) == (60.0, 100.0)


def test_a_suggestion_holds_until_a_number_is_set(model: ScenarioModel) -> None:
    field = NumberField(model, "acceleration_time_s")
    assert (field.value, field.suggested, field.start, field.end) == (None, None, 15, 110)
    field.suggest(131.0)
    assert (field.value, field.suggested, field.end) == (None, 131.0, 131.0)
    assert model.acceleration_time_s is None
    model.acceleration_time_s = 40.0
    field.suggest(31.0)
    assert (field.value, field.suggested) == (40.0, 131.0)


def test_a_load_above_the_capacity_is_told_and_bounded_by_the_vehicle(model: ScenarioModel) -> None:
    field = LoadField(model, "load_percent", ["preset", "opened", "edits"])
    assert (field.end, field.note) == (120, "")
    field.type("115")
    assert model.scenario().vehicle.load_factor == pytest.approx(1.15)
    assert field.note == "crush load, 115 % of capacity"
    field.type("121")
    assert model.load_percent == 115
    assert field.refusal == "At most 120, the vehicle's crush load."
    model.edit({"vehicle.crush_load_factor": 1.5})
    assert field.end == 150
    field.type("121")
    assert model.load_percent == 121


def test_another_scenario_brings_its_own_ends() -> None:
    state = Workbench()
    browser = Browser()
    sidebar = Sidebar(state, browser, Keeping(state, browser))
    fields = [field.field for field in sidebar.view.select(NumberField)]
    assert fields[:4] == ["travel_time_s", "load_percent", "load_t", "recuperation_percent"]
    for name in ("metro-10-stations", "metro-with-limit"):
        state.scenario.choose(name)
        assert (sidebar.travel_time.start, sidebar.travel_time.end) == state.scenario.travel_time_range_s
        assert sidebar.travel_time.value == state.scenario.travel_time_s


def test_a_plain_number_has_no_slider_and_may_be_checked_and_taken_otherwise(model: ScenarioModel) -> None:
    taken: list[float] = []

    def check(number: float) -> float:
        if number == 13:
            raise ValueError("Not that one.")
        return number

    field = NumberField(model, "load_percent", ends=(0, 100), check=check, take=taken.append, of="Train: ")
    field.type("13")
    assert (taken, field.refusal) == ([], "Not that one.")
    field.type("14")
    assert (taken, field.refusal, field.of) == ([14.0], "", "Train: ")


def test_a_whole_number_stays_one() -> None:
    model = Day(ScenarioModel())
    field = NumberField(model, "seed")
    field.type("7")
    assert (model.seed, type(model.seed), field.refusal) == (7, int, "")
    field.type("7.5")
    assert (model.seed, field.refusal) == (7, "A whole number.")


def test_a_number_may_be_left_out_only_where_its_model_says_so() -> None:
    station = StationModel(latest_s=120.0)
    latest, dwell = NumberField(station, "latest_s"), NumberField(station, "dwell_s")
    latest.type(" ")
    assert (station.latest_s, latest.value, latest.refusal) == (None, None, "")
    dwell.type("")
    assert "is not a time" in dwell.refusal


def test_style_sheets_are_sent_once(model: ScenarioModel) -> None:
    document = Document()
    one, other = (NumberField(model, "recuperation_percent").get_root(document) for _ in range(2))
    assert one.stylesheets[-1] is other.stylesheets[-1]
