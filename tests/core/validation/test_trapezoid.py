from dataclasses import replace

import numpy as np
import pytest

from railjoule.core import load_scenario
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.enoc import enoc_coefficients, enoc_energy
from railjoule.core.strategies.plain_line import plain_line
from railjoule.core.validation._trapezoid import sample_trapezoid


@pytest.fixture(scope="module")
def line():
    return plain_line(prepare_task(load_scenario("ftorek-300s")))


@pytest.mark.parametrize(("time", "ramp"), [(270.0, 60.932), (300.0, 5.0), (300.0, 150.0)])
def test_sampled_energy_is_the_closed_form(line, time, ramp):
    run = sample_trapezoid(line, time, ramp)
    # Simpson's rule is exact to rounding for these polynomials on 1001 samples a part
    assert run.energy_j[-1] == pytest.approx(float(enoc_energy(enoc_coefficients(line), time, ramp)), rel=1e-9)


def test_shaft_energy_is_the_closed_form_without_copper_loss(line):
    lossless = enoc_coefficients(replace(line, loss_coefficient=0.0))
    run = sample_trapezoid(line, 300.0, 62.713)
    assert run.shaft_energy_j == pytest.approx(float(enoc_energy(lossless, 300.0, 62.713)), rel=1e-9)


def test_extremes_of_effort_lie_at_the_corners(line):
    run = sample_trapezoid(line, 300.0, 62.713)
    peak = 5000 / (300 - 62.713)
    inertia = line.inertia_kg * peak / 62.713
    drag = line.constant_n + line.linear * peak + line.quadratic * peak**2
    assert run.peak_speed_ms == pytest.approx(peak)
    assert np.max(run.effort_n) == pytest.approx(inertia + drag)
    assert np.min(run.effort_n) == pytest.approx(line.constant_n - inertia)
