"""Where the names of lines stand: never on a line, on one another or beyond the frame.

All is pixels, counted from the lower left corner of the frame. A name that has no free place gets none: the list of
strategies and the tables name its line too. A place stays free where the frame turns out to be larger than was
reckoned with, or is zoomed: names keep their size while the lines move apart.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import maximum_filter1d, minimum_filter1d

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
END_GAP_PX = 6.0
BOX_GAP_PX = 2.0
AROUND_PX = (10.0, 18.0, 30.0, 44.0)
"""How far beside a point its name may stand."""
SIDEWAYS = 0.02
"""What a pixel away from the preferred place along the line costs, in pixels of steepness or lost distance."""

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
        Where along the frame it stands best, 0 to 1, if it is not at the end.
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
    lines: Sequence[Polyline],
    labels: Sequence[Label],
    width_px: float,
    height_px: float,
    taken: Sequence[Box] = (),
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
        What else stands in the figure.
    """
    if width_px < 2 * COLUMN_PX or height_px < LINE_PX or not labels:
        return [None] * len(labels)
    low, high = envelopes(lines, width_px)
    boxes = list(taken)
    result: list[Box | None] = [None] * len(labels)
    for k, box in _at_ends(lines, labels, low, high, width_px, height_px, boxes):
        result[k] = box
        boxes.append(box)
    rest = [k for k in range(len(labels)) if result[k] is None]
    find = {True: _along, False: _around}
    candidates = {k: find[labels[k].point is None](labels[k], low, high, width_px, height_px) for k in rest}
    # who has least choice chooses first
    for k in sorted(rest, key=lambda k: (len(candidates[k]), k)):
        free = candidates[k][_clear_of(candidates[k], boxes)]
        if len(free):
            left, bottom, right, top = free[0].tolist()
            result[k] = (left, bottom, right, top)
            boxes.append((left, bottom, right, top))
    return result


