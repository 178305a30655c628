"""The lesson that is driven: its try and its optimum are pinned where Drive opens."""

import pytest

from railjoule.core import ScenarioError, load_scenario
from railjoule.core.motion import build_meshed_line
from railjoule.core.simulation.manual import require_drivable
from railjoule.dashboard.keep.pins import run_again
from railjoule.dashboard.pages.learn.by_hand import PRESET, TryRequest, best_run, driven_run, judge
from railjoule.dashboard.pages.learn.drive_it import DriveIt
from railjoule.dashboard.state.pins import KeptPin
from railjoule.dashboard.state.workbench import Workbench

COMMANDS = "p0c300p600"


def test_the_try_and_the_optimum_are_pinned_on_drive() -> None:
    state = Workbench()
    lesson = DriveIt(state)
    state.learn.tried = judge(TryRequest(COMMANDS))
    lesson._take({"what": "open"})
    assert (state.page, state.scenario.preset) == ("Drive", PRESET)
    best, driven = state.pins
    assert best.trajectory.energy_kwh == best_run().energy_kwh
    verdict = state.learn.tried.verdict
    assert driven.trajectory.energy_kwh == verdict["kwh"]
    assert driven.name.startswith("Driven by hand, ")
    # the same try again is the same pin
    lesson._take({"what": "open"})
    assert len(state.pins) == 2


def test_a_link_runs_the_try_again() -> None:
    state = Workbench()
    state.learn.tried = judge(TryRequest(COMMANDS))
    DriveIt(state)._take({"what": "open"})
    best, driven = run_again(tuple(KeptPin.of(pin) for pin in state.pins))
    assert best.trajectory.energy_kwh == pytest.approx(best_run().energy_kwh)
    assert driven.trajectory.energy_kwh == driven_run(COMMANDS).energy_kwh


def test_without_a_try_only_the_scenario_is_opened() -> None:
    state = Workbench()
    DriveIt(state)._take({"what": "open"})
    assert (state.page, state.pins) == ("Drive", ())


def test_stations_cannot_be_driven_by_hand() -> None:
    with pytest.raises(ScenarioError, match="without stops on the way"):
        require_drivable(build_meshed_line(load_scenario("metro-10-stations")))
