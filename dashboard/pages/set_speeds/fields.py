"""Fields that only Set speeds has: a list of sections, and a storage with suggested numbers."""

import math
from typing import Any

import panel as pn
from panel.viewable import Viewable

from railjoule.dashboard.pages.set_speeds.sections import SectionModel
from railjoule.dashboard.parts.html import stack
from railjoule.dashboard.parts.number_field import NumberField, number_fields


def list_sections(page: Any) -> Viewable:
    """Make the fields of the sections, which follow their number."""

    def row(number: int, section: SectionModel) -> pn.Column:
        fields = ["limit_kmh"] if number == len(page.sections) else ["limit_kmh", "to_m"]
        labels = {field: f"{number}: {section.param[field].label}" for field in fields}
        return stack(*(NumberField(section, field, label=label, of="Section ") for field, label in labels.items()))

    def show(*_: Any) -> None:
        listed[:] = [row(number, section) for number, section in enumerate(page.sections, 1)]

    listed = stack()
    page.param.watch(show, "sections")
    show()
    return listed


def storage_fields(page: Any) -> Viewable:
    """Make the fields of the storage, which suggest the storage needed until one is named."""
    size, power = number_fields(page, "storage_size_kwh", "storage_power_kw")

    def suggest(*_: Any) -> None:
        if page.storage is not None:
            chosen = page.storage.chosen.storage
            size.suggest(chosen.size_kwh)
            # whole kilowatts, as the field has room for no more; upwards, as less would not do
            power.suggest(math.ceil(chosen.power_kw))

    page.param.watch(suggest, ["storage", "storage_size_kwh", "storage_power_kw"])
    suggest()
    return stack(size, power)
