"""The charts of the trade-off: frontier, distance to the optimum, ENOC's contours."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from bokeh.events import Pan, Tap
from bokeh.models import ContourRenderer, Range1d, Span
from bokeh.plotting import figure
from bokeh.plotting.contour import contour_data

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.citation import printed_numbers
from railjoule.core.energy import share_above
from railjoule.core.strategies.enoc import best_acceleration_time, enoc_energy
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.charts.chart import columns, nice_range, points, style_of, xy
from railjoule.dashboard.charts.figures import LoneChart, ink_on
from railjoule.dashboard.charts.label_places import Box
from railjoule.dashboard.charts.line_names import Name, clear_of
from railjoule.dashboard.charts.surface import CIVIDIS, round_step
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.pages.trade_off.compute import EnocMap, TradeOff
from railjoule.dashboard.state.workbench import Workbench

TIME_TITLE = "Travel time, s"
MAX_LEVELS = 10
STEEPEST_SHARE = 0.04
"""The frontier is drawn from this share above the shortest time: nearer to it, it rises out of any scale."""
BEFORE_SHARE, TANGENT_SHARE = 0.04, 0.09
"""What is shown of the times that are too short, and how far the tangent reaches each way, of the range of times."""
FAR_BELOW_AND_ABOVE = (-1e3, 1e4)
"""Ends of the tint of impossible times, beyond any energy [kWh] to which the axis reaches."""
MARK_PX = 6
"""Half the size of the marks that names keep clear of."""
SIGNED = (0.02, 0.93)
"""Quantiles of the energies between which contours lie: beyond them the map rises so steeply that they would touch."""


class FrontierChart(LoneChart):
    """Least energy over travel time; a click or a drag sets the travel time."""

    def __init__(self, height: int, state: Workbench, palette: Palette) -> None:
        super().__init__("frontier", "Net energy, kWh, over travel time, s", height, palette)
        self.state = state

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(digits=1, x_title=TIME_TITLE)
        self.glyphs("varea", "between", "x", "low", "high", paint={"fill_color": "enoc"}, fill_alpha=0.10)
        self.source("impossible", "left", "right")
        self.glyphs(
            "quad",
            "impossible",
            "left",
            "right",
            *FAR_BELOW_AND_ABOVE,
            paint={"fill_color": "ground", "hatch_color": "groundline"},
            line_color=None,
            fill_alpha=0.55,
            hatch_pattern="right_diagonal_line",
            hatch_scale=8,
            hatch_alpha=0.4,
        )
        for name in ("enoc", "optimal"):
            self.line(name, name, **style_of(name))
        self.line("tangent", "ink", line_width=1)
        self.dots("printed", "surface", "enoc", marker="diamond", size=10, line_width=1.5)
        self.now = upright(f, self.palette)
        self.dots("point", size=11, line_width=2)
        self.add_names()
        f.on_event(Tap, self._set_time)
        f.on_event(Pan, self._set_time)

    def _set_time(self, event: Any) -> None:
        # a drag may lead out of the frame
        if event.x is not None and self.x_range.start < event.x < self.x_range.end:
            self.state.scenario.travel_time_s = round(float(event.x), 1)

    def draw(self, trade_off: TradeOff, run: Trajectory) -> None:
        """Draw the frontier, ENOC's curve, the present run and its tangent."""
        frontier = trade_off.frontier
        time, energy = frontier.travel_time_s, frontier.energy_kwh
        shortest = frontier.shortest_travel_time_s
        steepest = float(np.interp(shortest * (1 + STEEPEST_SHARE), time, energy))
        now, price = run.travel_time_s, run.price_of_time_w or 0.0
        self.set_ranges(
            (shortest - BEFORE_SHARE * (time[-1] - shortest), float(time[-1]) * 1.005),
            nice_range(float(np.nanmin(energy)), max(steepest, run.energy_kwh), 0.08),
        )
        self.put("impossible", left=[0.0], right=[shortest])
        self.put("optimal", **xy(time, energy))
        enoc_time, enoc, below_enoc = enoc_curve(trade_off)
        self.put("enoc", **xy(enoc_time, enoc))
        self.put("between", **columns(x=enoc_time, low=below_enoc, high=enoc))
        sides = TANGENT_SHARE * float(time[-1] - time[0]) * np.array([-1.0, 1.0])
        self.put("tangent", **xy(now + sides, run.energy_kwh - price / J_PER_KWH * sides))
        printed = printed_points(trade_off)
        self.put("printed", x=printed[0], y=printed[2])
        self.now.location = now
        self.put("point", **points([(now, run.energy_kwh)]))
        self._draw_names(run, printed)

    def _draw_names(self, run: Trajectory, printed: tuple[FloatArray, ...]) -> None:
        """Name the curves, the present point and the printed ones where nothing else is."""
        tokens, now, frame = self.palette.tokens, (run.travel_time_s, run.energy_kwh), self.frame_now
        lines = {
            name: (np.asarray(self.sources[name].data["x"]), np.asarray(self.sources[name].data["y"]))
            for name in ("optimal", "tangent", "enoc")
        }
        times, _, energies = printed
        places = [(float(x), float(y)) for x, y in zip(times, energies, strict=True)]
        point = f"{words.energy(now[1])} kWh at {words.time(now[0])} s"
        price = f"saved per extra second: {words.price(run.price_of_time_w or 0.0)} Wh"
        names = [
            Name("now", point, tokens["optimal"], point=now),
            Name("price", price, tokens["ink2"], point=now),
            Name("optimal", "optimal", tokens["optimal"], preferred=0.8),
        ]
        if len(lines["enoc"][0]):
            names.append(Name("enoc", "ENOC", tokens["enoc"], preferred=0.5))
        inside = [place for place in places if frame.x[0] <= place[0] <= frame.x[1]]
        if inside:
            names.append(Name("printed", "ENOC as printed, Table 2", tokens["enoc"], point=inside[-1]))
        dots = [frame.dot(*place, MARK_PX) for place in (now, *places)]
        self.place_names({**lines, "now": frame.upright(now[0])}, names, dots)


