"""The tab "Load and position": the plan under another load and a position error, and the table of both."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import panel as pn
import param
from panel.viewable import Viewable

from railjoule.core import Scenario
from railjoule.core.studies.braking_sensors import MEASUREMENTS, BrakingSensors
from railjoule.core.studies.sensitivity_table import COORDINATE_ERRORS_M, LOAD_FACTORS, KnownFacts, sensitivity_steps
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard import day
from railjoule.dashboard.charts.driven import BRAKING, EFFORTS, LOAD, PLACE, SPEEDS, reality_words
from railjoule.dashboard.charts.plot import Plot
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.page import Page, Request, shows, study, work
from railjoule.dashboard.pages.what_if.compute import Reality, compute_reality, steps, stop_steps
from railjoule.dashboard.pages.what_if.heat_map import MEASURES, HeatMapChart, printed_table
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import box, buttons, menu
from railjoule.dashboard.parts.number_field import LoadField, number_fields
from railjoule.dashboard.state.kept import result
from railjoule.dashboard.state.recipes import followed
from railjoule.dashboard.work.runs import is_slow
from railjoule.dashboard.workbench import Workbench

LOAD_AND_POSITION, FOLLOWING, CHANCE, EVENTS = (
    tuple(f"desk.day.{field}" for field in fields)
    for fields in (day.LOAD_AND_POSITION, day.FOLLOWING, day.CHANCE, ("events", "changed", "accepted_delay_s", "on"))
)
"""The actual conditions as sources."""
PREVIEW_RUNS = 500
"""Random draws without a request for more."""
NOTHING_WRONG = {"disturbance.actual_load_factor": 0.0, "disturbance.coordinate_error_m": 0.0}
"""Changes for studies with their own loads and position errors."""


def conditions(desk: Workbench, changes: Mapping[str, Any]) -> tuple[Scenario, dict[str, Any]]:
    """Return the scenario, and some of the actual conditions by its keys, without the events of its file."""
    events = day.NO_EVENTS if desk.scenario.edited.disturbance.events else {}
    return desk.scenario.scenario(), {"strategy": desk.chosen, **followed(desk), **events, **changes}


def is_slow_plan(scenario: Scenario, *_: Any) -> bool:
    """Return whether a plan takes seconds."""
    return is_slow(scenario, scenario.strategy)


def section(title: str, aside: str) -> Viewable:
    """Return a heading among the fields of the sidebar."""
    return parts.html_pane(parts.markup('<div class="section">{} <span>\u00b7 {}</span></div>', title, aside))


KNOWN: dict[str, KnownFacts] = {
    "none": "nothing",
    "for the load": "load",
    "for the position": "place",
    "for both": "both",
}
SELECT: dict[str, Any] = {"margin": (6, 0, 6, 6)}
BESIDE: dict[str, Any] = {"margin": (10, 0, 0, 12)}
HEAT_MAP = Plot("heatmap", "", heights=(350, 440, 320), chart=HeatMapChart)
DRIVEN = (SPEEDS, EFFORTS)
LAYOUT_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); column-gap: 28px;
  padding: 10px 20px 12px 14px; align-items: start; }
@media (max-width: 1099px) { :host { grid-template-columns: minmax(0, 1fr); padding: 8px 12px; } }
"""
HINT = (
    "Click a cell to see its run. Cells compare with a plan on time, the sentence at the top with one as late as the "
    f"run. {comparisons.MISSED}"
)


