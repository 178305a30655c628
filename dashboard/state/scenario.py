"""The scenario that a page edits: a shipped one and the fields that differ from it."""

from collections.abc import Callable, Mapping
from typing import Any

import param

from railjoule.core import RailjouleError, Scenario, ScenarioError
from railjoule.core.budget import PAGE, within
from railjoule.core.scenario import preset_names
from railjoule.core.scenario.drive import DriveParameters
from railjoule.core.scenario.options import EnocOptions
from railjoule.core.scenario.scenario import Timetable
from railjoule.core.scenario.vehicle import Vehicle
from railjoule.core.strategies import prepare_task
from railjoule.core.units import KG_PER_T
from railjoule.dashboard.state.draft import FIELD_KEYS, Edited, ScenarioDraft, open_scenario, shipped
from railjoule.dashboard.state.numbers import TypedParameters, keyed

FIRST_SCENARIO = "metro-with-limit"
PLAN_FIELDS = ("travel_time_s", "load_percent", "load_t", "recuperation_percent", "edits")
"""Fields that every plan depends on."""
RUN_FIELDS = (*PLAN_FIELDS, "acceleration_time_s")
"""Fields that the runs of all strategies depend on: ENOC's has a field of its own."""
LEAST_RANGE, TIMETABLE_RANGE = 0.97, 2.0
"""The slider of the travel time begins and ends at these times the shortest time."""
LEAST_OF_TIMETABLE = 0.75
"""At least this share of the timetable is taken for the shortest time, where the slider ends."""


def travel_time_ends(scenario: Scenario) -> tuple[float, float]:
    """Return the ends of the travel time's slider [s].

    Raises
    ------
    RailjouleError
        If no train can run the scenario.
    """
    with within(PAGE):
        shortest = prepare_task(scenario).shortest_travel_time_s
    # whole seconds at both ends, as those stand at them: a little less than can be driven, so that one sees where it
    # ends, and at least one and a half times the timetable, however tight that is
    start = float(int(LEAST_RANGE * shortest))
    return start, float(int(TIMETABLE_RANGE * max(shortest, LEAST_OF_TIMETABLE * scenario.travel_time_s)) + 1)


