import numpy as np
import pytest

from railjoule.core import ScenarioError, load_scenario
from railjoule.core.simulation.following import simulate_following
from railjoule.core.studies import monte_carlo
from railjoule.core.studies.robust_plan import (
    CHECK_RATIO,
    DrawnRuns,
    UnreachedProbabilityError,
    find_robust_plan,
    robust_plan_steps,
)

RUNS = 600
CERTAIN = {
    f"montecarlo.{name}": {"distribution": "fixed", "value": value}
    for name, value in {
        "load_factor": 0.5,
        "coordinate_error_m": 0.0,
        "resistance_factor": 1.0,
        "line_voltage_factor": 1.0,
        **dict.fromkeys(("speed_error", "d1_error_m", "d2_error_m", "d3_error_m"), 0.0),
    }.items()
}


def drawn(**changes):
    return load_scenario("liashenko-ii").replace(**{"montecarlo.runs": RUNS, **changes})


@pytest.fixture(scope="module")
def found():
    return find_robust_plan(drawn(), 0.8, 12)


def test_the_robust_plan_has_the_least_expected_energy_of_those_on_time(found):
    on_time = [one for one in found.candidates if one.drawn.share_interval[0] >= 0.8]
    assert found.chosen in on_time
    assert found.chosen.drawn.expected_kwh == min(one.drawn.expected_kwh for one in on_time)
    # the plan for half of the load is late with the heavier half of the trains
    assert found.nominal not in on_time


def test_it_holds_under_other_and_more_draws(found):
    nominal, robust = found.checked
    assert robust.runs == CHECK_RATIO * found.chosen.drawn.runs == RUNS
    assert found.is_held
    assert robust.share_on_time > 0.8 > nominal.share_on_time
    assert not np.isin(robust.energy_kwh, found.chosen.drawn.energy_kwh).any()
    extra, error = found.extra_kwh
    assert extra == pytest.approx(robust.expected_kwh - nominal.expected_kwh, rel=1e-9)
    # runs under the same draws differ far less than two samples of runs do
    assert 0 < error < 0.5 * 1.96 * robust.energy_kwh.std() / RUNS**0.5


def test_all_plans_are_followed_by_monte_carlo_under_the_same_draws(found):
    table = monte_carlo(drawn(**{"montecarlo.runs": RUNS // CHECK_RATIO}))
    assert np.array_equal(found.nominal.drawn.energy_kwh, table.energy_kwh)
    assert found.nominal.drawn.lateness_s == pytest.approx(table.delay_s, abs=1e-6)
    # the candidate nearest to the scenario's own plan needs nearly the same in each single run
    other = found.candidates[1]
    assert (other.load_factor, other.resistance_factor) == pytest.approx((0.5, 1.0), abs=0.05)
    assert np.corrcoef(other.drawn.energy_kwh, table.energy_kwh)[0, 1] > 0.99


def test_the_same_seed_finds_the_same_plan():
    first, again = (find_robust_plan(drawn(**{"montecarlo.runs": 100}), 0.3, 3) for _ in range(2))
    assert again.chosen.reserve_s == first.chosen.reserve_s
    assert np.array_equal(again.checked[1].energy_kwh, first.checked[1].energy_kwh)


def test_a_certain_delay_needs_that_reserve():
    """The only thing drawn is a departure 3 s late: on time are the plans that arrive 3 s early, and no others."""
    few = {"montecarlo.runs": 200, "montecarlo.departure_delay_s": {"distribution": "fixed", "value": 3.0}}
    late = drawn(**CERTAIN, **few)
    found = find_robust_plan(late, 0.9, 16)
    reserves = {one.reserve_s: one.drawn.share_on_time for one in found.candidates}
    assert all(share == (1.0 if reserve >= 2.95 else 0.0) for reserve, share in reserves.items())
    assert found.chosen.reserve_s == min(reserve for reserve, share in reserves.items() if share == 1.0) < 4
    # and what it costs is a plan for the shorter time, followed without any deviation
    sooner = late.replace(
        **{
            "timetable.average_speed_kmh": None,
            "timetable.travel_time_s": late.travel_time_s - found.chosen.reserve_s,
        }
    )
    assert found.chosen.drawn.expected_kwh == pytest.approx(simulate_following(sooner).actual.energy_kwh, rel=1e-9)


def test_an_accepted_lateness_needs_no_reserve():
    late = drawn(
        **CERTAIN,
        **{
            "montecarlo.runs": 200,
            "montecarlo.departure_delay_s": {"distribution": "fixed", "value": 3.0},
            "disturbance.accepted_delay_s": 3.0,
        },
    )
    found = find_robust_plan(late, 0.9, 3)
    assert found.chosen.reserve_s == 0
    assert found.extra_kwh[0] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(("on_time", "runs", "low", "high"), [(400, 400, 0.025 ** (1 / 400), 1.0), (0, 50, 0.0, None)])
def test_the_interval_is_exact(on_time, runs, low, high):
    """Clopper and Pearson 1934: of n in n the lower end is 2.5 % ^ (1/n), of none the upper end 1 less that."""
    lateness = np.where(np.arange(runs) < on_time, 0.0, np.nan)
    interval = DrawnRuns(np.ones(runs), lateness, 0.0).share_interval
    assert interval == pytest.approx((low, 1 - 0.025 ** (1 / runs) if high is None else high), rel=1e-9)


def test_a_train_at_a_stand_is_not_on_time():
    runs = DrawnRuns(np.array([2.0, np.nan, 4.0]), np.array([0.0, np.nan, 9.0]), 5.0)
    assert (runs.on_time, runs.expected_kwh) == (1, 3.0)
    assert runs.late_quantile_s(0.9) == np.inf


def test_a_probability_that_none_reaches_is_a_sentence():
    """A delay of the whole run cannot be made up for, and 20 draws without one late show 83 %, not 99 %."""
    sentence = "^probability = 0.9 is reached by none of 4 plans: the best one is on time in 0 of 20 runs"
    late = {"montecarlo.departure_delay_s": {"distribution": "fixed", "value": 120.0}, "montecarlo.runs": 100}
    with pytest.raises(UnreachedProbabilityError, match=sentence):
        find_robust_plan(drawn(**late), 0.9, 3)
    with pytest.raises(UnreachedProbabilityError, match=r"in 20 of 20 runs \(1; at 95 % confidence at least 0\.832\)"):
        find_robust_plan(drawn(**{"montecarlo.runs": 100}), 0.99, 3)


@pytest.mark.parametrize(
    ("probability", "candidates", "sentence"),
    [(1.0, 5, "probability = 1 must lie"), (0.9, 0, "candidates = 0 must lie between 1 and 1,000")],
)
def test_settings_out_of_bounds_are_refused(probability, candidates, sentence):
    with pytest.raises(ScenarioError, match=sentence):
        next(robust_plan_steps(drawn(), probability, candidates))


def test_the_candidates_are_a_labelled_table(found):
    table = found.to_table().to_xarray()
    assert table.sizes == {"candidate": 13}
    assert table.is_chosen.values.sum() == 1
    assert table.reserve_s.attrs["units"] == "s"
