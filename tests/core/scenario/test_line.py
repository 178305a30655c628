"""Lines in running order."""

import math

import pytest
from builders import HILLS
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.scenario import Line

LENGTH_M = sum(section["length_m"] for section in HILLS)


@st.composite
def lines(draw):
    ends = sorted(draw(st.lists(st.integers(0, int(LENGTH_M)), min_size=2, max_size=2, unique=True)))
    return Line.model_validate(
        {
            "sections": HILLS,
            "speed_limits": [{"from_m": ends[0], "to_m": ends[1], "limit_kmh": 50}],
            "neutral_sections": [{"from_m": ends[0] / 2, "to_m": ends[1] / 2}, {"from_m": ends[0], "to_m": ends[1]}],
            # at either end the run begins and ends without a dwell
            "stations": [
                {"position_m": 2 * place, "dwell_s": 10 + place if 0 < 2 * place < LENGTH_M else 0}
                for place in sorted(draw(st.lists(st.integers(0, int(LENGTH_M) // 2), max_size=4, unique=True)))
            ],
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
    stations = [{"position_m": 0.0}, {"position_m": 700.0}, {"position_m": LENGTH_M, "latest_arrival_s": 90.0}]
    line = Line.model_validate({"sections": HILLS, "stations": stations})
    assert [station.position_m for station in line.inner_stations] == [700.0]
    assert (line.start_station, line.end_station) == (line.stations[0], line.stations[2])
    assert Line.model_validate({"sections": HILLS, "stations": stations[1:2]}).end_station is None


@pytest.mark.parametrize(
    ("index", "times", "reverse", "words"),
    [
        (0, {"dwell_s": 5.0}, False, r"stations\[0\]\.dwell_s = 5 has no effect, as the run begins"),
        (0, {"earliest_arrival_s": 5.0}, False, r"stations\[0\]\.earliest_arrival_s = 5 has no effect"),
        (0, {"latest_arrival_s": 5.0}, False, r"stations\[0\]\.latest_arrival_s = 5 has no effect"),
        (0, {"arrival_s": 5.0}, False, r"stations\[0\]\.arrival_s = 5 has no effect"),
        (
            1,
            {"dwell_s": 5.0},
            False,
            r"stations\[1\]\.dwell_s = 5 has no effect, as the run ends when the train arrives",
        ),
        (1, {"latest_arrival_s": 5.0}, True, r"stations\[1\]\.latest_arrival_s = 5 has no effect, as the run begins"),
        (0, {"dwell_s": 5.0}, True, r"stations\[0\]\.dwell_s = 5 has no effect, as the run ends"),
    ],
)
def test_times_without_effect_at_the_ends_are_refused_by_key(index, times, reverse, words):
    stations = [{"position_m": 0.0}, {"position_m": LENGTH_M}]
    stations[index] |= times
    with pytest.raises(ValueError, match=words):
        Line.model_validate({"sections": HILLS, "stations": stations, "reverse": reverse})
