import base64
import json
import tracemalloc
from urllib.parse import urlencode

import pytest
from panel.io.state import set_curdoc
from turns import Page

from railjoule.core import load_scenario
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.keep.keeping import Keeping
from railjoule.dashboard.keep.link import _packed
from railjoule.dashboard.keep.snapshot import snapshot_of
from railjoule.dashboard.limits import LARGEST_RUN_BYTES
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.shell.share import file_name
from railjoule.dashboard.shell.sidebar import Changes
from railjoule.dashboard.workbench import Workbench


@pytest.fixture
def state() -> Workbench:
    """The state of a page with the work behind it, none of whose pages with work of its own is in sight."""
    state = Workbench()
    for page in ("What if", "Set speeds", "Motor", "Line"):
        PageWorks(state.pages[page])
    return state


@pytest.fixture
def keeping(state: Workbench) -> Keeping:
    keeping = Keeping(state, Browser())
    keeping.begin("")
    return keeping


def test_a_new_page_has_a_bare_address_and_nothing_to_undo(keeping: Keeping) -> None:
    assert keeping.browser.address == ""
    assert not keeping.can_undo
    for preset in ("liashenko-ii", "tram-950m-stop", "ftorek-300s"):
        keeping.state.scenario.choose(preset)
        keeping.note()
        assert keeping.browser.address == f"?v=1&preset={preset}"


def test_steps_back_and_forth_change_state_and_address(keeping: Keeping) -> None:
    scenario, limits = keeping.state.scenario, keeping.state.pages["Set speeds"]
    scenario.load_percent = 30.0
    keeping.note()
    limits.section_count = 4
    keeping.note()
    scenario.choose("liashenko-ii")
    keeping.note()
    keeping.undo()
    assert (scenario.preset, scenario.load_percent) == (Workbench().scenario.preset, 30.0)
    assert len(limits.sections) == limits.section_count == 4
    keeping.undo()
    assert len(limits.sections) == limits.section_count == 2
    keeping.undo()
    assert keeping.browser.address == ""
    assert not keeping.can_undo
    keeping.redo()
    keeping.redo()
    keeping.redo()
    assert keeping.browser.address == "?v=1&preset=liashenko-ii"
    assert not keeping.can_redo


def test_a_change_is_noted_with_its_runs_but_not_with_each_of_many(
    keeping: Keeping, monkeypatch: pytest.MonkeyPatch
) -> None:
    state, now_s = keeping.state, [100.0]
    monkeypatch.setattr("railjoule.dashboard.keep.keeping.time.monotonic", lambda: now_s[0])
    for later_s, time_s, noted in ((1.0, 140.0, "140"), (0.05, 141.0, "140"), (0.2, 142.0, "142")):
        now_s[0] += later_s
        with set_curdoc(Page().document):
            state.scenario.travel_time_s = time_s
            state.param.trigger("runs")
        assert keeping.browser.address == f"?v=1&travel_time_s={noted}"


def test_a_page_begins_with_the_state_of_its_address(state: Workbench) -> None:
    keeping = Keeping(state, Browser())
    keeping.begin("?v=1&preset=liashenko-i&load_percent=30&robustness.seed=7&load=2")
    assert (state.scenario.preset, state.scenario.load_percent, state.day.seed) == ("liashenko-i", 30, 7)
    assert state.notice == "Parts of the link were ignored: load is not known."
    assert keeping.browser.address == "?v=1&preset=liashenko-i&load_percent=30&day.seed=7"
    assert not keeping.can_undo


def drop(keeping: Keeping, name: str, content: bytes) -> None:
    keeping.browser._handle_msg({"kind": "drop", "name": name, "data": base64.b64encode(content).decode()})


def test_a_dropped_file_is_shown_on_the_page_of_its_kind(keeping: Keeping) -> None:
    state = keeping.state
    drop(keeping, "limits.csv", b"from_m,to_m,limit_kmh\n0,500,60\n")
    assert state.page == "Files"
    assert [file.name for file in state.pages["Files"].files] == ["limits.csv"]
    drop(keeping, "large.nc", b"0" * (LARGEST_RUN_BYTES + 1))
    assert "larger than the 8 MB that can be dropped" in state.notice
    drop(keeping, "study.nc", b"CDF")
    assert state.page == "Explore"
    drop(keeping, "mine.toml", format_scenario(load_scenario("ftorek-300s").replace(title="Mine")).encode())
    assert state.scenario.base.title == "Mine"
    keeping.browser._handle_msg({"kind": "drop", "name": "a.csv", "data": "no base64!"})
    assert len(state.pages["Files"].files) == 1


def test_a_dropped_file_is_opened_or_refused(keeping: Keeping) -> None:
    keeping.open_file("mine.toml", format_scenario(load_scenario("ftorek-300s").replace(title="Mine")))
    assert keeping.state.scenario.base.title == "Mine"
    keeping.note()
    keeping.open_file("other.toml", "railjoule = 99")
    assert keeping.state.notice.startswith("other.toml: ")
    assert keeping.state.scenario.base.title == "Mine"
    drop(keeping, "picture.png", b"\x89PNG\xff")
    assert keeping.state.notice.startswith("picture.png: it is not UTF-8 text. Only scenarios")
    keeping.undo()
    assert keeping.state.scenario.opened is None


