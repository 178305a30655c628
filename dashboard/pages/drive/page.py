"""Drive: one run, its numbers, the driving advice, and the charts that explain it."""

import io
from typing import Any

import numpy as np
import panel as pn
import panel_material_ui as pmui
import param
from panel.viewable import Viewable

from railjoule.core import Scenario, TimetableError, Trajectory
from railjoule.core.bounds import with_tighter_bound
from railjoule.core.simulation.actual_run import ActualRun
from railjoule.dashboard.browser import one_message
from railjoule.dashboard.charts.plot import AxisPlot, Plot
from railjoule.dashboard.charts.run_charts import (
    DifferenceChart,
    EffortChart,
    EnergyChart,
    PhaseStrip,
    SupplyChart,
)
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.day import FOLLOWING, LOAD_AND_POSITION
from railjoule.dashboard.look import words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.tokens import NARROW_PX, WIDE_PX
from railjoule.dashboard.page import Own, Page, Request, shows, study, work
from railjoule.dashboard.pages.drive import texts
from railjoule.dashboard.pages.drive.charts import (
    TRAIN,
    DriveSpeedChart,
    LawChart,
    Player,
    PriceChart,
    TrackStrip,
    played_columns,
)
from railjoule.dashboard.pages.drive.compute import (
    Answer,
    Move,
    answer,
    compute_actual,
    compute_moved,
)
from railjoule.dashboard.pages.drive.fields import ActualFields
from railjoule.dashboard.pages.drive.sankey import SankeyChart
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import buttons, menu, over_time_buttons
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.kept import result
from railjoule.dashboard.state.numbers import TypedNumber
from railjoule.dashboard.state.pins import same_run
from railjoule.dashboard.state.recipes import SOLVE, PageRun, actual_run
from railjoule.dashboard.work.runs import (
    FURTHER_BOXES,
    ProofRequest,
    Proven,
    Runs,
    RunsRequest,
    compute_proof,
    compute_runs,
    is_slow,
    same_plan,
)
from railjoule.dashboard.work.simple_advice import choose_simple, compute_simple_advice
from railjoule.dashboard.work.worker import PROOF_THREADS, SLOW_THREADS

REST_MS = 300
"""While a slider moves, each run is replaced before a proof could be of use."""
DAY = tuple(f"desk.day.{name}" for name in (*LOAD_AND_POSITION, *FOLLOWING))
DAY_EVENTS = tuple(f"desk.day.{name}" for name in ("on", "events", "changed", "accepted_delay_s", "reaction"))
SPEED = AxisPlot("speed", DriveSpeedChart, (250, 310, 220))
PRICE = AxisPlot("price", PriceChart, (120, 120, 120))
SCENES = (
    SPEED,
    AxisPlot("phases", PhaseStrip, (26, 26, 26)),
    AxisPlot("line", TrackStrip, (104, 104, 104)),
    AxisPlot("energy", EnergyChart, (140, 140, 140)),
    AxisPlot("difference", DifferenceChart, (92, 92, 92)),
    AxisPlot("effort", EffortChart, (104, 104, 104)),
    AxisPlot("current", SupplyChart, (134, 134, 134)),
    PRICE,
)
LAW = AxisPlot("law", LawChart, (180, 180, 180))
SANKEY = Plot("sankey", "", heights=(300, 300, 340), chart=SankeyChart)
SANKEY_FROM_PX = 1200
"""From this width of the window on, the energy balance is a Sankey diagram; below it, bars."""
MARGIN_PX, NARROW_MARGIN_PX, LEAST_WIDTH_PX = 400, 40, 300
"""Width of the parts beside the charts, and the least width of the charts."""
# the second column of LAYOUT_CSS, 330 px, and the gap of 20 px before it
RAIL_PX = 350
NO_CURRENT = "The current needs the voltage of the line: set it under Edit scenario, Vehicle."
COMPUTING = "Computing simple advice ..."
LAYOUT_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) 330px; padding: 0 20px 12px 14px; column-gap: 20px; }
@media (max-width: 1599px) { :host { grid-template-columns: minmax(0, 1fr); } }
@media (max-width: 899px) { :host { padding: 0 10px 12px 6px; } }
"""
RAIL_CSS = """
:host { border-left: 1px solid var(--rj-line); padding: 4px 0 0 20px; }
@media (max-width: 1599px) { :host { border-left: 0; padding: 4px 6px 0 6px; display: grid;
  grid-template-columns: repeat(auto-fit, minmax(300px, 1fr)); column-gap: 32px; align-items: start; } }
