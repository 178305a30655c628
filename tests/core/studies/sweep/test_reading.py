"""The file of a study is read as it was written, and any other file is one sentence."""

import io
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

from railjoule.core import load_scenario
from railjoule.core.studies.sweep import StudyFileError, SweepTable, sweep, write_rows
from railjoule.core.studies.sweep.table_files import read_study

TIME, LOAD = "timetable.travel_time_s", "vehicle.load_factor"
NO_STUDY = "x.nc does not contain a study of railjoule; a study is saved as a .nc file."


@pytest.fixture(scope="module")
def table() -> SweepTable:
    made = sweep(load_scenario("liashenko-i"), {TIME: (60.0, 150.0), LOAD: (0.0, 1.0)}, 24, seed=3)
    assert made.reasons
    return made


@pytest.fixture(scope="module")
def content(table: SweepTable, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path: Path = tmp_path_factory.mktemp("study") / "x.nc"
    write_rows(table, path)
    return path.read_bytes()


def test_a_study_is_read_as_it_was_written(table: SweepTable, content: bytes) -> None:
    read, is_same_solver = read_study(content, "x.nc", 100)
    assert is_same_solver
    assert read.study.identity == table.study.identity
    assert np.array_equal(read.index, table.index)
    for name in (TIME, LOAD):
        assert np.array_equal(read.samples[name], table.samples[name])
    for name, values in table.columns.items():
        assert np.array_equal(read.columns[name], values, equal_nan=True)
    assert dict(read.reasons) == dict(table.reasons)


def test_a_larger_study_than_allowed_is_one_sentence(content: bytes) -> None:
    with pytest.raises(StudyFileError, match=r"^x\.nc: a study of 24 runs; at most 23 can be opened\.$"):
        read_study(content, "x.nc", 23)


def changed(content: bytes, change: Callable[[xarray.Dataset], Any]) -> bytes:
    """Return the file with something else in it."""
    with xarray.load_dataset(io.BytesIO(content), engine="scipy") as dataset:
        found = change(dataset)
        return bytes((dataset if found is None else found).to_netcdf(engine="scipy"))


def with_identity(**values: Any) -> Callable[[xarray.Dataset], None]:
    def change(dataset: xarray.Dataset) -> None:
        dataset.attrs["railjoule_study"] = json.dumps({**json.loads(dataset.attrs["railjoule_study"]), **values})

    return change


@pytest.mark.parametrize(
    "change",
    [
        lambda data: data.attrs.clear(),
        lambda data: data.attrs.update(railjoule_study="{"),
        lambda data: data.attrs.update(railjoule_study="[1]"),
        lambda data: data.drop_vars(LOAD),
        lambda data: data.assign(energy_kwh=("other", np.zeros(3))),
        lambda data: data.assign_coords(row=data["row"][::-1]),
        lambda data: data.assign_coords(row=data["row"] + 1),
        lambda data: data.assign_coords(row=data["row"] - 1),
        lambda data: data.assign_coords(row=data["row"] * 0),
        lambda data: data.assign({LOAD: data[LOAD] * np.nan}),
        lambda data: data.assign(energy_kwh=data["energy_kwh"] + np.inf),
        lambda data: data.assign(row_without_run=("few", np.arange(24, dtype=np.int32))),
        with_identity(over=5),
        with_identity(columns=None),
    ],
)
def test_a_file_that_is_not_the_rows_of_a_study_is_one_sentence(
    content: bytes, change: Callable[[xarray.Dataset], Any]
) -> None:
    with pytest.raises(StudyFileError, match="^" + re.escape(NO_STUDY) + "$"):
        read_study(changed(content, change), "x.nc", 100)


@pytest.mark.parametrize("end", [0, 3, 40, 600, -1])
def test_a_damaged_file_is_one_sentence(content: bytes, end: int) -> None:
    with pytest.raises(StudyFileError, match="^" + re.escape(NO_STUDY) + "$"):
        read_study(content[:end], "x.nc", 100)


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"scenario": "title = 5"}, "x.nc: scenario.toml: title = 5 must be a text"),
        ({"sample": "many"}, "x.nc: sample = 'many' must be a whole number"),
    ],
)
def test_a_wrong_value_in_the_study_is_named(content: bytes, values: dict[str, Any], sentence: str) -> None:
    with pytest.raises(StudyFileError, match="^" + re.escape(sentence)):
        read_study(changed(content, with_identity(**values)), "x.nc", 100)


def test_a_scenario_of_a_stranger_names_no_file(content: bytes) -> None:
    scenario = '[vehicle]\npreset = "tram-105n"\n[line]\nfile = "/etc/passwd"\n[timetable]\ntravel_time_s = 100\n'
    with pytest.raises(StudyFileError, match="can only be read from a scenario file on disk"):
        read_study(changed(content, with_identity(scenario=scenario)), "x.nc", 100)


def test_rows_of_another_solver_are_known_as_such(content: bytes) -> None:
    _, is_same_solver = read_study(changed(content, with_identity(solver="another")), "x.nc", 100)
    assert not is_same_solver
