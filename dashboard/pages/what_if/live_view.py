"""The part of the page that plays a run: its chart, its controls, its numbers, and how it ended."""

from collections.abc import Callable, Mapping
from functools import partial
from operator import methodcaller
from typing import Any

import numpy as np
import panel as pn

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.leg import Leg
from railjoule.core.simulation.live import LiveEvent, LiveRun
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.charts.axis import xy
from railjoule.dashboard.charts.figures import DistanceChart
from railjoule.dashboard.charts.names import Name
from railjoule.dashboard.charts.plot import AxisPlot
from railjoule.dashboard.charts.quantities import SPEED
from railjoule.dashboard.charts.run_lines import DRIVEN_DASH, NAMES, Curve, Line
from railjoule.dashboard.charts.track import add_limits, add_stations, draw_limits, draw_stations, limits_of
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.theme import padded
from railjoule.dashboard.look.typed import clock
from railjoule.dashboard.pages.what_if.live import PACES, Live, LiveResult
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import box, button, buttons
from railjoule.dashboard.parts.number_field import NumberField

LINES = {
    "former plan": Line("pinned", {"line_width": 1.8, "line_dash": [2, 3]}),
    "plan ahead": Line("accent", {"line_width": 2.2, "line_dash": DRIVEN_DASH}),
    "driven": Line("driven", {"line_width": 2.4}),
}
"""Colour and stroke of the lines, in the order of drawing."""
HEADROOM = 1.2
"""The upper end of the axis over the highest speed."""
LIMIT_ROOM = 1.1
"""The same over the highest limit: the signs of the signals stand between."""
# a cell of a coarse plan is drawn in as many pieces as it is seen to be curved
DRAWN_POINTS = 400


class LiveSpeedChart(DistanceChart):
    """Speed over distance while a run plays; a press sets a red signal."""

    unit, digits = SPEED.unit, SPEED.digits
    look: Mapping[str, Any] = {"ticks": 5, "x_title": "Distance, m"}
    layers = (
        add_limits,
        add_stations,
        methodcaller("hairlines", "signals", "limit", line_width=1.4),
        *(methodcaller("line", name, line.token, **line.stroke) for name, line in LINES.items()),
        methodcaller("dots", "train", "surface", "driven", size=11, line_width=3),
        methodcaller("signs", "signs", "limit", x_offset=4, text_baseline="top"),
        NAMES,
        methodcaller("take_presses"),
        methodcaller("set_cursor_sources", *LINES),
    )
    _plan: Leg | None = None
    _drawn_m = 0.0

    def draw(self, run: LiveRun) -> None:
        """Draw a run with its plan."""
        driven = [_curve(leg) for leg in (*run.driven, run.plan.until(run.position_m))]
        curves = {
            "former plan": _curve(run.former) if run.former is not None else (np.empty(0), np.empty(0)),
            "plan ahead": _curve(run.plan),
            "driven": (np.concatenate([x for x, _ in driven]), np.concatenate([y for _, y in driven])),
        }
        for name, (x, y) in curves.items():
            # as lists: `stream` adds to them
            self.put(name, x=x.tolist(), y=y.tolist())
        borders, limits = limits_of(run.since.scenario)
        limit = draw_limits(self, borders, limits)
        draw_stations(self, [station.position_m for station in run.scenario.line.inner_stations])
        speeds = [float(y.max()) for _, y in curves.values() if len(y)]
        speeds.append(run.planned.max_speed_kmh)
        top = max(HEADROOM * max(speeds), LIMIT_ROOM * float(limits.max()))
        self.set_range(0, top)
        signals = [one for one in run.events if one.is_ahead and not run.has_left(one)]
        places = [float(one.event.position_m) for one in signals]  # type: ignore[attr-defined]
        self.put("signals", x=places)
        self.put("signs", x=places, y=[0.99 * top] * len(places), text=[_sign(one) for one in signals])
        self._plan, self._drawn_m = run.plan, run.position_m
        self._draw_train(run)
        shown = {name: curve for name, curve in curves.items() if len(curve[0]) > 1}
        # the line of the former plan is too pale for text
        tokens = {name: line.token for name, line in LINES.items()} | {"former plan": "ink3"}
        names = [Name(name, name, self.palette.tokens[tokens[name]]) for name in reversed(shown)]
        taken = [self.frame_now.box(x, 0.99 * top, "red 000 s", lift_px=-15) for x in places]
        self.place_names({**shown, "limit": limit}, names, taken)

    def move(self, run: LiveRun) -> None:
        """Move the train on, over the plan that is drawn."""
        if self.figure is None or run.plan is not self._plan:
            return
        now = run.position_m
        between = (run.plan.position_m > self._drawn_m) & (run.plan.position_m < now)
        x = np.append(run.plan.position_m[between], now)
        y = np.sqrt(np.interp(x, run.plan.position_m, run.plan.speed2)) / MS_PER_KMH
        if now > self._drawn_m:
            self.sources["driven"].stream({"x": x.tolist(), "y": y.tolist()})
        self._drawn_m = now
        self._draw_train(run)

    def _draw_train(self, run: LiveRun) -> None:
        self.put("train", **xy(np.array([run.position_m]), np.array([run.speed_ms / MS_PER_KMH])))


