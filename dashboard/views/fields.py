"""A number with its text field, perhaps a slider, and the sentence that says why a text was not taken."""

import html
from collections.abc import Mapping
from typing import Any, Protocol

import panel as pn
import panel_material_ui as pmui
import param
from panel.viewable import Viewable

from railjoule.dashboard.look import words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.views.parts import html_pane

MOST_TYPED_DIGITS, ROUNDING = 6, 1e-12
"""More decimals than these nobody types; by less than the second, as a share, binary numbers miss decimal ones."""
HIDDEN_LABEL = {"position": "absolute", "clipPath": "inset(50%)", "width": "1px", "height": "1px", "overflow": "hidden"}


INFO_PLACE = {"position": "absolute", "right": "68px", "top": "0", "z-index": "1"}


class Numbers(Protocol):
    """A model that holds numbers and knows how they may be typed."""

    @property
    def param(self) -> Any:
        """The parameters."""

    @property
    def originals(self) -> Mapping[str, Any]:
        """The numbers of the scenario as it is shipped, by field."""

    def parse(self, field: str, text: str) -> float:
        """Return the number that a text gives; raises ValueError with a sentence."""


def shown(number: float, digits: int) -> str:
    """Return a number with `digits` decimals, and with more where somebody has typed them.

    A number that a computation gave has no end in sight; it is rounded.
    """
    for more in range(digits, MOST_TYPED_DIGITS + 1):
        if abs(round(number, more) - number) <= ROUNDING * max(abs(number), 1.0):
            return words.number(number, more)
    return words.number(number, digits)


class TypedNumber:
    """A text field for one number of a model, its label beside it.

    Parameters
    ----------
    model : Numbers
        Holds the number.
    field : str
        Its name there.
    label : str
        Quantity and unit.
    digits : int
        Decimals in the text field.
    unit : str
        Unit in the sentence about what was kept.
    of : str
        What the number belongs to, where the label alone does not tell; for those who listen.
    """

    def __init__(self, model: Numbers, field: str, label: str, *, digits: int, unit: str, of: str = "") -> None:
        self.model, self.field, self.label, self.digits, self.unit = model, field, label, digits, unit
        self._quiet = False
        number = getattr(model, field)
        self.text = pmui.TextInput(
            label=f"{of}{label}, as a number",
            value="" if number is None else shown(number, digits),
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
        self.mark = html_pane(
            "", visible=False, width=8, height=16, sizing_mode="fixed", styles={"position": "absolute", "right": "5px"}
        )
        # over the left end of the number's field, which is wider than most numbers
        sign = info(label)
        explained = [html_pane(sign, width=24, height=24, sizing_mode="fixed", styles=INFO_PLACE)] if sign else []
        self.view = pn.Column(
            self.beside(),
            self.text,
            self.mark,
            *explained,
            self.error,
            margin=(4, 0, 0, 0),
            sizing_mode="stretch_width",
            styles={"position": "relative"},
            css_classes=["rj-term"],
        )
        self.text.param.watch(self._type, "value")
        model.param.watch(self._follow, field)
        model.param.watch(self._mark, [field, "originals"])
        self._mark()

    def beside(self) -> Viewable:
        """Return what stands beside the text field."""
        return html_pane(f'<div class="row">{html.escape(self.label)}</div>', height=25)

    def _kept(self) -> float:
        return float(getattr(self.model, self.field))

    def _mark(self, *_: Any) -> None:
        """Mark a number that is not the scenario's own."""
        now = getattr(self.model, self.field)
        before = self.model.originals.get(self.field, now)
        self.mark.visible = now != before
        if now != before:
            was = "not set" if before is None else f"{shown(before, self.digits)} {self.unit}".rstrip()
            text = html.escape(f"changed: was {was}")
            self.mark.object = f'<span class="dot" role="img" title="{text}" aria-label="{text}"></span>'

    def _type(self, event: param.parameterized.Event) -> None:
        if self._quiet:
            return
        try:
            number = self.parse(event.new)
        except ValueError as error:
            kept = f"{shown(self._kept(), self.digits)} {self.unit}".rstrip()
            sentence = f"{error} Kept: {kept}."
            self.error.param.update(
                object=f'<div class="error" role="alert">{html.escape(sentence)}</div>', visible=True
            )
            return
        with pn.io.hold():
            self.take(number)
            self._follow()

    def parse(self, text: str) -> float:
        """Return the number that a text gives; raises ValueError with a sentence."""
        return self.model.parse(self.field, text)

    def take(self, number: float) -> None:
        """Give the model a number that was typed."""
        setattr(self.model, self.field, number)

    def _follow(self, *_: Any) -> None:
        """Show the number that the model holds."""
        number = getattr(self.model, self.field)
        if number is not None:
            self._quiet = True
            try:
                self._show(number)
            finally:
                self._quiet = False

    def _show(self, number: float) -> None:
        self.error.visible = False
        self.text.value = shown(number, self.digits)


class NumberField(TypedNumber):
    """A text field with a slider.

    Parameters
    ----------
    model, field, label, digits, unit
        As in `TypedNumber`.
    step : float
        Step of the slider.
    ends : tuple of float
        Ends of the slider.
    """

    def __init__(
        self,
        model: Numbers,
        field: str,
        label: str,
        *,
        step: float,
        digits: int,
        unit: str,
        ends: tuple[float, float],
    ) -> None:
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
        super().__init__(model, field, label, digits=digits, unit=unit)
        self.suggest(number)
        self.slider.param.watch(self._slide, "value")

    def beside(self) -> Viewable:
        """Return the slider with its label."""
        return self.slider

    def set_ends(self, ends: tuple[float, float]) -> None:
        """Move the ends of the slider."""
        number = self._kept()
        self._quiet = True
        self.slider.param.update(start=min(ends[0], number), end=max(ends[1], number), value=number)
        self._quiet = False

    def suggest(self, number: float) -> None:
        """Show a number that holds as long as the model names none."""
        if getattr(self.model, self.field) is None:
            self._quiet = True
            self._show(number)
            self._quiet = False

    def _kept(self) -> float:
        number = getattr(self.model, self.field)
        return float(self.slider.value if number is None else number)

    def _slide(self, event: param.parameterized.Event) -> None:
        if not self._quiet:
            # the number, its mark and whatever else follows the slider reach the browser as one message
            with pn.io.hold():
                setattr(self.model, self.field, round(event.new, 6))

    def _show(self, number: float) -> None:
        super()._show(number)
        self.slider.param.update(start=min(self.slider.start, number), end=max(self.slider.end, number), value=number)


class CrushLoad:
    """The mark beneath a load above the capacity.

    Parameters
    ----------
    field : NumberField
        The load, % of capacity.
    """

    def __init__(self, field: NumberField) -> None:
        self.field = field
        self.view = html_pane(visible=False)
        field.model.param.watch(self._show, field.field)
        self._show()

    def _show(self, *_: Any) -> None:
        factor = getattr(self.field.model, self.field.field) / 100
        self.view.visible = factor > 1
        self.view.object = f'<div class="row small open">{html.escape(words.load(factor))}</div>' if factor > 1 else ""


def tie(widget: Any, model: Any, field: str) -> None:
    """Let a widget's value and a field of a model follow each other."""
    widget.param.watch(lambda event: setattr(model, field, event.new), "value")
    model.param.watch(lambda event: setattr(widget, "value", event.new), field)
