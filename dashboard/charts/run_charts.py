"""The charts beneath the speed: phases, line, energy, difference, effort, current, power."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.motion.line_profile import height_profile, section_borders
from railjoule.core.physics.adhesion import driven_adhesion_n
from railjoule.core.units import N_PER_KN
from railjoule.dashboard.charts.chart import Axis, add_zero, columns, nice_range, text_style, xy
from railjoule.dashboard.charts.line_names import Name
from railjoule.dashboard.charts.quantities import (
    EFFORT,
    ENERGY,
    LARGEST_EFFORT,
    MOTOR_CURRENT,
    POWER,
    SUPPLY_CURRENT,
    along,
)
from railjoule.dashboard.charts.run_lines import Curve, ends_of
from railjoule.dashboard.charts.scene import (
    ACTUAL,
    PINNED,
    CellChart,
    RunChart,
    RunScene,
    SceneChart,
    draw_borders,
    line_words,
)
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette

WORD_PX = 7.2
"""How wide a letter is, a little more than the mean: assets/scripts/report.js reckons with the same."""
GROUND, SIGNS, CURVES, TOP = 0.08, 1.22, (1.58, 1.68), 1.7
"""Heights in the strip of the line, in units of its relief above its lowest point (of the ground: below it). The relief
ends at 1, so that gradients stand above it, and curves above these at the upper edge."""
LEAST_KWH = 0.05
"""The axis of a difference of energies reaches at least so far."""
END_WORDS = {PINNED: "pinned", "fastest": "fastest", "speed_limits": "set speeds"}
"""What stands at the end of a line, beside its number, where the whole name has no room."""


def end_words(name: str, scene: RunScene) -> str:
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
        self.source("phases", "left", "right", "middle", "text", "fill", "ink")
        band = {"line_color": "surface"}
        self.glyphs("quad", "phases", "left", "right", 0.04, 0.96, paint=band, fill_color="fill", line_width=1.5)
        centred = {"text_align": "center", "text_baseline": "middle", **text_style(11)}
        self.glyphs("text", "phases", "middle", 0.5, "text", paint={}, text_color="ink", **centred)

    def alternative(self, scene: RunScene) -> str:
        """Return in words what it shows, for who cannot see it."""
        return "Phases: " + ", ".join(words.advice_in_words(scene.run.advice))

    def draw(self, scene: RunScene) -> None:
        """Draw the bands, each with as many words as fit."""
        phases, advice, tokens = scene.run.phases, scene.run.advice, self.palette.tokens
        groups = words.instruction_groups(advice)
        firsts, lasts = ([phases[group[end]] for group in groups] for end in (0, -1))
        left = np.array([phase.start_s if scene.over_time else phase.start_m for phase in firsts])
        right = np.array([phase.end_s if scene.over_time else phase.end_m for phase in lasts])
        room = (right - left) / scene.end * scene.width_px
        texts = []
        for number, (group, pixels) in enumerate(zip(groups, room, strict=True), 1):
            instruction = advice[group[0]]
            full = f"{number}  {words.PHASE_WORDS[instruction.action]}"
            if instruction.action == "hold" and instruction.to_kmh is not None:
                full = f"{full} {words.tenths(instruction.to_kmh)}"
            fitting = full if len(full) * WORD_PX < pixels else str(number)
            texts.append(fitting if pixels > 1.6 * WORD_PX else "")
        self.put(
            "phases",
            **columns(left=left, right=right, middle=0.5 * (left + right)),
            text=texts,
            fill=[tokens[phase.phase] for phase in firsts],
            ink=[tokens[f"on_{phase.phase}"] for phase in firsts],
        )


class LineStrip(SceneChart):
    """The line: gradients over its height, curves hatched."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("line", f"Track: gradient, {words.PER_MILLE}, over height, m", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(with_axis=True, ticks=2)
        self.palette.paint(f.xaxis[0], axis_line_color="line2")
        f.xaxis.axis_label = along(False).words
        self.source("height", "x", "y", "base")
        self.glyphs("varea", "height", "x", "base", "y", paint={"fill_color": "ground"})
        self.line("height", "groundline", line_width=1.3)
        self.hairlines("borders", "line2", line_dash=[1, 3])
        hatched = {"line_color": "groundline", "hatch_color": "groundline"}
        sides = ("left", "right", "bottom", "top")
        self.glyphs("quad", "curves", *sides, paint=hatched, fill_color=None, hatch_pattern="/")
        self.signs("signs", "ink2", text_align="center")

    def alternative(self, scene: RunScene) -> str:
        """Return in words what it shows, for who cannot see it."""
        return "Gradient and height of the track; a table of the sections follows."

    def draw(self, scene: RunScene) -> None:
        """Draw height above the start of the run, changes of gradient and the gradients that have room."""
        line = scene.run.scenario.line.in_running_order()
        gradients = np.array([section.gradient_permille for section in line.sections])
        borders, height = section_borders(line), height_profile(line)
        # on level track, a metre counts as the relief
        bottom, relief = float(height.min()), max(float(np.ptp(height)), 1.0)
        assert self.figure is not None
        self.figure.xaxis.axis_label = along(scene.over_time).words
        # over time, a straight slope is curved
        places = np.union1d(np.linspace(0, borders[-1], 200), borders) if scene.over_time else borders
        x = scene.x_of_place(places)
        self.set_range(bottom - GROUND * relief, bottom + TOP * relief)
        base = np.full(len(places), bottom - GROUND * relief)
        self.put("height", **columns(x=x, y=np.interp(places, borders, height), base=base))
        self.put("borders", **columns(x=scene.x_of_place(borders[1:-1])))
        ends = scene.x_of_place(borders)
        radii = np.array([section.curve_radius_m for section in line.sections])
        self._draw_curves(ends[:-1][radii > 0], ends[1:][radii > 0], bottom, relief)
        texts = [words.signed(gradient, 0 if gradient == round(gradient) else 1) for gradient in gradients]
        room = np.diff(ends) / scene.end * scene.width_px
        texts = [curve_words(*told) for told in zip(texts, radii, room, strict=True)]
        fits = np.array([len(text) * WORD_PX + 6 < pixels for text, pixels in zip(texts, room, strict=True)])
        self.put(
            "signs",
            **xy((0.5 * (ends[1:] + ends[:-1]))[fits], np.full(int(fits.sum()), bottom + SIGNS * relief)),
            text=[text for text, fit in zip(texts, fits, strict=True) if fit],
        )

    def _draw_curves(self, left: FloatArray, right: FloatArray, bottom: float, relief: float) -> None:
        """Draw a hatched band over each curve."""
        low, high = (np.full(len(left), bottom + share * relief) for share in CURVES)
        self.put("curves", **columns(left=left, right=right, bottom=low, top=high))


