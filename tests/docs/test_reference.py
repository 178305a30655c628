"""The reference is complete: what the program has stands in it."""

import argparse
import re
import sys
import tomllib

import pytest
from documents import DOCS, text_of

import railjoule.core
from railjoule.core.scenario import Scenario, format_scenario, load_scenario, preset_names, scenario_from_document
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.command.cli import build_parser

sys.path.insert(0, str(DOCS))

from building.colours import in_theme, with_variables
from building.generated import MARKS, command_line, filled, papers, scenario_keys, strategies
from railjoule.dashboard.look.tokens import DARK, LIGHT


def commands(parser: argparse.ArgumentParser) -> list[argparse.ArgumentParser]:
    inner = [action for action in parser._actions if isinstance(action, argparse._SubParsersAction)]
    return [one for action in inner for child in action.choices.values() for one in commands(child)] or [parser]


def test_every_command_stands_in_it_with_all_its_options():
    told = command_line()
    parsers = commands(build_parser())
    assert len(parsers) > 15
    for parser in parsers:
        own = told.partition(f"## {parser.prog}\n")[2].partition("\n## ")[0]
        for action in parser._actions:
            assert all(f"`{name}`" in own for name in action.option_strings if action.dest != "help"), parser.prog


def keys_of(table: dict[str, object], place: str = "") -> set[tuple[str, str]]:
    """Return the keys of a document, each with the table that it stands in."""
    found = set()
    for key, value in table.items():
        found.add((place, key))
        for one in value if isinstance(value, list) else [value]:
            if isinstance(one, dict):
                found |= keys_of(one, f"{place}.{key}" if place else key)
    return found


def reference_keys() -> dict[str, set[str]]:
    """Return the keys that the page tells, by table."""
    told: dict[str, set[str]] = {}
    for heading, body in re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", scenario_keys(), re.MULTILINE | re.DOTALL):
        place = re.match(r"`\[([\w.]+)\]`", heading)
        told.setdefault(place[1] if place else "", set()).update(re.findall(r"^\| `(\w+)` \|", body, re.MULTILINE))
    # as the page says: what stands there lies over the vehicle's drive
    told[""].add("drive")
    told["drive"] = told["vehicle.drive"]
    return told


@pytest.mark.parametrize("name", preset_names("scenarios"))
def test_every_key_of_a_shipped_scenario_stands_in_it(name):
    told = reference_keys()
    written = tomllib.loads(format_scenario(load_scenario(name)))
    assert {(place, key) for place, key in keys_of(written) if key not in told.get(place, set())} == set()


def test_keys_of_the_scenario_guide_are_those_of_the_models():
    """Each key of a table stands in the block of its heading, as the models have it."""
    generated, page = reference_keys(), text_of("howto/scenario")
    for place, table in re.findall(r"^## `\[([\w.]+)\]`\n(.*?)(?=^## |\Z)", page, re.MULTILINE | re.DOTALL):
        rows = [row for row in table.splitlines() if row.startswith("| `")]
        named = {key for row in rows for key in re.findall(r"`(\w+)`", row.split("|")[1])}
        # `file` is replaced by its sections when the scenario is read
        assert named - generated[place] <= ({"file"} if place == "line" else set()), place
    assert len(generated) > 30


def test_bounds_are_those_that_are_checked():
    """A number just beyond the bound that the page tells is refused, by hand for one key."""
    assert (
        "| `load_factor` | number | `0.0` | at least 0, at most 3 | Share of the capacity on board. |"
        in scenario_keys()
    )
    document = {"vehicle": {"preset": "metro-81-7036"}, "line": {"preset": "liashenko-ii"}}
    with pytest.raises(railjoule.core.ScenarioError, match=r"load_factor = 3\.1"):
        scenario_from_document(
            {**document, "vehicle": {**document["vehicle"], "load_factor": 3.1}, "timetable": {"travel_time_s": 150}}
        )


def test_every_field_of_the_scenario_has_words():
    rows = [line for line in scenario_keys().splitlines() if line.startswith("| `")]
    assert len(rows) > 150
    assert [row for row in rows if row.rstrip(" |").endswith("|")] == []
    assert all(f"| `{key}` |" in scenario_keys() for key in Scenario.model_fields)


def test_numbers_of_the_papers_are_those_that_are_shipped():
    """Table 1 of Ftorek: 4714.9 Wh are printed, and 4618 Wh is what less can be had with, see core/validation."""
    assert "| T_m = 270 s | W_T | Wh | 4714.9 | 4618.1 |" in papers()


def test_every_strategy_stands_in_its_table_with_what_it_takes():
    rows = strategies().splitlines()[2:]
    assert [row.split("`")[1] for row in rows] == list(STRATEGIES)
    assert all(STRATEGIES[row.split("`")[1]].applies_to in row for row in rows)


def test_every_mark_stands_in_one_page():
    for mark in MARKS:
        assert sum(mark in path.read_text(encoding="utf-8") for path in DOCS.rglob("*.md")) == 1


def test_a_page_that_others_bring_stands_in_its_list_once_it_is_there(tmp_path):
    (tmp_path / "serve.md").write_text("# Serve\n", encoding="utf-8")
    assert filled("first\n? /serve\n? /tested\nlast\n", tmp_path) == "first\n/serve\nlast\n"


def test_pictures_take_the_colours_of_the_page():
    drawn = f'<path style="stroke: {LIGHT["enoc"].lower()}"/>'
    assert with_variables(drawn) == '<path style="stroke: var(--rj-enoc)"/>'
    assert in_theme(drawn, "dark") == f'<path style="stroke: {DARK["enoc"]}"/>'
