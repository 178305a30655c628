"""Positions of the names of lines: never on a line, on one another or beyond the frame.

All is pixels, counted from the lower left corner of the frame. A name that has no free place gets none: the list of
strategies and the tables name its line too. A place stays free where the frame turns out to be larger than was
assumed, or is zoomed: names keep their size while the lines move away from each other.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from railjoule.core.arrays import FloatArray

COLUMN_PX = 4.0
"""Lines are looked at in columns of this width."""
GAP_PX = 3.0
"""Between a name and any line."""
OFFSETS_PX = (0.0, 6.0, 13.0)
"""How much further away from its line a name may stand, where another line runs close beside it."""
CLEAR_PX = 14.0
"""A name that is this far from other lines cannot be taken for theirs; more distance gains nothing."""
LINE_PX = 15.0
"""Height of a line of text of 12 px."""
END_GAP_PX, END_SHIFT_PX, END_STEP_PX = 6.0, 46.0, 1.0
"""Between the end of a line and its name; how far up or down from it the name may be, and in which steps."""
END_SHIFTS_PX = np.repeat(np.arange(0.0, END_SHIFT_PX, END_STEP_PX), 2)
END_SHIFTS_PX[1::2] *= -1
"""The shifts in the order in which they are tried: up and down by turns."""
BOX_GAP_PX = 2.0
AROUND_PX = (10.0, 18.0, 30.0, 44.0)
"""How far beside a point its name may stand."""
SIDEWAYS = 0.02
"""Cost of a pixel away from the preferred place along the line, in pixels of steepness or lost distance."""
WIDTHS_EM = {
    letter: width
    for letters, width in {
        "\u202f\u2009": 0.15,
        "ijlI": 0.28,
        " .,:;|'!\u00a0": 0.31,
        "t()/[]": 0.37,
        "frJ1-": 0.47,
        "\u2013szvxkaceyh": 0.58,
        "nudobgqpEFL7": 0.62,
        "wMmW\u2030%@\u2014": 1.0,
    }.items()
    for letter in letters
}
"""Widths of Inter's letters, not below those that a browser measures."""
USUAL_EM, CAPITAL_EM = 0.66, 0.77
# finite, as the difference of two infinite heights would be NaN
FAR_PX = 1e9
Box = tuple[float, float, float, float]
"""Left, bottom, right, top [px]."""
Polyline = tuple[FloatArray, FloatArray]
"""Places and heights of the corners [px]; the places never decrease."""
COLUMNS = ("x", "y", "text", "colour", "align", "dx", "line")
LINE_HEIGHT = 1.25
"""Height of a line of text over the size of its letters."""


@dataclass(frozen=True)
class Label:
    """A name that wants a place.

    Parameters
    ----------
    line : int
        Which of the lines it names; unused where it names a point.
    width_px, height_px : float
    at_end : bool
        Whether it stands beside the end of its line, if there is room.
    preferred : float
        Best place along the frame, 0 to 1, if it is not the end.
    point : tuple or None
        The point that it names, if it names no line [px].
    """

    line: int
    width_px: float
    height_px: float = LINE_PX
    at_end: bool = False
    preferred: float = 0.4
    point: tuple[float, float] | None = None


def text_width_px(text: str, size_px: float = 12.0) -> float:
    """Return how wide a text is at most, in the page's font."""
    widths = (WIDTHS_EM.get(letter, CAPITAL_EM if letter.isupper() else USUAL_EM) for letter in text)
    return size_px * sum(widths)


def place_labels(
    lines: Sequence[Polyline], labels: Sequence[Label], width_px: float, height_px: float, taken: Sequence[Box] = ()
) -> list[Box | None]:
    """Return the box of each label, or None where there is no free place.

    Parameters
    ----------
    lines : sequence
        All lines of the figure, those without a name among them.
    labels : sequence of Label
        The most important first.
    width_px, height_px : float
        Size of the frame.
    taken : sequence of Box
        Boxes of other texts and marks in the figure.
    """
    result: list[Box | None] = [None] * len(labels)
    if width_px < 2 * COLUMN_PX or height_px < LINE_PX:
        return result
    low, high = envelopes(lines, width_px)
    boxes = list(taken)

    def place(k: int, candidates: FloatArray) -> None:
        free = candidates[_clear_mask(candidates, boxes)]
        if len(free):
            left, bottom, right, top = free[0].tolist()
            result[k] = (left, bottom, right, top)
            boxes.append((left, bottom, right, top))

    for k, label in enumerate(labels):
        if label.at_end and len(lines[label.line][0]):
            place(k, _free(_beside(label, lines[label.line], height_px), low, high, width_px, height_px))
    rest: dict[int, FloatArray] = {}
    for k, label in enumerate(labels):
        if result[k] is None and label.point is not None:
            rest[k] = _free(_around(label, *label.point), low, high, width_px, height_px)
        elif result[k] is None:
            rest[k] = _along(label, low, high, width_px, height_px)
    # labels with the least choice choose first
    for k in sorted(rest, key=lambda k: (len(rest[k]), k)):
        place(k, rest[k])
    return result


