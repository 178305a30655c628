"""What the page Robustness asks for: the reality that a plan meets, the table, and what chance draws."""

from typing import get_args

import param

from railjoule.core import Scenario
from railjoule.core.scenario.disturbance import Disturbance
from railjoule.core.studies.braking_sensors import BrakingSensors
from railjoule.core.studies.robust_plan import CANDIDATES, MAX_CANDIDATES, PROBABILITY
from railjoule.core.studies.sensitivity_table import Knows
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.pages.robustness.compute import Reality, RobustAnswer
from railjoule.dashboard.state.numbers import TypedInteger, TypedNumber, TypedParameters, core_bounds
from railjoule.dashboard.state.page_model import PageModel, result

PREVIEW_RUNS, FULL_RUNS = 500, 10_000
ROBUST_RUNS = 1500
"""Draws of the check of a robust plan; its candidates have a fifth of them."""
ROBUST_FIELDS = ("probability_percent", "accepted_delay_s", "candidates")
"""The search for a robust plan."""
TABLE_FIELDS = ("both_directions", "knows")
MEASURES = ("over_replanned", "overconsumption", "delay_s", "stop_error_m")


class RobustnessModel(TypedParameters, PageModel):
    """The settings of the page and its results, in the units that it shows."""

    kept = (*ROBUST_FIELDS, *TABLE_FIELDS, "measure")
    passing = ("drawing", "searching")

    probability_percent = TypedNumber("Probability, %", "%", default=100 * PROBABILITY, bounds=(1, 99.9))
    accepted_delay_s = TypedNumber(
        "Accepted lateness, s", "s", 1, default=0.0, **core_bounds(Disturbance, "accepted_delay_s")
    )
    candidates = TypedInteger("Candidate plans", default=CANDIDATES, bounds=(1, MAX_CANDIDATES))
    both_directions = param.Boolean(default=False, doc="Whether the table covers both directions.")
    knows = param.Selector(default="nothing", objects=list(get_args(Knows)), doc="What the train knows.")
    measure = param.Selector(default="over_replanned", objects=list(MEASURES), doc="What the table shows.")

    reality = result(Reality, "The last good run.")
    table = result(StudyTable, "The table so far.")
    chance = result(StudyTable, "Random runs so far.")
    drawing = param.Boolean(default=False, doc="Whether Monte Carlo runs are being drawn.")
    stops = result(BrakingSensors, "Stopping errors with precision braking and without.")
    robust = result(RobustAnswer, "The robust plan, or the search for it so far.")
    searching = param.Boolean(default=False, doc="Whether a robust plan is being searched.")
    find_robust = param.Event(doc="Search the robust plan.")
    stop_search = param.Event(doc="Stop the search for a robust plan.")
    draw_all = param.Event(doc="Draw all Monte Carlo runs.")
    stop_drawing = param.Event(doc="Stop drawing; the runs so far are kept.")

    def take(self, scenario: Scenario) -> None:
        """Take over the accepted lateness of a scenario's file."""
        self.accepted_delay_s = scenario.disturbance.accepted_delay_s
