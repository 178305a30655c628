import json
from urllib.parse import quote, urlencode

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import load_scenario
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.keep.link import LONGEST_QUERY, LinkTooLongError, read_link, write_link
from railjoule.dashboard.keep.snapshot import fields_of, lay, originals_of, snapshot_of
from railjoule.dashboard.limits import LONGEST_LINK, LONGEST_TEXT
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.workbench import Workbench

STATE = Workbench()
KEYS = [key for key, _, _ in fields_of(STATE)]


def link_of(state: Workbench) -> str:
    snapshot = snapshot_of(state)
    return write_link(snapshot, originals_of(snapshot))


def test_a_link_names_what_differs_and_can_be_read() -> None:
    state = Workbench()
    lay(state, {})
    assert link_of(state) == ""
    state.scenario.param.update(travel_time_s=150.0, load_percent=30.5)
    state.param.update(page="Set speeds", ticked=["optimal", "eoc"])
    link = "?v=1&page=Set+speeds&ticked=optimal,eoc&travel_time_s=150&load_percent=30.5"
    assert link_of(state) == link
    read = read_link(link)
    assert read.refusal == ""
    assert read.snapshot == {
        "page": "Set speeds",
        "ticked": ["optimal", "eoc"],
        "travel_time_s": 150,
        "load_percent": 30.5,
    }


def test_a_long_state_stands_behind_the_hash() -> None:
    state = Workbench()
    lay(state, {})
    sections = [{"length_m": 100.0 + 1.37 * k, "gradient_permille": (7 * k) % 11 - 5.0} for k in range(300)]
    state.scenario.edit({"line": {"sections": sections}, "timetable.travel_time_s": 3000.0})
    link = link_of(state)
    assert link.startswith("#v=1&")
    assert LONGEST_QUERY < len(link) < 20_000
    assert read_link(link).snapshot["edits"]["line"]["sections"] == sections


def test_the_scenario_of_a_file_goes_with_the_link() -> None:
    state = Workbench()
    state.scenario.open(
        format_scenario(load_scenario("ftorek-300s").replace(title="<b>M\u00fcller & S\u00f6hne</b>")), "x"
    )
    lay(state, snapshot_of(state))
    other = Workbench()
    assert lay(other, read_link(link_of(state)).snapshot) == ()
    assert other.scenario.scenario() == state.scenario.scenario()


@pytest.mark.parametrize(
    ("query", "sentence"),
    [
        ("?v=2&load_percent=30", "The link has version 2, but this page reads version 1; it was not opened."),
        pytest.param("?v=1&" + "&k=1" * 600, "has more than the limit of 500 values", id="many values"),
        pytest.param("?v=1&toml=" + "a" * LONGEST_LINK, "longer than the limit of 2,000,000 characters", id="long"),
        ("?v=1&load_percent=340", "load_percent = 340 must be at most 300."),
        ("?v=1&load_percent=nan", "load_percent = nan must be a finite number."),
        ("?v=1&travel_time_s=1e9", "travel_time_s = 1e9 must be at most 86400."),
        ("?v=1&travel_time_s=" + "9" * 400, "must be a finite number."),
        ("?v=1&robustness.seed=1.5", "robustness.seed = 1.5 must be a whole number."),
        ("?v=1&over_time=maybe", "over_time = maybe must be true or false."),
        ("?v=1&page=Nowhere", "page = Nowhere is not one of the 13 known."),
        ("?v=1&colours=green", "colours = green must be one of system, light, dark."),
        ("?v=1&preset=liashenko-2", "preset = liashenko-2 is not one of the 20 known; did you mean liashenko-i?"),
        ("?v=1&wings=2", "wings is not known."),
        ("?v=1&edits=~AAAA", "is damaged"),
        ("?v=1&edits=[1]", "edits = [1] must be a table."),
        ("?v=1&disturbances.events=" + quote('[{"position_m":-5}]'), "has position_m = -5, which must be at least 0."),
        ("?v=1&disturbances.events=" + quote(json.dumps([{}] * 501)), "must have at most 500 entries."),
    ],
)
def test_what_cannot_be_opened_is_told(query: str, sentence: str) -> None:
    assert sentence in read_link(query).refusal


def test_an_address_without_a_version_may_carry_anybody_s_values() -> None:
    read = read_link("?utm_source=mail&page=Set+speeds&load_percent=20")
    assert (read.snapshot, read.refusal) == ({"page": "Set speeds", "load_percent": 20}, "")


