"""The sidebar's part of Speed limits: the sections one by one, the search, the storage on board."""

import math
from typing import Any

import panel as pn

from railjoule.dashboard.models.speed_limits import SectionModel
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.views.fields import NumberField, TypedNumber
from railjoule.dashboard.views.parts import html_pane, stack

PAGE = "Speed limits"
SIZE_ENDS, POWER_ENDS = (0.0, 5.0), (0.0, 5000.0)
"""Ends of the sliders [kWh, kW]; a storage beyond them can be typed."""


class SectionFields:
    """The fields of all sections; in sight on Speed limits alone."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.speed_limits
        model = self.model
        self.list = stack()
        self.search = [
            TypedNumber(model, "section_count", "Sections", digits=0, unit=""),
            TypedNumber(model, "time_window_percent", "Time window, \u00b1 %", digits=1, unit="%"),
            TypedNumber(model, "stop_deceleration_ms2", "Braking, m/s\u00b2", digits=2, unit="m/s\u00b2"),
        ]
        self.size = NumberField(
            model, "storage_size_kwh", "Storage, kWh", step=0.01, digits=2, unit="kWh", ends=SIZE_ENDS
        )
        self.power = NumberField(model, "storage_power_kw", "Power, kW", step=10, digits=0, unit="kW", ends=POWER_ENDS)
        self.shares = [
            TypedNumber(model, "charging_percent", "Charging efficiency, %", digits=1, unit="%"),
            TypedNumber(model, "discharging_percent", "Discharging efficiency, %", digits=1, unit="%"),
        ]
        self.view = stack(
            html_pane('<div class="section">Sections <span>\u00b7 limit and end of each</span></div>'),
            self.list,
            html_pane('<div class="section">Search</div>'),
            *(field.view for field in self.search),
            html_pane('<div class="section">Storage on board <span>\u00b7 at first as needed</span></div>'),
            self.size.view,
            self.power.view,
            *(field.view for field in self.shares),
            html_pane('<hr class="rule">'),
        )
        model.param.watch(self._list_sections, "sections")
        model.param.watch(self._suggest, ["storage", "storage_size_kwh", "storage_power_kw"])
        self._list_sections()

    def _suggest(self, *_: Any) -> None:
        """Show the storage that holds as long as none is named."""
        if self.model.storage is not None:
            chosen = self.model.storage.chosen.storage
            self.size.suggest(chosen.size_kwh)
            # whole kilowatts, as the field has room for no more; upwards, as less would not do
            self.power.suggest(math.ceil(chosen.power_kw))

    def _list_sections(self, *_: Any) -> None:
        sections = self.model.sections
        self.list[:] = [self._row(k, section, k == len(sections)) for k, section in enumerate(sections, 1)]

    def _row(self, number: int, section: SectionModel, last: bool) -> pn.Column:
        limit = TypedNumber(section, "limit_kmh", f"{number}: limit, km/h", digits=1, unit="km/h", of="Section ")
        if last:
            return stack(limit.view)
        end = TypedNumber(section, "to_m", f"{number}: ends at, m", digits=0, unit="m", of="Section ")
        return stack(limit.view, end.view)
