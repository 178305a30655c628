"""Lines in running order."""

import math

from builders import HILLS
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.scenario import Line

LENGTH_M = sum(section["length_m"] for section in HILLS)
places = st.floats(0, LENGTH_M)


@st.composite
def lines(draw):
    ends = sorted(draw(st.lists(st.integers(0, int(LENGTH_M)), min_size=2, max_size=2, unique=True)))
    stations = sorted(draw(st.lists(st.integers(0, int(LENGTH_M) // 2), max_size=4, unique=True)))
    return Line.model_validate(
        {
            "sections": HILLS,
            "speed_limits": [{"from_m": ends[0], "to_m": ends[1], "limit_kmh": 50}],
            "neutral_sections": [{"from_m": ends[0] / 2, "to_m": ends[1] / 2}, {"from_m": ends[0], "to_m": ends[1]}],
            "stations": [{"position_m": 2 * place, "dwell_s": 10 + place} for place in stations],
        }
    )


def reversed_line(line):
    return line.model_copy(update={"reverse": True}).in_running_order()


@given(lines())
def test_a_line_reversed_twice_is_the_line(line):
    again = reversed_line(reversed_line(line))
    assert again.sections == line.sections
    for one, other in zip(again.stations, line.stations, strict=True):
        assert math.isclose(one.position_m, other.position_m, abs_tol=1e-9)
        assert one.dwell_s == other.dwell_s
    for key in ("speed_limits", "neutral_sections"):
        for one, other in zip(getattr(again, key), getattr(line, key), strict=True):
            assert math.isclose(one.from_m, other.from_m, abs_tol=1e-9)
            assert math.isclose(one.to_m, other.to_m, abs_tol=1e-9)


@given(lines())
def test_reversing_mirrors_places_and_negates_gradients(line):
    turned = reversed_line(line)
    assert turned.length_m == line.length_m
    assert [section.gradient_permille for section in turned.sections] == [
        -section["gradient_permille"] if "gradient_permille" in section else 0 for section in HILLS[::-1]
    ]
    assert [station.position_m for station in turned.stations] == [
        LENGTH_M - station.position_m for station in line.stations[::-1]
    ]
    for key in ("speed_limits", "neutral_sections"):
        assert [(one.from_m, one.to_m) for one in getattr(turned, key)] == [
            (LENGTH_M - one.to_m, LENGTH_M - one.from_m) for one in getattr(line, key)[::-1]
        ]
    # a line that was turned is valid as it stands
    assert Line.model_validate(turned.model_dump()) == turned


def test_a_forward_line_is_itself():
    line = Line.model_validate({"sections": HILLS})
    assert line.in_running_order() is line


def test_stations_at_the_ends_are_no_stops_on_the_way():
    stations = [{"position_m": 0.0, "dwell_s": 5.0}, {"position_m": 700.0}, {"position_m": LENGTH_M, "dwell_s": 5.0}]
    line = Line.model_validate({"sections": HILLS, "stations": stations})
    assert [station.position_m for station in line.inner_stations] == [700.0]
