"""The scenario that a page edits: a shipped one and the fields that differ from it."""

from collections.abc import Mapping
from typing import Any

import param

from railjoule.core import Scenario, load_scenario
from railjoule.core.scenario import parse_scenario, preset_names
from railjoule.core.strategies import prepare_task
from railjoule.dashboard.models.numbers import TypedParameters, parse_number

FIRST_SCENARIO = "metro-with-limit"
TIME_FIELDS = {"travel_time_s": (1.0, 86_400.0), "acceleration_time_s": (1.0, 43_200.0)}
"""Bounds of the fields that a slider shows only in part [s]."""
PLAN_FIELDS = ("travel_time_s", "load_percent", "recuperation_percent")
"""What every plan depends on."""
TIMETABLE_RANGE = 2.0
"""The slider of the travel time ends at this many times the shortest time."""


class ScenarioModel(TypedParameters):
    """A shipped scenario, or one from a file, with the values of the page's sliders laid over it.

    The values are in the units that the page shows.
    """

    preset = param.Selector(default=FIRST_SCENARIO, objects=list(preset_names("scenarios")), doc="Shipped scenario.")
    opened = param.ClassSelector(class_=Scenario, default=None, allow_None=True, doc="The scenario of a file.")
    travel_time_s = param.Number(default=100.0, doc="Travel time, s")
    load_percent = param.Number(default=0.0, bounds=(0, 100), doc="Load, % of capacity")
    recuperation_percent = param.Number(default=0.0, bounds=(0, 100), doc="Recuperation, %")
    acceleration_time_s = param.Number(default=None, allow_None=True, doc="Acceleration time, s")
    travel_time_range_s = param.Range(default=(50.0, 200.0), doc="Ends of the travel time's slider.")

    def __init__(self, **params: Any) -> None:
        super().__init__(**params)
        self.restore()

    def choose(self, preset: str) -> None:
        """Take a shipped scenario."""
        self.param.update(preset=preset, opened=None)
        self.restore()

    def open(self, text: str, name: str) -> None:
        """Take the scenario of a file.

        Parameters
        ----------
        text : str
            The TOML.
        name : str
            What the file is called.

        Raises
        ------
        RailjouleError
            If it cannot be read, or no train can run it; then nothing changes.
        """
        scenario = parse_scenario(text, name)
        prepare_task(scenario)
        self.opened = scenario
        self.restore()

    def restore(self) -> None:
        """Take over the values of the shipped scenario or the file."""
        base = self.base
        shortest = prepare_task(base).shortest_travel_time_s
        start = float(int(0.97 * shortest))
        end = float(int(TIMETABLE_RANGE * max(shortest, 0.75 * base.travel_time_s)) + 1)
        self.param.update(
            travel_time_range_s=(start, end),
            travel_time_s=round(base.travel_time_s, 1),
            load_percent=100 * base.vehicle.load_factor,
            recuperation_percent=100 * base.vehicle.drive.recuperation_factor,
            acceleration_time_s=base.enoc.acceleration_time_s,
        )
        self.param.trigger("travel_time_s")

    @property
    def base(self) -> Scenario:
        """The shipped scenario, or that of the file."""
        return self.opened or load_scenario(self.preset)

    @property
    def changes(self) -> Mapping[str, Any]:
        """The keys of the file that differ from the shipped scenario."""
        base = self.base
        values = {
            "timetable.travel_time_s": (self.travel_time_s, round(base.travel_time_s, 1)),
            "vehicle.load_factor": (self.load_percent / 100, base.vehicle.load_factor),
            "drive.recuperation_factor": (self.recuperation_percent / 100, base.vehicle.drive.recuperation_factor),
            "enoc.acceleration_time_s": (self.acceleration_time_s, base.enoc.acceleration_time_s),
        }
        return {key: now for key, (now, before) in values.items() if now != before}

    def scenario(self) -> Scenario:
        """Return the scenario as it stands.

        Raises
        ------
        ScenarioError
            If a value is out of its bounds.
        """
        changes = self.changes
        return self.base.with_(**changes) if changes else self.base

    def parse(self, field: str, text: str) -> float:
        """Return the number that a text gives for a field.

        Raises
        ------
        ValueError
            With a sentence that names the bound that it misses.
        """
        if field in TIME_FIELDS:
            return parse_number(text, TIME_FIELDS[field])
        return super().parse(field, text)
