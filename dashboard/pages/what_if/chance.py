"""The tab "Chance": random draws of the conditions, and the plan that is robust against them."""

from operator import methodcaller
from typing import Any

import numpy as np
import panel as pn
import panel_material_ui as pmui
import param
from panel.viewable import Viewable

from railjoule.core import Scenario
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.studies.montecarlo import monte_carlo_steps, punctuality
from railjoule.core.studies.robust_plan import CANDIDATES, MAX_CANDIDATES, PROBABILITY, Candidate, DrawnRuns, RobustPlan
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard import day
from railjoule.dashboard.charts.axis import nice_range, xy
from railjoule.dashboard.charts.names import Name
from railjoule.dashboard.charts.plot import CurveChart, Plot
from railjoule.dashboard.charts.quantities import SPEED
from railjoule.dashboard.charts.run_lines import NAMES, Line, RunLines, RunPlot, data_range
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.key_names import without_keys
from railjoule.dashboard.page import Page, Request, shows, study
from railjoule.dashboard.pages.what_if.chance_charts import SCATTER, chance_table, draws_table, finite, histogram
from railjoule.dashboard.pages.what_if.compute import RobustAnswer, robust_steps, steps
from railjoule.dashboard.pages.what_if.heat_map import percent_difference
from railjoule.dashboard.pages.what_if.load import (
    CHANCE,
    FOLLOWING,
    LAYOUT_CSS,
    NOTHING_WRONG,
    PREVIEW_RUNS,
    conditions,
    section,
)
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import button
from railjoule.dashboard.parts.number_field import number_fields
from railjoule.dashboard.state.kept import result
from railjoule.dashboard.state.numbers import TypedInteger, TypedNumber, keyed

# ---- the robust plan

LINES = {
    "nominal": Line("accent", {"line_width": 2.2}),
    "robust": Line("good", {"line_width": 1.9, "line_dash": [9, 3]}),
}
HEADROOM = 1.22


def draw_plans(chart: RunLines, found: RobustPlan) -> None:
    """Draw the speeds of the nominal plan, and of the robust one once it is known."""
    runs = {"nominal": found.nominal.plan}
    if found.chosen is not None and found.chosen is not found.nominal:
        runs["robust"] = found.chosen.plan
    chart.axis.fit(max(float(run.position_m[-1]) for run in runs.values()), roomy=False)
    lines = chart.fill(runs)
    chart.set_range(0, HEADROOM * data_range(lines.values())[1])
    tokens = chart.palette.tokens
    places = {"nominal": 0.25, "robust": 0.7}
    chart.place_names(lines, [Name(name, name, tokens[LINES[name].token], preferred=places[name]) for name in runs])


def draw_candidates(chart: CurveChart, found: RobustPlan) -> None:
    """Draw the candidates so far, the probability that was asked for, the nominal and the robust plan."""
    drawn = [one.drawn for one in found.candidates]
    energy = np.array([one.expected_kwh for one in drawn])
    share = 100 * np.array([one.share_on_time for one in drawn])
    intervals = 100 * np.array([one.share_interval for one in drawn])
    chart.put("intervals", x=intervals[:, 0].tolist(), y=energy.tolist(), x1=intervals[:, 1].tolist())
    chart.put("points", **xy(share, energy))
    chart.put("asked", x=[100 * found.probability])
    chart.set_ranges(
        (float(min(intervals.min(), 100 * found.probability)) - 2.0, 102.0),
        nice_range(float(np.nanmin(energy)), float(np.nanmax(energy)), 0.12),
    )
    names, lines = [], {}
    for name, one in {"nominal": found.nominal, "robust": found.chosen}.items():
        x, y = ([], []) if one is None else ([100 * one.drawn.share_on_time], [one.drawn.expected_kwh])
        chart.put(name, x=x, y=y)
        if one is not None:
            names.append(Name(name, name, chart.palette.tokens[LINES[name].token], point=(x[0], y[0])))
            lines[name] = np.array(x), np.array(y)
    chart.place_names(lines, names)


