"""The page Compare without a browser: what it asks for, its answer, its table and its figures."""

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from bokeh.document import Document
from lines import sent
from markup import plain
from panel.io.state import set_curdoc

from railjoule.core.bounds import ProofStep
from railjoule.core.trajectory import Bound
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.app import Session
from railjoule.dashboard.keep.link import read_link
from railjoule.dashboard.keep.snapshot import lay
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.pages.compare.page import REST_MS, Compare
from railjoule.dashboard.shell.strategies import strategy_numbers
from railjoule.dashboard.work.runs import Proven
from railjoule.dashboard.workbench import Workbench

PAGE = "Compare"


@pytest.fixture(scope="module")
def session() -> Session:
    """A page with one pinned run, turned to Compare."""
    session = Session()
    session.state.pin()
    session.state.page = PAGE
    return session


@pytest.fixture
def page(session: Session) -> Iterator[Compare]:
    """The page; what a test changes is put back."""
    found = session.state.pages[PAGE]
    assert isinstance(found, Compare)
    yield found
    found.param.update(reference="", compare_all=True)
    session.state.over_time = False
    session.state.scenario.restore()


def caption(chart: Any) -> str:
    above, _ = chart.content.object.children
    return str(above.text)


def rows(page: Compare) -> dict[str, list[str]]:
    """Return the cells of the table by the names of the runs."""
    cells = [[plain(cell) for cell in row.split("<td>")[1:]] for row in page.table.object.split("<tr")[2:]]
    return {name: rest for name, *rest in cells}


def test_all_strategies_are_run_only_while_the_page_is_in_sight(session: Session, page: Compare) -> None:
    state = session.state
    assert list(page.compared.runs) == ["optimal", "linear_reserve", "fastest", "phases", "bellman", "speed_limits"]
    assert set(page.compared.refused) == {"eoc", "enoc"}
    before = page.compared
    state.page = "Drive"
    state.scenario.load_percent = 60.0
    assert page.compared is before
    state.page = PAGE
    assert page.compared.scenario.vehicle.load_factor == 0.6


def test_a_slider_that_moves_begins_no_study(session: Session, page: Compare) -> None:
    timers: list[tuple[int, Callable[[], None]]] = []
    before = page.compared
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(PageWorks, "after", lambda _, milliseconds, act: timers.append((milliseconds, act)))
        for load in (61.0, 62.0, 63.0):
            session.state.scenario.load_percent = load
        assert [milliseconds for milliseconds, _ in timers] == [REST_MS] * 3
        (_, first), (_, second), (_, third) = timers
        assert page.comparing
        assert "2 of 2 others under way" in plain(page.host.figures.object)
        first()
        second()
        assert page.compared is before
        session.state.page = "Help"
        third()
        assert page.compared is before
        # a page that returns asks again
        session.state.page = PAGE
        *_, (_, last) = timers
        last()
    assert not page.comparing
    assert page.compared.scenario.vehicle.load_factor == pytest.approx(0.63)


def test_a_page_that_leaves_sight_keeps_its_runs(session: Session, page: Compare) -> None:
    before = page.compared
    work = next(work for work in session.works if work.of.page == PAGE)
    study = work.jobs["compared"]
    with set_curdoc(Document()):
        study.ask(page._compared())
        assert study.busy
        session.state.page = "Help"
    assert not study.busy
    assert page.compared is before
    # it begins again
    session.state.page = PAGE
    assert page.compared is not before
    assert list(page.compared.runs) == list(before.runs)


def test_the_answer_is_the_cheapest_strategy_on_time(session: Session, page: Compare) -> None:
    answer = plain(page.host.figures.object)
    assert answer.startswith("Least energy in 170.0 s: Optimal")
    assert "7.81 kWh \u2713 proven" in answer
    # Bellman reads the same as the optimum, and Set speeds, which would be the next one, are late
    assert "Next best +8.1 % Four phases, 8.45 kWh" in answer
    assert "Strategies on time 5 of 6 Set speeds 1.7 s late" in answer
    page.reference = "phases"
    assert "7.81 kWh 7.5 % below Four phases" in plain(page.host.figures.object)
    page.reference = "speed_limits"
    assert "7.81 kWh 4.7 % below Set speeds, 1.7 s late" in plain(page.host.figures.object)
    page.reference = "pin_1"
    assert "another scenario" not in plain(page.host.figures.object)
    session.state.scenario.load_percent = 0.0
    # the pinned train is heavier, and what it costs is no merit of the strategy
    assert re.search(r"% below 1 Optimal, .* of another scenario", plain(page.host.figures.object))


