"""Parts of pages that the program generates: commands from their parser, keys of files from their models."""

import argparse
import json
import re
import textwrap
from collections.abc import Callable, Iterator
from importlib.resources import files
from pathlib import Path
from typing import Any, get_args

from annotated_types import Ge, Gt, Le, Lt, MaxLen, MinLen
from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

from railjoule.core.scenario import Scenario, load_scenario, preset_names
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.command.cli import build_parser

SIGNS = {Ge: ("ge", "at least"), Gt: ("gt", "above"), Le: ("le", "at most"), Lt: ("lt", "below")}
LENGTHS = {MinLen: ("min_length", "at least {} entries"), MaxLen: ("max_length", "at most {} entries")}
WORDS = {float: "number", int: "whole number", str: "text", bool: "true or false"}


def command_line() -> str:
    """Return all commands with their arguments, as Markdown."""
    return "\n".join(_commands(build_parser()))


def _commands(parser: argparse.ArgumentParser) -> Iterator[str]:
    subcommands = [action for action in parser._actions if isinstance(action, argparse._SubParsersAction)]
    for action in subcommands:
        help_texts = {choice.dest: choice.help for choice in action._choices_actions}
        for name, child in action.choices.items():
            if any(isinstance(one, argparse._SubParsersAction) for one in child._actions):
                yield from _commands(child)
                continue
            yield f"## {child.prog}\n"
            yield f"{_sentence(help_texts[name])}\n"
            yield f"```text\n{_usage(child)}\n```\n"
            yield "| argument | meaning |\n| --- | --- |"
            yield from (_argument(one) for one in child._actions if one.dest != "help")
            yield f"\n{child.epilog}\n" if child.epilog else ""


def _usage(parser: argparse.ArgumentParser) -> str:
    words = " ".join(parser.format_usage().removeprefix("usage: ").split())
    return textwrap.fill(words, 92, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False)


def _argument(action: argparse.Action) -> str:
    names = ", ".join(f"`{name}`" for name in action.option_strings) or f"`{action.metavar or action.dest}`"
    meaning = (action.help or "").replace("%%", "%").replace("%(default)s", str(action.default))
    choices = f" One of {', '.join(f'`{choice}`' for choice in action.choices)}." if action.choices else ""
    return f"| {names} | {_cell(_sentence(meaning) + choices)} |"


def _sentence(text: str | None) -> str:
    text = (text or "").strip()
    return text[:1].upper() + text[1:] + ("" if text.endswith(".") else ".")


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")


def scenario_keys() -> str:
    """Return the keys of a scenario file, table by table, as Markdown."""
    return "\n".join(_tables(Scenario, "", {}))


def _tables(model: type[BaseModel], path: str, headings: dict[type[BaseModel], str]) -> Iterator[str]:
    """Yield the tables of a model and of its fields; `headings` has the heading of each model that is done."""
    heading = headings[model] = _heading(model, path)
    yield f"## {heading}\n"
    yield f"{_cell((model.__doc__ or '').strip().splitlines()[0])}\n"
    yield "| key | value | default | bounds | meaning |\n| --- | --- | --- | --- | --- |"
    for key, field in model.model_fields.items():
        yield f"| `{key}` | {_kind(field)} | {_default(field)} | {_bounds(field)} | {_cell(_meaning(field))} |"
    yield ""
    for key, field in model.model_fields.items():
        models = list(dict.fromkeys(_models(field.annotation)))
        place = f"{path}.{key}" if path else key
        new = [one for one in models if one not in headings]
        if models and not new:
            yield f"## `[{place}]`\n\nIts keys are those of {headings[models[0]].partition(' with ')[0]}.\n"
        for one in new:
            yield from _tables(one, place, headings)


def _heading(model: type[BaseModel], path: str) -> str:
    if not path:
        return "At the top of the file"
    # a table that may be of several kinds names its own
    kinds = ((key, get_args(field.annotation)) for key, field in model.model_fields.items() if field.is_required())
    named = next((f' with `{key} = "{words[0]}"`' for key, words in kinds if _is_one_text(words)), "")
    return f"`[{path}]`{named}"


def _is_one_text(words: tuple[Any, ...]) -> bool:
    return len(words) == 1 and isinstance(words[0], str)


