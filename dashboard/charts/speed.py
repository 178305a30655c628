"""Speed of all runs under the limits."""

from collections.abc import Mapping
from operator import methodcaller
from typing import Any

import numpy as np

from railjoule.core.motion.line_profile import neutral_stretches, section_borders
from railjoule.core.units import MS_PER_KMH
from railjoule.dashboard.charts.axis import xy
from railjoule.dashboard.charts.chart import Layer
from railjoule.dashboard.charts.names import Box, Frame, Name, text_width_px
from railjoule.dashboard.charts.quantities import SPEED, along
from railjoule.dashboard.charts.run_lines import NAMES, Curve
from railjoule.dashboard.charts.scene import ACTUAL, BORDERS, RunChart, RunScene, line_words
from railjoule.dashboard.charts.track import (
    NEUTRAL_LIFT_PX,
    NEUTRAL_SIGNS,
    PASS_LIFT_PX,
    PASSES,
    SIGN_PX,
    add_limits,
    add_neutral_sections,
    add_passing_points,
    as_steps,
    draw_limits,
    draw_neutral_sections,
    draw_passing_points,
    limits_of,
)
from railjoule.dashboard.look import words
from railjoule.dashboard.look.comparisons import OTHER_TIME_S

BRAKING, BRAKING_WORDS = "braking", "braking curve"
"""The source of the speed permitted by braking curves, and what it is called."""
# over the highest limit or speed: the sign of a limit stands above its line
HEADROOM = 1.16
SIGN_LIFTS_PX = {"signs": 2, "stops": 5, "late": 3, PASSES: PASS_LIFT_PX, NEUTRAL_SIGNS: NEUTRAL_LIFT_PX}
"""How far above its place each kind of sign is written."""


