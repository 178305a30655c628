"""The tab "Chance": random draws of the conditions, and the plan that is robust against them."""

from functools import partial
from typing import Any

import numpy as np
import param
from panel.viewable import Viewable

from railjoule.core import Scenario
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.studies.robust_plan import CANDIDATES, MAX_CANDIDATES, PROBABILITY
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.charts.plot import Plot
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.page import Page, Request, keyed, shows, study
from railjoule.dashboard.pages.what_if.chance_charts import HistogramChart, LoadScatter, chance_table, finite
from railjoule.dashboard.pages.what_if.compute import Conditions, RobustAnswer, compute_chance, compute_robust
from railjoule.dashboard.pages.what_if.conditions import CHANCE, FOLLOWING, NOTHING_WRONG, PREVIEW_RUNS, conditions
from railjoule.dashboard.pages.what_if.explorer import HEIGHTS, Explorer
from railjoule.dashboard.pages.what_if.heat_map import percent_difference
from railjoule.dashboard.pages.what_if.robust import ROBUST, robust_text
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.state.numbers import TypedInteger, TypedNumber
from railjoule.dashboard.state.page_model import result

DRAWS = "chance"
FULL_RUNS = 10_000
ROBUST_RUNS = 1500
"""Draws of the check of a robust plan; its candidates have a fifth of them."""
ROBUST_FIELDS = ("probability_percent", "accepted_lateness_s", "candidates")
"""The search for a robust plan."""


def _histogram(name: str, caption: str, quantity: str, show: Any) -> Plot:
    return Plot(name, "", heights=(190, 220, 170), chart=partial(HistogramChart, name, caption, quantity, show))


MORE = _histogram(
    *("more", "Extra energy against a plan for the actual load, %", "Extra energy, %"), percent_difference
)
DELAYS = _histogram("late", "Delay at the stop, s", "Delay, s", words.delay)
SCATTER = Plot("scatter", "", heights=(220, 260, 200), chart=LoadScatter)
LAYOUT_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); column-gap: 28px;
  padding: 10px 20px 12px 14px; align-items: start; }
@media (max-width: 1099px) { :host { grid-template-columns: minmax(0, 1fr); padding: 8px 12px; } }
"""


class ChanceTab(Page):
    """The part of the page that this tab shows."""

    probability_percent = TypedNumber("Probability, %", "%", default=100 * PROBABILITY, bounds=(1, 99.9))
    accepted_lateness_s = keyed(Disturbance, "accepted_delay_s", "Accepted lateness", "s", 1)
    candidates = TypedInteger("Candidate plans", default=CANDIDATES, bounds=(1, MAX_CANDIDATES))

    chance = result(StudyTable, "Random runs so far.")
    drawing = param.Boolean(default=False, doc="Whether more are being computed.")
    more_of = result(Conditions, "The conditions of which all runs were asked for.")
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

    def search_robust(self, *_: Any) -> None:
        """Search the robust plan."""
        self.param.trigger("find_robust")

    def _draws(self, runs: int, **more: Any) -> Conditions:
        return conditions(self.desk, {**self.desk.day.chance_changes(runs), **NOTHING_WRONG, **more})

    @study(
        "scenario", "desk.chosen", "more_of", *FOLLOWING, *CHANCE, into="chance", busy="drawing", marked=True, tab=DRAWS
    )
    def _chance(self) -> Request:
        preview = self._draws(PREVIEW_RUNS)
        return compute_chance, self._draws(FULL_RUNS) if preview == self.more_of else preview

    @study(
        *("scenario", "desk.chosen", *FOLLOWING, *CHANCE, *ROBUST_FIELDS),
        into="robust",
        start="find_robust",
        busy="searching",
        tab=DRAWS,
    )
    def _robust(self) -> Request:
        accepted = {"disturbance.accepted_delay_s": float(self.accepted_lateness_s)}
        draws = self._draws(ROBUST_RUNS, **accepted)
        return compute_robust, draws, self.probability_percent / 100, self.candidates

    # ---- what it shows

    def layout_chance(self) -> Viewable:
        """Return the parts of the tab, laid out."""
        host, plots = self.host, self.host.plots
        self.quantiles, self.quantile_table, self.robust_words = (parts.html_pane() for _ in range(3))
        self.explorer = Explorer(self, lambda: host.take_charts(self.explorer.charts))
        host.heights = {**host.heights, **HEIGHTS}
        upper = parts.stack(
            parts.stack(plots["more"].host, plots["scatter"].host),
            parts.stack(plots["late"].host, self.quantile_table),
            css=LAYOUT_CSS,
        )
        charts = parts.stack(*(plots[plot.name].host for plot in ROBUST), css=LAYOUT_CSS)
        self.robust_part = parts.stack(charts, self.robust_words, visible=False)
        return parts.stack(self.quantiles, upper, self.robust_part, self.explorer.view)

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
        self.quantile_table.object = f"{chance_table(chance)}{parts.note_paragraphs(chance.notes)}"

    @shows("chance", "drawing", "desk.dark", tab=DRAWS)
    def _explore(self) -> None:
        self.explorer.follow()

    @shows("robust", tab=DRAWS)
    def _show_robust(self) -> None:
        self.robust_part.visible = self.robust is not None
        if self.robust is not None:
            self.host.draw(ROBUST, self.robust.found)
            self.robust_words.object = robust_text(self.robust)


# ---- texts


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


# so many runs need less by arriving late or missing the stop, which is no saving
def _at_most(share: float) -> str:
    return f"< {words.share_difference(share)}" if share >= 0 else words.UNKNOWN


def _unless_missed(share: float) -> str:
    return "above a plan for the load" if share >= 0 else "less, with a miss"
