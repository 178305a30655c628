"""The row of numbers of Robustness."""

import html
import re

import numpy as np
import pytest

from railjoule.core import load_scenario
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.browser.browser import Browser
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.words import MINUS
from railjoule.dashboard.pages.robustness.chance_charts import chance_table
from railjoule.dashboard.pages.robustness.compute import RealityRequest, compute_reality
from railjoule.dashboard.pages.robustness.view import RobustnessView, chance_figures
from railjoule.dashboard.state.workbench import Workbench

NO_TARGET_CURVE = load_scenario("metro-with-limit", {"simulation.target_braking": False})
"""A train that brakes where it thinks the curve begins, and so may miss its stop."""


def plain(markup: str) -> str:
    return " ".join(html.unescape(re.sub(r"<[^>]+>", " ", markup)).split())


def figures_at(load_factor: float, error_m: float) -> list[str]:
    state = Workbench()
    view = RobustnessView(state, Browser(), Palette(dark=False))
    changes = {"disturbance.actual_load_factor": load_factor, "disturbance.coordinate_error_m": error_m}
    state.robustness.reality = compute_reality(RealityRequest(NO_TARGET_CURVE, changes))
    return [plain(cell) for cell in view._cells(state.robustness.reality)]


def test_a_run_that_misses_timetable_and_stop_is_no_saving() -> None:
    """It read as -1.8 % (walk_engineer.md, F8)."""
    main, plan, *_ = figures_at(1.0, 10.0)
    assert main == "Load 100 %, +10 m 3.2 s late 14.5 m beyond the stop; 9.68 kWh, for the actual load 9.86"
    # beside the plan for half of the load it needs more, and that is told
    assert plan == "Against the plan +1.867 kWh +23.9 %, planned 7.81"


def test_a_miss_that_needs_more_is_told_by_what_it_costs() -> None:
    main, *_ = figures_at(1.0, -20.0)
    assert re.match(r"Load 100 %, \u221220 m \+\d", main)


def test_less_than_the_plan_by_a_miss_has_no_percentage() -> None:
    _, plan, *_ = figures_at(0.25, 10.0)
    assert re.fullmatch(rf"Against the plan {MINUS}[\d.]+ kWh planned 7\.81", plan)


def drawn(energy_kwh: list[float], delay_s: float) -> StudyTable:
    count = len(energy_kwh)
    energy, extra = np.array(energy_kwh), np.array(energy_kwh) / 10.0 - 1
    columns = {
        "load_factor": np.full(count, 0.5),
        "energy_kwh": energy,
        "overconsumption": extra,
        "over_replanned": extra,
        "delay_s": np.full(count, delay_s),
        "stop_error_m": np.zeros(count),
        "replanned_kwh": np.full(count, 10.0),
    }
    return StudyTable(NO_TARGET_CURVE, {"run": range(count)}, columns, {"planned_energy_kwh": 10.0}, count)


@pytest.mark.parametrize(
    ("energies", "cells"),
    [
        ([9.0, 11.0, 12.0], ["Median < +10.0 %", "95th percentile < +19.0 %"]),
        ([9.0, 9.5, 12.0], ["Median \u2013 % less, with a miss", "95th percentile < +17.5 %"]),
    ],
)
def test_half_of_the_runs_drawn_save_nothing_by_a_miss(energies: list[float], cells: list[str]) -> None:
    for cell, text in zip(chance_figures(drawn(energies, 5.0)), cells, strict=True):
        assert plain(cell).startswith(text)


def test_the_table_says_how_many_runs_need_less_by_a_miss() -> None:
    told = "2 of the runs need less than a plan for their load, but arrive late or miss the stop: no saving."
    assert told in plain(chance_table(drawn([9.0, 9.5, 12.0], 5.0)))
    assert "no saving" not in plain(chance_table(drawn([9.0, 9.5, 12.0], 0.0)))
