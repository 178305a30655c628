"""Calibration errors of the gauges, by recordings of random trains whose parameters are known."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from measured_trains import CASES, SCENARIO, Errors, measured_trains

from railjoule.core import load_scenario
from railjoule.core.errors import RecordingError
from railjoule.core.identification import GaugeErrors, fit_runs
from railjoule.core.identification.noise import noise_inflation
from railjoule.core.identification.parameters import AUXILIARY, DEFAULT, Model
from railjoule.core.identification.problem import Problem
from railjoule.core.identification.steps import usable_steps
from railjoule.core.measured import measured_run

EXACT = GaugeErrors(0, 0, 0, 0, 0)
USUAL = GaugeErrors()


@cache
def train_with(errors, seed):
    """Return a random train with these errors, recorded once for all tests."""
    (train,) = measured_trains(errors, 1, seed)
    return train


@cache
def fit_train(errors, seed, stated=USUAL):
    """Return the fit to the runs of a train, computed once for all tests."""
    scenario = load_scenario(SCENARIO)
    return fit_runs(train_with(errors, seed).runs(scenario), scenario, stated=stated)


@pytest.fixture(scope="module")
def scenario():
    return load_scenario(SCENARIO)


def shares_inside(case, trains, scenario):
    """Return the share of intervals that hold the truth, by parameter."""
    inside = []
    for train in measured_trains(CASES[case], trains, seed=list(CASES).index(case)):
        fit = fit_runs(train.runs(scenario), scenario)
        inside.append([one.low <= train.truth[one.name] <= one.high for one in fit.parameters])
    return dict(zip(DEFAULT, np.mean(inside, axis=0), strict=True))


@pytest.mark.parametrize(
    "case", ["effort gauge 2 % off", pytest.param("effort offset 2 kN", marks=pytest.mark.nightly)]
)
def test_intervals_hold_the_truth_with_gauges_that_are_off(scenario, case):
    # Of 8 intervals of 95 %, fewer than 6 hold it once in 170. Without gauge errors in the fit, the third review found
    # 23 % for the efficiency and the gauge, 0 % for A and the offset.
    shares = shares_inside(case, 8, scenario)
    assert min(shares.values()) >= 6 / 8, shares


@pytest.mark.nightly
@pytest.mark.parametrize("case", CASES)
def test_intervals_hold_the_truth_in_all_cases_of_the_review(scenario, case):
    # of 31 intervals of 95 %, fewer than 27 hold it once in 50
    shares = shares_inside(case, 31, scenario)
    # gusts last longer than the noise model takes them to: C is held in some 87 % of trains
    assert min(shares.values()) >= (24 if CASES[case].gust_ms > 0 else 27) / 31, shares


def test_a_speed_that_is_too_high_fades_by_the_resistance_that_it_meets(scenario):
    # of two trains under the same efforts, one a little faster: dv' = -R'(v) dv / m
    steps = usable_steps(train_with(Errors(), 3).runs(scenario), scenario)
    faster_ms = 0.2
    problem, faster = (
        Problem(Model(scenario.vehicle, DEFAULT, 30.0), with_speeds, 0.0, EXACT)
        for with_speeds in (steps, replace(steps, start_speed_ms=steps.start_speed_ms + faster_ms))
    )
    start = np.zeros(problem.count)
    ahead = faster.speed_residual(start) - problem.speed_residual(start)
    kept = problem.driven(start).kept
    first = np.flatnonzero(steps.begins)
    last = np.append(first[1:], steps.count) - 1
    for begin, end in zip(first, last, strict=True):
        assert ahead[end] == pytest.approx(faster_ms * np.prod(kept[begin : end + 1]), rel=0.02)
        assert ahead[end] < 0.9 * faster_ms


@pytest.mark.parametrize("stated", [GaugeErrors(), EXACT], ids=["usual", "exact"])
def test_an_offset_of_the_effort_never_leaves_a_value_outside_its_interval(stated):
    # fault F4 of the third review: A 3462 in "3541 to 6745", B 2.5e-17 in "0 to 0"
    for one in fit_train(Errors(effort_offset_n=3e3), 5, stated).parameters:
        assert 0 <= one.low <= one.value <= one.high
        assert one.low < one.high


def test_runs_that_contradict_the_model_are_reported():
    assert fit_train(Errors(), 5).contradiction == ""
    assert fit_train(Errors(effort_offset_n=8e3), 5).contradiction.startswith(
        "These runs contradict the model, so the intervals are not valid: the offset of the effort would"
    )
    by_exact = fit_train(Errors(effort_offset_n=8e3), 5, EXACT).contradiction
    assert "would be -" in by_exact
    assert "standard deviations away" in by_exact


def test_a_line_that_is_not_that_of_the_runs_is_reported(scenario):
    sections = [
        {"length_m": one.length_m, "gradient_permille": one.gradient_permille} for one in scenario.line.sections[::-1]
    ]
    other = scenario.replace(line={"sections": sections})
    sentence = fit_runs(train_with(Errors(), 5).runs(other), other).contradiction
    assert "the simulated speed misses the measured one by" in sentence
    assert "times the noise of usual gauges" in sentence


def test_an_exact_meter_gives_the_auxiliaries_by_the_noise_of_its_samples():
    # some 50 samples of coasting a run with 1 % of noise on 20 to 80 kW: 0.06 kW
    exact, default = fit_train(Errors(), 3, EXACT).parameters[-1], fit_train(Errors(), 3).parameters[-1]
    assert exact.name == default.name == AUXILIARY
    assert exact.low <= train_with(Errors(), 3).truth[AUXILIARY] <= exact.high
    assert exact.high - exact.low < 1.0
    # 0.2 % of some 3,300 kW, times 2.1 to both sides
    assert default.high - default.low == pytest.approx(2 * 2.1 * 0.002 * 3300, rel=0.15)


def test_only_gauge_errors_that_count_in_the_runs_are_listed(scenario):
    fit = fit_train(Errors(), 3)
    assert [gauge.name for gauge in fit.gauge_errors] == ["effort_gain", "effort_offset", "power_gain", "power_offset"]
    assert "gain of the effort 2 %" in fit.assumed
    # the scale of the speeds is not known where a run does not end in a station
    flat = scenario.replace(**{"line.preset": "flat-5km"})
    cut = [measured_run(run.recording, flat, 100.0) for run in train_with(Errors(), 3).runs(scenario)]
    assert "speed_gain" in [gauge.name for gauge in fit_runs(cut, flat).gauge_errors]


@pytest.mark.parametrize(
    ("percent", "words"),
    [
        ({"colour": 1.0}, "--gauge colour: must be among effort_gain"),
        ({"effort_gain": -1.0}, "--gauge effort_gain = -1 %: must lie within 0 to 50 %"),
        ({"effort_gain": float("nan")}, "--gauge effort_gain = nan %: must lie within 0 to 50 %"),
    ],
)
def test_refuses_deviations_that_no_gauge_has(percent, words):
    with pytest.raises(RecordingError, match=words):
        GaugeErrors.from_percent(percent)


def test_the_inflation_of_correlated_residuals_is_that_of_their_sums():
    # of x_i = k x_(i-1) + sqrt(1 - k^2) e_i a long sum has (1 + k) / (1 - k) times the variance of independent ones;
    # windows of 30 s see (1 - d / 30) of what is correlated over d
    random, keep, count = np.random.default_rng(0), 0.6, 20_000
    values = np.empty(count)
    values[0] = random.standard_normal()
    for i in range(1, count):
        values[i] = keep * values[i - 1] + np.sqrt(1 - keep**2) * random.standard_normal()
    lags = np.arange(1, 30)
    expected = 1 + 2 * np.sum((1 - lags / 30) * keep**lags)
    none = np.zeros((count, 1)), np.eye(1)
    assert noise_inflation(values, *none, np.ones(count)) == pytest.approx(expected**0.5, rel=0.05)
    assert noise_inflation(random.standard_normal(count), *none, np.ones(count)) == pytest.approx(1.0, abs=0.05)
