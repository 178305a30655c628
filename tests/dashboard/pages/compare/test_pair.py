"""The tab "Two scenarios" of Compare without a browser: what stands beside the first scenario, and the numbers."""

from collections.abc import Iterator

import numpy as np
import pytest
from markup import plain

from railjoule.core import Scenario, ScenarioError, Vehicle, load_scenario, solve
from railjoule.core.scenario import format_scenario
from railjoule.dashboard.app import Session
from railjoule.dashboard.keep.link import read_link, write_link
from railjoule.dashboard.keep.snapshot import lay, originals_of, snapshot_of
from railjoule.dashboard.pages.compare.page import Compare
from railjoule.dashboard.pages.compare.pair_tab import HELD, PAIR_TAB
from railjoule.dashboard.scenario_folder import ScenarioFolder
from railjoule.dashboard.state.files import serve_folder
from railjoule.dashboard.work.pair import NOTHING, SCENARIO, TIME, TRAIN, SecondScenario
from railjoule.dashboard.workbench import Workbench

METRO = "metro-with-limit"


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Session:
    """A page with a folder that has one scenario, turned to the tab."""
    folder = ScenarioFolder(tmp_path_factory.mktemp("mine"))
    folder.save("short", format_scenario(load_scenario("liashenko-ii")))
    serve_folder(folder)
    session = Session()
    serve_folder(None)
    session.state.page = "Compare"
    session.state.pages["Compare"].tab = PAIR_TAB
    return session


@pytest.fixture
def page(session: Session) -> Iterator[Compare]:
    """The page; what a test changes is put back."""
    found = session.state.pages["Compare"]
    assert isinstance(found, Compare)
    yield found
    found.param.update(second=NOTHING, second_from="")
    session.state.param.update(over_time=False, pins=(), notice="", chosen="optimal")
    session.state.scenario.restore()


def numbers(page: Compare) -> dict[str, list[str]]:
    """Return the cells of the table by quantity."""
    rows = [[plain(cell) for cell in row.split("<td>")[1:]] for row in page.pair_table.object.split("<tr")[2:]]
    return {name: cells for name, *cells in rows}


def number(cell: str) -> float:
    return float(cell.replace("\u2212", "-").replace(" ", ""))


def test_nothing_stands_beside_a_scenario_until_it_is_chosen(page: Compare) -> None:
    assert page.pair is None
    assert plain(page.pair_words.object).startswith("Choose a second scenario")
    assert not page.pair_columns.visible


def test_another_train_has_the_numbers_of_two_single_solves(session: Session, page: Compare) -> None:
    page.second_menu.value = "train:metro-5-car-synchronous"
    base = load_scenario(METRO)
    # the vehicle's own file, with load, recuperation and time of the first train
    other = Scenario(
        Vehicle.from_preset("metro-5-car-synchronous", load_factor=0.5, drive={"recuperation_factor": 0.4}),
        base.line,
        travel_time_s=170.0,
    )
    first, second = solve(base), solve(other)
    shown = numbers(page)
    for name, one, two in (
        ("Energy, kWh", first.energy.net_j / 3.6e6, second.energy.net_j / 3.6e6),
        ("Energy per km, kWh/km", first.energy.net_j / 3.6e6 / 2.3, second.energy.net_j / 3.6e6 / 2.3),
        ("Travel time, s", first.time_s[-1], second.time_s[-1]),
        ("Highest speed, km/h", 3.6 * first.speed_ms.max(), 3.6 * second.speed_ms.max()),
        ("Largest power, kW", first.supply_power_w.max() / 1e3, second.supply_power_w.max() / 1e3),
        ("Lower bound, kWh", first.lower_bound_kwh, second.lower_bound_kwh),
    ):
        a, b, difference, percent = (number(cell) for cell in shown[name])
        digit = 10.0 ** -len(shown[name][0].partition(".")[2])
        assert (a, b, difference) == pytest.approx((one, two, two - one), abs=digit), name
        assert percent == pytest.approx(100 * (two / one - 1), abs=0.6), name
    per_tonne = number(shown["Energy per tonne and km, Wh"][1])
    mass_t = other.vehicle.total_mass_kg / 1000
    assert per_tonne == pytest.approx(second.energy.net_j / 3600 / mass_t / 2.3, abs=0.06)
    assert "vehicle Metro, 5 cars, synchronous instead of Metro 81-7036, 5 cars" in plain(page.pair_words.object)
    # the sliders of the plan move both trains
    session.state.scenario.param.update(travel_time_s=181.0, load_percent=70.0, recuperation_percent=20.0)
    now = page.pair.second.scenario
    assert (now.travel_time_s, now.vehicle.load_factor, now.vehicle.drive.recuperation_factor) == (181.0, 0.7, 0.2)


