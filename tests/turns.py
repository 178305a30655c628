"""A page whose turns a test takes itself."""

import threading
from collections.abc import Callable

from bokeh.document import Document
from panel.io.state import set_curdoc

PATIENCE_S = 20.0


class Page:
    """A document whose turns the test takes itself."""

    def __init__(self) -> None:
        self.document = Document()
        self._turns: list[Callable[[], None]] = []
        self._due = threading.Semaphore(0)
        self.document.add_next_tick_callback = self._note  # type: ignore[method-assign,assignment]

    def _note(self, callback: Callable[[], None]) -> None:
        self._turns.append(callback)
        self._due.release()

    @property
    def is_due(self) -> bool:
        return bool(self._turns)

    def take_turn(self) -> None:
        assert self._due.acquire(timeout=PATIENCE_S)
        with set_curdoc(self.document):
            self._turns.pop(0)()
