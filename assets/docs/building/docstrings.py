"""Docstrings as Sphinx reads them: what the code marks as a name is set as code."""

import re
from typing import Any

from sphinx.application import Sphinx

NAME = re.compile(r"(?<![`:\w])`([^`\n]+)`(?![`_])")
SPECIAL = re.compile(r"(?<![\\`])([*|])(?!\*)")


def _set_names_as_code(_app: Sphinx, _what: str, _name: str, _thing: Any, _options: Any, lines: list[str]) -> None:
    for number, line in enumerate(lines):
        parts = re.split(r"(``[^`]*``)", NAME.sub(r"``\1``", line))
        # what is not code may hold signs that reStructuredText would take for its own
        lines[number] = "".join(part if part.startswith("``") or ":" in part[:1] else _plain(part) for part in parts)


def _plain(text: str) -> str:
    return text if text.lstrip().startswith(("*", "|", ":", "..")) else SPECIAL.sub(r"\\\1", text)


def _without_signature(_app: Sphinx, what: str, *_: Any) -> tuple[str, None] | None:
    # a class is shown by what it holds; most are made by functions, and none by hand with twenty arguments
    return ("", None) if what == "class" else None


def setup(app: Sphinx) -> dict[str, bool]:
    """Change docstrings and the signatures of classes before they are read."""
    # before napoleon, which makes reStructuredText of their sections
    app.connect("autodoc-process-docstring", _set_names_as_code, priority=400)
    app.connect("autodoc-process-signature", _without_signature)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
