import json

import numpy as np
import pandas
import pytest
import xarray
from pyarrow import parquet

from railjoule.core.studies.sweep import (
    MemoryResults,
    StudyFileError,
    make_study,
    run_study,
    table_files,
    write_rows,
)
from tests.builders import plain_scenario

# the shortest possible time of the plain train lies between both ends
OVER = {"vehicle.load_factor": (0.0, 1.0), "timetable.travel_time_s": (50.0, 200.0)}


@pytest.fixture(scope="module")
def results():
    kept = MemoryResults(make_study(plain_scenario(), OVER, 200))
    run_study(kept)
    return kept


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".nc"])
def test_a_table_is_read_back_to_the_last_bit(results, suffix, tmp_path, monkeypatch):
    # of several groups of rows each
    monkeypatch.setattr(table_files, "ROWS_PER_GROUP", 70)
    path, table = tmp_path / f"table{suffix}", results.to_table()
    write_rows(results, path)
    if suffix == ".nc":
        read = xarray.open_dataset(path, engine="scipy")
        reasons = dict(zip(read["row_without_run"].values.tolist(), read["reason"].values.astype(str), strict=True))
    else:
        read = pandas.read_csv(path, keep_default_na=False) if suffix == ".csv" else pandas.read_parquet(path)
        reasons = {row: reason for row, reason in enumerate(read["reason"]) if reason}
    assert reasons == table.reasons != {}
    for name, values in {**table.samples, **table.columns}.items():
        assert np.array_equal(pandas.to_numeric(np.asarray(read[name])), values, equal_nan=True)


def test_a_file_tells_where_its_rows_come_from(results, tmp_path):
    write_rows(results, tmp_path / "table.parquet")
    told = parquet.read_schema(tmp_path / "table.parquet").metadata
    assert told[b"railjoule_fingerprint"].decode() == results.study.fingerprint
    assert json.loads(told[b"railjoule_study"]) == results.study.identity
    assert told[b"railjoule_rows"] == b"200 of 200"


@pytest.mark.parametrize("suffix", [".csv", ".parquet", ".nc"])
def test_a_study_without_rows_is_a_table_without_rows(suffix, tmp_path):
    path = tmp_path / f"table{suffix}"
    write_rows(MemoryResults(make_study(plain_scenario(), OVER, 5)), path)
    assert path.stat().st_size > 0
    if suffix == ".csv":
        assert path.read_text().startswith("vehicle.load_factor,timetable.travel_time_s,energy_kwh")


def test_what_cannot_be_written_is_told(results, tmp_path, monkeypatch):
    with pytest.raises(StudyFileError, match=r"table\.txt: a table ends in \.csv, \.parquet or \.nc"):
        write_rows(results, tmp_path / "table.txt")
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    with pytest.raises(StudyFileError, match="parquet needs pyarrow"):
        write_rows(results, tmp_path / "table.parquet")
    assert list(tmp_path.iterdir()) == []
