"""The control loop of the drive as a block diagram: blocks and figures light each other up.

A block under the pointer or with the keyboard's focus lights up together with the figures that it explains, and a
figure under the pointer lights its block. A press on a block brings its first figure into sight.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import param
from panel.custom import JSComponent

from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.scripts import module

BLOCK_HEIGHT, RADIUS, LINE_PX, HEAD_PX = 44.0, 5.0, 15.0, 6.0
FONT_PX, SIGNAL_PX = 12.5, 11.0


@dataclass(frozen=True)
class Block:
    """One block of the loop.

    Parameters
    ----------
    words : tuple of str
        Its name, in lines.
    does : str
        What it does, for those who listen.
    charts : tuple of str
        Names of the charts that it explains, the foremost first.
    """

    words: tuple[str, ...]
    does: str
    charts: tuple[str, ...]


BLOCKS: Mapping[str, Block] = {
    "reference": Block(
        ("Reference",),
        "turns the plan into position, speed, acceleration and jerk over time",
        ("rival_speed", "rival_current", "rival_energy"),
    ),
    "precompensator": Block(
        ("Pre-", "compensator"), "leads the reference by the lag of the loop", ("tracking", "tracking_fine")
    ),
    "motion_control": Block(
        ("Position and", "speed control"), "demands the torque that keeps the train on the reference", ("loop_speed",)
    ),
    "current_control": Block(
        ("Current", "control"), "sets the voltages that produce flux and torque currents", ("loop_currents",)
    ),
    "inverter": Block(("Inverter",), "switches the DC-link voltage to the phases", ("loop_voltage", "ripple")),
    "machine": Block(("Machine",), "turns currents into flux and torque", ("loop_energy", "machine_map", "flux_sweep")),
    "load": Block(("Train", "and line"), "takes the torque and moves", ("loop_place",)),
    "flux_estimator": Block(
        ("Flux estimator",),
        "computes flux and its angle from currents, speed and resistance",
        ("loop_flux", "detuning"),
    ),
}


@dataclass(frozen=True)
class Drawing:
    """Where the blocks stand in a window of one kind, and the lines between them.

    Parameters
    ----------
    kind : str
        Style class.
    size : tuple of float
        Width and height [px].
    block_width : float
        Of a block [px].
    places : mapping
        Left upper corner of each block [px].
    lines : tuple of str
        Paths; each ends in an arrow.
    signals : tuple
        Place and name of each signal, the part after an underscore as subscript.
    """

    kind: str
    size: tuple[float, float]
    block_width: float
    places: Mapping[str, tuple[float, float]]
    lines: tuple[str, ...]
    signals: tuple[tuple[float, float, str], ...]


WIDE = Drawing(
    kind="wide",
    size=(980, 132),
    block_width=104,
    places={
        "reference": (1, 8),
        "precompensator": (147, 8),
        "motion_control": (293, 8),
        "current_control": (439, 8),
        "inverter": (585, 8),
        "machine": (731, 8),
        "load": (875, 8),
        "flux_estimator": (585, 76),
    },
    lines=(
        "M105 30 H146",
        "M251 30 H292",
        "M397 30 H438",
        "M543 30 H584",
        "M689 30 H730",
        "M835 30 H874",
        # currents and speed to the estimator, its flux to the current control
        "M757 52 V91 H690",
        "M895 52 V106 H690",
        "M584 98 H491 V53",
        # speed and position back to their control
        "M935 52 V126 H345 V53",
    ),
    signals=(
        (126, 23, "\u03b8, \u03c9"),
        (272, 23, "\u03b8\u2032"),
        (418, 23, "i_q*"),
        (564, 23, "u*"),
        (710, 23, "u"),
        (854, 23, "T"),
        (775, 84, "i"),
        (871, 101, "\u03c9"),
        (535, 91, "\u03c8, angle"),
        (400, 121, "\u03b8, \u03c9"),
    ),
)
NARROW = Drawing(
    kind="narrow",
    size=(352, 238),
    block_width=92,
    places={
        "reference": (1, 8),
        "precompensator": (121, 8),
        "motion_control": (241, 8),
        "machine": (1, 88),
        "inverter": (121, 88),
        "current_control": (241, 88),
        "load": (1, 168),
        "flux_estimator": (121, 168),
    },
    lines=(
        "M93 30 H120",
        "M213 30 H240",
        "M287 52 V87",
        "M241 110 H214",
        "M121 110 H94",
        "M47 132 V167",
        "M75 132 V150 H150 V167",
        "M93 190 H120",
        "M213 190 H287 V133",
        "M47 212 V230 H346 V30 H334",
    ),
    signals=(
        (107, 23, "\u03b8, \u03c9"),
        (227, 23, "\u03b8\u2032"),
        (303, 74, "i_q*"),
        (228, 103, "u*"),
        (108, 103, "u"),
        (38, 154, "T"),
        (112, 144, "i"),
        (107, 183, "\u03c9"),
        (256, 183, "\u03c8, angle"),
        (200, 225, "\u03b8, \u03c9"),
    ),
)
# both are sent: the style sheet shows the one for the window
DRAWINGS = (WIDE, NARROW)

STYLE = """
:host { display: block; font-family: var(--rj-font); }
:host > div { width: 100%; }
svg { display: block; width: 100%; height: auto; }
svg.wide { max-width: 1180px; } svg.narrow { max-width: 420px; display: none; }
@media (max-width: 899px) { svg.wide { display: none; } svg.narrow { display: block; } }
.wire { fill: none; stroke: var(--rj-ink3); stroke-width: 1.2; }
.head { fill: var(--rj-ink3); }
.signal { fill: var(--rj-ink2); text-anchor: middle; font-style: italic; }
.signal tspan { font-style: normal; }
.block { cursor: pointer; outline: none; }
.block rect { fill: var(--rj-surface); stroke: var(--rj-ink3); stroke-width: 1.2; }
.block text { fill: var(--rj-ink); text-anchor: middle; font-weight: 500; }
.block.lit rect { fill: var(--rj-tint); stroke: var(--rj-accent); stroke-width: 2.4; }
.block:focus-visible rect { stroke: var(--rj-accent); stroke-width: 3.4; }
"""


class LoopDiagram(JSComponent):
    """The block diagram; its colours follow the page's."""

    drawing = param.String(default="", doc="The diagrams for wide and narrow windows, as SVG.")
    charts = param.Dict(default={}, doc="Names of the charts of each block.")

    _esm = module("loop_diagram")

    def __init__(self, **params: object) -> None:
        charts = {name: list(block.charts) for name, block in BLOCKS.items()}
        drawing = "".join(diagram(kind) for kind in DRAWINGS)
        super().__init__(
            **{"drawing": drawing, "charts": charts, "sizing_mode": "stretch_width", "stylesheets": [STYLE], **params}
        )


