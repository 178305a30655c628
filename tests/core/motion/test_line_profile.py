"""Limits and neutral sections of a line over distance, against plain rules."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.motion.line_profile import is_neutral, neutral_stretches, speed_limit_at
from railjoule.core.scenario import Line

STRETCHES = st.lists(
    st.tuples(st.integers(0, 99), st.integers(1, 100), st.integers(1, 20)).filter(lambda one: one[0] < one[1]),
    max_size=12,
)


@given(STRETCHES)
def test_the_lowest_limit_of_all_that_cover_a_place(stretches):
    limits = [{"from_m": start, "to_m": end, "limit_kmh": limit} for start, end, limit in stretches]
    sections = [{"length_m": 40, "speed_limit_kmh": 10}, {"length_m": 60}]
    line = Line.model_validate({"sections": sections, "speed_limits": limits})
    places = np.arange(100) + 0.5
    expected = [
        min([10 if place < 40 else np.inf, *(limit for start, end, limit in stretches if start < place < end)])
        for place in places
    ]
    assert speed_limit_at(line, places).tolist() == expected


@given(STRETCHES)
def test_a_place_is_neutral_where_any_section_covers_it(stretches):
    sections = [{"from_m": start, "to_m": end} for start, end, _ in stretches]
    line = Line.model_validate({"sections": [{"length_m": 100}], "neutral_sections": sections})
    places = np.arange(100) + 0.5
    expected = [any(start < place < end for start, end, _ in stretches) for place in places]
    assert is_neutral(line, places).tolist() == expected
    joined = neutral_stretches(line)
    # joined, they rise and have gaps between them
    assert (np.diff(joined.ravel()) > 0).all()
    assert (joined[:, 1] - joined[:, 0]).sum() == sum(expected)
