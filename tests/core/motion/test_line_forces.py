"""Means of gradient and curve over cells and trains, against brute-force integration."""

import numpy as np
import pytest
from builders import HILLS, plain_scenario
from hypothesis import given
from hypothesis import strategies as st

from railjoule.core.motion import build_meshed_line
from railjoule.core.motion.line_geometry import TrainExtent, mean_over_train
from railjoule.core.scenario import Line

LINE = Line.model_validate({"sections": HILLS})
VALUES = np.array([3.0, -20.0, 7.5, 0.0, 40.0])
ENDS = np.cumsum([section["length_m"] for section in HILLS])


def at(places):
    """Return the constant of the section at each place; before the start the first one continues."""
    return VALUES[np.clip(np.searchsorted(ENDS, places, side="right"), 0, len(VALUES) - 1)]


def brute_force(nodes, offsets, samples=400):
    """Sample every cell at the middles of `samples` parts, for each point of the train."""
    shares = (np.arange(samples) + 0.5) / samples
    fronts = nodes[:-1, None] + np.diff(nodes)[:, None] * shares
    return at(fronts[:, :, None] - offsets).mean(axis=(1, 2))


nodes = st.lists(st.integers(1, 1999), min_size=1, max_size=8, unique=True).map(
    lambda inner: np.array([0.0, *sorted(inner), 2000.0])
)


@given(nodes, st.integers(1, 8), st.floats(10, 600))
def test_cars_are_felt_at_their_centres(position_m, car_count, length_m):
    means = mean_over_train(LINE, VALUES, position_m, TrainExtent(length_m, car_count))
    centres = (np.arange(car_count) + 0.5) * length_m / car_count
    assert means == pytest.approx(brute_force(position_m, centres, 2000), abs=60 / 2000 * 2)


def test_the_first_value_continues_before_the_line():
    line = Line.model_validate({"sections": [{"length_m": 100}, {"length_m": 100}]})
    means = mean_over_train(line, np.array([6.0, 0.0]), np.array([0.0, 100.0, 200.0]), TrainExtent(50.0))
    # in the second cell, half of the train's length passes the border: 50 of 100 m at a mean of a half
    assert means == pytest.approx([6.0, 6.0 * 25 / 100])


def test_forces_on_a_train():
    """120 t on 25 per mille, and in a curve of 300 m with 600 N m/kN: 29.43 kN and 2.354 kN."""
    scenario = plain_scenario(
        {
            "vehicle.tare_kg": 120e3,
            "vehicle.resistance.curve_constant_m_n_per_kn": 600.0,
            "line.sections": [{"length_m": 500, "gradient_permille": 25, "curve_radius_m": 300}],
        }
    )
    mesh = build_meshed_line(scenario)
    assert mesh.gradient_force_n == pytest.approx(120 * 9.81 * 25)
    assert mesh.curve_force_n == pytest.approx(120 * 9.81 * 600 / 300)
    assert mesh.data.line_force_n == pytest.approx(mesh.gradient_force_n + mesh.curve_force_n)
