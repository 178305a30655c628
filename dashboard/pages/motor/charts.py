"""The figures of Motor, and the control loop of the drive as a block diagram that lights them up.

A block under the pointer or with the keyboard's focus lights up together with the figures that it explains, and a
figure under the pointer lights its block. A press on a block brings its first figure into sight.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from importlib.resources import files

import param
from panel.custom import JSComponent

from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.charts import quantities
from railjoule.dashboard.charts.level_map import MotorMapChart
from railjoule.dashboard.charts.plot import DASHED, SOLID, Plot, Stroke
from railjoule.dashboard.charts.quantities import Quantity, read
from railjoule.dashboard.charts.run_lines import Line, RowPlot
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.look.tokens import DASHES


def column(name: str, attribute: str, divisor: float = 1.0) -> Quantity:
    """Return one of several quantities of a figure: caption, unit and digits are the figure's."""
    return Quantity(name, "", "", 0, read(attribute, divisor))


def of_rivals(quantity: Quantity) -> dict[str, Line]:
    """Return a line for each of the paper's two strategies."""
    rivals: tuple[str, ...] = ("eoc", "enoc")
    return {of.upper(): Line(of, {"line_width": 1.8, "line_dash": DASHES[of]}, of, quantity) for of in rivals}


TORQUE_CURRENT = column("torque_current", "torque_current_a")
INPUT_ENERGY = column("input_energy", "energy_by_input_power_j", J_PER_KWH)
SPEED = replace(quantities.SPEED, name="loop_speed", words="Speed over time, km/h", digits=2)
OF_RUN = (
    RowPlot(
        "loop_speed",
        SPEED,
        {
            "planned": Line("accent", {"line_width": 2.4}, "planned", quantities.SPEED),
            "actual": Line("driven", DASHED, "run", quantities.SPEED),
        },
        (200, 250, 180),
        ticks=5,
    ),
    RowPlot(
        "loop_currents",
        Quantity("loop_currents", "Currents of one motor, A", "A", 1, read("torque_current_a")),
        {
            "flux current": Line("phases", DASHED, "run", column("flux_current", "flux_current_a")),
            "torque current": Line("accent", SOLID, "run", TORQUE_CURRENT),
        },
        (170, 200, 160),
    ),
    RowPlot(
        "loop_voltage",
        Quantity("loop_voltage", "Phase voltage of one motor, V", "V", 0, read("phase_voltage_v")),
        {
            "limit": Line("limit", {"line_width": 1.2}, "run", column("voltage_limit", "voltage_limit_v")),
            "voltage": Line("accent", SOLID, "run", column("phase_voltage", "phase_voltage_v")),
        },
        (130, 150, 120),
        last=True,
    ),
)
OF_TRACKING = (
    RowPlot(
        "tracking",
        Quantity("tracking", "Tracking error with and without pre-compensator, m", "m", 3, read("tracking_error_m")),
        {"without": Line("driven", DASHED, "without"), "with": Line("accent", SOLID, "with")},
        (120, 140, 120),
    ),
)
OF_RIVALS = (
    RowPlot(
        "rival_current",
        Quantity("rival_current", "EOC and ENOC: torque current of one motor, A", "A", 1, read("torque_current_a")),
        of_rivals(TORQUE_CURRENT),
        (140, 160, 130),
    ),
    RowPlot(
        "rival_energy",
        Quantity(
            "rival_energy",
            "EOC and ENOC: energy at the motors so far, kWh",
            "kWh",
            3,
            read("energy_by_input_power_j", J_PER_KWH),
        ),
        of_rivals(INPUT_ENERGY),
        (170, 200, 160),
        digits=1,
        last=True,
    ),
)
MAP = Plot(
    "machine_map",
    "",
    heights=(290, 340, 270),
    chart=lambda height, palette: MotorMapChart(height, palette, "machine_map"),
)
RIPPLE = Plot(
    "ripple",
    "Switched current of one phase, A; dashed: averaged",
    {"switched": Stroke("accent", {"line_width": 1.6}), "averaged": Stroke("driven", DASHED)},
    x_title="Time, ms",
    zero=True,
    room=0.1,
)
FLUX = Plot(
    "flux_sweep",
    "Cruise, %: efficiency, power factor, voltage / limit, loss / loss at rated flux",
    {
        "efficiency": Stroke("accent", word="efficiency"),
        "power factor": Stroke("phases", word="power factor"),
        "loss": Stroke("ink2", word="loss"),
        "voltage": Stroke("limit", word="voltage"),
    },
    (220, 260, 210),
    x_title="Flux current of one motor, A",
    ticks=5,
    from_zero=True,
    uprights={"least": "ink3"},
)


# ---- the block diagram

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
