"""The ends of ranges as typed numbers: of the inputs of a study, and of the selection."""

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import markup
from railjoule.dashboard.pages.explore.fields import MOST_VARIED, StudyField, fields_that_vary
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.numbers import TypedNumber, TypedParameters
from railjoule.dashboard.work.run_table import Ends

ROW_CSS = ":host { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); column-gap: 4px; }"


class Span(TypedParameters):
    """Two ends that are typed.

    Parameters
    ----------
    take : callable
        Called with both ends once one of them has changed.
    field : StudyField, optional
        The input whose bounds hold; without one the ends may be empty.
    """

    passing = ("low", "high")

    low = TypedNumber("from", digits=0, default=None, allow_None=True)
    high = TypedNumber("to", digits=0, default=None, allow_None=True)

    def __init__(self, take: Callable[[tuple[float | None, float | None]], None], field: StudyField | None = None):
        super().__init__()
        self._take, self._field, self._quiet = take, field, False
        self.param.watch(self._give, ["low", "high"])

    def parse_or_none(self, field: str, text: str) -> float | None:
        """Return the number that a text gives for an end.

        Raises
        ------
        ValueError
            With a sentence that names the bound that it misses.
        """
        if not text.strip() and self._field is None:
            return None
        if self._field is None:
            number: float = self.parse(field, text)
        else:
            found = self._field.declared.parse(text) if text.strip() else None
            if found is None:
                raise ValueError("Not a number.")
            number = float(found)
        low, high = (number, self.high) if field == "low" else (self.low, number)
        if low is not None and high is not None and low > high:
            raise ValueError(f"The range {low:g} to {high:g} begins above its end.")
        return number

    def set(self, low: float | None, high: float | None) -> None:
        """Show both ends without reporting them as input."""
        self._quiet = True
        self.param.update(low=low, high=high)
        self._quiet = False

    def _give(self, *_: Any) -> None:
        if not self._quiet:
            self._take((self.low, self.high))


def typed_ends(span: Span, of: str, digits: int = 0) -> pn.Column:
    """Return the fields of both ends beside each other; `of` is read before their labels."""
    fields = [NumberField(span, end, of=f"{of}: ", narrow=True, digits=digits) for end in ("low", "high")]
    return stack(*fields, css=ROW_CSS)


class InputRange:
    """One input that varies: its name, both ends as numbers, and a slider between them."""

    def __init__(self, path: str, field: StudyField | None, take: Callable[[str, Ends], None]) -> None:
        self.path, self.field = path, field
        self._take = take
        label = path if field is None else field.label.removesuffix(f", {words.UNKNOWN}")
        self.span = Span(lambda ends: take(path, ends), field)  # type: ignore[arg-type]
        self.slider = pmui.RangeSlider(
            label=label,
            show_value=False,
            start=0,
            end=1,
            value=(0, 1),
            size="small",
            margin=(4, 20, -6, 20),
            sizing_mode="stretch_width",
        )
        self.slider.param.watch(self._slide, "value_throttled")
        name = html_pane(markup('<div class="row"><span>{}</span></div>', label))
        self.view = stack(name if field is None else self.slider, typed_ends(self.span, label))

    def show(self, low: float, high: float) -> None:
        """Show a range."""
        self.span.set(low, high)
        if self.field is not None:
            least, most = self.field.ends
            self.slider.param.update(
                start=min(least, low), end=max(most, high), step=self.field.step, value=(low, high)
            )

    def _slide(self, event: Any) -> None:
        if event.new is not None and tuple(event.new) != (self.span.low, self.span.high):
            low, high = (round(end, 9) for end in event.new)
            self._take(self.path, (low, high))


class InputRanges:
    """The inputs of a study with their ranges, in the sidebar."""

    def __init__(self, page: Any) -> None:
        self.page, self._quiet = page, False
        self.rows: dict[str, InputRange] = {}
        self.head = html_pane()
        self.inputs = pmui.MultiChoice(
            label="Add input",
            visual_size="small",
            max_items=MOST_VARIED,
            margin=(4, 16, 6, 16),
            sizing_mode="stretch_width",
            sx={"& .MuiSelect-select": {"minHeight": "0 !important", "padding": "6px 32px 6px 14px !important"}},
        )
        self.inputs.param.watch(self._choose, "value")
        self.list = stack()
        self.view = stack(self.head, self.inputs, self.list)
        page.param.watch(self.show, "over")
        page.desk.scenario.param.watch(self.show, ["preset", "opened"])
        self.show()

    def show(self, *_: Any) -> None:
        """Show the inputs and their ranges as they are."""
        over = self.page.over
        known = fields_that_vary(self.page.desk.scenario.edited)
        labels = {field.label.removesuffix(f", {words.UNKNOWN}"): path for path, field in known.items()}
        options = {**labels, **{path: path for path in over if path not in known}}
        self._quiet = True
        self.inputs.param.update(options=options, value=list(over), value_label=f"{len(over)} of {len(known)} vary")
        self._quiet = False
        self.head.object = markup('<div class="section">Inputs and ranges</div>')
        rows = {
            path: self.rows[path]
            if path in self.rows and self.rows[path].field == known.get(path)
            else InputRange(path, known.get(path), self._set)
            for path in over
        }
        for path, (low, high) in over.items():
            rows[path].show(low, high)
        if rows != self.rows:
            self.rows = rows
            self.list[:] = [row.view for row in rows.values()]

    def _set(self, path: str, ends: Ends) -> None:
        if None not in ends:
            self.page.over = {**self.page.over, path: list(ends)}

    def _choose(self, event: Any) -> None:
        """Vary the chosen inputs, the new ones over their first range."""
        if self._quiet:
            return
        over, known = self.page.over, fields_that_vary(self.page.desk.scenario.edited)
        kept = {path: ends for path, ends in over.items() if path in event.new}
        new = {path: list(known[path].first_range) for path in event.new if path in known and path not in over}
        self.page.over = {**kept, **new}