ROBUST = (
    RunPlot(
        *("robust_speed", SPEED, LINES, (250, 310, 220)),
        caption="Robust plan: speed, km/h, beside the nominal plan",
        ticks=5,
        last=True,
        axis="robust",
        above=(NAMES,),
        draws=draw_plans,
    ),
    Plot(
        "candidates",
        "Candidates: expected energy, kWh, over runs on time, with the 95 % interval",
        heights=(250, 310, 220),
        x_title="Runs on time, %",
        digits=2,
        sketch="map",
        layers=(
            methodcaller("hairlines", "asked", "ink3", line_dash=[2, 3]),
            methodcaller("glyphs", "segment", "intervals", "x", "y", "x1", "y", paint={"line_color": "line2"}),
            methodcaller("dots", "points", "driven", size=6),
            *(methodcaller("dots", name, line.token, size=9) for name, line in LINES.items()),
            NAMES,
        ),
        draws=draw_candidates,
    ),
)


def robust_text(answer: RobustAnswer) -> str:
    """Return the nominal and the robust plan as a table with the result of the check, or how far the search is."""
    found = answer.found
    if answer.refusal:
        return parts.inset(parts.refusal(without_keys(answer.refusal)))
    if found.chosen is None or found.checked is None:
        tried = len(found.candidates) - 1 + found.refused
        return parts.inset(parts.note_paragraphs([f"{tried} of {found.asked} candidate plans followed."]))
    header = (
        "Plan",
        "Load, %",
        "Resistance",
        "Reserve, s",
        "Planned, kWh",
        "Expected, kWh",
        "On time, %",
        "Interval, %",
    )
    pairs = zip((found.nominal, found.chosen), found.checked, strict=True)
    rows = [(_cells(name, *pair), name == "robust") for name, pair in zip(LINES, pairs, strict=True)]
    return parts.inset(parts.table("Robust plan", header, rows), parts.note_paragraphs(robust_notes(found)))


def _cells(name: str, plan: Candidate, checked: DrawnRuns) -> tuple[str, ...]:
    low, high = checked.share_interval
    return (
        name,
        words.setting(plan.load_factor),
        words.number(plan.resistance_factor, 3),
        words.number(plan.reserve_s, 1),
        words.energy(plan.plan.energy_kwh),
        words.energy(checked.expected_kwh),
        words.share(checked.share_on_time),
        f"{words.share(low)} to {words.share(high)}",
    )


def robust_notes(found: RobustPlan) -> list[str]:
    """Return the cost of the robust plan, the result of its check, and the size of the search, in sentences."""
    assert found.chosen is not None
    assert found.checked is not None
    extra, error = found.extra_kwh
    accepted = found.scenario.disturbance.accepted_delay_s
    late = f" or at most {words.number(accepted, 1)} s late" if accepted else ""
    asked, runs = words.share(found.probability), words.number(found.checked[1].runs, 0)
    held = "enough" if found.is_held else "not enough; choose a higher probability or more candidates"
    cost = f"{words.energy_difference(extra)} \u00b1 {words.number(error, 4)} kWh"
    sentences = [
        f"The robust plan needs {cost} against the nominal plan." if found.chosen is not found.nominal else "",
        f"Asked for: on time{late} in at least {asked} % of the runs. Under {runs} draws that are not the search's, "
        f"the robust plan is on time in {words.share(found.checked[1].share_on_time)} %: {held}.",
        f"Search: {len(found.candidates)} plans under the same {words.number(found.nominal.drawn.runs, 0)} draws. On "
        "time are those whose 95 % interval lies above the probability.",
        f"No train can keep {found.refused} more candidates." if found.refused else "",
    ]
    return [sentence for sentence in sentences if sentence]


# ---- the tab

DRAWS = "chance"
FULL_RUNS = 10_000
ROBUST_RUNS = 1500
"""Draws of the check of a robust plan; its candidates have a fifth of them."""
ROBUST_FIELDS = ("probability_percent", "accepted_lateness_s", "candidates")
"""The search for a robust plan."""


MORE = histogram(*("more", "Extra energy against a plan for the actual load, %", "Extra energy, %"), percent_difference)
DELAYS = histogram("late", "Delay at the stop, s", "Delay, s", words.delay)