def curve_words(gradient: str, radius_m: float, room_px: float) -> str:
    """Return the words of a section: its gradient, and its curve where there is room for it."""
    full = f"{gradient}, curve {words.number(radius_m, 0)} m"
    return full if radius_m > 0 and len(full) * WORD_PX + 6 < room_px else gradient


class EnergyChart(RunChart):
    """Energy from the supply so far."""

    names_in = "ends"

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__(ENERGY, height, axis, palette)

    def beneath(self) -> None:
        """Draw what the actual run takes more beneath all else."""
        self.glyphs("varea", "extra", "x", "low", "high", paint={"fill_color": "over"})
        super().beneath()

    def above(self) -> None:
        """Write the names of the lines."""
        self.add_names("ends")

    def alternative(self, scene: RunScene) -> str:
        """Return in words what it shows, for who cannot see it."""
        energies = ((words.STRATEGY_WORDS[name], words.energy(run.energy_kwh)) for name, run in scene.runs.items())
        ends = ", ".join(f"{name} {energy}" for name, energy in energies)
        return f"Energy from the supply so far over distance; at the end, in kWh: {ends}."

    def draw(self, scene: RunScene) -> None:
        """Draw the energies with their names at the ends."""
        lines = self.draw_runs(scene)
        self.set_range(*nice_range(*ends_of(lines.values()), self.form.room))
        self._draw_extra(scene)
        if scene.narrow:
            self.clear("ends")
            return
        names = [
            Name(name, f"{end_words(name, scene)} {words.energy(energies[-1])}", self.name_colour(name), True)
            # against the order of drawing: the chosen run's name has the first choice of a place
            for name, (_, energies) in reversed(lines.items())
        ]
        if scene.actual is not None and scene.actual.causes:
            names.append(self._extra_name(scene, lines))
        self.place_names(lines, names, source="ends")

    def _extra_name(self, scene: RunScene, lines: Mapping[str, Curve]) -> Name:
        """Return what the actual run costs beyond the plan, between the ends of both."""
        assert scene.actual is not None
        (x, driven), (_, planned) = lines[ACTUAL], lines[scene.chosen]
        between = 0.5 * (float(driven[-1]) + float(planned[-1]))
        text = f"{words.energy_difference(scene.actual.extra_kwh)} kWh"
        return Name(ACTUAL, text, self.palette.tokens["overline"], point=(float(x[-1]), between))

    def _draw_extra(self, scene: RunScene) -> None:
        """Tint what the actual run has taken more than the plan so far."""
        if scene.actual is None:
            self.clear("extra")
            return
        actual = scene.actual.actual
        x = np.union1d(scene.x(scene.run), scene.x(actual))
        planned, driven = (np.interp(x, scene.x(run), self.values(run)) for run in (scene.run, actual))
        # where the actual run has taken less so far, the tint has no height
        self.put("extra", **columns(x=x, low=planned, high=np.maximum(planned, driven)))


