"""The sidebar's part of Robustness: what is otherwise in reality, the sensors, what chance draws."""

from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.dashboard.day import CHANCE, SENSOR_ERRORS, SENSOR_FIELDS
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.robustness.model import FULL_RUNS, ROBUST_FIELDS
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.parts.number_field import LoadField, number_fields, tie
from railjoule.dashboard.state.workbench import Workbench


class RealityFields:
    """Fields for actual conditions, sensors and Monte Carlo; in sight on Robustness alone."""

    def __init__(self, state: Workbench) -> None:
        self.state, model, day = state, state.robustness, state.day
        self.braking = pmui.Checkbox(
            label="Brake along the target curve",
            value=day.target_braking,
            size="small",
            margin=(0, 16, 0, 14),
            sx={"& .MuiTypography-root": {"fontSize": "13px"}},
        )
        self.drawing = _Study(state, f"Run {words.number(FULL_RUNS, 0)}", "Stop", "draw_all", "stop_drawing")
        self.search = _Study(state, "Find the robust plan", "Cancel", "find_robust", "stop_search")
        self.sensors = stack(*number_fields(day, *SENSOR_FIELDS, *SENSOR_ERRORS), visible=day.target_braking)
        self.view = stack(
            html_pane('<div class="section">Actual conditions <span>\u00b7 the framed cell</span></div>'),
            LoadField(day, "actual_load_percent", ["most_load_percent"]),
            *number_fields(day, "coordinate_error_m", "speed_error_percent"),
            html_pane('<div class="section">Braking sensors <span>\u00b7 metres before the stop</span></div>'),
            self.braking,
            self.sensors,
            html_pane('<div class="section">Monte Carlo <span>\u00b7 normal, resistance log-normal</span></div>'),
            *number_fields(day, *CHANCE),
            self.drawing.view,
            html_pane('<div class="section">Robust plan <span>\u00b7 on time under these draws</span></div>'),
            *number_fields(model, *ROBUST_FIELDS),
            self.search.view,
            html_pane('<hr class="rule">'),
        )
        tie(self.braking, day, "target_braking")
        day.param.watch(self._show_sensors, "target_braking")
        model.param.watch(self._show_progress, ["chance", "drawing", "robust", "searching"])

    def _show_sensors(self, *_: Any) -> None:
        # without the target curve nothing depends on them
        self.sensors.visible = self.state.day.target_braking

    def _show_progress(self, *_: Any) -> None:
        model = self.state.robustness
        chance, robust = model.chance, model.robust
        self.drawing.show(model.drawing, 0.0 if chance is None else chance.done / chance.scenario.montecarlo.runs)
        tried = 0 if robust is None else len(robust.found.candidates) + robust.found.refused
        # the check of the chosen plan comes last
        self.search.show(model.searching, 0.0 if robust is None else tried / (robust.found.asked + 2))


class _Study:
    """Buttons that begin and stop a study of the page, and its progress.

    Parameters
    ----------
    state : Workbench
    label, stop_label : str
    begin, stop : str
        The events of the page's model.
    """

    def __init__(self, state: Workbench, label: str, stop_label: str, begin: str, stop: str) -> None:
        trigger = state.robustness.param.trigger
        run = pmui.Button(
            label=label, variant="outlined", size="small", margin=(8, 8, 8, 16), on_click=lambda _: trigger(begin)
        )
        self._stop = pmui.Button(
            label=stop_label,
            variant="text",
            size="small",
            margin=(8, 8),
            visible=False,
            on_click=lambda _: trigger(stop),
        )
        self._progress = pmui.LinearProgress(
            value=0, variant="determinate", margin=(0, 16, 4, 16), sizing_mode="stretch_width", visible=False
        )
        row = pn.Row(run, self._stop, margin=0, sizing_mode="stretch_width")
        self.view = stack(row, self._progress)

    def show(self, is_running: bool, share: float) -> None:
        """Show whether the study goes on, and which share of it is done."""
        self._progress.visible = self._stop.visible = is_running
        if is_running:
            self._progress.value = int(100 * share)
