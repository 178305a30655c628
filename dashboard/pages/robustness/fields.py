"""The sidebar's part of Robustness: what is otherwise in reality, the sensors, what chance draws."""

from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.dashboard.actual.follower import SENSOR_FIELDS
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.robustness.model import CHANCE_FIELDS, FULL_RUNS
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.parts.number_field import LoadField, number_fields, tie
from railjoule.dashboard.state.workbench import Workbench


class RealityFields:
    """Fields for actual conditions, sensors and Monte Carlo; in sight on Robustness alone."""

    def __init__(self, state: Workbench) -> None:
        self.state, model = state, state.robustness
        self.braking = pmui.Checkbox(
            label="Brake along the target curve",
            value=model.target_braking,
            size="small",
            margin=(0, 16, 0, 14),
            sx={"& .MuiTypography-root": {"fontSize": "13px"}},
        )
        self.run = pmui.Button(
            label=f"Run {words.number(FULL_RUNS, 0)}",
            variant="outlined",
            size="small",
            margin=(8, 8, 8, 16),
            on_click=lambda _: model.param.trigger("draw_all"),
        )
        self.stop = pmui.Button(
            label="Stop",
            variant="text",
            size="small",
            margin=(8, 8),
            visible=False,
            on_click=lambda _: model.param.trigger("stop_drawing"),
        )
        self.progress = pmui.LinearProgress(
            value=0, variant="determinate", margin=(0, 16, 4, 16), sizing_mode="stretch_width", visible=False
        )
        self.sensors = stack(*number_fields(model, *SENSOR_FIELDS), visible=model.target_braking)
        self.view = stack(
            html_pane('<div class="section">Actual conditions <span>\u00b7 the framed cell</span></div>'),
            LoadField(model, "actual_load_percent", ["most_load_percent"]),
            *number_fields(model, "coordinate_error_m", "speed_error_percent"),
            html_pane('<div class="section">Braking sensors <span>\u00b7 metres before the stop</span></div>'),
            self.braking,
            self.sensors,
            html_pane('<div class="section">Monte Carlo <span>\u00b7 normal, resistance log-normal</span></div>'),
            *number_fields(model, *CHANCE_FIELDS),
            pn.Row(self.run, self.stop, margin=0, sizing_mode="stretch_width"),
            self.progress,
            html_pane('<hr class="rule">'),
        )
        tie(self.braking, model, "target_braking")
        model.param.watch(self._show_sensors, "target_braking")
        model.param.watch(self._show_progress, ["chance", "drawing"])

    def _show_sensors(self, *_: Any) -> None:
        # without the target curve nothing depends on them
        self.sensors.visible = self.state.robustness.target_braking

    def _show_progress(self, *_: Any) -> None:
        model = self.state.robustness
        self.progress.visible = self.stop.visible = model.drawing
        if model.drawing and model.chance is not None:
            self.progress.value = int(100 * model.chance.done / model.chance.runs)
