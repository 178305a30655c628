"""Files that are brought to a page, and what the page makes of them."""

import pytest

from railjoule.core import load_scenario
from railjoule.dashboard.keep.history import History
from railjoule.dashboard.keep.snapshot import snapshot_of
from railjoule.dashboard.pages.imports.forms import FilesForm, TakeForm
from railjoule.dashboard.pages.imports.model import MAX_FILE_BYTES, MAX_FILES, Wanted
from railjoule.dashboard.pages.imports.work import Imports
from railjoule.dashboard.state.workbench import Workbench


@pytest.fixture
def state() -> Workbench:
    """A workbench whose page Import is in sight; all work is done in the test's own turn."""
    state = Workbench(page="Import")
    Imports(state)
    return state


def choose_track(state: Workbench) -> None:
    form = FilesForm(state.imports)
    form._take({"what": "example"})
    form._take({"what": "say", "number": 2, "key": "rows NOM_VOIE", "value": "V1"})


def test_the_example_is_taken_as_one_step_and_drive_opens(state: Workbench) -> None:
    history = History(snapshot_of(state))
    choose_track(state)
    before = snapshot_of(state)
    TakeForm(state.imports, lambda: state.scenario.edited)._take({"what": "take", "offer": "line", "time": "700"})
    assert state.page == "Drive"
    assert state.scenario.scenario().travel_time_s == 700
    assert state.scenario.scenario().line.length_m == 12_000
    history.note(snapshot_of(state))
    assert history.can_undo
    step = history.undo()
    assert step["toml"] == before["toml"] is None
    assert not history.can_undo


def test_a_line_is_taken_without_its_gradients_only_if_the_user_says_so(state: Workbench) -> None:
    FilesForm(state.imports)._take({"what": "example"})
    form = TakeForm(state.imports, lambda: state.scenario.edited)
    form.show()
    (offer,) = form.offers
    assert offer["waits"].startswith("It waits for the gradients, which cannot be read: ")
    assert offer["without"] == "Take this line without the gradients"
    before = snapshot_of(state)
    form._take({"what": "take", "offer": "line", "time": "900"})
    assert state.imports.refusal == offer["waits"]
    assert snapshot_of(state) == before
    form._take({"what": "take", "offer": "line", "time": "900", "without": True})
    assert state.page == "Drive"
    assert all(section.gradient_permille == 0 for section in state.scenario.scenario().line.sections)


def test_a_column_is_chosen_by_hand_and_files_are_removed(state: Workbench) -> None:
    choose_track(state)
    form = FilesForm(state.imports)
    limits = next(file for file in state.imports.files if file.kind == "limits")
    choose = {"what": "say", "number": limits.number, "key": "value"}
    form._take({**choose, "value": "lib_ligne"})
    assert "row 2: lib_ligne = 'Invented example line'" in state.imports.reading.cards[0].failure
    form._take({**choose, "value": "v_max"})
    assert [card.failure for card in state.imports.reading.cards] == ["", "", ""]
    for file in state.imports.files:
        form._take({"what": "remove", "number": file.number})
    assert state.imports.reading.offers == ()


def test_a_time_that_is_none_changes_nothing(state: Workbench) -> None:
    choose_track(state)
    before = snapshot_of(state)
    for time, sentence in (
        ("soon", "Travel time: 'soon' must be a number of seconds, such as "),
        ("nan", "Travel time: nan s must be at least the shortest possible "),
        ("3", "Travel time: 3 s must be at least the shortest possible "),
    ):
        state.imports.wanted = Wanted("line", time)
        assert state.imports.refusal.startswith(sentence)
    assert snapshot_of(state) == before


def test_messages_that_nobody_sends_change_nothing(state: Workbench) -> None:
    form, take = FilesForm(state.imports), TakeForm(state.imports, lambda: state.scenario.edited)
    choose_track(state)
    files = state.imports.files
    for message in (
        {"what": "say", "number": 2, "key": "factor a.b", "value": "inf"},
        {"what": "say", "number": 2, "key": "value", "value": "no column"},
        {"what": "say", "number": [], "key": {}, "value": None},
        {"what": "kind", "number": 1, "value": "track"},
        {"what": "remove", "number": 99},
        {},
    ):
        form._take(message)
    take._take({"what": "take", "offer": "both", "time": "700"})
    assert state.imports.files == files
    assert state.page == "Import"


def test_files_are_capped_in_size_and_number(state: Workbench) -> None:
    model = state.imports
    model.add("large.csv", "A" * (MAX_FILE_BYTES * 4 // 3 + 8))
    assert model.refusal == "large.csv: larger than the 4 MB allowed for one file."
    for _ in range(MAX_FILES + 1):
        model.add("a\n.csv", "")
    assert len(model.files) == MAX_FILES
    assert model.refusal == f"a .csv: at most {MAX_FILES} files at a time; remove one first."


def test_another_scenario_beside_the_page_is_the_one_that_is_offered_with_the_line(state):
    """The offer had the vehicle of the scenario that was chosen when the files came."""
    choose_track(state)
    state.scenario.choose("tram-950m")
    (offer,) = state.imports.reading.offers
    state.imports.wanted = Wanted("line", f"{offer.time_s:g}")
    assert state.scenario.scenario().vehicle.name == load_scenario("tram-950m").vehicle.name
