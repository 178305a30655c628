"""Line: the running time of a whole line, and how its supplement is distributed over the legs between stations."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
from panel.viewable import Viewable

from railjoule.core import RailjouleError, Scenario
from railjoule.core.studies.whole_line import Sharing, WholeLine
from railjoule.dashboard.charts.scene import RunScene
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.look.tokens import NARROW_PX
from railjoule.dashboard.page import BODY_CSS, Page, Request, shows, work
from railjoule.dashboard.pages.line import texts
from railjoule.dashboard.pages.line.charts import ENERGY, PATH, PRICE, SHARING_WORDS, SPEED, SUPPLEMENTS, TRACK
from railjoule.dashboard.pages.line.compute import (
    EXAMPLE,
    EXAMPLE_TITLE,
    LineRuns,
    compute_given,
    compute_line,
    example_scenario,
)
from railjoule.dashboard.pages.line.model import TIMES, LinkedStation, Row, StationModel, station_rows
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import button
from railjoule.dashboard.parts.number_field import number_fields
from railjoule.dashboard.state.kept import Items, result
from railjoule.dashboard.state.recipes import PageRun, Program
from railjoule.dashboard.work.runs import is_slow

WHOLE_LINE = Program(
    {"whole_line": "railjoule.core.studies.whole_line"}, "line = whole_line(scenario)\nprint(line.run.energy_kwh)\n", ""
)
OTHERS: tuple[Sharing, ...] = ("proportional", "equal", "given")
OTHER_WORDS = {"Proportional supplement": "proportional", "Equal supplement": "equal", "Present timetable": "given"}
STATIONS_KEY = "line.stations"
LOWER_CSS = """
:host { padding: 4px 20px 20px 20px; }
@media (max-width: 1099px) { :host { padding: 4px 14px 16px; } }
"""
TABLE_CSS = "th { white-space: normal; vertical-align: bottom; }"
ROW_CSS = """
:host { border-top: 1px solid var(--rj-line); padding: 4px 0; }
@media (min-width: 900px) { :host { display: grid; align-items: start;
  grid-template-columns: minmax(90px, 200px) repeat(4, minmax(90px, 150px)); } }
