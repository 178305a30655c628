"""The charts below the speed: phases, line, energy, difference, effort, current, power."""

from collections.abc import Mapping
from dataclasses import replace
from operator import methodcaller
from typing import Any

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray, midpoints
from railjoule.core.motion.line_profile import height_profile, largest_current_a, section_borders
from railjoule.core.motion.meshed_line import driven_adhesion_n
from railjoule.core.units import N_PER_KN, W_PER_KW
from railjoule.dashboard.charts.axis import columns, nice_range, xy
from railjoule.dashboard.charts.chart import Layer, axis_line, no_grid, zero_line
from railjoule.dashboard.charts.dress import text_style
from railjoule.dashboard.charts.names import Name
from railjoule.dashboard.charts.quantities import (
    EFFORT,
    ENERGY,
    LARGEST_EFFORT,
    MOTOR_CURRENT,
    POSITION,
    POWER,
    SUPPLY_CURRENT,
    along,
)
from railjoule.dashboard.charts.run_lines import Curve
from railjoule.dashboard.charts.scene import (
    ACTUAL,
    BORDERS,
    PINNED,
    RunChart,
    RunScene,
    SceneChart,
    draw_borders,
    line_words,
)
from railjoule.dashboard.look import words

WORD_PX = 7.2
"""How wide a letter is, a little more than the mean: assets/scripts/report.js uses the same value."""
GROUND, SIGNS, CURVES, TOP = 0.08, 1.22, (1.58, 1.68), 1.7
"""Heights in the strip of the line, in units of its relief above its lowest point (of the ground: below it). The relief
ends at 1, so that gradients stand above it, and curves above these at the upper edge."""
CENTRED: Mapping[str, Any] = {"text_align": "center", "text_baseline": "middle", **text_style(11)}
LEAST_KWH = 0.05
"""The axis of a difference of energies reaches at least so far."""
END_WORDS = {PINNED: "pinned", "fastest": "fastest", "speed_limits": "set speeds"}
"""Short name at the end of a line, beside its number, where the whole name has no room."""


def end_words(name: str, scene: RunScene) -> str:
    """Return the name at the end of a line, beside its number."""
    short = None if scene.actual is not None and name == scene.chosen else END_WORDS.get(name)
    return short or line_words(name, scene)


class PhaseStrip(SceneChart):
    """The phases of the chosen run as a strip of numbered bands."""

    called, kind, title = ("phases", ""), "strip", "phases of the run"
    look: Mapping[str, Any] = {"zoom": False}
    layers: tuple[Layer, ...] = (
        no_grid,
        # it has room for the numbers of an axis, as the charts around it
        lambda chart: chart.figure.yaxis[0].update(major_label_text_alpha=0),
        methodcaller("source", "phases", "left", "right", "middle", "text", "fill", "ink"),
        methodcaller(
            *("glyphs", "quad", "phases", "left", "right", 0.04, 0.96),
            paint={"line_color": "surface"},
            fill_color="fill",
            line_width=1.5,
        ),
        methodcaller(
            *("glyphs", "text", "phases", "middle", 0.5, "text"),
            paint={},
            text_color="ink",
            **CENTRED,
        ),
    )

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

    called = "line", f"Track: gradient, {words.PER_MILLE}, over height, m"
    look: Mapping[str, Any] = {"ticks": 2, "x_title": POSITION.words}
    layers: tuple[Layer, ...] = (
        axis_line,
        methodcaller("source", "height", "x", "y", "base"),
        methodcaller("glyphs", "varea", "height", "x", "base", "y", paint={"fill_color": "ground"}),
        methodcaller("line", "height", "groundline", line_width=1.3),
        methodcaller("hairlines", "borders", "line2", line_dash=[1, 3]),
        methodcaller(
            *("glyphs", "quad", "curves", "left", "right", "bottom", "top"),
            paint={"line_color": "groundline", "hatch_color": "groundline"},
            fill_color=None,
            hatch_pattern="/",
        ),
        methodcaller("signs", "signs", "ink2", text_align="center"),
    )

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
        texts = [words.tenths(gradient, words.signed) for gradient in gradients]
        room = np.diff(ends) / scene.end * scene.width_px
        texts = [curve_words(*one) for one in zip(texts, radii, room, strict=True)]
        fits = np.array([len(text) * WORD_PX + 6 < pixels for text, pixels in zip(texts, room, strict=True)])
        self.put(
            "signs",
            **xy((0.5 * (ends[1:] + ends[:-1]))[fits], np.full(int(fits.sum()), bottom + SIGNS * relief)),
            text=[text for text, fit in zip(texts, fits, strict=True) if fit],
        )

    def _draw_curves(self, left: FloatArray, right: FloatArray, bottom: float, relief: float) -> None:
        low, high = (np.full(len(left), bottom + share * relief) for share in CURVES)
        self.put("curves", **columns(left=left, right=right, bottom=low, top=high))


def curve_words(gradient: str, radius_m: float, room_px: float) -> str:
    """Return the words of a section: its gradient, and its curve where there is room for it."""
    full = f"{gradient}, curve {words.number(radius_m, 0)} m"
    return full if radius_m > 0 and len(full) * WORD_PX + 6 < room_px else gradient


