import numpy as np
import pytest
from recordings import as_csv, samples, with_time

from railjoule.core import load_scenario, solve
from railjoule.core.errors import RecordingError
from railjoule.core.measured import load_run, measured_run, possible_saving, read_recording
from railjoule.core.measured.speed import smoothed_speed


@pytest.fixture(scope="module")
def scenario():
    return load_scenario("liashenko-ii")


def run_of(scenario, run, start_m=None, **recorder):
    return measured_run(read_recording(as_csv(samples(run, **recorder)), "run.csv"), scenario, start_m)


@pytest.mark.parametrize(
    ("name", "strategy", "largest"),
    # what sampling at 1 Hz leaves: switching between two samples is not seen, nor the sharp peak of the fastest run
    [
        ("liashenko-ii", "optimal", 0.006),
        # full power turns into full brake between two samples
        ("liashenko-ii", "fastest", 0.03),
        ("metro-10-stations", "optimal", 0.005),
        ("kharkiv-like-40kmh", "optimal", 0.012),
        ("tram-950m", "optimal", 0.015),
        ("ftorek-300s", "optimal", 0.002),
    ],
)
def test_the_model_finds_the_energy_of_a_recorded_run(name, strategy, largest):
    scenario = load_scenario(name)
    run = solve(scenario, strategy)
    measured = run_of(scenario, run)
    assert measured.modelled.energy_kwh == pytest.approx(run.energy_kwh, rel=largest)
    assert abs(measured.modelled.energy.imbalance) < 1e-9
    assert measured.modelled.travel_time_s == pytest.approx(run.travel_time_s, abs=1.0)


def test_a_run_of_many_samples_is_smoothed_by_their_means(scenario):
    run = solve(with_time(scenario, 110.0), "speed_limits")
    columns = samples(run, step_s=0.02, speed_step_ms=0.0)
    noise = 0.05 * np.random.default_rng(2).standard_normal(len(columns["speed_ms"]))
    columns["speed_ms"] = np.where(columns["speed_ms"] > 0, np.maximum(columns["speed_ms"] + noise, 0.0), 0.0)
    measured = measured_run(read_recording(as_csv(columns, ("time_s", "speed_ms")), "run.csv"), scenario)
    assert len(measured.speed_ms) > 5000
    assert measured.recording.speed_noise_ms == pytest.approx(0.05, rel=0.05)
    assert measured.modelled.energy_kwh == pytest.approx(run.energy_kwh, rel=0.01)


def test_raw_steps_would_cost_more_than_they_did(scenario):
    # why there is a smoothing at all: a train that coasts would be paid for in traction and brakes in turn
    recording = read_recording(as_csv(samples(solve(scenario))), "run.csv")
    steps = np.diff(recording.speed_ms) / np.diff(recording.time_s)
    kept, coasts = smoothed_speed(recording.time_s, recording.speed_ms, 0.1, 0.0, np.zeros(len(steps)))
    assert np.abs(np.diff(np.diff(kept) / np.diff(recording.time_s))).sum() < 0.5 * np.abs(np.diff(steps)).sum()
    assert np.max(np.abs(kept - recording.speed_ms)) <= 0.05 + 1e-9
    assert coasts.dtype == bool


def test_the_meter_is_read(scenario):
    run = solve(scenario)
    assert run_of(scenario, run).measured_kwh == pytest.approx(run.energy_kwh, rel=1e-4)


def test_the_account_of_what_was_measured_names_what_no_model_explains(scenario):
    measured = run_of(scenario, solve(scenario)).measured
    energy = measured.energy
    assert abs(energy.imbalance) < 1e-9
    assert abs(energy.losses_j["unexplained"]) < 0.05 * energy.traction_j
    assert measured.strategy == "measured"


def test_stops_are_kept_with_their_dwells():
    scenario = load_scenario("metro-10-stations")
    found = run_of(scenario, solve(scenario)).scenario.line.inner_stations
    stations = scenario.line.inner_stations
    assert [stop.name for stop in found] == [station.name for station in stations]
    for stop, station in zip(found, stations, strict=True):
        assert stop.position_m == pytest.approx(station.position_m, abs=10)
        assert stop.dwell_s == pytest.approx(station.dwell_s, abs=1.1)