def envelopes(lines: Sequence[Polyline], width_px: float) -> tuple[FloatArray, FloatArray]:
    """Return the least and the greatest height of each line in each column, shape (lines, columns).

    Where a line has no height in a column, its least one is FAR_PX and its greatest one -FAR_PX.
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


def spread_within(preferred: Sequence[float], gap: float, bottom: float, top: float) -> list[float]:
    """Return places between `bottom` and `top` that lie at least `gap` apart, as near to them as possible.

    The order stays, and the sum of squares of the distances is least: groups that touch stand around the mean of what
    they come from. There must be room for all.
    """
    order = np.argsort(preferred, kind="stable")
    groups: list[tuple[float, int]] = []
    for place, k in enumerate(order):
        # less the gaps before it, a place need only not be below the one before: pool adjacent violators
        groups.append((preferred[k] - place * gap, 1))
        while len(groups) > 1 and groups[-2][0] >= groups[-1][0]:
            (one, n), (other, m) = groups.pop(-2), groups.pop()
            groups.append(((one * n + other * m) / (n + m), n + m))
    free = np.repeat([place for place, _ in groups], [count for _, count in groups])
    placed = np.clip(free, bottom, top - gap * (len(preferred) - 1)) + gap * np.arange(len(preferred))
    result = np.empty(len(preferred))
    result[order] = placed
    return [float(place) for place in result]


def _at_ends(
    lines: Sequence[Polyline],
    labels: Sequence[Label],
    low: FloatArray,
    high: FloatArray,
    width_px: float,
    height_px: float,
    taken: Sequence[Box],
) -> list[tuple[int, Box]]:
    """Return the labels that stand beside the ends of their lines, and their boxes."""
    wanted = [k for k, label in enumerate(labels) if label.at_end and len(lines[label.line][0])]
    if not wanted:
        return []
    pitch = max(labels[k].height_px for k in wanted)
    # no more than fit: `spread_within` needs room for all
    wanted = wanted[: int(height_px // pitch)]
    ends = {k: (float(lines[labels[k].line][0][-1]), float(lines[labels[k].line][1][-1])) for k in wanted}
    places = spread_within([ends[k][1] for k in wanted], pitch, 0.5 * pitch, height_px - 0.5 * pitch)
    result: list[tuple[int, Box]] = []
    for k, place in zip(wanted, places, strict=True):
        left, half = ends[k][0] + END_GAP_PX, 0.5 * labels[k].height_px
        box = left, place - half, left + labels[k].width_px, place + half
        others = [*taken, *(other for _, other in result)]
        if box[2] <= width_px and not _crossed(box, low, high) and _clear_of(np.array([box]), others, 0.0)[0]:
            result.append((k, box))
    return result


def _along(label: Label, low: FloatArray, high: FloatArray, width_px: float, height_px: float) -> FloatArray:
    """Return the boxes above and below a label's line that lie on no line, the best first; shape (boxes, 4)."""
    # one more than it fills, as it may begin within a column
    count = int(np.ceil(label.width_px / COLUMN_PX)) + 1
    if count > low.shape[1]:
        return np.zeros((0, 4))
    # the filters stand in the middle of what they look at: what begins at column s is at s + count // 2
    starts = slice(count // 2, count // 2 + low.shape[1] - count + 1)
    lowest = minimum_filter1d(low, count, axis=1)[:, starts]
    highest = maximum_filter1d(high, count, axis=1)[:, starts]
    own_low, own_high = lowest[label.line], highest[label.line]
    bottoms = [own_high + GAP_PX + offset for offset in OFFSETS_PX]
    bottoms += [own_low - GAP_PX - offset - label.height_px for offset in OFFSETS_PX]
    bottom = np.stack(bottoms)
    top = bottom + label.height_px
    others = np.arange(len(low)) != label.line
    distances = np.maximum(lowest[others, None] - top, bottom - highest[others, None])
    # a line that is alone is as far from others as counts
    distance = distances.min(axis=0, initial=CLEAR_PX)
    whole = maximum_filter1d(low[label.line], count)[starts] < FAR_PX
    free = whole & (distance >= GAP_PX) & (bottom >= 0) & (top <= height_px)
    side, column = np.nonzero(free)
    left = np.clip(COLUMN_PX * (column + 0.5 * count) - 0.5 * label.width_px, 0.0, max(width_px - label.width_px, 0.0))
    aside = np.abs(left + 0.5 * label.width_px - label.preferred * width_px)
    away = np.array([*OFFSETS_PX, *OFFSETS_PX])[side] + (own_high - own_low)[column]
    cost = away - distance[side, column] + SIDEWAYS * aside
    best = np.argsort(cost, kind="stable")
    boxes = np.stack([left, bottom[side, column], left + label.width_px, top[side, column]], axis=1)
    return boxes[best]


def _around(label: Label, low: FloatArray, high: FloatArray, width_px: float, height_px: float) -> FloatArray:
    """Return the boxes around a point that lie on no line, the nearest first; shape (boxes, 4)."""
    assert label.point is not None
    (x, y), width, height = label.point, label.width_px, label.height_px
    boxes = []
    for away in AROUND_PX:
        sides = (x + away, x - away - width, x - 0.5 * width)
        levels = (y - 0.5 * height, y + 0.7 * away, y - 0.7 * away - height)
        boxes += [
            (left, bottom, left + width, bottom + height)
            for bottom in levels
            for left in sides
            if left != sides[2] or bottom != levels[0]
        ]
    free = [box for box in boxes if _inside(box, width_px, height_px) and not _crossed(box, low, high)]
    return np.array(free).reshape(-1, 4)


def _inside(box: Box, width_px: float, height_px: float) -> bool:
    return box[0] >= 0 and box[1] >= 0 and box[2] <= width_px and box[3] <= height_px


def _crossed(box: Box, low: FloatArray, high: FloatArray) -> bool:
    """Return whether any line comes near a box."""
    left, bottom, right, top = box
    columns = slice(int(left // COLUMN_PX), int(right // COLUMN_PX) + 1)
    return bool(((low[:, columns] < top + 1) & (high[:, columns] > bottom - 1)).any())


def _clear_of(
    boxes: FloatArray, taken: Sequence[Box], gap: float = BOX_GAP_PX
) -> "np.ndarray[tuple[int], np.dtype[np.bool_]]":
    """Return which boxes touch none of those taken."""
    clear = np.ones(len(boxes), dtype=np.bool_)
    for left, bottom, right, top in taken:
        beside = (boxes[:, 0] >= right + gap) | (boxes[:, 2] <= left - gap)
        clear &= beside | (boxes[:, 1] >= top) | (boxes[:, 3] <= bottom)
    return clear
