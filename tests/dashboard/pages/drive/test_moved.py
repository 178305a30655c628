"""A moved instruction on Drive: by the field and by the line that is dragged, over distance and over time."""

import re

import numpy as np
import pytest

from railjoule.dashboard.browser import Browser
from railjoule.dashboard.keep.pins import run_again
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.state.pins import KeptPin
from railjoule.dashboard.work.runs import RunsRequest, compute_runs
from railjoule.dashboard.workbench import Workbench

COAST = 5
"""The phase of coasting after the limit of the first scenario."""


class Desk:
    """A page turned to Drive with the runs of its scenario."""

    def __init__(self) -> None:
        self.state = Workbench()
        PageWorks(self.state.pages["Drive"])
        self.host = PageHost(self.state.pages["Drive"], Browser(), Palette(dark=False))
        self.page, self.speed = self.state.pages["Drive"], self.host.plots["speed"]
        self.state.page = "Drive"
        self.run()

    def run(self) -> None:
        self.state.runs = compute_runs(RunsRequest(self.state.scenario.scenario(), self.state.drawn))

    @property
    def text(self) -> str:
        return " ".join(re.sub(r"<[^>]+>", " ", self.page.moved_text.object).split())


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_a_typed_place_costs_the_energy_of_the_sentence(desk: Desk) -> None:
    assert not desk.page.moved_field.visible
    assert set(desk.page.mover_menu.options) == {"None", "2 coast", "3 brake", "6 coast", "7 brake"}
    desk.page.moved_phase = COAST
    start = desk.state.run.phases[COAST].start_m
    assert desk.page.moved_to_m == start
    assert desk.speed.switch.visible
    assert desk.speed.switch.location == start
    desk.page.moved_to_m = 1000.0
    more = 100 * (desk.page.moved.found.energy_kwh / desk.state.run.energy_kwh - 1)
    assert desk.text == f"Coasting from 1 000 m instead of 970 m: +{more:.2f} %, same arrival."
    # the run is drawn beside the optimum
    assert len(desk.speed.sources["variant"].data["x"]) == len(desk.page.moved.found.position_m)
    desk.page.pin_moved.clicks += 1
    (pin,) = desk.state.pins
    assert pin.trajectory.energy_kwh == desk.page.moved.found.energy_kwh
    assert pin.name.startswith("Moved to 1\u202f000 m, Optimal, 170.0 s")
    assert desk.state.pin_of_run is None
    # a link has it, and its run is the same again
    (again,) = run_again((KeptPin.of(pin),))
    assert again.trajectory.energy_kwh == pytest.approx(pin.trajectory.energy_kwh, rel=1e-9)
    assert again.recipe == pin.recipe
    desk.page.moved_phase = -1
    assert not desk.page.pin_moved.visible
    assert not desk.speed.switch.visible
    assert not len(desk.speed.sources["variant"].data["x"])


def test_the_line_is_dragged_over_distance_and_over_time(desk: Desk) -> None:
    desk.page.moved_phase = COAST
    desk.speed.switch.location = 985.0
    assert desk.page.moved_to_m == 985.0
    assert desk.text.startswith("Coasting from 985 m instead of 970 m: +")
    desk.state.over_time = True
    run = desk.state.run
    assert desk.speed.switch.location == pytest.approx(np.interp(985.0, run.position_m, run.time_s))
    desk.speed.switch.location = float(np.interp(1000.0, run.position_m, run.time_s))
    assert desk.page.moved_to_m == pytest.approx(1000.0)


def test_a_place_that_cannot_be_is_refused_in_a_sentence(desk: Desk) -> None:
    desk.page.moved_phase = COAST
    desk.page.moved_to_m = 800.0
    assert desk.text == "Coasting can begin between 901 m and 2198 m here, not at 800 m."
    assert desk.page.failure is None


def test_the_plan_of_an_actual_run_has_no_instructions_to_move(desk: Desk) -> None:
    desk.page.moved_phase = COAST
    desk.state.day.on = True
    assert not desk.page.mover.visible
    assert desk.page.moved is None
    assert not desk.speed.switch.visible


def test_another_strategy_has_no_instructions_to_move(desk: Desk) -> None:
    desk.page.moved_phase = COAST
    desk.state.chosen = "fastest"
    assert not desk.page.mover.visible
    assert desk.page.moved is None
