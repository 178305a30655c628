import pytest
import scipy
from builders import plain_scenario

from railjoule.core.motion import build_meshed_line
from railjoule.core.units import VACUUM_PERMEABILITY_H_PER_M, distinct_numbers


def test_the_permeability_of_vacuum_is_that_of_scipy():
    """Importing scipy.constants takes 0.05 s; editions of CODATA differ in the tenth digit."""
    assert pytest.approx(scipy.constants.mu_0, rel=1e-9) == VACUUM_PERMEABILITY_H_PER_M


def test_weight_is_that_of_all_four_papers():
    """g = 9.81 m/s2: 100 t on 10 per mille pull with 9.81 kN."""
    sections = [{"length_m": 100.0, "gradient_permille": 10.0}]
    force = build_meshed_line(plain_scenario({"line.sections": sections})).gradient_force_n
    assert force.round(6).tolist() == [9810.0] * len(force)


@pytest.mark.parametrize(
    ("one", "other", "words"),
    [
        (303.2, 5880.0, ("303.2", "5880")),
        (44.8201, 44.8204, ("44.8201", "44.8204")),
        (0.014, 0.0, ("0.014", "0")),
        (1e-7, 0.0, ("0.0000001", "0")),
        (123456.0, 1.0, ("123500", "1")),
        (2.0, 2.0, ("2", "2")),
    ],
)
def test_two_numbers_are_distinct_numbers(one, other, words):
    assert distinct_numbers(one, other) == words
