"""Grey sketches: what stands where a chart will be until it is drawn, and the words for one that cannot be."""

from typing import Literal
from urllib.parse import quote

from railjoule.dashboard.look.markup import Markup, joined, markup

SketchKind = Literal["lines", "bars", "map", "strip"]
COMPUTING = "Computing"
NOT_DRAWN = "This figure could not be drawn because of a program error; the server\u2019s log describes it."
BAR_HEIGHTS = (52, 78, 64, 90, 40, 70, 58, 84, 46, 66)
MAP_ROWS, MAP_COLUMNS = 4, 7
STRIPS = ((0, 9), (10, 46), (57, 17), (75, 25))
"""Start and width of each part of a strip [%]."""
SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100" preserveAspectRatio="none"{}>{}</svg>'
SKETCH_CSS = """
:host(.rj-undrawn) { position: relative; }
:host(.rj-undrawn)::before { content: %(caption)s; padding-left: 50px; white-space: pre;
  font: 500 12px/1.6 var(--rj-font); color: var(--rj-ink2); }
:host(.rj-computing)::before { content: %(message)s / %(name)s; }
:host(.rj-undrawn)::after { content: ""; position: absolute; inset: %(top)spx 14px 10px 50px;
  background: var(--rj-%(colour)s); mask: url("data:image/svg+xml,%(drawn)s") 0 0 / 100%% 100%%; }
"""


def sketch_css(kind: SketchKind, caption: str, name: str) -> str:
    """Return the style sheet that draws the sketch of a chart in its place, below its caption.

    Parameters
    ----------
    kind : str
        Its future shape.
    caption : str
        Empty where the chart has none.
    name : str
        The chart for screen readers.
    """
    style = ' fill="none" stroke="#000" stroke-width="2"' if kind == "lines" else ""
    drawn = quote(SVG.format(style, shapes(kind).replace("<path", '<path vector-effect="non-scaling-stroke"')))
    message = f"{caption}\\A {COMPUTING}" if kind != "strip" else caption
    return SKETCH_CSS % {
        "caption": _quoted(caption),
        "message": _quoted(message).replace("\\\\A", "\\A"),
        "name": _quoted(f"Being computed: {name}"),
        "drawn": drawn,
        "colour": "line2" if kind == "lines" else "ground",
        "top": 24 if caption else 4,
    }


def _quoted(text: str) -> str:
    """Return a string of CSS."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", " ") + '"'


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
    """Return the placeholder of a chart that could not be drawn."""
    failed = '{}<div class="failed" role="alert" style="min-height:{}px"><p>{}</p></div>'
    return markup(failed, markup('<div class="caption">{}</div>', words) if words else "", height, NOT_DRAWN)
