from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas
import pytest
from builders import plain_scenario

from railjoule.core.studies.sweep import MemoryResults, SweepTable, make_study, run_study, sensitivities
from railjoule.dashboard.pages.study import compute
from railjoule.dashboard.pages.study.columns import columns_of
from railjoule.dashboard.pages.study.compute import (
    BINS,
    CELLS,
    ENERGY,
    EstimateRequest,
    LookRequest,
    Points,
    Raster,
    compute_estimate,
    compute_look,
    raster_of,
    write_table,
)

X, LOAD, RECUPERATION = "timetable.travel_time_s", "vehicle.load_factor", "drive.recuperation_factor"


def asked(table: SweepTable, **changes: object) -> LookRequest:
    return replace(LookRequest(table, X, ENERGY, LOAD, LOAD, RECUPERATION, {}, 10, (40, 30)), **changes)


def test_the_runs_are_listed_by_their_energy(table: SweepTable) -> None:
    look = compute_look(asked(table))
    energy = table.columns[ENERGY]
    place = list(columns_of(table.study)).index(ENERGY)
    assert (look.done, look.driven, look.chosen) == (200, 200, 200)
    assert [run.values[place] for run in look.listed] == sorted(energy)[:10]
    assert (look.lowest.row, look.highest.row) == (int(np.argmin(energy)), int(np.argmax(energy)))
    assert look.median.values[place] == sorted(energy)[99]


def test_a_choice_holds_what_lies_within_all_of_its_bounds(table: SweepTable) -> None:
    choice = {X: (150.0, 165.0), ENERGY: (0.0, float(np.median(table.columns[ENERGY])))}
    look = compute_look(asked(table, choice=choice))
    held = np.all([(low <= v) & (v <= high) for (low, high), v in
                   ((choice[X], table.samples[X]), (choice[ENERGY], table.columns[ENERGY]))], axis=0)  # fmt: skip
    assert 0 < look.chosen == held.sum() < 200
    assert {run.row for run in look.listed} <= set(np.flatnonzero(held).tolist())


def test_the_map_holds_the_medians_of_its_cells(table: SweepTable) -> None:
    medians = compute_look(asked(table)).medians
    load, back = table.samples[LOAD], table.samples[RECUPERATION]
    held = (load < 1 / CELLS) & (back >= 0.8 * (CELLS - 1) / CELLS)
    assert medians.kwh[CELLS - 1, 0] == np.median(table.columns[ENERGY][held])
    assert compute_look(asked(table, map_x=LOAD, map_y=LOAD)).medians is None


def test_histograms_count_the_runs_within_the_axes(table: SweepTable) -> None:
    look = compute_look(asked(table))
    assert look.along_x is not None
    assert look.along_y is not None
    for told, values, ends in zip(
        (look.along_x, look.along_y), (table.samples[X], table.columns[ENERGY]), look.ends, strict=True
    ):
        assert len(told.counts) == BINS
        assert told.counts.sum() == np.count_nonzero((values >= ends[0]) & (values <= ends[1]))
        assert told.places == tuple(np.quantile(values, (0.05, 0.5, 0.95)))


def test_shares_are_those_of_the_core_the_greatest_first(table: SweepTable) -> None:
    results = MemoryResults(table.study)
    run_study(results)
    found, shares = sensitivities(results), compute_look(asked(table)).shares
    assert dict(zip(shares.fields, shares.total, strict=True)) == pytest.approx(
        dict(zip(found.fields, found.total, strict=True))
    )
    assert list(shares.total) == sorted(shares.total, reverse=True)
    # less time costs more than any load of this train
    assert shares.fields[0] == X


def test_too_few_runs_tell_no_shares_and_say_why(table: SweepTable) -> None:
    results = MemoryResults(make_study(plain_scenario(), {LOAD: (0.0, 1.0), X: (120.0, 170.0)}, 12))
    run_study(results)
    look = compute_look(asked(results.to_table(), map_y=X))
    assert look.shares is None
    assert "too few" in look.shares_refusal


def test_runs_that_cannot_be_driven_are_counted_and_the_first_reason_told() -> None:
    results = MemoryResults(make_study(plain_scenario(), {X: (60.0, 170.0)}, 32))
    run_study(results)
    look = compute_look(asked(results.to_table(), colour=X, map_x=X, map_y=X))
    # the shortest time is 110.4 s, see core's own tests of the plain scenario
    assert 0 < look.driven < look.done == 32
    assert look.reason
    assert isinstance(look.runs, Points)
    assert len(look.runs.x) == look.driven


def test_without_any_run_there_is_nothing_to_draw() -> None:
    results = MemoryResults(make_study(plain_scenario(), {X: (60.0, 70.0)}, 4))
    run_study(results)
    look = compute_look(asked(results.to_table(), colour=X, map_x=X, map_y=X))
    assert (look.done, look.driven, look.runs, look.listed) == (4, 0, None, ())


def test_many_points_become_a_raster(table: SweepTable, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compute, "MAX_POINTS", 100)
    runs = compute_look(asked(table)).runs
    assert isinstance(runs, Raster)
    assert runs.count.shape == runs.mean.shape == (30, 40)


def test_a_raster_counts_its_points_and_tells_their_mean() -> None:
    x, y, colour = np.array([0.1, 0.1, 0.9]), np.array([0.1, 0.1, 0.9]), np.array([1.0, 3.0, 7.0])
    raster = raster_of(x, y, colour, ((0.0, 1.0), (0.0, 1.0)), (2, 2))
    assert raster.count.tolist() == [[2, 0], [0, 1]]
    assert raster.mean[0, 0] == 2.0
    assert raster.mean[1, 1] == 7.0
    assert np.isnan(raster.mean[0, 1])


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_table_is_written_as_the_command_line_writes_it(table: SweepTable, tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"study{suffix}"
    write_table(table, path)
    read = pandas.read_csv(path) if suffix == ".csv" else pandas.read_parquet(path)
    assert len(read) == 200
    assert np.array_equal(read[ENERGY], table.columns[ENERGY])
    assert np.array_equal(read[X], table.samples[X])


@pytest.mark.parametrize(
    ("over", "sample", "told"),
    [
        (((LOAD, 0.0, 5.0),), 10, "load_factor"),
        ((("vehicle.name", 0.0, 1.0),), 10, "is no number"),
        ((), 10, "a sweep varies 1 to"),
        (((LOAD, 0.0, 1.0),), 2**40, "sample"),
    ],
)
def test_what_cannot_be_begun_is_refused_in_a_sentence(
    over: tuple[tuple[str, float, float], ...], sample: int, told: str
) -> None:
    estimate = compute_estimate(EstimateRequest(plain_scenario(), over, sample, "sobol", 1, "optimal", (ENERGY,)))
    assert estimate.seconds is None
    assert told in estimate.refusal
    assert estimate.refusal.endswith(".")
