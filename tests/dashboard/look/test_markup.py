"""Texts stay texts in HTML; and no f-string of the dashboard makes HTML of what it has not escaped."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from railjoule.dashboard.look.markup import Markup, escaped, joined, markup

DASHBOARD = Path(__file__).parents[3] / "dashboard"
ELEMENT = re.compile(r"</?[a-zA-Z]")
NUMBER = re.compile(r"[.0-9]*[defgn%]$")
"""Formats that only numbers take: no text can stand there."""


def unsafe(tree: ast.AST) -> Iterator[str]:
    """Yield the f-strings that hold an element of HTML and anything but formatted numbers."""
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            fixed = "".join(str(part.value) for part in node.values if isinstance(part, ast.Constant))
            values = [part for part in node.values if isinstance(part, ast.FormattedValue)]
            formats = ["" if part.format_spec is None else ast.unparse(part.format_spec)[2:-1] for part in values]
            if ELEMENT.search(fixed) and not all(NUMBER.fullmatch(form) for form in formats):
                yield f"line {node.lineno}: {ast.unparse(node)[:90]}"


@pytest.mark.parametrize("path", sorted(DASHBOARD.rglob("*.py")), ids=lambda path: str(path.relative_to(DASHBOARD)))
def test_no_text_gets_into_html_unescaped(path: Path) -> None:
    assert list(unsafe(ast.parse(path.read_text(encoding="utf-8")))) == []


@pytest.mark.parametrize(
    ("code", "count"),
    [("f'<p>{x}</p>'", 1), ("f'<p>{x:.1f}</p>'", 0), ("f'<p>{x!s}</p>'", 1), ("f'{x} < {y}'", 0), ("f'<p>{x:>9}'", 1)],
)
def test_the_search_finds_what_it_looks_for(code: str, count: int) -> None:
    assert len(list(unsafe(ast.parse(code)))) == count


def test_texts_are_escaped_and_pieces_of_html_are_not() -> None:
    piece = markup('<p title="{}">{}</p>', '"><script>', 5)
    assert piece == '<p title="&quot;&gt;&lt;script&gt;">5</p>'
    assert markup("<b>{a}{b}</b>", a=piece, b="<i>") == f"<b>{piece}&lt;i&gt;</b>"
    assert joined([piece, "<", Markup("<hr>")]) == f"{piece}&lt;<hr>"
    assert escaped("</style>") == "&lt;/style&gt;"
    assert isinstance(joined([]), Markup)
