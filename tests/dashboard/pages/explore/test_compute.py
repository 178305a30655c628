from dataclasses import replace
from typing import Any

import numpy as np
import pandas
import pytest
from builders import plain_scenario

from railjoule.core.studies.sweep import MemoryResults, SweepTable, make_study, run_study, sensitivities
from railjoule.dashboard.pages.explore import compute
from railjoule.dashboard.pages.explore.compute import (
    BINS,
    CELLS,
    ENERGY,
    Look,
    LookRequest,
    Settings,
    Shares,
    compute_look,
    compute_shares,
    preview_steps,
    raster,
    table_file,
)
from railjoule.dashboard.pages.explore.fields import study_columns, study_table
from railjoule.dashboard.pages.explore.texts import finding_html, number_figures

X, LOAD, RECUPERATION = "timetable.travel_time_s", "vehicle.load_factor", "drive.recuperation_factor"


def look_at(table: SweepTable, **changes: Any) -> Look:
    asked = LookRequest(X, ENERGY, LOAD, LOAD, RECUPERATION, {}, 10)
    return compute_look(study_table(table), replace(asked, **changes))


def test_the_runs_are_listed_by_their_energy(table: SweepTable) -> None:
    look = look_at(table)
    energy = table.columns[ENERGY]
    assert (look.table.done, len(look.table.rows), look.chosen) == (200, 200, 200)
    assert energy[look.listed].tolist() == sorted(energy)[:10]
    lowest, highest = look.ranked
    assert (lowest, highest) == (int(np.argmin(energy)), int(np.argmax(energy)))
    # between the two in the middle, as the figure has it
    middle = f"{np.median(energy):.3f}"
    assert f">{middle}<" in number_figures(look, None)[1]


def test_a_selection_holds_what_lies_within_all_of_its_bounds(table: SweepTable) -> None:
    choice = {X: (150.0, 165.0), ENERGY: (-np.inf, float(np.median(table.columns[ENERGY])))}
    look = look_at(table, choice=choice)
    held = np.all([(low <= v) & (v <= high) for (low, high), v in
                   ((choice[X], table.samples[X]), (choice[ENERGY], table.columns[ENERGY]))], axis=0)  # fmt: skip
    assert 0 < look.chosen == held.sum() < 200
    assert set(look.listed.tolist()) <= set(np.flatnonzero(held).tolist())
    energy = table.columns[ENERGY]
    assert look.middles == {ENERGY: (np.median(energy[held]), np.median(energy))}
    assert look.histograms[X].held.sum() == held.sum()


def test_a_selection_may_hold_nothing(table: SweepTable) -> None:
    look = look_at(table, choice={X: (1e6, 2e6)})
    assert (look.chosen, len(look.listed), look.middles) == (0, 0, {})


def test_the_map_holds_the_medians_of_its_cells(table: SweepTable) -> None:
    medians = look_at(table).medians
    load, back = table.samples[LOAD], table.samples[RECUPERATION]
    held = (load < 1 / CELLS) & (back >= 0.8 * (CELLS - 1) / CELLS)
    assert medians.kwh[CELLS - 1, 0] == np.median(table.columns[ENERGY][held])
    assert look_at(table, map_x=LOAD, map_y=LOAD).medians is None


def test_histograms_count_the_runs_within_the_axes(table: SweepTable) -> None:
    look = look_at(table)
    for name, values in ((X, table.samples[X]), (ENERGY, table.columns[ENERGY])):
        found, ends = look.histograms[name], look.ends[name]
        # of 200 runs: twice the root of their number, as forty bins would look like a comb
        assert len(found.counts) == 28 < BINS
        assert found.counts.sum() == np.count_nonzero((values >= ends[0]) & (values <= ends[1]))
        assert found.places == tuple(np.quantile(values, (0.05, 0.5, 0.95)))


def test_shares_are_those_of_the_core_the_greatest_first(table: SweepTable) -> None:
    found, shares = sensitivities(table), compute_shares(table)
    assert dict(zip(shares.fields, shares.total, strict=True)) == pytest.approx(
        dict(zip(found.fields, found.total, strict=True))
    )
    assert list(shares.total) == sorted(shares.total, reverse=True)
    # less time costs more than any load of this train
    assert shares.fields[0] == X


def test_too_few_runs_give_no_shares_and_the_reason() -> None:
    results = MemoryResults(make_study(plain_scenario(), {LOAD: (0.0, 1.0), X: (120.0, 170.0)}, 12))
    run_study(results)
    assert "too few" in compute_shares(results.to_table()).refusal


