"""The texts of the lessons, from assets/texts/lessons.toml, and the numbers that they ask for."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

from railjoule.dashboard.look import words
from railjoule.dashboard.state.numbers import TypedNumber

TEXTS: Mapping[str, Any] = tomllib.loads(
    (files("railjoule.assets") / "texts" / "lessons.toml").read_text(encoding="utf-8")
)


@dataclass(frozen=True)
class Lesson:
    """A lesson that asks for a guess.

    Parameters
    ----------
    name, title : str
    lines : str
        The caption of its speed chart.
    label, unit, ends, first
        Its slider: label, unit, first and last value, and the value at which it begins.
    headline, first_name, second_name : str
        Labels of its numbers: the difference, and the energies of both runs.
    because : str
        Explains the answer, with the numbers of `railjoule.dashboard.pages.learn.answers` in braces.
    question : str
        With `{at}` for the value of the slider.
    guess_unit, guess_ends, guess_step
        The field of the guess.
    close : float
        A guess that misses the answer by no more is close.
    text : str
        The explanation, at most 150 words.
    attempt, answer : str
        A task for the slider, and its result.
    choices : tuple of float
        Choices in place of a field.
    term : str
        The word of the glossary for the headline.
    digits : int
        Decimals of the answer.
    compared : bool
        Whether the run that the optimum is compared with is shown before the guess.
    bars : bool
        Whether the energies along both runs are shown.
    planned : bool
        Whether its plans are followed by a controller, and so keep to its braking curve.
    """

    name: str
    title: str
    lines: str
    label: str
    unit: str
    ends: tuple[float, float]
    first: float
    headline: str
    first_name: str
    second_name: str
    because: str
    question: str
    guess_unit: str
    guess_ends: tuple[float, float]
    guess_step: float
    close: float
    text: str
    attempt: str
    answer: str
    choices: tuple[float, ...] = ()
    term: str = "Saving"
    digits: int = 1
    compared: bool = True
    bars: bool = False
    planned: bool = False

    @property
    def guess(self) -> str:
        """The name of the parameter that holds its guess."""
        return f"{self.name}_guess"

    @property
    def draft(self) -> str:
        """The name of the parameter that holds a number before it becomes the guess."""
        return f"{self.name}_draft"

    def number(self) -> TypedNumber:
        """Return the parameter of its slider."""
        ends = tuple(self.ends)
        return TypedNumber(self.label, self.unit, default=self.first, bounds=ends, softbounds=ends, step=1)

    def guess_number(self) -> TypedNumber:
        """Return the parameter of its guess; None before there is one."""
        return TypedNumber("Guess", self.guess_unit, default=None, allow_None=True, bounds=tuple(self.guess_ends))

    def draft_number(self) -> TypedNumber:
        """Return the parameter of the field in which one guesses; a slider begins in the middle."""
        ends, step = tuple(self.guess_ends), self.guess_step
        middle = self.choices[0] if self.choices else step * round(sum(ends) / 2 / step)
        label = f"Your guess, {self.guess_unit}"
        return TypedNumber(label, self.guess_unit, default=middle, bounds=ends, softbounds=ends, step=step)

    def ask(self, at: float) -> str:
        """Return the question for a value of the slider."""
        return self.question.format(at=words.number(at, 0))

    def difference(self, guess: float, answer: float) -> str:
        """Return how a guess compares with the answer, as the beginning of a sentence."""
        missed = guess - answer
        if abs(missed) <= self.close:
            return "Close"
        # a share's difference is in points, which are no percentages of it
        unit = "points" if self.guess_unit == "%" else self.guess_unit
        return f"{words.number(abs(missed), self.digits)} {unit} too {'high' if missed > 0 else 'low'}"

    def share(self, number: float) -> float:
        """Return the place of a number between the ends [%]; one beyond them lies at the nearer end."""
        low, high = self.guess_ends
        return 100 * min(max((number - low) / (high - low), 0.0), 1.0)


LESSONS = tuple(Lesson(**row) for row in TEXTS["lesson"])
"""In the order in which they are read."""
NAMES = tuple(lesson.name for lesson in LESSONS)
