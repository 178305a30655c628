"""Work that would take too long is refused before it begins."""

import re
import threading
import tracemalloc
from dataclasses import replace

import pytest
from builders import INDUCTION, plain_scenario

from railjoule.core import ScenarioError, StrategyRefusedError, compare, load_scenario, solve
from railjoule.core.budget import LIBRARY, PAGE, current_budget, rounded_up, within
from railjoule.core.motion import build_meshed_line
from railjoule.core.simulation.field_oriented import simulate_field_oriented
from railjoule.core.strategies import prepare_task, run_strategy

SMALL = replace(PAGE, cell_count=300, strategy_cells={"bellman": 100, "speed_limits": 150}, idling_cells=120)
"""For a line of 2000 m: a mesh of 10 m makes 206 cells."""


def test_the_pages_budget_is_smaller_in_everything():
    page, library = ({**one.__dict__, **one.strategy_cells} for one in (PAGE, LIBRARY))
    assert page.keys() == library.keys()
    assert [key for key in page if isinstance(page[key], int | float) and page[key] >= library[key]] == []


def test_a_budget_holds_in_its_block_and_its_thread_alone():
    others = []
    with within(SMALL):
        assert current_budget() is SMALL
        thread = threading.Thread(target=lambda: others.append(current_budget()))
        thread.start()
        thread.join()
    assert current_budget() is LIBRARY
    assert others == [LIBRARY]


@pytest.mark.parametrize(
    ("strategy", "sentence"),
    [
        ("bellman", "takes at most 100 cells, and solver.mesh_m = 10 makes 206. Use 22 m or more."),
        ("speed_limits", "takes at most 150 cells, and solver.mesh_m = 10 makes 206. Use 14 m or more."),
    ],
)
def test_a_strategy_refuses_more_cells_than_its_own(strategy, sentence):
    task = prepare_task(plain_scenario())
    with within(SMALL):
        with pytest.raises(StrategyRefusedError, match=f"^{re.escape(sentence)}$"):
            run_strategy(task, strategy)
        enough_m = float(re.search(r"Use (\S+) m", sentence)[1])
        assert run_strategy(prepare_task(plain_scenario({"solver.mesh_m": enough_m})), strategy).energy_kwh > 0


def test_a_comparison_goes_on_without_the_strategies_that_take_fewer_cells():
    with within(SMALL):
        found = compare(plain_scenario())
        runs, refused = found.runs, found.refused
    assert {"optimal", "fastest"} <= {run.strategy for run in runs}
    assert refused["bellman"].startswith("takes at most 100 cells")


def test_given_limits_are_one_trip_over_any_mesh():
    given = plain_scenario({"search.limits_kmh": [80.0]})
    with within(SMALL):
        assert run_strategy(prepare_task(given), "speed_limits").energy_kwh > 0


def test_the_optimum_of_a_drive_that_takes_power_idling_has_fewer_cells():
    scenario = plain_scenario({"vehicle.drive": INDUCTION, "timetable.travel_time_s": 250.0})
    with within(SMALL):
        with pytest.raises(StrategyRefusedError, match=r"^takes at most 120 cells"):
            solve(scenario)
        fastest = solve(scenario, "fastest")
    assert fastest.bound is None
    assert solve(scenario, "fastest").bound is not None


def test_no_mesh_has_more_cells_than_the_budget_even_if_it_is_known():
    scenario = plain_scenario({"solver.mesh_m": 5.0})
    assert build_meshed_line(scenario).cell_count == 406
    with (
        within(SMALL),
        pytest.raises(
            ScenarioError, match=r"^solver.mesh_m = 5 makes 406 cells; the page takes at most 300. Use 6.9 m or more.$"
        ),
    ):
        build_meshed_line(scenario)


@pytest.mark.parametrize("key", ["line.sections", "line.speed_limits"])
def test_more_rows_than_the_budget_has_are_refused(key):
    limits = [{"from_m": index, "to_m": index + 1, "limit_kmh": 50} for index in range(301)]
    rows = limits if key == "line.speed_limits" else [{"length_m": 5.0}] * 301
    scenario = plain_scenario({key: rows, "solver.mesh_m": 1000.0})
    build_meshed_line(scenario)
    with (
        within(replace(SMALL, row_count=300)),
        pytest.raises(ScenarioError, match=rf"^{key} has 301 entries; the page takes at most 300\.$"),
    ):
        build_meshed_line(scenario)


def test_cars_over_very_many_sections_are_refused_before_their_nodes_are_made():
    sections = [{"length_m": 1.0, "gradient_permille": index % 5} for index in range(20_000)]
    scenario = plain_scenario({"line.sections": sections, "vehicle.length_m": 300.0, "vehicle.car_count": 200})
    tracemalloc.start()
    with pytest.raises(ScenarioError, match=r"railjoule takes at most 200,000, and sections, .* already make 4,019,80"):
        build_meshed_line(scenario)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 20e6  # bytes; four million nodes alone would take 32 MB


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        (
            {"timetable.travel_time_s": 3000.0},
            "A plan of 3,000 s is too long for the closed loop: the page takes at most 2,500 s.",
        ),
        (
            {"timetable.travel_time_s": 2000.0, "simulation.time_step_s": 5e-5},
            "simulation.time_step_s = 5e-05 makes 40,000,000 steps; the page takes at most 5,000,000. "
            "Use 0.0004 s or more.",
        ),
    ],
    ids=["long", "fine"],
)
def test_a_closed_loop_of_too_many_steps_is_refused(changes, sentence):
    with within(PAGE), pytest.raises(ScenarioError, match=f"^{re.escape(sentence)}$"):
        simulate_field_oriented(load_scenario("ftorek-300s", changes))


def test_the_literal_regulator_refuses_too_short_a_step():
    search = {"search.regulator": "literal", "search.limits_kmh": [80.0], "search.time_step_s": 0.0005}
    scenario = plain_scenario({**search, "timetable.travel_time_s": 200.0})
    sentence = (
        "takes at most 200,000 steps of the literal regulator, and search.time_step_s = 0.0005 makes 400,000. "
        "Use 0.001 s or more."
    )
    with pytest.raises(StrategyRefusedError, match=f"^{re.escape(sentence)}$"):
        solve(scenario, "speed_limits")


@pytest.mark.parametrize(
    ("value", "expected"), [(0.1, 0.1), (0.1001, 0.11), (99.1, 100.0), (1234.0, 1300.0), (6.9, 6.9), (3e-4, 3e-4)]
)
def test_recommended_numbers_have_two_digits_and_are_enough(value, expected):
    assert rounded_up(value) == expected