class SpeedChart(RunChart):
    """Speed of all runs under the limits."""

    quantity, with_fastest = SPEED, True
    look: Mapping[str, Any] = {"ticks": 5}
    below = (
        add_limits,
        methodcaller("line", BRAKING, "limit", line_width=1, line_dash=[4, 2]),
        add_neutral_sections,
        BORDERS,
    )
    above: tuple[Layer, ...] = (
        methodcaller("signs", "signs", "limit", SIGN_PX, x_offset=4, y_offset=-SIGN_LIFTS_PX["signs"]),
        # nothing draws it: the cursor reads it
        methodcaller("source", "gradient"),
        NAMES,
        methodcaller("source", "stops", "x", "y", "text"),
        methodcaller(*("glyphs", "scatter", "stops", "x", "y"), paint={"fill_color": ACTUAL}, size=7, line_color=None),
        methodcaller("hairlines", "stops", "ink3", line_dash=[1, 3]),
        methodcaller("signs", "stops", ACTUAL, x_offset=7, y_offset=-SIGN_LIFTS_PX["stops"]),
        add_passing_points,
        methodcaller("signs", "late", "overline", 12, x_offset=6, y_offset=-SIGN_LIFTS_PX["late"]),
    )
    _limits: Curve
    top: float
    _braking: Curve | None = None
    """Drawn limit: the permitted speed, which is below the limits only on a braking curve."""

    def _draw_day(self, scene: RunScene) -> None:
        """Draw the signs of the actual run; on a narrow screen its delay stands only in the numbers."""
        stops, actual = scene.stops, scene.actual
        self.put(
            "stops",
            **xy(np.array([x for x, _ in stops]), np.zeros(len(stops))),
            text=[f"stop, {words.number(lasts, 0)} s" for _, lasts in stops],
        )
        if actual is None or scene.narrow or actual.delay_s < OTHER_TIME_S:
            self.clear("late")
            return
        end = float(scene.x(actual.actual)[-1])
        self.put("late", x=[end], y=[0.0], text=[f"{words.time(actual.delay_s)} s late"])

    def draw(self, scene: RunScene) -> None:
        """Draw limits, runs and names."""
        self._draw_limits(scene)
        self._draw_braking_curve(scene)
        line = scene.run.scenario.line.in_running_order()
        draw_neutral_sections(self, line, scene.x_of_place, self.top)
        draw_passing_points(self, line, scene.x_of_place)
        lines = self.draw_runs(scene)
        self._tell_cursor(scene)
        self._draw_day(scene)
        self._draw_names(scene, lines)

    def alternative(self, scene: RunScene) -> str:
        """Return in words what it shows, for who cannot see it."""
        run, names = scene.run, ", ".join(words.STRATEGY_WORDS[name] for name in scene.runs)
        stretches = [
            f"{words.number(start, 0)} to {words.number(end, 0)} m"
            for start, end in neutral_stretches(run.scenario.line.in_running_order()).tolist()
        ]
        neutral = f" Without traction power: {', '.join(stretches)}." if stretches else ""
        return (
            f"Speed over distance of {names}; {words.STRATEGY_WORDS[scene.chosen]} reaches "
            f"{words.number(run.max_speed_kmh)} km/h and takes {words.number(run.travel_time_s)} s."
            f"{neutral} A table of the phases follows."
        )

    def _tell_cursor(self, scene: RunScene) -> None:
        """Let the cursor write when or where it stands, the limit, the gradient and the fastest run's speed too."""
        run, fastest, line = scene.run, scene.fastest, scene.run.scenario.line.in_running_order()
        other, x = along(not scene.over_time), along(scene.over_time)
        self.axis.columns(scene.chosen).take(run, {other.name: other.values(run)})
        gradients = np.array([section.gradient_permille for section in line.sections])
        self.put("gradient", **xy(*as_steps(scene.x_of_place(section_borders(line)), gradients)))
        self.cursor_data["sources"] += [
            self.read(scene.chosen, "", other.unit, other.digits, y=other.name),
            ["limit", self.sources["limit"], "x", "y", self.unit, 0],
            ["gradient", self.sources["gradient"], "x", "y", words.PER_MILLE, 1],
        ]
        if self._braking is not None:
            self.cursor_data["sources"].append([BRAKING_WORDS, self.sources[BRAKING], "x", "y", self.unit, 0])
        if fastest is not None and scene.chosen != "fastest":
            # its line may be hidden: it is not drawn before it is ticked
            self.axis.columns("fastest").take(fastest, {x.name: x.values(fastest), SPEED.name: self.values(fastest)})
            self.cursor_data["sources"].append(self.read("fastest", "fastest"))

    def _draw_limits(self, scene: RunScene) -> None:
        """Draw the limits, each with its number where there is room."""
        places, limits = limits_of(scene.run.scenario)
        x = scene.x_of_place(places)
        self.top = HEADROOM * max(float(np.max(limits)), *(run.max_speed_kmh for run in scene.named().values()))
        self.set_range(0, self.top)
        # other runs pass the places of the limits at other times, and keep them
        of_one = scene.over_time and len(scene.named()) > 1
        self._limits = draw_limits(self, x, limits, tinted=not of_one)
        of_run = f" for {line_words(scene.chosen, scene)}" if of_one else ""
        texts = [f"limit {words.number(limit, 0)}{of_run}" for limit in limits]
        room = np.diff(self.frame_now.x_px(x))
        fits = np.array([text_width_px(text, SIGN_PX) + 8 < px for text, px in zip(texts, room, strict=True)])
        self.put(
            "signs", **xy(x[:-1][fits], limits[fits]), text=[text for text, fit in zip(texts, fits, strict=True) if fit]
        )

    def _draw_braking_curve(self, scene: RunScene) -> None:
        """Draw the speed that the braking curves before limits and stops permit, where the vehicle has such a curve."""
        permitted = scene.run.permitted_speed_ms
        if permitted is None:
            self._braking = None
            self.clear(BRAKING)
            return
        self._braking = scene.x(scene.run), permitted / MS_PER_KMH
        self.put(BRAKING, **xy(*self._braking))

    def _draw_names(self, scene: RunScene, lines: Mapping[str, Curve]) -> None:
        """Name the lines where nothing else is, the chosen one first."""
        frame = self.frame_now
        taken = [box for source, lift_px in SIGN_LIFTS_PX.items() for box in self._sign_boxes(frame, source, lift_px)]
        # against the order of drawing: what lies on top is named first
        names = [Name(name, line_words(name, scene), self.name_colour(name)) for name in reversed(list(lines))]
        if self._braking is not None:
            names.append(Name(BRAKING, BRAKING_WORDS, self.palette.tokens["limit"]))
            lines = {**lines, BRAKING: last_descent(self._braking)}
        self.place_names({**lines, "limit": self._limits}, names, taken)

    def _sign_boxes(self, frame: Frame, source: str, lift_px: float) -> list[Box]:
        signs = self.sources[source].data
        return [
            frame.box(x, y, text, SIGN_PX, lift_px=lift_px)
            for x, y, text in zip(signs["x"], signs["y"], signs["text"], strict=True)
        ]


def last_descent(line: Curve) -> Curve:
    """Return the part of a line that falls up to its end; all of it where it does not fall there."""
    x, y = line
    # elsewhere a braking curve lies on the limits, and its name would name those
    rises = np.flatnonzero(np.diff(y) >= 0)
    first = int(rises[-1]) + 1 if len(rises) else 0
    return (x[first:], y[first:]) if first < len(x) - 1 else line
