"""What the page Speed limits asks for: sections with their limits, who drives under them, a storage on board."""

from collections.abc import Mapping, Sequence
from typing import Any, get_args

import numpy as np
import param

from railjoule.core import Scenario
from railjoule.core.motion.line_profile import section_borders
from railjoule.core.scenario.options import LITERAL_KEYS, SearchOptions
from railjoule.core.strategies.set_speed_run import MIN_LIMIT_KMH
from railjoule.core.strategies.speed_limits import MAX_SECTIONS
from railjoule.core.studies.motor_map import MotorMap
from railjoule.dashboard.pages.speed_limits.compute import InterStationRuns, LimitRun, LimitTrip, StorageCurve
from railjoule.dashboard.state.numbers import TypedInteger, TypedNumber, TypedParameters, core_bounds
from railjoule.dashboard.state.page_model import PageModel, result

REGULATORS = get_args(SearchOptions.model_fields["regulator"].annotation)
INTER_STATION_RUNS = get_args(SearchOptions.model_fields["inter_station_runs"].annotation)
FIRST_SECTIONS = 2
"""Of each inter-station run in a scenario that names no borders; as in the paper."""
MOST_BORDERS = 50
"""As `search.boundaries_m` has at most."""
LONGEST_M = 1e7
MAPS = ("drive", "motor")
STORAGE_FIELDS = ("storage_size_kwh", "storage_power_kw", "charging_percent", "discharging_percent")


class SectionModel(TypedParameters):
    """One section: its limit, and where it ends."""

    kept = ("limit_kmh", "to_m")

    limit_kmh = TypedNumber("set speed, km/h", "km/h", 1, default=80.0, bounds=(MIN_LIMIT_KMH, 600.0))
    to_m = TypedNumber("ends at, m", "m", default=1000.0, bounds=(1.0, LONGEST_M))