def test_another_time_follows_the_first_scenario_in_all_else(session: Session, page: Compare) -> None:
    page.second_menu.value = "time:"
    assert page.second_time.visible
    # 1.1 times the first where none is given
    assert (page.second_time.value, page.second_time.suggested) == (None, pytest.approx(187.0))
    assert page.pair.runs[1].travel_time_s == pytest.approx(187.0, abs=1e-3)
    session.state.scenario.travel_time_s = 180.0
    assert page.second_time.suggested == pytest.approx(198.0)
    assert [run.travel_time_s for run in page.pair.runs] == pytest.approx([180.0, 198.0], abs=1e-3)
    session.state.scenario.travel_time_s = 170.0
    page.second_time_s = 200.0
    session.state.scenario.load_percent = 0.0
    first, second = (run.scenario for run in page.pair.runs)
    assert second == first.replace({"timetable.travel_time_s": 200.0})
    words = plain(page.pair_words.object)
    assert "First: 170.0 s Second: 200.0 s The second scenario has travel time 200.0 s instead of 170.0 s." in words
    page.second_time_s = 60.0
    assert "60.0 s is too short." in plain(page.host.message.object)
    page.second_time_s = 200.0
    assert page.failure is None


def test_lines_of_two_lengths_share_the_axes(session: Session, page: Compare) -> None:
    page.second_menu.value = "scenario:tram-950m"
    plots = page.host.plots
    assert "The lines are 2 300 and 950 m long; both are drawn from their start." in plain(page.pair_words.object)
    one, other = plots["first_speed"], plots["second_speed"]
    assert one.axis is other.axis
    # one cursor: the very same model in both figures
    assert one.axis.cursor is other.axis.cursor
    assert one.axis.end == pytest.approx(2300.0)
    for row in ("speed", "power", "energy", "effort"):
        ranges = [plots[f"{side}_{row}"].y_range for side in ("first", "second")]
        assert (ranges[0].start, ranges[0].end) == (ranges[1].start, ranges[1].end)
    # each column has the limits of its own line
    assert np.max(one.sources["limit"].data["x"]) == 2300.0
    assert np.max(other.sources["limit"].data["x"]) == 950.0
    session.state.over_time = True
    assert one.axis.end == pytest.approx(170.0, abs=1e-3)
    assert len(one.sources["limit"].data["x"]) == 0


def test_the_scenario_of_a_pin_stands_beside_the_changed_one(session: Session, page: Compare) -> None:
    session.state.pin()
    session.state.scenario.load_percent = 0.0
    page.second_menu.value = "pin:pin_1"
    assert page.second_menu.value == HELD
    assert page.pair.second.scenario == session.state.pins[0].trajectory.scenario
    assert page.pair.runs[1].energy_kwh == session.state.pins[0].trajectory.energy_kwh
    assert "load 50 % instead of 0 %" in plain(page.pair_words.object)


def test_a_saved_scenario_or_its_train_stands_beside_the_first(session: Session, page: Compare) -> None:
    page.second_menu.value = "file:short"
    assert page.pair.second.scenario == load_scenario("liashenko-ii")
    page.second_menu.value = "train-of:short"
    second = page.pair.second.scenario
    assert second.line == load_scenario(METRO).line
    train = (
        load_scenario("liashenko-ii").replace({"drive.recuperation_factor": 0.4, "vehicle.load_factor": 0.5}).vehicle
    )
    assert second.vehicle.model_dump(exclude={"preset"}) == train.model_dump(exclude={"preset"})


def test_a_strategy_that_refuses_the_second_scenario_is_named(session: Session, page: Compare) -> None:
    session.state.scenario.choose("ftorek-300s")
    session.state.chosen = "eoc"
    page.second_menu.value = "scenario:metro-with-limit"
    first, second = page.pair.runs
    assert (first.strategy, second.strategy) == ("eoc", "optimal")
    assert "EOC refuses the second scenario: needs a line without limits." in plain(page.pair_words.object)
    session.state.scenario.choose(METRO)


@pytest.mark.parametrize(
    ("kind", "source", "sentence"),
    [
        (TRAIN, "no-such-train", "second scenario: "),
        (SCENARIO, "[line]\nlength_m = 5\n", "second scenario: "),
        (SCENARIO, "", "second scenario: "),
    ],
)
def test_what_is_no_scenario_is_one_sentence(page: Compare, kind: str, source: str, sentence: str) -> None:
    page.param.update(second=kind, second_from=source)
    assert sentence in str(page.failure)
    assert page.host.message.visible


def test_a_link_opens_the_same_pair_and_undo_takes_it_back(session: Session, page: Compare) -> None:
    page.second_menu.value = "train:tram-105n"
    state = session.state
    link = write_link(snapshot_of(state), originals_of(snapshot_of(state)))
    assert "compare.second=train" in link
    assert "compare.second_from=tram-105n" in link
    opened = Workbench()
    assert lay(opened, read_link(link).snapshot) == ()
    assert opened.pages["Compare"].second_scenario == page.second_scenario
    assert opened.pages["Compare"].tab == PAIR_TAB
    history = session.keeping.history
    history.note({**snapshot_of(state), "compare.second": TIME})
    assert history.can_undo


def test_a_second_train_may_be_too_full(page: Compare) -> None:
    crowded = load_scenario(METRO).replace({"vehicle.crush_load_factor": 3.0, "vehicle.load_factor": 2.9})
    with pytest.raises(ScenarioError, match="load_factor"):
        SecondScenario(TRAIN, "tram-105n", 1.0).beside(crowded)