"""
HEAD_CSS = f"{ROW_CSS} @media (max-width: 899px) {{ :host {{ display: none; }} }}"
CELL_CSS = "@media (min-width: 900px) { .label { position: absolute; clip-path: inset(50%); } }"
"""In a table the head of the column is the label of a field; on narrow screens it stands beside the field."""
NOWRAP = {"& .MuiToggleButton-root": {"whiteSpace": "nowrap"}}
HEAD = ("Station", "Dwell, s", "Earliest arrival, s", "Latest arrival, s", "Present arrival, s")
ARRIVALS_HELP = (
    "The optimum may choose each arrival between the earliest and the latest; two equal times are a fixed arrival. "
    "Present arrivals make a timetable to compare the optimum with; the other arrivals in it are free."
)


class WholeLines(Page):
    """The stations, whose times stand in the scenario, and the runs over the whole line."""

    page = "Line"
    kept = ("stations", "other")
    passing = ("inner_stations", "moving", "moved")
    figures = (SPEED, TRACK, PATH, SUPPLEMENTS, PRICE, ENERGY)

    stations = param.List(
        default=[], item_type=LinkedStation, doc="Stations in a link of an earlier version; never of this page."
    )
    inner_stations = param.List(
        default=[], item_type=StationModel, doc="The stations between the ends, in running order."
    )
    other = param.Selector(
        default="proportional", objects=list(OTHERS), doc="Timetable with which the optimum is compared."
    )
    moving = param.Boolean(default=False, doc="Whether a station is being dragged.")
    moved = param.Tuple(default=None, length=2, allow_None=True, doc="Its number, and the arrival where it is now, s.")
    runs = result(LineRuns, "The last good runs; of the example where the line has no stations.")
    dragged = result((WholeLine, str), "The given timetable of a drag, or the reason against it.")

    def __init__(self, *args: Any, **params: Any) -> None:
        self._items, self._taking = Items(self._take_change), False
        self._before: LineRuns | None = None
        self._refused: RailjouleError | None = None
        self._resting: list[str] = []
        super().__init__(*args, **params)

    # ---- the stations

    def part(self, scenario: Scenario) -> object:
        """Return the stations of a scenario, in running order."""
        return scenario.line.in_running_order().inner_stations

    def take(self, scenario: Scenario) -> None:
        """Give the fields the stations of a scenario."""
        self.param.update(moving=False, moved=None)
        inner = scenario.line.in_running_order().inner_stations
        if [(s.name, s.position_m) for s in inner] != [(s.station, s.position_m) for s in self.inner_stations]:
            self.inner_stations = [StationModel.of(number, station) for number, station in enumerate(inner)]
            return
        with self._quiet():
            for model, station in zip(self.inner_stations, inner, strict=True):
                model.take(station)

    @contextmanager
    def _quiet(self) -> Iterator[None]:
        """Change stations without an edit of the scenario."""
        before, self._taking = self._taking, True
        try:
            yield
        finally:
            self._taking = before

    @param.depends("inner_stations", watch=True)
    def _follow_stations(self) -> None:
        self._items.follow(self.inner_stations, lambda _: TIMES)

    def _take_change(self, *events: Any) -> None:
        """Write the times of a station into the scenario, where every page has them."""
        if self._taking:
            return
        station: StationModel = events[-1].obj
        self._try_edit({station.number: station.row})

    def _try_edit(self, times: Mapping[int, Mapping[str, Any]]) -> None:
        """Write times into the scenario, or show the reason against them."""
        try:
            self.edit(times)
        except RailjouleError as error:
            self.failure = self._refused = error
            self.take(self.desk.scenario.edited)

    def edit(self, times: Mapping[int, Mapping[str, Any]]) -> None:
        """Write times of stations into the scenario.

        Parameters
        ----------
        times : mapping of int to mapping
            The changes, by the keys of the file and the number of the station; None removes a key.

        Raises
        ------
        RailjouleError
            If a time is out of its bounds; then nothing changes.
        """
        scenario = self.desk.scenario
        rows = station_rows(scenario.edited.line, times)
        others = {key: value for key, value in scenario.edits.items() if key != STATIONS_KEY}
        if rows == station_rows(scenario.base.replace(**others).line, {}):
            scenario.take_back(STATIONS_KEY)
        else:
            scenario.edit({STATIONS_KEY: rows})

    def take_over(self, sharing: Sharing | None) -> None:
        """Make the arrivals of a shown run the given timetable; without a run, remove it."""
        arrivals: list[float | None] = [None] * len(self.inner_stations)
        if sharing is not None:
            if self.runs is None:
                return
            arrivals = [round(leg.arrival_s, 1) for leg in self.runs.runs[sharing].legs[:-1]]
        self._try_edit({number: {"arrival_s": arrival} for number, arrival in enumerate(arrivals)})

    def lay(self, values: Mapping[str, Any]) -> None:
        """Take over checked values by field; arrivals that a link of an earlier version fixes go into the scenario.

        Raises
        ------
        ValueError
            If such a link fixes an arrival at a station that is not there.
        RailjouleError
            If the arrival is out of its bounds.
        """
        super().lay({field: value for field, value in values.items() if field != "stations"})
        fixed = [station for station in values.get("stations", ()) if station.get("fixed")]
        if fixed:
            self.edit(self._fixed_by(fixed))

    def _fixed_by(self, stations: Sequence[Mapping[str, Any]]) -> dict[int, Row]:
        inner = self.desk.scenario.edited.line.in_running_order().inner_stations
        numbers = {(s.name, round(s.position_m, 6)): number for number, s in enumerate(inner)}
        times = {}
        for station in stations:
            place = float(station.get("position_m", 0.0))
            number = numbers.get((station.get("station", ""), round(place, 6)))
            if number is None:
                raise ValueError(f"there is no station at {place:g} m to fix an arrival at")
            at = station.get("arrival_s", 0.0)
            times[number] = {"earliest_arrival_s": at, "latest_arrival_s": at}
        return times

    def drag(self, number: int, arrival_s: float) -> None:
        """Show the given timetable with the arrival of a station that is being dragged."""
        if number < len(self.inner_stations):
            self.param.update(moving=True, moved=(number, arrival_s))

    @param.depends("moving", watch=True)
    def _let_go(self) -> None:
        """Write the arrival of the station that was dragged into the scenario: one step to undo."""
        if not self.moving and self.moved is not None:
            (number, arrival_s), self.moved = self.moved, None
            self._try_edit({number: {"arrival_s": arrival_s}})

    # ---- what it computes

    @work("scenario", into="runs", marked=True, is_slow=lambda scenario, _: is_slow(scenario), only_last=False)
    def _runs(self) -> Request:
        scenario = self.desk.scenario.scenario()
        if scenario.line.in_running_order().inner_stations:
            return compute_line, scenario, False
        return compute_line, example_scenario(), True

    @work("moved", into="dragged", only_last=False)
    def _dragged(self) -> Request:
        if self.moved is None or self.runs is None:
            return None
        number, arrival_s = self.moved
        scenario = self.desk.scenario.scenario()
        rows = station_rows(scenario.line, {number: {"arrival_s": arrival_s}})
        return compute_given, scenario, rows

    @param.depends("runs", "dragged", watch=True)
    def _show_given(self) -> None:
        """Compare the optimum with a given timetable that is new; an edit that was refused is past."""
        shown, before = self.shown_runs, self._before
        self._before = shown
        if shown is not None and before is not None and "given" in shown.runs and "given" not in before.runs:
            self.other = "given"
        if self._refused is not None and self._refused is self.failure:
            self.failure = self._refused = None

    @property
    def shown_runs(self) -> LineRuns | None:
        """The runs, with the given timetable of a drag while there is one."""
        runs: LineRuns | None = self.runs
        return runs if runs is None or self.dragged is None else runs.with_drag(self.dragged)

    @property
    def shown_other(self) -> Sharing:
        """The way of sharing beside the optimum: a given timetable only where there is one."""
        shown, other = self.shown_runs, self.other
        return other if shown is not None and other in shown.runs else OTHERS[0]

    def page_run(self) -> PageRun:
        """Return the whole line as a program."""
        # the page divides the time by optima, whatever strategy is chosen
        program_note = "The page compares timetables over the mesh of the scenario, which solve refines for its run."
        return PageRun(WHOLE_LINE, {"strategy": "optimal"}, program_note)

    # ---- what it shows

    def is_over_time(self, axis: str) -> bool:
        """Return that the figures are over positions."""
        return False

    def layout(self) -> Viewable:
        """Make the parts of the page, and return them laid out."""
        self.key, self.verdict, self.notes, self.example = (parts.html_pane() for _ in range(4))
        self.table = parts.html_pane(stylesheets=[parts_css(), TABLE_CSS])
        supplements = self.host.plots[SUPPLEMENTS.name]
        supplements.move, supplements.release = self.drag, lambda: self.param.update(moving=False)
        self.others = pmui.RadioButtonGroup(
            options=OTHER_WORDS, value=self.other, margin=(8, 4, 4, 20), size="small", sx=NOWRAP
        )
        self.others.param.watch(self._choose_other, "value")
        self.open = button(
            f"Open {EXAMPLE_TITLE}", lambda _: self.desk.scenario.choose(EXAMPLE), margin=(0, 20, 10, 20)
        )
        self.take_best, self.take_other, self.take_away = (
            button(label, act, margin=(4, 8, 8, 0))
            for label, act in (
                ("Use the optimal arrivals", lambda _: self.take_over("optimum")),
                ("", lambda _: self.take_over(self.shown_other)),
                ("Remove the present timetable", lambda _: self.take_over(None)),
            )
        )
        self.rows = parts.stack()
        acts = pn.FlexBox(self.take_best, self.take_other, self.take_away, margin=0, sizing_mode="stretch_width")
        title = parts.html_pane('<div class="block"><h2>Timetable of the stations</h2></div>')
        about = parts.html_pane(parts.note_paragraphs([ARRIVALS_HELP]))
        head = parts.stack(
            *(parts.html_pane(parts.markup("<b>{}</b>{}", word, info(word))) for word in HEAD), css=HEAD_CSS
        )
        self.timetable = parts.stack(title, about, acts, head, self.rows)
        body = parts.stack(*(chart.host for chart in self.host.charts), css=BODY_CSS)
        lower = parts.stack(self.table, self.timetable, self.notes, css=LOWER_CSS)
        self.of_example = parts.stack(self.example, self.open)
        return parts.stack(self.of_example, self.verdict, self.host.figures, self.others, self.key, body, lower)

    def _choose_other(self, event: Any) -> None:
        # the rule that is shown while the chosen one is missing is no choice
        if event.new != self.shown_other:
            self.other = event.new

    @shows("inner_stations")
    def _list_stations(self) -> None:
        self.rows[:] = [station_row(station) for station in self.inner_stations]
        self.of_example.visible = not self.inner_stations
        self.timetable.visible = bool(self.inner_stations)
        title = self.desk.scenario.edited.title
        self.example.object = parts.note_paragraphs([texts.EXAMPLE_NOTE.format(title)], "margin:0 20px")

    @shows("runs", "dragged", "failure", "other", "inner_stations", "moving")
    def _show(self) -> None:
        runs, host = self.shown_runs, self.host
        host.tell(self.failure, "Shown: the last runs that could be computed." if runs is not None else "")
        self.take_best.disabled = self.take_other.disabled = runs is None or runs.is_example
        if runs is None:
            return
        other = self.shown_other
        self._show_choices(runs)
        host.axis.fit(runs.best.run.distance_m, roomy=False)
        width = host.browser.window_width
        narrow = width < NARROW_PX
        room = float(width - (90 if narrow else 370))
        host.draw([SPEED], runs, other, room)
        host.draw([TRACK], RunScene("optimal", {"optimal": runs.best.run}, None, False, narrow, room))
        host.draw([PATH], runs, other)
        host.plots[SUPPLEMENTS.name].moving = self.moving
        host.draw([SUPPLEMENTS, PRICE, ENERGY], runs, other, room)
        self._show_texts(runs, other)

    def _show_choices(self, runs: LineRuns) -> None:
        """Offer the comparison with a given timetable if there is one, and the use of the shown times."""
        there = {word: name for word, name in OTHER_WORDS.items() if name in runs.runs}
        if self.others.options != there:
            self.others.options = there
        other = self.shown_other
        if self.others.value != other:
            self.others.value = other
        self.take_other.visible = other != "given"
        self.take_other.label = f"Use the arrivals of the {SHARING_WORDS[other]}"
        self.take_away.visible = any(station.given_s is not None for station in self.inner_stations)

    def _show_texts(self, runs: LineRuns, other: Sharing) -> None:
        self.host.heading.object = texts.heading(runs)
        self.key.object = texts.key_words(runs, other)
        cells = texts.figure_cells(runs)
        if self.moving:
            # the figure must not move away under the hand that drags in it
            self.host.figures.object = parts.figures_in_place(cells, self._resting)
        else:
            self._resting = cells
            self.host.figures.object = parts.figures(cells, self.failure is not None)
            self.verdict.object = parts.finding(*texts.sharing_words(runs))
        self.table.object = texts.legs_table(runs, other)
        self.notes.object = parts.note_paragraphs(texts.missed_words(runs)) + parts.notes(runs.best.run)


def station_row(station: StationModel) -> pn.Column:
    """Return the row of a station in the table: its name and the fields of its times."""
    name = parts.html_pane(parts.markup("<b>{}</b>", station.name_or_number))
    fields = number_fields(station, *TIMES, of=f"{station.name_or_number}: ", info="", stylesheets=[CELL_CSS])
    return parts.stack(name, *fields, css=ROW_CSS)