def envelopes(lines: Sequence[Polyline], width_px: float) -> tuple[FloatArray, FloatArray]:
    """Return the least and the greatest height of each line in each column, shape (lines, columns).

    If a line has no height in a column, its least one is FAR_PX and its greatest one -FAR_PX.
    """
    count = int(np.ceil(width_px / COLUMN_PX))
    edges = COLUMN_PX * np.arange(count + 1)
    low, high = np.full((len(lines), count), FAR_PX), np.full((len(lines), count), -FAR_PX)
    for k, (places, heights) in enumerate(lines):
        known = np.isfinite(heights)
        x, y = places[known], heights[known]
        if len(x) < 2:
            continue
        at_edges = np.interp(edges, x, y, left=np.nan, right=np.nan)
        # unlike np.minimum it passes over NaN: at the edge of a column in which the line ends it has no height
        np.fmin(at_edges[:-1], at_edges[1:], out=low[k])
        np.fmax(at_edges[:-1], at_edges[1:], out=high[k])
        np.copyto(low[k], FAR_PX, where=np.isnan(low[k]))
        np.copyto(high[k], -FAR_PX, where=np.isnan(high[k]))
        inside = (x >= 0) & (x <= edges[-1])
        # a corner on the right edge of the frame belongs to its last column
        columns = np.minimum(x[inside] // COLUMN_PX, count - 1).astype(np.intp)
        # unlike low[k][columns] = ..., it counts all corners where several lie in one column
        np.minimum.at(low[k], columns, y[inside])
        np.maximum.at(high[k], columns, y[inside])
    return low, high


def _beside(label: Label, line: Polyline, height_px: float) -> FloatArray:
    """Return the boxes beside the end of a label's line, the nearest first; shape (boxes, 4)."""
    half, left = 0.5 * label.height_px, float(line[0][-1]) + END_GAP_PX
    middle = np.clip(float(line[1][-1]) + END_SHIFTS_PX, half, height_px - half)
    ends = np.full((2, len(middle)), [[left], [left + label.width_px]])
    return np.column_stack([ends[0], middle - half, ends[1], middle + half])


def _along(label: Label, low: FloatArray, high: FloatArray, width_px: float, height_px: float) -> FloatArray:
    """Return the boxes above and below a label's line that lie on no line, the best first; shape (boxes, 4)."""
    # one more than it fills, as it may begin within a column
    count = int(np.ceil(label.width_px / COLUMN_PX)) + 1
    if count > low.shape[1]:
        return np.zeros((0, 4))
    lows, highs = (sliding_window_view(ends, count, axis=1) for ends in (low, high))
    lowest, highest = lows.min(axis=-1), highs.max(axis=-1)
    own_low, own_high = lowest[label.line], highest[label.line]
    away_px = GAP_PX + np.array(OFFSETS_PX)[:, None]
    bottom = np.concatenate([own_high + away_px, own_low - away_px - label.height_px])
    top = bottom + label.height_px
    others = np.arange(len(low)) != label.line
    distances = np.maximum(lowest[others, None] - top, bottom - highest[others, None])
    # a single line is as far from others as counts
    distance = distances.min(axis=0, initial=CLEAR_PX)
    whole = lows[label.line].max(axis=-1) < FAR_PX
    free = whole & (distance >= GAP_PX) & (bottom >= 0) & (top <= height_px)
    side, column = np.nonzero(free)
    left = np.clip(COLUMN_PX * (column + 0.5 * count) - 0.5 * label.width_px, 0.0, max(width_px - label.width_px, 0.0))
    aside = np.abs(left + 0.5 * label.width_px - label.preferred * width_px)
    away = np.array([*OFFSETS_PX, *OFFSETS_PX])[side] + (own_high - own_low)[column]
    cost = away - distance[side, column] + SIDEWAYS * aside
    lower = bottom[side, column]
    boxes = np.column_stack([left, lower, left + label.width_px, lower + label.height_px])
    return boxes[np.argsort(cost, kind="stable")]


def _around(label: Label, x: float, y: float) -> FloatArray:
    """Return the boxes around a point, the nearest first; shape (boxes, 4)."""
    width, height = label.width_px, label.height_px
    boxes = []
    for away in AROUND_PX:
        sides = (x + away, x - away - width, x - 0.5 * width)
        levels = (y - 0.5 * height, y + 0.7 * away, y - 0.7 * away - height)
        places = [(left, bottom) for bottom in levels for left in sides][:2]
        places += [(left, bottom) for bottom in levels[1:] for left in sides]
        boxes += [(left, bottom, left + width, bottom + height) for left, bottom in places]
    return np.array(boxes)


def _free(boxes: FloatArray, low: FloatArray, high: FloatArray, width_px: float, height_px: float) -> FloatArray:
    """Return the boxes within the frame that no line comes near."""
    free = (boxes[:, :2] >= 0).all(axis=1) & (boxes[:, 2] <= width_px) & (boxes[:, 3] <= height_px)
    # boxes above each other meet the same columns
    for left in np.unique(boxes[free, 0]):
        among = np.flatnonzero(free & (boxes[:, 0] == left))
        columns = slice(int(left // COLUMN_PX), int(boxes[among[0], 2] // COLUMN_PX) + 1)
        below, above = boxes[among, 3, None] + 1, boxes[among, 1, None] - 1
        free[among] = ~((low[:, columns].ravel() < below) & (high[:, columns].ravel() > above)).any(axis=1)
    return boxes[free]


def _clear_mask(boxes: FloatArray, taken: Sequence[Box]) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
    """Return which boxes touch none of those taken."""
    clear = np.ones(len(boxes), dtype=np.bool_)
    for left, bottom, right, top in taken:
        beside = (boxes[:, 0] >= right + BOX_GAP_PX) | (boxes[:, 2] <= left - BOX_GAP_PX)
        clear &= beside | (boxes[:, 1] >= top) | (boxes[:, 3] <= bottom)
    return clear


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
        Best place along the frame, 0 to 1.
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