@pytest.mark.parametrize(
    ("query", "snapshot"),
    [
        ("robustness.seed=7&robustness.actual_load_percent=80", {"day.seed": 7, "day.actual_load_percent": 80}),
        (
            "actual.on=true&actual.reaction=known&disturbances.accepted_delay_s=5",
            {"day.on": True, "day.reaction": "known", "day.accepted_delay_s": 5},
        ),
        (
            "disturbances.events=" + quote('[{"kind":"stop","position_m":500}]'),
            {"day.events": [{"kind": "stop", "position_m": 500}]},
        ),
        ("robustness.measure=delay_s&robustness.candidates=9", {"what_if.measure": "delay_s", "what_if.candidates": 9}),
        ("robustness.knows=both", {"what_if.known": "both"}),
        ("robustness.accepted_delay_s=4", {"what_if.accepted_lateness_s": 4}),
        ("page=Robustness", {"page": "What if", "what_if.tab": "load"}),
        ("page=Disturbances", {"page": "What if", "what_if.tab": "events"}),
        ("page=Speed+limits&speed_limits.section_count=3", {"page": "Set speeds", "set_speeds.section_count": 3}),
    ],
)
@pytest.mark.parametrize("version", ["v=1&", ""])
def test_a_link_with_earlier_keys_opens(query: str, snapshot: dict[str, object], version: str) -> None:
    read = read_link(f"?{version}{query}")
    assert (read.snapshot, read.refusal) == (snapshot, "")


def test_a_link_of_an_earlier_version_fixes_an_arrival() -> None:
    stations = (
        '[{"number":0,"station":"Old+Town","position_m":1150,"dwell_s":25,"fixed":false,"arrival_s":0},'
        '{"number":1,"station":"Market","position_m":1950,"dwell_s":30,"fixed":true,"arrival_s":190}]'
    )
    state, read = Workbench(), read_link(f"?v=1&preset=metro-10-stations&line.stations={stations}")
    state.scenario.choose("metro-10-stations")
    # on a page its work does so
    state.pages["Set speeds"].take(state.scenario.base)
    assert (lay(state, read.snapshot), read.refusal) == ((), "")
    assert state.scenario.scenario().line.stations[2].window_s == (190, 190)


def test_nothing_grows_beyond_bounds_when_it_is_unpacked() -> None:
    bomb = write_link({"toml": "#" * (LONGEST_TEXT + 1), "preset": "x", "edits": {}}, {})
    assert len(bomb) < 20_000
    assert "too long or incomplete" in read_link(bomb).refusal


def test_a_state_that_no_address_holds_is_told() -> None:
    noise = np.random.default_rng(1).bytes(LONGEST_LINK).hex()
    with pytest.raises(LinkTooLongError, match="an address holds at most 2,000,000"):
        write_link({"toml": noise, "preset": "x", "edits": {}}, {})


VALUES = st.one_of(
    st.text(max_size=30),
    st.sampled_from(["nan", "inf", "-1", "1e999", "none", "true", "~", "~eJw", "[]", "{}", "null", "[[[[", "[{}]"]),
    st.floats().map(repr),
    st.integers().map(str),
    st.recursive(
        st.none() | st.booleans() | st.floats() | st.text(max_size=8),
        lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
        max_leaves=8,
    ).map(json.dumps),
)


@given(st.dictionaries(st.sampled_from([*KEYS, "v"]) | st.text(max_size=12), VALUES, max_size=6), st.booleans())
def test_any_link_is_read_within_bounds(pairs: dict[str, str], versioned: bool) -> None:
    read = read_link("?" + urlencode({"v": "1", **pairs} if versioned else pairs, errors="replace"))
    known = {key: (model, name) for key, model, name in fields_of(STATE)}
    for key, value in read.snapshot.items():
        model, name = known[key]
        assert model.checked(name, value) == value
        low, high = model.field_bounds(name)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            assert low is None or value >= low
            assert high is None or value <= high
    assert len(read.refusal) < 2000


@given(st.text(max_size=200))
def test_any_text_is_read(text: str) -> None:
    read_link(text)


# a page in sight would compute
@given(st.dictionaries(st.sampled_from([key for key in KEYS if key != "page"]), VALUES, max_size=5))
def test_any_link_can_be_laid(pairs: dict[str, str]) -> None:
    state = Workbench()
    for page in ("What if", "Set speeds"):
        PageWorks(state.pages[page])
    lay(state, read_link("?" + urlencode({**pairs, "v": "1"}, errors="replace")).snapshot)
    snapshot_of(state)
    state.scenario.scenario()
