"""The sidebar's part of Drive: what differs from the plan on the day."""

from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.dashboard.day import EventModel
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.parts.choices import menu, remove_button
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.parts.number_field import LoadField, NumberField, tie
from railjoule.dashboard.workbench import Workbench


class ActualFields:
    """The switch of the actual run, and all that differs from the plan; in sight on Drive only."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.day = state, state.day
        day = self.day
        self.switch = pmui.Switch(
            label="Actual run", value=day.on, size="small", margin=(10, 16, 0, 16), sizing_mode="stretch_width"
        )
        self.load = LoadField(day, "actual_load_percent", ["most_load_percent"], label="Actual load, %")
        self.stops = stack()
        self.others = html_pane()
        self.add = pmui.Button(
            label="+ stop", variant="text", size="small", margin=(0, 8), on_click=lambda _: day.add_stop()
        )
        reactions = {name: reaction for reaction, name in words.REACTION_WORDS.items()}
        self.reaction = menu(day, "reaction", "Who reacts", reactions)
        self.equal = pmui.Button(
            label="As planned", variant="text", size="small", margin=(0, 8), on_click=lambda _: day.as_planned()
        )
        head = pn.Row(
            html_pane('<div class="row">Unplanned stops</div>', align="center"),
            self.add,
            margin=(4, 0, 0, 0),
            sizing_mode="stretch_width",
        )
        self.body = stack(
            self.load,
            NumberField(day, "coordinate_error_m", tick=0.0),
            head,
            self.stops,
            self.others,
            self.reaction,
            self.equal,
            visible=day.on,
        )
        self.view = stack(self.switch, self.body)
        tie(self.switch, day, "on")
        day.param.watch(self._unfold, "on")
        state.scenario.param.watch(self._mark_planned, ["load_percent", "load_t"])
        day.param.watch(self._list, ["events", "changed"])
        self._listed: list[EventModel] = []
        self._mark_planned()
        self._list()

    def _unfold(self, *_: Any) -> None:
        self.body.visible = self.day.on

    def _mark_planned(self, *_: Any) -> None:
        self.load.tick = self.state.scenario.planned_load_percent

    def _list(self, *_: Any) -> None:
        events = self.day.events
        stops = list(self.day.stops)
        # by identity: a stop that was only moved keeps its fields, and the focus in them
        if [id(stop) for stop in stops] != [id(stop) for stop in self._listed]:
            self._listed = stops
            self.stops[:] = [self._row(number, stop) for number, stop in enumerate(stops, 1)]
        others = [event.sign for event in events if event.kind != "stop"]
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
            check=partial(self.day.checked_place, stop),
            take=stop.move,
        )
        lasts = NumberField(stop, "duration_s", label="for, s", of=name, narrow=True)
        remove = remove_button(f"stop {number}", lambda _: self.day.remove(stop))
        return pn.Row(place, lasts, remove, margin=(0, 4, 0, 0), sizing_mode="stretch_width", css_classes=["rj-stop"])
