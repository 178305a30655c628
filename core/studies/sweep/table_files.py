"""Write and read the rows of a study as a table file: CSV, Parquet, or netCDF, which can be read back.

Parquet and netCDF contain the identity and the fingerprint of the study. CSV and Parquet are written chunk by chunk,
for any number of rows.
"""

import io
import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.csv_text import csv_of_table
from railjoule.core.errors import RailjouleError
from railjoule.core.parquet import NEEDED, has_parquet
from railjoule.core.studies.rows import Chunk
from railjoule.core.studies.sweep.results import StudyFileError, SweepFile, SweepTable, join_chunks
from railjoule.core.studies.sweep.study import Study, study_from
from railjoule.core.written import written

if TYPE_CHECKING:
    import pandas

SUFFIXES = (".csv", ".parquet", ".nc")
ROWS_PER_GROUP = 65_536
"""Rows of a group in Parquet: larger groups are smaller on the disk, smaller ones need less memory."""
LONGEST_IDENTITY = 2_000_000


def require_format(path: Path) -> None:
    """Raise StudyFileError if the suffix of a file names no format that can be written here."""
    if path.suffix.lower() not in SUFFIXES:
        raise StudyFileError(f"{path.name}: a table ends in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}.")
    if path.suffix.lower() == ".parquet" and not has_parquet():
        raise StudyFileError(f"{path.name}: {NEEDED}")


def write_rows(results: SweepFile | SweepTable, path: str | Path) -> None:
    """Write all completed rows as a table, atomically.

    Parameters
    ----------
    results : SweepFile or SweepTable
    path : str or Path
        Its suffix selects the format.

    Raises
    ------
    StudyFileError
        If the format does not exist, or its library is not installed.
    ScenarioError
        If the table is too large for the memory, for netCDF.
    OSError
        If the file cannot be written.
    """
    target = Path(path)
    require_format(target)
    write = {".csv": _write_csv, ".parquet": _write_parquet, ".nc": _write_netcdf}[target.suffix.lower()]
    with written(target) as place:
        write(results, place)


def _origin(results: SweepFile | SweepTable) -> dict[str, str]:
    """Return the origin of the rows as attributes of a file."""
    return {
        "railjoule_study": json.dumps(results.study.identity),
        "railjoule_fingerprint": results.study.fingerprint,
        "railjoule_rows": f"{results.done} of {results.study.sample}",
    }


def _write_csv(results: SweepFile | SweepTable, place: Path) -> None:
    with place.open("w", encoding="utf-8", newline="") as file:
        for number, table in enumerate(_tables(results)):
            file.write(csv_of_table(table, header=number == 0))


def _write_parquet(results: SweepFile | SweepTable, place: Path) -> None:
    import pyarrow  # noqa: PLC0415  (slow to import, and rarely installed)
    from pyarrow import parquet  # noqa: PLC0415

    tables = (pyarrow.Table.from_pandas(table, preserve_index=False) for table in _tables(results))
    first = next(tables)
    schema = first.schema.with_metadata({**(first.schema.metadata or {}), **_origin(results)})
    with parquet.ParquetWriter(place, schema) as writer:
        writer.write_table(first.replace_schema_metadata(schema.metadata))
        for rows in tables:
            writer.write_table(rows.replace_schema_metadata(schema.metadata))


def _write_netcdf(results: SweepFile | SweepTable, place: Path) -> None:
    import xarray  # noqa: PLC0415  (slow to import, and rarely needed)

    table = results if isinstance(results, SweepTable) else results.to_table()
    columns: dict[str, Any] = {name: ("row", values) for name, values in {**table.samples, **table.columns}.items()}
    if table.reasons:
        # in a dimension of their own, as netCDF reserves space for the longest text in each row
        columns["row_without_run"] = "refused", np.array(list(table.reasons), dtype=np.int32)
        columns["reason"] = "refused", np.array([reason.encode() for reason in table.reasons.values()])
    coordinates = {"row": table.index.astype(np.int32)}
    xarray.Dataset(columns, coords=coordinates, attrs=_origin(results)).to_netcdf(place, engine="scipy")


def _tables(results: SweepFile | SweepTable) -> "Iterator[pandas.DataFrame]":
    """Yield the rows in order as tables of limited size; one without rows if there are none."""
    held: list[Chunk] = []
    for chunk in results.chunks():
        held.append(chunk)
        if held[-1].end - held[0].first >= ROWS_PER_GROUP:
            yield join_chunks(results.study, held, 0.0).to_dataframe()
            held = []
    if held or not results.done:
        yield join_chunks(results.study, held, 0.0).to_dataframe()


def read_study(content: bytes, name: str, max_rows: int) -> tuple[SweepTable, bool]:
    """Return the rows in a netCDF file of `write_rows`, and whether this solver made them, so that it can add rows.

    Parameters
    ----------
    content : bytes
    name : str
        Name of the file, for error messages.
    max_rows : int
        Largest permitted sample.

    Raises
    ------
    StudyFileError
        If it contains no study or a larger one, or its scenario is invalid.
    """
    refusal = StudyFileError(f"{name} does not contain a study of railjoule; a study is saved as a .nc file.")
    try:
        import xarray  # noqa: PLC0415  (slow to import, and rarely needed)

        with xarray.open_dataset(io.BytesIO(content), engine="scipy", decode_times=False) as dataset:
            identity = json.loads(str(dataset.attrs["railjoule_study"])[:LONGEST_IDENTITY])
            variables = {str(key): np.asarray(variable.values) for key, variable in dataset.variables.items()}
        study = study_from(identity)
        is_same_solver = identity["solver"] == study.identity["solver"]
        table = _table(study, variables)
    except RailjouleError as error:
        raise StudyFileError(f"{name}: {error}") from None
    # the libraries raise any exception for a damaged file
    except Exception:
        raise refusal from None
    if study.sample > max_rows:
        raise StudyFileError(f"{name}: a study of {study.sample:,} runs; at most {max_rows:,} can be opened.")
    return table, is_same_solver


def _table(study: Study, variables: dict[str, Any]) -> SweepTable:
    """Return the table of a study; raises KeyError or ValueError for variables that are not its rows."""
    index = variables["row"].astype(np.int64)
    samples = _columns(variables, [field.name for field in study.fields], len(index))
    columns = _columns(variables, study.columns, len(index))
    if index.ndim != 1 or np.any(np.diff(index) <= 0) or not np.all((index >= 0) & (index < study.sample)):
        raise ValueError
    if any(map(np.any, map(np.isinf, columns.values()))) or not all(map(np.all, map(np.isfinite, samples.values()))):
        raise ValueError
    refused = [int(row) for row in variables.get("row_without_run", ())]
    texts = [bytes(reason).decode("utf-8", "replace") for reason in variables.get("reason", ())]
    return SweepTable(study, index, samples, columns, dict(zip(refused, texts, strict=True)), 0.0)


def _columns(variables: dict[str, Any], names: Sequence[str], rows: int) -> dict[str, FloatArray]:
    columns = {name: variables[name].astype(float) for name in names}
    if any(column.shape != (rows,) for column in columns.values()):
        raise ValueError
    return columns
