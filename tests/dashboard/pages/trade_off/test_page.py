"""The page Trade-off without a browser: what it asks for, and what its figures and table show."""

from typing import Any

import numpy as np
import pytest

from railjoule.core import load_scenario, solve
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.app import Session
from railjoule.dashboard.charts.names import AROUND_PX
from railjoule.dashboard.keep.link import read_link, write_link
from railjoule.dashboard.keep.snapshot import lay, originals_of, snapshot_of
from railjoule.dashboard.pages.trade_off.page import ENOC_SCENARIO, TradeOffPage
from railjoule.dashboard.work.runs import RunsRequest, compute_runs
from railjoule.dashboard.workbench import Workbench


@pytest.fixture(scope="module")
def session() -> Session:
    """A page turned to Trade-off; all work is done in the test's own turn."""
    session = Session()
    session.state.page = "Trade-off"
    return session


@pytest.fixture
def page(session: Session) -> TradeOffPage:
    found = session.state.pages["Trade-off"]
    assert isinstance(found, TradeOffPage)
    return found


def frontier(page: TradeOffPage) -> Any:
    return page.host.plots["frontier"]


def drawn(page: TradeOffPage, source: str) -> list[tuple[float, float]]:
    data = frontier(page).sources[source].data
    return list(zip(data["x"], data["y"], strict=True))


def test_strategies_stand_beside_the_frontier_of_a_line_with_limits(session: Session, page: TradeOffPage) -> None:
    state = session.state
    state.ticked = ["optimal", "phases", "speed_limits", "fastest"]
    runs = state.runs.runs
    shown = drawn(page, "runs")
    assert shown == [(runs[n].travel_time_s, runs[n].energy_kwh) for n in runs if n != "optimal"]
    assert len(shown) == 3
    # the frontier is the minimum: no run lies below it
    for time, energy in shown:
        least = page.trade_off.frontier.energy_kwh_at(time)
        assert np.isnan(least) or energy >= least * (1 - 1e-4)
    table = page.table.object
    for name in ("Four phases", "Set speeds", "Fastest"):
        assert name in table
    assert "1.7 s late" in table
    assert "+8.1" in table


def test_a_minute_more_saves_what_its_optimum_needs_less(session: Session, page: TradeOffPage) -> None:
    best = session.state.runs.best
    longer = solve(best.scenario.replace(**{"timetable.travel_time_s": 230.0}))
    *_, energy, _, _, each = page.times.object.split("<td>+60<")[1].split("<tr")[0].split("<td>")
    # the frontier's mesh is coarser than that of a run
    assert float(energy) == pytest.approx(longer.energy_kwh, rel=2e-3)
    assert float(each.split("<")[0]) == pytest.approx((best.energy_kwh - longer.energy_kwh) / 0.06, abs=1)
    # 36.4 s less than now is the shortest time
    assert "\u221230<" in page.times.object
    assert "\u221260<" not in page.times.object


def test_no_curve_and_no_run_is_cut(session: Session, page: TradeOffPage) -> None:
    chart = frontier(page)
    for x, y in (*drawn(page, "optimal"), *drawn(page, "runs"), *drawn(page, "point")):
        assert chart.y_range.start < y < chart.y_range.end
        assert chart.x_range.start < x < chart.x_range.end


def test_names_of_points_keep_close_to_them(session: Session, page: TradeOffPage) -> None:
    chart = frontier(page)
    data = chart.sources["names"].data
    now = session.state.runs.best.travel_time_s
    placed = dict(zip(data["line"], zip(data["x"], data["y"], data["dx"], data["text"], strict=True), strict=True))
    x, y, dx, text = placed["now"]
    # the browser writes the name so many pixels beside the point itself, however wide the figure turns out to be
    assert x == pytest.approx(now)
    assert abs(dx) < 0.5 * 14 * len(text) + max(AROUND_PX)
    assert abs(float(np.diff(chart.frame_now.y_px(np.array([y, drawn(page, "point")[0][1]])))[0])) < 60
    assert {"Four phases", "Set speeds", "Fastest"} & set(data["text"])


def test_a_click_sets_the_travel_time(session: Session, page: TradeOffPage) -> None:
    before = session.state.scenario.travel_time_s
    trade_off = page.trade_off
    frontier(page).on_time(180.0)
    assert session.state.runs.scenario.travel_time_s == 180.0
    # the frontier is that of all times
    assert page.trade_off is trade_off
    session.state.scenario.travel_time_s = before


