import numpy as np
import pytest

from railjoule.core import ScenarioError
from railjoule.core.studies.sweep import METHODS
from railjoule.core.studies.sweep.fields import Field, draw_rows, require_sample

FIELDS = (
    Field("vehicle.load_factor", ("vehicle", "load_factor"), 0.0, 1.0, whole=False),
    Field("timetable.travel_time_s", ("timetable", "travel_time_s"), 100.0, 140.0, whole=False),
    Field("drive.motors", ("vehicle", "drive", "motors"), 2.0, 5.0, whole=True),
)


def drawn(method, rows=64, sizes=(64,), seed=5, fields=FIELDS):
    firsts = np.cumsum((0, *sizes)).tolist()
    parts = zip(firsts[:-1], [min(end, rows) for end in firsts[1:]], strict=True)
    return np.concatenate([draw_rows(fields, rows, method, seed, first, end - first) for first, end in parts])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("sizes", [(1, 63), (2, 1, 5, 56), (63, 1), (40, 40)])
def test_a_row_does_not_depend_on_how_many_are_drawn_at_once(method, sizes):
    assert np.array_equal(drawn(method, sizes=sizes), drawn(method))


@pytest.mark.parametrize("method", ["random", "sobol", "halton"])
def test_a_longer_sample_begins_with_a_shorter_one_and_a_seed_draws_its_own(method):
    assert np.array_equal(drawn(method, 100, (100,))[:64], drawn(method))
    assert not np.array_equal(drawn(method, seed=6), drawn(method))


@pytest.mark.parametrize("method", METHODS)
def test_values_stay_within_their_ranges(method):
    values = drawn(method)
    for column, field in zip(values.T, FIELDS, strict=True):
        assert field.low <= column.min() <= column.max() <= field.high
    assert set(values[:, 2]) == {2.0, 3.0, 4.0, 5.0}


def test_a_grid_has_all_pairs_of_equal_steps():
    values = drawn("grid", 9, (9,), fields=FIELDS[:2])
    # three values of each, the last field fastest: from the definition of a grid
    assert values.tolist() == [[x, y] for x in (0.0, 0.5, 1.0) for y in (100.0, 120.0, 140.0)]


def test_sobol_points_halve_each_field():
    # a Sobol' sequence of 2^k points has half of them on either side of the middle of each field, whatever the seed
    values = drawn("sobol", 128, (128,))
    assert np.count_nonzero(values[:, 0] < 0.5) == 64
    assert np.count_nonzero(values[:, 1] < 120.0) == 64


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (10, "sample = 10: a grid over 3 fields has as many values of each, such as 8 or 27 rows"),
        (125, "drive.motors has 4 whole numbers, fewer than the 5 of the grid"),
    ],
)
def test_a_grid_that_is_none_is_refused(rows, words):
    with pytest.raises(ScenarioError, match=words):
        require_sample(FIELDS, rows, "grid", 0)
