"""The page's ties to its address, its keys, dropped files, the clipboard, and the server.

The browser's half says when the server is gone, and loads the page's address again when it answers.
"""

from collections.abc import Callable
from typing import Any

import param
from panel.custom import JSComponent

from railjoule.dashboard.keep.dropped import LARGEST_REPORT_BYTES
from railjoule.dashboard.look.scripts import module


class Lifeline(JSComponent):
    """The page's ties to its browser's address, keys, files and clipboard.

    What the browser reports is heard by kind: `open` (a fragment with a state), `undo`, `redo`, `drop` (a file),
    `too_large` (a file that is not sent), `copied`.
    """

    address = param.String(default="", doc="Query or fragment that holds the page's state.")
    started = param.Boolean(default=False, doc="Whether the page has loaded.")
    # the browser has to look first: a message that is too large ends the connection without a word, panel issue 6923
    largest_bytes = param.Integer(default=LARGEST_REPORT_BYTES, doc="Largest file to be dropped.")

    _esm = module("lifeline")

    def __init__(self, **params: object) -> None:
        super().__init__(**params)
        self._listeners: dict[str, Callable[[dict[str, Any]], None]] = {}

    def listen(self, kind: str, callback: Callable[[dict[str, Any]], None]) -> None:
        """Call back with each message of a kind."""
        self._listeners[kind] = callback

    def copy(self, text: str) -> None:
        """Put a text on the clipboard."""
        self._send_msg({"kind": "copy", "text": text})

    def copy_link(self) -> None:
        """Put the page's address on the clipboard."""
        self._send_msg({"kind": "copy_link"})

    def save(self, name: str, text: str, kind: str = "application/toml") -> None:
        """Let the browser save a text as a file of a kind."""
        self._send_msg({"kind": "save", "name": name, "text": text, "type": kind})

    def _handle_msg(self, data: Any) -> None:
        listener = self._listeners.get(str(data.get("kind"))) if isinstance(data, dict) else None
        if listener is not None:
            listener(data)
