import pytest

from railjoule.dashboard.limits import LONGEST_AUTHOR, LONGEST_NOTE
from railjoule.dashboard.report.contents import Contents, ContentsError
from railjoule.dashboard.report.section_names import SECTION_TITLES


def test_everything_is_told_unless_it_is_chosen() -> None:
    assert Contents().sections == tuple(SECTION_TITLES)
    chosen = Contents(("proof",))
    assert chosen.has("result", "proof")
    assert not chosen.has("result", "file")


def test_an_unknown_section_names_those_that_there_are() -> None:
    with pytest.raises(ContentsError) as refused:
        Contents(("result", "prof"))
    assert str(refused.value).startswith(
        "sections: 'prof' is no section of a report; choose of result, energy, pinned,"
    )
    with pytest.raises(ContentsError, match=r"^sections: 'x{37}\.\.\.' is no"):
        Contents(("x" * 41,))
    with pytest.raises(ContentsError, match=r"^sections: a report has at least one of result, "):
        Contents(())


def test_texts_have_their_bounds() -> None:
    # letters that take two of JavaScript's units and four bytes each: characters are counted
    longest = "\U0001d465" * LONGEST_NOTE
    assert Contents(note=longest).paragraphs == (longest,)
    with pytest.raises(ContentsError, match=r"^note: has 2,001 characters, at most 2,000 are permitted\.$"):
        Contents(note=longest + "x")
    assert Contents(author="x" * LONGEST_AUTHOR).author
    with pytest.raises(ContentsError, match=r"^author: has 101 characters, at most 100 are permitted\.$"):
        Contents(author="x" * (LONGEST_AUTHOR + 1))
    with pytest.raises(ContentsError, match=r"^author: must be one line\.$"):
        Contents(author="A\nB")


# a half of a pair could not be written as UTF-8
@pytest.mark.parametrize(("sign", "told"), [("\ud800", "U\\+D800"), ("\x00", "U\\+0000"), ("\x1b", "U\\+001B")])
def test_what_is_no_text_is_refused(sign: str, told: str) -> None:
    with pytest.raises(ContentsError, match=f"^note: character 3 is {told}, which is no text"):
        Contents(note=f"ab{sign}")


@pytest.mark.parametrize(
    ("note", "paragraphs"),
    [
        ("", ()),
        (" \n\n", ()),
        ("one\ntwo\n\nthree", ("one\ntwo", "three")),
        ("one\r\n \r\n\r\ntwo\r\n", ("one", "two")),
    ],
)
def test_an_empty_line_begins_a_paragraph(note: str, paragraphs: tuple[str, ...]) -> None:
    assert Contents(note=note).paragraphs == paragraphs
