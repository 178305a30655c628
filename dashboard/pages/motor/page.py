"""Motor: the plan through the control loop of its motors, with currents, flux, voltage and both energies."""

from collections.abc import Mapping
from typing import Any

import param
from panel.viewable import Viewable

from railjoule.core import Scenario, load_scenario
from railjoule.core.scenario.options import SimulationOptions
from railjoule.core.simulation.field_oriented import FieldOrientedRun, Ripple
from railjoule.core.studies.flux_sweep import FluxSweep
from railjoule.dashboard.charts.plot import AnyPlot
from railjoule.dashboard.look import words
from railjoule.dashboard.page import Hint, Page, Request, Section, shows, work
from railjoule.dashboard.pages.motor import texts
from railjoule.dashboard.pages.motor.charts import FLUX, MAP, OF_RIVALS, OF_RUN, OF_TRACKING, RIPPLE, LoopDiagram
from railjoule.dashboard.pages.motor.compute import (
    MACHINE_SCENARIO,
    RIVALS,
    Limits,
    LoopRivals,
    compute_flux_sweep,
    compute_loop_run,
    compute_machine_map,
    compute_ripple,
    compute_rivals,
    limit_changes,
    limits_of,
    scenario_with_motor,
)
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import button
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.kept import result
from railjoule.dashboard.state.numbers import TypedNumber, keyed
from railjoule.dashboard.state.recipes import SOLVE, PageRun, Program, simulation
from railjoule.dashboard.work.runs import is_slow
from railjoule.dashboard.workbench import Workbench

IN_CLOSED_LOOP = simulation("simulate_field_oriented", "field_oriented")
CRUISE_KMH = 44.0
"""Speed of the flux chart where a scenario is opened: of the cruise that Rawicki prints, 12.26 m/s."""
CONTROL = (
    "precompensator",
    "flux",
    "bandwidth_rads",
    "rotor_resistance_factor",
    "speed_noise_rads",
    "noise_seed",
)
"""The fields of the controller, by the keys of the file."""
LIMITS = ("max_phase_voltage_v", "max_current_a")
EXAMPLE_NOTE = (
    "The data of {} describe no induction motor; the editor has them under Powertrain. The page shows an example."
)
LAYOUT_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); gap: 16px 28px;
  padding: 8px 20px 12px 14px; align-items: start; }
@media (max-width: 1099px) { :host { grid-template-columns: minmax(0, 1fr); padding: 8px 10px 12px 6px; } }
"""
DIAGRAM_CSS = """
:host { position: sticky; top: 0; z-index: 5; background: var(--rj-surface); padding: 10px 20px 8px;
  border-bottom: 1px solid var(--rj-line); }