class ScenarioModel(TypedParameters):
    """A shipped scenario, or one from a file, with edited keys and the values of the page's sliders laid over it.

    The sliders' values are in the units that the page shows, those of other keys in the units of the file.
    """

    kept = ("preset", "toml", *FIELD_KEYS.values(), "edits")
    passing = ("travel_time_range_s",)
    may_be_empty = ("load_t",)

    preset = param.Selector(default=FIRST_SCENARIO, objects=list(preset_names("scenarios")), doc="Shipped scenario.")
    opened = param.ClassSelector(class_=Scenario, default=None, allow_None=True, doc="The scenario of a file.")
    toml = param.String(default=None, allow_None=True, doc="That scenario as a text.")
    travel_time_s = keyed(Timetable, "travel_time_s", "Travel time", "s", 1, default=100.0, step=0.5)
    # the bound of every vehicle; `parse` and `lay` hold it to the crush load of the one that is there
    load_percent = keyed(Vehicle, "load_factor", "Load, % of capacity", "%", scale=100, step=1)
    load_t = keyed(Vehicle, "load_t", "Load", "t", 1, allow_None=True)
    recuperation_percent = keyed(
        DriveParameters, "recuperation_factor", "Recuperation", "%", scale=100, softbounds=(0, 100), step=1
    )
    # its slider goes as far as ENOC's map of real timetables, NARROW_MAP_S in pages/trade_off/compute.py
    acceleration_time_s = keyed(
        EnocOptions, "acceleration_time_s", "Acceleration time", "s", 1, allow_None=True, softbounds=(15, 110), step=0.1
    )
    travel_time_range_s = param.Range(default=(50.0, 200.0), doc="Ends of the travel time's slider.")
    edits = param.Dict(default={}, doc="Other edited keys of the file, with their values.")

    def __init__(self, **params: Any) -> None:
        self._draft: ScenarioDraft | None = None
        super().__init__(**params)
        self.param.watch(self._follow_reserve, ["load_percent", "travel_time_s"])
        self.restore()

    def _follow_reserve(self, *events: param.parameterized.Event) -> None:
        """Let the travel time follow the load where a reserve gives it and it was not set by hand."""
        edited, loads = self.edited, [event for event in events if event.name == "load_percent"]
        if len(loads) < len(events) or not edited.timetable.has_reserve:
            return
        try:
            before, now = (
                round(edited.replace(**{"vehicle.load_factor": percent / 100}).travel_time_s, 1)
                for percent in (loads[0].old, loads[0].new)
            )
        except RailjouleError:
            # the runs of this load are refused with their reason
            return
        if self.travel_time_s == before:
            self.travel_time_s = now

    @property
    def draft(self) -> ScenarioDraft:
        """The scenario as it stands, with all that was derived from it since the last change."""
        base = self.opened or shipped(self.preset)
        sliders = {field: getattr(self, field) for field in FIELD_KEYS.values()}
        known = self._draft
        # by identity, which costs nothing: shipped scenarios are cached, `edits` is replaced and never changed in place
        if known is None or known.base is not base or known.plan.edits is not self.edits:
            known = ScenarioDraft(Edited(base, self.edits), sliders)
        elif known.sliders != sliders:
            known = known.slid(sliders)
        self._draft = known
        return known

    def choose(self, preset: str) -> None:
        """Take a shipped scenario."""
        self.param.update(preset=preset, opened=None, toml=None, edits={})
        self.restore()

    def open(self, text: str, name: str) -> None:
        """Take the scenario of a file.

        Parameters
        ----------
        text : str
            The TOML.
        name : str
            Name of the file.

        Raises
        ------
        RailjouleError
            If it cannot be read, is too large for a page, or no train can run it; then nothing changes.
        """
        found = open_scenario(text, name)
        # a link to the file does not name the scenario that was shown before it
        self.param.update(preset=FIRST_SCENARIO, opened=found.scenario, toml=found.toml, edits={})
        self.restore()

    def restore(self) -> None:
        """Take over the values of the shipped scenario or the file."""
        self._take(self.base, {})

    def edit(self, changes: Mapping[str, Any]) -> None:
        """Lay values over keys of the file, all of them or none.

        Parameters
        ----------
        changes : mapping
            Dotted keys with their values; None takes a key away, and a whole table replaces what was edited in it.

        Raises
        ------
        RailjouleError
            If a value is out of its bounds, or no train can run what comes out; then nothing changes.
        """
        self._change(self.draft.with_changes(changes))

    def take_back(self, *keys: str) -> None:
        """Give keys the values of the shipped scenario or the file again.

        Raises
        ------
        RailjouleError
            If no train can run what is left.
        """
        self._change(self.draft.without(*keys))

    def lay(self, values: Mapping[str, Any]) -> None:
        """Take over edits and sliders of the base that is there; the base itself is chosen or opened.

        Raises
        ------
        RailjouleError
            If no train can run what comes out; then nothing changes. If the load is more than the vehicle carries; then
            all but the load is taken over.
        """
        edits = values["edits"]
        # only then, as taking edits over computes the shortest time
        if edits != self.edits:
            self._take(self.base.replace(**edits), edits)
        fields = {field: values[field] for field in FIELD_KEYS.values() if field in values}
        load, most = fields.get("load_percent", 0.0), self.most_load_percent
        if load > most:
            fields.pop("load_percent")
        self.param.update(**fields)
        # set last, so that all else is taken over
        if load > most:
            raise ScenarioError(f"load_percent = {load:g} must be at most {most:g}, the crush load of the vehicle.")

    def follow(self, part: Callable[[Scenario], object], take: Callable[[Scenario], None]) -> None:
        """Tell who has fields of its own when the scenario is another one, or that part of it was edited.

        Parameters
        ----------
        part : callable
            Returns what its fields depend on.
        take : callable
            Called with the scenario, its edits included.
        """
        known = part(self.edited)

        def look(*events: param.parameterized.Event) -> None:
            nonlocal known
            scenario = self.edited
            before, known = known, part(scenario)
            # another scenario is announced even where that part is equal: what was set by hand on a page is reset
            if known != before or any(event.name != "edits" for event in events):
                take(scenario)

        self.param.watch(look, ["preset", "opened", "edits"])

    def _change(self, changes: Mapping[str, Any]) -> None:
        """Let these be all changes of the base."""
        edits = {key: value for key, value in changes.items() if key not in FIELD_KEYS}
        self._take(self.base.replace(**changes), edits)

    def _take(self, scenario: Scenario, edits: Mapping[str, Any]) -> None:
        """Show a scenario that comes from edits of the base."""
        # first of all: it refuses what no train can run, and then nothing must have changed
        ends = travel_time_ends(scenario)
        self.param.update(
            edits=dict(edits),
            travel_time_range_s=ends,
            # to a tenth, as `ScenarioDraft.changes` compares it: any more digits would count as a change
            travel_time_s=round(scenario.travel_time_s, 1),
            load_percent=100 * scenario.vehicle.load_factor,
            load_t=scenario.vehicle.load_t,
            recuperation_percent=100 * scenario.vehicle.drive.recuperation_factor,
            acceleration_time_s=scenario.enoc.acceleration_time_s,
        )
        # another scenario may have the same values in all fields: its runs are asked for all the same
        self.param.trigger("travel_time_s")

    @property
    def is_shipped(self) -> bool:
        """Whether it is a shipped scenario of which nothing but the sliders' values was changed."""
        return self.opened is None and not self.edits

    @property
    def base(self) -> Scenario:
        """The shipped scenario, or that of the file."""
        return self.draft.base

    def identity(self) -> Scenario:
        """Return an object that is another one for each scenario that is chosen or opened, whatever is edited in it."""
        return self.base

    def original(self, key: str) -> Any:
        """Return the base's value of a key of the file, or None."""
        return self.draft.original(key)

    @property
    def edited(self) -> Scenario:
        """The base with its edited keys, without the sliders' values."""
        return self.draft.edited

    @property
    def changes(self) -> Mapping[str, Any]:
        """The keys of the file that differ from the base, in the order in which they count."""
        return self.draft.changes

    def scenario(self) -> Scenario:
        """Return the scenario as it stands.

        Raises
        ------
        ScenarioError
            If a value is out of its bounds.
        """
        return self.draft.scenario

    @property
    def most_load_percent(self) -> float:
        """The vehicle's crush load, % of capacity."""
        # 100 times a factor is rarely round in binary, and a sentence would read 110.00000000000001
        return float(round(100 * self.edited.vehicle.crush_load_factor, 6))

    @property
    def loads_in_tonnes(self) -> bool:
        """Whether the load is shown in tonnes: a vehicle for freight, unless its file gives a share."""
        vehicle = self.edited.vehicle
        return vehicle.load_t is not None or (vehicle.capacity_passengers == 0 and vehicle.load_factor == 0)

    @property
    def planned_load_percent(self) -> float:
        """The planned load, % of capacity, however it is given."""
        return self.load_percent if self.load_t is None else float(round(100 * self.scenario().vehicle.load_share, 6))

    def parse(self, field: str, text: str) -> float:
        """Return the number that a text gives for a field; the load has the bound of the vehicle."""
        number = super().parse(field, text)
        vehicle = self.edited.vehicle
        most_t = vehicle.crush_load_factor * vehicle.capacity_kg / KG_PER_T
        if field == "load_t" and vehicle.has_capacity and number > most_t:
            raise ValueError(f"At most {most_t:g}, what the vehicle can carry.")
        if field == "load_percent" and number > self.most_load_percent:
            raise ValueError(f"At most {self.most_load_percent:g}, the vehicle's crush load.")
        return number