class ChanceTab(Page):
    """The content of this tab."""

    probability_percent = TypedNumber("Probability, %", "%", default=100 * PROBABILITY, bounds=(1, 99.9))
    accepted_lateness_s = keyed(Disturbance, "accepted_delay_s", "Accepted lateness", "s", 1)
    candidates = TypedInteger("Candidate plans", default=CANDIDATES, bounds=(1, MAX_CANDIDATES))

    chance = result(StudyTable, "Random runs so far.")
    drawing = param.Boolean(default=False, doc="Whether more are being computed.")
    more_of = result(tuple, "The conditions of which all runs were asked for.")
    robust = result(RobustAnswer, "The robust plan, or the search for it so far.")
    searching = param.Boolean(default=False, doc="Whether it is being searched.")
    find_robust = param.Event(doc="Search the robust plan.")

    def take(self, scenario: Scenario) -> None:
        """Take over the accepted lateness of a scenario."""
        super().take(scenario)
        self.accepted_lateness_s = scenario.disturbance.accepted_delay_s

    def draw_all(self, *_: Any) -> None:
        """Compute all runs of the present conditions, not only those of the preview."""
        self.more_of = self._draws(PREVIEW_RUNS)

    def goes_on(self, into: str) -> bool:
        """Return whether all runs of the present conditions were asked for."""
        return into == "chance" and self.more_of is not None and self.more_of == self._draws(PREVIEW_RUNS)

    def _draws(self, runs: int, **more: Any) -> tuple[Any, ...]:
        return conditions(self.desk, {**self.desk.day.chance_changes(runs), **NOTHING_WRONG, **more})

    @study(
        "scenario", "desk.chosen", "more_of", *FOLLOWING, *CHANCE, into="chance", busy="drawing", marked=True, tab=DRAWS
    )
    def _chance(self) -> Request:
        preview = self._draws(PREVIEW_RUNS)
        return steps, *(self._draws(FULL_RUNS) if preview == self.more_of else preview), monte_carlo_steps

    @study(
        *("scenario", "desk.chosen", *FOLLOWING, *CHANCE, *ROBUST_FIELDS),
        into="robust",
        start="find_robust",
        busy="searching",
        tab=DRAWS,
    )
    def _robust(self) -> Request:
        draws = self._draws(ROBUST_RUNS, **{"disturbance.accepted_delay_s": float(self.accepted_lateness_s)})
        return steps, *draws, robust_steps, self.probability_percent / 100, self.candidates

    # ---- what it shows

    def layout_chance(self) -> Viewable:
        """Return the parts of the tab, laid out."""
        plots = self.host.plots
        self.quantiles, self.quantile_table, self.robust_words = (parts.html_pane() for _ in range(3))
        upper = parts.stack(
            parts.stack(plots["more"].host, plots["scatter"].host),
            parts.stack(plots["late"].host, self.quantile_table),
            css=LAYOUT_CSS,
        )
        charts = parts.stack(*(plots[plot.name].host for plot in ROBUST), css=LAYOUT_CSS)
        self.robust_part = parts.stack(charts, self.robust_words, visible=False)
        explore = button("Explore the draws", self.explore, margin=(4, 20, 16, 20))
        return parts.stack(self.quantiles, upper, explore, self.robust_part)

    def layout_chance_fields(self) -> Viewable:
        """Return its part of the sidebar."""
        self.more_progress = Progress(self, f"Run {words.number(FULL_RUNS, 0)}", "Stop", self.draw_all, "drawing")
        self.search = Progress(
            self, "Find the robust plan", "Cancel", lambda _: self.param.trigger("find_robust"), "searching"
        )
        self.param.watch(self._show_progress, ["chance", "drawing", "robust", "searching"])
        self._show_progress()
        return parts.stack(
            section("Monte Carlo", "normal, resistance log-normal"),
            *number_fields(self.desk.day, *day.CHANCE),
            self.more_progress.view,
            section("Robust plan", "on time under these draws"),
            *number_fields(self, *ROBUST_FIELDS),
            self.search.view,
        )

    def _show_progress(self, *_: Any) -> None:
        chance, robust = self.chance, self.robust
        self.more_progress.show(0.0 if chance is None else chance.done / chance.scenario.montecarlo.runs)
        # the check of the chosen plan comes last
        tried = 0 if robust is None else len(robust.found.candidates) + robust.found.refused
        self.search.show(0.0 if robust is None else tried / (robust.found.asked + 2))

    def explore(self, *_: Any) -> None:
        """Show the draws so far on the page of tables of runs."""
        table = None if self.chance is None else draws_table(self.chance)
        if table is not None:
            self.desk.turn_to("Explore", draws=table)

    @shows("chance", "failure", "accepted_lateness_s", tab=DRAWS)
    def _show_chance(self) -> None:
        chance = self.chance
        if chance is None:
            return
        self.host.draw([MORE], 100 * chance.over_replanned)
        self.host.draw([DELAYS], chance.delay_s)
        self.host.draw([SCATTER], chance)
        self.quantiles.object = parts.figures(
            chance_figures(chance, float(self.accepted_lateness_s)), self.failure is not None
        )
        notes = parts.note_paragraphs(chance.notes)
        self.quantile_table.object = f"{chance_table(chance)}{punctuality_table(chance)}{notes}"

    @shows("robust", tab=DRAWS)
    def _show_robust(self) -> None:
        self.robust_part.visible = self.robust is not None
        if self.robust is not None:
            self.host.draw(ROBUST, self.robust.found)
            self.robust_words.object = robust_text(self.robust)


