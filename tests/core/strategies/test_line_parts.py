"""The optimum under windows of arrival, against a search over all arrivals that knows none of its rules."""

import numpy as np
import pytest
from builders import COPPER_LOSS, plain_scenario

from railjoule.core import ScenarioError, solve
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


def test_windows_that_do_not_bind_change_nothing():
    free = whole_line(with_windows(*FREE))
    line = whole_line(with_windows(*tuple((at - 1.0, at + 1.0) for at in arrivals_of(free))))
    assert line.run.energy_kwh == pytest.approx(free.run.energy_kwh, rel=1e-12)
    assert len({leg.price_of_time_w for leg in line.legs}) == 1


def test_a_bound_covers_all_runs_that_keep_the_windows():
    run = solve(with_windows((100.0, None), (None, None), (None, None)))
    # over the mesh of the scenario, 10 m
    assert 0 <= run.gap < 1e-3
    assert "No way of driving this train over this line within 420.0 s" in run.bound.statement
    assert [window[:2] for window in run.bound.windows] == [(800.0, 100.0)]
    assert run.bound.covers(solve(with_windows((105.0, 105.0), (None, None), (None, None))))
    assert not run.bound.covers(solve(with_windows(*FREE)))


def test_other_strategies_say_which_windows_they_miss():
    runs = compare(with_windows((100.0, None), (None, None), (None, None), **{"vehicle.drive": COPPER_LOSS})).runs
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
    scenario = with_windows((None, None), (None, None), (100.0, None)).replace(**{"line.reverse": True})
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
    scenario = with_windows(*FREE).replace(**{"line.stations": stations})
    given, best = whole_line(scenario, "given"), whole_line(scenario)
    assert arrivals_of(given) == pytest.approx([85.0, 190.0, 320.0], abs=1e-4)
    assert given.run.energy_kwh > best.run.energy_kwh
    # each leg has a price of its own, the optimum one for all
    assert len({round(leg.price_of_time_w, 3) for leg in given.legs}) == 4
    with pytest.raises(ScenarioError, match="there is no timetable to compare with"):
        whole_line(with_windows(*FREE), "given")
