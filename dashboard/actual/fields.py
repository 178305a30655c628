"""The sidebar's part of Drive: what differs from the plan on the day."""

from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.dashboard.actual.event import EventModel, event_sign
from railjoule.dashboard.actual.model import add_stop, as_planned, checked_place, move_stop, stops_of
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.parts.choices import menu
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.parts.number_field import LoadField, NumberField, tie
from railjoule.dashboard.state.workbench import Workbench


class ActualFields:
    """The switch of the actual run, and all that differs from the plan; in sight on Drive alone."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.actual
        reality = state.robustness
        self.switch = pmui.Switch(
            label="Actual run", value=self.model.on, size="small", margin=(10, 16, 0, 16), sizing_mode="stretch_width"
        )
        self.load = LoadField(reality, "actual_load_percent", ["most_load_percent"], label="Actual load, %")
        self.stops = stack()
        self.others = html_pane()
        self.add = pmui.Button(
            label="+ stop", variant="text", size="small", margin=(0, 8), on_click=lambda _: add_stop(state)
        )
        reactions = {name: reaction for reaction, name in words.REACTION_WORDS.items()}
        self.reaction = menu(self.model, "reaction", "Who reacts", reactions)
        self.equal = pmui.Button(
            label="As planned", variant="text", size="small", margin=(0, 8), on_click=lambda _: as_planned(state)
        )
        head = pn.Row(
            html_pane('<div class="row">Unplanned stops</div>', align="center"),
            self.add,
            margin=(4, 0, 0, 0),
            sizing_mode="stretch_width",
        )
        self.body = stack(
            self.load,
            NumberField(reality, "coordinate_error_m", tick=0.0),
            head,
            self.stops,
            self.others,
            self.reaction,
            self.equal,
            visible=self.model.on,
        )
        self.view = stack(self.switch, self.body)
        tie(self.switch, self.model, "on")
        self.model.param.watch(self._unfold, "on")
        state.scenario.param.watch(self._mark_planned, "load_percent")
        state.disturbances.param.watch(self._list, ["events", "changed"])
        self._listed: list[EventModel] = []
        self._mark_planned()
        self._list()

    def _unfold(self, *_: Any) -> None:
        self.body.visible = self.model.on

    def _mark_planned(self, *_: Any) -> None:
        self.load.tick = self.state.scenario.load_percent

    def _list(self, *_: Any) -> None:
        events = self.state.disturbances.events
        stops = list(stops_of(self.state))
        # by identity: a stop that was only moved keeps its fields, and the focus in them
        if [id(stop) for stop in stops] != [id(stop) for stop in self._listed]:
            self._listed = stops
            self.stops[:] = [self._row(number, stop) for number, stop in enumerate(stops, 1)]
        others = [event_sign(event) for event in events if event.kind != "stop"]
        self.others.object = markup('<div class="row small muted">Also {}</div>', ", ".join(others)) if others else ""
        self.others.visible = bool(others)
        self.reaction.visible = bool(events)

    def _row(self, number: int, stop: EventModel) -> pn.Row:
        name = f"Stop {number}: "
        place = NumberField(
            stop,
            "position_m",
            of=name,
            narrow=True,
            check=partial(checked_place, self.state, stop),
            take=partial(move_stop, stop),
        )
        lasts = NumberField(stop, "duration_s", label="for, s", of=name, narrow=True)
        remove = pmui.IconButton(
            icon="close",
            size="small",
            margin=0,
            description=f"Remove stop {number}",
            on_click=lambda _: self.state.disturbances.remove(stop),
            color="default",
        )
        return pn.Row(place, lasts, remove, margin=(0, 4, 0, 0), sizing_mode="stretch_width", css_classes=["rj-stop"])
