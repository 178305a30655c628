"""Texts in TOML from anybody."""

import time
import tomllib
import tracemalloc

import pytest
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import ScenarioError
from railjoule.core.scenario.text_file import MAX_KEY_PARTS, TomlError, read_toml, require_short_keys

LONG = ".".join("a" * (MAX_KEY_PARTS + 1))
SHORT = ".".join("a" * MAX_KEY_PARTS)


@pytest.mark.parametrize(
    "text",
    [
        f"{LONG} = 1",
        f"x = 1\n  {LONG.replace('.', ' . ')} = 1",
        f"[{LONG}]",
        f"[[ {LONG} ]]",
        f"x = {{{LONG} = 1}}",
        f"x = [1, {{b = 1, {LONG} = 1}}]",
        LONG.replace("a", '"a.b"') + " = 1",
        LONG.replace("a", "'#'") + " = 1",
        LONG.replace("a", '"\u2028"') + " = 1",
        f'x = """\n""a\\"""""" # "\n{LONG} = 1',
        f"x = '''\n'''''\n{LONG} = 1",
        f'x = ["""x"""", {{{LONG} = 1}}, "y"]',
    ],
)
def test_keys_of_many_parts_are_refused(text):
    with pytest.raises(ScenarioError, match=r"^x: not a valid scenario: a key in line \d has more than 6 parts with"):
        read_toml(text, "x")


@pytest.mark.parametrize(
    "text",
    [
        f"{SHORT} = 1",
        f'title = "{LONG}"',
        f"title = '{LONG}'",
        f'title = """\n{LONG} = 1\n"""',
        f"title = '''\n{LONG} = 1\n'''",
        f"# {LONG} = 1",
        "x = [" + "1.5, " * 50 + "]",
        f'x = ["\\"", "{LONG}"]',
    ],
)
def test_dots_elsewhere_are_not_counted(text):
    assert read_toml(text, "x") == tomllib.loads(text)


KEY = st.integers(1, 12).map(lambda parts: ".".join("a" * parts))
STRINGS = st.sampled_from(
    [
        '""',
        '"\\""',
        "''",
        "'\"'",
        '"a.a.a.a.a.a.a.a"',
        '"""x"""',
        '"""x""""',
        '"""x"""""',
        "'''x''''",
        "'''\n'''",
        "1.5",
    ]
)


@given(KEY, st.lists(st.tuples(KEY, STRINGS), min_size=1, max_size=3), st.sampled_from([" ", "  # 'a", '# "']))
def test_no_text_around_a_key_hides_it(key, pairs, comment):
    values = ", ".join(f"{{{inner} = {value}}}" for inner, value in pairs)
    text = f"x = [{values}, '''\n'''] {comment}\n{key} = 1\n"
    parts = max(len(one.split(".")) for one in (key, *(inner for inner, _ in pairs)))
    tomllib.loads(text)  # it is valid
    try:
        require_short_keys(text, "x")
        refused = False
    except ScenarioError:
        refused = True
    assert refused == (parts > MAX_KEY_PARTS)


@pytest.mark.parametrize("count", [50_000, 1_000_000])
def test_a_key_of_very_many_parts_is_refused_at_once(count):
    text = ".".join("a" * count) + "=1"
    tracemalloc.start()
    started = time.process_time()
    with pytest.raises(ScenarioError):
        read_toml(text, "x")
    taken = time.process_time() - started
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert taken < 1.0
    assert peak < 20e6


@pytest.mark.parametrize("text", ["time_s;speed_kmh\n0;0\n", "x = ", "{}"])
def test_what_is_no_toml_can_be_told_from_what_is_wrong_in_it(text):
    with pytest.raises(TomlError, match=r"^x: not a valid TOML file: "):
        read_toml(text, "x")
