"""The tab "Events": unplanned stops and limits, with and without replanning, and a run that plays."""

from functools import partial
from typing import Any

import panel as pn
import param
from panel.viewable import Viewable

from railjoule.core import Scenario, Trajectory
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.live import events_to_keep
from railjoule.dashboard.charts.driven import reality_words
from railjoule.dashboard.day import KIND_WORDS, EventModel, event_model
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.page import Page, Request, shows, study, work
from railjoule.dashboard.pages.what_if.compute import Late, Rides, compute_late_arrivals, compute_rides
from railjoule.dashboard.pages.what_if.live import Live
from railjoule.dashboard.pages.what_if.live_view import BODY_CSS, LivePart, ride_row
from railjoule.dashboard.pages.what_if.load import (
    EVENTS,
    FOLLOWING,
    LAYOUT_CSS,
    LOAD_AND_POSITION,
    conditions,
    is_slow_plan,
    section,
)
from railjoule.dashboard.pages.what_if.rides import ENERGIES, LATE, RIDES, SPEEDS, late_curves, late_ends, saved_by
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import button, buttons, over_time_buttons, remove_button
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.kept import result

FIELDS = {
    "stop": {"position_m": "at, m", "duration_s": "stops for, s"},
    "limit": {"position_m": "from, m", "to_m": "to, m", "limit_kmh": "km/h"},
    "voltage": {"share_percent": "of nominal, %"},
    "recuperation": {"share_percent": "recuperated, %"},
}
"""The fields of each kind of event, with their labels."""
WHO = (
    "Driver: holds the speed or coasts on, brakes for the event, then drives the optimal remainder. Replanned: the "
    "whole remainder is computed again when the event is noticed. With advance notice: the whole run is planned for it."
)
AS_DRIVER = (
    "Every run may arrive {} s late, which the driver does at least: energies of different arrivals do not compare. "
    "Change the accepted delay in the sidebar."
)
NO_EVENT = 'No event yet. Click the speed chart or press "Add a stop".'


