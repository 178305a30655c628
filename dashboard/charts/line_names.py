"""The names of lines and points in a figure, each where `label_places` finds room for it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.dashboard.charts.label_places import END_GAP_PX, Box, Label, place_labels, text_width_px

COLUMNS = ("x", "y", "text", "colour", "align", "dx", "line")
LINE_HEIGHT = 1.25
"""Height of a line of text over the size of its letters."""


@dataclass(frozen=True)
class Frame:
    """The part of a figure that is drawn in: its size [px] and what its axes span."""

    width_px: float
    height_px: float
    x: tuple[float, float]
    y: tuple[float, float]

    def x_px(self, x: FloatArray) -> FloatArray:
        """Return how far places lie from the left edge [px]."""
        return (np.asarray(x, dtype=float) - self.x[0]) * (self.width_px / (self.x[1] - self.x[0]))

    def y_px(self, y: FloatArray) -> FloatArray:
        """Return how far values lie above the lower edge [px]."""
        return (np.asarray(y, dtype=float) - self.y[0]) * (self.height_px / (self.y[1] - self.y[0]))

    def point_px(self, x: float, y: float) -> tuple[float, float]:
        """Return the place of a point, from the lower left corner [px]."""
        return float(self.x_px(np.array(x))), float(self.y_px(np.array(y)))

    def from_px(self, x_px: float, y_px: float) -> tuple[float, float]:
        """Return the point of a place [px], in the units of the axes."""
        (x, right), (y, top) = self.x, self.y
        return x + x_px * (right - x) / max(self.width_px, 1.0), y + y_px * (top - y) / max(self.height_px, 1.0)

    def upright(self, x: float) -> tuple[FloatArray, FloatArray]:
        """Return an upright line through the frame, in the units of the axes."""
        return np.full(2, x), np.array(self.y)

    def dot(self, x: float, y: float, radius_px: float = 5.0) -> Box:
        """Return the box of a mark."""
        left, bottom = float(self.x_px(np.array(x))) - radius_px, float(self.y_px(np.array(y))) - radius_px
        return left, bottom, left + 2 * radius_px, bottom + 2 * radius_px

    def box(self, x: float, y: float, text: str, size: float = 11, align: str = "left", lift_px: float = 0.0) -> Box:
        """Return the box of a text whose lower edge stands `lift_px` above a place."""
        width = text_width_px(text, size)
        left = float(self.x_px(np.array(x))) - {"left": 0.0, "center": 0.5, "right": 1.0}[align] * width
        bottom = float(self.y_px(np.array(y))) + lift_px
        return left, bottom, left + width, bottom + LINE_HEIGHT * size


@dataclass(frozen=True)
class Name:
    """The name of a line, or of a point.

    Parameters
    ----------
    line : str
        The key of the line; of a point, its own key.
    text, colour : str
    at_end : bool
        Whether it stands beside the end of the line if there is room.
    point : tuple or None
        The point that it names, in the units of the axes.
    preferred : float
        Where along the frame it stands best, 0 to 1.
    """

    line: str
    text: str
    colour: str
    at_end: bool = False
    point: tuple[float, float] | None = None
    preferred: float = 0.4


def rows_of(spans: Sequence[tuple[float, float]], gap_px: float = 6.0) -> list[int]:
    """Return for each span [px] the first row in which it overlaps none of those before it."""
    result: list[int] = []
    for left, right in spans:
        near = zip(spans, result, strict=False)
        full = {row for (start, end), row in near if right + gap_px > start and left < end + gap_px}
        result.append(next(row for row in range(len(spans)) if row not in full))
    return result


def clear_of(box: Box, taken: Sequence[Box], frame: Frame) -> bool:
    """Return whether a box lies within a frame and touches none of those taken."""
    left, bottom, right, top = box
    inside = left >= 0 and bottom >= 0 and right <= frame.width_px and top <= frame.height_px
    return inside and not any(left < b[2] and b[0] < right and bottom < b[3] and b[1] < top for b in taken)


def placed_names(
    frame: Frame,
    lines: Mapping[str, tuple[FloatArray, FloatArray]],
    names: Sequence[Name],
    taken: Sequence[Box] = (),
    size: float = 12.0,
) -> dict[str, list[object]]:
    """Return the columns of the names that have a place.

    Parameters
    ----------
    frame : Frame
    lines : mapping
        Places and values of all lines of the figure by their keys, in the units of the axes.
    names : sequence of Name
        The most important first.
    taken : sequence of Box
        Boxes of other texts in the figure.
    size : float
        Of the letters [px].
    """
    order = {key: k for k, key in enumerate(lines)}
    pixels = [(frame.x_px(x), frame.y_px(y)) for x, y in lines.values()]
    points = [None if one.point is None else frame.point_px(*one.point) for one in names]
    labels = [
        Label(order.get(one.line, 0), text_width_px(one.text, size), LINE_HEIGHT * size, one.at_end, one.preferred, at)
        for one, at in zip(names, points, strict=True)
    ]
    boxes = place_labels(pixels, labels, frame.width_px, frame.height_px, taken)
    rows = []
    for name, label, box in zip(names, labels, boxes, strict=True):
        if box is None:
            continue
        end = float(pixels[label.line][0][-1]) if label.at_end and pixels else np.inf
        # a name beside an end or a point keeps to it when the figure is wider than estimated
        beside = abs(box[0] - end - END_GAP_PX) < 1e-6
        middle = 0.5 * (box[0] + box[2])
        x = end if beside else middle if label.point is None else label.point[0]
        align, dx = ("left", END_GAP_PX) if beside else ("center", middle - x)
        place = frame.from_px(x, 0.5 * (box[1] + box[3]))
        rows.append((*place, name.text, name.colour, align, dx, name.line))
    return {column: [row[k] for row in rows] for k, column in enumerate(COLUMNS)}
