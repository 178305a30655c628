"""Storage: by hand on three cells, by its account on runs, and what is refused."""

import numpy as np
import pytest
from builders import plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core import ScenarioError, load_scenario, solve
from railjoule.core.studies.storage import (
    Storage,
    StorageRun,
    _stored,
    link_power_w,
    saving_over_size,
    storage_need,
    with_storage,
)

KWH = 3.6e6
RUN = solve(load_scenario("kharkiv-like-40kmh"))


def share_of_receptive_line(run: StorageRun) -> float:
    """Return what a storage saves over what a line would save that takes everything."""
    return run.saved_kwh / (run.with_resistors_kwh - run.with_receptive_line_kwh)


def test_a_storage_that_fills_slowly_is_full_in_the_end():
    """1 kWh taken, 2 kWh generated: each of many runs leaves 1 kWh more in a storage of 1000 kWh until it is full.

    Then a run takes 1 kWh from the storage and fills it again; the other kWh is dissipated, and no energy disappears.
    """
    power, seconds = np.array([1.0, -2.0]) * KWH / 100, np.full(2, 100.0)
    found = _stored(power, seconds, Storage(1000.0, 1e6, 1.0, 1.0))
    assert (found.energy_kwh, found.dissipated_kwh) == (pytest.approx(0.0, abs=1e-9), pytest.approx(1.0))
    assert found.storage_loss_kwh == pytest.approx(0.0, abs=1e-9)


def test_three_cells_by_hand():
    """2 kWh taken, 1 kWh generated, 0.5 kWh taken; 0.8 kWh of size, 0.9 in and out, with the charge of a run before.

    0.8 / 0.9 kWh go in, 0.111 kWh are dissipated, 0.72 kWh come out.
    """
    power, seconds = np.array([2.0, -1.0, 0.5]) * KWH / 100, np.full(3, 100.0)
    found = _stored(power, seconds, Storage(0.8, 1e6, 0.9, 0.9))
    assert found.with_resistors_kwh == pytest.approx(2.5)
    assert found.with_receptive_line_kwh == pytest.approx(1.5)
    assert found.energy_kwh == pytest.approx(2.5 - 0.72)
    assert found.dissipated_kwh == pytest.approx(1 - 0.8 / 0.9)
    assert (found.storage_loss_kwh, found.cycles) == (pytest.approx(0.8 / 0.9 - 0.72), pytest.approx(1.0))
    assert share_of_receptive_line(found) == pytest.approx(0.72)


@given(size=st.floats(0, 5), power=st.floats(0, 2000), into=st.floats(0.5, 1), out=st.floats(0.5, 1))
def test_the_account_closes(size, power, into, out):
    found = with_storage(RUN, Storage(size, power, into, out))
    offered = found.with_resistors_kwh - found.with_receptive_line_kwh
    assert found.saved_kwh + found.storage_loss_kwh + found.dissipated_kwh == pytest.approx(offered, abs=1e-6)
    assert -1e-9 <= found.saved_kwh <= offered * into * out + 1e-9


def test_without_loss_the_largest_drop_is_enough():
    need = storage_need(RUN)
    enough = with_storage(RUN, Storage(need.max_drop_kwh, 1e6, 1.0, 1.0))
    less = with_storage(RUN, Storage(0.9 * need.max_drop_kwh, 1e6, 1.0, 1.0))
    assert share_of_receptive_line(enough) == pytest.approx(1.0)
    assert share_of_receptive_line(less) < 1 - 1e-3


def test_need_of_a_run():
    need = storage_need(RUN, service_time_s=36000.0, turnaround_s=30.0)
    power, seconds = link_power_w(RUN)
    assert need.charging_peak_kw == pytest.approx(-power.min() / 1e3)
    assert need.discharging_peak_kw == pytest.approx(power.max() / 1e3)
    assert need.generated_kwh == pytest.approx(-np.minimum(power, 0) @ seconds / KWH)
    assert need.cycles_per_day == pytest.approx(need.cycles * 36000 / (RUN.travel_time_s + 30))


def test_savings_rise_with_size_and_end():
    saved = saving_over_size(RUN, np.linspace(0, 4, 9), 2000.0)
    assert saved[0] == pytest.approx(0, abs=1e-9)
    assert (np.diff(saved) >= -1e-9).all()
    assert saved[-1] == pytest.approx(saved[-2])


def test_a_line_with_stations():
    """Two like halves ask for the storage of one and cycle it twice."""
    half = {"drive.recuperation_factor": 0.0, "line.sections": [{"length_m": 1000.0}], "timetable.travel_time_s": 90.0}
    one = storage_need(solve(plain_scenario(half), "fastest"))
    whole = {
        **half,
        "line.sections": [{"length_m": 2000.0}],
        "line.stations": [{"position_m": 1000.0, "dwell_s": 20.0}],
        "timetable.travel_time_s": 200.0,
    }
    two = storage_need(solve(plain_scenario(whole), "fastest"))
    assert two.max_drop_kwh == pytest.approx(one.max_drop_kwh, rel=1e-6)
    assert two.cycles == pytest.approx(2 * one.cycles, rel=1e-6)


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ((-1.0, 100.0), r"^storage.size_kwh = -1 must be a number of at least 0.$"),
        ((1.0, -100.0), r"^storage.power_kw = -100 must be a number of at least 0.$"),
        ((1.0, 100.0, 1.1), r"^storage.charging_efficiency = 1.1 must be above 0 and at most 1.$"),
        ((1.0, 100.0, 0.9, 0.0), r"^storage.discharging_efficiency = 0 must be above 0 and at most 1.$"),
    ],
)
def test_bad_storages(values, expected):
    with pytest.raises(ScenarioError, match=expected):
        Storage(*values)
    with pytest.raises(ScenarioError, match="size_kwh = -2"):
        saving_over_size(RUN, [1.0, -2.0], 100.0)
