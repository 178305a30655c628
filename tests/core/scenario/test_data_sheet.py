"""A train from a data sheet: its values by hand, what is assumed, and how an assumption ends."""

import math

import pytest

from railjoule.core import ScenarioError, Vehicle
from railjoule.core.physics.resistance import resistance_coefficients
from railjoule.core.scenario import Scenario, format_scenario, load_scenario
from railjoule.core.scenario.data_sheet import DataSheet
from railjoule.core.scenario.document import parse_scenario
from railjoule.dashboard.command.arguments import DATA_SHEET

FLIRT = {"mass_t": 122, "power_kw": 2600, "max_effort_kn": 200, "max_speed_kmh": 160, "length_m": 74.1, "cars": 4}
TGV = {"kind": "high_speed", "mass_t": 460, "power_kw": 8800, "max_effort_kn": 260, "max_speed_kmh": 320}


def resistance_n(vehicle: Vehicle, speed_kmh: float) -> float:
    constant, linear, quadratic = resistance_coefficients(vehicle)
    speed = speed_kmh / 3.6
    return constant + linear * speed + quadratic * speed**2


def find_basis(vehicle: Vehicle, key: str) -> str:
    return next(one.basis for one in vehicle.assumed if one.key == key)


def test_sauthoffs_resistance_of_a_multiple_unit():
    """At 120 km/h by hand; TTOBench's r0 and r1 of this train are the same, its r2 is the second derivative."""
    vehicle = Vehicle.from_data_sheet(**FLIRT)
    weight = 122 * 9.81
    by_hand = (1.9 + 0.0025 * 120) * weight + 4.8 * 6.7 * 0.0145 * 135**2
    assert resistance_n(vehicle, 120) == pytest.approx(by_hand, rel=1e-5)
    constant, linear, quadratic = resistance_coefficients(vehicle)
    assert constant == pytest.approx(2378.88, rel=1e-4)
    assert linear / 3.6 == pytest.approx(16.98165, rel=1e-4)
    assert 2 * quadratic / 3.6**2 == pytest.approx(0.93264, rel=1e-5)


def test_the_resistance_of_a_high_speed_train_is_near_that_of_osrd():
    """OSRD's example of 200 m and 460 t: 3496 N, 125.856 N/(m/s), 6.55776 N/(m/s)^2; within 12 % from 100 km/h."""
    vehicle = Vehicle.from_data_sheet(**TGV, length_m=200, axles=26)
    for speed_kmh in (100, 200, 300):
        speed = speed_kmh / 3.6
        published = 3496 + 125.856 * speed + 6.55776 * speed**2
        assert resistance_n(vehicle, speed_kmh) == pytest.approx(published, rel=0.12)
    by_hand = 0.9 * 460 * math.sqrt(10 / (460 / 26)) + 0.01 * 460 * 300 + (0.0009 * 10 + 0.00002 * 10 * 200) * 300**2
    assert resistance_n(vehicle, 300) == pytest.approx(10 * by_hand, rel=1e-5)


def test_strahls_resistance_of_a_freight_train():
    vehicle = Vehicle.from_data_sheet(
        kind="freight", mass_t=1103, power_kw=6400, max_effort_kn=300, max_speed_kmh=100, length_m=359
    )
    assert resistance_n(vehicle, 80) == pytest.approx((2.0 + 0.057 * 8**2) * 1103 * 9.81, rel=1e-5)
    assert vehicle.auxiliary_power_kw == 20


def test_effort_from_the_acceleration():
    vehicle = Vehicle.from_data_sheet(
        kind="light_rail", mass_t=40.37, power_kw=580, max_acceleration_ms2=1.07, max_speed_kmh=80, length_m=24.8
    )
    standing_kn = (1.9 * 40.37 * 9.81 + 4.8 * 3.7 * 0.0145 * 15**2) / 1e3
    assert vehicle.traction.max_effort_kn == pytest.approx(1.04 * 40.37 * 1.07 + standing_kn, rel=1e-5)
    assert vehicle.traction.max_acceleration_ms2 == 1.07
    assert "41.985 t" in find_basis(vehicle, "vehicle.traction.max_effort_kn")


