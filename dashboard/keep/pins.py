"""The work behind the pins: repeats the runs that an address or an undo step names."""

from typing import Any, NamedTuple

from railjoule.core import RailjouleError, StrategyRefusedError, Trajectory
from railjoule.core.motion import build_meshed_line
from railjoule.core.simulation.manual import drive_manually, read_commands
from railjoule.core.strategies import prepare_task
from railjoule.dashboard.state.pins import MOST_PINS, TOO_MANY, KeptPin, Pin
from railjoule.dashboard.state.recipes import Recipe
from railjoule.dashboard.work.runs import RunsRequest, compute_runs
from railjoule.dashboard.work.simple_advice import simple_run
from railjoule.dashboard.work.worker import Worker
from railjoule.dashboard.workbench import Workbench

LOST = "No longer pinned: {}. The file of a measured run is in no link; bring it to Files, and pin it there again."


class RecipeRun(NamedTuple):
    """A recipe and its run."""

    recipe: Recipe
    trajectory: Trajectory


Found = tuple[RecipeRun, ...]


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
        # the colour distinguishes pins: Compare has one row and one line for each
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

    def _take(self, found: Found) -> None:
        wanted = [(one, one.recipe()) for one in self.state.kept_pins]
        computed = [recipe for _, recipe in wanted if not recipe.recording]
        known = all(recipe.recording in self.state.recorded for _, recipe in wanted if recipe.recording)
        # another pin may have come, or one may have gone, while these were run
        if not known or computed != [recipe for recipe, _ in found]:
            return
        runs = (self.state.proof.bounded(run) for _, run in found)
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
        self._refuse(f"The pinned runs cannot be computed again: {failure}")

    def _refuse(self, sentence: str) -> None:
        """Keep the pins that there are."""
        self.state.notice = sentence
        self.state.kept_pins = [KeptPin.of(pin) for pin in self.state.pins]


def run_again(pins: tuple[KeptPin, ...]) -> Found:
    """Return the runs of pins, each with the bound of its scenario's optimum.

    Raises
    ------
    RailjouleError
        If one of them cannot be read or run.
    """
    return tuple(RecipeRun(recipe, _run(recipe)) for recipe in [one.recipe() for one in pins])


def _run(recipe: Recipe) -> Trajectory:
    scenario, strategy = recipe.scenario, recipe.strategy
    if recipe.simple:
        return simple_run(scenario, recipe.simple)
    if recipe.driven:
        mesh = build_meshed_line(scenario)
        return drive_manually(scenario, mesh, read_commands(recipe.driven, mesh.cell_count))
    runs = compute_runs(RunsRequest(scenario, (strategy,)))
    if strategy not in runs.runs:
        raise StrategyRefusedError(f"{strategy} {runs.refused[strategy]}")
    return move_instruction(runs.runs[strategy], recipe.moved) if recipe.moved else runs.runs[strategy]


def move_instruction(run: Trajectory, moved: str) -> Trajectory:
    """Return an optimum with one instruction moved to a place, such as 5@1000; errors as `moved_run`."""
    from railjoule.core.studies.moved_instruction import moved_run  # noqa: PLC0415

    number, _, place = moved.partition("@")
    if int(number) >= len(run.phases):
        raise StrategyRefusedError(f"has no instruction {number}.")
    return moved_run(prepare_task(run.scenario), run, int(number), float(place))
