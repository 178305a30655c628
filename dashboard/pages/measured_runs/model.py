"""What the page Measured runs shows: the files that were brought, what the user says of them, and what came of it."""

import param

from railjoule.dashboard.pages.measured_runs.columns import RunFile
from railjoule.dashboard.pages.measured_runs.compute import Measured
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters
from railjoule.dashboard.state.page_model import PageModel, result

EXAMPLE_SCENARIO = "metro-with-limit"
"""On whose line the example runs were made, see tests/measured_example.py."""
LONGEST_NAME = 80
"""Characters of a file's name: it comes from the browser, however long."""
MAX_FILES = 12
"""Kept of one page: each is held in the server's memory."""


class MeasuredRunsModel(TypedParameters, PageModel):
    """The files of the page and their results; the files themselves live as long as the page."""

    kept = ("example", "answers", "begins_at_m", "shown", "coasting_only")
    passing = ("reading", "refusal")

    example = param.Boolean(default=False, doc="Whether the example runs are among the files.")
    answers = param.Dict(default={}, doc="What columns mean, by their names: a quantity and a unit, or nothing.")
    begins_at_m = TypedNumber(
        "Begins at, m", "m", 0, default=None, allow_None=True, bounds=(0.0, 1e6), doc="Where the runs begin; found."
    )
    shown = param.String(default="", doc="Name of the file that is shown; the last one where there is none of it.")
    coasting_only = param.Boolean(default=False, doc="Fit samples without effort alone.")

    brought = param.ClassSelector(class_=tuple, default=(), doc="Name and content of files that are not read yet.")
    files = param.ClassSelector(class_=tuple, default=(), doc="The files, in the order in which they came.")
    reading = param.Integer(default=0, doc="How many files are being read.")
    refusal = param.String(default="", doc="Why a file was not taken.")
    measured = result(Measured, "What came of the files so far.")

    def bring(self, files: list[tuple[str, bytes]]) -> None:
        """Have files read, each given by its name and content."""
        self.param.update(brought=tuple((name[:LONGEST_NAME], content) for name, content in files), refusal="")

    def add(self, file: RunFile) -> None:
        """Take a file and show it; one of the same name is replaced."""
        others = tuple(other for other in self.files if other.name != file.name)
        if len(others) >= MAX_FILES:
            self.refusal = f"{file.name}: at most {MAX_FILES} runs can be open; remove one first."
            return
        self.param.update(files=(*others, file), shown=file.name)

    def remove(self, name: str) -> None:
        """Let go of a file."""
        files = tuple(file for file in self.files if file.name != name)
        example = self.example and any(file.is_example for file in files)
        self.param.update(files=files, shown=files[-1].name if files else "", example=example, refusal="")

    def say(self, header: str, text: str) -> None:
        """Take what the user says of a column."""
        self.answers = {**self.answers, header: text}
