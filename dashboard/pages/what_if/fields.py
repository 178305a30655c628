"""The sidebar's part of What if: the actual conditions that the open tab depends on."""

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.dashboard.charts.driven import LOAD
from railjoule.dashboard.day import CHANCE, KIND_WORDS, SENSOR_ERRORS, SENSOR_FIELDS, EventModel
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.pages.what_if.chance import DRAWS, FULL_RUNS, ROBUST_FIELDS
from railjoule.dashboard.pages.what_if.rides import RIDES
from railjoule.dashboard.parts.choices import box, remove_button
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.parts.number_field import LoadField, NumberField, number_fields

FIELDS = {
    "stop": {"position_m": "at, m", "duration_s": "stops for, s"},
    "limit": {"position_m": "from, m", "to_m": "to, m", "limit_kmh": "km/h"},
    "voltage": {"share_percent": "of nominal, %"},
    "recuperation": {"share_percent": "recuperated, %"},
}
"""The fields of each kind of event, with their labels."""
SECTION = '<div class="section">{} <span>\u00b7 {}</span></div>'


class WhatIfFields:
    """The fields of each tab, made when it is first open; in sight on What if only."""

    def __init__(self, page: Any) -> None:
        self.page, self.day, self.scenario = page, page.desk.day, page.desk.scenario
        self.parts = {tab: stack(visible=False) for tab in (LOAD, RIDES, DRAWS)}
        self.view = stack(*self.parts.values())
        self.page.param.watch(self._turn, "tab")
        self._turn()

    def _turn(self, *_: Any) -> None:
        part = self.parts[self.page.tab]
        if not list(part):
            part[:] = {LOAD: self._load, RIDES: self._events, DRAWS: self._chance}[self.page.tab]()
        for one in self.parts.values():
            one.visible = one is part

    # ---- load and position

    def _load(self) -> list[Any]:
        day = self.day
        self.sensors = stack(*number_fields(day, *SENSOR_FIELDS, *SENSOR_ERRORS), visible=day.target_braking)
        # without the target curve nothing depends on them
        day.param.watch(lambda event: self.sensors.param.update(visible=event.new), "target_braking")
        return [
            html_pane(markup(SECTION, "Actual conditions", "the framed cell")),
            LoadField(day, "actual_load_percent", ["most_load_percent"]),
            *number_fields(day, "coordinate_error_m", "speed_error_percent"),
            html_pane(markup(SECTION, "Braking sensors", "metres before the stop")),
            box(day, "target_braking", "Brake along the target curve", margin=(0, 16, 0, 14)),
            self.sensors,
        ]

    # ---- events

    def _events(self) -> list[Any]:
        self.list = stack()
        adders = [
            pmui.Button(
                label=f"+ {word.lower()}", variant="text", size="small", margin=(0, 2), on_click=self._adder(kind)
            )
            for kind, word in KIND_WORDS.items()
        ]
        self.day.param.watch(self._list_events, "events")
        self._list_events()
        return [
            html_pane(markup(SECTION, "Events", "click the speed chart to add one")),
            self.list,
            pn.FlexBox(*adders, margin=(4, 8)),
            NumberField(self.day, "accepted_delay_s"),
        ]

    def _adder(self, kind: str) -> Any:
        return lambda _: self.page.drop(kind, self.scenario.base.line.length_m / 2)

    def _list_events(self, *_: Any) -> None:
        self.list[:] = [self._rows(number, event) for number, event in enumerate(self.day.events, 1)]

    def _rows(self, number: int, event: EventModel) -> pn.Column:
        name = f"{number} {KIND_WORDS[event.kind]}"
        of = f"{name}: "
        fields = [NumberField(event, field, label=label, of=of) for field, label in FIELDS[event.kind].items()]
        remove = remove_button(name, lambda _: self.day.remove(event))
        head = pn.Row(
            html_pane(markup('<div class="row"><b>{}</b></div>', name), align="center"),
            remove,
            margin=(4, 8, 0, 0),
            sizing_mode="stretch_width",
        )
        return stack(head, *fields, NumberField(event, "noticed_at_m", of=of))

    # ---- chance

    def _chance(self) -> list[Any]:
        page = self.page
        self.drawing = Progress(page, f"Run {words.number(FULL_RUNS, 0)}", "Stop", page.draw_all, "drawing")
        self.search = Progress(page, "Find the robust plan", "Cancel", page.search_robust, "searching")
        page.param.watch(self._show_progress, ["chance", "drawing", "robust", "searching"])
        self._show_progress()
        return [
            html_pane(markup(SECTION, "Monte Carlo", "normal, resistance log-normal")),
            *number_fields(self.day, *CHANCE),
            self.drawing.view,
            html_pane(markup(SECTION, "Robust plan", "on time under these draws")),
            *number_fields(page, *ROBUST_FIELDS),
            self.search.view,
        ]

    def _show_progress(self, *_: Any) -> None:
        chance, robust = self.page.chance, self.page.robust
        self.drawing.show(0.0 if chance is None else chance.done / chance.scenario.montecarlo.runs)
        tried = 0 if robust is None else len(robust.found.candidates) + robust.found.refused
        # the check of the chosen plan comes last
        self.search.show(0.0 if robust is None else tried / (robust.found.asked + 2))


class Progress:
    """Buttons that begin and stop a study of the page, and its progress.

    Parameters
    ----------
    page : Page
    label, stop_label : str
    begin : callable
    busy : str
        The parameter of the page that holds whether it is under way.
    """

    def __init__(self, page: Any, label: str, stop_label: str, begin: Any, busy: str) -> None:
        self._is_busy: Callable[[], bool] = lambda: getattr(page, busy)
        run = pmui.Button(label=label, variant="outlined", size="small", margin=(8, 8, 8, 16), on_click=begin)
        self._stop = pmui.Button(
            label=stop_label,
            variant="text",
            size="small",
            margin=(8, 8),
            visible=False,
            on_click=lambda _: page.param.update(**{busy: False}),
        )
        self._progress = pmui.LinearProgress(
            value=0, variant="determinate", margin=(0, 16, 4, 16), sizing_mode="stretch_width", visible=False
        )
        self.view = stack(pn.Row(run, self._stop, margin=0, sizing_mode="stretch_width"), self._progress)

    def show(self, share: float) -> None:
        """Show whether the study is under way, and the share of it that is done."""
        self._progress.visible = self._stop.visible = self._is_busy()
        if self._is_busy():
            self._progress.value = int(100 * share)