def test_changed_keys_can_be_taken_back_one_by_one(state: Workbench) -> None:
    browser = Browser()
    changes = Changes(state, browser)
    state.scenario.edit({"vehicle.auxiliary_power_kw": 40.0, "vehicle.load_factor": 0.3})
    browser._handle_msg({"kind": "changes"})
    assert "2 fields changed" in changes.view.object
    before = state.scenario.base.vehicle.auxiliary_power_kw
    assert f"{before:g} \u2192 40" in changes.view.object
    browser._handle_msg({"kind": "take_back", "name": "vehicle.auxiliary_power_kw"})
    assert dict(state.scenario.changes) == {"vehicle.load_factor": 0.3}


@pytest.mark.parametrize(
    ("title", "name"),
    [("Metro, profile II + I", "metro-profile-ii-i.toml"), ("<b>../..", "b.toml"), ("\u4e16\u754c", "scenario.toml")],
)
def test_a_file_s_name_is_made_of_letters_and_digits(title: str, name: str) -> None:
    assert file_name(title) == name


TOML = """
[vehicle]
preset = "metro-81-7036"
[line]
sections = [{length_m = 900}]
[timetable]
travel_time_s = 400
"""
DOTTED = ".".join("a" * 50_000)
HOSTILE = {
    "key of many parts": {"toml": f"{DOTTED} = 1"},
    "fine mesh": {"edits": json.dumps({"solver.mesh_m": 0.05})},
    "nested": {"edits": '{"a":' + "[" * 900 + "]" * 900 + "}"},
    "edit of many parts": {"edits": json.dumps({DOTTED: 1})},
    "edit of many rows": {"edits": json.dumps({"line.sections": [{"length_m": 1}] * 100_000})},
    "many edits": {"edits": json.dumps({f"line.a{number}": 1 for number in range(100_000)})},
    "many sections": {"toml": TOML.replace("sections = [", "sections = [" + "{length_m = 1}, " * 100_000)},
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.nightly][: name == "many sections"]) for name in HOSTILE]
)
def test_a_hostile_address_opens_a_page_that_says_so(name: str) -> None:
    state = Workbench()
    keeping = Keeping(state, Browser())
    packed = {key: _packed(text) for key, text in HOSTILE[name].items()}
    tracemalloc.start()
    keeping.begin(f"?{urlencode({'v': 1, 'page': 'Drive', **packed})}")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert state.notice.startswith("Parts of the link were ignored: ")
    assert len(state.notice) < 300
    assert (state.page, state.scenario.preset) == ("Drive", Workbench().scenario.preset)
    assert keeping.browser.address == "?v=1&page=Drive"
    assert peak < (200e6 if name == "many sections" else 50e6)


@pytest.mark.parametrize("error", [MemoryError, RecursionError, RuntimeError])
def test_an_address_that_breaks_something_opens_the_plain_page(
    state: Workbench, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, error: type[Exception]
) -> None:
    keeping, before = Keeping(state, Browser()), snapshot_of(state)

    def break_down(*_: object) -> None:
        state.scenario.load_percent = 77.0
        state.page = "Learn"
        raise error

    monkeypatch.setattr(keeping, "_open", break_down)
    keeping.begin("?v=1&page=Drive")
    assert snapshot_of(state) == before
    assert state.notice == "The link could not be opened; the server's log has the details."
    assert len(caplog.records) == 1
    assert keeping.browser.address == ""


def test_a_long_scenario_is_read_in_a_thread(state: Workbench) -> None:
    page, keeping = Page(), Keeping(state, Browser())
    sections = "{length_m = 1.0}, " * 4000
    long = TOML.replace("sections = [", f"sections = [{sections}")
    with set_curdoc(page.document):
        keeping.begin("")
        keeping.open_file("long.toml", long)
        assert state.scenario.opened is None
    page.take_turn()
    assert len(state.scenario.opened.line.sections) == 4001


def test_the_first_change_after_a_rest_is_noted_in_the_next_turn(
    keeping: Keeping, monkeypatch: pytest.MonkeyPatch
) -> None:
    state, now_s, page = keeping.state, [100.0], Page()
    monkeypatch.setattr("railjoule.dashboard.keep.keeping.time.monotonic", lambda: now_s[0])
    now_s[0] += 1.0
    with set_curdoc(page.document):
        state.scenario.load_percent = 30.0
    assert keeping.browser.address == ""
    page.take_turn()
    assert keeping.browser.address == "?v=1&load_percent=30"
    # what follows at once waits until NOTE_MS have passed
    with set_curdoc(page.document):
        state.scenario.load_percent = 40.0
    assert not page.is_due
