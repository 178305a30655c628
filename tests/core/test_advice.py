"""The phases of a run as instructions with printed numbers."""

from types import SimpleNamespace

import numpy as np
import pytest
from pieces import INERTIA_KG, LARGEST_N, run_of

from railjoule.core import load_scenario, solve
from railjoule.core.advice import Instruction, advise, brake_place_m
from railjoule.core.phases import find_phases


def advice_of(*pieces, **fields):
    run = run_of(*pieces, **fields)
    return advise(SimpleNamespace(run_data=run, phases=find_phases(run)))


def test_the_advice_of_the_first_scenario():
    """The optimum brakes from 595 m to its limit of 50 km/h at 600 m and from 2198.6 m, in both with all it has."""
    assert solve(load_scenario("metro-with-limit")).advice == (
        Instruction("full_power", 0, 36.9),
        Instruction("coast", 43),
        Instruction("brake", 593, 50, 600, fully=True),
        Instruction("hold", 600, 50),
        Instruction("full_power", 900, 63.3),
        Instruction("coast", 970),
        Instruction("brake", 2196, 0, 2300, fully=True),
    )


def test_speeds_are_in_tenths_and_places_in_metres():
    pieces = ((100.3, 15.02, 1.0), (400.3, 15.02, 0.1), (300.3, 12, 0.0), (100.3, 6.0, -0.4), (200.0, 6.0, 0.1))
    told = advice_of(*pieces, start_ms=5.0, cell_m=100.1)
    assert [(one.action, one.from_m, one.to_kmh, one.at_m) for one in told] == [
        ("full_power", 0, 54.1, None),
        ("hold", 100, 54.1, None),
        ("coast", 501, None, None),
        ("brake", 800, 21.6, 901),
        ("hold", 901, 21.6, None),
    ]
    assert not told[3].fully


def test_power_begins_no_earlier_and_brakes_end_no_later_than_in_the_run():
    """A limit may end where power begins, and begin where a brake ends."""
    told = advice_of((300.4, 20, 0.1), (100.2, 15, -0.4), (300.2, 15, 0.1), (100, 20, 0.9), start_ms=20.0, cell_m=50.1)
    assert [(one.action, one.from_m, one.at_m) for one in told] == [
        ("hold", 0, None),
        ("brake", 300, 400),
        ("hold", 401, None),
        ("part_power", 701, pytest.approx(800.8)),
    ]


def test_stands_and_stops_have_their_own_places():
    told = advice_of((300.4, 0, -0.4), (0, 0, 0), (200.4, 15, 1.0), (300, 14, 0.0), start_ms=15.0, cell_m=50.1)
    assert [(one.action, one.from_m, one.at_m, one.stand_s) for one in told] == [
        ("brake", 0, 300.4, None),
        ("stand", 300.4, None, 30),
        ("full_power", 300.4, None, None),
        ("coast", 501, None, None),
    ]


def test_coasting_that_ends_at_a_stop_tells_so():
    told = advice_of((300, 15, 1.0), (500, 0, 0.0), (0, 0, 0), (300, 15, 1.0), start_ms=5.0)
    assert told[1] == Instruction("coast", 300, 0, 800)


@pytest.mark.parametrize(("limit_kmh", "between"), [(80.0, (43.5, 45.5)), (45.0, (43.0, 45.0))])
def test_a_hold_by_turns_swings_one_kmh_to_each_side_and_below_the_limit(limit_kmh, between):
    """Between 12.2 and 12.5 m/s, 44.5 km/h on average."""
    saw = ((60, 12.2, 0.0), (20, 12.5, 0.5)) * 10
    hold = advice_of((200, 12.5, 1.0), *saw, (500, 10, 0.0), start_ms=5.0, limit_ms=limit_kmh / 3.6)[1]
    assert (hold.action, hold.power_share, hold.to_kmh) == ("hold", 0.5, 44.5)
    assert hold.between_kmh == between


def test_a_brake_has_a_reserve_for_a_faster_train():
    """From 20 m/s, 2 m/s2 stop in 100 m. 0.5 km/h more takes (2 x 20 x 0.139 + 0.139^2) / 4 m more."""
    run = run_of((300, 20, 0.0), (100, 0, -2.0), start_ms=20.0, max_braking_n=np.full(40, 2 * LARGEST_N))
    assert brake_place_m(run, (300, 20), (400, 0), 0.0) == pytest.approx(300)
    faster = 0.5 / 3.6
    place = 300 - (2 * 20 * faster + faster**2) / (2 * 2 * LARGEST_N / INERTIA_KG)
    assert brake_place_m(run, (300, 20), (400, 0), faster) == pytest.approx(place)
    told = advise(SimpleNamespace(run_data=run, phases=find_phases(run)))
    assert told[1] == Instruction("brake", 298, 0, 400, fully=True)


def test_a_gentle_brake_is_its_own_reserve():
    """Half of the brakes stop a train that comes 41 % faster."""
    run = run_of((300, 20, 0.0), (200, 0, -1.0), start_ms=20.0, max_braking_n=np.full(50, 2 * LARGEST_N))
    assert brake_place_m(run, (300, 20), (500, 0), 0.5 / 3.6) == 300
    assert brake_place_m(run, (300, 20), (500, 0), 8.0) == 300
    assert brake_place_m(run, (300, 20), (500, 0), 8.5) < 300


def test_a_bound_of_deceleration_bounds_the_reserve():
    """The brakes have twice as much, the train may not use it."""
    run = run_of((300, 20, 0.0), (200, 0, -1.0), start_ms=20.0, max_braking_n=np.full(50, 2 * LARGEST_N))
    place = brake_place_m(run._replace(max_deceleration_ms2=1.0), (300, 20), (500, 0), 0.5 / 3.6)
    assert place == pytest.approx(300 - (2 * 20 * 0.5 / 3.6 + (0.5 / 3.6) ** 2) / 2)
