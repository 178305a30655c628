"""The charts of the trade-off: the frontier with the strategies beside it, ENOC's energy as contours and surface."""

from collections.abc import Callable, Iterable, Mapping
from operator import methodcaller
from typing import Any

import numpy as np
import panel as pn
from bokeh.events import Pan, Tap
from bokeh.models import HoverTool, Span

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.charts.axis import columns, nice_range, points, xy
from railjoule.dashboard.charts.chart import Chart, no_grid
from railjoule.dashboard.charts.dress import line_style, point_tip
from railjoule.dashboard.charts.figures import LoneChart
from railjoule.dashboard.charts.level_map import LevelMap
from railjoule.dashboard.charts.names import Name
from railjoule.dashboard.charts.run_lines import NAMES
from railjoule.dashboard.charts.surface import (
    CIVIDIS,
    LIGHTING,
    NARROW_DISTANCE,
    NARROW_PX,
    TALLEST,
    Scene,
    round_step,
    scene_layout,
)
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.tokens import FONT
from railjoule.dashboard.pages.trade_off.compute import EnocMap, EnocPoint, Points, TradeOff
from railjoule.dashboard.parts import html as parts

TIME_TITLE = "Travel time, s"
MAX_LEVELS = 10
BEFORE_SHARE, TANGENT_SHARE = 0.04, 0.09
"""Share of the range of times that is drawn left of the shortest time, and length of the tangent each way."""
FAR_BELOW_AND_ABOVE = (-1e3, 1e4)
"""Ends of the hatched area of impossible times, beyond any energy [kWh] on the axis."""
WHITE_LINE: Mapping[str, Any] = {"line_color": "#FFFFFF"}
TIP = (
    ("Travel time", "@x{0.0} s"),
    ("Least energy", "@y{0.000} kWh"),
    ("Against the present time", "@more{+0.000} kWh"),
    ("One more second saves", "@price{0.0} Wh"),
)
"""Words and columns of a point of the frontier under the mouse."""
MARK_PX = 6
"""Half the size of the marks that names keep clear of."""
POINT_LIFT = 0.012
"""Points and valley float this share of the height above the surface, or it would hide them."""
SIGNED = (0.02, 0.93)
"""Quantiles of the energies between which contours lie: beyond them the map rises so steeply that they would touch."""


