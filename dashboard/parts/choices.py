"""Buttons, and widgets that choose among a few values of a field of a model; widget and field follow each other."""

from collections.abc import Callable, Mapping
from typing import Any

import panel_material_ui as pmui

from railjoule.dashboard.parts.number_field import tie

Options = Mapping[str, Any]
"""The values by the words for them."""


def buttons(model: Any, field: str, options: Options, **params: Any) -> pmui.RadioButtonGroup:
    """Return buttons side by side, of which one is pressed."""
    unbroken = {"& .MuiToggleButton-root": {"whiteSpace": "nowrap"}}
    return _tied(pmui.RadioButtonGroup, model, field, options=dict(options), sx=unbroken, **params)


def radios(model: Any, field: str, label: str, options: Options, **params: Any) -> pmui.RadioBoxGroup:
    """Return a group of choices in a row."""
    return _tied(pmui.RadioBoxGroup, model, field, label=label, options=dict(options), inline=True, **params)


def button(label: str, on_click: Callable[[Any], Any], **params: Any) -> pmui.Button:
    """Return a button of a page."""
    return pmui.Button(label=label, on_click=on_click, **{"variant": "outlined", "size": "small", **params})


def over_time_buttons(state: Any, **params: Any) -> pmui.RadioButtonGroup:
    """Return the buttons that lay the runs of all pages over distance or time."""
    return buttons(state, "over_time", {"Distance": False, "Time": True}, **params)


def menu(model: Any, field: str, label: str, options: Options, **params: Any) -> pmui.Select:
    """Return a menu of the sidebar."""
    place = {"margin": (8, 16, 4, 16), "sizing_mode": "stretch_width"}
    return _tied(pmui.Select, model, field, label=label, options=dict(options), **{**place, **params})


def box(model: Any, field: str, label: str, **params: Any) -> pmui.Checkbox:
    """Return a box to tick."""
    small = {"& .MuiFormControlLabel-label": {"fontSize": "13px"}}
    return _tied(pmui.Checkbox, model, field, label=label, sx=small, **params)


def remove_button(name: str, on_click: Callable[[Any], Any]) -> pmui.IconButton:
    """Return the cross that removes an entry of a list."""
    return pmui.IconButton(
        icon="close", size="small", margin=0, description=f"Remove {name}", on_click=on_click, color="default"
    )


def _tied(kind: Any, model: Any, field: str, **params: Any) -> Any:
    widget = kind(value=getattr(model, field), size="small", **params)
    tie(widget, model, field)
    return widget