def test_a_driver_could_have_saved_what_the_optimum_saves(scenario):
    saving = possible_saving(run_of(scenario, solve(with_time(scenario, 110.0), "speed_limits")))
    assert saving.optimum.is_proven
    assert 0 < saving.possible_kwh <= saving.at_most_kwh + 1e-6
    assert possible_saving(run_of(scenario, solve(with_time(scenario, 110.0)))).possible_kwh < 0.1


def test_a_part_of_a_line_is_found():
    scenario = load_scenario("metro-10-stations")
    run = solve(scenario)
    text = as_csv(samples(run)).splitlines()
    stops = [station.position_m for station in scenario.line.inner_stations]
    phase = np.random.default_rng(0).random()  # of the recorder's clock, as `samples` draws it
    positions = np.interp([float(line.split(",")[0]) for line in text[1:]], run.time_s + 3 - phase, run.position_m)
    # from the second to the fourth station, standing at both
    rows = [line for line, place in zip(text[1:], positions, strict=True) if stops[1] - 0.05 < place < stops[3] + 0.05]
    measured = measured_run(read_recording("\n".join([text[0], *rows]), "part.csv"), scenario)
    assert measured.placement.start_m == pytest.approx(stops[1])
    assert measured.placement.end_m == pytest.approx(stops[3])
    assert measured.scenario.line.length_m == pytest.approx(stops[3] - stops[1])


def test_a_place_that_the_run_does_not_tell_is_asked_for():
    # a flat line has the same heights everywhere, and a run that never stands knows no station
    scenario = load_scenario("ftorek-300s")
    rows = "\n".join(f"{second},50" for second in range(60))
    with pytest.raises(RecordingError, match=r"fits the line alike from .* say where it begins by --from"):
        measured_run(read_recording(f"time_s,speed_kmh\n{rows}", "part.csv"), scenario)
    placed = measured_run(read_recording(f"time_s,speed_kmh\n{rows}", "part.csv"), scenario, 400.0)
    assert placed.placement.start_m == 400.0
    assert placed.scenario.timetable.entry_speed_kmh == pytest.approx(50.0, abs=0.05)


def test_refuses_a_run_that_the_line_cannot_hold(scenario):
    rows = "\n".join(f"{second},{min(second, 50, 400 - second)}" for second in range(401))
    recording = read_recording(f"time_s,speed_kmh\n{rows}", "long.csv")
    with pytest.raises(RecordingError, match=r"covers .* m, but the line of the scenario has 1300 m"):
        measured_run(recording, scenario)
    with pytest.raises(RecordingError, match=r"--from 2000: must be at least 0 and below 1300 m"):
        measured_run(recording, scenario, 2000.0)
    with pytest.raises(RecordingError, match="but the line ends at 1300 m"):
        measured_run(recording, scenario, 10.0)


@pytest.mark.parametrize("end_kmh", [0.0, 0.4, 5.0])
def test_a_run_that_is_a_little_longer_than_the_line_covers_it(scenario, end_kmh):
    """0.3 m with 0.4 km/h at standstill, and 0.1 m at speed, were refused: walk_teacher.md, field.md."""
    columns = samples(solve(scenario))
    columns["speed_ms"] = np.maximum(columns["speed_ms"] * 1.001, end_kmh / 3.6)
    columns["speed_ms"][0] = 0.0
    moving = np.flatnonzero(samples(solve(scenario))["speed_ms"] > 0)
    text = as_csv({name: values[: moving[-1] + 1] for name, values in columns.items()}, ("time_s", "speed_ms"))
    run = measured_run(read_recording(text, "run.csv"), scenario)
    assert run.placement.is_whole_line
    assert run.scenario.line.length_m == pytest.approx(1300)