class FrontierChart(LoneChart):
    """Minimum energy over travel time, and the runs of other strategies; a click or a drag sets the travel time."""

    on_time: Callable[[float], None] | None = None
    """Takes the travel time [s] that was clicked."""

    look: Mapping[str, Any] = {"digits": 1, "x_title": TIME_TITLE}
    layers = (
        methodcaller(
            *("glyphs", "varea", "between", "x", "low", "high"), paint={"fill_color": "enoc"}, fill_alpha=0.10
        ),
        methodcaller(
            *("glyphs", "quad", "impossible", "left", "right", *FAR_BELOW_AND_ABOVE),
            paint={"fill_color": "ground", "hatch_color": "groundline"},
            line_color=None,
            fill_alpha=0.55,
            hatch_pattern="right_diagonal_line",
            hatch_scale=8,
            hatch_alpha=0.4,
        ),
        methodcaller("source", "optimal", "x", "y", "more", "price"),
        *(methodcaller("line", name, name, **line_style(name)) for name in ("enoc", "optimal")),
        methodcaller("line", "tangent", "ink", line_width=1),
        methodcaller("dots", "printed", "surface", "enoc", marker="diamond", size=10, line_width=1.5),
        methodcaller("source", "runs", "x", "y", "colour"),
        methodcaller(
            *("glyphs", "scatter", "runs", "x", "y"),
            paint={"line_color": "surface"},
            fill_color="colour",
            size=10,
            line_width=1.5,
        ),
        methodcaller("dots", "point", size=11, line_width=2),
        NAMES,
    )

    def build(self) -> None:
        """Make the figure."""
        super().build()
        self.now = Span(location=-1, dimension="height", line_width=1)
        self.palette.paint(self.now, line_color="line2")
        assert self.figure is not None
        self.figure.add_layout(self.now)
        optimum = [drawn for drawn in self.figure.renderers if drawn.data_source is self.sources["optimal"]]
        self.figure.add_tools(HoverTool(renderers=optimum, mode="vline", tooltips=point_tip(*TIP), visible=False))
        for kind in (Tap, Pan):
            self.figure.on_event(kind, self._set_time)

    def _set_time(self, event: Any) -> None:
        # a drag may lead out of the frame
        if self.on_time is not None and event.x is not None and self.x_range.start < event.x < self.x_range.end:
            self.on_time(round(float(event.x), 1))

    def draw(self, trade_off: TradeOff, best: Trajectory, others: Mapping[str, Trajectory]) -> None:
        """Draw the frontier, ENOC's curve, the optimum of the present time with its tangent, and other runs.

        Parameters
        ----------
        trade_off : TradeOff
        best : Trajectory
            The optimum of the present travel time.
        others : mapping of str to Trajectory
            The runs of other strategies.
        """
        time, energy = trade_off.frontier.travel_time_s, trade_off.frontier.energy_kwh
        shortest = trade_off.frontier.shortest_travel_time_s
        enoc_time, enoc, below_enoc = trade_off.enoc_curve
        printed_time, _, printed_energy = trade_off.printed_points()
        places = {name: (run.travel_time_s, run.energy_kwh) for name, run in others.items()}
        now, price = best.travel_time_s, best.price_of_time_w or 0.0
        all_energies = np.concatenate([energy, enoc, [run.energy_kwh for run in (best, *others.values())]])
        self.set_ranges(
            time_ends(trade_off, [best, *others.values()]),
            nice_range(float(np.nanmin(all_energies)), float(np.nanmax(all_energies))),
        )
        self.put("impossible", left=[0.0], right=[shortest])
        more = energy - trade_off.frontier.energy_kwh_at(now)
        self.put("optimal", **columns(x=time, y=energy, more=more, price=trade_off.frontier.price_of_time_wh_per_s))
        self.put("enoc", **xy(enoc_time, enoc))
        self.put("between", **columns(x=enoc_time, low=below_enoc, high=enoc))
        sides = TANGENT_SHARE * float(time[-1] - time[0]) * np.array([-1.0, 1.0])
        self.put("tangent", **xy(now + sides, best.energy_kwh - price / J_PER_KWH * sides))
        self.put("printed", x=printed_time, y=printed_energy)
        tokens = self.palette.tokens
        self.put("runs", **points(places.values()), colour=[tokens[name] for name in places])
        self.now.location = now
        self.put("point", **points([(now, best.energy_kwh)]))
        printed = list(zip(printed_time.tolist(), printed_energy.tolist(), strict=True))
        self._draw_names(best, places, printed)

    def _draw_names(
        self, best: Trajectory, places: Mapping[str, tuple[float, float]], printed: list[tuple[float, float]]
    ) -> None:
        """Name the points and the curves where there is room."""
        tokens, now, frame = self.palette.tokens, (best.travel_time_s, best.energy_kwh), self.frame_now
        lines = {
            name: (np.asarray(self.sources[name].data["x"]), np.asarray(self.sources[name].data["y"]))
            for name in ("optimal", "tangent", "enoc")
        }
        point = f"{words.energy(now[1])} kWh at {words.time(now[0])} s"
        names = [Name("now", point, tokens["optimal"], point=now)]
        names += [Name(name, words.STRATEGY_WORDS[name], tokens[name], point=place) for name, place in places.items()]
        if best.price_of_time_w is not None:
            price = f"one more second saves {words.price(best.price_of_time_w)} Wh"
            names.append(Name("price", price, tokens["ink2"], point=now))
        names.append(Name("optimal", words.STRATEGY_WORDS["optimal"], tokens["optimal"], preferred=0.8))
        if len(lines["enoc"][0]):
            names.append(Name("enoc", words.STRATEGY_WORDS["enoc"], tokens["enoc"], preferred=0.5))
        inside = [place for place in printed if frame.x[0] <= place[0] <= frame.x[1]]
        if inside:
            names.append(Name("printed", "ENOC, Table 2 of the paper", tokens["enoc"], point=inside[-1]))
        dots = [frame.dot(*place, MARK_PX) for place in (now, *places.values(), *printed)]
        self.place_names({**lines, "now": frame.upright(now[0])}, names, dots)


