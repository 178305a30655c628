"""The charts beneath the speed: phases, line, energy, difference, effort, current, power."""

import numpy as np
from bokeh.models import ColumnDataSource

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.views.charts import Axis, clear, columns, nice_range, text_style, xy
from railjoule.dashboard.views.line_names import Name
from railjoule.dashboard.views.scene import ACTUAL, PINNED, CellChart, RunChart, Scene, SceneChart, line_words

WORD_PX = 7.2
MOTOR_CURRENT = "Current of one motor, A"
END_WORDS = {PINNED: "pinned", "fastest": "fastest", "speed_limits": "set speeds"}
"""What stands at the end of a line, beside its number, where the whole name has no room."""


def end_words(name: str, scene: Scene) -> str:
    """Return what stands at the end of a line, beside its number."""
    short = None if scene.actual is not None and name == scene.chosen else END_WORDS.get(name)
    return short or line_words(name, scene)


class PhaseStrip(SceneChart):
    """The phases of the chosen run as a strip of numbered bands."""

    kind = "strip"
    title = "phases of the run"

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("phases", "", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(zoom=False)
        f.yaxis.major_label_text_alpha = 0
        f.ygrid.visible = False
        columns = ("left", "right", "middle", "text", "fill", "ink")
        self.sources["phases"] = ColumnDataSource({column: [] for column in columns})
        bands = f.quad("left", "right", 0.04, 0.96, source=self.sources["phases"], fill_color="fill", line_width=1.5)
        self.palette.paint(bands.glyph, line_color="surface")
        f.text(
            "middle",
            0.5,
            "text",
            text_color="ink",
            source=self.sources["phases"],
            text_align="center",
            text_baseline="middle",
            **text_style(11),
        )

    def draw(self, scene: Scene) -> None:
        """Draw the bands, each with as many words as fit."""
        phases, tokens = scene.run.phases, self.palette.tokens
        left = np.array([phase.start_s if scene.over_time else phase.start_m for phase in phases])
        right = np.array([phase.end_s if scene.over_time else phase.end_m for phase in phases])
        room = (right - left) / scene.end * scene.width_px
        texts = []
        for number, (told, pixels) in enumerate(zip(scene.run.advice, room, strict=True), 1):
            full = f"{number}  {words.PHASE_WORDS[told.action]}"
            if told.action == "hold" and told.to_kmh is not None:
                full = f"{full} {words.tenths(told.to_kmh)}"
            fitting = full if len(full) * WORD_PX < pixels else str(number)
            texts.append(fitting if pixels > 1.6 * WORD_PX else "")
        self.sources["phases"].data = {
            **columns(left=left, right=right, middle=0.5 * (left + right)),
            "text": texts,
            "fill": [tokens[phase.phase] for phase in phases],
            "ink": [tokens[f"on_{phase.phase}"] for phase in phases],
        }


class LineStrip(SceneChart):
    """The line: gradients over its height, curves hatched."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("line", f"Track: gradient, {words.PER_MILLE}, over height, m", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(with_axis=True, ticks=2)
        self.palette.paint(f.xaxis[0], axis_line_color="line2")
        f.xaxis.axis_label = "Distance, m"
        self.sources["height"] = ColumnDataSource({"x": [], "y": [], "base": []})
        ground = f.varea("x", "base", "y", source=self.sources["height"])
        self.palette.paint(ground.glyph, fill_color="ground")
        edge = f.line("x", "y", source=self.sources["height"], line_width=1.3)
        self.palette.paint(edge.glyph, line_color="groundline")
        self.sources["borders"] = ColumnDataSource({"x": []})
        borders = f.vspan("x", source=self.sources["borders"], line_width=1, line_dash=[1, 3])
        self.palette.paint(borders.glyph, line_color="line2")
        self.sources["curves"] = ColumnDataSource({"left": [], "right": [], "bottom": [], "top": []})
        curves = f.quad(
            "left", "right", "bottom", "top", source=self.sources["curves"], fill_color=None, hatch_pattern="/"
        )
        self.palette.paint(curves.glyph, line_color="groundline", hatch_color="groundline")
        self.sources["signs"] = ColumnDataSource({"x": [], "y": [], "text": []})
        signs = f.text("x", "y", "text", source=self.sources["signs"], text_align="center", **text_style(11))
        self.palette.paint(signs.glyph, text_color="ink2")

    def draw(self, scene: Scene) -> None:
        """Draw height above the start of the run, changes of gradient and the gradients that have room."""
        line = scene.run.scenario.line.in_running_order()
        gradients = np.array([section.gradient_permille for section in line.sections])
        borders, height = section_borders(line), height_profile(line)
        bottom, relief = float(height.min()), max(float(np.ptp(height)), 1.0)
        assert self.figure is not None
        self.figure.xaxis.axis_label = "Time, s" if scene.over_time else "Distance, m"
        places = np.union1d(np.linspace(0, borders[-1], 200), borders) if scene.over_time else borders
        x = scene.x_of_place(places)
        self.set_range(bottom - 0.08 * relief, bottom + 1.7 * relief)
        base = np.full(len(places), bottom - 0.08 * relief)
        self.sources["height"].data = columns(x=x, y=np.interp(places, borders, height), base=base)
        self.sources["borders"].data = columns(x=scene.x_of_place(borders[1:-1]))
        ends = scene.x_of_place(borders)
        radii = np.array([section.curve_radius_m for section in line.sections])
        self._draw_curves(ends[:-1][radii > 0], ends[1:][radii > 0], bottom, relief)
        texts = [words.signed(gradient, 0 if gradient == round(gradient) else 1) for gradient in gradients]
        room = np.diff(ends) / scene.end * scene.width_px
        texts = [curve_words(*told) for told in zip(texts, radii, room, strict=True)]
        fits = np.array([len(text) * WORD_PX + 6 < pixels for text, pixels in zip(texts, room, strict=True)])
        self.sources["signs"].data = {
            **xy((0.5 * (ends[1:] + ends[:-1]))[fits], np.full(int(fits.sum()), bottom + 1.22 * relief)),
            "text": [text for text, fit in zip(texts, fits, strict=True) if fit],
        }

    def _draw_curves(self, left: FloatArray, right: FloatArray, bottom: float, relief: float) -> None:
        """Draw a hatched band over each curve."""
        low, high = (np.full(len(left), bottom + share * relief) for share in (1.58, 1.68))
        self.sources["curves"].data = columns(left=left, right=right, bottom=low, top=high)


def curve_words(gradient: str, radius_m: float, room_px: float) -> str:
    """Return the words of a section: its gradient, and its curve where there is room for it."""
    full = f"{gradient}, curve {words.number(radius_m, 0)} m"
    return full if radius_m > 0 and len(full) * WORD_PX + 6 < room_px else gradient


class EnergyChart(RunChart):
    """Energy drawn so far."""

    unit, digits = "kWh", 2

    def __init__(self, height: int, axis: Axis, palette: Palette, lines: tuple[str, ...]) -> None:
        super().__init__("energy", "Energy drawn so far, kWh", height, axis, palette)
        self.lines = lines

    def build(self) -> None:
        """Make the figure."""
        self.make_sources()
        f = self.frame()
        self.sources["extra"] = ColumnDataSource({"x": [], "low": [], "high": []})
        extra = f.varea("x", "low", "high", source=self.sources["extra"])
        self.palette.paint(extra.glyph, fill_color="over")
        self.add_borders()
        self.add_lines()
        self.add_names("ends")

    def values(self, run: Trajectory) -> FloatArray:
        """Line energy so far [kWh]."""
        return run.line_energy_j / J_PER_KWH

    def draw(self, scene: Scene) -> None:
        """Draw the energies with their names at the ends."""
        named = {name: run for name, run in scene.named().items() if name != "fastest" or scene.chosen == "fastest"}
        values = {name: self.values(run) for name, run in named.items()}
        low, high = nice_range(min(v.min() for v in values.values()), max(v.max() for v in values.values()))
        self.set_range(low, high)
        self.draw_lines(scene)
        if "fastest" not in named:
            clear(self.sources["fastest"])
        self.draw_borders(scene)
        self._draw_extra(scene)
        if scene.narrow:
            clear(self.sources["ends"])
            return
        lines = {name: (scene.x(run), values[name]) for name, run in named.items()}
        names = [
            Name(name, f"{end_words(name, scene)} {words.energy(v[-1])}", self.name_colour(name), True)
            for name, v in reversed(values.items())
        ]
        if scene.actual is not None and scene.actual.causes:
            names.append(self._extra_name(scene, values))
        self.place_names(lines, names, source="ends")

    def _extra_name(self, scene: Scene, values: dict[str, FloatArray]) -> Name:
        """Return what the actual run costs beyond the plan, between the ends of both."""
        assert scene.actual is not None
        between = 0.5 * (float(values[ACTUAL][-1]) + float(values[scene.chosen][-1]))
        text = f"{words.energy_difference(scene.actual.extra_kwh)} kWh"
        end = float(scene.x(scene.actual.actual)[-1])
        return Name(ACTUAL, text, self.palette.tokens["overline"], point=(end, between))

    def _draw_extra(self, scene: Scene) -> None:
        """Tint what the actual run has taken more than the plan so far."""
        if scene.actual is None:
            clear(self.sources["extra"])
            return
        actual = scene.actual.actual
        x = np.union1d(scene.x(scene.run), scene.x(actual))
        planned, driven = (np.interp(x, scene.x(run), self.values(run)) for run in (scene.run, actual))
        self.sources["extra"].data = columns(x=x, low=planned, high=np.maximum(planned, driven))


class DifferenceChart(RunChart):
    """Energy so far against the pinned run."""

    unit, digits = "kWh", 2

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("difference", "Against the pinned run, kWh", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        self.sources["run"] = ColumnDataSource({"x": [], "y": []})
        f = self.frame(ticks=3, digits=1)
        self.add_zero()
        self.add_borders()
        area = f.varea("x", 0, "y", source=self.sources["run"], fill_alpha=0.13)
        self.palette.paint(area.glyph, fill_color="accent")
        line = f.line("x", "y", source=self.sources["run"], line_width=1.8)
        self.palette.paint(line.glyph, line_color="accent")
        self.add_names("ends")

    def draw(self, scene: Scene) -> None:
        """Draw the difference to the pinned run."""
        if scene.pinned is None:
            for source in self.sources.values():
                clear(source)
            return
        x = scene.x(scene.run)
        difference = (
            scene.run.line_energy_j - np.interp(x, scene.x(scene.pinned), scene.pinned.line_energy_j)
        ) / J_PER_KWH
        self.set_range(*nice_range(min(float(difference.min()), 0), max(float(difference.max()), 0), 0.15))
        self.sources["run"].data = xy(x, difference)
        self.told["sources"] = [["", self.sources["run"]]]
        self.draw_borders(scene)
        if scene.narrow:
            clear(self.sources["ends"])
            return
        last = float(difference[-1])
        text = f"{words.energy_difference(last)} kWh"
        name = Name("run", text, self.palette.tokens["accent"], at_end=True)
        self.place_names({"run": (x, difference)}, [name], source="ends")


class EffortChart(CellChart):
    """Tractive and braking effort."""

    unit, digits = "kN", 0

    def __init__(self, height: int, axis: Axis, palette: Palette, lines: tuple[str, ...]) -> None:
        super().__init__("effort", "Tractive (+) and braking (\u2212) effort, kN", height, axis, palette)
        self.lines = lines

    def build(self) -> None:
        """Make the figure, with the largest effort dotted."""
        super().build()
        assert self.figure is not None
        self.sources["largest"] = ColumnDataSource({"x": [], "y": []})
        line = self.figure.line("x", "y", source=self.sources["largest"], line_width=1, line_dash=[2, 3])
        self.palette.paint(line.glyph, line_color="ink3")

    def of_cells(self, run: Trajectory) -> FloatArray:
        """Effort [kN]."""
        return run.effort_n / 1e3

    def draw(self, scene: Scene) -> None:
        """Draw the efforts and the largest one."""
        super().draw(scene)
        largest = np.append(scene.run.largest_effort_n[:1], scene.run.largest_effort_n) / 1e3
        self.sources["largest"].data = xy(scene.x(scene.run), largest)
        self.set_range(min(self.y_range.start, -0.05 * largest.max()), max(self.y_range.end, 1.08 * largest.max()))


class CurrentChart(CellChart):
    """Current of one motor where the drive's model has one, else that of the line."""

    unit, digits = "A", 0

    def __init__(self, height: int, axis: Axis, palette: Palette, lines: tuple[str, ...]) -> None:
        super().__init__("current", MOTOR_CURRENT, height, axis, palette)
        self.lines, self.of_motor = lines, True

    @staticmethod
    def knows(run: Trajectory) -> bool:
        """Return whether a run has a current to draw."""
        return run.current_a is not None or run.line_current_a is not None

    def draw(self, scene: Scene) -> None:
        """Draw the currents, and say in the title which they are."""
        self.of_motor = scene.run.current_a is not None
        volts = scene.run.scenario.vehicle.line_voltage_v or 0.0
        self.rename(MOTOR_CURRENT if self.of_motor else f"Current from the supply, A, at {words.number(volts, 0)} V")
        super().draw(scene)

    def of_cells(self, run: Trajectory) -> FloatArray:
        """Return the current [A], zero where the model knows none."""
        current = run.current_a if self.of_motor else run.line_current_a
        return current if current is not None else np.zeros(len(run.line_power_w))


class PowerChart(CellChart):
    """Power at the line."""

    unit, digits = "MW", 2
    with_axis = True
    axis_digits = 1

    def __init__(self, height: int, axis: Axis, palette: Palette, lines: tuple[str, ...]) -> None:
        super().__init__("power", "Power from the supply, MW", height, axis, palette)
        self.lines = lines

    def of_cells(self, run: Trajectory) -> FloatArray:
        """Line power [MW]."""
        return run.line_power_w / 1e6

    def draw(self, scene: Scene) -> None:
        """Draw the powers and name the axis."""
        super().draw(scene)
        assert self.figure is not None
        self.figure.xaxis.axis_label = "Time, s" if scene.over_time else "Distance, m"
