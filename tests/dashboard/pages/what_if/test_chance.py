"""The numbers of the tab "Chance"."""

from dataclasses import replace

import numpy as np
import pytest
from markup import plain

from railjoule.core import load_scenario
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.pages.what_if.chance import chance_figures
from railjoule.dashboard.pages.what_if.chance_charts import chance_table

SCENARIO = load_scenario("metro-with-limit")


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
    return StudyTable(SCENARIO, {"run": range(count)}, columns, {"planned_energy_kwh": 10.0}, count)


@pytest.mark.parametrize(
    ("energies", "cells"),
    [
        ([9.0, 11.0, 12.0], ["Median < +10.0 %", "95th percentile < +19.0 %"]),
        ([9.0, 9.5, 12.0], ["Median \u2013 % less, with a miss", "95th percentile < +17.5 %"]),
    ],
)
def test_half_of_the_runs_drawn_save_nothing_by_a_miss(energies: list[float], cells: list[str]) -> None:
    for cell, text in zip(chance_figures(drawn(energies, 5.0), 0.0)[1:], cells, strict=True):
        assert plain(cell).startswith(text)


def test_the_table_says_how_many_runs_need_less_by_a_miss() -> None:
    told = "2 of the runs need less than a plan for their load, but arrive late or miss the stop: no saving."
    assert told in plain(chance_table(drawn([9.0, 9.5, 12.0], 5.0)))
    assert "no saving" not in plain(chance_table(drawn([9.0, 9.5, 12.0], 0.0)))


def test_the_large_number_is_the_share_of_runs_on_time() -> None:
    table = drawn([9.0, 11.0, 12.0, 13.0], 0.0)
    table = replace(table, columns={**table.columns, "delay_s": np.array([0.0, -3.0, 2.0, 9.0])})
    first, *_ = chance_figures(table, 0.0)
    assert plain(first) == "Runs on time 50.0 % of 4 draws"
    first, *_ = chance_figures(table, 2.0)
    assert plain(first) == "Runs on time 75.0 % or at most 2.0 s late, of 4 draws"