PLAYED = AxisPlot("live_speed", partial(LiveSpeedChart, "live_speed", SPEED.words), (300, 380, 240), "live")


def _curve(leg: Leg) -> Curve:
    """Return places [m] and speeds [km/h] of a leg, fine enough for the root of a straight line."""
    first, last = float(leg.position_m[0]), float(leg.position_m[-1])
    places: FloatArray = np.union1d(leg.position_m, np.linspace(first, last, DRAWN_POINTS))
    return places, np.sqrt(np.interp(places, leg.position_m, leg.speed2)) / MS_PER_KMH


def _sign(signal: LiveEvent) -> str:
    """Return the sign of a red signal."""
    return "red" if signal.is_open else f"red {words.number(signal.event.duration_s, 0)} s"  # type: ignore[attr-defined]


# ---- controls, numbers, texts

UNLIKE_S = 0.1
"""Energies of arrivals that differ by this do not compare [s]."""
BODY_CSS = padded("4px 20px 12px 14px", "4px 10px 12px 6px")
FIELDS_CSS = """
:host { display: grid; grid-template-columns: repeat(auto-fill, minmax(172px, 1fr)); align-items: end; }
"""
SMALL: dict[str, Any] = {"height": 28, "margin": (8, 4, 0, 4)}
HOW = (
    "Press Play, then set a signal, a limit or a voltage while the train drives: the plan ahead is computed again from "
    "where the train is. A click on the chart sets a red signal there."
)
STANDS_IN = "{} over cells of {} m, as {} is too slow for that or refuses the line"
FASTEST = "as fast as permitted, as the time is too short"
UNLIKE = (
    "Energies of different arrivals do not compare. Set an accepted delay in the sidebar and play again, so that both "
    "arrive at the same time."
)