def _models(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for inner in get_args(annotation):
        yield from _models(inner)


def _kind(field: FieldInfo) -> str:
    words: list[str] = []
    _describe(field.annotation, words)
    return " or ".join(dict.fromkeys(words))


def _describe(annotation: Any, words: list[str]) -> None:
    arguments = [one for one in get_args(annotation) if one is not type(None)]
    if annotation in WORDS:
        words.append(WORDS[annotation])
    elif isinstance(annotation, type) and issubclass(annotation, BaseModel):
        words.append("table")
    elif all(isinstance(one, str | bool | int) for one in arguments) and arguments:
        words.append(", ".join(f'`"{one}"`' for one in arguments))
    elif getattr(annotation, "__origin__", None) in {tuple, list, dict}:
        words.append("list of tables" if any(_models(annotation)) else "list")
    elif hasattr(annotation, "__metadata__"):
        _describe(arguments[0], words)
    else:
        for one in arguments:
            _describe(one, words)


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "required"
    if field.default in (None, "", ()) or isinstance(field.default, BaseModel) or field.default_factory is not None:
        return ""
    value = field.default
    text = json.dumps(value) if isinstance(value, str | bool | int | float) else str(value)
    return f"`{text}`"


def _bounds(field: FieldInfo) -> str:
    found: list[str] = []
    for one in (*field.metadata, *_inner(field.annotation)):
        for kind, (attribute, words) in SIGNS.items():
            if isinstance(one, kind):
                found.append(f"{words} {getattr(one, attribute):g}")
        for length, (attribute, words) in LENGTHS.items():
            if isinstance(one, length) and not (length is MinLen and getattr(one, attribute) == 0):
                unit = words if _kind(field) != "text" else words.replace("entries", "characters")
                found.append(unit.format(getattr(one, attribute)))
    return ", ".join(dict.fromkeys(found))


def _inner(annotation: Any) -> Iterator[Any]:
    # of a number that may be absent the bounds stand within the union; those of entries of a list are the list's own
    if getattr(annotation, "__origin__", None) in {tuple, list, dict}:
        return
    for one in getattr(annotation, "__metadata__", ()):
        yield from getattr(one, "metadata", [one])
    for inner in get_args(annotation):
        yield from _inner(inner)


def _meaning(field: FieldInfo) -> str:
    return field.description or ("Its keys stand below." if any(_models(field.annotation)) else "")


def papers() -> str:
    """Return all claims and printed numbers of the papers as Markdown, as `railjoule validate` prints them."""
    kept = json.loads(files("railjoule.assets").joinpath("papers", "computed.json").read_text(encoding="utf-8"))
    return "\n".join(line for name, paper in kept["papers"].items() for line in _paper(name, paper))


def _paper(name: str, paper: dict[str, Any]) -> Iterator[str]:
    yield f"## {name.capitalize()}\n"
    yield "### Claims\n"
    yield "| place | claim | railjoule | verdict | reason |\n| --- | --- | --- | --- | --- |"
    for claim in paper["claims"]:
        yield "| " + " | ".join(_cell(claim[key]) for key in ("place", "claim", "found", "verdict", "reason")) + " |"
    yield ""
    for table in paper["tables"]:
        place = f" ({table['place']})" if table["place"] else ""
        yield f"### {table['title']}{place}\n"
        yield f"| case | quantity | unit | {table['reference']} | railjoule |\n| --- | --- | --- | --- | --- |"
        for row in table["rows"]:
            printed = "" if row["printed"] is None else f"{row['printed']:g}"
            words = (row["case"], row["quantity"], row["unit"], printed, f"{row['value']:.5g}")
            yield "| " + " | ".join(map(_cell, words)) + " |"
        yield ""


def strategies() -> str:
    """Return the table of strategies, as Markdown."""
    rows = [
        f"| `{one.name}` | {one.label} | {_cell(one.help)} | {_cell(one.applies_to)} |" for one in STRATEGIES.values()
    ]
    return "\n".join(["| name | label | what it does | takes |", "| --- | --- | --- | --- |", *rows])


def scenarios() -> str:
    """Return the table of shipped scenarios, as Markdown."""
    loaded = ((name, load_scenario(name)) for name in preset_names("scenarios"))
    rows = [f"| `{name}` | {_cell(one.title)} | {one.strategy} |" for name, one in loaded]
    return "\n".join(["| name | title | strategy |", "| --- | --- | --- |", *rows])


MARKS: dict[str, Callable[[], str]] = {
    "<!-- the strategies -->": strategies,
    "<!-- the scenarios -->": scenarios,
    "<!-- the commands -->": command_line,
    "<!-- the keys of a scenario -->": scenario_keys,
    "<!-- the papers' numbers -->": papers,
}
"""Marks in pages, with the functions whose text replaces them."""


OPTIONAL = re.compile(r"^\? /(.+)\n", re.MULTILINE)
"""A line of a list of pages that counts where its page is there: other parts of the project bring some."""


def filled(text: str, pages: Path) -> str:
    """Return the text of a page with all marks filled, and its list without those that `pages` has not."""
    for mark, made in MARKS.items():
        if mark in text:
            text = text.replace(mark, made())
    return OPTIONAL.sub(lambda found: f"/{found[1]}\n" if (pages / f"{found[1]}.md").is_file() else "", text)


def _fill(app: Sphinx, _page: str, source: list[str]) -> None:
    source[0] = filled(source[0], Path(app.srcdir))


def _let_the_keyboard_scroll(_app: Sphinx, _page: str, _template: str, context: dict[str, Any], _tree: Any) -> None:
    # what is wider than the window scrolls by itself; without a place in the order of tabs only a mouse could do it
    for tag in ("<pre", "<table"):
        context["body"] = context.get("body", "").replace(tag, f'{tag} tabindex="0"')


def setup(app: Sphinx) -> dict[str, bool]:
    """Fill the marked places when a page is read."""
    app.connect("source-read", _fill)
    app.connect("html-page-context", _let_the_keyboard_scroll)
    # Pygments has no lexer for tables
    app.add_lexer("csv", TextLexer)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
