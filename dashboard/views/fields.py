"""A number with its slider, its text field and the sentence that says why a text was not taken."""

import html
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from railjoule.dashboard.look import words
from railjoule.dashboard.models.scenario import ScenarioModel
from railjoule.dashboard.views.parts import html_pane

HIDDEN_LABEL = {"position": "absolute", "clipPath": "inset(50%)", "width": "1px", "height": "1px", "overflow": "hidden"}


class NumberField:
    """Slider and text field for one number of the scenario.

    Parameters
    ----------
    model : ScenarioModel
        Holds the number.
    field : str
        Its name there.
    label : str
        Quantity and unit.
    step : float
        Step of the slider.
    digits : int
        Decimals in the text field.
    unit : str
        Unit in the sentence about what was kept.
    ends : tuple of float
        Ends of the slider.
    """

    def __init__(
        self,
        model: ScenarioModel,
        field: str,
        label: str,
        *,
        step: float,
        digits: int,
        unit: str,
        ends: tuple[float, float],
    ) -> None:
        self.model, self.field, self.digits, self.unit = model, field, digits, unit
        number = getattr(model, field)
        number = ends[0] if number is None else number
        start, end = min(ends[0], number), max(ends[1], number)
        self.slider = pmui.FloatSlider(
            label=label,
            value=number,
            start=start,
            end=end,
            step=step,
            show_value=False,
            tooltips=False,
            size="small",
            margin=(0, 16, 0, 16),
            sizing_mode="stretch_width",
            sx={"& .MuiSlider-root": {"marginX": "6px", "width": "calc(100% - 12px)"}},
        )
        self.text = pmui.TextInput(
            label=f"{label}, as a number",
            value=words.number(number, digits),
            variant="standard",
            size="small",
            width=74,
            margin=0,
            styles={"position": "absolute", "right": "16px", "top": "0"},
            sx={
                "& .MuiInputBase-input": {
                    "textAlign": "right",
                    "fontWeight": 600,
                    "fontSize": "13px",
                    "padding": "1px 0",
                },
                "& .MuiFormLabel-root": HIDDEN_LABEL,
                "& .MuiInput-root": {"marginTop": "0 !important"},
                "& .MuiInput-root:before": {"borderBottomColor": "text.secondary"},
            },
        )
        self.error = html_pane("", visible=False)
        self.view = pn.Column(
            self.slider,
            self.text,
            self.error,
            margin=(4, 0, 0, 0),
            sizing_mode="stretch_width",
            styles={"position": "relative"},
        )
        self._quiet = False
        self.slider.param.watch(self._slide, "value")
        self.text.param.watch(self._type, "value")
        model.param.watch(self._follow, field)

    def set_ends(self, ends: tuple[float, float]) -> None:
        """Move the ends of the slider."""
        number = getattr(self.model, self.field)
        number = self.slider.value if number is None else number
        self._quiet = True
        self.slider.param.update(start=min(ends[0], number), end=max(ends[1], number), value=number)
        self._quiet = False

    def suggest(self, number: float) -> None:
        """Show a number that holds as long as the scenario names none."""
        if getattr(self.model, self.field) is None:
            self._show(number)

    def _slide(self, event: param.parameterized.Event) -> None:
        if not self._quiet:
            setattr(self.model, self.field, round(event.new, 6))

    def _type(self, event: param.parameterized.Event) -> None:
        if self._quiet:
            return
        try:
            number = self.model.parse(self.field, event.new)
        except ValueError as error:
            kept = getattr(self.model, self.field)
            sentence = (
                f"{error} Kept: {words.number(self.slider.value if kept is None else kept, self.digits)} {self.unit}."
            )
            self.error.param.update(
                object=f'<div class="error" role="alert">{html.escape(sentence)}</div>', visible=True
            )
            return
        setattr(self.model, self.field, number)
        self._follow()

    def _follow(self, *_: Any) -> None:
        """Show the number that the scenario holds."""
        number = getattr(self.model, self.field)
        if number is not None:
            self._show(number)

    def _show(self, number: float) -> None:
        self._quiet = True
        try:
            self.error.visible = False
            self.text.value = words.number(number, self.digits)
            self.slider.param.update(
                start=min(self.slider.start, number), end=max(self.slider.end, number), value=number
            )
        finally:
            self._quiet = False
