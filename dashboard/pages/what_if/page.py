"""The page What if: the plan under another load, a position error, events on the way, and random draws."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import param
from panel.viewable import Viewable

from railjoule.core import Scenario
from railjoule.dashboard.charts.driven import BRAKING, LOAD, PLACE
from railjoule.dashboard.look import words
from railjoule.dashboard.page import Own, shows
from railjoule.dashboard.pages.what_if import chance, events, load
from railjoule.dashboard.pages.what_if.chance import DELAYS, DRAWS, MORE, ROBUST, ROBUST_FIELDS, ChanceTab
from railjoule.dashboard.pages.what_if.chance_charts import SCATTER
from railjoule.dashboard.pages.what_if.events import EventsTab
from railjoule.dashboard.pages.what_if.live_view import PLAYED
from railjoule.dashboard.pages.what_if.load import DRIVEN, HEAT_MAP, LoadTab, conditions
from railjoule.dashboard.pages.what_if.rides import ENERGIES, LATE, RIDES, SPEEDS
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.tabs import PageTabs, TabBodies
from railjoule.dashboard.state.recipes import FOLLOWING, PageRun, actual_run

if TYPE_CHECKING:
    from railjoule.dashboard.page_work import PageWorks

TABS: Mapping[str, str] = {LOAD: "Load and position", RIDES: "Events", DRAWS: "Chance"}
"""The tabs by their names in the address."""


class WhatIf(LoadTab, EventsTab, ChanceTab):
    """The page with its three tabs."""

    page = "What if"
    kept = ("tab", "both_directions", "known", "measure", *ROBUST_FIELDS)
    passing = ("as_driver", "dropping", "drawing", "searching")
    figures = (
        *(HEAT_MAP, *DRIVEN, BRAKING, PLACE),
        *(SPEEDS, ENERGIES, LATE, PLAYED),
        *(MORE, SCATTER, DELAYS, *ROBUST),
    )
    # as the grids of the tabs, which have one column up to 1099 px
    halves_from_px = 1100
    full_width = (SPEEDS.name, ENERGIES.name, PLAYED.name)

    tab = param.Selector(default=LOAD, objects=list(TABS), doc="The tab in sight.")

    def part(self, scenario: Scenario) -> object:
        """Return the part of a scenario that the accepted lateness is from."""
        return scenario.disturbance

    def is_over_time(self, axis: str) -> bool:
        """Return whether an axis is one of times, which is possible on the tab of events."""
        return axis == RIDES and self.desk.over_time

    def page_run(self) -> PageRun:
        """Return the run of the tab in sight as a program."""
        desk = self.desk
        if self.tab == RIDES:
            # not `chosen_now`: the chosen strategy is computed, and the page shows its refusal
            return actual_run(desk, {"strategy": desk.chosen, **desk.day.event_changes})
        return PageRun(FOLLOWING, conditions(desk, desk.day.conditions)[1])

    def begin_work(self, works: "PageWorks") -> None:
        """Play runs."""
        self.live.begin_work(works)

    # ---- what it shows

    def layout(self) -> Viewable:
        """Make the tabs and the parts of the one that is open, and return them laid out."""
        self.finding = parts.html_pane(visible=False)
        makers = {LOAD: self.layout_load, RIDES: self.layout_events, DRAWS: self.layout_chance}
        self.tabs = PageTabs(self, TABS, makers)
        return parts.stack(self.finding, self.tabs.view)

    def layout_fields(self) -> Viewable:
        """Return the fields of the tab in sight."""
        makers = {LOAD: self.layout_load_fields, RIDES: self.layout_event_fields, DRAWS: self.layout_chance_fields}
        self.tab_fields = TabBodies(self, makers)
        return self.tab_fields.view

    fields = (Own(layout_fields),)

    @shows("scenario", "failure", "tab", "desk.chosen", "desk.day.events", "desk.day.on")
    def _show_heading(self) -> None:
        shown = {LOAD: self.reality, RIDES: self.rides, DRAWS: self.chance}[self.tab]
        self.host.tell(self.failure, "Shown: the last run that could be computed." if shown is not None else "")
        self.host.heading.object = parts.heading(self.page, self.desk.scenario.edited.title, self._subtitle(), "")

    @shows("tab", "reality", "rides", "live.on", "chance", "robust", "accepted_lateness_s")
    def _show_finding(self) -> None:
        found = parts.Markup()
        count = len(self.desk.day.events)
        if self.tab == LOAD and self.reality is not None:
            found = load.finding(self.reality)
        elif self.tab == RIDES and self.rides is not None and count and not self.live.on:
            found = events.finding(self.rides, count)
        elif self.tab == DRAWS and self.chance is not None:
            found = chance.finding(self.chance, float(self.accepted_lateness_s), self.robust)
        self.finding.param.update(object=found, visible=bool(found))

    def _subtitle(self) -> str:
        if self.tab == RIDES:
            return self.events_words()
        scenario = self.desk.scenario.scenario()
        braking = ", braking along the target curve" if self.desk.day.target_braking else ""
        differs = "actual load and position differ" if self.tab == LOAD else "the actual run is drawn at random"
        return (
            f"{words.distance(scenario.line.length_m)} km in {words.time(scenario.travel_time_s)} s, planned at "
            f"{words.vehicle_load(scenario.vehicle)}{braking}; {differs}"
        )
