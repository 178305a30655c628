"""The sidebar's part of Speed limits: the sections one by one, the search, the storage on board."""

import math
from typing import Any

import panel as pn

from railjoule.dashboard.pages.speed_limits.model import SectionModel
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.parts.number_field import NumberField, number_fields
from railjoule.dashboard.state.workbench import Workbench

PAGE = "Speed limits"


class SectionFields:
    """The fields of all sections; in sight on Speed limits alone."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.speed_limits
        model = self.model
        self.list = stack()
        self.size, self.power = number_fields(model, "storage_size_kwh", "storage_power_kw")
        self.view = stack(
            html_pane('<div class="section">Sections <span>\u00b7 set speed and end of each</span></div>'),
            self.list,
            html_pane('<div class="section">Search</div>'),
            *number_fields(model, "section_count", "time_window_percent", "stop_deceleration_ms2"),
            html_pane('<div class="section">Storage on board <span>\u00b7 at first as needed</span></div>'),
            self.size,
            self.power,
            *number_fields(model, "charging_percent", "discharging_percent"),
            html_pane('<hr class="rule">'),
        )
        model.param.watch(self._list_sections, "sections")
        model.param.watch(self._suggest, ["storage", "storage_size_kwh", "storage_power_kw"])
        self._list_sections()
        self._suggest()

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
        fields = ["limit_kmh"] if last else ["limit_kmh", "to_m"]
        labels = {field: f"{number}: {section.param[field].label}" for field in fields}
        return stack(*(NumberField(section, field, label=label, of="Section ") for field, label in labels.items()))
