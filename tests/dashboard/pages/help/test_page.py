"""The page Help without a browser."""

from html import unescape
from pathlib import Path

import pytest
from commands import answer

from railjoule.dashboard.limits import limits, markdown
from railjoule.dashboard.look.glossary import TERMS
from railjoule.dashboard.page_list import PAGES
from railjoule.dashboard.pages.help.page import USES, documentation_html, glossary_html, last_html


@pytest.mark.parametrize("built", [True, False])
def test_the_documentation_is_linked_once_it_is_built(built: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """An installed package has no built documentation: a link there would lead nowhere."""
    monkeypatch.setattr("railjoule.dashboard.pages.help.page.is_built", lambda: built)
    assert ('href="docs/"' in documentation_html()) == built


DOCS = Path(__file__).resolve().parents[4] / "assets" / "docs" / "limits.md"


def test_the_page_the_terminal_and_the_docs_list_each_limit(capsys):
    printed, page = answer(capsys, "limits"), unescape(last_html())
    for limit in limits():
        assert f"<td>{limit.of}</td><td>{limit.page}</td><td>{limit.library}</td>" in page
        assert any(line.split("  ")[0] == limit.of and limit.page in line for line in printed.splitlines())
    assert DOCS.read_text(encoding="utf-8") == markdown(), "renew it by its own command"


def test_each_page_has_its_use():
    assert USES.keys() == PAGES.keys()


def test_a_term_is_found_by_any_of_its_words():
    assert all(f'id="term-{term.slug}"' in glossary_html() for term in TERMS)
    # a label of "Energy saved per extra second", whose name does not have it
    found = glossary_html("EXTRA SECOND SAVES")
    assert found.count("<dt>") == 1
    assert 'id="term-energy-saved-per-extra-second"' in found
    assert "No term has" in glossary_html("no such term")
