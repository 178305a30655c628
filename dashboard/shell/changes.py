"""The sidebar's last line: how many keys differ from the preset, which, and a way back for each."""

from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.core import RailjouleError
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.state.kept import short
from railjoule.dashboard.state.scenario import RUN_FIELDS
from railjoule.dashboard.state.workbench import Workbench

OPENED, CLOSED = "expand_less", "expand_more"
ROW = (
    '<div class="row small" style="flex-direction: column; gap: 0; overflow-wrap: anywhere">'
    "<span>{}</span><span>{} \u2192 {}</span></div>"
)


UNCHANGED = '<div class="row small" style="padding-top:8px"><span>Unchanged</span></div>'


class Changes:
    """The changed keys; the list opens at a press."""

    def __init__(self, state: Workbench) -> None:
        self.state = state
        self.unchanged = html_pane(UNCHANGED)
        self.count = pmui.Button(
            label="", variant="text", size="small", margin=(0, 0, 0, 6), icon=CLOSED, on_click=self._turn
        )
        self.back = pmui.Button(
            label="Undo all",
            variant="text",
            size="small",
            margin=(0, 4),
            on_click=lambda _: state.scenario.restore(),
        )
        self.list = stack(visible=False)
        self.view = stack(
            pn.FlexBox(self.unchanged, self.count, self.back, margin=0, sizing_mode="stretch_width"), self.list
        )
        state.scenario.param.watch(self._show, ["preset", "opened", *RUN_FIELDS])
        self._show()

    def _turn(self, *_: Any) -> None:
        self.list.visible = not self.list.visible
        self._show()

    def _show(self, *_: Any) -> None:
        changes = self.state.scenario.changes
        number = len(changes)
        opened = self.list.visible and number > 0
        label = f"{number} field{'' if number == 1 else 's'} changed"
        # a change costs the library much more than a look at what there is, and most moves of a slider change nothing
        if (label, opened) != (self.count.label, self.count.icon == OPENED):
            self.count.param.update(label=label, icon=OPENED if opened else CLOSED, visible=number > 0)
            self.back.visible, self.list.visible = number > 0, opened
            # by its text: a pane that has not been drawn yet, as in a sidebar that is closed, cannot be shown
            self.unchanged.object = "" if number else UNCHANGED
        if opened or len(self.list):
            self.list[:] = [self._row(key, value) for key, value in changes.items()] if opened else []

    def _row(self, key: str, value: Any) -> pn.Row:
        before = short(self.state.scenario.original(key))
        take_back = pmui.IconButton(
            icon="undo",
            description=f"Undo {key}",
            size="small",
            margin=0,
            color="default",
            on_click=lambda _: self._take_back(key),
        )
        return pn.Row(
            html_pane(markup(ROW, key, before, short(value))),
            take_back,
            margin=0,
            sizing_mode="stretch_width",
        )

    def _take_back(self, key: str) -> None:
        try:
            self.state.scenario.take_back(key)
        except RailjouleError as refusal:
            self.state.failure = refusal
