"""Steps and noise of a recorder's speed; the right values are those by which the speeds here are made."""

import numpy as np
import pytest

from railjoule.core.measured.speed_error import impossible_change, noise_deviation, quantisation, standing_samples

KMH_MS, MPH_KMH = 1 / 3.6, 1.609344
SPEED_KMH = 72 * np.sin(np.pi * np.arange(110) / 109)
"""A run of 109 s at 1 Hz."""


@pytest.mark.parametrize(
    ("step_kmh", "unit", "decimals"),
    [
        (1.0, KMH_MS, 2),  # fault 2 of field.md in the third review
        (0.5, KMH_MS, 2),
        (0.1, KMH_MS, 3),
        (0.36, 1.0, 1),  # 0.1 m/s
        (MPH_KMH, 1.0, 1),
        (1.0, 1 / MPH_KMH, 1),
        (0.36, 1 / MPH_KMH, 2),
    ],
)
def test_a_step_is_found_behind_a_second_rounding(step_kmh, unit, decimals):
    written = np.round(step_kmh * np.round(SPEED_KMH / step_kmh) * unit, decimals)
    found = quantisation(written)
    assert found == pytest.approx(step_kmh * unit, rel=2e-3)
    assert noise_deviation(written, found) == 0


def test_an_even_change_of_speed_is_not_a_step():
    assert quantisation(np.round(np.linspace(0, 20, 77), 1)) == pytest.approx(0.1)


@pytest.mark.parametrize("noise_ms", [0.05, 0.17])
@pytest.mark.parametrize("step_ms", [0.1, 0.01])
def test_noise_is_estimated_where_it_exceeds_the_steps(noise_ms, step_ms):
    found = []
    for seed in range(8):
        speed = SPEED_KMH * KMH_MS + noise_ms * np.random.default_rng(seed).standard_normal(len(SPEED_KMH))
        found.append(noise_deviation(np.maximum(step_ms * np.round(speed / step_ms), 0), step_ms))
    # 0.05 m/s beside steps of 0.1 m/s can be either
    if noise_ms > step_ms:
        assert np.array(found) == pytest.approx(noise_ms, rel=0.35)
        assert np.mean(found) == pytest.approx(noise_ms, rel=0.12)


def test_a_short_or_steady_speed_has_no_noise():
    assert noise_deviation(np.array([0.0, 1.0, 2.0]), 0.0) == 0
    assert noise_deviation(SPEED_KMH, 0.0) < 1e-3


def test_a_sensor_that_shows_a_speed_at_standstill():
    time = np.arange(10.0)
    speed = np.array([0.1, 0.1, 0.0, 0.1, 1.0, 2.0, 1.0, 0.1, 0.1, 0.1])
    assert standing_samples(time, speed, 0.0).tolist() == [True] * 4 + [False] * 3 + [True] * 3
    # a train that starts is not at rest
    assert not np.any(standing_samples(time, np.array([0, 0, 0, 0.1, 1, 2, 1, 0.1, 0, 0]), 0.0))


def test_a_change_that_no_train_makes_is_found_at_any_rate():
    time = np.arange(100) / 10
    assert impossible_change(time, np.minimum(4.0 * time, 20)) is None
    # 12 m/s2, 1.2 m/s from sample to sample
    assert impossible_change(time, np.minimum(12.0 * time, 20)) == (0, 10)
    assert impossible_change(np.arange(3.0), np.array([0.0, 1.0, 7.0])) == (1, 2)
