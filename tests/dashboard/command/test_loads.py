"""Loads in tonnes on the command line: of any vehicle, and of a train that was imported."""

import json
from pathlib import Path

import pytest
from commands import answer, complaint

from railjoule.core.physics.resistance import resistance_coefficients
from railjoule.core.scenario import load_scenario
from railjoule.dashboard.command.cli import OK, main

ORE = """
schema: https://railtoolkit.org/schema/rolling-stock.json
schema_version: "2022.05"
trains:
  - {id: ore, formation: [loco, wagon, wagon, wagon, wagon]}
vehicles:
  - {id: loco, length: 14, mass: 80, mass_traction: 80, speed_limit: 80, rotation_mass: 1.1, base_resistance: 2.0,
     air_resistance: 9.0, tractive_effort: [[0, 180000], [20, 100000], [80, 30000]]}
  - {id: wagon, length: 19, mass: 25, load_limit: 55, speed_limit: 100, base_resistance: 1.4, air_resistance: 4.0}
"""
LINE = """
timetable.travel_time_s = 900
[line]
sections = [{ length_m = 8000 }]
"""


def test_a_passenger_train_takes_tonnes_as_well(capsys: pytest.CaptureFixture[str]) -> None:
    """A metro of 0.5 times its passengers and the same mass in tonnes need the same energy."""
    vehicle = load_scenario("liashenko-ii").vehicle
    tonnes = vehicle.load_mass_kg / 1000
    assert tonnes > 0
    runs = [
        json.loads(answer(capsys, "solve", "liashenko-ii", *words, "--json"))
        for words in ((), ("--set", f"vehicle.load_t={tonnes}"))
    ]
    assert runs[0]["energy_kwh"] == pytest.approx(runs[1]["energy_kwh"], rel=1e-9)
    assert runs[1]["load_t"] == pytest.approx(tonnes)
    assert runs[1]["load_factor"] == pytest.approx(vehicle.load_factor)


def test_an_imported_train_is_loaded(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Empty 180 t, full 400 t; more than 220 t is refused with the number that it can carry."""
    pytest.importorskip("yaml")
    source, train, file = (tmp_path / name for name in ("ore.yaml", "train.toml", "ore.toml"))
    source.write_text(ORE, encoding="utf-8")
    assert main(["import", "railtoolkit", str(source), "-o", str(train)]) == OK
    assert "vehicle.load_t loads it with up to 220 t" in capsys.readouterr().err
    file.write_text(LINE.lstrip() + train.read_text(encoding="utf-8"), encoding="utf-8")
    times = []
    for load_t in (0, 220):
        vehicle = load_scenario(file, {"vehicle.load_t": float(load_t)}).vehicle
        # per mille of each vehicle's own weight, by hand
        assert resistance_coefficients(vehicle)[0] == pytest.approx(9.81 * (80 * 2.0 + (100 + load_t) * 1.4))
        words = ("--strategy", "fastest", "--set", f"vehicle.load_t={load_t}", "--json")
        times.append(json.loads(answer(capsys, "solve", str(file), *words))["travel_time_s"])
    assert times[1] > times[0] + 30
    said = complaint(capsys, "solve", str(file), "--set", "vehicle.load_t=221")
    assert "load_t = 221 must be at most 220, the capacity with crush_load_factor" in said


def test_davis_in_pounds_a_ton_and_a_start_on_the_command_line(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("vehicle.resistance.davis={a=1.3,b=0.03,unit='lb/ton',speed_unit='mph'}",)
    base = json.loads(answer(capsys, "solve", "liashenko-ii", "--json"))
    more = json.loads(answer(capsys, "solve", "liashenko-ii", "--set", *words, "--json"))
    assert more["losses_kwh"]["running_resistance"] > base["losses_kwh"]["running_resistance"]
    said = complaint(
        capsys,
        *("solve", "liashenko-ii", "--set", "vehicle.resistance.starting_n=900000"),
        "vehicle.resistance.starting_ends_at_kmh=5",
    )
    assert "the train stands and cannot start" in said
    assert "900 kN are its starting resistance" in said