class EventsTab(Page):
    """The content of this tab."""

    as_driver = param.Boolean(
        default=False, doc="Whether the accepted delay follows the driver's smallest one, until it is set by hand."
    )
    dropping = param.Selector(
        default="stop", objects=["stop", "limit"], doc="Kind of event that a click on the chart adds."
    )

    rides = result(Rides, "The last good runs.")
    late = result(dict, "Energy over delay so far.")

    def __init__(self, desk: Any, **params: Any) -> None:
        super().__init__(desk, **params)
        self.live = Live(self)
        """The run that plays."""
        self._adopting = False
        # registered before what computes, as the request depends on `as_driver`
        desk.day.param.watch(self._leave_driver, ["events", "accepted_delay_s"])
        self.param.watch(self._adopt_delay, "rides")

    def take(self, scenario: Scenario) -> None:
        """Forget whose delay is accepted: the scenario has one of its own."""
        super().take(scenario)
        self.as_driver = False

    def drop(self, kind: str, place_m: float) -> None:
        """Add an event; after the first one the driver's delay is accepted."""
        day = self.desk.day
        # flat out, each reaction would arrive at another time, and their energies would not compare
        first = not day.events and day.accepted_delay_s == 0
        self.as_driver = self.as_driver or first
        day.drop(kind, place_m)

    def keep_events(self, *_: Any) -> None:
        """Make the events of the run that plays those of the page."""
        run = self.live.run
        if run is not None:
            self.as_driver = False
            self.live.param.update(on=False, playing=False)
            self.desk.day.events = [event_model(event) for event in events_to_keep(run)]

    def _leave_driver(self, *changes: Any) -> None:
        # set by hand, by a link or by a step back
        by_hand = any(change.name == "accepted_delay_s" for change in changes) and not self._adopting
        # an event that is added on Drive must not change its numbers once this page is opened
        if by_hand or self.desk.page != self.page:
            self.as_driver = False

    def _adopt_delay(self, *_: Any) -> None:
        if self.rides is not None and self.rides.as_driver and self.as_driver:
            self._adopting = True
            self.desk.day.accepted_delay_s = self.rides.accepted_s
            self._adopting = False

    def _events(self, as_driver: bool) -> tuple[Any, ...]:
        changes = self.desk.day.event_changes
        # what the driver reaches follows from the rest
        return conditions(self.desk, {**changes, "disturbance.accepted_delay_s": 0.0} if as_driver else changes)

    @work(
        *("scenario", "desk.chosen", *EVENTS, *LOAD_AND_POSITION, *FOLLOWING),
        into="rides",
        marked=True,
        is_slow=is_slow_plan,
        only_last=False,
        tab=RIDES,
    )
    def _rides(self) -> Request:
        return compute_rides, *self._events(self.as_driver), self.as_driver

    # the curve of all accepted delays
    @study("rides", into="late", tab=RIDES)
    def _late(self) -> Request:
        known = self.rides is not None and self.desk.day.events
        return (compute_late_arrivals, *self._events(as_driver=True)) if known else None

    # ---- what it shows

    def layout_events(self) -> Viewable:
        """Return the parts of the tab, laid out."""
        day, plots = self.desk.day, self.host.plots
        self.arrivals, self.reactions, self.remarks = (parts.html_pane() for _ in range(3))
        plots["ride_speed"].press = lambda place_m: self.drop(self.dropping, place_m)
        self.invitation = parts.html_pane(
            parts.markup('<p role="status" style="padding:10px 20px 0;font-size:13.5px">{}</p>', NO_EVENT),
            visible=False,
        )
        drops = {"Click adds a stop": "stop", "Click adds a limit": "limit"}
        tools = pn.Row(
            buttons(self, "dropping", drops, margin=(8, 8, 0, 20)),
            button("Add a stop", lambda _: self.drop("stop", day.free_m()), margin=(8, 0, 0, 12), height=28),
            pn.Spacer(sizing_mode="stretch_width"),
            over_time_buttons(self.desk, margin=(8, 20, 0, 20)),
            margin=0,
            sizing_mode="stretch_width",
            stylesheets=[parts.WRAP_CSS],
        )
        self.reacting = parts.stack(self.reactions, self.remarks)
        lower = parts.stack(self.reacting, plots["late_arrival"].host, css=LAYOUT_CSS)
        body = parts.stack(plots["ride_speed"].host, plots["ride_energy"].host, css=BODY_CSS)
        self.before = parts.stack(self.invitation, self.arrivals, tools, body, lower)
        self.playing = LivePart(self.live, self.host, self.keep_events)
        modes = {"Events before the start": False, "Events while the train drives": True}
        return parts.stack(buttons(self.live, "on", modes, margin=(8, 8, 4, 20)), self.before, self.playing.view)

    def layout_event_fields(self) -> Viewable:
        """Return its part of the sidebar."""
        day = self.desk.day
        self.list = parts.stack()
        small: dict[str, Any] = {"variant": "text", "margin": (0, 2)}
        adders = [
            button(f"+ {word.lower()}", partial(self._drop_in_middle, kind), **small)
            for kind, word in KIND_WORDS.items()
        ]
        day.param.watch(self._list_events, "events")
        self._list_events()
        return parts.stack(
            section("Events", "click the speed chart to add one"),
            self.list,
            pn.FlexBox(*adders, margin=(4, 8)),
            NumberField(day, "accepted_delay_s"),
        )

    def _drop_in_middle(self, kind: str, *_: Any) -> None:
        self.drop(kind, self.desk.scenario.base.line.length_m / 2)

    def _list_events(self, *_: Any) -> None:
        self.list[:] = [self._event_fields(number, event) for number, event in enumerate(self.desk.day.events, 1)]

    def _event_fields(self, number: int, event: EventModel) -> Viewable:
        name = f"{number} {KIND_WORDS[event.kind]}"
        labels = {**FIELDS[event.kind], "noticed_at_m": "noticed at, m"}
        head = pn.Row(
            parts.html_pane(parts.markup('<div class="row"><b>{}</b></div>', name), align="center"),
            remove_button(name, lambda _: self.desk.day.remove(event)),
            margin=(4, 8, 0, 0),
            sizing_mode="stretch_width",
        )
        fields = (NumberField(event, field, label=label, of=f"{name}: ") for field, label in labels.items())
        return parts.stack(head, *fields)

    @shows("live.on", tab=RIDES)
    def _show_mode(self) -> None:
        self.before.visible, self.playing.view.visible = not self.live.on, self.live.on

    @shows("desk.over_time", "rides", "failure", *EVENTS, tab=RIDES)
    def _show_rides(self) -> None:
        rides, events, over_time = self.rides, self.desk.day.events, self.desk.over_time
        none = not events
        self.invitation.visible, self.arrivals.visible = none, not none
        self.reacting.visible = self.host.plots["late_arrival"].host.visible = not none
        if rides is None:
            return
        runs = {"undisturbed": rides.undisturbed} if none else drawn(rides)
        ends = [run.time_s[-1] if over_time else run.position_m[-1] for run in runs.values()]
        self.host.axes[RIDES].fit(float(max(ends)), roomy=False)
        self.host.draw([SPEEDS], runs, list(events), over_time)
        self.host.draw([ENERGIES], runs, over_time)
        self.arrivals.object = parts.figures(event_figures(rides), self.failure is not None)
        alike = [AS_DRIVER.format(words.number(rides.accepted_s))] if rides.as_driver and rides.accepted_s else []
        self.remarks.object = parts.note_paragraphs([*limits_kept(rides), *alike, WHO])

    @shows("rides", "late", tab=RIDES)
    def _show_late(self) -> None:
        if self.rides is None:
            return
        self.reactions.object = reaction_table(self.rides, self.late)
        if self.late is None:
            return
        curves = late_curves(self.late, self.rides)
        ends = late_ends(curves)
        if ends is not None:
            self.host.draw([LATE], curves, x_ends=ends[0], y_ends=ends[1])

    @shows("live.planned", tab=RIDES)
    def _show_plan(self) -> None:
        self.playing.show_plan()

    @shows("live.playing", "live.failure", "live.ended", tab=RIDES)
    def _show_controls(self) -> None:
        self.playing.show_controls()

    @shows("live.ended", tab=RIDES)
    def _show_result(self) -> None:
        self.playing.show_result()

    def events_words(self) -> str:
        """Return the text below the heading."""
        day, scenario = self.desk.day, self.desk.scenario.scenario()
        count = len(day.events)
        also = ""
        if day.on:
            also = f"; {reality_words(day.actual_load_percent / 100, day.coordinate_error_m)} as on Drive"
        planned = words.STRATEGY_WORDS[self.desk.chosen]
        return (
            f"{words.distance(scenario.line.length_m)} km in {words.time(scenario.travel_time_s)} s, {count or 'no'} "
            f"event{'' if count == 1 else 's'} on the way, planned with: {planned}{also}"
        )