def test_infeasible_runs_are_counted_with_the_first_reason() -> None:
    results = MemoryResults(make_study(plain_scenario(), {X: (60.0, 170.0)}, 32))
    run_study(results)
    look = look_at(results.to_table(), colour=X, map_x=X, map_y=X)
    # the shortest time is 110.4 s, see core's own tests of the plain scenario
    assert 0 < len(look.table.rows) < look.table.done == 32
    assert look.table.reason
    feasible = number_figures(look, None)[-1]
    assert f"{len(look.table.rows)} of 32" in feasible


def test_without_any_run_there_is_nothing_to_draw() -> None:
    results = MemoryResults(make_study(plain_scenario(), {X: (60.0, 70.0)}, 4))
    run_study(results)
    look = look_at(results.to_table(), colour=X, map_x=X, map_y=X)
    assert (look.table.done, look.chosen, look.raster, look.listed) == (4, 0, None, ())


def test_many_points_become_a_raster(table: SweepTable, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compute, "MAX_POINTS", 100)
    monkeypatch.setattr(compute, "RASTER_PX", (40, 30))
    found = look_at(table, choice={X: (150.0, 165.0)}).raster
    assert found.count.shape == found.mean.shape == (30, 40)
    assert 0 < found.count.sum() < found.count.sum() + found.others.sum() <= 200


def test_a_raster_counts_its_points_and_gives_their_mean() -> None:
    x, y, colour = np.array([0.1, 0.1, 0.9, 0.9]), np.array([0.1, 0.1, 0.9, 0.1]), np.array([1.0, 3.0, 7.0, 5.0])
    found = raster(x, y, colour, np.array([True, True, True, False]), ((0.0, 1.0), (0.0, 1.0)), (2, 2))
    assert found.count.tolist() == [[2, 0], [0, 1]]
    assert found.others.tolist() == [[0, 1], [0, 0]]
    assert (found.mean[0, 0], found.mean[1, 1]) == (2.0, 7.0)
    assert np.isnan(found.mean[0, 1])


@pytest.mark.parametrize("suffix", [".csv", ".parquet"])
def test_a_table_is_written_as_the_command_line_writes_it(table: SweepTable, suffix: str) -> None:
    file = table_file(table, suffix)
    read = pandas.read_csv(file) if suffix == ".csv" else pandas.read_parquet(file)
    assert len(read) == 200
    assert np.array_equal(read[ENERGY], table.columns[ENERGY])
    assert np.array_equal(read[X], table.samples[X])


def test_a_preview_has_the_first_rows_of_the_study_and_an_estimate() -> None:
    settings = Settings(plain_scenario(), ((LOAD, 0.0, 1.0),), 40, "sobol", 1, "optimal", (ENERGY,))
    *_, preview = preview_steps(settings)
    assert preview.table is not None
    assert preview.seconds > 0
    results = MemoryResults(settings.study())
    run_study(results)
    assert np.array_equal(preview.table.columns[ENERGY], results.to_table().columns[ENERGY][: preview.table.rows])


@pytest.mark.parametrize(
    ("over", "sample", "said"),
    [
        (((LOAD, 0.0, 5.0),), 10, "load_factor"),
        ((("vehicle.name", 0.0, 1.0),), 10, "is no number"),
        ((), 10, "a sweep varies 1 to"),
        (((LOAD, 0.0, 1.0),), 2**40, "sample"),
    ],
)
def test_what_cannot_be_begun_is_refused_in_a_sentence(
    over: tuple[tuple[str, float, float], ...], sample: int, said: str
) -> None:
    *_, preview = preview_steps(Settings(plain_scenario(), over, sample, "sobol", 1, "optimal", (ENERGY,)))
    assert preview.table is None
    assert said in preview.refusal
    assert preview.refusal.endswith(".")


def test_a_preview_has_enough_runs_to_name_the_input_that_decides(monkeypatch: pytest.MonkeyPatch) -> None:
    """In three seconds it had 48 of the 60 that five inputs take, and said "too few runs yet" in place of an answer."""
    # ten for each of two inputs and a constant
    monkeypatch.setattr(compute, "PREVIEW_RUNS", 4)
    over = tuple((path, 0.1, 0.9) for path in (LOAD, RECUPERATION))
    settings = Settings(plain_scenario(), over, 3000, "sobol", 1, "optimal", (ENERGY,))
    *_, preview = preview_steps(settings)
    assert preview.table is not None
    shares = compute_shares(preview.table)
    assert (preview.table.rows, shares.refusal) == (30, "")
    assert shares.fields == (RECUPERATION, LOAD)
    finding = finding_html(shares, study_columns(preview.table.study), "So far.")
    assert finding.startswith("<p class=finding>Recuperation factor decides ")
    assert ", then load factor " in finding
    assert finding.endswith(" So far.</p>")
    assert finding_html(Shares(refusal="too few"), {}, "") == ""