@media (max-width: 899px) { :host { position: static; padding: 10px 14px 8px; } }
"""
COLUMN_CSS = ":host { row-gap: 6px; }"


class Motor(Page):
    """The drive in closed loop."""

    page = "Motor"
    kept = (*CONTROL, *LIMITS, "ripple_at_s", "cruise_speed_kmh")
    fields = (
        Section("Controller", "with a rotor resistance of its own"),
        *CONTROL,
        Hint("Slip is computed from this resistance.", "Slip"),
        Section("Inverter", "at most, each phase"),
        *LIMITS,
    )
    choices = {"flux": {"Constant": "constant", "Least loss": "min_loss"}}  # noqa: RUF012
    figures = (*OF_RUN, *OF_TRACKING, *OF_RIVALS, MAP, RIPPLE, FLUX)

    precompensator = param.Boolean(default=True, label="Pre-compensator")
    flux = param.Selector(default="constant", objects=["constant", "min_loss"], label="Rotor flux")
    bandwidth_rads = keyed(SimulationOptions, "bandwidth_rads", "Bandwidth", "rad/s", 1)
    rotor_resistance_factor = keyed(SimulationOptions, "rotor_resistance_factor", "Assumed / true resistance", digits=2)
    speed_noise_rads = keyed(SimulationOptions, "speed_noise_rads", "Speed noise", "rad/s", 2)
    noise_seed = keyed(SimulationOptions, "noise_seed", "Seed")
    max_phase_voltage_v = TypedNumber("Phase voltage, V", "V", default=None, allow_None=True, bounds=(1.0, 1e5))
    max_current_a = TypedNumber("Current, A", "A", default=None, allow_None=True, bounds=(1.0, 1e5))
    ripple_at_s = TypedNumber(
        "Ripple at t, s", "s", 1, default=20.0, bounds=(0.0, 86_400.0), softbounds=(0, 100), step=0.5
    )
    cruise_speed_kmh = TypedNumber(
        "Cruise speed, km/h", "km/h", 1, default=CRUISE_KMH, bounds=(1.0, 500.0), softbounds=(1, 100), step=1
    )

    run = result(FieldOrientedRun, "The last good run.")
    rivals = result(LoopRivals, "Runs to compare with.")
    machine_map = result(tuple, "Efficiency and run.")
    ripple = result(Ripple, "Current under switched voltage.")
    flux_sweep = result(FluxSweep, "Cruise over the flux current.")

    def __init__(self, desk: Workbench, **params: Any) -> None:
        super().__init__(desk, **params)
        # without them, the limits of the scenario would differ from those of a new page
        self.take(desk.scenario.base)

    def part(self, scenario: Scenario) -> object:
        """Return the drive and its control."""
        return scenario.vehicle.drive, scenario.simulation

    def take(self, scenario: Scenario) -> None:
        """Give the fields the values of a scenario's controller and machine."""
        scenario = scenario_with_motor(scenario)
        limits = limits_of(scenario)
        self.param.update(
            **{name: getattr(scenario.simulation, name) for name in CONTROL},
            **(limits or dict.fromkeys(LIMITS)),
            cruise_speed_kmh=min(CRUISE_KMH, scenario.vehicle.traction.max_speed_kmh),
        )

    @property
    def is_example(self) -> bool:
        """Whether the page shows an example, as the scenario has no motor to simulate."""
        return limits_of(self.desk.scenario.edited) is None

    @property
    def changes(self) -> Mapping[str, Any]:
        """Controller and limits, by the keys of the file."""
        control = {f"simulation.{name}": getattr(self, name) for name in CONTROL}
        limits = self._limits()
        machine = {} if limits is None else limit_changes(scenario_with_motor(self.desk.scenario.edited), limits)
        return {"simulation.kind": "field_oriented", **control, **machine}

    def _limits(self) -> Limits | None:
        if self.max_phase_voltage_v is None or self.max_current_a is None:
            return None
        return {name: float(getattr(self, name)) for name in LIMITS}

    def page_run(self) -> PageRun:
        """Return the run in closed loop as a program; with other limits than the plan's, in two steps."""
        own, tried = limits_of(self.desk.scenario.edited), self._limits()
        if own is None or tried is None:
            return super().page_run()
        changes = {"strategy": self.desk.chosen, **self.changes}
        # of these drives only the plan depends on what the inverter gives
        if tried == own or "drive.max_phase_voltage_v" not in changes:
            return PageRun(IN_CLOSED_LOOP, changes)
        body = (
            f"loop = scenario.replace(**{dict(self.changes)!r})\n"
            "ride = simulate(loop, solve(scenario))\nprint(ride.actual.energy_kwh)\n"
        )
        program_note = (
            f"The page tries {tried['max_phase_voltage_v']:g} V and {tried['max_current_a']:g} A on a plan that does "
            "not know of them. A scenario file has one set of limits, for the plan and for the motors."
        )
        program = Program({**SOLVE.imports, **IN_CLOSED_LOOP.imports}, body, "")
        return PageRun(program, {"strategy": self.desk.chosen}, program_note)

    # ---- what it computes

    @work(
        *("scenario", "desk.chosen", *CONTROL, *LIMITS),
        into="run",
        marked=True,
        is_slow=lambda scenario, strategy, _: is_slow(scenario, strategy),
        only_last=False,
    )
    def _run(self) -> Request:
        shown = scenario_with_motor(self.desk.scenario.scenario())
        return compute_loop_run, shown, shown.strategy if self.is_example else self.desk.chosen, self.changes

    @work("run", into="rivals")
    def _rivals(self) -> Request:
        return self.run and (compute_rivals, self.run)

    @work("run", into="machine_map")
    def _map(self) -> Request:
        return self.run and (compute_machine_map, self.run)

    @work("run", "ripple_at_s", into="ripple", clears=True)
    def _ripple(self) -> Request:
        return self.run and (compute_ripple, self.run, float(self.ripple_at_s))

    @work("run", "cruise_speed_kmh", into="flux_sweep", clears=True)
    def _flux(self) -> Request:
        return self.run and (compute_flux_sweep, self.run.scenario, float(self.cruise_speed_kmh))

    # ---- what it shows

    def layout(self) -> Viewable:
        """Make the parts of the page, and return them laid out."""
        self.finding, self.numbers, self.held, self.account, self.compared = (parts.html_pane() for _ in range(5))
        self.refusals, self.notes, self.example, self.fluxes = (parts.html_pane() for _ in range(4))
        self.at = NumberField(self, "ripple_at_s")
        self.cruise = NumberField(self, "cruise_speed_kmh", check=self._within_top_speed)
        title = load_scenario(MACHINE_SCENARIO).title
        open_one = button(f"Open {title}", lambda _: self.desk.scenario.choose(MACHINE_SCENARIO), margin=(10, 20))
        self.of_example = parts.stack(self.example, open_one, visible=False)
        speed, *others = OF_RUN
        return parts.stack(
            self.of_example,
            self.finding,
            self.numbers,
            self.held,
            self.compared,
            parts.stack(LoopDiagram(), css=DIAGRAM_CSS),
            parts.stack(
                self._column(speed, *OF_TRACKING, *others),
                self._column(MAP, *OF_RIVALS, self.refusals),
                self._column(FLUX, self.cruise, self.fluxes),
                self._column(RIPPLE, self.at, self.account),
                css=LAYOUT_CSS,
            ),
            parts.stack(self.notes, css=":host { padding: 0 20px 16px; }"),
        )

    def _column(self, *content: AnyPlot | Viewable) -> Viewable:
        hosts = (one if isinstance(one, Viewable) else self.host.plots[one.name].host for one in content)
        return parts.stack(*hosts, css=COLUMN_CSS)

    @shows("run", "failure", "scenario")
    def _show_run(self) -> None:
        run, own = self.run, self.desk.scenario.edited
        self.of_example.visible = self.is_example
        self.example.object = parts.note_paragraphs([EXAMPLE_NOTE.format(own.vehicle.name)], "margin:0 20px")
        what = "planned run, simulated with field-oriented control of the motors"
        self.host.heading.object = parts.heading(self.page, scenario_with_motor(own).title, what, "")
        self.host.tell(self.failure, "Shown: the last run that could be computed." if run is not None else "")
        if run is not None:
            self._draw_run(run)

    def _draw_run(self, run: FieldOrientedRun) -> None:
        host = self.host
        host.axis.fit(float(run.time_s[-1]), roomy=False)
        self.at.set_ends((0.0, float(run.time_s[-1])))
        self.cruise.set_ends((1.0, run.scenario.vehicle.traction.max_speed_kmh))
        bands = [(span.start_s, span.end_s) for span in run.saturated]
        host.draw(OF_RUN, {"run": run, "planned": run.planned}, bands)
        self.numbers.object = parts.figures(texts.run_figures(run), self.failure is not None)
        self.held.object = texts.held_words(run)
        self.account.object = texts.parts_table(run)
        self.notes.object = parts.note_paragraphs((*run.planned.notes, *run.notes))

    @shows("run", "rivals")
    def _show_finding(self) -> None:
        run, runs = self.run, self.rivals and self.rivals.runs
        if run is not None:
            # before they come, the last ones are those of another run
            other_flux = runs["other flux"] if runs and runs["run"] is run else None
            self.finding.object = texts.finding(run, other_flux)

    @shows("rivals")
    def _show_rivals(self) -> None:
        rivals = self.rivals
        if rivals is None:
            return
        run, is_compared = rivals.runs["run"], any(name in rivals.runs for name in RIVALS)
        for plot in OF_RIVALS:
            self.host.plots[plot.name].host.visible = is_compared
        bands = [(span.start_s, span.end_s) for span in run.saturated]
        self.host.draw((*OF_TRACKING, *(OF_RIVALS if is_compared else ())), rivals.runs, bands)
        self.compared.object = texts.rivals_table(rivals.runs)
        refused = (words.about(words.STRATEGY_WORDS[name], why) for name, why in rivals.refused.items())
        self.refusals.object = parts.note_paragraphs(refused, "padding-left:6px")

    @shows("machine_map")
    def _show_map(self) -> None:
        if self.machine_map is not None:
            found, points = self.machine_map
            self.host.draw([MAP], found, "motor", points)

    @shows("ripple", "failure")
    def _show_ripple(self) -> None:
        ripple = self.ripple
        # until it is there, its sketch; after an error there will be none
        self.host.plots["ripple"].host.visible = ripple is not None or self.failure is None
        if ripple is not None:
            time_ms = 1e3 * (ripple.time_s - ripple.time_s[0])
            curves = {"switched": (time_ms, ripple.phase_current_a), "averaged": (time_ms, ripple.average_current_a)}
            self.host.draw([RIPPLE], curves)

    @shows("flux_sweep", "failure")
    def _show_flux(self) -> None:
        sweep = self.flux_sweep
        self.host.plots["flux_sweep"].host.visible = self.fluxes.visible = sweep is not None or self.failure is None
        if sweep is None:
            return
        self.fluxes.object = texts.flux_table(sweep)
        current = sweep.values("flux_current_a")
        shares = {
            "efficiency": sweep.values("efficiency"),
            "power factor": sweep.values("power_factor"),
            "loss": sweep.values("loss_w") / sweep.rated.loss_w,
            "voltage": sweep.values("phase_voltage_v") / sweep.max_phase_voltage_v,
        }
        curves = {name: (current, 100 * share) for name, share in shares.items()}
        self.host.draw([FLUX], curves, uprights={"least": sweep.min_loss.flux_current_a})

    def _within_top_speed(self, speed_kmh: float) -> float:
        """Return a speed that was typed; raises ValueError beyond the maximum speed of the vehicle."""
        top = scenario_with_motor(self.desk.scenario.scenario()).vehicle.traction.max_speed_kmh
        if speed_kmh > top:
            raise ValueError(f"At most {top:g}, the maximum speed of the vehicle.")
        return speed_kmh