def test_one_press_opens_a_scenario_with_enoc_and_undo_returns(session: Session, page: TradeOffPage) -> None:
    assert page.invitation.visible
    assert not page.enoc.visible
    assert "ENOC needs a line without limits." in page.refused.object
    button = page.invitation[1]
    assert button.label == f"Open {load_scenario(ENOC_SCENARIO).title}"
    button.clicks += 1
    assert session.state.scenario.preset == ENOC_SCENARIO
    assert page.enoc.visible
    assert not page.invitation.visible
    session.keeping.note()
    session.keeping.undo()
    assert session.state.scenario.preset == "metro-with-limit"
    assert page.invitation.visible


def test_the_acceleration_time_is_the_best_until_it_is_set(session: Session, page: TradeOffPage) -> None:
    state = session.state
    state.scenario.choose(ENOC_SCENARIO)
    assert page.ramp.suggested == pytest.approx(31.0, abs=0.05)
    assert not page.best_ramp.visible
    trade_off = page.trade_off
    state.scenario.acceleration_time_s = 62.7
    assert page.trade_off is trade_off
    assert "ENOC, ramp as set" in page.table.object
    assert page.best_ramp.label == "Best for 300.0 s: 31.0 s"
    page.best_ramp.clicks += 1
    assert state.scenario.acceleration_time_s is None
    assert "ENOC, ramp as set" not in page.table.object
    assert "ENOC as printed" in page.table.object


def test_the_map_is_one_picture_over_the_range_that_is_chosen(session: Session, page: TradeOffPage) -> None:
    session.state.scenario.choose(ENOC_SCENARIO)
    surface, contour = (page.host.plots[name] for name in ("surface", "contour"))
    assert (surface.host.visible, contour.host.visible) == (True, False)
    near = page.trade_off.enoc_map
    page.map.value = (True, 1.0)
    assert page.trade_off.enoc_map.travel_time_s[-1] == 5000.0 > near.travel_time_s[-1]
    page.map_view = "contours"
    assert (surface.host.visible, contour.host.visible) == (False, True)
    assert contour.x_range.end == 5000.0
    energies = page.trade_off.enoc_map.energy_kwh
    # the mouse and the saved table read what the bands show
    assert contour.sources["map"].data["image"][0] == pytest.approx(energies, rel=1e-6, nan_ok=True)
    levels = [float(text) for text in contour.scale.major_label_overrides.values()]
    assert np.nanmin(energies) < levels[0] < levels[-1] < np.nanmax(energies)
    assert contour.scale.color_mapper.high == len(levels) + 1 == len(contour.scale.color_mapper.palette)
    page.param.update(wide_map=False, map_view="surface")
    assert page.map.value == (False, 1.0)


def test_another_scenario_with_the_same_values_has_its_own_frontier() -> None:
    session = Session()
    session.state.page = "Trade-off"
    state, page = session.state, session.state.pages["Trade-off"]
    before = page.trade_off
    state.scenario.open(format_scenario(state.scenario.base.replace(title="Mine")), "mine.toml")
    assert page.trade_off.scenario.title == "Mine"
    assert page.trade_off is not before


def test_old_links_name_the_map_as_before() -> None:
    state = Workbench()
    assert lay(state, read_link("?v=1&page=Trade-off&wide_map=true&copper_weight=3.087").snapshot) == ()
    page = state.pages["Trade-off"]
    assert (page.wide_map, page.copper_weight) == (True, 3.087)
    snapshot = snapshot_of(state)
    link = write_link(snapshot, originals_of(snapshot))
    assert "trade_off.wide_map=true" in link
    assert read_link(link).snapshot["trade_off.copper_weight"] == 3.087
    for both in ("?v=1&wide_map=true&trade_off.wide_map=false", "?v=1&trade_off.wide_map=false&wide_map=true"):
        assert read_link(both).snapshot == {"trade_off.wide_map": False}
    assert "copper_weight = none must be a number" in read_link("?v=1&copper_weight=none").refusal


def test_a_run_that_is_not_the_optimum_leads_where_the_optimum_fails(page: TradeOffPage, session: Session) -> None:
    """The frontier's point is the best run, whichever strategy it is of."""
    session.state.scenario.choose("metro-with-limit")
    runs = compute_runs(RunsRequest(session.state.scenario.scenario(), ("fastest", "phases")))
    session.state.runs = runs
    assert drawn(page, "point") == [(runs.best.travel_time_s, runs.best.energy_kwh)]