class SpeedLimitsModel(TypedParameters, PageModel):
    """The sections of the page, the search's settings, and the results, in the units that the page shows."""

    kept = (
        "section_count",
        "sections",
        "found",
        "regulator",
        "free_borders",
        "inter_station_runs",
        "time_window_percent",
        "stop_deceleration_ms2",
        *STORAGE_FIELDS,
        "shown_map",
    )
    passing = ("no_map", "moving")

    sections = param.List(default=[], item_type=SectionModel, doc="From the start to the end of the line.")
    found = param.Boolean(default=True, doc="Whether the search finds the set speeds, instead of given ones.")
    regulator = param.Selector(default="coast", objects=list(REGULATORS), doc="The regulator under the limits.")
    free_borders = param.Boolean(default=False, doc="Whether the search can move the section ends.")
    inter_station_runs = param.Selector(
        default="together",
        objects=list(INTER_STATION_RUNS),
        doc="Whether each inter-station run is searched by itself.",
    )
    section_count = TypedInteger("Sections", default=FIRST_SECTIONS, bounds=(1, MAX_SECTIONS))
    time_window_percent = TypedNumber(
        "Time window, \u00b1 %", "%", 1, default=1.0, **core_bounds(SearchOptions, "time_window", 100)
    )
    stop_deceleration_ms2 = TypedNumber(
        "Braking, m/s\u00b2",
        "m/s\u00b2",
        2,
        default=0.8,
        doc="For stops.",
        **core_bounds(SearchOptions, "stop_deceleration_ms2"),
    )
    storage_size_kwh = TypedNumber(
        "Storage, kWh", "kWh", 2, default=None, allow_None=True, bounds=(0.0, 1e4), softbounds=(0, 5), step=0.01
    )
    storage_power_kw = TypedNumber(
        "Power, kW", "kW", default=None, allow_None=True, bounds=(0.0, 1e5), softbounds=(0, 5000), step=10
    )
    charging_percent = TypedNumber("Charging efficiency, %", "%", 1, default=95.0, bounds=(1.0, 100.0))
    discharging_percent = TypedNumber("Discharging efficiency, %", "%", 1, default=95.0, bounds=(1.0, 100.0))
    shown_map = param.Selector(default="drive", objects=list(MAPS), doc="Which efficiency is shown.")

    run = result(LimitRun, "The last good run.")
    path = result(LimitRun, "The last run searched for.")
    trip = result(LimitTrip, "The trip while a step moves.")
    comparison = result(InterStationRuns, "The last run beside that of the other way to search.")
    storage = result(StorageCurve, "Energy saved by storages.")
    motor_map = result(MotorMap, "Efficiency of the powertrain.")
    no_map = param.String(default="", doc="Why there is no such map.")
    moving = param.Boolean(default=False, doc="Whether a step is being moved.")
    moved = param.Event(doc="A step has been moved a little further.")

    # the bounds of core/scenario, until `take` knows the line and the vehicle
    _stops_m: tuple[float, ...] = (0.0, LONGEST_M)
    _most_kmh = 600.0

    def take(self, scenario: Scenario) -> None:
        """Take over what a scenario's file says of sections and search."""
        options, stops = scenario.search, scenario.line.in_running_order().stops_m
        most = scenario.vehicle.traction.max_speed_kmh
        own_borders = section_borders(scenario.line.in_running_order())[1:-1].tolist()
        limits = options.limits_kmh
        runs = len(stops) - 1
        most_sections = min(runs * MAX_SECTIONS, MOST_BORDERS + 1)
        even = even_borders(stops, min(runs * FIRST_SECTIONS, most_sections))
        borders = list(options.boundaries_m) or (own_borders if limits else even)
        if limits is not None and len(limits) != len(borders) + 1:
            limits = None
        # before the sections below, which are made with both
        self._stops_m, self._most_kmh = stops, most
        # a search without borders takes those of the line
        self.param.section_count.bounds = (2 if own_borders else 1, max(most_sections, len(borders) + 1))
        self.param.update(
            sections=self._made_of(limits or [most] * (len(borders) + 1), borders),
            section_count=len(borders) + 1,
            found=limits is None,
            regulator=options.regulator,
            free_borders=options.free_boundaries,
            inter_station_runs=options.inter_station_runs,
            time_window_percent=100 * options.time_window,
            stop_deceleration_ms2=options.stop_deceleration_ms2,
            storage_size_kwh=None,
            storage_power_kw=None,
        )

    def _made_of(self, limits_kmh: Sequence[float], borders_m: Sequence[float]) -> list[SectionModel]:
        """Return sections whose fields know the vehicle's own limit."""
        made = []
        for limit, end in zip(limits_kmh, [*borders_m, self._stops_m[-1]], strict=True):
            section = SectionModel(to_m=float(end))
            # of this section alone: param copies a parameter for the instance through which it is asked for
            section.param.limit_kmh.bounds = (MIN_LIMIT_KMH, self._most_kmh)
            section.limit_kmh = float(np.clip(limit, *section.param.limit_kmh.bounds))
            made.append(section)
        return made

    def keep(self) -> dict[str, Any]:
        """Return the kept values by field; without limits and borders that the search finds anew."""
        values = super().keep()
        if self.found:
            borders = [{"to_m": section["to_m"]} for section in values["sections"]]
            values["sections"] = [] if self.free_borders else borders
        if values["sections"]:
            values["sections"][-1].pop("to_m")  # that is where the line ends
        return values

    def lay(self, values: Mapping[str, Any]) -> None:
        """Take over checked values by field; sections that are not named are cut anew.

        Raises
        ------
        ValueError
            If there are too few or too many sections; then nothing changes.
        """
        before = self.keep()
        named, count = values.get("sections") or [], values.get("section_count", self.section_count)
        new = {field: value for field, value in values.items() if field not in before or value != before[field]}
        new.pop("section_count", None)
        if new.pop("sections", []):
            low, high = self.param.section_count.bounds
            if not low <= len(named) <= high:
                raise ValueError(f"sections must be {low} to {high}, not {len(named)}")
            limits = [section.get("limit_kmh", self._most_kmh) for section in named]
            borders = [section.get("to_m", self._stops_m[-1]) for section in named[:-1]]
            new.update(sections=self._made_of(limits, borders), section_count=len(named))
        elif not named and count != self.section_count:
            self.cut(count)
            new["section_count"] = count
        self.param.update(**new)

    def cut(self, count: int) -> None:
        """Cut the line into sections that are equal between two stops, whose limits the search shall find."""
        borders = even_borders(self._stops_m, count)
        self.param.update(sections=self._made_of([self._most_kmh] * count, borders), found=True)

    def move(self, limits_kmh: Sequence[float], borders_m: Sequence[float]) -> None:
        """Set limits [km/h] and borders [m] while a step is being moved."""
        # before the sections change, which would each ask for a whole run
        self.moving = True
        self.set(limits_kmh, borders_m)
        self.found = False
        self.param.trigger("moved")

    def set(self, limits_kmh: Sequence[float], borders_m: Sequence[float]) -> None:
        """Set all limits [km/h] and borders [m] of the sections that there are."""
        for section, limit in zip(self.sections, limits_kmh, strict=True):
            section.limit_kmh = float(limit)
        # not strict: the last section ends with the line
        for section, border in zip(self.sections, borders_m, strict=False):
            section.to_m = float(border)

    def show_found(self, limits_kmh: Sequence[float], borders_m: Sequence[float]) -> None:
        """Set the limits [km/h] and borders [m] that a search found, in as many sections."""
        if len(limits_kmh) != len(self.sections):
            sections = self._made_of(limits_kmh, borders_m)
            self.param.update(sections=sections, section_count=len(sections))
        self.set(limits_kmh, borders_m)

    @property
    def has_stations(self) -> bool:
        """Whether the line has stations between its ends."""
        return len(self._stops_m) > 2

    @property
    def limits_kmh(self) -> tuple[float, ...]:
        """The limits of the sections [km/h]."""
        return tuple(float(section.limit_kmh) for section in self.sections)

    @property
    def borders_m(self) -> tuple[float, ...]:
        """The borders between the sections [m]."""
        return tuple(float(section.to_m) for section in self.sections[:-1])

    @property
    def changes(self) -> Mapping[str, Any]:
        """Sections and search by the keys of the file; limits are given unless the search finds them."""
        # a file of the literal regulator names keys that the others do not have
        of_literal = {} if self.regulator == "literal" else {f"search.{key}": None for key in LITERAL_KEYS}
        return {
            **of_literal,
            "strategy": "speed_limits",
            "search.regulator": self.regulator,
            "search.boundaries_m": list(self.borders_m),
            "search.free_boundaries": self.free_borders if self.found else None,
            "search.inter_station_runs": self.inter_station_runs if self.found and self.has_stations else None,
            "search.limits_kmh": None if self.found else list(self.limits_kmh),
            "search.time_window": self.time_window_percent / 100,
            "search.stop_deceleration_ms2": float(self.stop_deceleration_ms2),
        }


def even_borders(stops_m: Sequence[float], count: int) -> list[float]:
    """Return the borders of sections of a line, in whole metres where these are long enough [m].

    Stations are borders where there are enough sections. All inter-station runs have as many, the longest one more
    where they cannot, and those of a run are equal.
    """
    if count < len(stops_m) - 1:
        stops_m = stops_m[0], stops_m[-1]
    length = np.diff(stops_m)
    counts = np.full(len(length), count // len(length))
    counts[np.argsort(-length)[: count % len(length)]] += 1
    borders: list[float] = []
    for start, run, pieces in zip(stops_m, length.tolist(), counts.tolist(), strict=False):
        inside = [start + run * number / pieces for number in range(1, pieces)]
        borders += [start, *(float(round(border)) if run > 10 * pieces else border for border in inside)]
    return borders[1:]
