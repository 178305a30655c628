"""Sobol' indices of a study: the share of each field in the variance of a column, from the completed rows.

A column is fitted by a polynomial of the fields that is orthonormal over their values, so that the squares of its
coefficients are shares of the variance: of one field (first order), and of all terms with it (total). Unlike Saltelli's
scheme this needs no further runs, and works while a study still runs.

References: Sobol', Mathematics and Computers in Simulation 55, 2001, for the indices; Sudret, Reliability Engineering
and System Safety 93, 2008, for their way from the coefficients.
"""

from collections.abc import Iterator
from itertools import combinations_with_replacement
from math import comb

import numpy as np
from numpy.polynomial import legendre

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.errors import RailjouleError
from railjoule.core.scenario._sentences import shorten, suggestion
from railjoule.core.studies.sweep.results import SweepFile, SweepTable
from railjoule.core.studies.sweep.study import Study
from railjoule.core.studies.table import StudyTable

# Terms cost their square for each row. Measured on liashenko-ii over time, load, recuperation and resistance: 126 terms
# explain all but 1e-5 of the energy's variance.
MAX_TERMS, MAX_DEGREE = 256, 10
ROWS_PER_TERM = 10
"""Fewest rows per coefficient: with fewer the polynomial would follow the noise between them."""
BATCHES = 10
"""The error is that of fits without one of these parts of the rows."""
MIN_SHARE_DRIVEN = 0.99
"""With more rows that cannot be driven the fields are no longer independent, which the indices need."""
DEVIATIONS = 1.96
"""Half width of an interval with 95 % of a normal distribution, in standard deviations."""
ROWS_AT_ONCE = 8192
"""Rows whose terms are in memory at a time."""


class SensitivityError(RailjouleError):
    """A study whose rows do not show which field decides."""


def sensitivities(results: SweepFile | SweepTable, column: str = "energy_kwh") -> StudyTable:
    """Return the share of each field in the variance of a column, from the completed rows of a study.

    The table over `fields` has the columns `first` and `total`, Sobol' indices of a field by itself and with all its
    interactions, and `first_error` and `total_error`, half the width of their 95 % intervals. Its attributes are
    `column`, `rows`, the number of rows used, and `explained`, the share of the variance that the polynomial explains;
    the indices are shares of this part.

    Parameters
    ----------
    results : SweepFile or SweepTable
    column : str
        A column of the study.

    Raises
    ------
    SensitivityError
        If the column does not exist or does not vary, too few rows are completed, or too many cannot be driven.
    """
    study, done = results.study, results.done
    if column not in study.columns:
        words = suggestion(column, study.columns)
        raise SensitivityError(f"the study has no column {shorten(column)}: {words}.".replace("?.", "?"))
    degree = _degree(len(study.fields), done)
    terms, rows = _terms(study, degree), 0
    bases = [_basis(study.level_count(field), degree) for field in study.fields]
    moments = np.zeros((BATCHES, len(terms) + 1, len(terms) + 1))
    for numbers, samples, values in _blocks(results, study.columns.index(column)):
        rows += len(numbers)
        matrix = np.column_stack([_design(study, bases, terms, samples), values])
        for batch in range(BATCHES):
            part = matrix[numbers % BATCHES == batch]
            moments[batch] += part.T @ part
    if rows < MIN_SHARE_DRIVEN * done:
        raise SensitivityError(
            f"{done - rows:,} of {done:,} rows cannot be driven: shares of the spread need ranges "
            f"in which {MIN_SHARE_DRIVEN:.0%} can."
        )
    whole = moments.sum(axis=0)
    square = whole[-1, -1] / rows
    variance = square - (whole[0, -1] / rows) ** 2
    # rounding leaves a little variance of equal numbers
    if not variance > 1e-12 * square:
        raise SensitivityError(f"{column} does not vary over the rows: no field decides it.")
    first, total, coefficients = _shares(terms, whole)
    without = [_shares(terms, whole - moment)[:2] for moment in moments]
    # the jackknife: fits without a tenth of the rows differ less than fits to a tenth
    errors = DEVIATIONS * np.sqrt(BATCHES - 1) * np.std(without, axis=0)
    left = whole[-1, -1] - coefficients @ whole[:-1, -1]
    return StudyTable(
        study.scenario,
        {"fields": tuple(field.name for field in study.fields)},
        {"first": first, "total": total, "first_error": errors[0], "total_error": errors[1]},
        {"column": column, "rows": rows, "explained": float(1 - left / (rows * variance))},
        rows,
    )


