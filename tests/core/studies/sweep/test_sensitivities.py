"""The shares are held against SciPy's, which takes another way: runs of its own in Saltelli's scheme."""

import numpy as np
import pytest
import scipy

from railjoule.core import load_scenario
from railjoule.core.studies.rows import Chunk, Rows
from railjoule.core.studies.sweep import MemoryResults, SensitivityError, make_study, run_study, sensitivities
from railjoule.core.studies.sweep.engine import solve_rows
from tests.builders import plain_scenario

# any three numbers: what comes out is put in by hand
THREE = {
    "vehicle.load_factor": (0.0, 1.0),
    "drive.recuperation_factor": (0.2, 0.6),
    "timetable.travel_time_s": (150.0, 250.0),
}


def results_of(function, rows=4096, method="sobol", over=THREE):
    """Return a study whose energy is a function of the fields' places, 0 to 1 each."""
    study = make_study(plain_scenario(), over, rows, method, columns=("energy_kwh",))
    samples = study.draw(0, rows)
    low, high = (np.array([getattr(field, end) for field in study.fields]) for end in ("low", "high"))
    values = function(*((samples - low) / (high - low)).T)
    results = MemoryResults(study)
    for first in range(0, rows, 1000):
        here = slice(first, first + 1000)
        results.append(Chunk(first, samples[here], Rows(values[here, None], {}, 1.0)), 1.0)
    return results


def ishigami(x, y, z):
    x, y, z = (np.pi * (2 * place - 1) for place in (x, y, z))
    return np.sin(x) + 7 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)


def test_ishigami_s_function_has_its_known_shares():
    # Ishigami and Homma, 1990, with a = 7, b = 0.1: variances in closed form
    a, b = 7.0, 0.1
    one, two = 0.5 * (1 + b * np.pi**4 / 5) ** 2, a**2 / 8
    both = b**2 * np.pi**8 * (1 / 18 - 1 / 50)
    whole = one + two + both
    told = sensitivities(results_of(ishigami, 16_384))
    assert told.first == pytest.approx([one / whole, two / whole, 0], abs=0.01)
    assert told.total == pytest.approx([(one + both) / whole, two / whole, both / whole], abs=0.01)
    assert 0.98 < told.explained < 1


@pytest.mark.parametrize("method", ["random", "sobol", "halton", "grid"])
def test_shares_of_a_product_are_exact_however_the_rows_are_drawn(method):
    # over equal shares of 0 to 1: x + 2 y has the variances 1/12 and 4/12, whatever the third
    rows = 4096
    told = sensitivities(results_of(lambda x, y, _z: x + 2 * y, rows, method))
    assert told.first == pytest.approx([0.2, 0.8, 0], abs=1e-9)
    assert (told.total, told.explained) == (pytest.approx(told.first, abs=1e-9), pytest.approx(1))
    assert told.rows == rows


def test_few_whole_numbers_are_no_range():
    # over the values 1 and 2 alone the places are 0 and 1, with variance 1/4; the load's is 1/12
    over = {"vehicle.load_factor": (0.0, 1.0), "montecarlo.runs": (1, 2)}
    told = sensitivities(results_of(lambda x, y: x + y, over=over))
    assert told.first == pytest.approx([0.25, 0.75], abs=1e-3)


def test_shares_of_a_metro_s_energy_agree_with_scipy_s():
    base = load_scenario("liashenko-ii").replace(**{"solver.mesh_m": 50.0})
    over = {
        "timetable.travel_time_s": (105.0, 130.0),
        "vehicle.load_factor": (0.0, 1.0),
        "drive.recuperation_factor": (0.2, 0.6),
    }
    results = MemoryResults(make_study(base, over, 1024, columns=("energy_kwh",)))
    run_study(results)
    told = sensitivities(results)

    def energy(places):
        (low, high) = np.array(list(over.values())).T
        study = make_study(base, over, places.shape[1], columns=("energy_kwh",))
        return solve_rows(study, low + (high - low) * places.T).values[:, 0]

    theirs = scipy.stats.sobol_indices(func=energy, n=512, dists=[scipy.stats.uniform()] * 3, rng=1)
    # SciPy's own error with 512 rows is about a hundredth
    assert told.first == pytest.approx(theirs.first_order, abs=0.02)
    assert told.total == pytest.approx(theirs.total_order, abs=0.02)
    assert told.explained > 0.999


def test_the_error_covers_what_more_rows_change():
    noise = np.random.default_rng(1).normal(size=16_384)

    def noisy(x, y, z):
        return x + 2 * y * z + noise[: len(x)]

    few, many = sensitivities(results_of(noisy, 1024)), sensitivities(results_of(noisy, 16_384))
    assert np.all(np.abs(few.first - many.first) < 2 * few.first_error)
    assert np.all(many.first_error < few.first_error)


@pytest.mark.parametrize(
    ("results", "column", "words"),
    [
        (lambda: results_of(ishigami, 39), "energy_kwh", "39 rows are too few to tell which of 3 fields decides: it"),
        (lambda: results_of(ishigami), "energy", "has no column energy: did you mean 'energy_kwh'"),
        (lambda: results_of(lambda x, _y, _z: 0 * x + 3), "energy_kwh", "energy_kwh does not vary"),
        (lambda: results_of(lambda x, _y, _z: np.where(x < 0.1, np.nan, x)), "energy_kwh", "rows cannot be driven"),
    ],
)
def test_what_tells_nothing_is_refused_in_a_sentence(results, column, words):
    with pytest.raises(SensitivityError, match=words):
        sensitivities(results(), column)


def test_a_table_s_columns_serve_as_well_as_energy():
    base = plain_scenario({"timetable.travel_time_s": 170.0})
    results = MemoryResults(make_study(base, {"timetable.travel_time_s": (150.0, 200.0)}, 64))
    run_study(results)
    assert sensitivities(results, "price_of_time_w").first == pytest.approx([1.0])
