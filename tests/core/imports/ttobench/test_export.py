import json
from pathlib import Path

import pytest

from railjoule.core import load_scenario
from railjoule.core.errors import ScenarioError
from railjoule.core.imports import SourceFile
from railjoule.core.imports.ttobench import export_track, export_train, read_track, read_train, read_ttobench
from railjoule.core.scenario import scenario_from_document

FILES = Path(__file__).parents[1] / "files"
TRACK, TRAIN, JOURNEY = (SourceFile.read(FILES / f"ttobench-{kind}.json") for kind in ("track", "train", "journey"))
SCENARIO = scenario_from_document(read_ttobench(TRACK, TRAIN, JOURNEY).document)


def read_again(read, exported):
    return read(SourceFile("again.json", exported.to_json().encode()))


def test_what_is_exported_is_read_back():
    train = export_train(SCENARIO)
    again = read_again(read_train, train).vehicle
    assert again.model_dump() == {**SCENARIO.vehicle.model_dump(), "name": "Example_Train"}
    assert train.lost == ()
    track = export_track(SCENARIO)
    line = read_again(read_track, track).line
    plain = [section.model_copy(update={"tunnel_factor": 1.0}) for section in SCENARIO.line.sections]
    assert [s.length_m for s in line.sections] == [1000, 1500, 500, 100, 200, 100, 1600]
    assert line.sections[:6] == tuple(plain[:6])
    assert [station.position_m for station in line.stations] == [2000]
    assert track.lost == (
        "tunnel_factor of sections: a track has tunnels by their cross sections.",
        "dwell times of stations: a journey has them.",
    )


def test_neutral_sections_are_told_as_lost():
    track = export_track(SCENARIO.with_(**{"line.neutral_sections": [{"from_m": 100.0, "to_m": 200.0}]}))
    assert track.lost[1] == "neutral_sections: a track has traction power everywhere."


def test_the_line_is_that_of_the_running_direction():
    turned = export_track(SCENARIO.with_(**{"line.reverse": True})).document
    assert turned["gradients"]["values"] == [[0, 3.5], [4000, -5]]
    assert turned["stops"]["values"] == [0, 3000, 5000]


def test_a_line_without_limits_has_that_of_the_vehicle():
    document = export_track(load_scenario("liashenko-ii")).document
    assert document["speed limits"]["values"] == [[0, 80]]
    assert "curvatures" not in document


def test_a_loaded_train_with_resistance_over_weight():
    """Profile II's metro: 160 t and half of 1385 passengers; 1.1 N/kN of 2078.9 kN, and what a train cannot tell."""
    exported = export_train(load_scenario("liashenko-ii"))
    document = exported.document
    assert document["mass"]["value"] == pytest.approx(160_000 + 0.5 * 1385 * 74.9745)
    assert document["rolling resistance r0"]["value"] == pytest.approx(1.1 * 2.0789, rel=1e-4)
    assert document["rho"] == {"unit": "%", "value": pytest.approx(12)}
    assert "drive.recuperation_factor = 0: all that braking generates goes back." in exported.lost
    assert document["metadata"]["id"] == "Metro_81_7036_5_cars"


def test_the_json_is_plain():
    assert json.loads(export_train(SCENARIO).to_json())["mass"] == {"unit": "kg", "value": 160_000}


def test_a_curve_becomes_effort_and_power():
    """150 kN at 72 km/h are 3000 kW."""
    changes = {"vehicle.traction": {"max_speed_kmh": 144, "curve": [[0, 200], [36, 200], [72, 150], [144, 75]]}}
    exported = export_train(SCENARIO.with_(**changes))
    assert exported.document["max traction force"]["value"] == 200
    assert exported.document["max traction power"]["value"] == pytest.approx(3000)
    assert exported.lost == ("traction.curve: a train has its largest effort and power alone.",)


def test_a_train_whose_motors_alone_limit_it_cannot_be_told():
    with pytest.raises(
        ScenarioError, match=r"^vehicle.traction.max_power_kw is missing, and a train of TTOBench needs"
    ):
        export_train(SCENARIO.with_(**{"vehicle.traction.max_power_kw": None}))


def test_braking_curves_have_no_place():
    """The electric brake's largest effort is that of its curve."""
    changes = {"braking": {"curve": [[0, 80], [60, 120]], "permitted_deceleration": [[0, 0.7]]}}
    exported = export_train(SCENARIO.with_(**{f"vehicle.{key}": it for key, it in changes.items()}))
    assert exported.document["max reg braking force"]["value"] == 120
    assert exported.lost[0] == "braking.curve: a train has its largest effort and power alone."
    assert "braking.permitted_deceleration: a train has no braking curve." in exported.lost
