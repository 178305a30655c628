"""README.md is what a newcomer reads in three minutes, and it tells the truth; its blocks run in tests/docs."""

import re

from documents import README, ROOT, blocks, blocks_in, run_python

TEXT = README.read_text(encoding="utf-8")
# a page of prose is read at some 240 words a minute (Brysbaert 2019)
MOST_WORDS = 3 * 240


def test_first_block_is_the_two_commands():
    first = blocks_in(TEXT)[0]
    assert (first.kind, first.text) == ("sh", "./run serve\n./run test\n")


def test_five_tasks_take_six_lines_each_and_print_what_is_shown(tmp_path):
    """Solve a preset, bring a line from tables, compare strategies, draw a frontier, judge a strategy of one's own."""
    examples = blocks(TEXT, "python")
    assert len(examples) == 5
    for example in examples:
        assert len([line for line in example.splitlines() if line]) <= 6, example
    run = run_python(["-c", "\n".join(examples)], tmp_path)
    assert run.stderr == ""
    assert run.stdout == "".join(blocks(TEXT, "text"))
    assert (tmp_path / "frontier.png").read_bytes()[:4] == b"\x89PNG"


def test_it_is_read_in_three_minutes():
    prose = re.sub(r"```.*?```|<[^>]*>|\]\([^)]*\)|[|#*`-]", " ", TEXT, flags=re.DOTALL)
    assert len(prose.split()) <= MOST_WORDS


def test_pictures_are_there():
    named = re.findall(r"assets/pictures/[\w-]+\.\w+", TEXT)
    assert len(named) == 8
    for name in named:
        first = (ROOT / name).read_bytes()[:4]
        assert first == (b"<svg" if name.endswith(".svg") else b"\x89PNG"), name
