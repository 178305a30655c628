"""The numbers of the tab "Events"."""

from dataclasses import replace

import numpy as np
import pytest
from markup import plain
from needing import needing

from railjoule.core import load_scenario, solve
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.dashboard.pages.what_if.events import beside_driver, driver_figure


@pytest.fixture(scope="module")
def ride():
    """Makes a ride that needs so many kWh and arrives so late; the plan needs its own energy."""
    planned = solve(load_scenario("liashenko-0"))

    def made(energy_kwh: float, late_s: float) -> DisturbedRun:
        driven = needing(planned, 3.6e6 * energy_kwh)
        late = replace(driven, time_s=np.append(driven.time_s[:-1], driven.time_s[-1] + late_s))
        return DisturbedRun(planned, late, planned.travel_time_s, (), ())

    return made


def test_a_late_driver_is_shown_by_the_delay(ride) -> None:
    assert plain(driver_figure(ride(9.0, 0.0), 10.0)) == "Energy saved, driver 10.0 % 9.00 kWh, undisturbed 10.00"
    assert plain(driver_figure(ride(9.0, 12.0), 10.0)) == "Driver 12.0 s late 9.00 kWh, undisturbed 10.00"
    # neither does it cost what the undisturbed run, which is in time, needs less
    assert plain(driver_figure(ride(11.0, 12.0), 10.0)) == "Driver 12.0 s late 11.00 kWh, undisturbed 10.00"
    assert plain(driver_figure(ride(11.0, 0.0), 10.0)) == "Extra energy, driver 10.0 % 11.00 kWh, undisturbed 10.00"


def test_a_reaction_saves_only_where_it_arrives_no_later(ride) -> None:
    def figure(one: tuple[float, float], driver: tuple[float, float]) -> str:
        return plain(beside_driver(ride(*one), ride(*driver), "Replanning"))

    assert figure((9.0, 5.0), (10.0, 5.0)) == "Replanning saves 10.0 % 9.00 kWh, arrives at the same time"
    assert figure((9.0, 5.0), (10.0, 1.0)) == "Replanning needs 1.000 kWh less 9.00 kWh, arrives 4.0 s later"
    assert figure((11.0, 5.0), (10.0, 5.0)) == "Replanning costs 10.0 % more 11.00 kWh, arrives at the same time"
