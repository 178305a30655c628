"""Words and patterns that the style of the project's English avoids: none in texts, fewer and fewer in code and tests.

Texts are the docstrings and strings of Python, the scripts, and all pages of the documentation. For all else
`english_limits.json` contains the limit of each file beside the patterns; a file that is not listed has the limit 0.
`python -m tests.test_english` lowers the limits to the present counts, and refuses to raise one. Rename the key of a
renamed file by hand. `--reset` accepts every present count, for a merge of branches that moved text between files.
"""

import argparse
import ast
import json
import re
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]
LIMITS = ROOT / "tests" / "english_limits.json"
FOLDERS = ("core", "dashboard", "assets", "tests")
ENDINGS = {".py", ".js", ".md", ".toml"}
TEXTS = ("core/**/*.py", "dashboard/**/*.py", "core/*.md", "*.md", ".github/*.md")
ASSETS = {".css", ".html", ".ipynb", ".js", ".md", ".py", ".toml"}
FORMER = {"robustness.k" + "nows"}
"""A key in addresses of earlier versions, which still open."""


def load() -> dict[str, Any]:
    """Return patterns by the advice for each, and limits by file."""
    loaded: dict[str, Any] = json.loads(LIMITS.read_text(encoding="utf-8"))
    return loaded


def hits(text: str, patterns: Mapping[str, str]) -> list[tuple[int, str, str]]:
    """Return line number, matched text and advice for each occurrence of a pattern."""
    found = [
        (text.count("\n", 0, hit.start()) + 1, hit[0].strip(), advice)
        for advice, pattern in patterns.items()
        for hit in re.finditer(pattern, text, re.MULTILINE)
    ]
    return sorted(found)


def texts(path: Path) -> Iterator[tuple[int, str]]:
    """Yield line number and content of each text of a file: of Python the literals, which include docstrings."""
    source = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        yield 1, source
        return
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value not in FORMER:
            yield node.lineno, node.value


def all_hits(patterns: Mapping[str, str]) -> dict[str, list[tuple[int, str, str]]]:
    """Return the occurrences by file, for files that have any."""
    paths = (path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*")) if path.suffix in ENDINGS)
    files = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in paths}
    return {name: found for name, text in files.items() if (found := hits(text, patterns))}


def excess(found: Mapping[str, list[tuple[int, str, str]]], limits: Mapping[str, int]) -> list[str]:
    """Return for each file above its limit one line per occurrence, then its count and limit."""
    lines: list[str] = []
    for name, rows in found.items():
        if len(rows) > (limit := limits.get(name, 0)):
            lines += [f"{name}:{line}: '{words}': {advice}" for line, words, advice in rows]
            lines.append(f"{name}: {len(rows)} found, at most {limit} permitted: rewrite {len(rows) - limit} of them.")
    return lines


def test_no_text_has_an_avoided_word() -> None:
    patterns = load()["patterns"]
    paths = {path for pattern in TEXTS for path in ROOT.glob(pattern)}
    paths |= {path for path in (ROOT / "assets").rglob("*") if path.suffix in ASSETS}
    found = [
        f"{path.relative_to(ROOT)}:{first + line - 1}: '{words}': {advice}"
        for path in sorted(paths)
        for first, text in texts(path)
        for line, words, advice in hits(text, patterns)
    ]
    assert len(paths) > 500, "the texts are found"
    assert not found, "Words that the style avoids:\n" + "\n".join(found)


def test_no_file_has_more_avoided_words_than_its_limit() -> None:
    known = load()
    found = all_hits(known["patterns"])
    above = excess(found, known["limits"])
    if above:
        pytest.fail("Words that the style avoids:\n" + "\n".join(above), pytrace=False)
    lower = [name for name, limit in known["limits"].items() if len(found.get(name, ())) < limit]
    if lower:
        print(f"{len(lower)} limits can be lowered: python -m tests.test_english")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("def f(): # s" + "eldom\n", ["s" + "eldom"]),
        ("x_t" + "old = 1", ["t" + "old"]),
        ("It is read.\nW" + "hat it has is sent.", ["W" + "hat"]),
        ('title = "W' + 'ho goes"', ['= "W' + "ho"]),
        ("<h2>W" + "here it goes</h2>", [">W" + "here"]),
        ("The page is W" + "hat if.\nW" + "hat if follows.", []),
        ("def kind" + "_of(x):", ["def kind" + "_of"]),
        ("a roof, a tender, the mendicant, standalone; def f(): return 1", []),
    ],
)
def test_patterns_match_words_sentences_and_names(text: str, words: list[str]) -> None:
    assert [hit[1] for hit in hits(text, load()["patterns"])] == words


def test_a_new_file_has_the_limit_zero() -> None:
    found = {"core/new.py": [(7, "word", "advice")], "core/old.py": [(1, "word", "advice")] * 2}
    assert excess(found, {"core/old.py": 2}) == [
        "core/new.py:7: 'word': advice",
        "core/new.py: 1 found, at most 0 permitted: rewrite 1 of them.",
    ]


def main() -> int:
    """Lower the limits to the present counts; return 2 if a file is above its limit and `--reset` is not given."""
    parser = argparse.ArgumentParser(prog="python -m tests.test_english", description=__doc__)
    parser.add_argument("--reset", action="store_true", help="accept higher counts too")
    known = load()
    reset = parser.parse_args().reset
    found = all_hits(known["patterns"])
    above = excess(found, known["limits"])
    if above and not reset:
        print("\n".join(above), file=sys.stderr)
        return 2
    known["limits"] = {name: len(rows) for name, rows in sorted(found.items())}
    LIMITS.write_text(json.dumps(known, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{sum(known['limits'].values())} in {len(known['limits'])} files")
    return 0


if __name__ == "__main__":
    sys.exit(main())
