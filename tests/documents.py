"""The pages that tell of railjoule: README.md, those of assets/docs, and their blocks of code."""

import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "assets" / "docs"
README = ROOT / "README.md"
PAPER = DOCS / "paper" / "paper.md"
FENCE = re.compile(r"^```(?P<kind>[^\s`]*)[^\n`]*\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Block:
    """One block of code: its kind, empty where it has none, and its text."""

    kind: str
    text: str


def pages() -> list[Path]:
    """Return all pages with examples: README and the documentation, without the paper."""
    return [README, *sorted(path for path in DOCS.rglob("*.md") if path != PAPER)]


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def text_of(name: str) -> str:
    """Return the text of a page of the documentation, named without its ending."""
    return (DOCS / f"{name}.md").read_text(encoding="utf-8")


def blocks_in(text: str) -> list[Block]:
    return [Block(found["kind"], found["text"]) for found in FENCE.finditer(text)]


def blocks(text: str, kind: str) -> list[str]:
    """Return the blocks of one kind in a text."""
    return [block.text for block in blocks_in(text) if block.kind == kind]


def run_python(
    arguments: list[str], folder: Path, environment: dict[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
