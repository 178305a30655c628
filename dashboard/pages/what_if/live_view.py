"""The part of the page that plays a run: its controls, its numbers, its chart, and how it ended."""

from collections.abc import Callable
from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.live import LiveRun
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.theme import padded
from railjoule.dashboard.pages.what_if.live_chart import PLAYED
from railjoule.dashboard.pages.what_if.live_model import PACES, LiveModel, LiveResult
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import box, buttons
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.numbers import clock

UNLIKE_S = 0.1
"""Energies of arrivals that differ by this do not compare [s]."""
BODY_CSS = padded("4px 20px 12px 14px", "4px 10px 12px 6px")
FIELDS_CSS = """
:host { display: grid; grid-template-columns: repeat(auto-fill, minmax(172px, 1fr)); align-items: end; }
"""
HOW = (
    "Press Play, then set a signal, a limit or a voltage while the train drives: the plan ahead is computed again from "
    "where the train is. A click on the chart sets a red signal there."
)
STANDS_IN = "{} over cells of {} m, as {} is too slow for that or refuses the line"
FASTEST = "as fast as allowed, as the time is too short"
UNLIKE = (
    "Energies of different arrivals do not compare. Set an accepted delay in the sidebar and play again, so that both "
    "arrive at the same time."
)


class LivePart:
    """All that is in sight while the page plays a run."""

    def __init__(self, model: LiveModel, host: Any, keep: Callable[..., None]) -> None:
        self.model, self.axis, self.chart = model, host.axes[PLAYED.axis], host.plots[PLAYED.name]
        self.chart.press = self._press
        self.numbers, self.message, self.status, self.table = (parts.html_pane() for _ in range(4))
        self.play = _button("Play", self._play, variant="contained")
        self.again = _button("Start again", lambda _: model.param.trigger("restart"))
        self.keep = _button("Keep these events", keep)
        self.pace = buttons(self.model, "pace", {f"{pace:g}\u00d7": pace for pace in PACES}, margin=(8, 8, 0, 8))
        tools = pn.Row(self.play, self.pace, self.again, self.keep, margin=(0, 0, 0, 12), stylesheets=[parts.WRAP_CSS])
        body = parts.stack(self.status, self.chart.host, self._fields(), self.table, css=BODY_CSS)
        self.view = parts.stack(self.numbers, tools, self.message, body)
        # not a part of the page: a tenth of a second is too short to settle all charts
        model.param.watch(self.move, "run")
        host.browser.follow(["hidden"], lambda: self._pause(host.browser.hidden))

    def _fields(self) -> pn.Column:
        model = self.model
        self.clear = _button("Clear signal", model.clear_signal)
        rows = (
            (
                NumberField(model, "signal_m"),
                NumberField(model, "signal_s", of="Signal "),
                box(model, "is_open", "until cleared", margin=(0, 12)),
                pn.Row(
                    _button("Set red signal", model.set_signal),
                    self.clear,
                    margin=0,
                    stylesheets=[parts.WRAP_CSS],
                ),
            ),
            (
                NumberField(model, "from_m"),
                NumberField(model, "to_m", of="Limit "),
                NumberField(model, "limit_kmh", of="Limit "),
                _button("Set limit", model.set_limit),
            ),
            (
                NumberField(model, "voltage_percent"),
                _button("Set voltage", model.set_voltage),
            ),
        )
        return parts.stack(*(parts.stack(*row, css=FIELDS_CSS) for row in rows))

    def _play(self, _: Any) -> None:
        run = self.model.run
        if run is not None and run.has_arrived:
            self.model.param.trigger("restart")
        else:
            self.model.playing = run is not None and not self.model.playing

    def _pause(self, hidden: bool) -> None:
        if hidden:
            self.model.playing = False

    def _press(self, place_m: float) -> None:
        self.model.signal_m = float(round(place_m))
        self.model.set_signal()

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
        """Show where the train is, and what it needs."""
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
        """Show what can be pressed, and why the last press was refused."""
        run, model = self.model.run, self.model
        failure = model.failure
        self.message.visible = failure is not None
        if failure is not None:
            self.message.object = parts.refusal(str(failure))
        self.play.label = "Pause" if model.playing else "Play again" if run is not None and run.has_arrived else "Play"
        self.keep.disabled = run is None or not run.events
        self.clear.disabled = run is None or not any(one.is_ahead and not run.has_left(one) for one in run.events)

    def show_result(self) -> None:
        """Show how the run ended, beside its plan and the run of a train that knew all before."""
        result = self.model.ended
        self.table.object = "" if result is None else _table(result)


def _button(label: str, act: Any, variant: str = "outlined") -> pmui.Button:
    return pmui.Button(label=label, variant=variant, size="small", height=28, margin=(8, 4, 0, 4), on_click=act)


def _doing(run: LiveRun) -> str:
    if run.has_arrived:
        return "arrived"
    if run.speed_ms > 0:
        return ""
    return f"stands for {words.time(run.dwell_left_s)} s" if run.dwell_left_s > 0 else "stands"


def _status(run: LiveRun, replan_s: float) -> list[str]:
    """Return how the plan ahead came about, and what it cannot keep."""
    made = words.STRATEGY_WORDS[run.strategy]
    if run.strategy == "fastest":
        made = FASTEST
    elif run.strategy != run.scenario.strategy:
        cells = words.number(run.plan.scenario.solver.mesh_m, 0)
        made = STANDS_IN.format(made, cells, words.STRATEGY_WORDS[run.scenario.strategy])
    where = f"At {words.number(run.since.position_m, 0)} m"
    return [f"{where}: planned again in {1000 * replan_s:.0f} ms, {made}.", *run.notes]


def _table(result: LiveResult) -> str:
    """Return the energies and arrivals of the plan, the run that played, and the one with advance notice."""
    planned = result.live.planned
    nothing = (comparisons.NOTHING.cell, words.delay(0.0))
    rows: list[tuple[tuple[str, ...], bool]] = [(("Undisturbed", words.energy(planned.energy_kwh), *nothing), False)]
    rows += [
        (_row("Played", result.live, planned.energy_kwh), True),
        (_row(words.REACTION_WORDS["known"], result.known, planned.energy_kwh), False),
    ]
    is_unlike = abs(result.live.delay_s - result.known.delay_s) >= UNLIKE_S
    table = parts.table("How it ended", ("Run", "kWh", "more, %", "late, s"), rows)
    return parts.markup("{}{}", table, parts.note_paragraphs([UNLIKE] if is_unlike else []))


def _row(name: str, run: DisturbedRun, planned_kwh: float) -> tuple[str, ...]:
    energy = run.actual.energy_kwh
    more = comparisons.extra(energy, planned_kwh, run.delay_s, run.stop_error_m).cell
    return name, words.energy(energy), more, words.delay(run.delay_s)