class DifferenceChart(SceneChart):
    """Energy so far against the pinned run."""

    unit, digits = "kWh", 2

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__("difference", "Against the pinned run, kWh", height, axis, palette)

    def build(self) -> None:
        """Make the figure."""
        f = self.frame(ticks=3, digits=2)
        add_zero(f, self.palette)
        self.hairlines("borders", "line2", line_alpha=0.55, level="underlay")
        self.glyphs("varea", "run", "x", 0, "y", paint={"fill_color": "accent"}, fill_alpha=0.13)
        self.line("run", "accent", line_width=1.8)
        self.add_names("ends")

    def draw(self, scene: RunScene) -> None:
        """Draw the difference to the pinned run."""
        if scene.pinned is None:
            self.clear()
            return
        x, pinned = scene.x(scene.run), scene.pinned
        difference = ENERGY.values(scene.run) - np.interp(x, scene.x(pinned), ENERGY.values(pinned))
        # where nothing differs, the axis must have numbers that differ
        self.set_range(*nice_range(min(float(difference.min()), 0), max(float(difference.max()), LEAST_KWH), 0.15))
        self.put("run", **xy(x, difference))
        self.follow_line("run")
        draw_borders(self, scene)
        if scene.narrow:
            self.clear("ends")
            return
        text = f"{words.energy_difference(float(difference[-1]))} kWh"
        name = Name("run", text, self.palette.tokens["accent"], at_end=True)
        self.place_names({"run": (x, difference)}, [name], source="ends")


class EffortChart(CellChart):
    """Tractive and braking effort, with the largest one dotted and the adhesion of the driven axles dashed."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__(EFFORT, height, axis, palette)

    def above(self) -> None:
        """Draw the largest effort and the adhesion."""
        self.line("largest", "ink3", line_width=1, line_dash=[2, 3])
        self.line("adhesion", "limit", line_width=1, line_dash=[6, 3])

    def draw(self, scene: RunScene) -> None:
        """Draw the efforts, the largest one and, where the rail condition is known, the adhesion."""
        super().draw(scene)
        # after the runs, whose range is only widened here
        largest = LARGEST_EFFORT.values(scene.run)
        self.put("largest", **xy(scene.x(scene.run), largest))
        # the adhesion does not widen the range: on dry rails it may lie far above all efforts
        self.set_range(min(self.y_range.start, -0.05 * largest.max()), max(self.y_range.end, 1.08 * largest.max()))
        self._draw_adhesion(scene)

    def _draw_adhesion(self, scene: RunScene) -> None:
        run, condition = scene.run, scene.run.scenario.line.rail_condition
        if condition is None:
            self.rename(EFFORT.words)
            self.clear("adhesion")
            return
        self.rename(f"{EFFORT.words}; dashed: adhesion on {condition} rails")
        places, most = scene.x(run), driven_adhesion_n(run.scenario, run.speed_ms) / N_PER_KN
        # one line with a gap between its two sides
        self.put("adhesion", x=[*places, np.nan, *places], y=[*most, np.nan, *-most])


class CurrentChart(CellChart):
    """Current of one motor where the drive's model has one, else that of the line."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        super().__init__(MOTOR_CURRENT, height, axis, palette)

    @staticmethod
    def knows(run: Trajectory) -> bool:
        """Return whether a run has a current to draw."""
        return run.current_a is not None or run.supply_current_a is not None

    def draw(self, scene: RunScene) -> None:
        """Draw the currents, and say in the title which they are."""
        # before the lines are filled, which are of this quantity
        if scene.run.current_a is not None:
            self.quantity, at = MOTOR_CURRENT, ""
        else:
            volts = scene.run.scenario.vehicle.line_voltage_v or 0.0
            self.quantity, at = SUPPLY_CURRENT, f", at {words.number(volts, 0)} V"
        self.rename(f"{self.quantity.words}{at}")
        super().draw(scene)


class SupplyChart(CurrentChart):
    """Current or power at the supply, with the x axis of all charts above it."""

    def __init__(self, height: int, axis: Axis, palette: Palette) -> None:
        # the columns of the current, whichever is drawn
        CellChart.__init__(self, MOTOR_CURRENT, height, axis, palette, last=True)

    def draw(self, scene: RunScene) -> None:
        """Draw the power where it is chosen or no current is known, else the current."""
        power = scene.with_power or not self.knows(scene.run)
        assert self.figure is not None
        self.figure.yaxis[0].formatter.args = {"digits": 1 if power else 0}
        shown = replace(POWER, name=MOTOR_CURRENT.name)
        self.unit, self.digits = (shown.unit, shown.digits) if power else (MOTOR_CURRENT.unit, MOTOR_CURRENT.digits)
        self.told.update(unit=self.unit, digits=self.digits)
        if not power:
            super().draw(scene)
            return
        self.quantity = shown
        self.rename(shown.words)
        CellChart.draw(self, scene)


def power_chart(height: int, axis: Axis, palette: Palette) -> CellChart:
    """Return the chart of power at the supply, with the x axis of all charts above it."""
    return CellChart(POWER, height, axis, palette, last=True, digits=1)
