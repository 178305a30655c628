import json
import re
from pathlib import Path

import pytest

from railjoule.core.errors import ScenarioError
from railjoule.core.imports import SourceFile
from railjoule.core.imports.ttobench import read_train

FILE = Path(__file__).parents[1] / "files" / "ttobench-train.json"
TRAIN = json.loads(FILE.read_text())


def train_of(**changes):
    """Read the example with other entries; None leaves one out."""
    train = {**TRAIN, **{key.replace("_", " "): value for key, value in changes.items()}}
    content = json.dumps({key: value for key, value in train.items() if value is not None})
    return read_train(SourceFile("train.json", content.encode()))


def quantity(value, unit):
    return {"unit": unit, "value": value}


def told(train, kind):
    return [finding.sentence for finding in train.findings if finding.kind == kind]


def test_a_train_becomes_a_vehicle():
    train = read_train(SourceFile.read(FILE))
    assert train.document["vehicle"] == {
        "name": "Example_Train",
        "tare_kg": 160_000,
        "rotating_mass_factor": 0.08,
        "length_m": 80,
        "car_count": 4,
        "resistance": {"constant_n": 2500, "linear_n_per_kmh": 20, "quadratic_n_per_kmh2": 1},
        "traction": {"max_effort_kn": 190, "max_power_kw": 2400, "max_speed_kmh": 144, "max_acceleration_ms2": 1.1},
        "braking": {
            "max_effort_kn": 150,
            "max_power_kw": 2000,
            "friction_effort_kn": 300,
            "max_deceleration_ms2": 0.9,
        },
        "drive": {
            "model": "constant_efficiency",
            "traction_efficiency": 0.85,
            "braking_efficiency": 0.8,
            "recuperation_factor": 1,
        },
    }
    assert train.unused == ("ttobench-train.json: num seats.",)
    assert told(train, "question") == []


@pytest.mark.parametrize(
    ("key", "value", "unit", "path", "expected"),
    [
        ("mass", 160_000, "kg", ("tare_kg",), 160_000),
        ("rho", 0.08, "-", ("rotating_mass_factor",), 0.08),
        ("max speed", 40, "m/s", ("traction", "max_speed_kmh"), 144),
        ("max traction power", 2.4, "MW", ("traction", "max_power_kw"), 2400),
        ("rolling resistance r0", 2500, "N", ("resistance", "constant_n"), 2500),
        # 1 m/s is 3.6 km/h
        ("rolling resistance r1", 72, "N/(m/s)", ("resistance", "linear_n_per_kmh"), 20),
        ("rolling resistance r2", 12.96, "N/(m/s)^2", ("resistance", "quadratic_n_per_kmh2"), 1),
    ],
)
def test_units_are_converted(key, value, unit, path, expected):
    entry = train_of(**{key: quantity(value, unit)}).document["vehicle"]
    for name in path:
        entry = entry[name]
    assert entry == pytest.approx(expected, rel=1e-9)


def test_tunnels_add_to_the_quadratic_term():
    """Of 30 m2, half-way between 20 and 40: 1 + (0.0015 + 0.0005) / 2 / 0.001."""
    tunnels = train_of().tunnels
    assert [tunnels.factor_in(area) for area in (20, 30, 40)] == pytest.approx([2.5, 2.0, 1.5])
    assert tunnels.factor_in(19.9) is None
    assert tunnels.factor_in(40.1) is None


def test_what_need_not_be_there():
    """A train without an electric brake has no power for one either."""
    none = quantity(0, "kW")
    bare = dict.fromkeys(("rho", "length", "max_pn_braking_force", "max_acceleration", "max_deceleration"))
    train = train_of(**bare, max_reg_braking_power=none, efficiency_traction=None, efficiency_reg_brake=None)
    assert train.vehicle.rotating_mass_factor == 0
    assert train.vehicle.braking.max_effort_kn == 0
    assert train.vehicle.braking.max_power_kw is None
    assert train.vehicle.drive.traction_efficiency == 1
    assert "train.json: num coaches, as it gives no length." in train.unused
    assert "train.json: efficiency traction is missing: a drive without losses." in told(train, "assumption")


