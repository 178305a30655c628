from builders import plain_scenario

from railjoule.core.motion import build_course
from railjoule.core.units import J_PER_KWH, MS_PER_KMH


def test_factors_by_their_definitions():
    assert 36 * MS_PER_KMH == 10
    assert J_PER_KWH == 1000 * 3600


def test_weight_is_that_of_all_four_papers():
    """g = 9.81 m/s2: 100 t on 10 per mille pull with 9.81 kN."""
    sections = [{"length_m": 100.0, "gradient_permille": 10.0}]
    force = build_course(plain_scenario({"line.sections": sections})).gradient_force_n
    assert force.round(6).tolist() == [9810.0] * len(force)