def test_refuses_efforts_in_another_unit(scenario):
    columns = samples(solve(scenario))
    columns["effort_kn"] = 1e3 * columns["effort_kn"]
    with pytest.raises(RecordingError, match="the vehicle has at most 285 kN; is it in another unit"):
        measured_run(read_recording(as_csv(columns), "run.csv"), scenario)


def test_refuses_a_meter_that_was_reset(scenario):
    columns = samples(solve(scenario))
    columns["energy_kwh"][60:] -= columns["energy_kwh"][60]
    columns["energy_kwh"] = columns["energy_kwh"] + np.where(np.arange(len(columns["time_s"])) < 60, 100, 0)
    with pytest.raises(RecordingError, match="the meter was reset"):
        measured_run(read_recording(as_csv(columns), "run.csv"), scenario)


def test_a_run_that_the_model_cannot_drive_has_no_saving(scenario):
    run = run_of(scenario.replace(**{"vehicle.traction.max_power_kw": 1500}), solve(scenario, "fastest"))
    assert any("more tractive effort than the scenario's vehicle has" in note for note in run.notes)
    with pytest.raises(RecordingError, match="but the scenario's train needs at least"):
        possible_saving(run)


def test_the_table_of_a_solution_is_a_recording(scenario, tmp_path):
    run = solve(scenario)
    file = tmp_path / "run.csv"
    run.to_dataframe().to_csv(file, index=False)
    assert load_run(file, scenario).modelled.energy_kwh == pytest.approx(run.energy_kwh, rel=0.01)


def test_a_line_current_gives_the_power(scenario):
    """A recorder that has current and voltage tells the energy as one that has the power does."""
    columns = samples(solve(scenario))
    columns["line_voltage_v"] = np.full(len(columns["time_s"]), 750.0)
    columns["line_current_a"] = 1e3 * columns["power_kw"] / 750.0
    names = ("time_s", "speed_ms", "line_current_a", "line_voltage_v")
    run = measured_run(read_recording(as_csv(columns, names), "run.csv"), scenario)
    with_power = measured_run(read_recording(as_csv(columns, ("time_s", "speed_ms", "power_kw")), "run.csv"), scenario)
    assert run.measured_kwh == pytest.approx(with_power.measured_kwh, rel=1e-6)
    assert any(note.startswith("The electric power is the line current times the line voltage; ") for note in run.notes)
    # without a voltage in the file that of the vehicle counts
    at_750 = scenario.replace(**{"vehicle.line_voltage_v": 750})
    alone = read_recording(as_csv(columns, names[:3]), "run.csv")
    assert measured_run(alone, at_750).measured_kwh == pytest.approx(with_power.measured_kwh, rel=1e-6)
    assert any("line_voltage_v of 750 V" in note for note in measured_run(alone, at_750).notes)
    no_voltage = scenario.vehicle.model_copy(update={"line_voltage_v": None})
    unknown = measured_run(alone, scenario.model_copy(update={"vehicle": no_voltage}))
    assert unknown.measured_kwh is None
    assert any("the vehicle no line_voltage_v" in note for note in unknown.notes)


def test_a_current_is_not_used_beside_a_meter(scenario):
    columns = samples(solve(scenario))
    columns["line_current_a"] = np.full(len(columns["time_s"]), 1e4)
    names = ("time_s", "speed_ms", "energy_kwh", "line_current_a")
    run = measured_run(read_recording(as_csv(columns, names), "run.csv"), scenario)
    assert run.measured_kwh == pytest.approx(solve(scenario).energy_kwh, rel=1e-3)
    assert "The line current is not used: the file has the energy meter." in run.notes


def test_refuses_a_voltage_in_another_unit(scenario):
    columns = samples(solve(scenario))
    columns |= {"line_voltage_v": np.full(len(columns["time_s"]), 0.75), "line_current_a": columns["power_kw"]}
    names = ("time_s", "speed_ms", "line_current_a", "line_voltage_v")
    recording = read_recording(as_csv(columns, names), "run.csv")
    with pytest.raises(RecordingError, match=r"about 0.75 V, but the vehicle's line_voltage_v is 750 V; is it in"):
        measured_run(recording, scenario.replace(**{"vehicle.line_voltage_v": 750}))
