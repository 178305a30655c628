"""Which field decides: Sobol' indices of a study, from the rows that it has.

Any column is fitted by a polynomial of the fields that is orthonormal over their values, so that the squares of its
coefficients are shares of the variance: of one field alone (first order), and of all terms with it (total). It needs no
further runs, as Saltelli's scheme would, and serves while a study still runs.

References: Sobol', Mathematics and Computers in Simulation 55, 2001, for the indices; Sudret, Reliability Engineering
and System Safety 93, 2008, for their way from the coefficients.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations_with_replacement
from math import comb

import numpy as np
from numpy.polynomial import legendre

from railjoule.core.arrays import FloatArray, IntArray, frozen_array
from railjoule.core.errors import RailjouleError
from railjoule.core.scenario._sentences import shorten, suggestion
from railjoule.core.studies.sweep.fields import Field
from railjoule.core.studies.sweep.results import Done
from railjoule.core.studies.sweep.study import Study

# Terms cost their square for each row. Measured on liashenko-ii over time, load, recuperation and resistance: 126 terms
# explain all but 1e-5 of the energy's variance.
MOST_TERMS, HIGHEST_DEGREE = 256, 10
ROWS_A_TERM = 10
"""Rows for each coefficient at least: with fewer the polynomial would follow the noise between them."""
BATCHES = 10
"""By which the error is told: the fit without each tenth of the rows."""
LEAST_SHARE_DRIVEN = 0.99
"""With more rows that cannot be driven the fields are no longer independent, which the indices need."""
# of a normal distribution, for an interval that holds 95 of 100
DEVIATIONS = 1.96
ROWS_AT_ONCE = 8192


class SensitivityError(RailjouleError):
    """A study whose rows do not tell which field decides."""


@dataclass(frozen=True, eq=False)
class Sensitivities:
    """Shares of a column's variance; arrays of shape (fields,), in the order of the fields.

    Parameters
    ----------
    fields : tuple of str
        Their paths.
    column : str
        What varies.
    first, total : array
        Share of a field alone, and with all that it does together with others: Sobol' indices of first order and total.
    first_error, total_error : array
        Half the width of an interval that holds 95 of 100 of them.
    explained : float
        Share of the variance that the polynomial follows; the shares are of this part.
    rows : int
        How many rows were used.
    """

    fields: tuple[str, ...]
    column: str
    first: FloatArray
    total: FloatArray
    first_error: FloatArray
    total_error: FloatArray
    explained: float
    rows: int


def sensitivities(results: Done, column: str = "energy_kwh") -> Sensitivities:
    """Return which field decides a column of a study, from the rows that are done.

    Parameters
    ----------
    results : Done
    column : str
        One of the study's own.

    Raises
    ------
    SensitivityError
        If there is no such column, too few rows are done, too many cannot be driven, or the column does not vary.
    """
    study = results.study
    if column not in study.columns:
        words = suggestion(column, study.columns)
        raise SensitivityError(f"the study has no column {shorten(column)}: {words}.".replace("?.", "?"))
    degree = _degree(study, results.done)
    terms, driven = _terms(study, degree), 0
    bases = [_basis(field, study.level_count(field), degree) for field in study.fields]
    moments = np.zeros((BATCHES, len(terms) + 1, len(terms) + 1))
    for first, samples, values in _blocks(results, study.columns.index(column)):
        known = np.isfinite(values)
        driven += int(known.sum())
        matrix = np.column_stack([_design(study, bases, terms, samples[known]), values[known]])
        batches = np.arange(first, first + len(values))[known] % BATCHES
        for batch in range(BATCHES):
            part = matrix[batches == batch]
            moments[batch] += part.T @ part
    if driven < LEAST_SHARE_DRIVEN * results.done:
        raise SensitivityError(
            f"{results.done - driven:,} of {results.done:,} rows cannot be driven: shares of the spread need ranges "
            f"in which {LEAST_SHARE_DRIVEN:.0%} can."
        )
    return _told(study, column, terms, moments, driven)


def _degree(study: Study, rows: int) -> int:
    """Return how high the powers may be: as so many rows can tell apart."""
    count = len(study.fields)
    most = min(MOST_TERMS, rows // ROWS_A_TERM)
    degrees = [degree for degree in range(1, HIGHEST_DEGREE + 1) if comb(count + degree, degree) <= most]
    if not degrees:
        raise SensitivityError(
            f"{rows:,} rows are too few to tell which of {count} fields decides: it takes {ROWS_A_TERM * (count + 1)}."
        )
    return degrees[-1]


def _terms(study: Study, degree: int) -> IntArray:
    """Return the powers of each term up to a degree in all, of each field lower than it has values; the first is 1."""
    highest = [degree if levels is None else levels - 1 for levels in map(study.level_count, study.fields)]
    terms = [
        [chosen.count(k) for k in range(len(study.fields))]
        for of in range(degree + 1)
        for chosen in combinations_with_replacement(range(len(study.fields)), of)
    ]
    return np.array([term for term in terms if all(power <= most for power, most in zip(term, highest, strict=True))])


def _basis(field: Field, levels: int | None, degree: int) -> FloatArray:
    """Return what makes Legendre's polynomials orthonormal over a field's values: all of a range, or equal steps."""
    if levels is None:
        nodes, weights = legendre.leggauss(degree + 1)
        weights = weights / 2
    else:
        nodes, weights = np.linspace(-1, 1, max(levels, 2))[:levels], np.full(levels, 1 / levels)
    degree = min(degree, len(nodes) - 1)
    _, upper = np.linalg.qr(np.sqrt(weights)[:, None] * legendre.legvander(nodes, degree))
    inverse: FloatArray = np.linalg.inv(upper)
    return inverse


def _design(study: Study, bases: list[FloatArray], terms: IntArray, samples: FloatArray) -> FloatArray:
    """Return each term at each row; shape (rows, terms)."""
    values = np.ones((len(samples), len(terms)))
    for k, (field, basis) in enumerate(zip(study.fields, bases, strict=True)):
        width = field.high - field.low
        place = 2 * (samples[:, k] - field.low) / width - 1 if width else np.full(len(samples), -1.0)
        powers = legendre.legvander(place, len(basis) - 1) @ basis
        values *= powers[:, terms[:, k]]
    return values


def _blocks(results: Done, column: int) -> Iterator[tuple[int, FloatArray, FloatArray]]:
    """Yield the first row, the samples and the values of so many rows at once that the memory takes their terms."""
    for chunk in results.chunks():
        for start in range(0, len(chunk.samples), ROWS_AT_ONCE):
            here = slice(start, start + ROWS_AT_ONCE)
            yield chunk.first + start, chunk.samples[here], chunk.rows.values[here, column]


def _told(study: Study, column: str, terms: IntArray, moments: FloatArray, rows: int) -> Sensitivities:
    whole = moments.sum(axis=0)
    mean, square = whole[0, -1] / rows, whole[-1, -1] / rows
    variance = square - mean**2
    # of numbers that are all the same rounding leaves a little
    if not variance > 1e-12 * square:
        raise SensitivityError(f"{column} does not vary over the rows: no field decides it.")
    first, total, coefficients = _shares(terms, whole)
    without = [_shares(terms, whole - moment)[:2] for moment in moments]
    # of the jackknife: the fits without a tenth differ less than tenths would
    errors = DEVIATIONS * np.sqrt(BATCHES - 1) * np.std(without, axis=0)
    left = whole[-1, -1] - coefficients @ whole[:-1, -1]
    return Sensitivities(
        tuple(field.name for field in study.fields),
        column,
        frozen_array(first),
        frozen_array(total),
        frozen_array(errors[0]),
        frozen_array(errors[1]),
        float(1 - left / (rows * variance)),
        rows,
    )


def _shares(terms: IntArray, moments: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return first order and total indices by the field, and the coefficients, of products summed over rows."""
    # not `solve`: fields of few values may leave terms that are the same at all rows
    coefficients = np.asarray(np.linalg.lstsq(moments[:-1, :-1], moments[:-1, -1], rcond=None)[0], dtype=np.float64)
    squares = coefficients**2
    # the first term is the mean
    squares[0] = 0.0
    active = terms > 0
    alone = active & (active.sum(axis=1) == 1)[:, None]
    variance = squares.sum()
    return squares @ alone / variance, squares @ active / variance, coefficients
