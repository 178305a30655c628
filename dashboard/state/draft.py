"""A page's scenario as one value: its base, the edits, and the values of the sliders.

All that follows from it is derived once and kept with it: while a slider moves, half a dozen places of the page ask for
the same scenario.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache
from types import MappingProxyType
from typing import Any

from railjoule.core import RailjouleError, Scenario, ScenarioError, load_scenario
from railjoule.core.budget import PAGE, within
from railjoule.core.scenario import format_scenario, parse_scenario
from railjoule.core.scenario.scenario import TIME_KEYS
from railjoule.core.strategies import prepare_task
from railjoule.dashboard.limits import LONGEST_TEXT

FIELD_KEYS = {
    "timetable.travel_time_s": "travel_time_s",
    "vehicle.load_factor": "load_percent",
    "vehicle.load_t": "load_t",
    "drive.recuperation_factor": "recuperation_percent",
    "enoc.acceleration_time_s": "acceleration_time_s",
}
"""Keys of the file that have a field of their own beside every page."""
OTHER_TIMES = {f"timetable.{key}" for key in (*TIME_KEYS, "deduct_train_length", "reserve_parts")}
"""Edited keys that a time by the slider replaces."""


@cache
def shipped(preset: str) -> Scenario:
    """Return a shipped scenario, which never changes."""
    return load_scenario(preset)


@dataclass(frozen=True, eq=False)
class Edited:
    """A scenario with edited keys, which every move of a slider leaves as it is.

    Parameters
    ----------
    base : Scenario
        The shipped scenario, or that of a file.
    edits : mapping
        Edited keys of the file with their values.
    """

    base: Scenario
    edits: Mapping[str, Any]

    @cached_property
    def scenario(self) -> Scenario:
        """The scenario."""
        return self.base.replace(**self.edits) if self.edits else self.base


@dataclass(frozen=True, eq=False)
class ScenarioDraft:
    """An edited scenario and the values of the page's sliders.

    Parameters
    ----------
    plan : Edited
        Base of the sliders' values.
    sliders : mapping
        Their values by field, in the units that the page shows.
    """

    plan: Edited
    sliders: Mapping[str, float | None]

    def slid(self, sliders: Mapping[str, float | None]) -> "ScenarioDraft":
        """Return the draft with other values of the sliders."""
        return replace(self, sliders=sliders)

    @property
    def base(self) -> Scenario:
        """The shipped scenario, or that of the file."""
        return self.plan.base

    @property
    def edited(self) -> Scenario:
        """The base with its edited keys, without the sliders' values."""
        return self.plan.scenario

    @cached_property
    def changes(self) -> Mapping[str, Any]:
        """The keys of the file that differ from the base, in the order in which they count."""
        edited, now = self.edited, self.sliders
        values = {
            "vehicle.load_factor": (_fraction(now["load_percent"]), edited.vehicle.load_factor),
            "vehicle.load_t": (now["load_t"], edited.vehicle.load_t),
            "drive.recuperation_factor": (
                _fraction(now["recuperation_percent"]),
                edited.vehicle.drive.recuperation_factor,
            ),
            "enoc.acceleration_time_s": (now["acceleration_time_s"], edited.enoc.acceleration_time_s),
        }
        slid = {key: value for key, (value, before) in values.items() if value != before}
        # a reserve makes the time depend on the load
        timed = self.base.replace(**{**self.plan.edits, **slid}) if slid and edited.timetable.has_reserve else edited
        # to a tenth, as the slider shows it: a time that was only rounded is none that was changed
        edits = self.plan.edits
        if now["travel_time_s"] != round(timed.travel_time_s, 1):
            slid = {"timetable.travel_time_s": now["travel_time_s"], **slid}
            edits = {key: value for key, value in edits.items() if key not in OTHER_TIMES}
        # handed out at each call: who changed it in place would change the scenario of all others
        return MappingProxyType({**edits, **slid})

    @cached_property
    def scenario(self) -> Scenario:
        """The scenario with all changes.

        Raises
        ------
        ScenarioError
            If a value is out of its bounds.
        """
        return self.base.replace(**self.changes) if self.changes else self.base

    def original(self, key: str) -> Any:
        """Return the base's value of a key of the file, or None."""
        if key == "timetable.travel_time_s":
            return self.base.travel_time_s
        value: Any = self.base
        # a file has the drive beside the vehicle, the model within it
        for name in (f"vehicle.{key}" if key.startswith("drive") else key).split("."):
            value = value.get(name) if isinstance(value, Mapping) else getattr(value, name, None)
        return value

    def with_changes(self, changes: Mapping[str, Any]) -> Mapping[str, Any]:
        """Return all changes with others laid over them; a whole table replaces what was changed in it."""
        replaced = tuple(f"{key}." for key in changes)
        return {**{key: value for key, value in self.changes.items() if not key.startswith(replaced)}, **changes}

    def without(self, *keys: str) -> Mapping[str, Any]:
        """Return all changes but those of some keys."""
        return {key: value for key, value in self.changes.items() if key not in keys}


def _fraction(percent: float | None) -> float:
    return (percent or 0.0) / 100


SOURCE = "scenario"


@dataclass(frozen=True)
class Opened:
    """A scenario that some train can run, and the text that is kept of it."""

    scenario: Scenario
    toml: str


def open_scenario(text: str, name: str) -> Opened:
    """Return the scenario of a text; a text that was read before is not read again.

    Parameters
    ----------
    text : str
        The TOML.
    name : str
        Its name.

    Raises
    ------
    RailjouleError
        If it cannot be read, is too large for a page, or no train can run it.
    """
    outcome = outcome_of(text)
    if isinstance(outcome, Opened):
        return outcome
    raise type(outcome)(f"{name}: {str(outcome).removeprefix(f'{SOURCE}: ')}")


# keyed only by the text, as `open_scenario` lays the file's name on; eight texts have at most 16 MB (LONGEST_TEXT)
@lru_cache(maxsize=8)
def outcome_of(text: str) -> Opened | RailjouleError:
    """Return the scenario of a text or why there is none; long texts may be read here in a thread beforehand."""
    if len(text) > LONGEST_TEXT:
        return ScenarioError(f"{SOURCE}: more than the limit of {LONGEST_TEXT / 1e6:g} MB.")
    try:
        with within(PAGE):
            scenario = parse_scenario(text, SOURCE)
            prepare_task(scenario)
        return Opened(scenario, format_scenario(scenario))
    except RailjouleError as error:
        # returned, not raised, as the cache keeps no exceptions: a refused text is not read again either
        return error
    except MemoryError:
        return ScenarioError(f"{SOURCE}: not enough memory on the server to read it.")
