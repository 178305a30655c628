import pytest

from railjoule.core import ScenarioError
from railjoule.dashboard.browser import Browser
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.page_host import PageHost
from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.workbench import Workbench


@pytest.fixture
def state() -> Workbench:
    """A workbench whose page Line is in sight; all work is done in the test's own turn."""
    state = Workbench(page="Line")
    PageWorks(state.pages["Line"])
    state.scenario.choose("metro-10-stations")
    return state


def test_a_dwell_changes_the_scenario_of_every_page(state: Workbench) -> None:
    before = state.pages["Line"].runs
    state.pages["Line"].inner_stations[1].dwell_s = 60.0
    assert state.scenario.scenario().line.stations[2].dwell_s == 60
    assert state.pages["Line"].runs.best.run.energy_kwh > before.best.run.energy_kwh
    state.scenario.take_back("line.stations")
    assert state.pages["Line"].inner_stations[1].dwell_s == 30
    assert state.pages["Line"].runs.best.run.energy_kwh == pytest.approx(before.best.run.energy_kwh, rel=1e-9)


def fix(station, arrival_s):
    station.param.update(earliest_s=arrival_s, latest_s=arrival_s)


def test_an_arrival_is_fixed_by_two_equal_times(state: Workbench) -> None:
    model = state.pages["Line"]
    free, before = model.runs.best.run.energy_kwh, model.runs.best.legs[4].arrival_s
    fix(model.inner_stations[4], round(before, 1))
    assert model.runs.best.run.energy_kwh == pytest.approx(free, rel=1e-6)
    fix(model.inner_stations[4], 510.0)
    assert model.runs.best.legs[4].arrival_s == pytest.approx(510, abs=1e-3)
    assert model.runs.best.run.energy_kwh > free
    assert state.scenario.scenario().line.stations[5].window_s == (510, 510)


def test_a_window_around_the_optimum_binds_once_it_is_moved(state: Workbench) -> None:
    model = state.pages["Line"]
    free, central = model.runs.best.run.energy_kwh, model.inner_stations[4]
    before = model.runs.best.legs[4].arrival_s
    central.param.update(earliest_s=round(before - 5, 1), latest_s=round(before + 5, 1))
    assert model.runs.best.run.energy_kwh == pytest.approx(free, rel=1e-9)
    central.earliest_s = None
    central.latest_s = before - 4.0
    assert model.runs.best.legs[4].arrival_s == pytest.approx(before - 4, abs=1e-3)
    assert model.runs.best.run.energy_kwh > free
    # a rule does not keep a window, and says so
    assert "was to arrive no later than" in " ".join(model.runs.missed["equal"])
    central.latest_s = None
    assert state.scenario.edits == {}


def test_an_arrival_that_cannot_be_kept_is_told_and_the_last_runs_stay(state: Workbench) -> None:
    model = state.pages["Line"]
    before = model.runs
    fix(model.inner_stations[4], 510.0)
    kept = model.runs
    fix(model.inner_stations[4], 100.0)
    assert isinstance(model.failure, ScenarioError)
    assert "Central" in str(model.failure)
    assert model.runs is kept
    fix(model.inner_stations[4], None)
    assert model.failure is None
    assert model.runs.best.run.energy_kwh == pytest.approx(before.best.run.energy_kwh)


def test_arrivals_that_are_taken_over_are_a_given_timetable(state: Workbench) -> None:
    model = state.pages["Line"]
    optimum, equal = model.runs.best.run.energy_kwh, model.runs.runs["equal"]
    model.take_over("equal")
    given = model.runs.runs["given"]
    # rounded to tenths
    assert [leg.arrival_s for leg in given.legs] == pytest.approx([leg.arrival_s for leg in equal.legs], abs=0.06)
    assert given.run.energy_kwh == pytest.approx(equal.run.energy_kwh, rel=1e-3)
    assert model.runs.best.run.energy_kwh == pytest.approx(optimum, rel=1e-12)
    assert (model.other, model.shown_other, model.runs.measured_by) == ("given", "given", ("given",))
    assert model.runs.pays
    model.take_over("optimum")
    assert not model.runs.pays
    model.take_over(None)
    assert "given" not in model.runs.runs
    assert model.shown_other == "proportional"
    assert state.scenario.edits == {}


