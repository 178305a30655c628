"""Read the rows of a study from a netCDF file, as `write_rows` writes them."""

import io
import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import RailjouleError
from railjoule.core.studies.sweep.results import Chunk, SweepTable, chunk_table
from railjoule.core.studies.sweep.rows import Rows
from railjoule.core.studies.sweep.study import Study, study_from

LONGEST_IDENTITY = 2_000_000


class StudyReadError(RailjouleError):
    """A file that does not contain the rows of a study."""


@dataclass(frozen=True, eq=False)
class ReadStudy:
    """The rows of a study, and whether this version of the solver made them, so that more can be added."""

    table: SweepTable
    is_same_solver: bool


def read_study(content: bytes, name: str, most_rows: int) -> ReadStudy:
    """Return the study in the content of a netCDF file.

    Parameters
    ----------
    content : bytes
    name : str
        The name of the file, for error messages.
    most_rows : int
        The largest sample that is read.

    Raises
    ------
    StudyReadError
        If it contains none, or a larger one, or anything is wrong in its scenario.
    """
    refusal = StudyReadError(f"{name} does not contain a study of railjoule; a study is saved as a .nc file.")
    try:
        import xarray  # noqa: PLC0415  (slow to import, and rarely needed)

        with xarray.open_dataset(io.BytesIO(content), engine="scipy", decode_times=False) as dataset:
            identity = json.loads(str(dataset.attrs["railjoule_study"])[:LONGEST_IDENTITY])
            variables = {str(key): np.asarray(variable.values) for key, variable in dataset.variables.items()}
        study = study_from(identity)
    except RailjouleError as error:
        raise StudyReadError(f"{name}: {error}") from None
    # the libraries raise anything for a damaged file
    except Exception:
        raise refusal from None
    if study.sample > most_rows:
        raise StudyReadError(f"{name}: a study of {study.sample:,} runs; at most {most_rows:,} can be opened.")
    try:
        return ReadStudy(_table(study, variables), identity["solver"] == study.identity["solver"])
    except (KeyError, ValueError, TypeError, AttributeError):
        raise refusal from None


def _table(study: Study, variables: dict[str, Any]) -> SweepTable:
    """Return the table of a study; raises KeyError or ValueError for variables that are not its rows."""
    index = variables["row"].astype(np.int64)
    samples = _columns(variables, [field.name for field in study.fields], len(index))
    values = _columns(variables, study.columns, len(index))
    is_in_order = index.ndim == 1 and np.all(np.diff(index) > 0)
    if not is_in_order or np.isinf(values).any() or not np.isfinite(samples).all():
        raise ValueError
    if len(index) and not 0 <= index[0] <= index[-1] < study.sample:
        raise ValueError
    refused = [int(row) for row in variables.get("row_without_run", ())]
    texts = [bytes(reason).decode("utf-8", "replace") for reason in variables.get("reason", ())]
    reasons = dict(zip(refused, texts, strict=True))
    chunks = []
    for part in np.split(np.arange(len(index)), np.flatnonzero(np.diff(index) != 1) + 1):
        if len(part):
            first, last = int(index[part[0]]), int(index[part[-1]])
            inside = {row - first: reason for row, reason in reasons.items() if first <= row <= last}
            chunks.append(Chunk(first, samples[part], Rows(values[part], inside, 0.0)))
    return chunk_table(study, chunks, 0.0)


def _columns(variables: dict[str, Any], names: Any, rows: int) -> FloatArray:
    columns = [variables[name].astype(float) for name in names]
    if any(column.shape != (rows,) for column in columns):
        raise ValueError
    return np.column_stack(columns)
