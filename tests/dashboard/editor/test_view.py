from typing import Any

import pytest

from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.editor.view import EditorView, Group, LineGroup
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.state.workbench import Workbench


@pytest.fixture
def state() -> Workbench:
    return Workbench()


@pytest.fixture
def view(state: Workbench) -> EditorView:
    view = EditorView(state, Browser(), Palette(dark=False))
    state.editor.open = True
    return view


def opened(view: EditorView, name: str) -> Any:
    (group,) = [group for group in view.groups if group.name == name]
    group.head._handle_msg({"what": "turn"})
    return group


def shown(group: Group, key: str) -> dict[str, Any]:
    (entry,) = [entry for form, _ in group._forms for entry in form.fields if entry["key"] == key]
    return dict(entry)


def test_nothing_is_made_before_it_is_opened(state: Workbench) -> None:
    view = EditorView(state, Browser(), Palette(dark=False))
    assert (len(view.view), view.view.visible) == (0, False)
    state.editor.open = True
    assert all(len(group.body) == 0 for group in view.groups)
    assert len(opened(view, "Traction").body) == 2


def test_a_message_is_an_edit_and_its_refusal_is_shown(state: Workbench, view: EditorView) -> None:
    group = opened(view, "Vehicle")
    form, _ = group._forms[0]
    form._handle_msg({"what": "type", "key": "vehicle.tare_kg", "text": "150000"})
    assert dict(state.scenario.changes) == {"vehicle.tare_kg": 150_000.0}
    assert (shown(group, "vehicle.tare_kg")["changed"], shown(group, "vehicle.tare_kg")["was"]) == (True, "160000")
    assert (group.head.changed, group.head.note) == (True, "1 changed")
    form._handle_msg({"what": "type", "key": "vehicle.load_factor", "text": "<b>"})
    refused = shown(group, "vehicle.load_factor")
    assert (refused["text"], refused["sentence"]) == ("<b>", "Not a number. Kept: 0.5.")
    form._handle_msg({"what": "back", "key": "vehicle.tare_kg"})
    assert dict(state.scenario.changes) == {}


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
    group = opened(view, "Track")
    group._tables[0][0]._handle_msg(message)
    assert dict(state.scenario.changes) == {}


def test_a_dragged_border_changes_both_sections_beside_it(state: Workbench, view: EditorView) -> None:
    group = opened(view, "Track")
    assert isinstance(group, LineGroup)
    before = state.scenario.scenario().line
    x, y = section_borders(before), height_profile(before)
    x[3] += 100.0
    y[3] += 2.0
    group._drop_borders(x.tolist(), y.tolist())
    after = state.scenario.scenario().line
    assert after.length_m == before.length_m
    assert [section.length_m for section in after.sections[2:4]] == [500.0, 300.0]
    # what is not dragged keeps its gradient; the two meet the moved border within the tenths that they are rounded to
    assert height_profile(after)[3] == pytest.approx(y[3], abs=0.05 * 0.5)
    kept = [k for k in range(len(before.sections)) if k not in {2, 3}]
    assert [after.sections[k] for k in kept] == [before.sections[k] for k in kept]


def test_a_dragged_limit_is_that_of_its_table(state: Workbench, view: EditorView) -> None:
    state.scenario.edit({"line.sections": [{"length_m": 2300.0, "speed_limit_kmh": 70.0}]})
    group = opened(view, "Track")
    group._drop_limits([0.0, 650.0], [2300.0, 900.0], [65.0, 40.0])
    line = state.scenario.scenario().line
    assert line.sections[0].speed_limit_kmh == 65.0
    (limit,) = line.speed_limits
    assert (limit.from_m, limit.to_m, limit.limit_kmh) == (650.0, 900.0, 40.0)


def test_a_long_table_shows_its_beginning(state: Workbench, view: EditorView) -> None:
    state.scenario.edit({"line.sections": [{"length_m": 23.0}] * 100})
    group = opened(view, "Track")
    table = group._tables[0][0].table
    assert (len(table["rows"]), table["more"]) == (60, "40 more rows are not shown; paste a table to replace them all.")


def test_a_pasted_table_is_refused_with_its_cell_or_replaces_all_rows(state: Workbench, view: EditorView) -> None:
    group = opened(view, "Track")
    paste = group._tables[0][0]._handle_msg
    paste({"what": "paste_all", "text": "1200,5\t\u22123\n800\tsteep"})
    refusal = group._tables[0][0].table["refusal"]
    assert refusal["sentence"] == "Row 2, Gradient, \u2030: 'steep'. Not a number. Nothing is changed."
    assert dict(state.scenario.changes) == {}
    paste({"what": "paste_all", "text": "1200,5\t\u22123\n1099,5\t4"})
    assert group._tables[0][0].table["refusal"] is None
    assert [section.gradient_permille for section in state.scenario.scenario().line.sections] == [-3, 4]