def test_percentages_are_those_of_the_sidebar(session: Session, page: Compare) -> None:
    table = rows(page)
    session.state.ticked = ["optimal", "bellman", "phases", "speed_limits", "fastest"]
    for name, label in (("phases", "Four phases"), ("speed_limits", "Set speeds"), ("fastest", "Fastest")):
        shown = plain(strategy_numbers(session.state.runs, name))
        energy, _, percent, *_ = table[label]
        assert shown.removesuffix(" %") == f"{energy} {percent}"
    session.state.ticked = ["optimal", "fastest"]


def test_the_table_and_the_words_follow_the_scenario(session: Session, page: Compare) -> None:
    session.state.scenario.load_percent = 60.0
    table = plain(page.table.object)
    assert "Bellman" in table
    assert "1 Optimal, 170.0 s, load 50 %, recuperation 40 %" in table
    assert "EOC, ENOC: needs a line without limits." in table
    page.menu.value = "phases"
    assert page.reference == "phases"
    assert "load 50 % instead of 60 %" in plain(page.differences.object)
    page.compare_all = False
    assert "Bellman" not in plain(page.table.object)


def test_a_greater_bound_reaches_the_runs_of_all_strategies(session: Session, page: Compare) -> None:
    state = session.state
    before = page.compared
    bound = state.runs.best.bound
    assert isinstance(bound, Bound)
    greater = replace(bound, energy_j=bound.energy_j * (1 + 1e-9))
    step = ProofStep(greater, 1, 1, reached=False, exhausted=False)
    state.proof.remember(Proven(state.runs.scenario, greater, step))
    state.take_bound(state.runs.scenario, greater)
    assert page.compared is before
    assert next(one.run for one in page.among if one.key == "bellman").bound.energy_j == greater.energy_j


def test_the_fastest_run_does_not_press_the_energies_of_others_together(session: Session, page: Compare) -> None:
    chart = page.host.plots["compared_energy"]
    runs = session.state.runs.runs
    most = max(run.supply_energy_j.max() / J_PER_KWH for name, run in runs.items() if name != "fastest")
    assert most < chart.y_range.end < 1.5 * most
    assert len(sent(chart, "fastest")[0]) == 0
    assert caption(chart) == "Energy from the supply, kWh; off the scale: Linear reserve, Fastest"
    page.reference = "fastest"
    assert len(sent(chart, "fastest")[0]) > 0
    assert caption(chart) == "Energy from the supply, kWh"


def test_instructions_are_those_of_the_advice(session: Session, page: Compare) -> None:
    table = rows(page)
    # full power, coast, brake for the limit, hold it, full power, coast, brake
    assert table["Optimal"][5] == "7"
    # full power, hold the limit, brake, hold the lower one, full power, hold the limit, brake
    assert table["Fastest"][5] == "7"


def test_differences_are_those_to_the_reference(session: Session, page: Compare) -> None:
    chart = page.host.plots["compared_difference"]
    assert len(sent(chart, "optimal")[0]) == 0
    runs = page.compared.runs
    _, phases = sent(chart, "phases")
    assert phases[-1] == pytest.approx(runs["phases"].energy_kwh - runs["optimal"].energy_kwh, abs=1e-4)


def test_limits_are_drawn_over_distance_only(session: Session, page: Compare) -> None:
    chart = page.host.plots["compared_speed"]
    assert np.max(chart.sources["limit"].data["y"]) == 80.0
    session.state.over_time = True
    assert len(chart.sources["limit"].data["x"]) == 0
    assert chart.axis.end == pytest.approx(max(one.run.travel_time_s for one in page.among))


def test_pins_are_renamed_and_removed(session: Session, page: Compare) -> None:
    (row,) = page.rows.values()
    first = row.name.value
    assert list(page.pin_rows) == [row.view]
    row.name.value = "mine"
    assert session.state.pins[0].name == "mine"
    assert "1 mine" in plain(page.table.object)
    row.name.value = ""
    assert row.name.value == session.state.pins[0].name == first
    pins = session.state.pins
    row.remove.clicks += 1
    assert session.state.pins == ()
    assert list(page.pin_rows) == []
    session.state.pins = pins


def test_a_pinned_run_of_little_energy_hides_no_strategy(session: Session, page: Compare) -> None:
    """The scale is that of the reference; efforts of all runs share one."""
    session.state.scenario.travel_time_s = 250.0
    session.state.pin()
    session.state.scenario.restore()
    assert caption(page.host.plots["compared_energy"]).endswith("; off the scale: Linear reserve, Fastest")
    assert len(sent(page.host.plots["compared_energy"], "pin_2")[0]) > 0
    assert len(sent(page.host.plots["compared_effort"], "fastest")[0]) > 0
    session.state.unpin(session.state.pins[-1])


def test_old_links_name_reference_and_runs_as_before() -> None:
    state = Workbench()
    assert lay(state, read_link("?v=1&compare_all=false&reference=fastest").snapshot) == ()
    page = state.pages[PAGE]
    assert (page.compare_all, page.reference) == (False, "fastest")
