"""Contents of a report: its sections, its author, and a note by the author."""

import unicodedata
from dataclasses import dataclass

from railjoule.core import RailjouleError
from railjoule.dashboard.limits import LONGEST_AUTHOR, LONGEST_NOTE
from railjoule.dashboard.report.section_names import SECTION_TITLES

LONGEST_SHOWN = 40
BLANKS = "\n\t"
"""The only control characters that a text of a page may have."""


class ContentsError(RailjouleError):
    """Contents that no report can have, in one sentence."""


@dataclass(frozen=True)
class Contents:
    """Contents of a report.

    Parameters
    ----------
    sections : tuple of str
        Keys of `SECTION_TITLES` in any order; a report has its own.
    author : str
        A name of one line, at most `LONGEST_AUTHOR` characters; may be empty.
    note : str
        Plain text of at most `LONGEST_NOTE` characters; an empty line begins a new paragraph.

    Raises
    ------
    ContentsError
        If a section is not known or none is chosen, or if a text is too long or has control characters.
    """

    sections: tuple[str, ...] = tuple(SECTION_TITLES)
    author: str = ""
    note: str = ""

    def __post_init__(self) -> None:
        possible = ", ".join(SECTION_TITLES)
        for name in self.sections:
            if name not in SECTION_TITLES:
                shown = repr(name if len(name) <= LONGEST_SHOWN else f"{name[: LONGEST_SHOWN - 3]}...")
                raise ContentsError(f"sections: {shown} is no section of a report; choose of {possible}.")
        if not self.sections:
            raise ContentsError(f"sections: a report has at least one of {possible}.")
        for field, text, longest in (("author", self.author, LONGEST_AUTHOR), ("note", self.note, LONGEST_NOTE)):
            if len(text) > longest:
                raise ContentsError(f"{field}: has {len(text):,} characters, at most {longest:,} are permitted.")
            for place, sign in enumerate(text.replace("\r\n", "\n"), 1):
                # control characters, and halves of characters that could not be written as UTF-8
                if unicodedata.category(sign) in {"Cc", "Cs"} and sign not in BLANKS:
                    raise ContentsError(f"{field}: character {place:,} is U+{ord(sign):04X}, which is no text.")
        if "\n" in self.author.strip():
            raise ContentsError("author: must be one line.")

    def has(self, *sections: str) -> bool:
        """Return whether any of these sections is among them."""
        return any(section in self.sections for section in sections)

    @property
    def paragraphs(self) -> tuple[str, ...]:
        """The paragraphs of the note."""
        text = "\n".join(line.rstrip() for line in self.note.splitlines())
        return tuple(paragraph for part in text.split("\n\n") if (paragraph := part.strip("\n")))
