"""The sidebar's part of Robustness: what is otherwise in reality, the sensors, what chance draws."""

from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.dashboard.look import words
from railjoule.dashboard.models.robustness import FULL_RUNS
from railjoule.dashboard.models.workbench import Workbench
from railjoule.dashboard.views.fields import CrushLoad, NumberField, TypedNumber, tie
from railjoule.dashboard.views.parts import html_pane, stack


class RealityFields:
    """Fields for actual conditions, sensors and Monte Carlo; in sight on Robustness alone."""

    def __init__(self, state: Workbench) -> None:
        self.state, model = state, state.robustness
        self.load = NumberField(
            model, "actual_load_percent", "Actual load, % of capacity", step=1, digits=0, unit="%", ends=(0, 100)
        )
        self.crush = CrushLoad(self.load)
        self.place = NumberField(
            model, "coordinate_error_m", "Position error, m", step=1, digits=0, unit="m", ends=(-25, 25)
        )
        self.speed = NumberField(
            model, "speed_error_percent", "Speed error, %", step=0.1, digits=1, unit="%", ends=(-5, 5)
        )
        self.braking = pmui.Checkbox(
            label="Brake along the target curve",
            value=model.target_braking,
            size="small",
            margin=(0, 16, 0, 14),
            sx={"& .MuiTypography-root": {"fontSize": "13px"}},
        )
        self.sensors = [
            TypedNumber(model, "reset_sensor_m", "D1, resets position", digits=0, unit="m"),
            TypedNumber(model, "calibration_length_m", "D1 to D2, calibrates", digits=0, unit="m"),
            TypedNumber(model, "stop_sensor_m", "D3, resets position", digits=0, unit="m"),
            TypedNumber(model, "target_deceleration_ms2", "Target curve, m/s\u00b2", digits=2, unit="m/s\u00b2"),
        ]
        self.chance = [
            TypedNumber(model, "load_deviation_percent", "Load, \u00b1 %", digits=0, unit="%"),
            TypedNumber(model, "error_deviation_m", "Position error, \u00b1 m", digits=1, unit="m"),
            TypedNumber(model, "resistance_deviation_percent", "Resistance, \u00b1 %", digits=1, unit="%"),
            TypedNumber(model, "voltage_deviation_percent", "Supply voltage, \u00b1 %", digits=1, unit="%"),
            TypedNumber(model, "mean_departure_delay_s", "Departure delay, mean, s", digits=0, unit="s"),
            TypedNumber(model, "seed", "Seed", digits=0, unit=""),
        ]
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
        self.view = stack(
            html_pane('<div class="section">Actual conditions <span>\u00b7 the framed cell</span></div>'),
            self.load.view,
            self.crush.view,
            self.place.view,
            self.speed.view,
            html_pane('<div class="section">Braking sensors <span>\u00b7 metres before the stop</span></div>'),
            self.braking,
            *(field.view for field in self.sensors),
            html_pane('<div class="section">Monte Carlo <span>\u00b7 normal, resistance log-normal</span></div>'),
            *(field.view for field in self.chance),
            pn.Row(self.run, self.stop, margin=0, sizing_mode="stretch_width"),
            self.progress,
            html_pane('<hr class="rule">'),
        )
        tie(self.braking, model, "target_braking")
        model.param.watch(self._move_load, "most_load_percent")
        self._move_load()
        model.param.watch(self._show_progress, ["chance", "drawing"])

    def _move_load(self, *_: Any) -> None:
        self.load.set_ends((0, self.state.robustness.most_load_percent))

    def _show_progress(self, *_: Any) -> None:
        model = self.state.robustness
        self.progress.visible = self.stop.visible = model.drawing
        if model.drawing and model.chance is not None:
            self.progress.value = int(100 * model.chance.done / model.chance.runs)
