"""The columns of the run that plays: those of the run, of one length, and the begin of each line of the advice."""

import pytest

from railjoule.core import load_scenario, solve
from railjoule.dashboard.look import words
from railjoule.dashboard.pages.drive.charts import played_columns


@pytest.mark.parametrize("name", ["metro-with-limit", "ftorek-300s", "metro-10-stations"])
def test_columns_are_those_of_the_run(name: str) -> None:
    run = solve(load_scenario(name))
    columns = played_columns(run)
    starts = columns.pop("starts")
    assert {len(column) for column in columns.values()} == {len(run.time_s)}
    assert ("current" in columns) == (run.supply_current_a is not None)
    assert columns["time"][-1] == pytest.approx(run.travel_time_s, abs=1e-3)
    assert columns["energy"][-1] == pytest.approx(run.energy_kwh, abs=1e-3)
    assert columns["height"][0] == 0.0
    assert len(starts) == len(list(words.advice_in_words(run.advice)))
    assert starts == sorted(starts)
