"""Motor: the plan through the control loop of its motors, with currents, flux, voltage and both energies."""

from functools import partial

import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core import load_scenario
from railjoule.core.simulation.field_oriented import FieldOrientedRun
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.charts.chart import Axis, Chart
from railjoule.dashboard.charts.machine_map import MotorMapChart
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.pages.motor.charts import (
    CURRENTS,
    ENERGY,
    FLUX,
    RIVAL_CURRENT,
    RIVAL_ENERGY,
    RIVAL_SPEED,
    SPEED,
    TRACKING,
    TRACKING_FINE,
    VOLTAGE,
    DetuningChart,
    FluxChart,
    LoopChart,
    LoopDistanceChart,
    RippleChart,
    detuning_table,
    flux_table,
    length,
)
from railjoule.dashboard.pages.motor.compute import MACHINE_SCENARIO
from railjoule.dashboard.pages.motor.loop_diagram import LoopDiagram
from railjoule.dashboard.pages.motor.work import PAGE, Motor
from railjoule.dashboard.pages.page import PageView
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.number_field import NumberField

HEIGHTS = {
    "loop_speed": (200, 250, 180),
    "tracking": (120, 140, 120),
    "tracking_fine": (90, 100, 90),
    "loop_currents": (170, 200, 160),
    "loop_voltage": (130, 150, 120),
    "loop_flux": (90, 100, 90),
    "loop_energy": (190, 220, 180),
    "loop_place": (200, 250, 180),
    "rival_speed": (180, 210, 170),
    "rival_current": (140, 160, 130),
    "rival_energy": (170, 200, 160),
    "machine_map": (290, 340, 270),
    "ripple": (190, 220, 180),
    "flux_sweep": (220, 260, 210),
    "detuning": (190, 220, 180),
}
"""Of each chart [px]: in usual, wide and narrow windows."""
OF_RUN = ("loop_speed", "loop_currents", "loop_voltage", "loop_flux", "loop_energy")
LEFT = ("loop_speed", "tracking", "tracking_fine", "loop_currents", "loop_voltage", "loop_flux", "loop_energy")
OF_TRACKING = ("tracking", "tracking_fine")
OF_STRATEGIES = ("rival_speed", "rival_current", "rival_energy")
LAYOUT_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); column-gap: 28px;
  padding: 8px 20px 12px 14px; align-items: start; }
@media (max-width: 1099px) { :host { grid-template-columns: minmax(0, 1fr); padding: 8px 10px 12px 6px; } }
"""
DIAGRAM_CSS = """
:host { position: sticky; top: 0; z-index: 5; background: var(--rj-surface); padding: 10px 20px 8px;
  border-bottom: 1px solid var(--rj-line); }