def test_a_given_timetable_that_cannot_be_kept_is_no_reason_to_show_no_optimum(state: Workbench) -> None:
    state.pages["Line"].inner_stations[4].given_s = 100.0
    assert state.pages["Line"].failure is None
    assert list(state.pages["Line"].runs.runs) == ["optimum", "proportional", "equal"]
    assert "The arrival at Central after 100.0 s must be later than" in state.pages["Line"].runs.refusal


def test_a_dragged_station_changes_the_given_timetable_and_once_it_is_let_go_the_scenario(state: Workbench) -> None:
    model = state.pages["Line"]
    model.take_over("equal")
    before, market = model.runs, model.inner_stations[1]
    edits, at = state.scenario.edits, market.given_s
    model.param.update(moving=True, moved=(1, at + 3.0))
    legs, legs_before = model.shown_runs.runs["given"].legs, before.runs["given"].legs
    assert legs[1].supplement_s == pytest.approx(legs_before[1].supplement_s + 3, abs=1e-3)
    assert legs[2].supplement_s == pytest.approx(legs_before[2].supplement_s - 3, abs=1e-3)
    assert legs[3].supplement_s == pytest.approx(legs_before[3].supplement_s, abs=1e-3)
    # only the given timetable is another one, and the scenario none
    assert model.shown_runs.best is before.best
    assert state.scenario.edits == edits
    model.moving = False
    assert market.given_s == at + 3
    assert state.scenario.scenario().line.stations[2].arrival_s == at + 3
    assert model.moved is None


def test_a_drag_beyond_what_can_be_driven_is_told_meanwhile(state: Workbench) -> None:
    model = state.pages["Line"]
    model.take_over("equal")
    model.param.update(moving=True, moved=(1, 100.0))
    assert "must be later than" in model.shown_runs.refusal


def test_another_scenario_knows_nothing_of_a_drag(state: Workbench) -> None:
    state.pages["Line"].param.update(moving=True, moved=(1, 200.0))
    state.scenario.choose("tram-950m-stop")
    assert (state.pages["Line"].moving, state.pages["Line"].moved) == (False, None)
    assert state.scenario.edits == {}


def test_a_line_without_stations_has_an_example(state: Workbench) -> None:
    page = state.pages["Line"]
    PageHost(state.pages["Line"], Browser(started=True, charts_in_sight=["supplements"]), Palette(dark=False))
    assert not page.of_example.visible
    assert page.host.plots["supplements"].sources["grips"].data["name"][:2] == ["Old Town", "Market"]
    state.scenario.choose("liashenko-ii")
    assert page.failure is None
    assert page.runs.is_example
    assert page.of_example.visible
    assert not page.timetable.visible
    assert page.take_other.disabled
    assert state.scenario.edited.title in page.example.object
    assert "Example: Metro, ten stations" in page.host.heading.object
    # stations of another line cannot be dragged
    assert page.host.plots["supplements"].sources["grips"].data["name"] == []
    page.drag(1, 200.0)
    assert not page.moving
    before = page.runs
    state.scenario.load_percent += 1.0
    assert page.runs is before
    page.open.clicks += 1
    assert not page.runs.is_example
    assert page.timetable.visible
    assert not page.take_other.disabled
    assert page.runs.best.run.energy_kwh == pytest.approx(before.best.run.energy_kwh, rel=1e-9)


def test_an_edit_that_is_refused_is_shown_until_the_next_run(state: Workbench) -> None:
    page = state.pages["Line"]
    market = page.inner_stations[1]
    edits = state.scenario.edits
    market.param.update(earliest_s=300.0, latest_s=200.0)
    assert "lies before earliest_arrival_s" in str(page.failure)
    assert state.scenario.edits == edits
    market.dwell_s = 31.0
    assert page.failure is None
