"""The work behind the pins: runs again what an address or a step back says was pinned."""

from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.state.pins import MOST_PINS, TOO_MANY, KeptPin, Pin
from railjoule.dashboard.state.workbench import Workbench
from railjoule.dashboard.work.recipes import RecipeRun, compute_recipes
from railjoule.dashboard.work.worker import Worker

LOST = "No longer pinned: {}. The file of a measured run is in no link; bring it to Files, and pin it there again."


class Pins:
    """Keeps the pins of one page and what its address has of them alike."""

    def __init__(self, state: Workbench) -> None:
        self.state = state
        # nobody moves a slider and waits for them, and they may be many
        self.worker = Worker(run_again, self._take, self._take_failure, is_slow=lambda _: True)
        state.param.watch(self._keep, "pins")
        state.param.watch(self._run, "kept_pins")

    def _keep(self, *_: Any) -> None:
        # each of the two watchers changes what the other one watches: where both are alike, they end
        if not self._alike():
            self.state.kept_pins = [KeptPin.of(pin) for pin in self.state.pins]

    def _alike(self) -> bool:
        return [KeptPin.of(pin).keep() for pin in self.state.pins] == [one.keep() for one in self.state.kept_pins]

    def _run(self, *_: Any) -> None:
        """Ask for the runs that are not there."""
        if self._alike():
            return
        wanted = self.state.kept_pins
        # the colour tells pins apart: Compare has one row and one line for each
        if len(wanted) > MOST_PINS or len({one.colour for one in wanted}) < len(wanted):
            self._refuse(TOO_MANY if len(wanted) > MOST_PINS else "Two pinned runs of the link have one colour.")
            return
        lost = [one for one in wanted if one.recording and one.recording not in self.state.recorded]
        if lost:
            names = ", ".join(one.called for one in lost)
            self.state.notice = LOST.format(names)
            self.state.kept_pins = [one for one in wanted if one not in lost]
            return
        self.worker.ask(tuple(one for one in wanted if not one.recording))

    def _take(self, found: tuple[RecipeRun, ...]) -> None:
        wanted = [(one, one.recipe()) for one in self.state.kept_pins]
        computed = [recipe for _, recipe in wanted if not recipe.recording]
        known = all(recipe.recording in self.state.recorded for _, recipe in wanted if recipe.recording)
        # another pin may have come, or one may have gone, while these were run
        if not known or computed != [run.recipe for run in found]:
            return
        runs = (self.state.proof.bounded(run.trajectory) for run in found)
        self.state.pins = tuple(
            Pin(
                one.called,
                self.state.recorded[recipe.recording] if recipe.recording else next(runs),
                one.colour,
                recipe,
            )
            for one, recipe in wanted
        )

    def _take_failure(self, failure: RailjouleError) -> None:
        self._refuse(f"What was pinned cannot be run again: {failure}")

    def _refuse(self, sentence: str) -> None:
        """Keep the pins that there are."""
        self.state.notice = sentence
        self.state.kept_pins = [KeptPin.of(pin) for pin in self.state.pins]


def run_again(pins: tuple[KeptPin, ...]) -> tuple[RecipeRun, ...]:
    """Return the runs of pins; raises RailjouleError if one of them cannot be read or run."""
    return compute_recipes(tuple(one.recipe() for one in pins))