"""
TOOLS_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr); grid-auto-flow: column; align-items: start;
  column-gap: 12px; padding-right: 20px; box-sizing: border-box; }
@media (max-width: 899px) { :host { display: flex; flex-wrap: wrap; padding: 0 14px; } .rj-wide { flex: 1 0 100%; } }
"""
ROW_CSS = ":host { display: flex; flex-wrap: wrap; align-items: center; gap: 4px 16px; padding: 0 6px; }"
WORTH_CSS = ":host { padding: 12px 0 0; }"
WORTH_FIELDS = ("price_per_kwh", "trains_per_day", "co2_kg_per_kwh")
COMPARED = {"Fastest run": "fastest", "Typical driver (set speeds)": "speed_limits", "Pinned run": "pinned"}
"""The runs against which a saving is counted; a typical driver holds one set speed per section."""
FILLED_AFTER_MS = 400
MOVE, NOTHING_MOVED = ("moved_phase", "moved_to_m"), -1
NOTHING_MOVABLE = "No instruction can be moved: this run eases power and brakes gradually."
MOVER_MENU: dict[str, Any] = {"margin": (8, 0), "width": 220, "sizing_mode": "fixed"}
MOVER_CSS = """
:host { display: flex; flex-wrap: wrap; align-items: center; gap: 0 16px; min-height: 56px; padding: 0 6px 0 50px; }
@media (max-width: 899px) { :host { padding: 0 6px; } }
"""
SMALL: dict[str, Any] = {"variant": "text", "size": "small", "margin": 0}


