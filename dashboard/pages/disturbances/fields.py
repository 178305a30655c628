"""The sidebar's part of Disturbances: the events one by one, and the delay that is accepted."""

from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.dashboard.day import KIND_WORDS, EventModel
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.workbench import Workbench

FIELDS = {
    "stop": {"position_m": "at, m", "duration_s": "stops for, s"},
    "limit": {"position_m": "from, m", "to_m": "to, m", "limit_kmh": "km/h"},
    "voltage": {"share_percent": "of nominal, %"},
    "recuperation": {"share_percent": "recuperated, %"},
}
"""Of each kind of event, with what they are called there."""


class EventFields:
    """The fields of all events; in sight on Disturbances alone."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.day
        self.list = stack()
        adders = [
            pmui.Button(
                label=f"+ {word.lower()}", variant="text", size="small", margin=(0, 2), on_click=self._adder(kind)
            )
            for kind, word in KIND_WORDS.items()
        ]
        self.view = stack(
            html_pane('<div class="section">Events <span>\u00b7 click the speed chart to add one</span></div>'),
            self.list,
            pn.FlexBox(*adders, margin=(4, 8)),
            NumberField(self.model, "accepted_delay_s"),
            html_pane('<hr class="rule">'),
        )
        self.model.param.watch(self._list_events, "events")
        self._list_events()

    def _adder(self, kind: str) -> Any:
        # a function for each kind: one made within the loop would add the last kind at every button
        def add(_: Any) -> None:
            self.model.drop(kind, self.state.scenario.base.line.length_m / 2)

        return add

    def _list_events(self, *_: Any) -> None:
        self.list[:] = [self._rows(number, event) for number, event in enumerate(self.model.events, 1)]

    def _rows(self, number: int, event: EventModel) -> pn.Column:
        name = f"{number} {KIND_WORDS[event.kind]}"
        of = f"{name}: "
        fields = [NumberField(event, field, label=label, of=of) for field, label in FIELDS[event.kind].items()]
        remove = pmui.IconButton(
            icon="close",
            size="small",
            margin=0,
            description=f"Remove {name}",
            on_click=lambda _: self.model.remove(event),
            color="default",
        )
        head = pn.Row(
            html_pane(markup('<div class="row"><b>{}</b></div>', name), align="center"),
            remove,
            margin=(4, 8, 0, 0),
            sizing_mode="stretch_width",
        )
        return stack(head, *fields, NumberField(event, "noticed_at_m", of=of))