@pytest.mark.parametrize(
    ("changes", "question"),
    [
        (
            {"max_traction_force": quantity(190, "N")},
            "train.json: vehicle.traction.max_effort_kn = 0.19 kN for a train of 160 t: was 190 kN meant?",
        ),
        (
            {"max_traction_power": quantity(2400, "W")},
            "train.json: vehicle.traction.max_power_kw = 2.4 kW for a train of 160 t: was 2400 kW meant?",
        ),
        (
            {"rolling_resistance_r0": quantity(2.5, "N")},
            "train.json: vehicle.resistance.constant_n = 2.5 N for a train of 160 t: was 2500 N meant?",
        ),
        ({"mass": quantity(160, "kg")}, "train.json: vehicle.tare_kg = 160 kg: was 160000 kg meant?"),
        (
            {"efficiency_traction": quantity(0.85, "%")},
            "train.json: vehicle.drive.traction_efficiency = 0.0085 for a train of 160 t: was 0.85 meant?",
        ),
        (
            {"max_speed": quantity(20, "km/h")},
            "train.json: vehicle.traction.max_speed_kmh = 20 km/h for a train of 160 t: was 72 km/h meant?",
        ),
        (
            {"rolling_resistance_r2": quantity(1000, "N/(km/h)^2")},
            "train.json: vehicle.resistance.quadratic_n_per_kmh2 = 1000 N/(km/h)2 for a train of 160 t: was 1 "
            "N/(km/h)2 meant?",
        ),
    ],
)
def test_numbers_that_no_train_has_are_asked_about(changes, question):
    assert question in told(train_of(**changes), "question")


@pytest.mark.parametrize(
    ("version", "sentence"),
    [
        ("TTOBench v2.0", "its library version is 'TTOBench v2.0'"),
        (None, "it has no library version"),
    ],
)
def test_another_version_is_read_and_told(version, sentence):
    metadata = {"id": "x"} if version is None else {"id": "x", "library version": version}
    train = train_of(metadata=metadata, magnet_brake=quantity(5, "kN"))
    assert told(train, "question") == [
        f"train.json: {sentence}, and 1.1 to 1.5 are known: what is known of it was read as 1.5 has it."
    ]
    assert train.unused == ("train.json: num seats, magnet brake.",)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"mass": None}, "train.json: mass is missing."),
        ({"mass": quantity("heavy", "kg")}, "train.json: mass.value = 'heavy' must be a number."),
        ({"mass": quantity(160, "lb")}, "train.json: mass.unit = 'lb' must be one of kg, t."),
        ({"mass": quantity(-5, "kg")}, "train.json: vehicle.tare_kg = -5 must be above 0."),
        ({"mass": 160}, "train.json: mass = 160 must be a table."),
        ({"max_speed": quantity(900, "km/h")}, "train.json: vehicle.traction.max_speed_kmh = 900 must be at most 600."),
        (
            {"tunnel_resistance": {"units": {}, "values": [[20, 0.1], [20, 0.2]]}},
            "train.json: tunnel resistance.values has a cross section twice.",
        ),
        (
            {"tunnel_resistance": {"units": {"coefficient": "kN"}, "values": [[20, 0.1]]}},
            "train.json: tunnel resistance.units.coefficient = 'kN' must be one of kN/(km/h)^2, N/(km/h)^2, "
            "kN/(m/s)^2, N/(m/s)^2.",
        ),
    ],
)
def test_bad_trains_are_refused_in_one_sentence(changes, sentence):
    with pytest.raises(ScenarioError, match=f"^{re.escape(sentence)}$"):
        train_of(**changes)
