"""Grey sketches: what stands where a chart will be until it is drawn, and the words for one that cannot be."""

from typing import Literal

from railjoule.dashboard.look.markup import Markup, joined, markup

SketchKind = Literal["lines", "bars", "map", "strip"]
COMPUTING = "Computing"
NOT_DRAWN = "This figure could not be drawn because of a program error; the server\u2019s log describes it."
BAR_HEIGHTS = (52, 78, 64, 90, 40, 70, 58, 84, 46, 66)
MAP_ROWS, MAP_COLUMNS = 4, 7
STRIPS = ((0, 9), (10, 46), (57, 17), (75, 25))
"""Start and width of each part of a strip [%]."""


def sketch(kind: SketchKind, words: str, name: str, height: int, told: str = COMPUTING) -> Markup:
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
    return markup(
        '{caption}<div class="sketch {kind}" role="img" aria-label="{heard}: {name}" style="height:{height}px">'
        '<svg viewBox="0 0 100 100" preserveAspectRatio="none" aria-hidden="true">{shapes}</svg>{text}</div>',
        caption=_caption(words),
        kind=kind,
        heard="Being computed" if told else "Not drawn",
        name=name,
        height=height,
        shapes=shapes(kind),
        text=markup("<p>{}</p>", told) if told and kind != "strip" else "",
    )


def _caption(words: str) -> Markup:
    return markup('<div class="caption">{}</div>', words) if words else Markup()


def shapes(kind: SketchKind) -> Markup:
    """Return the shapes of a sketch in a square of 100 by 100, stretched to its place."""
    if kind == "bars":
        width = 100 / len(BAR_HEIGHTS)
        return Markup().join(
            Markup(f'<rect x="{k * width + 1.5:g}" y="{100 - high:g}" width="{width - 3:g}" height="{high:g}"/>')
            for k, high in enumerate(BAR_HEIGHTS)
        )
    if kind == "map":
        wide, high = 100 / MAP_COLUMNS, 100 / MAP_ROWS
        return Markup().join(
            Markup(
                f'<rect x="{column * wide + 0.4:g}" y="{row * high + 0.8:g}" width="{wide - 0.8:g}" '
                f'height="{high - 1.6:g}" fill-opacity="{0.45 + 0.55 * ((3 * row + 2 * column) % 5) / 4:g}"/>'
            )
            for row in range(MAP_ROWS)
            for column in range(MAP_COLUMNS)
        )
    if kind == "strip":
        bar = '<rect x="{}" y="8" width="{}" height="84"/>'
        return joined(markup(bar, start, width) for start, width in STRIPS)
    return Markup('<path d="M0 98 C4 40 8 16 18 16 L78 16 C90 16 96 46 100 98"/><path d="M0 99 H100"/>')


def numbers_sketch(count: int = 5) -> Markup:
    """Return the sketch of a row of numbers, as high as the row."""
    lines = joined(markup('<div class="{}"><i></i></div>', line) for line in ("label", "value", "detail"))
    cells = markup('<div class="figure">{}</div>', lines) * count
    return markup('<div class="figures sketched" role="img" aria-label="Being computed: numbers">{}</div>', cells)


def not_drawn(words: str, height: int) -> Markup:
    """Return what stands in the place of a chart that could not be drawn."""
    failed = '{}<div class="sketch failed" role="alert" style="min-height:{}px"><p>{}</p></div>'
    return markup(failed, _caption(words), height, NOT_DRAWN)
