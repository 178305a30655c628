"""The tab "Two scenarios" of Compare: a second scenario, the runs of both in two columns, and their numbers."""

from functools import cache
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
from panel.viewable import Viewable

from railjoule.core import RailjouleError, Scenario, load_scenario
from railjoule.core.scenario import format_scenario, preset_names
from railjoule.core.scenario.presets import preset_document
from railjoule.core.scenario.scenario import Timetable
from railjoule.dashboard.charts.quantities import along
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.side_by_side import HEAD, lengths_differ, pair_names, pair_rows, scenarios_differ
from railjoule.dashboard.page import Page, Request, shows, study
from railjoule.dashboard.pages.compare.charts import AXIS, FIRST, PAIR_PLOTS, SECOND, TOKENS
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import over_time_buttons
from railjoule.dashboard.parts.number_field import NumberField
from railjoule.dashboard.state.kept import result
from railjoule.dashboard.state.numbers import keyed
from railjoule.dashboard.work.pair import (
    KINDS,
    NOTHING,
    SCENARIO,
    TIME,
    TRAIN,
    Pair,
    PairRequest,
    SecondScenario,
    compute_pair,
)
from railjoule.dashboard.work.worker import SLOW_THREADS

STRATEGIES_TAB, PAIR_TAB = "strategies", "scenarios"
PAIR_FIELDS = ("second", "second_from", "second_time_s")
LONGER = 1.1
"""The second travel time is this multiple of the first where none is given."""
HELD = "held"
"""The entry of the menu for a scenario whose text the page holds: of a pin, a file or a link."""
INVITATION = (
    "Choose a second scenario: another train or another travel time on this line, a shipped scenario, that of a pinned "
    "run, or one of My files. Its run by the same strategy then stands beside the first, over the same axes and with "
    "one cursor."
)
COLUMNS_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); column-gap: 28px;
  padding: 4px 20px 8px 14px; align-items: start; }
