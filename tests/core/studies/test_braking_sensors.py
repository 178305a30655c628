import numpy as np
import pytest

from railjoule.core import load_scenario
from railjoule.core.simulation.following import simulate_following
from railjoule.core.studies.braking_sensors import MEASUREMENTS, study_braking_sensors


def metro(**changes):
    return load_scenario("liashenko-ii").replace(**{"montecarlo.runs": 200, **changes})


@pytest.fixture(scope="module")
def study():
    return study_braking_sensors(metro())


def test_the_stopping_errors_follow_from_figure_2(study):
    """Liashenko, Yatsko 2025, Figure 2: L_c = 120 m between D1 and D2, L_st = 15 m from D3 to the stop.

    D3 sets the position: its own error passes on in full, and of the calibration between D1 and D2, off by
    (e2 - e1) / L_c, the train drives the last L_st. The error of the speed sensor and that of the position cancel.
    """
    drawn = study.table
    expected = drawn["d3_error_m"] + 15.0 * (drawn["d2_error_m"] - drawn["d1_error_m"]) / 120.0
    assert study.table["stop_error_m"] == pytest.approx(expected, abs=0.05)
    assert np.mean(np.abs(study.table["stop_error_m"] - expected) < 1e-6) > 0.95


def test_without_sensors_the_train_stops_at_its_estimate_of_the_stop(study):
    """(10), and an odometer that measures 1 + e of the distance S: it stops at (S - ds) / (1 + e)."""
    drawn, length = study.table, study.table.scenario.line.length_m
    expected = (length - drawn["coordinate_error_m"]) / (1 + drawn["speed_error"]) - length
    # its plan uses all of the brake, so that some trains overrun their estimate by less than half a metre
    assert np.max(np.abs(study.table["stop_error_without_sensors_m"] - expected)) < 0.5
    assert np.mean(np.abs(study.table["stop_error_without_sensors_m"] - expected) < 1e-6) > 0.3


def test_precision_braking_withstands_each_error_but_that_of_the_last_sensor(study):
    effects = {}
    for effect in study.effects:
        effects.setdefault(effect.quantity, []).append(effect)
    assert list(effects) == list(MEASUREMENTS)
    for name in ("coordinate_error_m", "speed_error"):
        assert max(abs(effect.with_m) for effect in effects[name]) < 0.001
        assert min(abs(effect.without_m) for effect in effects[name]) > 9
    for effect in effects["d1_error_m"] + effects["d2_error_m"]:
        assert abs(effect.with_m) == pytest.approx(abs(effect.value) / 8, rel=1e-6)
    assert all(effect.with_m == pytest.approx(effect.value, rel=1e-6) for effect in effects["d3_error_m"])


def test_precision_braking_narrows_the_spread(study):
    """Errors of 0.5 m in each of three places: 0.5 sqrt(1 + 2 / 64) m; 5 m and 0.5 % of 1300 m: 8.2 m."""
    assert study.spread_with.deviation_m == pytest.approx(0.5 * np.sqrt(1 + 2 / 64), rel=0.1)
    assert study.spread_without.deviation_m == pytest.approx(np.hypot(5.0, 0.005 * 1300), rel=0.1)
    assert study.spread_without.deviation_m > 10 * study.spread_with.deviation_m
    spread = study.spread_with
    assert spread.deviation_m < spread.half_width_m < np.max(np.abs(study.table["stop_error_m"]))


def test_a_train_does_not_stand_centimetres_before_its_stop():
    """D3 moves the estimate back by half a metre, so the train lags the plan when it comes to the stop."""
    errors = {"simulation.speed_error": 0.0083783, "simulation.sensor_errors_m": [0.44717, -0.28413, 0.10949]}
    run = simulate_following(metro(**errors, **{"disturbance.coordinate_error_m": 0.47879}))
    assert run.stop_error_m == pytest.approx(0.10949 + 15 * (-0.28413 - 0.44717) / 120, abs=1e-6)


def test_the_study_is_a_labelled_table(study):
    table = study.table.to_xarray()
    assert table.sizes == {"run": 200}
    assert table.stop_error_m.attrs["units"] == "m"
