"""The control loop of the drive as a block diagram: blocks and figures light each other up.

A block under the pointer or with the keyboard's focus lights up together with the figures that it explains, and a
figure under the pointer lights its block. A press on a block brings its first figure into sight.
"""

from collections.abc import Mapping
from functools import cache
from importlib.resources import files

import param
from panel.custom import JSComponent

from railjoule.dashboard.look.scripts import module

CHARTS: Mapping[str, tuple[str, ...]] = {
    "reference": ("rival_current", "rival_energy"),
    "precompensator": ("tracking",),
    "motion_control": ("loop_speed", "tracking"),
    "current_control": ("loop_currents",),
    "inverter": ("loop_voltage", "ripple"),
    "machine": ("machine_map",),
    "load": ("loop_speed",),
    "flux_estimator": ("flux_sweep",),
}
"""Names of the figures that each block explains, the foremost first; a figure lights the first of its blocks."""
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


@cache
def drawing() -> str:
    """Return the diagrams for wide and narrow windows as SVG: the style sheet shows one of them."""
    return (files("railjoule.assets") / "templates" / "loop_diagram.svg").read_text(encoding="utf-8")


class LoopDiagram(JSComponent):
    """The block diagram; its colours follow the page's."""

    drawing = param.String(default="", doc="The diagrams for wide and narrow windows, as SVG.")
    charts = param.Dict(default={}, doc="Names of the charts of each block.")

    _esm = module("loop_diagram")

    def __init__(self, **params: object) -> None:
        charts = {block: list(names) for block, names in CHARTS.items()}
        sent = {"drawing": drawing(), "charts": charts, "sizing_mode": "stretch_width", "stylesheets": [STYLE]}
        super().__init__(**{**sent, **params})