def test_what_the_sheet_gives_is_not_assumed():
    whole = Vehicle.from_data_sheet(
        **FLIRT,
        kind="multiple_unit",
        axles=10,
        driven_axles=4,
        capacity_passengers=167,
        rotating_mass_factor=0.08,
        service_deceleration_ms2=0.9,
        electric_brake_kn=150,
        regenerative=True,
        efficiency=0.87654321,
        auxiliary_power_kw=55,
        line_voltage_v=15_000,
    )
    given = {"vehicle.rotating_mass_factor", "vehicle.braking.max_deceleration_ms2", "vehicle.braking.max_effort_kn"}
    given |= {"drive.traction_efficiency", "drive.recuperation_factor", "vehicle.auxiliary_power_kw"}
    assert not given & {one.key for one in whole.assumed}
    assert whole.drive.traction_efficiency == 0.87654321
    assert whole.adhesion.driven_mass_share == 0.4
    assert whole.braking.friction_effort_kn == pytest.approx(1.08 * 122 * 0.9)
    assert whole.assumptions == whole.assumed


def test_every_field_but_those_has_an_effect():
    """A value of the sheet that nothing reads would be dropped without a word."""
    base = FLIRT | {"kind": "multiple_unit", "axles": 10, "max_acceleration_ms2": 1.0}
    changes = {
        "name": "x",
        "kind": "light_rail",
        "mass_t": 130,
        "power_kw": 2000,
        "max_effort_kn": 180,
        "cars": 3,
        "max_acceleration_ms2": 0.9,
        "max_speed_kmh": 140,
        "length_m": 80,
        "driven_axles": 4,
        "regenerative": False,
        "capacity_passengers": 90,
        "rotating_mass_factor": 0.05,
        "service_deceleration_ms2": 0.8,
        "electric_brake_kn": 120,
        "efficiency": 0.9,
        "auxiliary_power_kw": 10,
        "line_voltage_v": 15000,
    }
    before = Vehicle.from_data_sheet(**base)
    for key, value in changes.items():
        assert Vehicle.from_data_sheet(**{**base, key: value}) != before, key
    fast = {**TGV, "length_m": 200.0}
    for key, value in {"axles": 26, "front_area_m2": 9.0}.items():
        assert Vehicle.from_data_sheet(**fast, **{key: value}) != Vehicle.from_data_sheet(**fast), key
    assert changes.keys() | {"axles", "front_area_m2"} == DataSheet.model_fields.keys()


@pytest.mark.parametrize(
    ("sheet", "sentence"),
    [
        ({"max_effort_kn": None}, "DataSheet: needs max_effort_kn or max_acceleration_ms2."),
        ({"mass_t": -1}, "DataSheet: mass_t = -1 must be above 0."),
        ({"mas_t": 1}, "DataSheet: unknown key mas_t, did you mean 'mass_t'?"),
        ({"kind": "maglev"}, "DataSheet: kind = 'maglev' must be 'multiple_unit', 'light_rail', 'high_speed' or"),
        ({"driven_axles": 4}, "DataSheet: driven_axles needs axles, of which they are a share."),
        ({"axles": 4, "driven_axles": 6}, "DataSheet: driven_axles = 6 must be at most axles = 4."),
        ({"front_area_m2": 9}, "DataSheet: front_area_m2 = 9 has no effect without kind = 'high_speed'"),
        ({"regenerative": False, "electric_brake_kn": 9}, "DataSheet: electric_brake_kn = 9 has no effect with"),
    ],
)
def test_a_wrong_sheet_is_refused_in_one_sentence(sheet, sentence):
    with pytest.raises(ScenarioError) as refused:
        Vehicle.from_data_sheet(**{**FLIRT, **sheet})
    assert str(refused.value).startswith(sentence)


def test_assumptions_survive_a_file_and_end_with_another_value():
    scenario = Scenario(Vehicle.from_data_sheet(**FLIRT), load_scenario("ftorek-300s").line, travel_time_s=400)
    again = parse_scenario(format_scenario(scenario))
    assert again == scenario
    known = again.replace({"vehicle.rotating_mass_factor": 0.07, "drive.traction_efficiency": 0.9}).vehicle
    ended = {one.key for one in known.assumed} - {one.key for one in known.assumptions}
    assert ended == {"vehicle.rotating_mass_factor", "drive.traction_efficiency"}


def test_an_assumed_value_of_an_unknown_key_is_refused():
    scenario = load_scenario("ftorek-300s")
    entry = {"key": "vehicle.rotating_mass", "value": 0.1, "basis": "none"}
    with pytest.raises(
        ScenarioError, match=r"assumed\[0\]\.key = 'vehicle\.rotating_mass' must be the key of a number"
    ):
        scenario.replace({"vehicle.assumed": [entry]})
    entry["key"] = "vehicle.tare_kg"
    with pytest.raises(ScenarioError, match="is given twice"):
        scenario.replace({"vehicle.assumed": [entry, entry]})


def test_the_command_names_every_field_of_a_sheet():
    (_, settings), *_ = DATA_SHEET
    assert all(key in settings["help"] for key in DataSheet.model_fields)