@media (max-width: 899px) { :host { grid-template-columns: minmax(0, 1fr); padding: 4px 10px 8px 6px; } }
"""


class PairTab(Page):
    """The content of this tab."""

    may_be_empty = ("second_time_s",)

    second = param.Selector(default=NOTHING, objects=list(KINDS), doc="Changes of the second scenario.")
    second_from = param.String(default="", doc="Name of the second train or scenario, or the text of a scenario.")
    second_time_s = keyed(Timetable, "travel_time_s", "Second travel time", "s", 1, allow_None=True, step=0.5)
    pair = result(Pair, "The last runs of both scenarios.")

    @property
    def second_scenario(self) -> SecondScenario | None:
        """How the second scenario comes about; None where there is none."""
        if self.second == NOTHING:
            return None
        time_s = self.longer_time_s if self.second_time_s is None else float(self.second_time_s)
        return SecondScenario(self.second, self.second_from, time_s)

    @property
    def longer_time_s(self) -> float:
        """The second travel time where none is given [s]."""
        return float(round(LONGER * self.desk.scenario.travel_time_s, 1))

    def part(self, scenario: Scenario) -> object:
        """Return the part of a scenario to which the second travel time belongs."""
        return scenario.timetable

    def take(self, scenario: Scenario) -> None:
        """Forget the second travel time of another scenario."""
        self.second_time_s = None

    # ---- what it computes

    @study("desk.runs", "desk.chosen", *PAIR_FIELDS, into="pair", marked=True, threads=SLOW_THREADS, tab=PAIR_TAB)
    def _pair(self) -> Request:
        runs, second = self.desk.runs, self.second_scenario
        if runs is None or second is None:
            return None
        return compute_pair, PairRequest(runs, second, self.desk.chosen_now, self.pair)

    # ---- what it shows

    def layout_pair(self) -> Viewable:
        """Return the parts of the tab, laid out."""
        self.pair_figures, self.pair_words, self.pair_table = (parts.html_pane() for _ in range(3))
        self.second_menu = pmui.Select(
            label="Second scenario",
            groups=self._groups(),
            value=self._entry,
            size="small",
            margin=(10, 12, 0, 20),
            width=330,
        )
        self.second_menu.param.watch(self._choose_second, "value")
        ends = self.desk.scenario.travel_time_range_s
        self.second_time = NumberField(self, "second_time_s", ends=ends, max_width=360, visible=False)
        tools = pn.FlexBox(
            self.second_menu,
            over_time_buttons(self.desk, margin=(16, 20, 0, 20)),
            align_items="flex-start",
            margin=(0, 0, 12, 0),
            sizing_mode="stretch_width",
        )
        # the grid's own display would show it although it is not visible
        columns = parts.stack(*(self.host.plots[plot.name].host for plot in PAIR_PLOTS), css=COLUMNS_CSS)
        self.pair_columns = parts.stack(columns, visible=False)
        self.desk.files.look()
        return parts.stack(
            tools, self.second_time, self.pair_figures, self.pair_words, self.pair_columns, self.pair_table
        )

    def _choose_second(self, event: Any) -> None:
        """Take the entry of the menu that the user has chosen."""
        kind, _, name = str(event.new).partition(":")
        if event.new == self._entry:
            return
        if kind in {"train-of", "file"}:
            of = TRAIN if kind == "train-of" else SCENARIO
            self.desk.files.read(name, lambda toml: self._set_second(of, toml), self._refuse)
        elif kind == "pin":
            pin = next(pin for pin in self.desk.pins if pin.colour == name)
            self._set_second(SCENARIO, format_scenario(pin.trajectory.scenario))
        elif kind != HELD:
            self._set_second(kind, name)

    def _set_second(self, kind: str, source: str) -> None:
        self.param.update(second=kind, second_from=source)

    def _refuse(self, error: RailjouleError) -> None:
        self.desk.notice = str(error)
        self._show_menu()

    @property
    def _entry(self) -> str:
        """The entry of the menu for what is set."""
        if self.second in {NOTHING, TIME}:
            return f"{self.second}:"
        known = preset_names("vehicles" if self.second == TRAIN else "scenarios")
        return f"{self.second}:{self.second_from}" if self.second_from in known else HELD

    def _groups(self) -> dict[str, dict[str, str]]:
        """Return the entries of the menu by the titles of their groups."""
        begin = {"Nothing": f"{NOTHING}:"}
        if self._entry == HELD:
            title = "Untitled" if self.pair is None else words.title(self.pair.second.scenario.title)
            begin[f"Train of a scenario: {title}" if self.second == TRAIN else title] = HELD
        listing = self.desk.files.listing
        names = [] if listing is None else [file.name for file in listing.files if not file.refusal]
        groups = {
            "Beside this scenario": begin,
            "This line, another train": {**trains(), **{f"Train of {name}": f"train-of:{name}" for name in names}},
            "This train, another time": {"Another travel time": f"{TIME}:"},
            "Scenarios of pinned runs": {f"{pin.number} {pin.name}": f"pin:{pin.colour}" for pin in self.desk.pins},
            "My files": {name: f"file:{name}" for name in names},
            "Shipped scenarios": shipped_titles(),
        }
        return {title: entries for title, entries in groups.items() if entries}

    @shows(*PAIR_FIELDS, "pair", "desk.pins", "desk.files.listing", tab=PAIR_TAB)
    def _show_menu(self) -> None:
        groups, entry = self._groups(), self._entry
        if (self.second_menu.groups, self.second_menu.value) != (groups, entry):
            # both together, as a value must be among the options
            self.second_menu.param.update(groups=groups, value=entry)
        self.second_time.visible = self.second == TIME

    @shows("desk.scenario.travel_time_range_s", "desk.scenario.travel_time_s", "second_time_s", tab=PAIR_TAB)
    def _show_time(self) -> None:
        self.second_time.suggest(self.longer_time_s)
        self.second_time.set_ends(self.desk.scenario.travel_time_range_s)

    @shows("pair", "desk.over_time", "second", tab=PAIR_TAB)
    def _show_pair(self) -> None:
        pair = self.pair
        self.pair_columns.visible = pair is not None
        if pair is None:
            invitation = "" if self.second != NOTHING else parts.note_paragraphs([INVITATION], "margin:12px 20px")
            self.pair_words.object, self.pair_figures.object, self.pair_table.object = invitation, "", ""
            return
        first, second = pair.runs
        over_time = self.desk.over_time
        x = along(over_time)
        self.host.axes[AXIS].fit(max(float(x.values(run)[-1]) for run in pair.runs), roomy=False)
        self.host.draw(PAIR_PLOTS, {FIRST: first, SECOND: second}, over_time)
        self.pair_figures.object = parts.figures(pair_figures(pair))
        self.pair_words.object = pair_words(pair)
        rows = [(row, False) for row in pair_rows(first, second)]
        table = '<div class="wide-table wraps" tabindex="0" role="region" aria-label="Both scenarios">{}</div>'
        body = parts.markup(table, parts.table("Both scenarios", HEAD, rows))
        self.pair_table.object = parts.markup('<div style="padding:0 20px 16px">{}</div>', body)


def pair_figures(pair: Pair) -> list[parts.Markup]:
    """Return the head: by how much the second run differs from the first."""
    first, second = pair.runs
    cells = {name: cells for name, *cells in pair_rows(first, second)}
    energy = comparisons.above(second.energy_kwh, first.energy_kwh)
    per_tonne, speed = cells["Energy per tonne and km, Wh"], cells["Highest speed, km/h"]
    against = f"{words.energy(second.energy_kwh)} against {words.energy(first.energy_kwh)} kWh"
    return [
        parts.figure("Energy of the second", *energy, against, "main", term="Energy from the supply"),
        parts.figure("Per tonne and km", per_tonne[2], "Wh", f"{per_tonne[1]} against {per_tonne[0]}"),
        parts.figure(
            "Travel time",
            words.delay(second.travel_time_s - first.travel_time_s),
            "s",
            f"{words.time(second.travel_time_s)} against {words.time(first.travel_time_s)}",
        ),
        parts.figure("Highest speed", speed[2], "km/h", f"{speed[1]} against {speed[0]}"),
    ]


def pair_words(pair: Pair) -> parts.Markup:
    """Return the names of both scenarios with their colours, what differs, and what must be known of the figures."""
    names = parts.joined(
        parts.markup(
            '<b style="color:var(--rj-{});margin-right:18px">{}: {}</b>',
            TOKENS[name],
            name.capitalize(),
            called,
        )
        for name, called in zip((FIRST, SECOND), pair_names(*pair.runs), strict=True)
    )
    first, second = pair.runs
    sentences = [
        scenarios_differ(first.scenario, second.scenario),
        lengths_differ(first, second),
        pair.refusal,
        f"Both are run by {words.strategy(first.strategy)}." if first.strategy == second.strategy else "",
        "In each column the other run is the thin dashed line.",
    ]
    body = " ".join(filter(None, sentences))
    return parts.markup('<div style="padding:10px 20px 4px"><p>{}</p><p class="note">{}</p></div>', names, body)


@cache
def trains() -> dict[str, str]:
    """Return the entries of the shipped vehicles."""
    return {str(preset_document("vehicles", name)["name"]): f"{TRAIN}:{name}" for name in preset_names("vehicles")}


@cache
def shipped_titles() -> dict[str, str]:
    """Return the entries of the shipped scenarios."""
    return {load_scenario(name).title: f"{SCENARIO}:{name}" for name in preset_names("scenarios")}
