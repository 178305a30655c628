"""The sidebar's part of Drive: what differs from the plan on the day."""

from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.dashboard.look import words
from railjoule.dashboard.models.actual import (
    add_stop,
    as_planned,
    checked_place,
    move_stop,
    stops_of,
)
from railjoule.dashboard.models.disturbances import EventModel
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.views.events import event_sign
from railjoule.dashboard.views.fields import CrushLoad, NumberField, TypedNumber, tie
from railjoule.dashboard.views.parts import html_pane, stack

ERROR_ENDS_M = (-25.0, 25.0)
SLIDER_INSET_PX = 22
"""From the sidebar's edge to the end of a slider's rail."""


class StopPlace(TypedNumber):
    """Where an unplanned stop lies."""

    def __init__(self, state: Workbench, stop: EventModel, of: str) -> None:
        self.state, self.stop = state, stop
        super().__init__(stop, "position_m", "at, m", digits=0, unit="m", of=of)

    def parse(self, text: str) -> float:
        """Return the place that a text gives, if a train can stop there."""
        return checked_place(self.state, self.stop, super().parse(text))

    def take(self, number: float) -> None:
        """Move the stop, and where it is noticed with it."""
        move_stop(self.stop, number)


class ActualFields:
    """The switch of the actual run, and all that differs from the plan; in sight on Drive alone."""

    def __init__(self, state: Workbench) -> None:
        self.state, self.model = state, state.actual
        reality = state.robustness
        self.switch = pmui.Switch(
            label="Actual run", value=self.model.on, size="small", margin=(10, 16, 0, 16), sizing_mode="stretch_width"
        )
        self.load = NumberField(
            reality, "actual_load_percent", "Actual load, %", step=1, digits=0, unit="%", ends=(0, 100)
        )
        self.load_tick = Tick(self.load)
        self.crush = CrushLoad(self.load)
        self.place = NumberField(
            reality, "coordinate_error_m", "Position error, m", step=1, digits=0, unit="m", ends=ERROR_ENDS_M
        )
        self.place_tick = Tick(self.place)
        self.stops = stack()
        self.others = html_pane()
        self.add = pmui.Button(
            label="+ stop", variant="text", size="small", margin=(0, 8), on_click=lambda _: add_stop(state)
        )
        self.reaction = pmui.Select(
            label="Who reacts",
            options={name: reaction for reaction, name in words.REACTION_WORDS.items()},
            value=self.model.reaction,
            size="small",
            margin=(8, 16, 4, 16),
            sizing_mode="stretch_width",
        )
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
            self.load.view,
            self.crush.view,
            self.place.view,
            head,
            self.stops,
            self.others,
            self.reaction,
            self.equal,
            visible=self.model.on,
        )
        self.view = stack(self.switch, self.body)
        tie(self.switch, self.model, "on")
        tie(self.reaction, self.model, "reaction")
        self.model.param.watch(self._unfold, "on")
        reality.param.watch(self._move_load, "most_load_percent")
        state.scenario.param.watch(self._tick, ["load_percent", "edits", "preset", "opened"])
        state.disturbances.param.watch(self._list, ["events", "changed"])
        self._listed: list[EventModel] = []
        self._move_load()
        self._list()

    def _unfold(self, *_: Any) -> None:
        self.body.visible = self.model.on

    def _move_load(self, *_: Any) -> None:
        self.load.set_ends((0, self.state.robustness.most_load_percent))
        self._tick()

    def _tick(self, *_: Any) -> None:
        """Mark the planned values."""
        self.load_tick.show(self.state.scenario.load_percent)
        self.place_tick.show(0.0)

    def _list(self, *_: Any) -> None:
        events = self.state.disturbances.events
        stops = list(stops_of(self.state))
        if [id(stop) for stop in stops] != [id(stop) for stop in self._listed]:
            self._listed = stops
            self.stops[:] = [self._row(number, stop) for number, stop in enumerate(stops, 1)]
        others = [event_sign(event) for event in events if event.kind != "stop"]
        self.others.object = f'<div class="row small muted">Also {", ".join(others)}</div>' if others else ""
        self.others.visible = bool(others)
        self.reaction.visible = bool(events)

    def _row(self, number: int, stop: EventModel) -> pn.Row:
        name = f"Stop {number}: "
        place = StopPlace(self.state, stop, name)
        lasts = TypedNumber(stop, "duration_s", "for, s", digits=0, unit="s", of=name)
        remove = pmui.IconButton(
            icon="close",
            size="small",
            margin=0,
            description=f"Remove stop {number}",
            on_click=lambda _: self.state.disturbances.remove(stop),
            color="default",
        )
        for field in (place, lasts):
            field.text.width = 48
        return pn.Row(
            place.view, lasts.view, remove, margin=(0, 4, 0, 0), sizing_mode="stretch_width", css_classes=["rj-stop"]
        )


class Tick:
    """The planned value on the rail of a slider."""

    def __init__(self, field: NumberField) -> None:
        self.slider = field.slider
        self.mark = html_pane("", width=2, height=10, sizing_mode="fixed")
        field.view.append(self.mark)

    def show(self, planned: float) -> None:
        """Mark a value, if the rail has it."""
        start, end = self.slider.start, self.slider.end
        inside = start <= planned <= end
        self.mark.visible = inside
        if inside:
            share = (planned - start) / (end - start)
            self.mark.object = '<span class="tick" title="planned"></span>'
            self.mark.styles = {
                "position": "absolute",
                "top": "30px",
                "left": f"calc({SLIDER_INSET_PX}px + {share:.4f} * (100% - {2 * SLIDER_INSET_PX}px))",
                "pointer-events": "none",
            }
