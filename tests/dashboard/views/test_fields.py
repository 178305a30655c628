import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc

from railjoule.dashboard.models.scenario import ScenarioModel
from railjoule.dashboard.views.fields import CrushLoad, NumberField


@pytest.fixture
def model() -> ScenarioModel:
    return ScenarioModel()


@pytest.fixture
def field(model: ScenarioModel) -> NumberField:
    return NumberField(model, "load_percent", "Load, %", step=1, digits=0, unit="%", ends=(0, 100))


def test_slider_text_and_model_agree(model: ScenarioModel, field: NumberField) -> None:
    field.slider.value = 40
    assert (model.load_percent, field.text.value) == (40, "40")
    field.text.value = "55"
    assert (model.load_percent, field.slider.value) == (55, 55)
    model.load_percent = 70
    assert (field.slider.value, field.text.value) == (70, "70")


def test_all_that_follows_a_slider_goes_as_one_message(model: ScenarioModel, field: NumberField) -> None:
    document, held = Document(), []
    model.param.watch(lambda _: held.append(document.callbacks.hold_value), "load_percent")
    with set_curdoc(document):
        field.slider.value = 41
        field.text.value = "42"
    assert held == ["combine", "combine"]


def test_a_bad_text_is_kept_in_sight_and_explained(model: ScenarioModel, field: NumberField) -> None:
    before = model.load_percent
    field.text.value = "<b>"
    assert model.load_percent == before
    assert field.text.value == "<b>"
    assert field.error.visible
    assert f"Not a number. Kept: {before:.0f} %." in field.error.object
    field.text.value = "12"
    assert not field.error.visible


def test_a_number_beyond_the_slider_widens_it(model: ScenarioModel) -> None:
    field = NumberField(model, "travel_time_s", "Travel time, s", step=0.5, digits=1, unit="s", ends=(50.0, 200.0))
    field.text.value = "500"
    assert model.travel_time_s == 500.0
    assert field.slider.end >= 500.0


def test_a_suggestion_shows_until_a_number_is_set(model: ScenarioModel) -> None:
    field = NumberField(model, "acceleration_time_s", "Ramp, s", step=0.1, digits=1, unit="s", ends=(15.0, 110.0))
    field.suggest(31.0)
    assert field.text.value == "31.0"
    assert model.acceleration_time_s is None
    model.acceleration_time_s = 40.0
    field.suggest(31.0)
    assert field.text.value == "40.0"


@pytest.mark.parametrize(
    ("typed", "load", "text"),
    [("50.5", 50.5, "50.5"), ("33,25", 33.25, "33.25"), ("50", 50.0, "50"), ("7.10", 7.1, "7.1")],
)
def test_typed_decimals_are_shown(model: ScenarioModel, field: NumberField, typed: str, load: float, text: str) -> None:
    field.text.value = typed
    assert (model.load_percent, field.text.value) == (load, text)


def test_computed_decimals_are_rounded(model: ScenarioModel, field: NumberField) -> None:
    model.load_percent = 100 / 3
    assert field.text.value == "33"
    model.load_percent = 100 * 0.29  # 28.999999999999996
    assert field.text.value == "29"


def test_a_travel_time_is_read_as_on_a_clock(model: ScenarioModel) -> None:
    field = NumberField(model, "travel_time_s", "Travel time, s", step=0.5, digits=1, unit="s", ends=(50.0, 200.0))
    field.text.value = "2:30"
    assert (model.travel_time_s, field.text.value) == (150.0, "150.0")
    field.text.value = "2:75"
    assert model.travel_time_s == 150.0
    assert "Travel time: &#x27;2:75&#x27; is not a time: write seconds, min:s or h:min:s" in field.error.object
    assert "Kept: 150.0 s." in field.error.object


def test_a_load_above_the_capacity_is_marked_and_bounded_by_the_vehicle(
    model: ScenarioModel, field: NumberField
) -> None:
    crush = CrushLoad(field)
    field.set_ends((0, model.most_load_percent))
    assert (field.slider.end, crush.view.visible) == (120, False)
    field.text.value = "115"
    assert model.scenario().vehicle.load_factor == pytest.approx(1.15)
    assert crush.view.visible
    assert "crush load, 115 % of capacity" in crush.view.object
    field.text.value = "121"
    assert model.load_percent == 115
    assert "At most 120, the vehicle&#x27;s crush load. Kept: 115 %." in field.error.object
    model.edit({"vehicle.crush_load_factor": 1.5})
    field.text.value = "121"
    assert model.load_percent == 121
