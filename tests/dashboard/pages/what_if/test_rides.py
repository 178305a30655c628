from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from railjoule.core import Scenario, load_scenario
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.charts.axis import Axis
from railjoule.dashboard.day import Day
from railjoule.dashboard.look import words
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.pages.what_if.compute import compute_late_arrivals, compute_rides
from railjoule.dashboard.pages.what_if.events import drawn
from railjoule.dashboard.pages.what_if.rides import LATE, SPEEDS, late_curves, late_ends, saved_by
from railjoule.dashboard.state.scenario import ScenarioModel
from railjoule.dashboard.workbench import Workbench


def tram_stop() -> Day:
    scenario = ScenarioModel()
    scenario.choose("tram-950m-stop")
    return Day(scenario)


@pytest.fixture(scope="module")
def asked() -> tuple[Scenario, Mapping[str, Any]]:
    model = tram_stop()
    return load_scenario("tram-950m-stop"), model.event_tables


def test_a_press_drops_an_event_on_the_distance_alone(asked: tuple[Scenario, Mapping[str, Any]]) -> None:
    dropped: list[float] = []
    palette = Palette(dark=False)
    chart = SPEEDS.made(Axis(palette), palette)
    chart.press = dropped.append
    chart.axis.fit(950.0, roomy=False)
    chart.build()
    model = tram_stop()
    runs = drawn(compute_rides(*asked))

    class Press:
        x, y = 512.3, 20.0

    chart.draw(runs, model.events, over_time=False)
    assert list(chart.sources["events"].data["text"]) == ["stop 5 s"]
    # as the lines are named
    names = {"undisturbed", "driver", "replanned", "with advance notice"}
    assert {one[0] for one in chart.cursor_data["sources"]} == names == set(chart.sources["names"].data["text"])
    chart._press(Press)
    chart.draw(runs, model.events, over_time=True)
    assert list(chart.sources["events"].data["text"]) == []
    chart._press(Press)
    assert dropped == [512.3]


def test_the_table_has_the_energies_of_the_rides() -> None:
    state = Workbench()
    PageWorks(state.pages["What if"])
    state.scenario.choose("tram-950m-stop")
    state.pages["What if"].tab = "events"
    state.page = "What if"
    view = PageHost(state.pages["What if"], Browser(), Palette(dark=False))
    rides = {name: ride.actual.energy_kwh for name, ride in state.pages["What if"].rides.rides.items()}
    # 2.264 and 2.195 kWh with the tram of findings.md; the shipped one differs by half a per cent
    assert [rides["driver"], rides["computer"]] == pytest.approx([2.264, 2.195], rel=0.01)
    for name, word in words.REACTION_WORDS.items():
        assert f"<td>{word}<td>{words.energy(rides[name])}<td>" in view.of.reactions.object


def test_later_arrivals_save_and_the_price_falls(asked: tuple[Scenario, Mapping[str, Any]]) -> None:
    *_, late = compute_late_arrivals(*asked)
    curves = late_curves(late, compute_rides(*asked))
    ends = late_ends(curves)
    chart = LATE.made(Axis(Palette(dark=False)), Palette(dark=False))
    chart.build()
    chart.draw(curves, x_ends=ends[0], y_ends=ends[1])
    assert len(chart.sources["present"].data["x"]) == 3
    assert np.all(np.diff(np.asarray(chart.sources["driver"].data["y"])) < 0)
    # 2.264 on time and 2.127 two seconds late (findings on Rawicki): about 70 Wh a second
    assert 55 < float(saved_by(late, "driver")) < 80


def test_a_second_is_priced_from_the_smallest_delay_on() -> None:
    """Of a driver who is 18.1 s late whatever less is accepted; the column was empty."""
    late = np.array([[18.1, 18.1, 20.1, 30.0], [22.0, 22.0, 18.0, 14.0]])
    assert saved_by({"driver": late}, "driver") == words.price(4.0 / 2.0 * 3.6e6)
    assert saved_by({"driver": late[:, :2]}, "driver") == "\u2013"