def _degree(fields: int, rows: int) -> int:
    """Return the highest degree whose coefficients that many rows can determine."""
    most = min(MAX_TERMS, rows // ROWS_PER_TERM)
    degrees = [degree for degree in range(1, MAX_DEGREE + 1) if comb(fields + degree, degree) <= most]
    if not degrees:
        raise SensitivityError(
            f"{rows:,} rows are too few to tell which of {fields} fields decides: it takes "
            f"{ROWS_PER_TERM * (fields + 1)}."
        )
    return degrees[-1]


def _terms(study: Study, degree: int) -> IntArray:
    """Return the powers of each term up to a total degree, each below the number of values of its field.

    The first term is the constant.
    """
    highest = [degree if levels is None else levels - 1 for levels in map(study.level_count, study.fields)]
    terms = [
        [chosen.count(k) for k in range(len(highest))]
        for total in range(degree + 1)
        for chosen in combinations_with_replacement(range(len(highest)), total)
    ]
    return np.array([term for term in terms if all(power <= most for power, most in zip(term, highest, strict=True))])


def _basis(levels: int | None, degree: int) -> FloatArray:
    """Return the matrix that makes Legendre's polynomials orthonormal over equal steps, or over a whole range."""
    if levels is None:
        nodes, weights = legendre.leggauss(degree + 1)
        weights = weights / 2
    else:
        nodes, weights = np.linspace(-1, 1, max(levels, 2))[:levels], np.full(levels, 1 / levels)
    _, upper = np.linalg.qr(np.sqrt(weights)[:, None] * legendre.legvander(nodes, min(degree, len(nodes) - 1)))
    inverse: FloatArray = np.linalg.inv(upper)
    return inverse


def _design(study: Study, bases: list[FloatArray], terms: IntArray, samples: FloatArray) -> FloatArray:
    """Return each term at each row; shape (rows, terms)."""
    values = np.ones((len(samples), len(terms)))
    for k, (field, basis) in enumerate(zip(study.fields, bases, strict=True)):
        width = field.high - field.low
        place = 2 * (samples[:, k] - field.low) / width - 1 if width else np.full(len(samples), -1.0)
        values *= (legendre.legvander(place, len(basis) - 1) @ basis)[:, terms[:, k]]
    return values


def _blocks(results: SweepFile | SweepTable, column: int) -> Iterator[tuple[IntArray, FloatArray, FloatArray]]:
    """Yield numbers, samples and values of limited numbers of rows that have a run."""
    for chunk in results.chunks():
        for start in range(0, len(chunk.samples), ROWS_AT_ONCE):
            values = chunk.rows.values[start : start + ROWS_AT_ONCE, column]
            known = start + np.flatnonzero(np.isfinite(values))
            yield chunk.first + known, chunk.samples[known], chunk.rows.values[known, column]


def _shares(terms: IntArray, moments: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return first order and total indices by field, and the coefficients, from products summed over the rows."""
    # `solve` fails for fields of few values, which may leave terms that are equal at all rows
    coefficients = np.asarray(np.linalg.lstsq(moments[:-1, :-1], moments[:-1, -1], rcond=None)[0], dtype=np.float64)
    squares = coefficients**2
    # the first term is the mean
    squares[0] = 0.0
    active = terms > 0
    single = active & (active.sum(axis=1) == 1)[:, None]
    variance = squares.sum()
    return squares @ single / variance, squares @ active / variance, coefficients