class LoadTab(Page):
    """The content of this tab."""

    both_directions = param.Boolean(default=False, doc="Whether the table covers both directions.")
    known = param.Selector(
        default="nothing",
        objects=list(KNOWN.values()),
        label="Replanning",
        doc="Facts that the train gets before its start.",
    )
    measure = param.Selector(
        default="over_replanned", objects=list(MEASURES), label="Show", doc="Quantity of the table."
    )

    reality = result(Reality, "The last good run.")
    table = result(StudyTable, "The table so far.")
    stops = result(BrakingSensors, "Stopping errors with precision braking and without.")

    @work(
        *("scenario", "desk.chosen", *LOAD_AND_POSITION, *FOLLOWING),
        into="reality",
        marked=True,
        is_slow=is_slow_plan,
        only_last=False,
        tab=LOAD,
    )
    def _reality(self) -> Request:
        return compute_reality, *conditions(self.desk, self.desk.day.conditions)

    # the run comes first; the table has loads and errors of its own
    @study("reality", "both_directions", "known", into="table", marked=True, tab=LOAD)
    def _table(self) -> Request:
        plan = conditions(self.desk, {**self.desk.day.conditions, **NOTHING_WRONG})
        table = LOAD_FACTORS, COORDINATE_ERRORS_M, self.both_directions, self.known
        return self.reality and (steps, *plan, sensitivity_steps, *table)

    @study("reality", *CHANCE, into="stops", tab=LOAD)
    def _stops(self) -> Request:
        planned_load = {"disturbance.actual_load_factor": self.desk.scenario.planned_load_percent / 100}
        draws = {**self.desk.day.chance_changes(PREVIEW_RUNS), **NOTHING_WRONG, **planned_load}
        return self.reality and (steps, *conditions(self.desk, draws), stop_steps)

    # ---- what it shows

    def layout_load(self) -> Viewable:
        """Return the parts of the tab, laid out."""
        plots = self.host.plots
        self.numbers, self.stop_errors, self.printed = (parts.html_pane() for _ in range(3))
        plots["heatmap"].choose = self._choose
        left = parts.stack(
            pn.Row(
                menu(self, "measure", "Show", {m.words: key for key, m in MEASURES.items()}, min_width=270, **SELECT),
                buttons(self, "both_directions", {"One direction": False, "Both directions": True}, **BESIDE),
                margin=0,
                sizing_mode="stretch_width",
                stylesheets=[parts.WRAP_CSS],
            ),
            plots["heatmap"].host,
            pn.Row(
                menu(self, "known", "Replanning", KNOWN, **SELECT),
                parts.html_pane(parts.note_paragraphs([HINT], "margin:10px 0 0 12px")),
                margin=0,
                sizing_mode="stretch_width",
            ),
            self.stop_errors,
            self.printed,
        )
        right = parts.stack(*(plots[plot.name].host for plot in (*DRIVEN, BRAKING, PLACE)))
        return parts.stack(self.numbers, parts.stack(left, right, css=LAYOUT_CSS))

    def layout_load_fields(self) -> Viewable:
        """Return its part of the sidebar."""
        model = self.desk.day
        sensors = number_fields(model, *day.SENSOR_FIELDS, *day.SENSOR_ERRORS)
        self.sensors = parts.stack(*sensors, visible=model.target_braking)
        # without the target curve nothing depends on them
        model.param.watch(lambda event: self.sensors.param.update(visible=event.new), "target_braking")
        return parts.stack(
            section("Actual conditions", "the framed cell"),
            LoadField(model, "actual_load_percent", ["most_load_percent"]),
            *number_fields(model, "coordinate_error_m", "speed_error_percent"),
            section("Braking sensors", "metres before the stop"),
            box(model, "target_braking", "Brake along the target curve", margin=(0, 16, 0, 14)),
            self.sensors,
        )

    def _choose(self, load_factor: float, error_m: float) -> None:
        self.desk.day.param.update(actual_load_percent=100 * load_factor, coordinate_error_m=error_m)

    @shows("reality", "table", "failure", tab=LOAD)
    def _show_load_numbers(self) -> None:
        if self.reality is not None:
            self.numbers.object = parts.figures(load_figures(self.reality, self.table), self.failure is not None)

    @shows("reality", tab=LOAD)
    def _show_reality(self) -> None:
        if self.reality is None:
            return
        following = self.reality.following
        host, simulation = self.host, following.planned.scenario.simulation
        ends = following.planned.position_m[-1], following.actual.position_m[-1]
        host.axes[LOAD].fit(float(max(ends)), roomy=False)
        host.draw([DRIVEN[0]], following, reality_words(*_framed(self.reality)))
        host.draw([DRIVEN[1], BRAKING], following)
        # sensors reset the position only under the target curve; without them and a speed error it is constant
        host.plots["place"].host.visible = simulation.target_braking or simulation.speed_error != 0
        host.draw([PLACE], following)

    @shows("reality", "table", "measure", tab=LOAD)
    def _show_table(self) -> None:
        if self.table is None or self.reality is None:
            return
        measure = MEASURES[self.measure]
        self.host.draw([HEAT_MAP], self.table, measure, *_framed(self.reality))
        if self.table.done == self.table.energy_kwh.size:
            self.printed.object = printed_table(self.table, measure)

    @shows("stops", tab=LOAD)
    def _show_stops(self) -> None:
        self.stop_errors.object = "" if self.stops is None else stop_table(self.stops)


# ---- texts


def _framed(reality: Reality) -> tuple[float, float]:
    disturbance = reality.following.actual.scenario.disturbance
    return disturbance.actual_load_factor or 0.0, disturbance.coordinate_error_m


def finding(reality: Reality) -> parts.Markup:
    """Return the outcome of the plan in a sentence: timetable, stop, and energy beside a plan for the load."""
    following, equal = reality.following, reality.equal_kwh
    missed = " and ".join(map(str, comparisons.misses(following.delay_s, following.stop_error_m)))
    more = ""
    if equal is not None:
        above = comparisons.extra(following.actual.energy_kwh, equal, 0.0, following.stop_error_m).sentence
        more = f", and its energy is {above} that of a plan for the actual load with the same arrival"
    load, error_m = _framed(reality)
    planned_at = words.vehicle_load(following.planned.scenario.vehicle)
    return parts.finding(
        f"Planned at {planned_at}, driven at load {words.setting(load)}\u00a0% with a position error of "
        f"{words.signed(error_m, 0)}\u00a0m: the train arrives {missed or 'on time at its stop'}{more}."
    )


