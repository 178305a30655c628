"""Rows of a study as a table in a file: CSV or Parquet, chunk by chunk whatever their number, or netCDF.

The file says in its own words where it comes from: Parquet and netCDF carry the study's identity and fingerprint.
"""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from railjoule.core.csv_text import csv_of_table
from railjoule.core.errors import RailjouleError
from railjoule.core.parquet import NEEDED, has_parquet
from railjoule.core.studies.sweep.results import Chunk, Done, chunk_table, table_of
from railjoule.core.written import written

if TYPE_CHECKING:
    import pandas

SUFFIXES = (".csv", ".parquet", ".nc")
# of Parquet: larger groups are packed better, smaller ones need less memory
ROWS_A_GROUP = 65_536


class ExportError(RailjouleError):
    """A table that cannot be written."""


def require_format(path: Path) -> None:
    """Raise ExportError if the name of a file ends in no format that can be written here."""
    if path.suffix.lower() not in SUFFIXES:
        raise ExportError(f"{path.name}: a table ends in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}.")
    if path.suffix.lower() == ".parquet" and not has_parquet():
        raise ExportError(f"{path.name}: {NEEDED}")


def write_rows(results: Done, path: str | Path) -> None:
    """Write all rows that are done as a table; the file is there as a whole or stays as it was.

    Parameters
    ----------
    results : Done
    path : str or Path
        Its ending tells the format.

    Raises
    ------
    ExportError
        If the format is none, or what it needs is not installed.
    ScenarioError
        If netCDF is asked for and the table is too large for the memory.
    OSError
        If the file cannot be written.
    """
    target = Path(path)
    require_format(target)
    write = {".csv": _write_csv, ".parquet": _write_parquet, ".nc": _write_netcdf}[target.suffix.lower()]
    with written(target) as place:
        write(results, place)


def origin_of(results: Done) -> dict[str, str]:
    """Return what a file tells of its rows' origin, by name."""
    study = results.study
    return {
        "railjoule_study": json.dumps(study.identity),
        "railjoule_fingerprint": study.fingerprint,
        "railjoule_rows": f"{results.done} of {study.sample}",
    }


def _write_csv(results: Done, place: Path) -> None:
    with place.open("w", encoding="utf-8", newline="") as file:
        for number, table in enumerate(_tables(results)):
            file.write(csv_of_table(table, header=number == 0))


def _write_parquet(results: Done, place: Path) -> None:
    import pyarrow  # noqa: PLC0415  (slow to import, and seldom there)
    from pyarrow import parquet  # noqa: PLC0415

    writer: Any = None
    try:
        for table in _tables(results):
            rows = pyarrow.Table.from_pandas(table, preserve_index=False)
            if writer is None:
                origin = {**(rows.schema.metadata or {}), **origin_of(results)}
                writer = parquet.ParquetWriter(place, rows.schema.with_metadata(origin))
            writer.write_table(rows.replace_schema_metadata(writer.schema.metadata))
    finally:
        if writer is not None:
            writer.close()


def _write_netcdf(results: Done, place: Path) -> None:
    import xarray  # noqa: PLC0415  (slow to import, and seldom needed)

    table = table_of(results)
    columns: dict[str, Any] = {name: ("row", values) for name, values in {**table.samples, **table.columns}.items()}
    if table.reasons:
        # of their own: beside each row its format would keep room for the longest sentence
        columns["row_without_run"] = "refused", np.array(list(table.reasons), dtype=np.int32)
        columns["reason"] = "refused", np.array([reason.encode() for reason in table.reasons.values()])
    coordinates = {"row": table.index.astype(np.int32)}
    xarray.Dataset(columns, coords=coordinates, attrs=origin_of(results)).to_netcdf(place, engine="scipy")


def _tables(results: Done) -> "Iterator[pandas.DataFrame]":
    """Yield the rows in order as tables of at most so many; one without rows if there are none."""
    held: list[Chunk] = []
    count = 0
    for chunk in results.chunks():
        held.append(chunk)
        count += len(chunk.samples)
        if count >= ROWS_A_GROUP:
            yield chunk_table(results.study, held, 0.0).to_dataframe()
            held, count = [], 0
    if held or not results.done:
        yield chunk_table(results.study, held, 0.0).to_dataframe()