class EnergyChart(RunChart):
    """Energy from the supply so far."""

    quantity = ENERGY
    # below all else what the actual run takes more
    below = (methodcaller("glyphs", "varea", "extra", "x", "low", "high", paint={"fill_color": "over"}), BORDERS)
    above = (methodcaller("add_names", "ends"),)

    def alternative(self, scene: RunScene) -> str:
        """Return in words what it shows, for who cannot see it."""
        energies = ((words.STRATEGY_WORDS[name], words.energy(run.energy_kwh)) for name, run in scene.runs.items())
        ends = ", ".join(f"{name} {energy}" for name, energy in energies)
        return f"Energy from the supply so far over distance; at the end, in kWh: {ends}."

    def draw(self, scene: RunScene) -> None:
        """Draw the energies with their names at the ends."""
        lines = self.draw_runs(scene)
        self.fit(lines)
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
        """Return the extra energy of the actual run over the plan, between the ends of both."""
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

    called, unit, digits = ("difference", "Against the pinned run, kWh"), "kWh", 2
    look: Mapping[str, Any] = {"ticks": 3, "digits": 2}
    layers = (
        zero_line,
        BORDERS,
        methodcaller("glyphs", "varea", "run", "x", 0, "y", paint={"fill_color": "accent"}, fill_alpha=0.13),
        methodcaller("line", "run", "accent", line_width=1.8),
        methodcaller("add_names", "ends"),
    )

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


IN_CELLS: Mapping[str, Any] = {"ticks": 3, "zero": True, "room": 0.08}
"""How a quantity is drawn that is constant in each cell."""


class EffortChart(RunChart):
    """Tractive and braking effort, with the largest one dotted and the adhesion of the driven axles dashed."""

    quantity, look, title = EFFORT, IN_CELLS, EFFORT.words
    above = (
        methodcaller("line", "largest", "ink3", line_width=1, line_dash=[2, 3]),
        methodcaller("line", "adhesion", "limit", line_width=1, line_dash=[6, 3]),
    )

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
        run = scene.run
        adhesion_n = driven_adhesion_n(run.scenario, run.position_m, run.speed_ms)
        if adhesion_n is None:
            self.rename(EFFORT.words)
            self.clear("adhesion")
            return
        conditions = " and ".join(sorted(filter(None, run.scenario.line.all_rail_conditions)))
        self.rename(f"{EFFORT.words}; dashed: adhesion on {conditions} rails")
        places, most = scene.x(run), adhesion_n / N_PER_KN
        # one line with a gap between its two sides
        self.put("adhesion", x=[*places, np.nan, *places], y=[*most, np.nan, *-most])


class SupplyChart(RunChart):
    """Current or power at the supply, with the x axis of all charts above it."""

    quantity, title = MOTOR_CURRENT, "Current or power from the supply"
    above = (methodcaller("line", "largest_current", "limit", line_width=1, line_dash=[6, 3]),)
    look: Mapping[str, Any] = {**IN_CELLS, "last": True}

    @staticmethod
    def has_current(run: Trajectory) -> bool:
        """Return whether a run has a current to draw."""
        return run.current_a is not None or run.supply_current_a is not None

    def draw(self, scene: RunScene) -> None:
        """Draw the power where it is chosen or no current is known, else the current; the title names it."""
        run, at = scene.run, ""
        if scene.with_power or not self.has_current(run):
            self.quantity = POWER
        elif run.current_a is not None:
            self.quantity = MOTOR_CURRENT
        else:
            self.quantity, at = SUPPLY_CURRENT, f", at {words.number(run.scenario.vehicle.line_voltage_v or 0.0, 0)} V"
        # all are drawn from one column
        self.quantity = replace(self.quantity, name=self.plot.quantity.name)
        self.unit, self.digits = self.quantity.unit, self.quantity.digits
        self.cursor_data.update(unit=self.unit, digits=self.digits)
        assert self.figure is not None
        self.figure.yaxis[0].formatter.args = {"digits": 1 if self.quantity.unit == POWER.unit else 0}
        self.rename(f"{self.quantity.words}{at}")
        super().draw(scene)
        self._draw_largest_current(scene)

    def _draw_largest_current(self, scene: RunScene) -> None:
        """Draw the largest current from the supply where the line limits it, as a power in a chart of power."""
        run, line = scene.run, scene.run.scenario.line.in_running_order()
        if self.quantity.unit == MOTOR_CURRENT.unit and run.current_a is not None:
            # the limit is none of a motor
            self.clear("largest_current")
            return
        # between a cell's ends it is constant: each end twice, and a gap where there is no limit
        largest = np.repeat(largest_current_a(line, midpoints(run.position_m)), 2)
        if not np.isfinite(largest).any():
            self.clear("largest_current")
            return
        largest = np.where(np.isfinite(largest), largest, np.nan)
        if self.quantity.unit == POWER.unit:
            largest = largest * (run.scenario.vehicle.line_voltage_v or np.nan) / W_PER_KW
        self.put("largest_current", **xy(np.repeat(scene.x(run), 2)[1:-1], largest))
        self.rename(f"{self.caption}; dashed: limit of the line")


class CurrentChart(SupplyChart):
    """Current of one motor where the drive's model has one, else that of the supply, above other charts."""

    look, title = IN_CELLS, "Current"


class PowerChart(RunChart):
    """Power from the supply, with the x axis of all charts above it."""

    quantity = POWER
    look: Mapping[str, Any] = {**IN_CELLS, "last": True, "digits": 1}
