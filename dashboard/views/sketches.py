"""Grey sketches: what stands where a chart will be until it is drawn, and the words for one that cannot be."""

import html
from typing import Literal

SketchKind = Literal["lines", "bars", "map", "strip"]
COMPUTING = "Computing"
NOT_DRAWN = "This figure could not be drawn because of a program error; the server\u2019s log describes it."
BAR_HEIGHTS = (52, 78, 64, 90, 40, 70, 58, 84, 46, 66)
MAP_ROWS, MAP_COLUMNS = 4, 7
STRIPS = ((0, 9), (10, 46), (57, 17), (75, 25))
"""Start and width of each part of a strip [%]."""


def sketch(kind: SketchKind, words: str, name: str, height: int, told: str = COMPUTING) -> str:
    """Return the sketch of a chart under its caption, as HTML.

    Parameters
    ----------
    kind : str
        What it will look like.
    words : str
        The caption; empty where the chart has none.
    name : str
        What those hear who listen.
    height : int
        Of the figure [px].
    told : str
        What is going on; empty where nothing is.
    """
    caption = f'<div class="caption">{html.escape(words)}</div>' if words else ""
    heard = f"{'Being computed' if told else 'Not drawn'}: {name}"
    text = f"<p>{html.escape(told)}</p>" if told and kind != "strip" else ""
    return (
        f'{caption}<div class="sketch {kind}" role="img" aria-label="{html.escape(heard)}" style="height:{height}px">'
        f'<svg viewBox="0 0 100 100" preserveAspectRatio="none" aria-hidden="true">{shapes(kind)}</svg>{text}</div>'
    )


def shapes(kind: SketchKind) -> str:
    """Return the shapes of a sketch in a square of 100 by 100, stretched to its place."""
    if kind == "bars":
        width = 100 / len(BAR_HEIGHTS)
        return "".join(
            f'<rect x="{k * width + 1.5:g}" y="{100 - high:g}" width="{width - 3:g}" height="{high:g}"/>'
            for k, high in enumerate(BAR_HEIGHTS)
        )
    if kind == "map":
        wide, high = 100 / MAP_COLUMNS, 100 / MAP_ROWS
        return "".join(
            f'<rect x="{column * wide + 0.4:g}" y="{row * high + 0.8:g}" width="{wide - 0.8:g}" '
            f'height="{high - 1.6:g}" fill-opacity="{0.45 + 0.55 * ((3 * row + 2 * column) % 5) / 4:g}"/>'
            for row in range(MAP_ROWS)
            for column in range(MAP_COLUMNS)
        )
    if kind == "strip":
        return "".join(f'<rect x="{start}" y="8" width="{width}" height="84"/>' for start, width in STRIPS)
    return '<path d="M0 98 C4 40 8 16 18 16 L78 16 C90 16 96 46 100 98"/><path d="M0 99 H100"/>'


def numbers_sketch(count: int = 5) -> str:
    """Return the sketch of a row of numbers, as high as the row."""
    lines = "".join(f'<div class="{line}"><i></i></div>' for line in ("label", "value", "detail"))
    cell = f'<div class="figure">{lines}</div>'
    return f'<div class="figures sketched" role="img" aria-label="Being computed: numbers">{cell * count}</div>'


def not_drawn(words: str, height: int) -> str:
    """Return what stands in the place of a chart that could not be drawn."""
    caption = f'<div class="caption">{html.escape(words)}</div>' if words else ""
    return (
        f'{caption}<div class="sketch failed" role="alert" style="min-height:{height}px"><p>{html.escape(NOT_DRAWN)}'
        "</p></div>"
    )