class ContourChart(LevelMap):
    """ENOC's energy over travel time and acceleration time, as contours."""

    look: Mapping[str, Any] = {"ticks": 5, "x_title": TIME_TITLE, "y_title": "Acceleration time, s"}
    layers = (
        no_grid,
        methodcaller("glyphs", "line", "valley", "x", "y", paint={}, line_width=2, **WHITE_LINE),
        methodcaller("source", "printed", "x", "y", "energy"),
        methodcaller(
            *("glyphs", "scatter", "printed", "x", "y"),
            paint={},
            size=9,
            marker="diamond",
            fill_color=None,
            line_width=1.5,
            **WHITE_LINE,
        ),
        methodcaller(
            *("glyphs", "scatter", "point", "x", "y"),
            paint={"fill_color": "accent"},
            size=11,
            line_width=2,
            **WHITE_LINE,
        ),
    )
    tip = (("Energy", "@image{0.00} kWh"), ("Travel time", "$x{0.0} s"), ("Acceleration time", "$y{0.0} s"))

    def draw(self, trade_off: TradeOff, now: EnocPoint | None) -> None:
        """Draw contours, valley, the present run and the printed ones."""
        enoc_map = trade_off.enoc_map
        if enoc_map is None:
            return
        levels = contour_levels(enoc_map.energy_kwh)
        texts = [f"{level:g}" for level in levels[1:-1]]
        self.draw_map(enoc_map.travel_time_s, enoc_map.acceleration_time_s, enoc_map.energy_kwh, levels, texts)
        self.put("valley", **xy(enoc_map.travel_time_s, enoc_map.best_acceleration_s))
        self.put("point", **points([(now.travel_time_s, now.acceleration_time_s)] if now else []))
        printed = trade_off.printed_points(everywhere=True)
        self.put("printed", **columns(x=printed[0], y=printed[1], energy=printed[2]))