# ---- texts


def drawn(rides: Rides) -> dict[str, Trajectory]:
    """Return the runs to draw by the names of their lines."""
    return {"undisturbed": rides.undisturbed, **{name: ride.actual for name, ride in rides.rides.items()}}


def event_figures(rides: Rides) -> list[str]:
    """Return the numbers of the runs: how late the driver is, and the energy of all at their arrivals."""
    # the names are in the order of REACTION_WORDS
    driver, computer, known = (rides.rides[one] for one in words.REACTION_WORDS)
    return [
        driver_figure(driver, rides.undisturbed.energy_kwh),
        beside_driver(computer, driver, "Replanning"),
        beside_driver(known, driver, "Advance notice"),
    ]


def driver_figure(driver: DisturbedRun, planned_kwh: float) -> str:
    """Return the driver's miss of timetable or stop; without one the extra energy against the undisturbed run."""
    by_driver = driver.actual.energy_kwh
    missed = comparisons.misses(driver.delay_s, driver.stop_error_m)
    detail = f"{words.energy(by_driver)} kWh, undisturbed {words.energy(planned_kwh)}"
    if missed:
        first, *others = missed
        return parts.figure("Driver", *first, "; ".join([*map(str, others), detail]), "main")
    spent, more = comparisons.saving(by_driver, planned_kwh)
    return parts.figure("Extra energy, driver" if spent == "costs" else "Energy saved, driver", *more, detail, "main")


