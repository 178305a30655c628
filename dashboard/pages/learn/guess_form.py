"""What a lesson asks, and the bars beside its curve, as parts of the page."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import param

from railjoule.core import Trajectory
from railjoule.core.energy_along import EnergyAlong, energy_along
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.theme import lesson_css
from railjoule.dashboard.pages.learn.answers import answer_of
from railjoule.dashboard.pages.learn.compute import LessonResult
from railjoule.dashboard.pages.learn.guesses import Guess

STEPS = 60
"""Of the slider along a run."""
ENERGIES: Mapping[str, Callable[[EnergyAlong], Any]] = {
    "motion": lambda along: along.motion_j,
    "height": lambda along: along.height_j,
    "resistance": lambda along: along.resistance_j,
    "losses": lambda along: along.losses_j,
    "returned": lambda along: along.returned_j,
    "drawn": lambda along: along.drawn_j,
}
"""What has a bar."""


class GuessForm(Form):
    """The question of a lesson; the answer stands in it once there is a guess, and nowhere before.

    Parameters
    ----------
    lesson, title : str
        Name and title of the lesson.
    guess : Guess
        What is asked.
    at : float
        Where the slider of the lesson stands.
    take : callable
        Called with a number that was guessed, or with None to guess anew.
    """

    lesson = param.String(default="", doc="Name of the lesson.")
    title = param.String(default="", doc="Its title.")
    asked = param.Dict(default={}, doc="What is asked, and between which ends.")
    verdict = param.Dict(default={}, doc="Guess, answer, and a sentence on their difference; empty without a guess.")
    guessed = param.Boolean(default=False, doc="Whether there is a guess.")
    opened = param.Boolean(default=False, doc="Whether a link has opened the page for this lesson.")

    _esm = module("guess")

    def __init__(self, lesson: str, title: str, guess: Guess, at: float, take: Callable[[float | None], None]) -> None:
        super().__init__(self._take, stylesheets=[lesson_css()], lesson=lesson, title=title, asked=guess.asked(at))
        self.guess, self._give = guess, take

    def show(self, at: float, guess: float | None, result: LessonResult | None) -> None:
        """Show the question, and the answer if there is a guess and what it needs is computed."""
        verdict: dict[str, Any] = {}
        if guess is not None and result is not None:
            verdict = self.guess.told(guess, *answer_of(result))
        self.param.update(asked=self.guess.asked(at), verdict=verdict, guessed=guess is not None)

    def _take(self, message: dict[str, Any]) -> None:
        if message.get("what") == "again":
            self._give(None)
        elif message.get("what") == "guess" and isinstance(message.get("value"), (int, float)):
            low, high = self.guess.ends
            # a browser sends what its slider has; nothing else is a guess
            if low <= message["value"] <= high:
                self._give(float(message["value"]))


class EnergyBars(Form):
    """Where the energy of one or two runs is at a place that a slider chooses: values of `energy_along`."""

    places = param.List(default=[], doc="Places that the slider chooses from [m].")
    runs = param.List(default=[], doc="Name and kind of each run, and its energies at the places [kWh].")

    _esm = module("energy_bars")

    def __init__(self) -> None:
        super().__init__(lambda _: None, stylesheets=[lesson_css()])

    def show(self, runs: Mapping[str, Trajectory], best: str) -> None:
        """Show runs by name, and mark one of them as the best; none to show nothing."""
        self.param.update(**bars_of(runs, best))


def bars_of(runs: Mapping[str, Trajectory], best: str) -> dict[str, list[Any]]:
    """Return places along the longest of some runs, and the energies of each there; nothing without runs."""
    if not runs:
        return {"places": [], "runs": []}
    places = np.linspace(0.0, max(run.distance_m for run in runs.values()), STEPS + 1)
    told = [
        {"name": name, "kind": "best" if name == best else "other", **energies_at(run, places)}
        for name, run in runs.items()
    ]
    return {"places": np.round(places).astype(int).tolist(), "runs": told}


def energies_at(run: Trajectory, places: Any) -> dict[str, list[float]]:
    """Return the energies of a run up to some places, by the names of their bars [kWh]."""
    along = energy_along(run)
    return {
        name: np.round(np.interp(places, along.position_m, energy(along)) / J_PER_KWH, 4).tolist()
        for name, energy in ENERGIES.items()
    }