class Drive(Page):
    """The page of one run."""

    page = "Drive"
    kept = ("advice", "supply", "compared", *WORTH_FIELDS)
    passing = ("proving", "proving_further", "has_prices_open", *MOVE)
    may_be_empty = ("moved_to_m",)
    fields = (Own(lambda page: ActualFields(page.desk).view),)
    figures = (*SCENES, LAW, SANKEY)
    rail_px = RAIL_PX

    advice = param.Selector(default="exact", objects=["exact", "simple"], doc="The advice of the run, or simpler one.")
    supply = param.Selector(default="current", objects=["current", "power"], doc="The quantity at the supply.")
    compared = param.Selector(
        default="fastest", objects=list(COMPARED.values()), doc="The run that a saving is against."
    )
    price_per_kwh = TypedNumber("Price per kWh", "", 2, default=0.15, bounds=(0.0, 1000.0))
    trains_per_day = TypedNumber("Trains per day", "", 0, default=300.0, bounds=(0.0, 100_000.0))
    co2_kg_per_kwh = TypedNumber("CO\u2082 per kWh, kg", "kg", 2, default=0.3, bounds=(0.0, 10.0))
    moved_phase = param.Integer(default=NOTHING_MOVED, doc="Index of the phase that begins at another place.")
    moved_to_m = TypedNumber("Begins at, m", "m", 0, default=None, allow_None=True, bounds=(0.0, None))
    has_prices_open = param.Boolean(default=False, doc="Whether the prices that prove the bound are in sight.")
    proving = param.Boolean(default=False, doc="Whether the first stage of the proof is under way.")
    proving_further = param.Boolean(default=False, doc="Whether the second stage is.")
    prove_further = param.Event(doc="The user starts the second stage.")
    actual = result(ActualRun, "The last good actual run.")
    simple = result(Answer, "Simple advice.")
    moved = result(Answer, "The run with a moved instruction.")
    baseline = result(Runs, "The run that a saving is against, where it is not drawn.")
    first_proof = result(Proven, "The last step of the first stage.")
    further_proof = result(Proven, "The last step of the second stage.")

    def __init__(self, desk: Any, **params: Any) -> None:
        super().__init__(desk, **params)
        self.param.watch(self._remember, ["first_proof", "further_proof"])

    def take(self, scenario: Scenario) -> None:
        """Reset the moved instruction, as it belongs to another scenario."""
        self.param.update(moved_phase=NOTHING_MOVED, moved_to_m=None)

    def page_run(self) -> PageRun:
        """Return the plan or the actual run as a program."""
        plan = {"strategy": self.desk.chosen_now}
        day = self.desk.day
        return actual_run(self.desk, {**plan, **day.actual_changes}) if day.on else PageRun(SOLVE, plan)

    def is_over_time(self, axis: str) -> bool:
        """Return whether the figures are over time; else they are over distance."""
        return bool(self.desk.over_time)

    # ---- what it computes

    # the runs too, as they decide the strategy of the plan: `chosen_now`
    @work(
        *("scenario", "desk.chosen", "desk.runs", *DAY, *DAY_EVENTS),
        into="actual",
        marked=True,
        is_slow=lambda scenario, _: is_slow(scenario, scenario.strategy),
    )
    def _actual(self) -> Request:
        desk = self.desk
        if not desk.day.on:
            return None
        changes = {"strategy": desk.chosen_now, **desk.day.actual_changes}
        return compute_actual, desk.scenario.scenario(), changes

    # seconds on a long line: sliders of other pages need not wait for it
    @work("scenario", "advice", into="simple", is_slow=lambda *_: True)
    def _simple(self) -> Request:
        if self.advice == "exact":
            return None
        return answer, compute_simple_advice, self.desk.scenario.scenario()

    # each solves several optima, and a drag asks again and again
    @work("desk.runs", "desk.chosen", "desk.day.on", *MOVE, into="moved", is_slow=lambda *_: True)
    def _moved(self) -> Request:
        run = self._movable
        if run is None or self.moved_phase == NOTHING_MOVED or self.moved_to_m is None:
            return None
        return answer, compute_moved, Move(run, self.moved_phase, float(self.moved_to_m))

    @property
    def _movable(self) -> Trajectory | None:
        """The run whose instructions can be moved: the optimum, while no actual run has a plan of its own."""
        desk = self.desk
        return desk.run if desk.chosen_now == "optimal" and not desk.day.on else None

    @work("scenario", "desk.runs", "compared", into="baseline", is_slow=lambda asked: asked.is_slow)
    def _baseline(self) -> Request:
        runs, name = self.desk.runs, self.compared
        if runs is None or name == "pinned" or name in (*runs.runs, *runs.refused):
            return None
        return compute_runs, RunsRequest(self.desk.scenario.scenario(), ("optimal", name))

    @study("scenario", "desk.runs", into="first_proof", busy="proving", threads=SLOW_THREADS, rest_ms=REST_MS)
    def _first_proof(self) -> Request:
        runs = self.desk.runs
        # what is under way proves a plan that has gone
        if runs is None or runs.to_prove is None or not same_plan(runs.scenario, self.desk.scenario.scenario()):
            return None
        known = self.desk.proof.of(runs.scenario)
        if known is not None and (known.done_boxes > 0 or known.is_complete):
            return None
        return compute_proof, ProofRequest(runs.scenario, runs.to_prove)

    @study("scenario", into="further_proof", busy="proving_further", start="prove_further", threads=PROOF_THREADS)
    def _further_proof(self) -> Request:
        runs = self.desk.runs
        if runs is None or runs.to_prove is None:
            return None
        return compute_proof, ProofRequest(runs.scenario, runs.to_prove, FURTHER_BOXES)

    def _remember(self, event: Any) -> None:
        if event.new is not None:
            known = self.desk.proof.remember(event.new)
            self.desk.take_bound(known.scenario, known.bound)

    # ---- what it shows

    def layout(self) -> Viewable:
        """Make the parts of the page, and return them laid out."""
        plots = self.host.plots
        self.repair = pmui.Button(label="", **{**SMALL, "margin": (0, 20)}, visible=False, on_click=self._repair)
        self.advice_pane = parts.html_pane(css_classes=["rj-wide"])
        self.pin = pmui.Button(label="Pin this advice", **SMALL, visible=False, on_click=self._pin_simple)
        self.card = pmui.FileDownload(
            callback=self._make_card,
            filename="drivers-card.html",
            label="Driver\u2019s card",
            icon="print",
            size="small",
        )
        # as arguments they make Panel warn
        self.card.param.update(variant="text", margin=(8, 0))
        self.supply_buttons = buttons(self, "supply", {"Current": "current", "Power": "power"}, margin=(8, 0))
        self.causes = parts.html_pane(visible=False)
        self.no_current = parts.html_pane(parts.note_paragraphs([NO_CURRENT]), visible=False)
        self.proof, self.account, self.runs, self.phases = (parts.html_pane() for _ in range(4))
        # one button, so that the keyboard's focus stays where it is
        self.prove = pmui.Button(label="Prove further", **SMALL, on_click=self._press_prove)
        self.prices = pmui.Button(
            label="", **SMALL, on_click=lambda _: self.param.update(has_prices_open=not self.has_prices_open)
        )
        self.bellman = pmui.Button(
            label="Compare with dynamic programming",
            **SMALL,
            on_click=lambda _: self.desk.param.update(chosen="bellman"),
        )
        proof = pn.Row(self.prove, self.prices, self.bellman, margin=0, stylesheets=[ROW_CSS])
        for name in ("difference", "law", "price"):
            plots[name].host.visible = False
        self.mover, self.moved_text = parts.stack(), parts.html_pane(sizing_mode=None)
        plots["speed"].moved = self._drag
        beside = {"line": [self.mover], "energy": [self.causes], "current": [self.no_current, self.proof, proof]}
        column = parts.stack(*(one for name, plot in plots.items() for one in (plot.host, *beside.get(name, ()))))
        self.worth, self.saving = parts.stack(css=WORTH_CSS), parts.html_pane()
        rail = parts.stack(self.account, self.worth, self.runs, self.phases, css=RAIL_CSS)
        if pn.state.curdoc is None:
            self._fill_later()
        else:
            # the page itself comes first
            pn.state.curdoc.add_timeout_callback(self._fill_later, FILLED_AFTER_MS)
        tools = pn.Row(
            self.advice_pane,
            self.pin,
            self.card,
            buttons(self, "advice", {"Exact": "exact", "Simple": "simple"}, margin=(8, 0)),
            margin=0,
            sizing_mode="stretch_width",
            stylesheets=[TOOLS_CSS],
        )
        self.player = Player(margin=0, sizing_mode="stretch_width", css_classes=["rj-wide"])
        views = pn.Row(
            self.player,
            over_time_buttons(self.desk, margin=(8, 0)),
            self.supply_buttons,
            margin=0,
            sizing_mode="stretch_width",
            stylesheets=[TOOLS_CSS],
        )
        return parts.stack(self.repair, self.host.figures, tools, views, parts.stack(column, rail, css=LAYOUT_CSS))

    def _drag(self, place: float) -> None:
        run = self._movable
        if run is not None:
            self.moved_to_m = float(np.interp(place, run.time_s, run.position_m)) if self.desk.over_time else place

    def _fill_later(self) -> None:
        """Make the parts that are not needed when the page opens."""
        self.mover_menu = menu(self, "moved_phase", "Move an instruction", {"None": NOTHING_MOVED}, **MOVER_MENU)
        self.moved_field = parts.stack(NumberField(self, "moved_to_m"), visible=False, **MOVER_MENU)
        self.pin_moved = pmui.Button(
            label="Pin the moved run",
            **SMALL,
            visible=False,
            on_click=lambda _: self.desk.pin_moved(
                self.moved.found, self.moved.request.number, self.moved.request.place_m
            ),
        )
        with one_message():
            row = self.mover_menu, self.moved_field, self.moved_text, self.pin_moved
            self.mover[:] = [pn.Row(*row, margin=0, stylesheets=[MOVER_CSS])]
        self._show_moved()
        heading = parts.html_pane("<h2>Saving of a year</h2>")
        fields = [NumberField(self, name, margin=(0, -16)) for name in WORTH_FIELDS]
        with one_message():
            self.worth[:] = [
                heading,
                menu(self, "compared", "Saving against", COMPARED, margin=(8, 0)),
                *fields,
                self.saving,
            ]

    def _make_card(self) -> io.StringIO:
        found = self._shown
        run, sentence, simple = (self.desk.run, "", None) if found is None else self._advised(found[0])
        self.card.filename = f"{words.slug(self.desk.scenario.edited.title) or 'scenario'}-drivers-card.html"
        return io.StringIO("" if run is None else texts.driver_card(run, sentence if simple is not None else ""))

    def _repair(self, *_: Any) -> None:
        failure = self.desk.failure
        if isinstance(failure, TimetableError):
            self.desk.scenario.travel_time_s = failure.min_tenth_s

    def _pin_simple(self, *_: Any) -> None:
        found = self._shown
        if found is not None and self.simple is not None:
            simple = self._advised(found[0])[2]
            if simple is not None:
                self.desk.pin_simple(self.simple.request, simple)

    def _press_prove(self, *_: Any) -> None:
        if self.proving_further:
            self.proving_further = False
        else:
            self.param.trigger("prove_further")

    @shows("failure", "desk.failure", "desk.runs", "desk.day.on")
    def _show_failure(self) -> None:
        """Show why the requested run does not exist, and offer a repair."""
        run, failure = self.desk.run, self.desk.failure
        shown = "" if run is None else f"Shown: the last valid run, {words.number(run.travel_time_s)} s."
        if failure is None and self.desk.day.on and self.failure is not None:
            self.host.tell(self.failure, "Shown: the plan.")
        else:
            self.host.tell(failure, shown)
        self.repair.visible = isinstance(failure, TimetableError)
        if isinstance(failure, TimetableError):
            self.repair.label = f"Use {words.number(failure.min_tenth_s)} s"

    @property
    def _shown(self) -> tuple[Trajectory, Runs, ActualRun | None] | None:
        """The run to show, those beside it, and the actual run; None while there is none, or the actual run is due."""
        run, runs, on = self.desk.run, self.desk.runs, self.desk.day.on and self.failure is None
        if run is None or runs is None:
            return None
        if not on:
            return run, runs, None
        actual = self.actual
        if actual is None or not texts.belongs_to(actual, run):
            return None
        # under target braking curves the actual run has a plan of its own
        return (run if texts.is_same_plan(actual, run) else actual.planned), runs, actual

    def _advised(self, run: Trajectory) -> tuple[Trajectory, str, Any]:
        """Return the run whose advice is shown, a sentence on it, and the simple run if it is one."""
        found = self.simple
        if self.advice == "exact":
            return run, "", None
        # not the run's own scenario: set speeds are driven over one with nodes of its own
        if found is None or self.desk.runs is None or not same_plan(found.request, self.desk.runs.scenario):
            return run, COMPUTING, None
        if found.found is None:
            return run, f"Simple advice {found.refusal}", None
        simple, sentence = choose_simple(found.found)
        if simple is None:
            return run, sentence, None
        return simple.run, " ".join([sentence, *simple.run.notes]), simple

    @shows(
        *("desk.runs", "desk.chosen", "desk.ticked", "desk.pins", "desk.over_time", "desk.day.on"),
        *("actual", "failure", "simple", "advice", "supply", "moved"),
    )
    def _show_run(self) -> None:
        found = self._shown
        if found is None:
            return
        run, runs, actual = found
        desk, host, window_px = self.desk, self.host, self.host.browser.window_width
        narrow = window_px < NARROW_PX
        advised, _, simple = self._advised(run)
        drawn = {name: other for name, other in runs.runs.items() if name in desk.ticked}
        drawn[desk.chosen_now] = run
        width_px = max(window_px - (NARROW_MARGIN_PX if narrow else MARGIN_PX), LEAST_WIDTH_PX)
        scene = RunScene(
            *(desk.chosen_now, drawn, desk.pinned, desk.over_time, narrow, width_px, actual, runs.runs.get("fastest")),
            variant=self._variant(advised, simple),
            with_power=self.supply == "power",
        )
        # narrow windows have no names at the ends of lines, for which the room would be
        host.axis.fit(scene.end, roomy=not narrow)
        has_current, wide = SupplyChart.has_current(run), window_px >= SANKEY_FROM_PX
        self.supply_buttons.visible, self.no_current.visible = has_current, not has_current
        # a picture has even steps: those over places would be uneven over time
        law = None if desk.over_time else runs.law
        pinned = desk.pinned is not None and not same_run(desk.pinned, run)
        for name, visible in {"difference": pinned, "law": law is not None, "sankey": wide}.items():
            host.plots[name].host.visible = visible
        self.account.visible = not wide
        self._show_texts(run, runs, actual)
        host.draw(SCENES, scene)
        if law is not None:
            host.draw([LAW], scene, law)
        if wide:
            host.draw([SANKEY], run, width_px - (RAIL_PX if window_px >= WIDE_PX else 0))

    def _variant(self, advised: Trajectory, simple: Any) -> tuple[str, Trajectory] | None:
        """Return the run to draw beside the chosen one: with a moved instruction, or of simple advice."""
        if self.moved is not None and self.moved.found is not None and self.moved.request.run is self._movable:
            return "moved", self.moved.found
        return None if simple is None else ("simple advice", advised)

    @shows("desk.runs", "desk.chosen", "desk.over_time", "desk.day.on", "actual", "simple", "advice", "player.wanted")
    def _show_player(self) -> None:
        found = self._shown
        if found is None or not self.player.wanted:
            return
        # before the browser puts the train on them
        plots = [self.host.plots[name] for name in ("speed", "line")]
        self.player.param.update(
            run=played_columns(self._advised(found[0])[0]),
            train=[plot.sources[TRAIN].id for plot in plots if plot.figure is not None],
            over_time=self.desk.over_time,
        )

    @shows("desk.runs", "desk.chosen", "desk.over_time", "desk.day.on", *MOVE, "moved")
    def _show_moved(self) -> None:
        if not list(self.mover):
            return
        run, options = self._movable, {"None": NOTHING_MOVED}
        groups = [] if run is None else words.instruction_groups(run.advice)
        for number, (k, *more) in enumerate(groups, 1):
            if run is not None and k and not more and run.phases[k].phase in texts.DOING:
                options[f"{number} {words.PHASE_WORDS[run.phases[k].phase]}"] = k
        # without the row, whose own display would show what is hidden
        self.mover.visible = run is not None
        self.mover_menu.visible = len(options) > 1
        if self.mover_menu.options != options:
            # the instructions of another run have other places
            self.param.update(moved_phase=NOTHING_MOVED, moved_to_m=None)
            self.mover_menu.param.update(options=options, value=NOTHING_MOVED)
        chosen = run is not None and self.moved_phase != NOTHING_MOVED
        if run is not None and chosen and self.moved_to_m is None:
            self.moved_to_m = float(run.phases[self.moved_phase].start_m)
        elif not chosen:
            self.moved_to_m = None
        self.moved_field.visible = chosen
        place_m = self.moved_to_m
        over_time = run is not None and place_m is not None and self.desk.over_time
        x = float(np.interp(place_m, run.position_m, run.time_s)) if run is not None and over_time else place_m
        self.host.plots["speed"].place_switch(x)
        sentence = "Drag the dashed line in the speed figure, or type a place." if chosen else ""
        if len(options) == 1:
            sentence = NOTHING_MOVABLE
        elif chosen and self.moved is not None and self.moved.request.number == self.moved_phase:
            sentence = texts.moved_words(self.moved)
        self.moved_text.object = parts.markup("<p role=status>{}</p>", sentence)
        self.pin_moved.visible = chosen and self.moved is not None and self.moved.found is not None

    @shows(
        *("desk.runs", "desk.chosen", "desk.pins", "desk.day.on", "actual", "baseline", "compared"),
        *WORTH_FIELDS,
    )
    def _show_worth(self) -> None:
        found = self._shown
        if found is None:
            return
        run, runs, _ = found
        known = {**({} if self.baseline is None else self.baseline.runs), **runs.runs, "pinned": self.desk.pinned}
        refused = {**({} if self.baseline is None else self.baseline.refused), **runs.refused}
        name = next(title for title, key in COMPARED.items() if key == self.compared)
        numbers = [float(getattr(self, field)) for field in WORTH_FIELDS]
        self.saving.object = texts.worth(run, known.get(self.compared), name, refused.get(self.compared), *numbers)

    def _show_texts(self, run: Trajectory, runs: Runs, actual: ActualRun | None) -> None:
        subtitle = words.subtitle(run.distance_m, run.scenario.vehicle)
        self.host.heading.object = parts.heading(self.page, run.scenario.title, subtitle, "")
        self.causes.visible = actual is not None
        if actual is not None:
            self.host.figures.object = texts.actual_figures(actual, runs, self.desk.run or run)
            self.causes.object = texts.causes_block(actual)
        advised, sentence, simple = self._advised(run)
        note = parts.markup("{}{}", sentence, info("Simple advice")) if sentence else ""
        self.advice_pane.object = parts.advice(advised, stale=sentence == COMPUTING, note=note)
        pinned = simple is not None and self.desk.find_pin(simple.run) is not None
        self.pin.param.update(
            visible=simple is not None, disabled=pinned, label="Pinned" if pinned else "Pin this advice"
        )
        self.account.object = parts.account(run) if self.account.visible else ""
        self.runs.object = parts.runs_table(runs, run.strategy, self.desk.pins)
        self.phases.object = parts.phase_table(run)

    # a greater bound changes only numbers, and no line is drawn again for it
    @shows(
        *("desk.runs", "desk.chosen", "desk.pins", "desk.tightened", "desk.day.on", "actual", "failure"),
        *("first_proof", "further_proof", "proving", "proving_further", "has_prices_open"),
    )
    def _show_proof(self) -> None:
        found = self._shown
        if found is None:
            return
        run, runs, actual = found
        if actual is None:
            self.host.figures.object = parts.run_figures(runs, run, self.desk.pinned, stale=False)
        known, bound, to_prove = self.desk.proof.of(run.scenario), run.bound, runs.to_prove
        # the bound of a run over other nodes or with a time of its own is another proof
        own = actual is None and bound is not None and to_prove is not None and to_prove.bound is bound
        complete, busy, end = known is not None and known.is_complete, self.proving or self.proving_further, ""
        if own and busy:
            last = self.further_proof if self.proving_further else self.first_proof
            end = texts.progress(None if last is None else last.step)
        elif own and known is not None and complete:
            # a smooth drive has no further proof
            end = texts.EXHAUSTED if known.step.boxes else ""
        elif own and self.failure is not None:
            end = f"The proof has ended: {self.failure}"
        # the plan of an actual run has a looser bound of its own, where it keeps to a braking curve
        best = runs.best.bound
        run = run if actual is None or best is None else with_tighter_bound(run, best)
        self.proof.object = texts.proof_block(run, end, parts.note_paragraphs(run.all_notes))
        self.prove.visible = own and (not complete or busy)
        self.prove.label = "Stop" if self.proving_further else "Prove further"
        # the first stage ends by itself after about half a second
        self.prove.disabled = self.proving
        self.bellman.visible = "bellman" not in self.desk.drawn
        known_price = PriceChart.is_known(run)
        self.prices.visible = known_price
        self.prices.label = f"{'Hide' if self.has_prices_open else 'Show'} price of force"
        self.host.plots["price"].host.visible = self.has_prices_open and known_price