class LivePart:
    """The view of a run that plays."""

    def __init__(self, model: Live, host: Any, keep: Callable[..., None]) -> None:
        self.model, self.axis, self.chart = model, host.axes[PLAYED.axis], host.plots[PLAYED.name]
        self.chart.press = self._press
        self.numbers, self.message, self.status, self.table = (parts.html_pane() for _ in range(4))
        self.play = button("Play", self._play, **{**SMALL, "variant": "contained"})
        self.keep = button("Keep these events", keep, **SMALL)
        tools = pn.Row(
            self.play,
            buttons(model, "pace", {f"{pace:g}\u00d7": pace for pace in PACES}, margin=(8, 8, 0, 8)),
            button("Start again", model.restart, **SMALL),
            self.keep,
            margin=(0, 0, 0, 12),
            stylesheets=[parts.WRAP_CSS],
        )
        body = parts.stack(self.status, self.chart.host, self._fields(), self.table, css=BODY_CSS)
        self.view = parts.stack(self.numbers, tools, self.message, body)
        # not a part of the page: a tenth of a second is too short to settle all charts
        model.param.watch(self.move, "run")
        host.browser.follow(["hidden"], lambda: host.browser.hidden and model.param.update(playing=False))

    def _fields(self) -> pn.Column:
        model, signal, limit = self.model, self.model.signal, self.model.limit
        self.clear = button("Clear signal", model.clear, **SMALL)
        set_signal, set_limit, set_voltage = (
            button(label, partial(model.set, event), **SMALL)
            for label, event in {"Set red signal": signal, "Set limit": limit, "Set voltage": model.voltage}.items()
        )
        rows = (
            (
                NumberField(signal, "position_m", label="Signal at, m"),
                NumberField(signal, "duration_s", label="red for, s", of="Signal "),
                box(model, "is_open", "until cleared", margin=(0, 12)),
                pn.Row(set_signal, self.clear, margin=0, stylesheets=[parts.WRAP_CSS]),
            ),
            (
                NumberField(limit, "position_m", label="Limit from, m"),
                NumberField(limit, "to_m", of="Limit "),
                NumberField(limit, "limit_kmh", of="Limit "),
                set_limit,
            ),
            (NumberField(model.voltage, "share_percent", label="Voltage, %"), set_voltage),
        )
        return parts.stack(*(parts.stack(*row, css=FIELDS_CSS) for row in rows))

    def _play(self, _: Any) -> None:
        run = self.model.run
        if run is not None and run.has_arrived:
            self.model.restart()
        else:
            self.model.playing = run is not None and not self.model.playing

    def _press(self, place_m: float) -> None:
        self.model.signal.position_m = float(round(place_m))
        self.model.set(self.model.signal)

    def show_plan(self) -> None:
        """Draw the run with the plan that it has now."""
        run = self.model.run
        sentences = [HOW] if run is None or run.former is None else _status(run, self.model.replan_s)
        self.status.object = parts.markup('<div role="status">{}</div>', parts.note_paragraphs(sentences))
        self.show_controls()
        if run is None:
            self.numbers.object = ""
            self.chart.wait("")
            return
        self.axis.fit(float(run.planned.position_m[-1]), roomy=False)
        self.chart.show(partial(self._draw, run))
        self.show_numbers()

    def _draw(self, _: LiveRun) -> None:
        # a chart that waited draws the run as it is by then
        if self.model.run is not None:
            self.chart.draw(self.model.run)

    def move(self, *_: Any) -> None:
        """Move the train and its numbers on."""
        if self.model.run is not None:
            self.chart.move(self.model.run)
            self.show_numbers()

    def show_numbers(self) -> None:
        """Show position and energy of the train."""
        run = self.model.run
        assert run is not None
        late = run.delay_s
        verdict = "late" if late >= 0.05 else "early" if late <= -0.05 else "on time"
        whole_m = words.number(run.planned.distance_m, 0)
        cells = [
            parts.figure("Clock", clock(run.time_s), "", f"of {clock(run.scenario.travel_time_s)}", "main", term=""),
            parts.figure("Position", words.number(run.position_m, 0), "m", f"of {whole_m}", term=""),
            parts.figure("Speed", words.number(run.speed_ms / MS_PER_KMH), "km/h", _doing(run), term=""),
            parts.figure("Arrives", clock(run.arrival_s), "", f"{words.delay(late)} s, {verdict}", term="Delay"),
            parts.figure("Energy so far", words.energy(run.energy_j / J_PER_KWH), "kWh", "", term=""),
            parts.figure("To come", words.energy(run.remaining_j / J_PER_KWH), "kWh", "by the plan ahead", term=""),
        ]
        self.numbers.object = parts.figures(cells, role="timer")

    def show_controls(self) -> None:
        """Enable the possible buttons, and show why the last press was refused."""
        run, model = self.model.run, self.model
        failure = model.failure
        self.message.visible = failure is not None
        if failure is not None:
            self.message.object = parts.refusal(str(failure))
        self.play.label = "Pause" if model.playing else "Play again" if run is not None and run.has_arrived else "Play"
        self.keep.disabled = run is None or not run.events
        self.clear.disabled = run is None or not any(one.is_ahead and not run.has_left(one) for one in run.events)

    def show_result(self) -> None:
        """Show the result of the run beside its plan and the run with advance notice."""
        self.table.object = "" if self.model.ended is None else _table(self.model.ended)


def _doing(run: LiveRun) -> str:
    if run.has_arrived:
        return "arrived"
    if run.speed_ms > 0:
        return ""
    return f"stands for {words.time(run.dwell_left_s)} s" if run.dwell_left_s > 0 else "stands"


def _status(run: LiveRun, replan_s: float) -> list[str]:
    """Return the origin of the plan ahead, and the requirements that it misses."""
    made = words.STRATEGY_WORDS[run.strategy]
    if run.strategy == "fastest":
        made = FASTEST
    elif run.strategy != run.scenario.strategy:
        cells = words.number(run.plan.scenario.solver.mesh_m, 0)
        made = STANDS_IN.format(made, cells, words.STRATEGY_WORDS[run.scenario.strategy])
    return [
        f"At {words.number(run.since.position_m, 0)} m: planned again in {1000 * replan_s:.0f} ms, {made}.",
        *run.notes,
    ]


def _table(result: LiveResult) -> str:
    """Return the energies and arrivals of the plan, the run that played, and the one with advance notice."""
    planned = result.live.planned
    runs = {"Played": result.live, words.REACTION_WORDS["known"]: result.known}
    rows = [(ride_row(name, planned, ride), name == "Played") for name, ride in {"Undisturbed": None, **runs}.items()]
    table = parts.table("How it ended", ("Run", "kWh", "more, %", "late, s"), rows)
    is_unlike = abs(result.live.delay_s - result.known.delay_s) >= UNLIKE_S
    return parts.markup("{}{}", table, parts.note_paragraphs([UNLIKE] if is_unlike else []))


def ride_row(name: str, planned: Trajectory, ride: DisturbedRun | None) -> tuple[str, ...]:
    """Return energy of a run with events, more than that of the plan, and delay; None for the plan itself."""
    if ride is None:
        return name, words.energy(planned.energy_kwh), comparisons.NOTHING.cell, words.delay(0.0)
    energy = ride.actual.energy_kwh
    more = comparisons.extra(energy, planned.energy_kwh, ride.delay_s, ride.stop_error_m).cell
    return name, words.energy(energy), more, words.delay(ride.delay_s)
