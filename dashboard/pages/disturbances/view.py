"""Disturbances: events on the way, who reacts how, and what catching up costs."""

from functools import partial

import panel as pn
import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.core import Trajectory
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.dashboard.charts.chart import Axis, Chart
from railjoule.dashboard.charts.driven import reality_words
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.theme import padded
from railjoule.dashboard.pages.disturbances.charts import LateChart, RideSpeedChart, ride_energy_chart, saved_by
from railjoule.dashboard.pages.disturbances.compute import Rides
from railjoule.dashboard.pages.disturbances.live_view import LivePart
from railjoule.dashboard.pages.disturbances.live_work import Live
from railjoule.dashboard.pages.disturbances.work import Disturbances
from railjoule.dashboard.pages.page import PageView
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import buttons, over_time_buttons

HEIGHTS = {
    "ride_speed": (300, 380, 240),
    "ride_energy": (170, 200, 150),
    "late_arrival": (240, 280, 210),
    "live_speed": (300, 380, 240),
}
"""Of each chart [px]: in usual, wide and narrow windows."""
BODY_CSS = padded("4px 20px 12px 14px", "4px 10px 12px 6px")
LOWER_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); column-gap: 28px; align-items: start; }
@media (max-width: 1099px) { :host { grid-template-columns: minmax(0, 1fr); } }
"""
WHO = (
    "Driver: holds the speed or coasts on, brakes for the event, then drives the optimal remainder. Replanned: the "
    "whole remainder is computed again when the event is noticed. With advance notice: the whole run is planned for it."
)
AS_DRIVER = (
    "Every run may arrive {} s late, which the driver does at least: energies of different arrivals do not compare. "
    "Change the accepted delay in the sidebar."
)
NO_EVENT = 'No event yet. Click the speed chart or press "Add a stop".'


class DisturbancesView(PageView):
    """The page of what happens on the way."""

    page = "Disturbances"
    works = (Disturbances, Live)
    heights = HEIGHTS

    def make(self) -> Viewable:
        """Make the pieces of the page, and return them laid out."""
        state, palette = self.state, self.palette
        self.model = model = state.disturbances
        self.table, self.notes = (parts.html_pane() for _ in range(2))
        events = {"Click adds a stop": "stop", "Click adds a limit": "limit"}
        self.dropping = buttons(model, "dropping", events, margin=(8, 8, 0, 20))
        self.over = over_time_buttons(state, margin=(8, 20, 0, 0))
        self.axis = Axis(palette)
        self.speed = RideSpeedChart(HEIGHTS["ride_speed"][0], self.axis, palette, self._drop)
        self.energy = ride_energy_chart(HEIGHTS["ride_energy"][0], self.axis, palette)
        self.late = LateChart(HEIGHTS["late_arrival"][0], palette)
        self.add = pmui.Button(
            label="Add a stop",
            variant="outlined",
            size="small",
            margin=(8, 0, 0, 12),
            height=28,
            on_click=lambda _: state.day.add_stop(),
        )
        self.invitation = parts.html_pane(
            parts.markup('<p role="status" style="padding:10px 20px 0;font-size:13.5px">{}</p>', NO_EVENT),
            visible=False,
        )
        spacer = pn.Spacer(sizing_mode="stretch_width")
        tools = pn.Row(self.dropping, self.add, spacer, self.over, margin=0, stylesheets=[parts.WRAP_CSS])
        tools.sizing_mode = "stretch_width"
        self.reactions = parts.stack(self.table, self.notes)
        self.modes = buttons(
            state.live,
            "on",
            {"Events before the start": False, "Events while the train drives": True},
            margin=(8, 8, 4, 20),
        )
        self.live = LivePart(state, palette, HEIGHTS["live_speed"][0])
        lower = parts.stack(self.reactions, self.late.host, css=LOWER_CSS)
        body = parts.stack(self.speed.host, self.energy.host, lower, css=BODY_CSS)
        self.shows(self._show, (state, ["over_time"]), (model, ["rides", "failure"]), (state.day, ["events"]))
        self.shows(self._show_late, (model, ["late"]))
        self.before = parts.stack(self.message, self.invitation, self.figures, tools, body)
        live = state.live
        self.shows(self._show_mode, (live, ["on"]))
        self.shows(self.live.show_plan, (live, ["planned"]))
        self.shows(self.live.show_controls, (live, ["playing", "failure", "ended"]))
        self.shows(self.live.show_result, (live, ["ended"]))
        # not `shows`: a tenth of a second is too short to settle all charts
        live.param.watch(self.live.move, "run")
        self.browser.follow(["hidden"], self._pause)
        return parts.stack(self.heading, self.modes, self.before, self.live.view)

    def _show_mode(self) -> None:
        self.before.visible, self.live.view.visible = not self.state.live.on, self.state.live.on

    def _pause(self) -> None:
        if self.browser.hidden:
            self.state.live.playing = False

    @property
    def charts(self) -> tuple[Chart, ...]:
        """All charts of the page."""
        return self.speed, self.energy, self.late, self.live.chart

    def _drop(self, place_m: float) -> None:
        self.state.day.drop(self.model.dropping, place_m)

    def settle(self) -> None:
        """Tell the cursor of the rides that it may meet new charts."""
        self.axis.settle_over(self.state.over_time)
        self.live.axis.settle_over(False)

    def _show(self) -> None:
        rides = self.model.rides
        self.tell(self.model.failure, "Shown: the last runs that could be computed." if rides is not None else "")
        none = not self.state.day.events
        self.invitation.visible, self.figures.visible = none, not none
        self.reactions.visible = self.late.host.visible = not none
        if rides is None:
            return
        over_time = self.state.over_time
        runs = {"undisturbed": rides.undisturbed} if none else drawn(rides)
        ends = [run.time_s[-1] if over_time else run.position_m[-1] for run in runs.values()]
        self.axis.fit(float(max(ends)), roomy=False)
        self.speed.show(partial(self.speed.draw, runs, list(self.state.day.events), over_time))
        self.energy.show(partial(self.energy.draw, runs, over_time))
        self._draw_late(rides)
        self._show_texts(rides)

    def _show_late(self) -> None:
        rides = self.model.rides
        if rides is not None:
            self._draw_late(rides)
            self.table.object = self._table(rides)

    def _draw_late(self, rides: Rides) -> None:
        if self.model.late is not None:
            present = [(ride.delay_s, ride.actual.energy_kwh) for ride in rides.rides.values()]
            self.late.show(partial(self.late.draw, self.model.late, present))

    def _show_texts(self, rides: Rides) -> None:
        planned = rides.undisturbed
        scenario = planned.scenario
        what = (
            f"{words.distance(planned.distance_m)} km in {words.time(scenario.travel_time_s)} s, "
            f"{len(self.state.day.events) or 'no'} event{'' if len(self.state.day.events) == 1 else 's'} on the way, "
            f"planned with: {words.STRATEGY_WORDS[planned.strategy]}{self._day()}"
        )
        self.heading.object = parts.heading(self.page, scenario.title, what, "")
        self.figures.object = parts.figures(self._cells(rides), self.model.failure is not None)
        self.table.object = self._table(rides)
        alike = [AS_DRIVER.format(words.number(rides.accepted_s))] if rides.as_driver and rides.accepted_s else []
        self.notes.object = parts.note_paragraphs([*told(rides), *alike, WHO])

    def _day(self) -> str:
        """Return what else differs from the plan, where the actual run on Drive is switched on."""
        if not self.state.day.on:
            return ""
        reality = self.state.day
        return f"; {reality_words(reality.actual_load_percent / 100, reality.coordinate_error_m)} as on Drive"

    def _cells(self, rides: Rides) -> list[str]:
        # the names are in the order of REACTION_WORDS
        planned, driver, computer, known = rides.undisturbed, *(rides.rides[one] for one in words.REACTION_WORDS)
        return [
            driver_figure(driver, planned.energy_kwh),
            replanning_figure(computer, driver),
            parts.figure("With advance notice", words.energy(known.actual.energy_kwh), "kWh", "planned from the start"),
            self._arrival("Driver arrives", driver),
            self._arrival("Replanned run arrives", computer),
            self._arrival("With notice arrives", known),
        ]

    @staticmethod
    def _arrival(label: str, ride: DisturbedRun) -> str:
        late = ride.delay_s
        return parts.figure(
            label,
            words.delay(late),
            "s",
            "late" if late >= 0.05 else "early" if late <= -0.05 else "on time",
            term="Delay",
        )

    def _table(self, rides: Rides) -> str:
        planned, late = rides.undisturbed, self.model.late
        rows: list[tuple[tuple[str, ...], bool]] = [
            (
                (
                    "Undisturbed",
                    words.energy(planned.energy_kwh),
                    comparisons.NOTHING.cell,
                    words.delay(0.0),
                    words.number(planned.max_speed_kmh),
                    "\u2013",
                ),
                False,
            )
        ]
        for reaction, name in words.REACTION_WORDS.items():
            ride = rides.rides[reaction]
            price = saved_by(late, reaction) if late is not None and reaction in late.energy_kwh else "\u2013"
            cells = (
                name,
                words.energy(ride.actual.energy_kwh),
                comparisons.extra(ride.actual.energy_kwh, planned.energy_kwh, ride.delay_s, ride.stop_error_m).cell,
                words.delay(ride.delay_s),
                words.number(ride.actual.max_speed_kmh),
                price,
            )
            rows.append((cells, reaction == "computer"))
        header = ("Run", "kWh", "more, %", "late, s", "top, km/h", "saved per extra second, Wh")
        return parts.inset(parts.table("Who reacts", header, rows))


def driver_figure(driver: DisturbedRun, planned_kwh: float) -> str:
    """Return what the driver's ride needs more than the undisturbed one, or saves in time."""
    by_driver, missed = driver.actual.energy_kwh, (driver.delay_s, driver.stop_error_m)
    detail = f"{words.energy(by_driver)} kWh, undisturbed {words.energy(planned_kwh)}"
    if comparisons.is_false_saving(by_driver, planned_kwh, *missed):
        amount, detail = comparisons.headline(by_driver, planned_kwh, *missed, detail)
        return parts.figure("Driver", *amount, detail, "main", term="Extra energy, driver")
    spent, more = comparisons.saving(by_driver, planned_kwh)
    return parts.figure("Extra energy, driver" if spent == "costs" else "Energy saved, driver", *more, detail, "main")


