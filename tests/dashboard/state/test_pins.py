import pytest

from railjoule.core.strategies import prepare_task, run_strategy
from railjoule.dashboard.pages.compare.charts import contenders, find_reference
from railjoule.dashboard.state.pins import MOST_PINS, PIN_KEYS, TOO_MANY, Pin, make_recipe
from railjoule.dashboard.work.runs import RunsRequest, compute_runs
from railjoule.dashboard.workbench import Workbench


def solved(state: Workbench) -> Workbench:
    """Compute what the page would: the runs of the scenario as it stands."""
    state.runs = compute_runs(RunsRequest(state.scenario.scenario(), state.drawn))
    return state


@pytest.fixture
def state() -> Workbench:
    return solved(Workbench())


def same_energy(pin: Pin) -> None:
    """Run a pin's recipe again: the same scenario and strategy give the same energy."""
    scenario = pin.recipe.scenario
    assert scenario == pin.trajectory.scenario
    again = run_strategy(prepare_task(scenario), pin.recipe.strategy)
    assert again.energy_kwh == pytest.approx(pin.trajectory.energy_kwh, rel=1e-9)


def test_a_pin_can_be_run_again_from_its_recipe(state: Workbench) -> None:
    state.scenario.edit({"vehicle.load_factor": 0.25, "line.reverse": True})
    solved(state).chosen = "fastest"
    state.pin()
    (pin,) = state.pins
    assert (pin.recipe.preset, pin.recipe.opened, pin.recipe.strategy) == ("metro-with-limit", None, "fastest")
    assert pin.recipe.changes == {"vehicle.load_factor": 0.25, "line.reverse": True}
    same_energy(pin)


def test_a_run_that_the_page_has_moved_on_from_keeps_its_own_scenario(state: Workbench) -> None:
    state.scenario.load_percent = 90.0
    state.pin()
    (pin,) = state.pins
    assert pin.recipe.preset is None
    same_energy(pin)


def test_a_scenario_from_a_file_is_kept_as_its_document(state: Workbench) -> None:
    state.scenario.open(
        'line.preset = "liashenko-i"\n[vehicle]\npreset = "metro-81-7036"\nload_factor = 0.5\n'
        "[timetable]\ntravel_time_s = 100.0\n",
        "mine.toml",
    )
    state.scenario.travel_time_s = 110.0
    recipe = make_recipe(state.scenario, state.scenario.scenario(), "optimal")
    assert recipe.preset is None
    assert recipe.changes == {"timetable.travel_time_s": 110.0}
    assert recipe.scenario == state.scenario.scenario()


def test_six_runs_are_the_most_and_each_has_its_own_colour(state: Workbench) -> None:
    for load in range(10, 10 * (MOST_PINS + 2), 10):
        state.scenario.load_percent = float(load)
        solved(state).pin()
    assert [pin.colour for pin in state.pins] == list(PIN_KEYS)
    assert state.notice == TOO_MANY
    state.unpin(state.pins[2])
    assert state.notice == ""
    state.pin()
    assert [pin.number for pin in state.pins] == [1, 2, 4, 5, 6, 3]
    assert state.pinned is state.pins[-1].trajectory


def test_the_same_run_is_pinned_once(state: Workbench) -> None:
    state.pin()
    assert state.pin_of_run is state.pins[0]
    state.pin()
    assert len(state.pins) == 1
    state.chosen = "fastest"
    assert state.pin_of_run is None


def test_an_empty_name_gives_back_the_first_one(state: Workbench) -> None:
    state.pin()
    first = state.pins[0].name
    assert first == "Optimal, 170.0 s, load 50 %, recuperation 40 %"
    state.rename(state.pins[0], "  with \n wind ")
    assert state.pins[0].name == "with wind"
    state.rename(state.pins[0], " ")
    assert state.pins[0].name == first


def test_the_best_known_run_is_the_reference_until_another_is_chosen(state: Workbench) -> None:
    among = contenders(state)
    assert [contender.key for contender in among] == ["optimal", "fastest"]
    assert find_reference(state, among).key == "optimal"
    state.chosen = "fastest"
    state.pin()
    assert find_reference(state, contenders(state)).key == "optimal"
    assert find_reference(state, contenders(state), "pin_1").key == "pin_1"
    assert find_reference(state, contenders(state), "fastest").key == "fastest"
    state.unpin(state.pins[0])
    assert find_reference(state, contenders(state), "pin_1").key == "optimal"


def test_all_strategies_are_compared_only_over_the_scenario_in_sight(state: Workbench) -> None:
    compared = compute_runs(RunsRequest(state.runs.scenario, ("bellman",)))
    assert [contender.key for contender in contenders(state, compared)] == ["optimal", "bellman", "fastest"]
    assert [contender.key for contender in contenders(state, compared, only_ticked=True)] == ["optimal", "fastest"]
    state.scenario.load_percent = 10.0
    assert [contender.key for contender in contenders(solved(state), compared)] == ["optimal", "fastest"]
