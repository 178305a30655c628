"""The form of a data sheet on Files: refusals at its fields, and the train with the effects of its assumptions."""

import json
from typing import Any

import pytest

from railjoule.core import load_scenario
from railjoule.core.scenario import parse_scenario
from railjoule.core.scenario.data_sheet import DataSheet
from railjoule.dashboard.pages.files.brought import Brought
from railjoule.dashboard.pages.files.compute import Request, Stretch, assumed_effects, read_files, taken
from railjoule.dashboard.pages.files.line_tab import effects_table, train_table
from railjoule.dashboard.pages.files.sheet_form import SheetForm

TYPED = {
    "mass_t": "40,37",
    "power_kw": "580",
    "max_acceleration_ms2": "1.07",
    "max_speed_kmh": "80",
    "length_m": "24.8",
}


@pytest.fixture
def brought() -> list[tuple[str, bytes]]:
    return []


@pytest.fixture
def form(brought: list[tuple[str, bytes]]) -> SheetForm:
    return SheetForm(lambda name, content: brought.append((name, content)))


def fill(form: SheetForm, **texts: str) -> None:
    for name, text in texts.items():
        form.widgets[name].value = text
    form.make()


def test_each_field_of_a_sheet_has_a_widget(form: SheetForm) -> None:
    assert form.widgets.keys() == DataSheet.model_fields.keys()
    assert form.widgets["mass_t"].label == "Mass, t"


def test_what_is_wrong_is_said_where_it_is(form: SheetForm, brought: list[Any]) -> None:
    fill(form, mass_t="heavy")
    assert form.widgets["mass_t"].error_state
    assert form.widgets["mass_t"].helper_text == "Not a number."
    fill(form, **{**TYPED, "max_acceleration_ms2": ""})
    assert not form.widgets["mass_t"].error_state
    assert "The sheet needs Max effort, kN or Max acceleration" in str(form.refused.object)
    fill(form, **TYPED, driven_axles="4")
    assert "Driven axles needs Axles, of which they are a share." in str(form.refused.object)
    assert not brought
    fill(form, axles="6")
    assert not form.refused.visible
    assert len(brought) == 1


def test_a_sheet_becomes_a_train_with_marked_assumptions(form: SheetForm, brought: list[tuple[str, bytes]]) -> None:
    fill(form, **TYPED, kind="light_rail", name="Our tram", regenerative="yes")
    ((name, content),) = brought
    assert name == "Our tram, data sheet"
    assert json.loads(content)["data_sheet"]["mass_t"] == 40.37
    base = load_scenario("tram-950m")
    *_, reading = read_files(Request((Brought(1, name, content),), Stretch(), base))
    (card,) = reading.cards
    assert not card.failure
    assert "Rotating mass factor = 0.04: OSRD's example of a tram-train." in card.findings
    (offer,) = reading.offers or ()
    assert offer.what == "train"
    scenario = parse_scenario(taken(offer, offer.time_s))
    assert scenario.vehicle.name == "Our tram"
    assert "vehicle.rotating_mass_factor" in {one.key for one in scenario.vehicle.assumptions}
    assert str(train_table(reading)).count("assumed") == len(scenario.vehicle.assumptions)
    *_, effects = assumed_effects(offer)
    shown = str(effects_table(effects))
    assert "Resistance" in shown
    assert "Sauthoff" in shown
    assert "20.0 % lower" in shown or "20 % lower" in shown


def test_a_file_that_is_no_sheet_is_refused() -> None:
    file = Brought(1, "sheet.json", b'{"data_sheet": 3}')
    *_, reading = read_files(Request((file,), Stretch(), load_scenario("tram-950m")))
    assert reading.cards[0].failure == "sheet.json: data_sheet must be a table."