def saved_beside(ride: DisturbedRun, driver: DisturbedRun) -> tuple[str, comparisons.Amount]:
    """Return whether a reaction saves some of the driver's energy, and how much; kWh if it is later or off the stop."""
    own, by_driver = ride.actual.energy_kwh, driver.actual.energy_kwh
    verb, saved = comparisons.saving(own, by_driver)
    if verb == "costs":
        return verb, comparisons.Amount(saved.value, f"{saved.unit} more")
    if comparisons.is_false_saving(own, by_driver, ride.delay_s - driver.delay_s, ride.stop_error_m):
        return "needs", comparisons.Amount(words.energy(by_driver - own), "kWh less")
    return verb, saved


def beside_driver(ride: DisturbedRun, driver: DisturbedRun, what: str) -> str:
    """Return the share of the driver's energy that a reaction saves, as a number with its arrival."""
    verb, saved = saved_beside(ride, driver)
    than = "of" if verb == "saves" else "than"
    whole = f"{saved} {than} the driver\u2019s {words.energy(driver.actual.energy_kwh)} kWh"
    detail = f"{words.energy(ride.actual.energy_kwh)} kWh, arrives {comparisons.arrival(ride.delay_s - driver.delay_s)}"
    term = "Replanning" if what == "Replanning" else "With advance notice"
    return parts.figure(f"{what} {verb}", *saved, detail, whole=whole, term=term)


def finding(rides: Rides, events: int) -> parts.Markup:
    """Return in a sentence what the events cost the driver, and what a better reaction would save."""
    driver, computer, known = (rides.rides[one] for one in words.REACTION_WORDS)
    missed = " and ".join(map(str, comparisons.misses(driver.delay_s, driver.stop_error_m))) or "on time"
    energy, planned = words.energy(driver.actual.energy_kwh), words.energy(rides.undisturbed.energy_kwh)
    count = "1 event" if events == 1 else f"{events} events"
    better = {"Replanning on the way": computer, "advance notice": known}
    saves = [" ".join(map(str, (name, *saved_beside(ride, driver)))) for name, ride in better.items()]
    cost = f"With {count} the driver arrives {missed} and needs {energy} kWh instead of {planned}."
    return parts.finding(cost, f"{', '.join(saves)}.".replace(" %", "\u00a0%"))


def reaction_table(rides: Rides, late: Late | None) -> str:
    """Return energies and arrivals of all runs, and the energy that the first seconds of delay save."""
    planned, nothing = rides.undisturbed, words.UNKNOWN
    top = words.number(planned.max_speed_kmh)
    rows: list[tuple[tuple[str, ...], bool]] = [((*ride_row("Undisturbed", planned, None), top, nothing), False)]
    for reaction, name in words.REACTION_WORDS.items():
        ride = rides.rides[reaction]
        saved = saved_by(late, reaction) if late is not None and reaction in late else nothing
        cells = (*ride_row(name, planned, ride), words.number(ride.actual.max_speed_kmh), saved)
        rows.append((cells, reaction == "computer"))
    header = ("Run", "kWh", "more, %", "late, s", "top, km/h", "saved per extra second, Wh")
    return parts.inset(parts.table("Runs by reaction", header, rows))


def limits_kept(rides: Rides) -> list[str]:
    """Return the notes of all runs, each sentence once, with the names of its runs."""
    who: dict[str, list[str]] = {}
    for reaction, ride in rides.rides.items():
        for note in ride.notes:
            who.setdefault(note, []).append(words.REACTION_WORDS[reaction])
    return [
        note if len(names) == len(rides.rides) else f"{' and '.join(names)}: {note[0].lower()}{note[1:]}"
        for note, names in who.items()
    ]
