"""What is asked before each lesson shows its optimum: a number to guess, by a slider or by buttons."""

from dataclasses import dataclass
from typing import Any

import param

from railjoule.dashboard.look import words


@dataclass(frozen=True)
class Guess:
    """A question that a number answers.

    Parameters
    ----------
    question : str
        With `{at}` for where the slider of the lesson stands.
    unit : str
        Of the number.
    ends : tuple of float
        The least and the greatest guess.
    step : float
        Of the slider.
    close : float
        A guess that misses the answer by no more is close.
    choices : tuple of float
        Buttons in place of a slider.
    digits : int
        Decimals of the answer.
    compared : bool
        Whether the run that the optimum is compared with is shown before.
    """

    question: str
    unit: str
    ends: tuple[float, float]
    step: float
    close: float
    choices: tuple[float, ...] = ()
    digits: int = 1
    compared: bool = True

    def number(self) -> Any:
        """Return the parameter that holds the guess; None before there is one."""
        return param.Number(default=None, allow_None=True, bounds=self.ends, doc=f"What is guessed [{self.unit}].")

    def asked(self, at: float) -> dict[str, Any]:
        """Return what the browser asks, where the slider of the lesson stands at a number."""
        return {
            "question": self.question.format(at=words.number(at, 0)),
            "unit": self.unit,
            "low": self.ends[0],
            "high": self.ends[1],
            "step": self.step,
            "choices": list(self.choices),
        }

    def told(self, guess: float, answer: float, because: str) -> dict[str, Any]:
        """Return guess and answer side by side, with one sentence on their difference."""
        difference = guess - answer
        if abs(difference) <= self.close:
            lead = "Close"
        else:
            # a share's difference is told in points, which are no percentages of it
            unit = "points" if self.unit == "%" else self.unit
            amount = words.number(abs(difference), self.digits)
            lead = f"{amount} {unit} too {'high' if difference > 0 else 'low'}"
        return {
            "guess": f"{words.tenths(guess)} {self.unit}",
            "answer": f"{words.number(answer, self.digits)} {self.unit}",
            "guess_at": self._place(guess),
            "answer_at": self._place(answer),
            "sentence": f"{lead}: {because}",
        }

    def _place(self, number: float) -> float:
        """Return where a number lies between the ends, as a share; one beyond them at the nearer end."""
        low, high = self.ends
        return min(max((number - low) / (high - low), 0.0), 1.0)


GUESSES = {
    "coasting": Guess(
        "A metro train has {at} s for 1500 m. Dashed, it holds one constant speed. "
        "What share of that energy does the best run save?",
        "%",
        ends=(0.0, 40.0),
        step=1.0,
        close=2.0,
    ),
    "multiplier": Guess(
        "The best run over 3 km takes {at} s. How much energy does it save if it may take one second more?",
        "Wh",
        ends=(0.0, 1000.0),
        step=10.0,
        close=40.0,
        choices=(20.0, 75.0, 150.0, 300.0, 600.0),
        digits=0,
        compared=False,
    ),
    "recuperation": Guess(
        "Dashed, the best run over 6 km without recuperation: see where its motors are switched off. "
        "With {at} % recuperation, how far from the start?",
        "m",
        ends=(0.0, 6000.0),
        step=100.0,
        close=200.0,
        digits=0,
    ),
    "gradient": Guess(
        "Stations stand on humps of {at} \u2030. Dashed, a plan for level track is driven over them. "
        "What share of that energy does a plan with gradients save?",
        "%",
        ends=(0.0, 70.0),
        step=1.0,
        close=6.0,
        choices=(2.0, 15.0, 35.0, 60.0),
    ),
    "load": Guess(
        "Dashed, a plan for 30 % load is driven by a train that is {at} % full. "
        "How much more energy does it need than the best plan for that load, in the same time?",
        "%",
        ends=(0.0, 30.0),
        step=1.0,
        close=1.5,
    ),
}
"""By lesson."""
