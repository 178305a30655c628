"""What energies are compared with."""

import pytest
from builders import plain_scenario

from railjoule.core.motion import build_course
from railjoule.core.physics.reference import reference_energy


def test_an_energy_or_a_tenth_of_the_kinetic_one_at_the_mean_speed():
    """110 t at 2000 m over 100 s: 0.5 * 110e3 * 400 J, and a tenth of it."""
    data = build_course(plain_scenario()).data
    assert reference_energy(data, -5e7, 100.0) == 5e7
    assert reference_energy(data, 3.0, 100.0) == pytest.approx(2.2e6)
