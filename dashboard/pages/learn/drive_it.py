"""The lesson that is driven, as a part of the page: what the browser is told, and what it tells."""

from typing import Any

import param

from railjoule.core import load_scenario
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.pages.learn.by_hand import LESSON_CHANGES, PRESET, TryResult, best_run, driven_run
from railjoule.dashboard.pages.learn.played_form import PlayedForm
from railjoule.dashboard.state.recipes import Recipe
from railjoule.dashboard.state.workbench import Workbench


class DriveIt(PlayedForm):
    """Power, coast and brake in the browser; the server judges a try once it has arrived.

    Parameters
    ----------
    state : Workbench
    """

    timetable_s = param.Number(default=0.0, doc="Travel time of the timetable [s].")
    length_km = param.Number(default=0.0, doc="Length of the line [km].")
    mesh = param.Dict(default={}, doc="What the train obeys.")
    driven = param.String(default="", doc="Commands of a run that may be replayed.")

    _esm = module("drive_it")
    result = "tried"

    def __init__(self, state: Workbench) -> None:
        scenario = load_scenario(PRESET)
        super().__init__(state, timetable_s=scenario.travel_time_s, length_km=scenario.line.length_m / 1000)

    def shown(self, found: TryResult) -> dict[str, Any]:
        """Return what the train obeys, and a run that may be replayed."""
        return {"mesh": dict(found.mesh), "driven": self.state.learn.driven}

    def _take(self, message: dict[str, Any]) -> None:
        if message.get("what") == "open":
            self._open()
        elif message.get("what") == "done":
            self.state.learn.finished = str(message.get("commands", ""))

    def _open(self) -> None:
        """Turn to Drive with the lesson's scenario, and pin the try that is shown and the optimum."""
        tried = self.state.learn.tried
        self.state.scenario.choose(PRESET)
        if tried is not None and tried.request.commands:
            commands = tried.request.commands
            recipe = Recipe(PRESET, None, dict(LESSON_CHANGES), "optimal")
            self.state.pin_lesson(driven_run(commands), commands, best_run(), recipe)
        self.state.page = "Drive"
