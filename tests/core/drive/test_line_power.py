"""The rule of recuperation: by hand, smooth and kinked, for numbers and arrays."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.drive.line_power import line_power, resistor_power, smooth_line_power

powers = st.floats(-1e6, 1e6)
shares = st.floats(0, 1)


@pytest.mark.parametrize(("power", "share", "line", "burnt"), [(5.0, 0.3, 5, 0), (-5, 0.3, -1.5, 3.5), (-5, 0, 0, 5)])
def test_by_hand(power, share, line, burnt):
    assert line_power(power, share) == pytest.approx(line)
    assert resistor_power(power, share) == pytest.approx(burnt)


@given(powers, shares)
def test_what_is_generated_comes_back_or_is_burnt(power, share):
    assert line_power(power, share) - resistor_power(power, share) == pytest.approx(power, abs=1e-9)
    assert resistor_power(power, share) >= 0


@given(st.floats(0, 1e6), powers, shares)
def test_the_smooth_rule_is_the_same_where_braking_draws_what_it_draws(taken, generated, share):
    """Driving and braking never come together, but each alone."""
    drawn = max(-generated, 0.0)
    assert smooth_line_power(0.0, generated, drawn, share) == pytest.approx(line_power(-generated, share), abs=1e-9)
    assert smooth_line_power(taken, 0.0, 0.0, share) == line_power(taken, share)


def test_arrays():
    power = np.array([-4.0, 0.0, 3.0])
    assert line_power(power, 0.25).tolist() == [-1, 0, 3]
    assert resistor_power(power, 0.25).tolist() == [3, 0, 0]
