import numpy as np
import pytest

from railjoule.core import ScenarioError, load_scenario
from railjoule.core.simulation.following import simulate_following
from railjoule.core.studies import monte_carlo, monte_carlo_steps
from railjoule.core.studies.montecarlo import CONDITIONS, QUANTITIES, SENSOR_ERRORS, draw

FIXED = {
    f"montecarlo.{name}": {"distribution": "fixed", "value": 0.0 if name not in CONDITIONS else 1.0}
    for name in QUANTITIES
}


def few(runs=120, **changes):
    return load_scenario("liashenko-ii").replace(**{"montecarlo.runs": runs, **changes})


@pytest.fixture(scope="module")
def table():
    return monte_carlo(few())


def test_the_same_seed_gives_the_same_table(table):
    assert np.array_equal(monte_carlo(few()).energy_kwh, table.energy_kwh)
    assert not np.array_equal(monte_carlo(few(**{"montecarlo.seed": 2})).energy_kwh, table.energy_kwh)


def test_more_runs_begin_with_the_same_ones(table):
    assert np.array_equal(monte_carlo(few(150)).energy_kwh[:120], table.energy_kwh)


def test_another_distribution_leaves_the_other_quantities():
    other = few(**{"montecarlo.load_factor": {"distribution": "uniform", "low": 0.0, "high": 1.0}})
    before, after = draw(few()), draw(other)
    assert np.array_equal(before["coordinate_error_m"], after["coordinate_error_m"])
    assert not np.array_equal(before["load_factor"], after["load_factor"])


def test_a_run_is_a_single_simulation(table):
    run = 7
    drawn = {name: float(values[run]) for name, values in [(name, table[name]) for name in QUANTITIES]}
    names = {name: f"disturbance.{name}" for name in CONDITIONS} | {"load_factor": "disturbance.actual_load_factor"}
    changes = {names[name]: drawn[name] for name in CONDITIONS}
    sensors = {"simulation.sensor_errors_m": [drawn[name] for name in SENSOR_ERRORS]}
    single = simulate_following(few(**changes, **sensors, **{"simulation.speed_error": drawn["speed_error"]}))
    assert table.stop_error_m[run] == single.stop_error_m != 0
    assert table.energy_kwh[run] == pytest.approx(single.actual.energy_kwh, rel=1e-12)
    assert table.delay_s[run] == pytest.approx(single.delay_s, abs=1e-9)


def test_without_chance_nothing_goes_wrong():
    certain = few(3, **FIXED, **{"vehicle.load_factor": 1.0})
    certain = certain.replace(
        **{f"montecarlo.{name}.value": 0.0 for name in ("coordinate_error_m", "departure_delay_s")}
    )
    table = monte_carlo(certain)
    assert table.overconsumption == pytest.approx(np.zeros(3), abs=1e-9)
    assert table.over_replanned == pytest.approx(np.zeros(3), abs=1e-9)
    assert table.delay_s == pytest.approx(np.zeros(3), abs=1e-6)


def test_a_late_start_is_a_late_arrival():
    late = {"montecarlo.departure_delay_s": {"distribution": "exponential", "mean": 10.0}}
    with_delay, without = monte_carlo(few(40, **late)), monte_carlo(few(40))
    assert with_delay.delay_s - without.delay_s == pytest.approx(with_delay["departure_delay_s"], abs=1e-9)


@pytest.mark.parametrize(
    ("distribution", "mean", "deviation"),
    [
        ({"distribution": "uniform", "low": 0.2, "high": 0.8}, 0.5, 0.6 / np.sqrt(12)),
        ({"distribution": "triangular", "low": 0.2, "mode": 0.2, "high": 0.8}, 0.4, 0.6 / np.sqrt(18)),
        ({"distribution": "normal", "standard_deviation": 0.05}, 0.5, 0.05),
        ({"distribution": "normal", "mean": 0.3, "standard_deviation": 0.05}, 0.3, 0.05),
        ({"distribution": "log_normal", "median": 0.3, "log_standard_deviation": 0.1}, 0.3 * np.exp(0.005), 0.0301),
        ({"distribution": "exponential", "mean": 0.05}, 0.05, 0.05),
        ({"distribution": "fixed", "value": 0.25}, 0.25, 0.0),
    ],
)
def test_distributions_have_their_moments(distribution, mean, deviation):
    """Textbook moments of each distribution; 20,000 draws know them to about a hundredth of the deviation."""
    load = draw(few(20_000, **{"montecarlo.load_factor": distribution}))["load_factor"]
    assert load.mean() == pytest.approx(mean, abs=0.002)
    assert load.std() == pytest.approx(deviation, rel=0.03, abs=1e-12)


def test_what_is_drawn_stays_within_its_bounds():
    wide = few(2000, **{"montecarlo.load_factor": {"distribution": "normal", "standard_deviation": 5.0}})
    load = draw(wide)["load_factor"]
    assert load.min() >= 0
    assert load.max() <= 1
    # cut off, not clipped: no heap at the ends
    assert np.mean((load < 0.01) | (load > 0.99)) < 0.05


@pytest.mark.parametrize(
    ("changes", "most"),
    [
        ({}, 1.0),
        ({"vehicle.load_factor": 1.0}, 1.0),
        ({"vehicle.load_factor": 1.1}, 1.2),
        ({"montecarlo.load_factor": {"distribution": "normal", "mean": 1.1, "standard_deviation": 5.0}}, 1.2),
        ({"montecarlo.load_factor": {"distribution": "uniform", "low": 0.0, "high": 1.2}}, 1.2),
    ],
)
def test_crush_loads_are_drawn_where_they_are_asked_for(changes, most):
    wide = {"montecarlo.load_factor": {"distribution": "normal", "standard_deviation": 5.0}}
    assert 0.97 * most < draw(few(2000, **{**wide, **changes}))["load_factor"].max() <= most


def test_crush_loads_have_plans_that_know_them():
    assert np.isfinite(monte_carlo(few(20, **{"vehicle.load_factor": 1.15})).over_replanned).all()


@pytest.mark.parametrize(
    ("distribution", "sentence"),
    [
        ({"distribution": "fixed", "value": 1.5}, "montecarlo.load_factor.value = 1.5 must lie within 0 to 1.2."),
        (
            {"distribution": "uniform", "low": 2.0, "high": 3.0},
            "montecarlo.load_factor: the distribution has no values within 0 to 1.2.",
        ),
    ],
)
def test_a_distribution_beyond_its_bounds_is_refused(distribution, sentence):
    with pytest.raises(ScenarioError, match=sentence):
        monte_carlo(few(3, **{"montecarlo.load_factor": distribution}))


def test_results_stand_as_they_come():
    assert [table.done for table in monte_carlo_steps(few(90))] == [0, 40, 80, 90]


def test_the_dataset_is_labelled(table):
    data = table.to_xarray()
    assert data.sizes == {"run": 120}
    assert data.attrs["seed"] == 1
    assert data.delay_s.attrs["units"] == "s"
    assert data.overconsumption.values == pytest.approx(data.energy_kwh.values / data.attrs["planned_energy_kwh"] - 1)
