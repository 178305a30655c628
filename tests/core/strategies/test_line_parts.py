"""The optimum under windows of arrival, against a search over all arrivals that knows none of its rules."""

import numpy as np
import pytest
import scipy
from builders import COPPER_LOSS, plain_scenario

from railjoule.core import ScenarioError, solve
from railjoule.core.check import check_run
from railjoule.core.strategies import compare
from railjoule.core.strategies.arrival_windows import arrival_windows, require_windows
from railjoule.core.strategies.line_parts import inner_stations
from railjoule.core.studies.whole_line import whole_line
from railjoule.core.task import prepare_task

SECTIONS = [
    {"length_m": 900.0},
    {"length_m": 700.0, "gradient_permille": 12.0},
    {"length_m": 1200.0, "gradient_permille": -6.0},
    {"length_m": 900.0},
]
PLACES_M = (800.0, 1700.0, 2900.0)


def with_windows(*windows, **changes):
    """Return a hilly line of four legs, with an earliest and a latest arrival or None at each station."""
    stations = []
    for place, (low, high) in zip(PLACES_M, windows, strict=True):
        station = {"position_m": place, "dwell_s": 20.0, "name": f"{place:.0f}"}
        if low is not None:
            station["earliest_arrival_s"] = low
        if high is not None:
            station["latest_arrival_s"] = high
        stations.append(station)
    return plain_scenario(
        {"line.sections": SECTIONS, "line.stations": stations, "timetable.travel_time_s": 420.0, **changes}
    )


FREE = ((None, None),) * 3


def arrivals_of(line):
    return [leg.arrival_s for leg in line.legs[:-1]]


def best_by_search(windows):
    """Return the least energy over all arrivals within windows, by searches that know energies alone."""
    free = with_windows(*FREE)

    def energy(arrivals):
        try:
            return whole_line(free, arrivals_s=dict(enumerate(arrivals))).run.energy_kwh
        except ScenarioError:
            return 1e3

    bounds = [(low or 0.0, high or 420.0) for low, high in windows]
    # a start that can be driven: each leg 2 per cent slower than it could be, or later where the window says so
    start, ready = [], 0.0
    for (low, _), leg in zip(bounds, whole_line(free).legs, strict=False):
        start.append(max(ready + 1.02 * leg.shortest_time_s, low))
        ready = start[-1] + 20.0
    options = {"xatol": 1e-4, "fatol": 1e-10, "maxiter": 2000, "initial_simplex": simplex_from(start)}
    found = scipy.optimize.minimize(energy, start, method="Nelder-Mead", bounds=bounds, options=options)
    # along a bound a simplex may collapse: differences find what it left
    options = {"ftol": 1e-12, "eps": 1e-3}
    return min(found.fun, scipy.optimize.minimize(energy, found.x, method="SLSQP", bounds=bounds, options=options).fun)


def simplex_from(start):
    """Return a first simplex whose steps are seconds: those of Nelder and Mead are 5 per cent, which no leg spares."""
    return np.vstack([start, *(np.array(start) + step for step in 0.5 * np.eye(len(start)))])


@pytest.mark.parametrize(
    "windows",
    [
        ((100.0, None), (None, None), (None, None)),
        ((None, 76.0), (None, None), (None, None)),
        ((100.0, None), (None, 197.0), (None, None)),
        ((None, 78.0), (205.0, None), (None, 312.0)),
        ((95.0, 98.0), (None, None), (330.0, None)),
    ],
)
def test_no_other_arrivals_within_the_windows_need_less(windows):
    scenario = with_windows(*windows)
    line = whole_line(scenario)
    for arrival, (low, high) in zip(arrivals_of(line), windows, strict=True):
        assert (low or 0.0) - 1e-4 <= arrival <= (high or np.inf) + 1e-4
    assert line.run.energy_kwh == pytest.approx(best_by_search(windows), rel=1e-6)
    # more than the free optimum, or the windows would not have been worth a test
    assert line.run.energy_kwh > whole_line(with_windows(*FREE)).run.energy_kwh * (1 + 1e-6)


def test_windows_that_do_not_bind_change_nothing():
    free = whole_line(with_windows(*FREE))
    wide = tuple((at - 1.0, at + 1.0) for at in arrivals_of(free))
    line = whole_line(with_windows(*wide))
    assert line.run.energy_kwh == pytest.approx(free.run.energy_kwh, rel=1e-12)
    assert len({leg.price_of_time_w for leg in line.legs}) == 1