class SurfacePane(Chart):
    """The surface with its valley, the present point and the printed ones."""

    kind = "map"

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("surface", "ENOC: energy, kWh, as a surface (drag to turn)", height)
        self.palette = palette
        self.scene: Scene | None = None

    def build(self) -> None:
        """Make the pane."""
        self.scene = Scene(self.height, self.caption)
        style = f"font:12px {FONT};color:var(--rj-ink2);padding:2px 0 0 6px"
        title = parts.markup('<div style="{1}">{0}</div>', self.caption, style)
        # as plain text: the library escapes what it sends, and pieces of HTML would refuse
        self.content = parts.stack(pn.pane.HTML(str(title), margin=0, css_classes=["rj-caption"]), self.scene)
        self.figure = self.scene

    def draw(self, trade_off: TradeOff, now: EnocPoint | None) -> None:
        """Draw the surface, its valley, the present run and the printed ones."""
        enoc_map = trade_off.enoc_map
        if self.scene is None or enoc_map is None:
            return
        printed = trade_off.printed_points(everywhere=True)
        present = [(now.travel_time_s, now.acceleration_time_s, now.energy_kwh)] if now is not None else []
        bottom = float(np.nanmin(enoc_map.energy_kwh))
        # farther away, the titles of the axes lie within narrow places too
        distance = NARROW_DISTANCE if self.width_px < NARROW_PX else 1.0
        top = min(float(np.nanmax(enoc_map.energy_kwh)), TALLEST * bottom)
        self.scene.draw(
            [
                self._surface(enoc_map, bottom, top),
                self._valley(enoc_map, bottom, top),
                # above the cut it would float in the air
                self._points(
                    [point for point in present if point[2] < top], "present run", "accent", "circle", top - bottom
                ),
                self._printed(enoc_map, printed, bottom, top),
            ],
            scene_layout(self.palette, ("Travel time, s", "Acceleration time, s"), bottom, top, distance),
        )

    def _surface(self, enoc_map: EnocMap, bottom: float, top: float) -> dict[str, Any]:
        heights = np.where(enoc_map.energy_kwh > top, np.nan, enoc_map.energy_kwh)
        step = round_step((top - bottom) / 10)
        return {
            "type": "surface",
            "x": enoc_map.travel_time_s,
            "y": enoc_map.acceleration_time_s,
            "z": heights,
            "colorscale": [[k / (len(CIVIDIS) - 1), colour] for k, colour in enumerate(CIVIDIS)],
            "showscale": False,
            "cmin": bottom,
            "cmax": top,
            "lighting": LIGHTING,
            "contours": {
                "z": {
                    "show": True,
                    "start": float(step * np.ceil(bottom / step)),
                    "end": top,
                    "size": step,
                    "color": "rgba(255,255,255,0.45)",
                    "width": 1,
                }
            },
            "hovertemplate": "%{x:.0f} s, %{y:.0f} s: %{z:.3f} kWh<extra></extra>",
        }

    def _valley(self, enoc_map: EnocMap, bottom: float, top: float) -> dict[str, Any]:
        shown = enoc_map.best_energy_kwh < top
        lift = POINT_LIFT * (top - bottom)
        return {
            "type": "scatter3d",
            "mode": "lines",
            "x": enoc_map.travel_time_s[shown],
            "y": enoc_map.best_acceleration_s[shown],
            "z": enoc_map.best_energy_kwh[shown] + lift,
            "line": {"color": "#FFFFFF", "width": 6},
            "hoverinfo": "skip",
        }

    def _printed(self, enoc_map: EnocMap, printed: Points, bottom: float, top: float) -> dict[str, Any]:
        time, ramp, energy = printed
        inside = (time >= enoc_map.travel_time_s[0]) & (time <= enoc_map.travel_time_s[-1])
        inside &= (
            (ramp >= enoc_map.acceleration_time_s[0]) & (ramp <= enoc_map.acceleration_time_s[-1]) & (energy < top)
        )
        points = list(zip(time[inside], ramp[inside], energy[inside], strict=True))
        return self._points(points, "printed", "enoc", "diamond", top - bottom)

    def _points(self, points: list[Any], name: str, token: str, symbol: str, height: float) -> dict[str, Any]:
        return {
            "type": "scatter3d",
            "mode": "markers",
            "x": [point[0] for point in points],
            "y": [point[1] for point in points],
            "z": [point[2] + POINT_LIFT * height for point in points],
            # not z, which is lifted above the surface
            "customdata": [words.energy(point[2]) for point in points],
            "marker": {
                "size": 7,
                "symbol": symbol,
                "color": self.palette.tokens[token],
                "line": {"color": "#FFFFFF", "width": 2},
            },
            "hovertemplate": name + ": %{x:.1f} s, %{y:.1f} s: %{customdata} kWh<extra></extra>",
        }


def time_ends(trade_off: TradeOff, runs: Iterable[Trajectory]) -> tuple[float, float]:
    """Return the ends of the axis of travel times [s], on which all runs lie."""
    shortest = trade_off.frontier.shortest_travel_time_s
    latest = max(float(trade_off.frontier.travel_time_s[-1]), *(run.travel_time_s for run in runs))
    return shortest - BEFORE_SHARE * (latest - shortest), latest * 1.005


def contour_levels(energy_kwh: FloatArray) -> list[float]:
    """Return the multiples of a round step that most of the energies lie between, and ends beyond all of them."""
    low, high = (float(level) for level in np.nanquantile(energy_kwh, SIGNED))
    step = round_step((high - low) / MAX_LEVELS)
    inner = step * np.arange(np.ceil(low / step), np.floor(high / step) + 1)
    # the first and the last level only close the lowest and the highest band: they must lie beyond all energies
    return [0.0, *(round(float(level), 9) for level in inner if level > 0), float(np.nanmax(energy_kwh)) * 10 + 1]