def diagram(drawing: Drawing) -> Markup:
    """Return a diagram as SVG."""
    width, height = drawing.size
    lines = (markup('<path class="wire" d="{}"/>{}', path, arrow_head(path)) for path in drawing.lines)
    signals = (signal(x, y, name) for x, y, name in drawing.signals)
    # in the order of the loop, which is that of the tab key
    blocks = (block_shape(name, *drawing.places[name], drawing.block_width) for name in BLOCKS)
    return markup(
        '<svg class="{}" viewBox="0 0 {} {}" role="group" aria-label="Block diagram of the control loop">{}</svg>',
        drawing.kind,
        f"{width:g}",
        f"{height:g}",
        joined((*lines, *signals, *blocks)),
    )


def block_shape(name: str, x: float, y: float, width: float) -> Markup:
    """Return a block that can be focused and pressed."""
    block = BLOCKS[name]
    middle = y + 0.5 * BLOCK_HEIGHT - 0.5 * LINE_PX * (len(block.words) - 1)
    rect = f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{BLOCK_HEIGHT:g}" rx="{RADIUS:g}"/>'
    lines = (
        # 0.36 em below the middle is the baseline of a word in the middle: half the height of a capital
        (f'<text x="{x + 0.5 * width:g}" y="{middle + k * LINE_PX + 0.36 * FONT_PX:g}" font-size="{FONT_PX:g}">', line)
        for k, line in enumerate(block.words)
    )
    return markup(
        '<g class="block" role="button" tabindex="0" data-block="{}" aria-label="{} {}; show its chart">{}{}</g>',
        name,
        # a word that is broken at a hyphen is one word for those who listen
        " ".join(block.words).replace("- ", "-"),
        block.does,
        Markup(rect),
        joined(markup("{}{}</text>", Markup(tag), line) for tag, line in lines),
    )


def signal(x: float, y: float, name: str) -> Markup:
    """Return the name of a signal."""
    symbol, _, index = name.partition("_")
    tag = Markup(f'<text class="signal" x="{x:g}" y="{y:g}" font-size="{SIGNAL_PX:g}">')
    small = Markup(f'<tspan dy="3" font-size="{SIGNAL_PX - 2:g}">')
    return markup("{}{}{}</text>", tag, symbol, markup("{}{}</tspan>", small, index) if index else "")


def arrow_head(path: str) -> Markup:
    """Return the head of the arrow in which a path of M, H and V ends."""
    start_x, start_y, *steps = path[1:].split()
    before = end = float(start_x), float(start_y)
    for step in steps:
        before, place = end, float(step[1:])
        end = (place, end[1]) if step.startswith("H") else (end[0], place)
    x, y = end
    along_x, along_y = (x > before[0]) - (x < before[0]), (y > before[1]) - (y < before[1])
    back_x, back_y = x - HEAD_PX * along_x, y - HEAD_PX * along_y
    side_x, side_y = 0.5 * HEAD_PX * along_y, 0.5 * HEAD_PX * along_x
    corners = ((x, y), (back_x + side_x, back_y + side_y), (back_x - side_x, back_y - side_y))
    return markup('<polygon class="head" points="{}"/>', " ".join(f"{a:g},{b:g}" for a, b in corners))
