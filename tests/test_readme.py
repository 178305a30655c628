"""README.md takes a newcomer two minutes to read; its blocks of code run in tests/docs."""

import re

from documents import README, ROOT, blocks_in

TEXT = README.read_text(encoding="utf-8")
# a page of prose is read at some 240 words a minute (Brysbaert 2019)
MAX_WORDS = 2 * 240


def test_first_block_is_the_two_commands():
    first = blocks_in(TEXT)[0]
    assert (first.kind, first.text) == ("sh", "./run serve\n./run test\n")


def test_it_is_read_in_two_minutes():
    assert len(re.sub(r"```.*?```|<[^>]*>|\]\([^)]*\)|[|#*`-]", " ", TEXT, flags=re.DOTALL).split()) <= MAX_WORDS


def test_pictures_are_there():
    named = re.findall(r"assets/pictures/[\w-]+\.\w+", TEXT)
    assert len(named) == 2
    for name in named:
        assert (ROOT / name).read_bytes().startswith(b"\x89PNG"), name
