import pytest

from railjoule import core
from railjoule.core import RailjouleError, TimetableError


@pytest.mark.parametrize("name", [name for name in core.__all__ if name.endswith("Error")])
def test_every_error_can_be_caught_as_one_kind(name):
    assert issubclass(getattr(core, name), RailjouleError)


def test_a_timetable_error_carries_both_times():
    error = TimetableError(100, 110.36)
    assert (error.travel_time_s, error.shortest_time_s) == (100, 110.36)
    assert str(error) == "timetable.travel_time_s = 100 s is shorter than the shortest possible 110.4 s."