def replanning_figure(computer: DisturbedRun, driver: DisturbedRun) -> str:
    """Return what replanning saves of the driver's energy; where it arrives later or misses the stop, how much less."""
    by_computer, by_driver = computer.actual.energy_kwh, driver.actual.energy_kwh
    later_s, energy = computer.delay_s - driver.delay_s, f"{words.energy(by_driver)} kWh"
    verb, saved = comparisons.saving(by_computer, by_driver)
    label, unit, than = f"Replanning {verb}", saved.unit, "of"
    if verb == "costs":
        unit, than = f"{saved.unit} more", "more than"
    elif comparisons.is_false_saving(by_computer, by_driver, later_s, computer.stop_error_m):
        saved = comparisons.Amount(words.energy(by_driver - by_computer), "kWh")
        label, unit, than = "Replanning needs", "kWh less", "less than"
    whole = f"{saved} {than} the driver\u2019s {energy}"
    detail = f"arrives {comparisons.arrival(later_s)}"
    return parts.figure(label, saved.value, unit, detail, whole=whole, term="Replanning")


def told(rides: Rides) -> list[str]:
    """Return what could not be kept, each sentence with the names of those whom it is about."""
    who: dict[str, list[str]] = {}
    for reaction, ride in rides.rides.items():
        for note in ride.notes:
            who.setdefault(note, []).append(words.REACTION_WORDS[reaction])
    return [
        note if len(names) == len(rides.rides) else f"{' and '.join(names)}: {note[0].lower()}{note[1:]}"
        for note, names in who.items()
    ]


def drawn(rides: Rides) -> dict[str, Trajectory]:
    """Return the runs to draw by the names of their lines."""
    return {"undisturbed": rides.undisturbed, **{name: ride.actual for name, ride in rides.rides.items()}}