@media (max-width: 899px) { :host { position: static; padding: 10px 14px 8px; } }
"""
COLUMN_CSS = ":host { row-gap: 6px; }"
# 50 px, as charts have left of their frames
QUESTION = (
    '<div style="padding:8px 6px 0 50px"><h2>A wrong rotor resistance</h2><p class="note">The controller computes '
    "the flux from the rotor resistance, which rises by up to half as the rotor warms up. The study runs the plan with "
    "controllers that assume half to twice the true resistance.</p></div>"
)
LIMIT_WORDS = {"current": "The current limit", "voltage": "The voltage limit"}


class MotorView(PageView):
    """The page of the drive in closed loop."""

    page = PAGE
    works = (Motor,)
    heights = HEIGHTS

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        state, palette = self.state, self.palette
        self.model = state.motor
        self.held, self.account, self.refusals, self.notes, self.no_machine, self.costs, self.fluxes = (
            parts.html_pane() for _ in range(7)
        )
        self.diagram = LoopDiagram()
        self.axis = Axis(palette)
        loops = (
            SPEED,
            TRACKING,
            TRACKING_FINE,
            CURRENTS,
            VOLTAGE,
            FLUX,
            ENERGY,
            RIVAL_SPEED,
            RIVAL_CURRENT,
            RIVAL_ENERGY,
        )
        self.loops = {
            loop.name: LoopChart(loop, HEIGHTS[loop.name][0], self.axis, palette, last=loop in (ENERGY, RIVAL_ENERGY))
            for loop in loops
        }
        self.over_distance = LoopDistanceChart(HEIGHTS["loop_place"][0], palette)
        self.map = MotorMapChart(HEIGHTS["machine_map"][0], palette, "machine_map")
        self.ripple = RippleChart(HEIGHTS["ripple"][0], palette)
        self.flux_sweep = FluxChart(HEIGHTS["flux_sweep"][0], palette)
        self.detuning = DetuningChart(HEIGHTS["detuning"][0], palette)
        self.at = NumberField(self.model, "ripple_at_s")
        self.cruise = NumberField(self.model, "cruise_speed_kmh", check=self._within_top_speed)
        self.open = pmui.Button(
            label=f"Open {load_scenario(MACHINE_SCENARIO).title}",
            variant="outlined",
            size="small",
            margin=(10, 20),
            on_click=lambda _: state.scenario.choose(MACHINE_SCENARIO),
        )
        self.question = parts.html_pane(QUESTION)
        self.study = pmui.Button(
            label="Run the study",
            variant="outlined",
            size="small",
            margin=(8, 8, 4, 50),
            on_click=lambda _: self.model.param.trigger("study"),
        )
        self.stop = pmui.Button(
            label="Stop",
            variant="text",
            size="small",
            margin=(8, 8, 4, 8),
            visible=False,
            on_click=lambda _: self.model.param.trigger("stop_study"),
        )
        self.progress = pmui.LinearProgress(
            value=0, variant="determinate", margin=(4, 14, 4, 50), sizing_mode="stretch_width", visible=False
        )
        self.missing = parts.stack(self.no_machine, self.open, visible=False)
        self.body = self._laid_out()
        self.shows(self._show_run, (self.model, ["run", "failure", "no_machine"]))
        self.shows(self._show_rivals, (self.model, ["rivals"]))
        self.shows(self._show_map, (self.model, ["machine_map"]))
        self.shows(self._show_ripple, (self.model, ["ripple"]))
        self.shows(self._show_flux_sweep, (self.model, ["flux_sweep"]))
        self.shows(self._show_detuning, (self.model, ["detuning", "studying"]))
        return parts.stack(self.heading, self.missing, self.message, self.body)

    def _laid_out(self) -> pn.Column:
        left = parts.stack(*(self.loops[name].host for name in LEFT), self.account, css=COLUMN_CSS)
        rivals = (self.loops[name].host for name in OF_STRATEGIES)
        right = parts.stack(
            self.over_distance.host,
            *rivals,
            self.refusals,
            self.map.host,
            self.ripple.host,
            self.at,
            self.flux_sweep.host,
            self.cruise,
            self.fluxes,
            css=COLUMN_CSS,
        )
        diagram = parts.stack(self.diagram, css=DIAGRAM_CSS)
        study = parts.stack(
            self.question,
            pn.Row(self.study, self.stop, margin=0, sizing_mode="stretch_width"),
            self.progress,
            self.detuning.host,
            css=COLUMN_CSS,
        )
        notes = parts.stack(self.notes, css=":host { padding: 0 20px 16px; }")
        upper, lower = parts.stack(left, right, css=LAYOUT_CSS), parts.stack(study, self.costs, css=LAYOUT_CSS)
        return parts.stack(self.figures, self.held, diagram, upper, lower, notes)

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return *self.loops.values(), self.over_distance, self.map, self.ripple, self.flux_sweep, self.detuning

    def settle(self) -> None:
        """Tell the cursor of the runs that it may meet new charts."""
        self.axis.settle("s", 1)

    def _show_run(self) -> None:
        model, run = self.model, self.model.run
        self.missing.visible = bool(model.no_machine)
        self.body.visible = not model.no_machine
        self._show_heading()
        if model.no_machine:
            self.tell(None, "")
            self.no_machine.object = parts.note_paragraphs([model.no_machine], "margin:0 20px")
            return
        self.tell(model.failure, "Shown: the last run that could be computed." if run is not None else "")
        if run is None:
            return
        self.axis.fit(float(run.time_s[-1]), roomy=False)
        self.at.set_ends((0.0, float(run.time_s[-1])))
        self.cruise.set_ends((1.0, run.scenario.vehicle.traction.max_speed_kmh))
        for name in OF_RUN:
            self.loops[name].show(partial(self.loops[name].draw, {"run": run}))
        self.over_distance.show(partial(self.over_distance.draw, run))
        self._show_texts(run)

    def _show_heading(self) -> None:
        scenario = self.state.scenario.scenario()
        what = "plan run through the field-oriented control of the motors"
        run = self.model.run
        aside = "" if run is None else f"arrival error {words.delay(run.delay_s)} s"
        self.heading.object = parts.heading(self.page, scenario.title, what, aside)

    def _show_rivals(self) -> None:
        rivals = self.model.rivals
        if rivals is None:
            return
        for name in OF_STRATEGIES:
            self.loops[name].host.visible = bool(rivals.strategies)
        for name in (*(OF_STRATEGIES if rivals.strategies else ()), *OF_TRACKING):
            self.loops[name].show(partial(self.loops[name].draw, rivals.named))
        refused = (f"{words.STRATEGY_WORDS[name]}: {why}" for name, why in rivals.refused.items())
        self.refusals.object = parts.note_paragraphs(refused, "padding-left:6px")

    def _show_map(self) -> None:
        found = self.model.machine_map
        if found is not None:
            self.map.show(partial(self.map.draw, found.map, "motor", found.points))

    def _show_ripple(self) -> None:
        ripple = self.model.ripple
        # until it is there, its sketch; after an error there will be none
        self.ripple.host.visible = ripple is not None or self.model.failure is None
        if ripple is not None:
            self.ripple.show(partial(self.ripple.draw, ripple))

    def _within_top_speed(self, speed_kmh: float) -> float:
        """Return a speed that was typed; raises ValueError beyond the maximum speed of the vehicle."""
        top = self.state.scenario.scenario().vehicle.traction.max_speed_kmh
        if speed_kmh > top:
            raise ValueError(f"At most {top:g}, the maximum speed of the vehicle.")
        return speed_kmh

    def _show_flux_sweep(self) -> None:
        sweep = self.model.flux_sweep
        self.flux_sweep.host.visible = self.fluxes.visible = sweep is not None or self.model.failure is None
        if sweep is not None:
            self.fluxes.object = flux_table(sweep)
            self.flux_sweep.show(partial(self.flux_sweep.draw, sweep))

    def _show_detuning(self) -> None:
        table, studying = self.model.detuning, self.model.studying
        self.progress.visible = self.stop.visible = studying
        if studying:
            done = 0.0 if table is None else table.done / len(table.rotor_resistance_factors)
            self.progress.value = int(100 * done)
        self.detuning.host.visible = self.costs.visible = table is not None
        if table is not None:
            self.costs.object = detuning_table(table)
            self.detuning.show(partial(self.detuning.draw, table))

    def _show_texts(self, run: FieldOrientedRun) -> None:
        self.figures.object = parts.figures(run_figures(run), self.model.failure is not None)
        self.held.object = held_words(run)
        self.account.object = parts_table(run)
        notes = (*run.planned.notes, *run.notes)
        self.notes.object = parts.note_paragraphs(notes)


def run_figures(run: FieldOrientedRun) -> list[str]:
    """Return the numbers of a run."""
    by_input, by_parts = (
        float(energy[-1]) / J_PER_KWH for energy in (run.energy_by_input_power_j, run.energy_by_parts_j)
    )
    magnetising = run.magnetising_loss_kwh
    # in millionths, as a percentage of so small a difference would read 0.00
    share = 1e6 * (by_parts / by_input - 1) if by_input else 0.0
    # both from the supply: the motors' net energy counts braking energy that the supply may not take back
    amount = comparisons.above(run.actual.energy_kwh, run.planned.energy_kwh)
    planned = words.energy(run.planned.energy_kwh)
    return [
        parts.figure(
            "Energy", words.energy(run.actual.energy_kwh), "kWh", f"{amount.sentence} the plan, {planned} kWh", "main"
        ),
        parts.figure(
            "Energy from input power",
            words.energy(by_input),
            "kWh",
            "all braking energy deducted",
            whole=f"The parts sum to it within {words.number(abs(share), 2)} ppm",
        ),
        parts.figure(
            "Magnetising loss",
            words.energy(magnetising),
            "kWh",
            f"{words.energy(run.paper_energy_kwh)} without it",
        ),
        parts.figure(
            "Tracking error", *length(run.max_tracking_error_m), f"{' '.join(length(run.stop_error_m))} at the end"
        ),
        parts.figure(
            "Peak current",
            words.number(run.max_current_a, 0),
            "A",
            f"torque {words.number(run.min_torque_current_a, 0)} to {words.number(run.max_torque_current_a, 0)}",
        ),
        parts.figure("Peak voltage", words.number(run.max_phase_voltage_v, 0), "V", "per phase"),
        parts.figure("Arrival error", words.delay(run.delay_s), "s", "against the plan", "extra"),
    ]


def held_words(run: FieldOrientedRun) -> Markup:
    """Return where a limit held the drive and by how much it fell behind; nothing where none did."""
    rows = joined(
        markup(
            '<p class="note"><span class="open">{}</span> limited the motors from {} to {} s: {} behind the plan at '
            "most.</p>",
            LIMIT_WORDS[span.what],
            words.number(span.start_s),
            words.number(span.end_s),
            " ".join(length(max(span.lag_m, 0.0))),
        )
        for span in run.saturated
    )
    return markup('<div role="status" style="padding:0 20px 6px">{}</div>', rows) if rows else rows


def parts_table(run: FieldOrientedRun) -> Markup:
    """Return the parts of the energy, and their sum beside the integral of input power."""
    total = sum(run.parts_j.values())
    rows = [((words.PART_WORDS[name], *_amount(joules, total)), False) for name, joules in run.parts_j.items()]
    rows.append((("Sum of parts", *_amount(total, total)), True))
    by_input = float(run.energy_by_input_power_j[-1])
    rows.append((("Input power, integrated", *_amount(by_input, total)), True))
    return parts.inset(parts.table("Energy at the motors, by part", ("Part", "kWh", "%"), rows))


def _amount(joules: float, total: float) -> tuple[str, str]:
    return words.energy(joules / J_PER_KWH), words.share(joules / total if total else 0.0)
