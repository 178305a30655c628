"""The form of a data sheet: its values make a train, and missing values are assumed."""

import json
import re
from collections.abc import Callable
from typing import Any

import panel_material_ui as pmui

from railjoule.core import ScenarioError
from railjoule.core.imports.data_sheet import KEY
from railjoule.core.scenario.data_sheet import DataSheet
from railjoule.dashboard.editor.fields_of import NO, YES, Field, describe
from railjoule.dashboard.look.key_names import without_keys, words_of
from railjoule.dashboard.parts import html as parts

TITLE = "Train from a data sheet"
ABOUT = (
    "Type the values of the sheet: mass, power, largest speed, length, largest effort or acceleration. Values that "
    "are not given are assumed by formulas for this kind of train; the card of the train lists each assumption, and a "
    "table shows the energy that each of them is worth."
)
FOLD: dict[str, Any] = {
    "margin": (8, 0),
    "sizing_mode": "stretch_width",
    "elevation": 0,
    "square": True,
    "disable_gutters": True,
    "title_variant": "subtitle2",
    "sx": {"&::before": {"display": "none"}, "& .MuiAccordionSummary-root": {"padding": 0}},
}
GRID_CSS = """
:host { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(190px, 100%), 1fr)); gap: 12px 8px;
  padding: 8px 0; align-items: start; }
"""
SOURCE = "DataSheet: "
KEYS = re.compile(r"\b[a-z]+(?:_[a-z0-9]+)*\b")
"""Words that may be keys."""


class SheetForm:
    """Fields of a data sheet and the button that makes a train of them.

    Parameters
    ----------
    bring : callable
        Called with the name and the content of the sheet as a file.
    """

    def __init__(self, bring: Callable[[str, bytes], None]) -> None:
        self.bring = bring
        self.fields = {part.name: part for part in describe(DataSheet) if isinstance(part, Field)}
        self.widgets = {name: _widget(field) for name, field in self.fields.items()}
        self.refused = parts.html_pane(visible=False)
        self.button = pmui.Button(
            label="Make train", variant="outlined", size="small", margin=(4, 0, 8, 0), on_click=self.make
        )
        note = parts.html_pane(parts.note_paragraphs([ABOUT]))
        content = parts.stack(note, parts.stack(*self.widgets.values(), css=GRID_CSS), self.refused, self.button)
        self.view = pmui.Accordion((TITLE, content), **FOLD)

    def make(self, *_: Any) -> None:
        """Add the sheet as a file, or show errors at the fields or above the button."""
        values, is_refused = dict[str, Any](), False
        for name, field in self.fields.items():
            widget, text = self.widgets[name], str(self.widgets[name].value or "").strip()
            sentence = ""
            if text:
                try:
                    values[name] = field.parse(text[:200])
                except ValueError as error:
                    sentence = str(error)
            widget.param.update(helper_text=sentence or field.meaning, error_state=bool(sentence))
            is_refused |= bool(sentence)
        refusal = "" if is_refused else self._refusal(values)
        self.refused.param.update(visible=bool(refusal), object=parts.refusal(refusal) if refusal else "")
        if not (is_refused or refusal):
            self.bring(f"{values.get('name', 'Train')}, data sheet", json.dumps({KEY: values}).encode())

    def _refusal(self, values: dict[str, Any]) -> str:
        """Return why the values make no train, with the names of the fields; empty where they do."""
        try:
            DataSheet(**values).to_vehicle()
        except ScenarioError as error:
            sentence = str(error).removeprefix(SOURCE)
            named = KEYS.sub(
                lambda found: self.fields[found[0]].label if found[0] in self.fields else found[0], sentence
            )
            return f"The sheet {named}" if named.startswith("needs ") else without_keys(named)
        return ""


def _widget(field: Field) -> Any:
    common: dict[str, Any] = {
        "label": field.label,
        "helper_text": field.meaning,
        "size": "small",
        "margin": 0,
        "sizing_mode": "stretch_width",
    }
    if field.kind == "yes_no":
        return pmui.Select(options={"Not given": "", "Yes": YES[0], "No": NO[0]}, value="", **common)
    if field.kind == "choice":
        return pmui.Select(
            options={"Not given": ""} | {words_of(one): one for one in field.choices}, value="", **common
        )
    return pmui.TextInput(max_length=200, **common)
