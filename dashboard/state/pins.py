"""Pinned runs: what was run, by which strategy, and how it comes about again."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

import param

from railjoule.core import Scenario, Trajectory
from railjoule.core.scenario import format_scenario, preset_names
from railjoule.core.scenario._base import without_misleading
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.look import words
from railjoule.dashboard.state.draft import open_scenario
from railjoule.dashboard.state.kept import Kept
from railjoule.dashboard.state.recipes import Recipe
from railjoule.dashboard.state.scenario import ScenarioModel

# as many as the look has colours and strokes for: `pin_1` to `pin_6` in look/tokens.py
MOST_PINS = 6
PIN_KEYS = tuple(f"pin_{number}" for number in range(1, MOST_PINS + 1))
"""Colours and strokes of the pins, by the tokens of the look."""
TOO_MANY = f"At most {MOST_PINS} runs can be pinned; unpin one first."
LONGEST_NAME = 60
LONGEST_KEY = 16
OF_RECIPE = ("strategy", "simple", "recording", "driven", "moved", "preset")
"""Recipe of a pin as in an address."""


@dataclass(frozen=True, eq=False)
class Pin:
    """A run kept to compare others with.

    Parameters
    ----------
    name : str
        Name given by the user.
    trajectory : Trajectory
        The run.
    colour : str
        Its colour and stroke, one of PIN_KEYS.
    recipe : Recipe
        How it comes about again.
    """

    name: str
    trajectory: Trajectory
    colour: str
    recipe: Recipe

    @property
    def number(self) -> int:
        """The number that stands at its lines."""
        return PIN_KEYS.index(self.colour) + 1

    def renamed(self, name: str) -> "Pin":
        """Return the pin under another name; an empty one restores the name that describes the run."""
        # one line without gaps, as it stands at lines of charts and in tables
        plain = without_misleading(" ".join(name.split()))[:LONGEST_NAME]
        return replace(self, name=plain or pin_name(self.trajectory))


class KeptPin(Kept):
    """A pin without its run, as an address holds it."""

    kept = ("called", "strategy", "simple", "recording", "driven", "moved", "preset", "toml", "changes", "colour")

    called = param.String(default="", doc="Name given by the user.")
    strategy = param.Selector(default="optimal", objects=list(STRATEGIES), doc="The strategy.")
    # as core/studies/simple_advice.py bounds them, which no page loads before it is asked for
    simple = param.Integer(default=0, bounds=(0, 9), doc="Changes of regime of simple advice; 0: the strategy.")
    recording = param.String(default="", doc="Of a measured run the key under which the page holds it.")
    driven = param.String(default="", doc="Commands of a run driven by hand, such as p0c300b2200.")
    moved = param.String(
        default="",
        regex=r"(\d{1,4}@\d{1,7}(\.\d{1,20})?)?$",
        doc="Phase and place of a moved instruction: 5@1000.",
    )
    preset = param.Selector(
        default=None, allow_None=True, objects=list(preset_names("scenarios")), doc="Shipped scenario."
    )
    toml = param.String(default=None, allow_None=True, doc="The scenario, if it is not a shipped one.")
    changes = param.Dict(default={}, doc="Keys of the file with their changed values.")
    colour = param.Selector(default=PIN_KEYS[0], objects=list(PIN_KEYS), doc="Colour and stroke.")

    @classmethod
    def of(cls, pin: Pin) -> "KeptPin":
        """Return the persisted part of a pin."""
        recipe = pin.recipe
        return cls(
            called=pin.name,
            colour=pin.colour,
            toml=None if recipe.opened is None else format_scenario(recipe.opened),
            changes=dict(recipe.changes),
            **{name: getattr(recipe, name) for name in OF_RECIPE},
        )

    def recipe(self) -> Recipe:
        """Return how its run comes about.

        Raises
        ------
        RailjouleError
            If its text is no scenario.
        """
        opened = None if self.toml is None else open_scenario(self.toml, "the pinned run").scenario
        return Recipe(opened=opened, changes=dict(self.changes), **{name: getattr(self, name) for name in OF_RECIPE})


def pin_name(run: Trajectory) -> str:
    """Return the name of a pin until it is renamed, such as 'Optimal, 170.0 s, load 50 %, recuperation 40 %'."""
    strategy, vehicle = words.strategy(run.strategy), run.scenario.vehicle
    load = words.vehicle_load(vehicle)
    recuperation = words.setting(vehicle.drive.recuperation_factor)
    return f"{strategy}, {words.time(run.travel_time_s)} s, {load}, recuperation {recuperation} %"


def measured_name(run: Trajectory, has_energy: bool, file: str) -> str:
    """Return the name of the pin of a measured run: without an effort or a power its energy is the model's."""
    what = "Measured" if has_energy else "Measured speeds"
    return f"{what}, {words.time(run.travel_time_s)} s, {without_misleading(' '.join(file.split()))}"[:LONGEST_NAME]


def recipe_of_recording(run: Trajectory) -> Recipe:
    """Return how a measured run comes about: it cannot be computed, so the page holds it under a key of its own."""
    told = f"{run.travel_time_s!r} {run.energy.net_j!r} {run.position_m.tobytes()!r} {run.speed_ms.tobytes()!r}"
    return Recipe(None, None, {}, recording=hashlib.sha256(told.encode()).hexdigest()[:LONGEST_KEY])


def recipe_of(model: ScenarioModel, scenario: Scenario, strategy: str) -> Recipe:
    """Return how a run over `scenario` comes about, from what the page edits where that is the same scenario."""
    if model.scenario() != scenario:
        # the page has moved on while the run was computed, or what it asks for cannot be run
        return Recipe(None, scenario, {}, strategy)
    return Recipe(None if model.opened else model.preset, model.opened, dict(model.changes), strategy)


def same_run(one: Trajectory, other: Trajectory) -> bool:
    """Return whether two runs are one, computed again or not."""
    alike = one.strategy == other.strategy and one.scenario == other.scenario
    return alike and one.energy.net_j == other.energy.net_j


def make_pin(pins: Sequence[Pin], run: Trajectory, recipe: Recipe, name: str = "") -> Pin:
    """Return a pin with a colour that none of `pins` has; there must be less than MOST_PINS."""
    taken = {pin.colour for pin in pins}
    # the first that is free, as pins keep theirs while others go
    colour = next(key for key in PIN_KEYS if key not in taken)
    return Pin(name or pin_name(run), run, colour, recipe)