class ShareChart(LoneChart):
    """By how much ENOC lies above the optimum."""

    def __init__(self, height: int, x_range: Range1d, palette: Palette) -> None:
        super().__init__("share", "ENOC above the optimum, %", height, palette, x_range)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=3, x_title=TIME_TITLE)
        self.glyphs("varea", "share", "x", 0, "y", paint={"fill_color": "enoc"}, fill_alpha=0.10)
        self.line("share", "enoc", **style_of("enoc"))
        self.add_names()
        self.now = upright(f, self.palette)

    def draw(self, trade_off: TradeOff, run: Trajectory) -> None:
        """Draw the share over travel time."""
        time, enoc, optimal = enoc_curve(trade_off)
        if not len(time):
            self.clear()
            return
        share = 100 * share_above(enoc, optimal)
        drawn = time > trade_off.frontier.shortest_travel_time_s * (1 + STEEPEST_SHARE)
        self.y_range.update(start=0, end=float(np.ceil(np.max(share, where=drawn, initial=0.0) * 1.15 + 0.2)))
        self.put("share", **xy(time, share))
        now = run.travel_time_s
        # ENOC takes more time than the fastest run: before its first time there is nothing to tell
        if now < time[0]:
            self.clear("names")
        else:
            more = comparisons.above(best_enoc_kwh(trade_off, now), run.energy_kwh)
            here = float(np.interp(now, time, share))
            name = Name("now", f"{more} at {words.time(now)} s", self.palette.tokens["enoc"], point=(now, here))
            self.place_names({"enoc": (time, share)}, [name])
        self.now.location = now


def upright(f: figure, palette: Palette) -> Span:
    """Add the upright line of the present travel time to a figure, out of sight until it is drawn."""
    now = Span(location=-1, dimension="height", line_width=1)
    palette.paint(now, line_color="line2")
    f.add_layout(now)
    return now


# Bokeh's own contours: measured, they take 3 ms for a new map, HoloViews' 56 ms
class ContourChart(LoneChart):
    """ENOC's energy over travel time and acceleration time, as contours."""

    kind = "map"

    def __init__(self, height: int, palette: Palette) -> None:
        super().__init__("contour", "ENOC: energy, kWh, as contours", height, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=5, x_title=TIME_TITLE, y_title="Acceleration time, s")
        f.ygrid.visible = False
        self.contours: ContourRenderer | None = None
        self.drawn: EnocMap | None = None
        white = {"line_color": "#FFFFFF"}
        self.glyphs("line", "valley", "x", "y", paint={}, line_width=2, **white)
        self.source("printed", "x", "y", "energy")
        hollow = {"marker": "diamond", "fill_color": None, "line_width": 1.5}
        self.glyphs("scatter", "printed", "x", "y", paint={}, size=9, **hollow, **white)
        self.coloured_signs("signs", text_align="center", text_baseline="middle")
        self.glyphs("scatter", "point", "x", "y", paint={"fill_color": "accent"}, size=11, line_width=2, **white)

    def draw(self, trade_off: TradeOff, now: tuple[float, float, float] | None) -> None:
        """Draw contours, valley, the present point and the printed ones."""
        enoc_map = trade_off.enoc_map
        assert self.figure is not None
        if enoc_map is None:
            return
        time, ramp = enoc_map.travel_time_s, enoc_map.acceleration_time_s
        if self.drawn is not enoc_map:
            self._draw_map(enoc_map)
        self.set_ranges((float(time[0]), float(time[-1])), (float(ramp[0]), float(ramp[-1])))
        self.put("valley", **xy(time, enoc_map.best_acceleration_s))
        self.put("point", **points([now[:2]] if now else []))
        printed = printed_points(trade_off, everywhere=True)
        self.put("printed", **columns(x=printed[0], y=printed[1], energy=printed[2]))

    def _draw_map(self, enoc_map: EnocMap) -> None:
        """Draw the contours: with as many levels as before only their data change, which is far cheaper."""
        f = self.figure
        assert f is not None
        levels = contour_levels(enoc_map.energy_kwh)
        colours = [CIVIDIS[round(k * (len(CIVIDIS) - 1) / max(len(levels) - 2, 1))] for k in range(len(levels) - 1)]
        # contours leave holes where nothing is known: those are filled like the dearest energies
        filled = np.clip(np.nan_to_num(enoc_map.energy_kwh, nan=levels[-1]), levels[0], levels[-1] * (1 - 1e-9))
        given = enoc_map.travel_time_s, enoc_map.acceleration_time_s, filled, levels
        if self.contours is not None and len(self.contours.levels) == len(levels):
            self.contours.set_data(contour_data(*given))
        else:
            if self.contours is not None:
                f.renderers.remove(self.contours)
            self.contours = f.contour(*given, fill_color=colours, line_color="#FFFFFF", line_alpha=0.35, line_width=0.8)
            self.contours.level = "underlay"
        self._sign_levels(enoc_map, levels, colours)
        self.drawn = enoc_map

    def _sign_levels(self, enoc_map: EnocMap, levels: list[float], colours: list[str]) -> None:
        """Write each level on its line, in black or white, as high up as it is clear of the other levels."""
        time, ramp = enoc_map.travel_time_s, enoc_map.acceleration_time_s
        frame = self.frame_over((float(time[0]), float(time[-1])), (float(ramp[0]), float(ramp[-1])))
        signs: dict[str, list[Any]] = {"x": [], "y": [], "text": [], "colour": []}
        taken: list[Box] = []
        for k, level in enumerate(levels[1:-1], 1):
            text = f"{level:g}"
            place = next(
                (
                    (x, y, box)
                    for x, y in _crossings(enoc_map, level)
                    if clear_of(box := frame.box(x, y, text, 11, "center", -7.0), taken, frame)
                ),
                None,
            )
            if place is not None:
                x, y, box = place
                taken.append(box)
                for key, value in zip(signs, (x, y, text, ink_on(colours[k])), strict=True):
                    signs[key].append(value)
        self.put("signs", **signs)


