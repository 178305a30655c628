from typing import Any

import pytest

from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.editor.model import GROUPS
from railjoule.dashboard.editor.view import EditorView, FieldForm, LineGroup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.workbench import Workbench


@pytest.fixture
def state() -> Workbench:
    return Workbench()


@pytest.fixture
def view(state: Workbench) -> EditorView:
    view = EditorView(state, Browser(), Palette(dark=False))
    state.editor.open = True
    return view


def opened(view: EditorView, name: str) -> Any:
    index = list(GROUPS).index(name)
    view.folds.active = [*view.folds.active, index]
    return view.groups[index]


def form(group: Any, key: str) -> FieldForm:
    (found,) = [form for form in group._fields if form.field.key == key]
    return found


def test_nothing_is_made_before_it_is_opened(state: Workbench) -> None:
    view = EditorView(state, Browser(), Palette(dark=False))
    assert (len(view.view), view.view.visible) == (0, False)
    state.editor.open = True
    assert all(len(group.body) == 0 for group in view.groups)
    # the fields, the curve, and what replaces its rows
    assert len(opened(view, "Traction").body) == 3


def test_a_typed_text_is_an_edit_and_its_refusal_is_shown(state: Workbench, view: EditorView) -> None:
    group = opened(view, "Vehicle")
    tare, load = form(group, "vehicle.tare_kg"), form(group, "vehicle.load_factor")
    tare.widget.value = "150 000"
    assert (tare.widget.error_state, tare.widget.helper_text) == (True, "Not a number. Kept: 160000 kg.")
    tare.widget.value = "150\u202f000"
    assert dict(state.scenario.changes) == {"vehicle.tare_kg": 150_000.0}
    assert (tare.widget.value, tare.widget.label) == ("150000", "Tare, kg \u00b7 changed")
    assert (tare.widget.error_state, tare.widget.helper_text.startswith("Mass of the empty vehicle.")) == (False, True)
    assert (tare.back.description, len(tare.view)) == ("Reset Tare, kg to 160000", 2)
    assert "1 changed" in group.head.object
    load.widget.value = "<b>"
    # the text stays, with the sentence
    assert (load.widget.value, load.widget.helper_text) == ("<b>", "Not a number. Kept: 0.5.")
    assert view.head.alert == "Not a number. Kept: 0.5."
    tare._reset()
    assert (dict(state.scenario.changes), tare.widget.value, len(tare.view)) == ({}, "160000", 1)


def test_a_text_that_reads_as_before_is_shown_as_before(state: Workbench, view: EditorView) -> None:
    tare = form(opened(view, "Vehicle"), "vehicle.tare_kg")
    tare.widget.value = "160000.0"
    assert (dict(state.scenario.changes), tare.widget.value) == ({}, "160000")


def test_the_shipped_vehicles_and_the_kinds_of_drives_can_be_chosen(state: Workbench, view: EditorView) -> None:
    presets, drive = opened(view, "Presets"), opened(view, "Powertrain")
    kind = form(drive, "drive").widget
    before = [field.field.key for field in drive._fields]
    kind.value = "copper_loss"
    assert state.scenario.scenario().vehicle.drive.model == "copper_loss"
    assert [field.field.key for field in drive._fields] != before
    assert form(drive, "drive").widget.value == "copper_loss"
    vehicle = form(presets, "vehicle").widget
    assert "tram-105n" in vehicle.options.values()
    vehicle.value = "tram-105n"
    assert state.scenario.scenario().vehicle.preset == "tram-105n"
    form(presets, "vehicle")._reset()
    assert dict(state.scenario.changes) == {}


def test_a_choice_of_two_is_a_list_too(state: Workbench, view: EditorView) -> None:
    reverse = form(opened(view, "Track"), "line.reverse").widget
    assert (reverse.options, reverse.value) == ({"Yes": "yes", "No": "no"}, "no")
    reverse.value = "yes"
    assert dict(state.scenario.changes) == {"line.reverse": True}


@pytest.mark.parametrize(
    "message",
    [
        {"what": "cell", "row": 99, "column": 0, "text": "1"},
        {"what": "cell", "row": 0, "column": 99, "text": "1"},
        {"what": "remove", "row": -1},
        {"what": "explode", "row": 0},
        {"what": "up", "row": 0},
    ],
)
def test_what_the_browser_cannot_ask_for_changes_nothing(
    state: Workbench, view: EditorView, message: dict[str, Any]
) -> None:
    opened(view, "Track")._tables[0][0]._handle_msg(message)
    assert dict(state.scenario.changes) == {}


def test_a_dragged_border_changes_both_sections_beside_it(state: Workbench, view: EditorView) -> None:
    group = opened(view, "Track")
    assert isinstance(group, LineGroup)
    before = state.scenario.scenario().line
    x, y = section_borders(before), height_profile(before)
    x[3] += 100.0
    y[3] += 2.0
    group.profile._drop(x.tolist(), y.tolist())
    after = state.scenario.scenario().line
    assert after.length_m == before.length_m
    assert [section.length_m for section in after.sections[2:4]] == [500.0, 300.0]
    # what is not dragged keeps its gradient; the two meet the moved border within the tenths that they are rounded to
    assert height_profile(after)[3] == pytest.approx(y[3], abs=0.05 * 0.5)
    kept = [k for k in range(len(before.sections)) if k not in {2, 3}]
    assert [after.sections[k] for k in kept] == [before.sections[k] for k in kept]


def test_a_dragged_limit_is_that_of_its_table(state: Workbench, view: EditorView) -> None:
    state.scenario.edit({"line.sections": [{"length_m": 2300.0, "speed_limit_kmh": 70.0}]})
    opened(view, "Track").steps._drop([0.0, 650.0], [2300.0, 900.0], [65.0, 40.0])
    line = state.scenario.scenario().line
    assert line.sections[0].speed_limit_kmh == 65.0
    (limit,) = line.speed_limits
    assert (limit.from_m, limit.to_m, limit.limit_kmh) == (650.0, 900.0, 40.0)


def test_a_long_table_shows_its_beginning(state: Workbench, view: EditorView) -> None:
    state.scenario.edit({"line.sections": [{"length_m": 10.0}] * 240})
    table = opened(view, "Track")._tables[0][0].table
    assert len(table["rows"]) == 200
    assert table["more"] == "40 more rows are not shown; paste a table to replace them all."


def test_a_pasted_table_is_refused_with_its_cell_or_replaces_all_rows(state: Workbench, view: EditorView) -> None:
    group = opened(view, "Track")
    sections = group._tables[0][0]
    (content,) = group.body[-1]
    which, block, (button, file) = content
    assert which.value == "Sections"
    block.value = "1200,5\t\u22123\n800\tsteep"
    button.clicks += 1
    sentence = "Row 2, Gradient, \u2030: 'steep'. Not a number. Nothing is changed."
    assert sections.table["refusal"]["sentence"] == sentence
    assert dict(state.scenario.changes) == {}
    block.value = "1200,5\t\u22123\n1099,5\t4"
    button.clicks += 1
    assert sections.table["refusal"] is None
    assert [section.gradient_permille for section in state.scenario.scenario().line.sections] == [-3, 4]
    file.value = "length_m,gradient_permille\n2300,1.5\n".encode("utf-8-sig")
    assert [section.gradient_permille for section in state.scenario.scenario().line.sections] == [1.5]
    which.value = "Stations"
    file._refuse()
    stations = next(form for form, table in group._tables if table.key == "line.stations")
    assert stations.table["refusal"]["sentence"].startswith("The file is larger than the limit of 1 MB.")