@pytest.mark.parametrize("seed", range(8))
def test_any_windows(seed):
    """Drawn around the free arrivals, at which windows bind, stop binding once another one does, and are let go."""
    rng = np.random.default_rng(seed)
    middle = np.array([82.9, 191.4, 317.1]) + rng.uniform(-9, 9, 3)
    windows = tuple(
        (round(at - width, 1), round(at + width, 1)) for at, width in zip(middle, rng.uniform(0.5, 3, 3), strict=True)
    )
    line = whole_line(with_windows(*windows))
    assert line.run.energy_kwh == pytest.approx(best_by_search(windows), rel=2e-6)


def test_the_strategy_keeps_them_and_the_check_sees_it():
    scenario = with_windows((100.0, None), (None, 197.0), (None, None))
    run = solve(scenario, check=True)
    assert run.energy_kwh == pytest.approx(whole_line(scenario).run.energy_kwh, rel=1e-9)
    assert {"windows of arrival"} <= {check.name for check in run.check.checks}
    free = solve(with_windows(*FREE))
    failed = {check.name for check in check_run(scenario, free).checks if not check.ok}
    assert failed == {"windows of arrival"}


def test_a_bound_covers_all_runs_that_keep_the_windows():
    run = solve(with_windows((100.0, None), (None, None), (None, None)))
    assert run.is_proven
    assert "keeps all limits and the windows of arrival at 800, arrives within 420.0 s" in run.bound.statement
    later = solve(with_windows((105.0, 105.0), (None, None), (None, None)))
    assert run.bound.covers(later)
    assert not run.bound.covers(solve(with_windows(*FREE)))


def test_other_strategies_say_which_windows_they_miss():
    runs, _ = compare(with_windows((100.0, None), (None, None), (None, None), **{"vehicle.drive": COPPER_LOSS}))
    notes = {run.strategy: " ".join(run.notes) for run in runs}
    assert "was to arrive" not in notes["optimal"]
    assert "It arrives at 800 after" in notes["bellman"]
    assert "was to arrive no earlier than 100.0 s" in notes["bellman"]


@pytest.mark.parametrize(
    ("windows", "words"),
    [
        (((None, 40.0), (None, None), (None, None)), r"arrival at 800 must be no later than 40\.0 s, and is possible"),
        (
            ((120.0, None), (None, 190.0), (None, None)),
            r"arrival at 1700 must be no later than 190\.0 s.*with the windows of arrival before it",
        ),
        (((None, None), (None, None), (390.0, None)), r"arrival at the end must be no later than 420\.0 s"),
    ],
)
def test_the_first_window_that_fails_is_named(windows, words):
    with pytest.raises(ScenarioError, match=words):
        solve(with_windows(*windows))


def test_windows_whose_ends_are_crossed():
    with pytest.raises(ScenarioError, match="latest_arrival_s = 90 lies before earliest_arrival_s = 100"):
        with_windows((100.0, 90.0), (None, None), (None, None))


def test_windows_are_kept_in_a_reversed_line():
    scenario = with_windows((None, None), (None, None), (100.0, None)).with_(**{"line.reverse": True})
    task = prepare_task(scenario)
    assert arrival_windows(task) == {0: (100.0, np.inf)}
    assert [station.name for station in inner_stations(task)] == ["2900", "1700", "800"]
    require_windows(task, arrival_windows(task))
    assert whole_line(scenario).legs[0].arrival_s == pytest.approx(100.0, abs=1e-4)


def test_a_given_timetable_beside_the_optimum():
    stations = [
        {"position_m": place, "dwell_s": 20.0, "arrival_s": at}
        for place, at in zip(PLACES_M, (85.0, 190.0, 320.0), strict=True)
    ]
    scenario = with_windows(*FREE).with_(**{"line.stations": stations})
    given, best = whole_line(scenario, "given"), whole_line(scenario)
    assert arrivals_of(given) == pytest.approx([85.0, 190.0, 320.0], abs=1e-4)
    assert given.run.energy_kwh > best.run.energy_kwh
    # each leg has a price of its own, the optimum one for all
    assert len({round(leg.price_of_time_w, 3) for leg in given.legs}) == 4
    with pytest.raises(ScenarioError, match="there is no timetable to compare with"):
        whole_line(with_windows(*FREE), "given")
