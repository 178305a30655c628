"""What keeping a study's chunks costs: one SQLite file, beside parts in Parquet with a manifest, each safe from a kill.

`python -m tests.benchmarks.study_files` prints milliseconds a chunk and bytes on the disk over those of the numbers.
"""

import json
import os
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median

import numpy as np
import pyarrow
from pyarrow import parquet

from railjoule.core.arrays import FloatArray
from railjoule.core.studies.sweep import SweepFile, study_of
from railjoule.core.studies.sweep.results import Chunk
from railjoule.core.studies.sweep.rows import Rows
from railjoule.core.written import write_text
from tests.benchmarks.measurement import Measurement
from tests.benchmarks.sweep import OVER, profile_two

CHUNKS, ROWS = 200, 2048
COLUMNS = 4


def chunks() -> list[FloatArray]:
    """Return numbers as a study has them: no two the same, and none that packs well."""
    random = np.random.default_rng(1)
    return [random.random((ROWS, len(OVER) + COLUMNS)) for _ in range(CHUNKS)]


def time_each(keep: Callable[[int, FloatArray], None]) -> float:
    """Return the median time of keeping a chunk [s]."""
    taken = []
    for number, numbers in enumerate(chunks()):
        started = time.perf_counter()
        keep(number, numbers)
        taken.append(time.perf_counter() - started)
    return median(taken)


def in_sqlite(folder: Path) -> float:
    """Keep all chunks in a file of this project."""
    file = SweepFile.create(folder / "a.runs", study_of(profile_two(), OVER, CHUNKS * ROWS))

    def keep(number: int, numbers: FloatArray) -> None:
        file.append(Chunk(number * ROWS, numbers[:, COLUMNS:], Rows(numbers[:, :COLUMNS], {}, 1.0)), 1.0)

    with file:
        return time_each(keep)


def in_parquet(folder: Path) -> float:
    """Keep each chunk in a part of its own that is on the disk before the manifest names it."""
    named: list[str] = []

    def keep(number: int, numbers: FloatArray) -> None:
        part = folder / f"{number}.parquet"
        table = pyarrow.table({str(k): column for k, column in enumerate(numbers.T)})
        with part.open("wb") as file:
            parquet.write_table(table, file)
            file.flush()
            os.fsync(file.fileno())
        named.append(part.name)
        write_text(folder / "manifest.json", json.dumps(named))

    return time_each(keep)


def study_files() -> Iterator[Measurement]:
    """Both ways, with the same chunks."""
    numbers = CHUNKS * ROWS * (len(OVER) + COLUMNS) * 8
    for name, kept in (("SQLite, one file", in_sqlite), ("Parquet, parts and manifest", in_parquet)):
        with tempfile.TemporaryDirectory() as folder:
            yield Measurement(name, 1e3 * kept(Path(folder)), "ms a chunk")
            size = sum(path.stat().st_size for path in Path(folder).iterdir())
            yield Measurement(f"{name}: on the disk", size / numbers, "of the numbers' bytes")


if __name__ == "__main__":
    for measured in study_files():
        print(f"{measured.name:45}{measured.value:12,.3g} {measured.unit}", flush=True)
