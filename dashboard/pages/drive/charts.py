"""Figures that only Drive has: speeds, the bar that plays the run, the price of force, and Bellman's law."""

from collections.abc import Callable, Mapping
from operator import methodcaller
from typing import Any

import numpy as np
import param
from bokeh.models import LinearColorMapper, Span
from bokeh.palettes import interp_palette
from panel.custom import JSComponent

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.core.strategies.bellman import ControlLaw
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.charts.axis import Axis, xy
from railjoule.dashboard.charts.chart import no_grid, zero_line
from railjoule.dashboard.charts.quantities import ENERGY, POSITION, POWER, SPEED, SUPPLY_CURRENT, TIME
from railjoule.dashboard.charts.run_charts import LineStrip
from railjoule.dashboard.charts.run_lines import Curve
from railjoule.dashboard.charts.scene import BORDERS, VARIANT, RunScene, SceneChart, draw_borders
from railjoule.dashboard.charts.speed import SpeedChart
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.scripts import module

# pixels of the picture along the line and the speed
COLUMNS, ROWS = 180, 64
COLOURS = 21
"""From full braking over coasting to full effort."""
LOWEST, HIGHEST = -0.5, 2.5
"""Ends of the axis of the price [J/J]: next to a stop it grows without limit, elsewhere it stays near 0 to 1.5."""
TRAIN = "train"
"""The source of the train that assets/scripts/player.js moves."""


class DriveSpeedChart(SpeedChart):
    """Speeds, with a variant of the run, the train that plays, and a line that moves the begin of an instruction."""

    above = (
        methodcaller("line", VARIANT, "accent", line_width=1.6, line_dash=[7, 4]),
        *SpeedChart.above,
        methodcaller("dots", TRAIN, "surface", "accent", size=11, line_width=3),
    )

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__(height, axis, palette)
        self.moved: Callable[[float], None] = lambda _: None
        """Called with the place where the line is dragged to."""
        self.switch: Span | None = None
        self.variant: dict[str, Curve] = {}

    def draw(self, scene: RunScene) -> None:
        """Draw limits, runs and names."""
        run = None if scene.variant is None else scene.variant[1]
        self.variant = {} if run is None else {VARIANT: (scene.x(run), self.values(run))}
        self.put(VARIANT, **xy(*self.variant.get(VARIANT, (np.empty(0), np.empty(0)))))
        super().draw(scene)

    def _draw_names(self, scene: RunScene, lines: Mapping[str, Curve]) -> None:
        super()._draw_names(scene, {**self.variant, **lines})

    def place_switch(self, place: float | None) -> None:
        """Put the line that is dragged at a place of the axis, or hide it."""
        if self.switch is None:
            if place is None or self.figure is None:
                return
            self.switch = Span(
                dimension="height", line_width=3, line_dash=[4, 4], hover_line_width=5, editable=True, name="switch"
            )
            self.palette.paint(self.switch, line_color="accent", hover_line_color="accent")
            self.figure.add_layout(self.switch)
            self.switch.on_change("location", lambda _name, _old, to: self.moved(float(to)))
        # a move by the server was not dragged
        moved, self.moved = self.moved, lambda _: None
        self.switch.update(visible=place is not None, location=place or 0.0)
        self.moved = moved


class TrackStrip(LineStrip):
    """The line, with the train that plays."""

    layers = (*LineStrip.layers, methodcaller("dots", TRAIN, "surface", "accent", size=9, line_width=3))


class PriceChart(SceneChart):
    """The energy from the supply that a joule of work at the wheels is worth at each place, which proves the bound."""

    called, unit, digits = ("price", "Price of force, J from the supply per J at the wheels"), "J/J", 2
    look: Mapping[str, Any] = {"ticks": 3}
    layers = (
        zero_line,
        BORDERS,
        methodcaller("line", "price", "accent", line_width=1.8),
        methodcaller("set_range", LOWEST, HIGHEST),
    )

    @staticmethod
    def is_known(run: Trajectory) -> bool:
        """Return whether one price along the whole line proves the bound of a run."""
        return run.bound is not None and run.bound.costate is not None

    def alternative(self, scene: RunScene) -> str:
        """Return a text alternative."""
        return "Price of force over distance: high where the train drives, low where it brakes."

    def draw(self, scene: RunScene) -> None:
        """Draw the price beside the phases of the chosen run."""
        costate = None if scene.run.bound is None else scene.run.bound.costate
        if costate is None:
            self.clear()
            return
        self.put("price", **xy(scene.x_of_place(costate.position_m), costate.force_price))
        self.follow_line("price")
        draw_borders(self, scene)


class LawChart(SceneChart):
    """Traction blue, braking warm, coasting neutral, empty where the end cannot be reached."""

    called = (
        "law",
        f"Bellman\u2019s law at each speed, km/h: blue traction, warm braking ({words.MINUS}), pale coasting",
    )
    kind, unit, digits = "map", "km/h", 1

    def build(self) -> None:
        """Make the figure."""
        self.frame(ticks=4)
        self.mapper = LinearColorMapper(palette=diverging(self.palette), low=-1, high=1, nan_color="rgba(0, 0, 0, 0)")
        no_grid(self)
        sides = ("image", "x", "y", "dw", "dh")
        self.glyphs("image", "map", *sides, paint={}, color_mapper=self.mapper, level="underlay")
        self.line("run", "ink", line_width=2)

    def draw(self, scene: RunScene, law: ControlLaw | None = None) -> None:
        """Draw the law and the run that follows it."""
        assert law is not None
        image, top = sampled(law)
        self.mapper.palette = diverging(self.palette)
        self.put(
            "map",
            image=[image],
            x=[float(law.position_m[0])],
            y=[0.0],
            dw=[float(law.position_m[-1] - law.position_m[0])],
            dh=[top / MS_PER_KMH],
        )
        run = scene.runs["bellman"]
        self.put("run", **xy(POSITION.values(run), SPEED.values(run)))
        self.set_cursor_sources("run")
        self.set_range(0, top / MS_PER_KMH)


