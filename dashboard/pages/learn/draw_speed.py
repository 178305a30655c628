"""The lesson that is drawn, as a part of the page: what the browser is told, and what it tells."""

from typing import Any

import param

from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.pages.learn.drawing import (
    LEAST_KMH,
    MOST_KMH,
    DrawingResult,
    in_time_of,
    read_drawing,
    run_of,
)
from railjoule.dashboard.pages.learn.played_form import PlayedForm


class DrawSpeed(PlayedForm):
    """A speed drawn over the distance in the browser; the server tells the best run in the time that it takes."""

    mesh = param.Dict(default={}, doc="What the train obeys.")
    shortest_s = param.Number(default=0.0, doc="Shortest possible time [s].")
    begun = param.List(default=[], doc="The drawing to begin with [km/h].")
    linked = param.Boolean(default=False, doc="Whether that drawing is one of a link.")
    ends_kmh = param.List(default=[LEAST_KMH, MOST_KMH], doc="The least and the greatest speed that can be drawn.")

    _esm = module("draw_speed")
    result = "drawing"

    def shown(self, found: DrawingResult) -> dict[str, Any]:
        """Return what the train obeys, and the drawing to begin with."""
        return {
            "mesh": dict(found.mesh),
            "shortest_s": found.shortest_s,
            "begun": list(found.begun),
            "linked": bool(found.request.begun),
        }

    def _take(self, message: dict[str, Any]) -> None:
        drawn = str(message.get("drawn", ""))
        if message.get("what") == "open":
            # as a file: an edit of the time would be rounded to what its slider shows
            self.open_in_workbench(lambda: in_time_of(run_of(read_drawing(drawn))), "Draw the speed", "Drive")
        elif message.get("what") == "done":
            self.state.learn.sketched = drawn
