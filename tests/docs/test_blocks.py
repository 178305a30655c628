"""Every block of code in README and in the documentation: Python runs, commands are those of the real parser.

Examples with pictures run when the pages are built, which tests/browser/test_documentation.py does.
"""

import contextlib
import importlib.util
import io
import re
import shlex
import tomllib

import pytest
from documents import DOCS, README, ROOT, Block, blocks_in, name_of, pages

from railjoule.core.scenario import scenario_from_document
from railjoule.dashboard.command.cli import build_parser

PAGES = {name_of(page): page.read_text(encoding="utf-8") for page in pages()}
BUILT = {name_of(DOCS / "gallery.md"), name_of(DOCS / "explanation" / "proof.md")}
ADDED = ("# core/", "# dashboard/")
"""First words of a block that is a new file of the sources: tests/docs/test_guides.py adds it."""
SHOWN = {"text", "csv", "diff", "{toctree}", "{eval-rst}", "{include}"}
"""Kinds that are no code, or that other tests read."""
COMMANDS = {"sh", "console", ""}
OTHERS = {"dask", "nginx", "caddy"}
"""Programs of others that commands may start."""
EXTRAS = set(tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"])
RUN = set(re.findall(r"^(\w+)\)$", (ROOT / "run").read_text(encoding="utf-8"), re.MULTILINE))


def lines(kinds: set[str]) -> list[tuple[str, str]]:
    """Return the lines of all blocks of some kinds, each with its page."""
    return [
        (page, line)
        for page, text in PAGES.items()
        for block in blocks_in(text)
        if block.kind in kinds
        for line in block.text.splitlines()
        if line.strip()
    ]


def test_every_fence_is_a_block_of_a_known_kind():
    for page, text in PAGES.items():
        found = blocks_in(text)
        assert {block.kind for block in found} <= SHOWN | COMMANDS | {"python", "toml"}, page
        assert len(re.findall(r"^```", text, re.MULTILINE)) == 2 * len(found), page


def with_python() -> list[str]:
    return [name for name, text in PAGES.items() if any(block.kind == "python" for block in blocks_in(text))]


@pytest.mark.parametrize("page", [name for name in with_python() if name not in BUILT])
def test_python_runs_and_prints_what_is_shown(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": "__example__"}
    found = blocks_in(PAGES[page])
    # what follows a block of Python as text is what it prints
    for block, after in zip(found, [*found[1:], Block("", "")], strict=True):
        if block.kind != "python" or block.text.startswith(ADDED):
            continue
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block.text, page, "exec"), names)
        if after.kind == "text":
            assert printed.getvalue() == after.text


@pytest.mark.parametrize(("page", "line"), lines(COMMANDS))
def test_every_command_is_one_that_there_is(page, line):
    program, *arguments = shlex.split(line, comments=True, posix="\\" not in line)
    match program.replace("\\", "/").removeprefix(".venv/Scripts/").removeprefix(".venv/bin/"):
        case "railjoule":
            build_parser().parse_args(arguments)
        case "./run":
            assert arguments[0] in RUN
        case "pip":
            assert_pip_installs(arguments)
        case "python" if arguments[:3] == ["-m", "pip", "install"]:
            assert_pip_installs(arguments[2:])
        case "python" if arguments[0] == "-m":
            assert importlib.util.find_spec(arguments[1]) is not None
        case other:
            assert other in OTHERS, f"{page}: nobody knows the command {other}"


def assert_pip_installs(arguments: list[str]) -> None:
    """Hold that pip is asked for this package, with extras that it has."""
    assert arguments[0] == "install"
    extras = re.fullmatch(r"\.(?:\[([\w,]+)\])?", arguments[1].strip("\"'"))
    assert set((extras[1] or "").split(",")) - {""} <= EXTRAS


COMMANDS_IN_TEXT = [
    (page, found)
    for page, text in PAGES.items()
    for found in re.findall(
        r"`((?:railjoule|\./run|pip install) [^`]*)`", re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    )
]


@pytest.mark.parametrize(("page", "command"), COMMANDS_IN_TEXT)
def test_commands_within_sentences_begin_as_one_that_there_is(page, command):
    """They may leave arguments out: what they name has to be there."""
    program, *words = command.replace("\n", " ").split()
    if program == "./run":
        assert words[0] in RUN
    elif program == "pip":
        if words[1].strip("\"'").startswith("."):
            assert_pip_installs(words)
    elif not words[0].startswith("-") and words[0] != "COMMAND":
        parsers = build_parser()._subparsers._group_actions[0].choices
        assert words[0] in parsers, page
        if not parsers[words[0]]._subparsers:
            known = set(parsers[words[0]]._option_string_actions)
            assert {word for word in words if word.startswith("--")} <= known, page


@pytest.mark.parametrize(
    ("page", "text"),
    [(page, block.text) for page, text in PAGES.items() for block in blocks_in(text) if block.kind == "toml"],
)
def test_toml_is_read_and_a_scenario_is_valid(page, text):
    document = tomllib.loads(text)
    # those of a vehicle or a line alone are read in test_told
    if "timetable" in document:
        scenario_from_document(document)


LINK = re.compile(r"(?<!!)\[[^\]]*\]\(([^)\s]+)\)|srcset=\"([^\"]+)\"|src=\"([^\"]+)\"")


def slug(heading: str) -> str:
    return re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-")


@pytest.mark.parametrize("page", [README, ROOT / "CHANGELOG.md", ROOT / ".github" / "CONTRIBUTING.md"], ids=name_of)
def test_links_lead_to_something(page):
    """Those of the documentation itself are held when it is built."""
    for found in LINK.finditer(page.read_text(encoding="utf-8")):
        link = next(filter(None, found.groups()))
        if link.startswith(("http://", "https://")):
            continue
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), link
        if anchor:
            headings = re.findall(r"^#+ (.+)$", target.read_text(encoding="utf-8"), re.MULTILINE)
            assert anchor in map(slug, headings), link
