"""The page Help without a browser."""

from html import unescape
from pathlib import Path

import pytest
from commands import answer

from railjoule.dashboard.limits import limits, markdown
from railjoule.dashboard.pages.help.page import documentation_html, help_html


@pytest.mark.parametrize("built", [True, False])
def test_the_documentation_is_linked_once_it_is_built(built: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """An installed package has no built documentation: a link there would lead nowhere."""
    monkeypatch.setattr("railjoule.dashboard.pages.help.page.is_built", lambda: built)
    assert ('href="docs/"' in documentation_html()) == built


DOCS = Path(__file__).resolve().parents[4] / "assets" / "docs" / "limits.md"


def test_the_page_the_terminal_and_the_docs_list_each_limit(capsys):
    printed, page = answer(capsys, "limits"), unescape(help_html())
    for limit in limits():
        assert f"<td>{limit.of}</td><td>{limit.page}</td><td>{limit.library}</td>" in page
        assert any(line.split("  ")[0] == limit.of and limit.page in line for line in printed.splitlines())
    assert DOCS.read_text(encoding="utf-8") == markdown(), "renew it by its own command"