class Progress:
    """Buttons that begin and stop a study of a page, and its progress; `busy` is whether it is under way."""

    def __init__(self, page: Page, label: str, stop_label: str, begin: Any, busy: str) -> None:
        self.page, self.busy = page, busy
        small: dict[str, Any] = {"variant": "text", "margin": (8, 8), "visible": False}
        self.stop = button(stop_label, lambda _: page.param.update(**{busy: False}), **small)
        self.bar = pmui.LinearProgress(
            value=0, variant="determinate", margin=(0, 16, 4, 16), sizing_mode="stretch_width", visible=False
        )
        row = pn.Row(button(label, begin, margin=(8, 8, 8, 16)), self.stop, margin=0, sizing_mode="stretch_width")
        self.view = parts.stack(row, self.bar)

    def show(self, share: float) -> None:
        """Show whether the study is under way, and the share of it that is done."""
        self.bar.visible = self.stop.visible = getattr(self.page, self.busy)
        if self.bar.visible:
            self.bar.value = int(100 * share)


# ---- texts


def finding(chance: StudyTable, accepted_s: float, robust: RobustAnswer | None) -> parts.Markup:
    """Return in a sentence how often the plan is on time, and what is to be done for it."""
    more, delays = finite(chance.over_replanned), finite(chance.delay_s)
    if not len(more):
        return parts.Markup()
    share = words.share(float((delays < accepted_s + comparisons.OTHER_TIME_S).sum()) / chance.done)
    late = f" or at most {words.number(accepted_s)} s late" if accepted_s else ""
    most = float(np.quantile(more, 0.95))
    needs = f"; 19 of 20 need at most {words.share(most)} % more energy than a plan for their load" if most >= 0 else ""
    drawn = f"The plan is on time{late} in {share} % of {words.number(chance.done, 0)} random runs{needs}."
    if robust is None or robust.found.checked is None:
        return parts.finding(drawn, "\u201cFind the robust plan\u201d searches one that is on time more often.")
    share = words.share(robust.found.checked[1].share_on_time)
    extra = words.energy_difference(robust.found.extra_kwh[0])
    return parts.finding(drawn, f"The robust plan is on time in {share} % of others, for {extra} kWh.")


def chance_figures(chance: StudyTable, accepted_s: float) -> list[str]:
    """Return the share of the draws on time, and the extra energy of half of them and of nineteen in twenty at most."""
    values, delays = finite(chance.over_replanned), finite(chance.delay_s)
    if not len(values):
        return []
    share = float((delays < accepted_s + comparisons.OTHER_TIME_S).sum()) / chance.done
    late = f"or at most {words.number(accepted_s)} s late, " if accepted_s else ""
    drawn = f"{late}of {words.number(chance.done, 0)} draws"
    half, most = (float(np.quantile(values, share)) for share in (0.5, 0.95))
    return [
        parts.figure("Runs on time", words.share(share), "%", drawn, "main"),
        parts.figure("Median", _at_most(half), "%", _unless_missed(half)),
        parts.figure("95th percentile", _at_most(most), "%", _unless_missed(most)),
    ]


def punctuality_table(chance: StudyTable) -> parts.Markup:
    """Return delays at the stations, and energy with delays kept or made up for, as HTML; nothing without them."""
    rows = [
        (
            [
                row.place,
                words.time(row.mean_delay_s),
                words.time(row.late_delay_s),
                words.share(row.share_on_time),
                "" if row.energy_kwh is None else words.energy(row.energy_kwh),
            ],
            False,
        )
        for row in punctuality(chance)
    ]
    header = ("Arrival", "Mean delay, s", "95 % at most, s", "On time, %", "Mean energy, kWh")
    return parts.table("Arrivals with scattered dwells", header, rows) if rows else parts.Markup()


# so many runs need less by arriving late or missing the stop, which is no saving
def _at_most(share: float) -> str:
    return f"< {words.share_difference(share)}" if share >= 0 else words.UNKNOWN


def _unless_missed(share: float) -> str:
    return "above a plan for the load" if share >= 0 else "less, with a miss"