def sampled(law: ControlLaw) -> tuple[FloatArray, float]:
    """Return the control on an even grid of shape (speeds, places), and the greatest speed [m/s]."""
    top = float(law.speed_ms.max())
    places = np.linspace(law.position_m[0], law.position_m[-1], COLUMNS, endpoint=False)
    # a pixel has the law at its middle
    places += 0.5 * (law.position_m[-1] - law.position_m[0]) / COLUMNS
    speeds = (np.arange(ROWS) + 0.5) * top / ROWS
    image = np.full((ROWS, COLUMNS), np.nan)
    cells = np.searchsorted(law.position_m, places, side="right") - 1
    for column, cell in enumerate(cells):
        # above the last speed of a cell there is no law: empty, and not that of the last speed
        image[:, column] = np.interp(speeds, law.speed_ms[cell], law.control[cell], right=np.nan)
    return image, top


def diverging(palette: Palette) -> tuple[str, ...]:
    """Return colours from full braking over coasting to full traction."""
    colours: tuple[str, ...] = interp_palette([palette.tokens[name] for name in ("driven", "coast", "accent")], COLOURS)
    return colours


# ---- the bar that plays the run

DIGITS = 4
"""Decimals of the numbers that are sent: of a MW they are 100 W."""
STYLE = """
:host { padding: 6px 14px 0 20px; box-sizing: border-box; }
.player { display: flex; flex-wrap: wrap; align-items: center; gap: 4px 12px; font: 13px/1.4 var(--rj-font);
  color: var(--rj-ink2); font-feature-settings: "tnum" 1; }
button, select { min-height: 28px; border: 1px solid var(--rj-line2); border-radius: 6px; background: var(--rj-surface);
  color: var(--rj-ink); font: inherit; cursor: pointer; }
button { min-width: 68px; border-color: var(--rj-accent); background: var(--rj-accent); color: var(--rj-surface);
  font-weight: 600; }
:focus-visible { outline: 2px solid var(--rj-accent); outline-offset: 2px; }
input { flex: 1 1 140px; min-width: 100px; height: 24px; margin: 0; accent-color: var(--rj-accent); cursor: pointer; }
.readouts { display: flex; flex-wrap: wrap; gap: 0 14px; }
.readouts span { min-width: 62px; white-space: nowrap; text-align: right; }
.readouts span[hidden] { display: none; }
.idle { visibility: hidden; }
.readouts b { color: var(--rj-ink); font-weight: 600; }
@media (max-width: 899px) { :host { padding: 6px 14px 0; } .idle { display: none; } }
"""


READOUTS = (
    ("time", "s", 1, ""),
    ("position", "m", 0, ""),
    ("speed", "km/h", 1, ""),
    ("power", "MW", 2, "stepped"),
    ("current", "A", 0, "stepped"),
    ("energy", "kWh", 2, ""),
)
"""Column, unit and digits of each number, and whether it is constant in each cell."""
NUMBER = '<span><b data-quantity="{0}" data-digits="{2}" data-stepped="{3}">\u2013</b> {1}</span>'
BAR = """
<button type="button">Play</button>
<select aria-label="Pace"><option value="1">1\u00d7</option><option value="4">4\u00d7</option>
<option value="10">10\u00d7</option></select>
<input type="range" min="0" max="1" step="1" value="0" aria-label="Time of the run, s">
<span class="readouts idle">{}</span>
"""
"""The numbers have their place before there is a run to play."""


class Player(JSComponent):
    """The bar; the browser requests the run before it is played."""

    html = param.String(default=BAR.format("".join(NUMBER.format(*one) for one in READOUTS)), doc="The bar.")
    wanted = param.Boolean(default=False, doc="Whether the browser needs the columns of the run.")
    run = param.Dict(default={}, doc="The quantities over time, and when each instruction begins.")
    train = param.List(default=[], doc="The sources of the train in the figures of speed and track, by id.")
    over_time = param.Boolean(default=False, doc="Whether the figures are over time.")

    _esm = module("player")
    _stylesheets = [STYLE]  # noqa: RUF012


def played_columns(run: Trajectory) -> dict[str, Any]:
    """Return the quantities of a run over time for the browser, and the times when its instructions begin [s]."""
    line = run.scenario.line.in_running_order()
    quantities = [TIME, POSITION, SPEED, ENERGY, POWER, *([] if run.supply_current_a is None else [SUPPLY_CURRENT])]
    columns = {quantity.name: np.round(quantity.values(run), DIGITS).tolist() for quantity in quantities}
    height = np.interp(run.position_m, section_borders(line), height_profile(line))
    starts = [run.phases[group[0]].start_s for group in words.instruction_groups(run.advice)]
    return {**columns, "height": np.round(height, DIGITS).tolist(), "starts": starts}
