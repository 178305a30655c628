"""Running resistance as data sheets give it: every unit by hand, and the formulas against published constants."""

import pytest

from railjoule.core import ScenarioError
from railjoule.core.physics.resistance import resistance_coefficients
from railjoule.core.scenario import Vehicle, format_scenario, parse_scenario
from tests.builders import plain_scenario

GRAVITY_MS2 = 9.81


def vehicle_with(**resistance: object) -> Vehicle:
    """Return the plain vehicle, 100 t, with another resistance."""
    return plain_scenario({"vehicle.resistance": resistance}).vehicle


def resistance_n(vehicle: Vehicle, speed_ms: float) -> float:
    """Return the resistance at a speed."""
    constant, linear, quadratic = resistance_coefficients(vehicle)
    return constant + linear * speed_ms + quadratic * speed_ms**2


# 100 t at 36 km/h, which is 10 m/s and 22.3694 mph; a = 2, b = 0.1, c = 0.01 in each unit
BY_HAND = {
    ("N", "km/h"): 2 + 0.1 * 36 + 0.01 * 36**2,
    ("N", "m/s"): 2 + 0.1 * 10 + 0.01 * 10**2,
    ("daN", "m/s"): 10 * (2 + 0.1 * 10 + 0.01 * 10**2),
    ("kN", "m/s"): 1000 * (2 + 0.1 * 10 + 0.01 * 10**2),
    ("kgf", "m/s"): 9.80665 * 4,
    ("lbf", "m/s"): 4.4482216 * 4,
    ("N/t", "m/s"): 100 * 4,
    ("daN/t", "m/s"): 1000 * 4,
    # a thousandth and a two-thousandth of the weight of 981 kN
    ("kgf/t", "m/s"): 981 * 4,
    ("lb/ton", "m/s"): 981e3 / 2000 * 4,
    ("lb/ton", "mph"): 981e3 / 2000 * (2 + 0.1 * 22.3693629 + 0.01 * 22.3693629**2),
    ("N/kN", "km/h"): 981 * (2 + 0.1 * 36 + 0.01 * 36**2),
}


@pytest.mark.parametrize(("unit", "speed_unit"), BY_HAND)
def test_davis_coefficients_in_every_unit(unit: str, speed_unit: str) -> None:
    vehicle = vehicle_with(davis={"a": 2.0, "b": 0.1, "c": 0.01, "unit": unit, "speed_unit": speed_unit})
    assert resistance_n(vehicle, 10.0) == pytest.approx(BY_HAND[unit, speed_unit], rel=1e-6)


# N, N s/m and N s2/m2 by mass [t], axles and frontal area [m2], as FCalc 2.0 prints them for Open Rails: another
# program's metric form of the same formulas
FCALC = {
    "davis-1926-locomotive": (6.3743, 128.998, 0.32905, 0.57501),
    "davis-1926-passenger": (6.3743, 128.998, 0.32905, 0.08146),
    "davis-1926-freight": (6.3743, 128.998, 0.32905 * 1.5, 0.11979),
}


@pytest.mark.parametrize("name", FCALC)
def test_the_formula_of_davis(name: str) -> None:
    """The specific terms refer to 9.80665 m/s2 there: a pound on a ton is the same share of the weight."""
    per_t, per_axle, linear, air = FCALC[name]
    vehicle = vehicle_with(formula={"name": name, "axles": 16, "cars": 4, "frontal_area_m2": 9.0})
    heavier = GRAVITY_MS2 / 9.80665
    for speed in (0.0, 10.0, 25.0):
        by_fcalc = heavier * 100 * (per_t + linear * speed) + per_axle * 16 + air * 4 * 9.0 * speed**2
        assert resistance_n(vehicle, speed) == pytest.approx(by_fcalc, rel=2e-4)


@pytest.mark.parametrize(("name", "k"), [("conventional", 0.07), ("containers", 0.0935), ("trailers", 0.16)])
def test_the_modified_formula_of_davis(name: str, k: float) -> None:
    """R = 0.6 + 20/w + 0.01 V + K V^2 / (w n), lb/ton: four cars of 27.56 short tons on four axles at 40 mph."""
    tons = 100e3 / 0.45359237 / 2000
    w = tons / 16
    lb_per_ton = 0.6 + 20 / w + 0.01 * 40 + k * 40**2 / (w * 4)
    vehicle = vehicle_with(formula={"name": f"area-1970-{name}", "axles": 16, "cars": 4})
    assert resistance_n(vehicle, 40 * 0.44704) == pytest.approx(lb_per_ton * tons * 4.4482216, rel=3e-4)


def test_the_formula_of_sauthoff() -> None:
    """Ten coaches of 400 t: 1.9 + 0.0025 v + 0.0696 (n + 2.7) (v + 15)^2 / weight in kN, at 120 km/h in N/kN."""
    weight_kn = 400 * GRAVITY_MS2
    specific = 1.9 + 0.0025 * 120 + 4.8 * 0.0145 * (10 + 2.7) * (120 + 15) ** 2 / weight_kn
    formula = {"name": "sauthoff-1932", "cars": 10}
    vehicle = plain_scenario({"vehicle.resistance": {"formula": formula}, "vehicle.tare_kg": 400e3}).vehicle
    assert resistance_n(vehicle, 120 / 3.6) == pytest.approx(specific * weight_kn, rel=1e-9)


def test_terms_of_all_kinds_add_up_and_stay_as_they_are_written() -> None:
    davis = {"a": 1.5, "b": 0.03, "unit": "lb/ton", "speed_unit": "mph"}
    formula = {"name": "sauthoff-1932", "cars": 2}
    both = vehicle_with(constant_n=100.0, davis=davis, formula=formula)
    parts = vehicle_with(constant_n=100.0), vehicle_with(davis=davis), vehicle_with(formula=formula)
    assert resistance_n(both, 20.0) == pytest.approx(sum(resistance_n(part, 20.0) for part in parts))
    scenario = plain_scenario({"vehicle.resistance": {"davis": davis}})
    text = format_scenario(scenario)
    assert 'unit = "lb/ton"' in text
    assert parse_scenario(text) == scenario


@pytest.mark.parametrize(
    ("resistance", "sentence"),
    [
        ({"formula": {"name": "davis-1926-freight", "cars": 2}}, "name = 'davis-1926-freight' needs axles"),
        ({"formula": {"axles": 4}}, "axles has no effect without name"),
        (
            {"formula": {"name": "sauthoff-1932", "cars": 2, "axles": 8}},
            "axles has no effect with name = 'sauthoff-1932'",
        ),
        ({"starting_n": 1e3}, "need starting_ends_at_kmh, the speed at which they end"),
        ({"starting_ends_at_kmh": 5.0}, "starting_ends_at_kmh has no effect without starting_n_per_kn or starting_n"),
        ({"davis": {"a": 1.0, "unit": "lb/t"}}, "vehicle.resistance.davis.unit = 'lb/t'"),
    ],
)
def test_what_cannot_be_is_refused_in_a_sentence(resistance: dict[str, object], sentence: str) -> None:
    with pytest.raises(ScenarioError, match=r"^scenario: vehicle\.resistance") as refusal:
        vehicle_with(**resistance)
    assert sentence in str(refusal.value)