def load_figures(reality: Reality, table: StudyTable | None) -> list[str]:
    """Return the numbers of a run: first what it misses of timetable and stop, then its energy at equal arrival."""
    following, label = reality.following, reality_words(*_framed(reality)).capitalize()
    energy, planned = following.actual.energy_kwh, following.planned.energy_kwh
    missed = comparisons.misses(following.delay_s, following.stop_error_m)
    known, whose = reality.replanned_kwh, "for the actual load"
    if known is None:
        known, whose = planned, "planned"
    if missed:
        first, *others = missed
        detail = ", ".join(map(str, others)) or f"{words.stop_error(following.stop_error_m)} m at the stop"
        cells = [parts.figure(label, *first, detail, "main", term="Delay"), _equal_figure(reality)]
    else:
        detail = f"{words.energy(energy)} kWh, {whose} {words.energy(known)}"
        cells = [
            parts.figure(label, *comparisons.above(energy, known), detail, "main", term="Extra energy"),
            parts.figure("Arrival", words.delay(following.delay_s), "s", _early_words(reality)),
        ]
    share = f"{comparisons.above(energy, planned)}, "
    if comparisons.is_false_saving(energy, planned, following.delay_s, following.stop_error_m):
        share = ""
    more = words.energy_difference(energy - planned)
    cells.append(parts.figure("Against the plan", more, "kWh", f"{share}planned {words.energy(planned)}"))
    if table is not None and np.any(np.isfinite(table.over_replanned)):
        k, m = np.unravel_index(np.nanargmax(table.over_replanned), table.over_replanned.shape)
        largest = words.share_difference(float(table.over_replanned[k, m]))
        place = reality_words(table.load_factor[k], table.coordinate_error_m[m])
        cells.append(parts.figure("Largest in table", largest, "%", place))
    return cells


def _early_words(reality: Reality) -> str:
    """Return the energy of a run that is too early against that of a plan for its load which is as early."""
    following, equal = reality.following, reality.equal_kwh
    if equal is None or following.delay_s > -comparisons.OTHER_TIME_S:
        return "at the stop"
    return f"{comparisons.above(following.actual.energy_kwh, equal)} energy at equal arrival"


def _equal_figure(reality: Reality) -> str:
    """Return the energy of a run against that of a plan for its load that arrives when the run does."""
    energy, equal = reality.following.actual.energy_kwh, reality.equal_kwh
    if equal is None:
        detail = f"{words.energy(energy)} kWh; no plan arrives then"
        return parts.figure("Energy at equal arrival", words.UNKNOWN, "", detail, term="Extra energy")
    # beside a run that stops elsewhere, less energy is no saving
    more = comparisons.extra(energy, equal, 0.0, reality.following.stop_error_m)
    detail = f"{words.energy(energy)} kWh, for the actual load {words.energy(equal)}"
    return parts.figure("Energy at equal arrival", *more, detail, term="Extra energy")


def _metres(value: float) -> str:
    return f"{words.stop_error(value)} m"


ERRORS: dict[str, tuple[str, Callable[[float], str]]] = {
    "coordinate_error_m": ("Position", _metres),
    "speed_error": ("Speed", lambda value: f"{words.signed(100 * value, 2)} %"),
    "d1_error_m": (parts.Markup("D1 (L<sub>pb</sub>)"), _metres),
    "d2_error_m": (parts.Markup("D2 (L<sub>c</sub>)"), _metres),
    "d3_error_m": (parts.Markup("D3 (L<sub>st</sub>)"), _metres),
}
"""Words for each error of measurement, and the format of its values."""


def stop_table(found: BrakingSensors) -> str:
    """Return the stopping errors of each error of measurement by itself, then of all of them drawn together."""
    rows: list[tuple[tuple[str, ...], bool]] = []
    for name in MEASUREMENTS:
        word, show = ERRORS[name]
        # the upper end of the middle of its draws: the lower one gives the same with the other sign
        _, effect = (effect for effect in found.effects if effect.quantity == name)
        errors = words.stop_error(effect.with_m), words.stop_error(effect.without_m)
        rows.append(((word, show(effect.value), *errors), False))
    both = found.spread_with, found.spread_without
    rows.append((("All, 95 % within", "", *(words.number(spread.half_width_m, 2) for spread in both)), True))
    rows.append((("All, deviation", "", *(words.number(spread.deviation_m, 2) for spread in both)), False))
    note = (
        f"{words.number(found.table.done, 0)} runs, seed {found.table.scenario.montecarlo.seed}; each error by itself "
        "at the upper end of the middle 95 % of its draws, then all drawn together. Without sensors the train stops "
        "where it estimates the stop."
    )
    header = ("Error", "Value", "With sensors, m", "Without, m")
    return parts.inset(parts.table("Precision braking: stopping error", header, rows), parts.note_paragraphs([note]))
