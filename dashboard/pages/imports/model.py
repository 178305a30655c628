"""What Import holds: the files that were brought, and what was read from them.

Nothing of it is kept in the address: files are too large for it, and what is taken of them becomes the scenario.
"""

from dataclasses import dataclass
from typing import Any

import param

from railjoule.core.imports.source_file import SourceFile
from railjoule.dashboard.pages.imports.brought import Brought
from railjoule.dashboard.pages.imports.compute import Reading, Stretch
from railjoule.dashboard.state.page_model import PageModel, result

MAX_FILE_BYTES = 4_000_000
"""Of one file: a session keeps it until the page is closed, and a message of the browser may have 20 MB."""
MAX_FILES = 8
LONGEST_NAME = 120


@dataclass(frozen=True, eq=False)
class Wanted:
    """That a scenario is to be taken: which of those that can be, and the travel time as it was typed.

    Parameters
    ----------
    what, time : str
    without : bool
        Whether it is to be taken without what could not be read.
    """

    what: str
    time: str
    without: bool = False


class ImportModel(PageModel):
    """The files of one open page."""

    files = param.ClassSelector(class_=tuple, default=(), doc="What was brought.")
    stretch = param.ClassSelector(class_=Stretch, default=Stretch(), doc="The part of the line that is wanted.")
    reading = param.ClassSelector(class_=Reading, default=Reading(offers=()), doc="What was read.")
    wanted = result(Wanted, "What is to be taken.")
    refusal = param.String(default="", doc="Why the last file, or the last scenario, was not taken.")

    def __init__(self, **params: Any) -> None:
        super().__init__(**params)
        self._count = 0

    def add(self, name: str, encoded: str) -> None:
        """Take a file as a browser sends it, or say why not."""
        name = "".join(letter if letter.isprintable() else " " for letter in name)[:LONGEST_NAME] or "a file"
        # four letters carry three bytes
        if len(encoded) > MAX_FILE_BYTES * 4 / 3 + 4:
            self.refuse_large(name)
        elif len(self.files) >= MAX_FILES:
            self.refusal = f"{name}: at most {MAX_FILES} files at a time; remove one first."
        else:
            self._count += 1
            self.param.update(files=(*self.files, Brought(self._count, name, encoded)), refusal="")

    def add_sources(self, sources: tuple[SourceFile, ...]) -> None:
        """Take files of the server in the place of all others."""
        made = tuple(Brought.of(self._count + index, source) for index, source in enumerate(sources, 1))
        self._count += len(made)
        self.param.update(files=made, stretch=Stretch(), refusal="")

    def refuse_large(self, name: str) -> None:
        """Say that a file is too large."""
        self.refusal = f"{name[:LONGEST_NAME]}: larger than the {MAX_FILE_BYTES / 1e6:g} MB allowed for one file."

    def replace(self, file: Brought) -> None:
        """Put a file in the place of the one of its number."""
        self.files = tuple(file if one.number == file.number else one for one in self.files)

    def remove(self, number: int) -> None:
        """Forget a file."""
        self.param.update(files=tuple(one for one in self.files if one.number != number), refusal="")

    def numbered(self, number: object) -> Brought | None:
        """Return the file of a number; None where there is none any more."""
        return next((one for one in self.files if one.number == number), None)
