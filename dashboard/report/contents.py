"""What a report shall tell: which sections, who has written it, and a note by the author."""

import unicodedata
from dataclasses import dataclass

from railjoule.core import RailjouleError
from railjoule.dashboard.limits import LONGEST_AUTHOR, LONGEST_NOTE
from railjoule.dashboard.report.section_names import SECTION_TITLES

LONGEST_SHOWN = 40
# beside them, control characters and halves of characters are no text of a page
BLANKS = "\n\t"


class ContentsError(RailjouleError):
    """Contents that no report can have, in one sentence."""


@dataclass(frozen=True)
class Contents:
    """What a report shall tell, beside what it finds out.

    Parameters
    ----------
    sections : tuple of str
        Keys of `SECTION_TITLES`; whatever their order here, a report has its own.
    author : str
        Who has written it; a name of one line, at most `LONGEST_AUTHOR` characters, empty where nobody is named.
    note : str
        What the author says, as plain text of at most `LONGEST_NOTE` characters; an empty line begins a new paragraph.

    Raises
    ------
    ContentsError
        If a section is not known or none is chosen, or if a text is too long or has characters that are no text.
    """

    sections: tuple[str, ...] = tuple(SECTION_TITLES)
    author: str = ""
    note: str = ""

    def __post_init__(self) -> None:
        possible = ", ".join(SECTION_TITLES)
        if unknown := [name for name in self.sections if name not in SECTION_TITLES]:
            raise ContentsError(f"sections: {_shown(unknown[0])} is no section of a report; choose of {possible}.")
        if not self.sections:
            raise ContentsError(f"sections: a report has at least one of {possible}.")
        _check("author", self.author, LONGEST_AUTHOR)
        _check("note", self.note, LONGEST_NOTE)
        if "\n" in self.author.strip():
            raise ContentsError("author: must be one line.")

    def has(self, *sections: str) -> bool:
        """Return whether any of these sections is among them."""
        return any(section in self.sections for section in sections)

    @property
    def paragraphs(self) -> tuple[str, ...]:
        """The paragraphs of the note."""
        lines = [line.rstrip() for line in self.note.splitlines()]
        return tuple(text for part in "\n".join(lines).split("\n\n") if (text := part.strip("\n")))


def _check(name: str, text: str, longest: int) -> None:
    """Refuse a text that is too long, or that has characters which are no text."""
    if len(text) > longest:
        raise ContentsError(f"{name}: has {len(text):,} characters, at most {longest:,} are allowed.")
    plain = text.replace("\r\n", "\n")
    for place, character in enumerate(plain, 1):
        if unicodedata.category(character) in {"Cc", "Cs"} and character not in BLANKS:
            raise ContentsError(f"{name}: character {place:,} is U+{ord(character):04X}, which is no text.")


def _shown(text: str) -> str:
    """Return a text in quotes, of a long one its beginning."""
    return repr(text if len(text) <= LONGEST_SHOWN else f"{text[: LONGEST_SHOWN - 3]}...")
