"""The field of a number: a text field, perhaps a slider, and the reason why a text was not accepted."""

from collections.abc import Callable, Sequence
from typing import Any

import panel as pn
import param
from panel.custom import JSComponent

from railjoule.dashboard.look import words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.scripts import borrowed
from railjoule.dashboard.look.theme import number_css
from railjoule.dashboard.state.numbers import TypedParameters

Ends = tuple[float, float]


# not panel-material-ui's EditableFloatSlider: its number has no name for screen readers, and was often empty at first
class NumberField(JSComponent):
    """One number of a model, as the model declares it; it has a slider where the model names a step for one.

    The browser writes the numbers down: it receives no answer to a move of the slider, as it has sent the value itself.

    Parameters
    ----------
    model : TypedParameters
        Holds the number.
    field : str
        Its name there.
    ends : tuple of float, optional
        Ends of the slider, where they are not those that the model declares.
    check : callable, optional
        Returns a number that was typed, or raises ValueError with a sentence.
    take : callable, optional
        Gives the model a number that was typed, where more changes than the number.
    **params
        Of the component: `label` where it is not the model's, `of` for what the number belongs to, `narrow`.
    """

    label = param.String(default="", doc="Quantity and unit.")
    of = param.String(default="", doc="Owner of the number, for screen readers.")
    unit = param.String(default="", doc="Unit in sentences.")
    digits = param.Integer(default=0, doc="Decimals, where nobody has typed more.")
    info = param.String(default="", doc="The button that explains the label, as HTML.")
    narrow = param.Boolean(default=False, doc="Whether it stands beside others.")
    value = param.Number(default=None, allow_None=True, doc="The model's number.")
    suggested = param.Number(default=None, allow_None=True, doc="The number that applies if the model has none.")
    original = param.List(default=[], doc="The scenario's own number; nothing where none is known.")
    start = param.Number(default=None, allow_None=True, doc="Lower end of the slider.")
    end = param.Number(default=None, allow_None=True, doc="Upper end of the slider.")
    step = param.Number(default=None, allow_None=True, doc="Its step; None where there is no slider.")
    tick = param.Number(default=None, allow_None=True, doc="The planned value, marked on its rail.")
    note = param.String(default="", doc="A warning about the number.")
    hint = param.String(default="", doc="A remark about the number.")
    refusal = param.String(default="", doc="Why the last text was not taken.")
    answers = param.Integer(default=0, doc="Counts the texts that were answered.")

    _esm = borrowed("number_field")
    _stylesheets = [number_css()]  # noqa: RUF012
    _priority_changes = ("value",)
    """The browser sends it no more often than pages are drawn: it need not wait for more to come."""

    def __init__(
        self,
        model: TypedParameters,
        field: str,
        *,
        ends: Ends | None = None,
        check: Callable[[float], float] = lambda number: number,
        take: Callable[[float], None] | None = None,
        **params: Any,
    ) -> None:
        declared, number = model.param[field], getattr(model, field)
        label = params.get("label", declared.label)
        slider: dict[str, Any] = {}
        if declared.step is not None:
            slider = {"step": declared.step, **around(ends or declared.softbounds, number)}
        super().__init__(
            **{
                "label": label,
                "unit": declared.unit,
                "digits": declared.digits,
                "info": info(label),
                "value": number,
                "margin": 0,
                "sizing_mode": "stretch_width",
                **slider,
                **params,
            }
        )
        self.model, self.field = model, field
        self._check, self._take = check, take or self._set
        self.param.watch(self._slide, "value")
        model.param.watch(self._follow, field)
        model.param.watch(self._compare, "originals")
        self._compare()

    def set_ends(self, ends: Ends) -> None:
        """Move the ends of the slider; a number beyond them is not cut off."""
        # the model's own: if both change together, this field may not have it yet
        number = getattr(self.model, self.field)
        self.param.update(**around(ends, self.suggested if number is None else number))

    def suggest(self, number: float) -> None:
        """Show a number that holds as long as the model names none."""
        if self.value is None:
            self.param.update(suggested=number, **self._wide_enough(number))

    def type(self, text: str) -> None:
        """Take a text that was typed, or say why not; the browser is answered in any case."""
        refusal = ""
        with pn.io.hold():
            try:
                typed = self.model.parse_or_none(self.field, text)
                number = None if typed is None else self._check(typed)
            except ValueError as error:
                refusal = str(error)
            else:
                self._set(None) if number is None else self._take(number)
            # the same refusal twice is no change: the count shows the browser that its second text was answered too
            self.param.update(refusal=refusal, answers=self.answers + 1)

    def _handle_msg(self, data: Any) -> None:
        if isinstance(data, dict) and isinstance(data.get("text"), str):
            self.type(data["text"])

    def _set(self, number: float | None) -> None:
        setattr(self.model, self.field, number)

    def _slide(self, event: param.parameterized.Event) -> None:
        """Set the model to the slider's value; the model's own value in the field is not sent back."""
        if event.new is not None and event.new != getattr(self.model, self.field):
            # whatever follows the number reaches the browser as one message
            with pn.io.hold():
                self._set(float(event.new))

    def _follow(self, *_: Any) -> None:
        """Show the number that the model holds."""
        number = getattr(self.model, self.field)
        # the field shows the slider's value already
        if number != self.value or self.refusal:
            self.param.update(value=number, refusal="", **self._wide_enough(number))

    def _wide_enough(self, number: float | None) -> dict[str, float]:
        """Return ends of the slider, where there is one, widened as far as a number needs."""
        return {} if self.step is None else around((self.start, self.end), number)

    def _compare(self, *_: Any) -> None:
        """Tell the browser what the scenario's own number is."""
        originals = self.model.originals
        self.original = [originals[self.field]] if self.field in originals else []


class LoadField(NumberField):
    """The load of a vehicle: beyond its capacity a note appears, and the vehicle's crush load is the end of the slider.

    Parameters
    ----------
    model, field, **params
        As for `NumberField`; the model has the crush load too, as `most_load_percent`.
    follows : sequence of str
        The parameters of the model on which that depends.
    """

    def __init__(self, model: Any, field: str, follows: Sequence[str], **params: Any) -> None:
        super().__init__(model, field, ends=(0.0, model.most_load_percent), **params)
        model.param.watch(self._tell, field)
        model.param.watch(lambda *_: self.set_ends((0.0, model.most_load_percent)), list(follows))
        self._tell()

    def _tell(self, *_: Any) -> None:
        factor = getattr(self.model, self.field) / 100
        self.note = words.load(factor) if factor > 1 else ""


def around(ends: Ends, number: float | None) -> dict[str, float]:
    """Return the ends of a slider, widened where a number lies beyond them."""
    inside = ends if number is None else (*ends, number)
    return {"start": min(inside), "end": max(inside)}


def number_fields(model: TypedParameters, *fields: str, **params: Any) -> list[NumberField]:
    """Return the fields of some numbers of a model."""
    return [NumberField(model, field, **params) for field in fields]


def tie(widget: Any, model: Any, field: str) -> None:
    """Let a widget's value and a field of a model follow each other."""

    # the values of now, not those of the event: Panel gives a widget another value while it handles an invalid one
    # of its options, and two that each restore the event's value would go on without end
    def to_model(*_: Any) -> None:
        setattr(model, field, widget.value)

    def to_widget(*_: Any) -> None:
        widget.value = getattr(model, field)

    widget.param.watch(to_model, "value")
    model.param.watch(to_widget, field)