def _crossings(enoc_map: EnocMap, level: float) -> Iterator[tuple[float, float]]:
    """Yield where the line of an energy crosses the rows of the map, from above."""
    time, ramp, rows = enoc_map.travel_time_s, enoc_map.acceleration_time_s, len(enoc_map.acceleration_time_s)
    for row in range(int(0.92 * (rows - 1)), int(0.1 * (rows - 1)), -1):
        energies = enoc_map.energy_kwh[row]
        crossing = np.flatnonzero(np.diff(np.sign(energies - level)))
        if len(crossing):
            yield float(time[crossing[-1]]), float(ramp[row])


def enoc_curve(trade_off: TradeOff) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the travel times that ENOC takes [s], its energies and the optimal ones [kWh]; empty without ENOC."""
    frontier, enoc = trade_off.frontier, trade_off.enoc
    if enoc is None:
        return np.zeros(0), np.zeros(0), np.zeros(0)
    taken = np.isfinite(enoc.energy_kwh)
    return enoc.travel_time_s[taken], enoc.energy_kwh[taken], frontier.energy_kwh[taken]


def best_enoc_kwh(trade_off: TradeOff, travel_time_s: float) -> float:
    """Return ENOC's energy with its best acceleration time [kWh]; the trade-off must have one."""
    coefficients = trade_off.coefficients
    assert coefficients is not None
    best = best_acceleration_time(coefficients, travel_time_s)
    return float(enoc_energy(coefficients, travel_time_s, best)) / J_PER_KWH


def printed_points(trade_off: TradeOff, everywhere: bool = False) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return travel times [s], acceleration times [s] and energies [kWh] that Ftorek prints for this scenario.

    Table 2, and Table 3 too if `everywhere`; nothing for any other vehicle, line or recuperation.
    """
    empty = np.zeros(0)
    scenario = trade_off.scenario
    as_in_paper = (
        scenario.vehicle.preset == "suburban-ftorek"
        and scenario.line.preset == "flat-5km"
        and scenario.vehicle.load_factor == 0
        and scenario.vehicle.drive.recuperation_factor == 1
    )
    if not as_in_paper:
        return empty, empty, empty
    paper = printed_numbers("ftorek-2025")
    rows = paper["table_2"] + (paper["table_3"] if everywhere else [])
    times, ramps, energies = (
        np.array([row[key] for row in rows], dtype=float)
        for key in ("travel_time_s", "acceleration_time_s", "total_energy_wh")
    )
    return times, ramps, energies / 1000


def contour_levels(energy_kwh: FloatArray) -> list[float]:
    """Return the multiples of a round step that most of the energies lie between, and ends beyond all of them."""
    low, high = (float(level) for level in np.nanquantile(energy_kwh, SIGNED))
    step = round_step((high - low) / MAX_LEVELS)
    inner = step * np.arange(np.ceil(low / step), np.floor(high / step) + 1)
    # the first and the last level only close the lowest and the highest band: they must lie beyond all energies
    return [0.0, *(round(float(level), 9) for level in inner if level > 0), float(np.nanmax(energy_kwh)) * 10 + 1]
