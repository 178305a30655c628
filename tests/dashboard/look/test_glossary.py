"""The glossary explains all that the pages show, briefly, and nothing else."""

import ast
import re
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from pathlib import Path

import pytest
from documents import blocks, text_of

import railjoule.dashboard
from railjoule.dashboard.look import words
from railjoule.dashboard.look.glossary import MOST_WORDS, TERMS, Term, find_term, info, texts
from railjoule.dashboard.workbench import Workbench

DASHBOARD = Path(railjoule.dashboard.__file__).parent
EXPLAINING = ("glossary.py", "help.py")


def sources() -> Iterator[ast.Module]:
    """Yield the modules of the dashboard but those that explain."""
    for path in sorted(DASHBOARD.rglob("*.py")):
        if not path.as_posix().endswith(EXPLAINING):
            yield ast.parse(path.read_text(encoding="utf-8"))


def constants(node: ast.expr) -> list[str] | None:
    """Return the texts that an expression can be; None where they cannot be told."""
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return [node.value]
    if isinstance(node, ast.IfExp):
        both = constants(node.body), constants(node.orelse)
        return None if None in both else [text for texts in both for text in texts or ()]
    return None


def head_numbers(modules: Iterable[ast.Module]) -> Iterator[tuple[str, list[str] | None]]:
    """Yield each call that makes a number of a page's head, with what the glossary is asked for."""
    for module in modules:
        for call in ast.walk(module):
            if not isinstance(call, ast.Call) or not call.args:
                continue
            if getattr(call.func, "attr", getattr(call.func, "id", "")) == "figure" and len(call.args) >= 4:
                term = next((keyword.value for keyword in call.keywords if keyword.arg == "term"), call.args[0])
                yield ast.unparse(call)[:90], constants(term)


def the_added_page() -> Iterator[ast.Module]:
    """Yield the modules of the page that a guide adds."""
    for block in blocks(text_of("howto/add_page"), "python"):
        yield ast.parse(block)


@pytest.mark.parametrize(("modules", "least"), [(sources, 31), (the_added_page, 1)])
def test_every_number_of_a_head_is_explained(modules: Callable[[], Iterator[ast.Module]], least: int) -> None:
    found = list(head_numbers(modules()))
    assert len(found) >= least
    for call, labels in found:
        assert labels, f"give it a term: {call}"
        for label in labels:
            assert not label or find_term(label) is not None, f"no entry for {label!r}: {call}"


def test_every_strategy_is_explained() -> None:
    assert all(find_term(label) is not None for label in words.STRATEGY_WORDS.values())


@pytest.mark.parametrize("term", TERMS, ids=lambda term: term.slug)
def test_an_entry_is_short_and_plain(term: Term) -> None:
    assert len(term.text.split()) <= MOST_WORDS
    assert term.text.endswith(".")
    assert not re.search(r"[<>&]", term.name + term.text + "".join(term.labels))


def test_names_and_labels_are_distinct_numbers() -> None:
    labels = [label for term in TERMS for label in (term.name, *term.labels)]
    assert len(labels) == len(set(labels))
    assert len(texts()) == len(TERMS)


@cache
def shown_strings() -> frozenset[str]:
    """Return all texts of the dashboard's sources but what documents the code."""
    found = {label.lower() for label in words.STRATEGY_WORDS.values()}
    # labels with their unit are put together where a field is declared
    models = Workbench().models.values()
    found |= {
        parameter.label.lower() for model in models for parameter in model.param.objects().values() if parameter.label
    }
    for module in sources():
        told = {id(node.value) for node in ast.walk(module) if isinstance(node, ast.Expr)}
        found |= {
            node.value.lower()
            for node in ast.walk(module)
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in told
        }
    return frozenset(found)


@pytest.mark.parametrize("term", TERMS, ids=lambda term: term.slug)
def test_each_term_is_used_on_a_page(term: Term) -> None:
    strings = shown_strings()
    names = [name.lower() for name in (term.name, *term.labels)]
    assert any(name in string for name in names for string in strings), names


def test_a_label_without_an_entry_has_no_button() -> None:
    assert info("Something else") == ""
    assert "data-term='enoc'" in info("ENOC")
