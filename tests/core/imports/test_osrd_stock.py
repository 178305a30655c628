import json
import re
from pathlib import Path

import pytest

from railjoule.core.errors import ChoiceError, ScenarioError
from railjoule.core.imports import SourceFile
from railjoule.core.imports.osrd_stock import read_osrd_stock

FILE = Path(__file__).parent / "files" / "osrd-stock.json"
STOCK = json.loads(FILE.read_text())
FILE_SOURCE = SourceFile.read(FILE)


def stock_of(mode=None, **changes):
    """Read the example with other entries; None leaves one out."""
    stock = {key: value for key, value in {**STOCK, **changes}.items() if value is not None}
    return read_osrd_stock(SourceFile("stock.json", json.dumps(stock).encode()), mode)


def curves_with(**curve):
    modes = {"25000V": {**STOCK["effort_curves"]["modes"]["25000V"], "default_curve": curve}}
    return {"default_mode": "25000V", "modes": modes}


def told(vehicle, kind):
    return [finding.sentence for finding in vehicle.findings if finding.kind == kind]


def test_a_rolling_stock_becomes_a_vehicle():
    """B and C are over m/s, ours over km/h: 72 / 3.6 and 6.48 / 3.6^2; friction brakes of 200 t x 1.05 x 0.6 m/s2."""
    vehicle = read_osrd_stock(SourceFile.read(FILE))
    assert vehicle.document["vehicle"] == {
        "name": "example",
        "tare_kg": 200_000,
        "rotating_mass_factor": 0.05,
        "length_m": 100,
        "resistance": {"constant_n": 2600, "linear_n_per_kmh": 20, "quadratic_n_per_kmh2": 0.5},
        "traction": {
            "max_speed_kmh": 144,
            "curve": [[0, 200], [36, 200], [72, 150], [144, 75]],
            "max_acceleration_ms2": 0.5,
        },
        "braking": {"max_effort_kn": 0, "friction_effort_kn": 126, "max_deceleration_ms2": 0.6},
        "drive": {"model": "constant_efficiency", "traction_efficiency": 1},
    }
    assert vehicle.unused == (
        "osrd-stock.json: startup_time, startup_acceleration, energy_sources.",
        "osrd-stock.json: modes not read: 1500V.",
        "osrd-stock.json: 1 curve of 25000V under conditions.",
    )
    assert told(vehicle, "assumption") == [
        "osrd-stock.json: it tells of no electric brake: friction brakes for 0.6 m/s2, and nothing goes back.",
        "osrd-stock.json: no losses are given: a drive without losses.",
    ]
    assert told(vehicle, "question") == []


def test_another_supply_is_chosen_by_its_name():
    assert stock_of("1500V").vehicle.traction.curve == ((0, 100), (144, 50))


def test_from_3_4_on_resistance_is_that_of_a_kilogram():
    per_kg = {"type": "davis", "A": 0.013, "B": 0.00036, "C": 0.0000324}
    newer = stock_of(railjson_version="3.4", rolling_resistance=per_kg).vehicle.resistance
    older = stock_of().vehicle.resistance
    for name in ("constant_n", "linear_n_per_kmh", "quadratic_n_per_kmh2"):
        assert getattr(newer, name) == pytest.approx(getattr(older, name), rel=1e-9)


def test_resistance_of_the_other_kind_is_asked_about():
    per_kg = {"type": "davis", "A": 0.013, "B": 0.00036, "C": 0.0000324}
    (question,) = told(stock_of(rolling_resistance=per_kg), "question")
    assert question == "stock.json: vehicle.resistance.constant_n = 0.013 N for a train of 200 t: is this right?"


@pytest.mark.parametrize(("version", "words"), [("4.0", "is '4.0'"), (None, "")])
def test_another_version_is_told(version, words):
    per_kg = {"type": "davis", "A": 0.013, "B": 0.00036, "C": 0.0000324}
    (question,) = told(stock_of(railjson_version=version, rolling_resistance=per_kg), "question")
    assert words in question
    assert "3.0 to 3.4 are known" in question


def test_the_braking_of_older_versions():
    vehicle = stock_of(railjson_version="3.0", const_gamma=None, gamma={"type": "CONST", "value": 0.5}).vehicle
    assert vehicle.braking.max_deceleration_ms2 == 0.5


def test_a_step_of_the_effort_is_told():
    vehicle = stock_of(effort_curves=curves_with(speeds=[0, 10, 10, 40], max_efforts=[2e5, 2e5, 1e5, 5e4]))
    assert vehicle.vehicle.traction.curve == ((0, 200), (36, 200), (36, 100), (144, 50))
    assert told(vehicle, "reading") == [
        "stock.json: effort_curves.modes.25000V.default_curve: 1 step of the effort, at which the lower one holds."
    ]


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"mass": None}, "stock.json: mass is missing."),
        ({"mass": "200 t"}, "stock.json: mass = '200 t' must be a number."),
        ({"inertia_coefficient": 0.05}, "stock.json: inertia_coefficient = 0.05 must be at least 1."),
        ({"const_gamma": None}, "stock.json: const_gamma is missing."),
        ({"max_speed": 300}, "stock.json: vehicle.traction.max_speed_kmh = 1080 must be at most 600."),
        ({"mode": "750V"}, "stock.json: mode = '750V' must be one of 1500V, 25000V."),
        (
            {"effort_curves": curves_with(speeds=[0, 10], max_efforts=[1, 2, 3])},
            "stock.json: effort_curves.modes.25000V.default_curve has 2 speeds and 3 max_efforts.",
        ),
        (
            {"effort_curves": curves_with(speeds=[10, 0], max_efforts=[2e5, 1e5])},
            "stock.json: vehicle.traction.curve must have rising speeds; two points at the same speed are a step.",
        ),
        (
            {"rolling_resistance": {"type": "strahl", "A": 1, "B": 1, "C": 1}},
            "stock.json: rolling_resistance.type = 'strahl' must be 'davis'.",
        ),
    ],
)
def test_bad_stocks_are_refused_in_one_sentence(changes, sentence):
    with pytest.raises(ScenarioError, match=f"^{re.escape(sentence)}$"):
        stock_of(**changes)


@pytest.mark.parametrize("wrap", [lambda stocks: stocks, lambda stocks: {"count": 2, "results": stocks}])
def test_one_of_a_list_is_chosen_by_its_name(wrap):
    source = SourceFile("stock.json", json.dumps(wrap([STOCK, {**STOCK, "name": "heavy", "mass": 300_000}])).encode())
    with pytest.raises(ChoiceError) as caught:
        read_osrd_stock(source)
    assert str(caught.value) == "stock.json: holds 2 trains, example, heavy; choose one train by its name."
    heavy = read_osrd_stock(source, wanted="heavy")
    assert heavy.vehicle.tare_kg == 300_000
    assert "stock.json: trains not read: example." in heavy.unused
    with pytest.raises(ScenarioError, match=r"train = 'light' must be one of example, heavy\.$"):
        read_osrd_stock(source, wanted="light")
    alone = SourceFile("stock.json", json.dumps(wrap([STOCK])).encode())
    assert read_osrd_stock(alone).vehicle == read_osrd_stock(FILE_SOURCE).vehicle


@pytest.mark.parametrize("text", ["[]", "[1]", '{"results": []}'])
def test_a_list_of_something_else_is_refused(text):
    with pytest.raises(ScenarioError, match=r"^stock.json: its list must hold rolling stocks, each a JSON object\.$"):
        read_osrd_stock(SourceFile("stock.json", text.encode()))
