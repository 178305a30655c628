"""The buttons below the sidebar's list of scenarios: words with a sign, one below the other."""

from collections.abc import Callable
from typing import Any

import panel_material_ui as pmui

STYLE: dict[str, Any] = {"variant": "text", "size": "small", "margin": (2, 8, 0, 8)}
"""What they share with the field for a file among them."""


def text_button(label: str, icon: str, on_click: Callable[[Any], None], **params: Any) -> pmui.Button:
    """Return one of them; further parameters as the library's."""
    return pmui.Button(label=label, icon=icon, on_click=on_click, **STYLE, **params)
