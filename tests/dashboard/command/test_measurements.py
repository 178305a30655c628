import json
import re
from pathlib import Path

import pytest
from commands import answer

from railjoule.core import load_scenario

RECORDINGS = Path(__file__).parents[3] / "assets" / "recordings"
RUNS = [str(RECORDINGS / f"liashenko-ii-{seconds}s.csv") for seconds in (83, 89, 108)]


def test_measured_prints_json(capsys, tmp_path):
    scenario, table = tmp_path / "run.toml", tmp_path / "run.csv"
    words = ("measured", RUNS[2], "--scenario", "liashenko-ii", "-o", str(scenario), "--trajectory", str(table))
    found = json.loads(answer(capsys, *words, "--json"))
    assert found["travel_time_s"] == pytest.approx(108.0, abs=0.5)
    assert found["optimal_kwh"] < found["modelled_kwh"]
    assert found["possible_saving_kwh"] == pytest.approx(found["modelled_kwh"] - found["optimal_kwh"])
    low, high = found["saving_interval_kwh"]
    assert low < 0 < found["possible_saving_kwh"] < high
    assert found["saving_doubt"].startswith("No saving can be stated")
    assert found["model_error_kwh"] == pytest.approx(abs(found["modelled_kwh"] - found["measured_kwh"]))
    assert found["saving_at_most_kwh"] >= found["possible_saving_kwh"] - 1e-6
    assert 0 <= found["gap"] <= 5e-4
    assert load_scenario(str(scenario)).timetable.travel_time_s == pytest.approx(found["travel_time_s"], abs=0.2)
    assert table.stat().st_size > 1000


def test_measured_prints_words(capsys):
    text = answer(capsys, "measured", RUNS[2], "--scenario", "liashenko-ii")
    assert "Measured " in text
    assert "by the scenario at the measured speeds" in text
    assert "in the same time with the same stops, proven optimal" in text
    assert "No saving can be stated: the optimum needs 0.0435 kWh less" in text
    assert "The speed has steps of 0.1 m/s" in text


def test_measured_prints_a_saving_with_its_interval_and_the_part_of_the_line(capsys):
    text = answer(capsys, "measured", str(RECORDINGS / "metro-0714.csv"), "--scenario", "metro-with-limit")
    assert re.search(
        r"1\.649 kWh, 0\.\d+ to 2\.\d+ kWh by the errors of the speed and the model: the optimum saves", text
    )
    assert "Place" not in text
    text = answer(capsys, "measured", RUNS[2], "--scenario", "metro-with-limit", "--from", "1000")
    assert "Place          from 1000 m to 2300 m of the line's 2300 m" in text


def test_a_run_that_the_train_cannot_drive_is_told_without_a_saving(capsys):
    words = ("--scenario", "liashenko-ii", "--set", "vehicle.traction.max_speed_kmh=55")
    found = json.loads(answer(capsys, "measured", RUNS[0], *words, "--json"))
    assert found["optimal_kwh"] is None
    assert any("but the scenario's train needs at least" in note for note in found["notes"])


def test_fit_prints_json(capsys, tmp_path):
    target = tmp_path / "fitted.toml"
    found = json.loads(answer(capsys, "fit", *RUNS, "--scenario", "liashenko-ii", "-o", str(target), "--json"))
    # the recorded train has 0.82 and 0.10 where the scenario has 0.85 and 0.12
    for name, true in (("drive.traction_efficiency", 0.82), ("rotating_mass_factor", 0.10)):
        told = found["parameters"][name]
        assert told["low"] <= true <= told["high"]
    assert {"value", "low", "high"} <= found["parameters"]["resistance.constant_n"].keys()
    assert found["residual_ms"] < 0.5
    assert found["contradiction"] == ""
    assert found["gauge_errors"]["effort_gain"]["deviation"] == 0.02
    assert found["gauge_errors"]["power_offset"]["unit"] == "W"
    assert found["correlation"]["resistance.constant_n"]["resistance.constant_n"] == pytest.approx(1.0)
    assert [one["run"] for one in found["held_out"]] == [Path(run).name for run in RUNS]
    assert all(abs(one["energy_error"]) < 0.02 for one in found["held_out"])
    fitted = load_scenario(str(target))
    assert fitted.vehicle.drive.traction_efficiency == found["parameters"]["drive.traction_efficiency"]["value"]
    assert fitted.montecarlo.resistance_factor.log_standard_deviation == pytest.approx(found["resistance_deviation"])


def test_fit_prints_words(capsys):
    text = answer(capsys, "fit", RUNS[2], "--scenario", "liashenko-ii", "--free", "resistance.constant_n")
    assert "95 % interval" in text
    assert "One run leaves none to hold out" in text
    assert "Assumed standard deviations of the gauges' errors: gain of the effort 2 % and offset of the effort" in text


def test_stated_gauge_errors_take_the_place_of_the_assumed_ones(capsys):
    words = ("--free", "resistance.constant_n", "--gauge", "effort_gain=0", "effort_offset=0")
    assert "The gauges are taken as exact." in answer(capsys, "fit", RUNS[2], "--scenario", "liashenko-ii", *words)
