"""The numbers of the tab "Load and position"."""

import re

from markup import plain

from railjoule.core import load_scenario
from railjoule.core.simulation.following import plan_knowing_load
from railjoule.dashboard.look import words
from railjoule.dashboard.look.words import MINUS
from railjoule.dashboard.pages.what_if.compute import Reality, compute_reality
from railjoule.dashboard.pages.what_if.load import load_figures

NO_TARGET_CURVE = load_scenario("metro-with-limit", {"simulation.target_braking": False})
"""A train that brakes where it thinks the curve begins, and so may miss its stop."""


def reality_at(load_factor: float, error_m: float) -> Reality:
    changes = {"disturbance.actual_load_factor": load_factor, "disturbance.coordinate_error_m": error_m}
    return compute_reality(NO_TARGET_CURVE, changes)


def figures_at(load_factor: float, error_m: float) -> list[str]:
    return [plain(cell) for cell in load_figures(reality_at(load_factor, error_m), None)]


def test_a_run_that_misses_timetable_and_stop_is_no_saving() -> None:
    """It read as -1.8 % (walk_engineer.md, F8): late and beyond the stop first, the energy at equal arrival second."""
    main, equal, plan = figures_at(1.0, 10.0)
    assert main == "Load 100 %, +10 m 3.2 s late 14.5 m beyond the stop"
    assert re.fullmatch(r"Energy at equal arrival \+[\d.]+ % 9\.68 kWh, for the actual load [\d.]+", equal)
    # beside the plan for half of the load it needs more, and that is shown
    assert plan == "Against the plan +1.867 kWh +23.9 %, planned 7.81"


def test_energy_is_compared_with_the_plan_for_the_load_that_arrives_when_the_run_did() -> None:
    reality = reality_at(1.0, 10.0)
    run = reality.following.actual
    equal = plan_knowing_load(NO_TARGET_CURVE.replace(**{"timetable.travel_time_s": run.travel_time_s}), 1.0)
    assert reality.equal_kwh == equal.energy_kwh
    # 3.2 s more save energy: beside the plan for the timetable the run looked better than it is
    assert reality.replanned_kwh is not None
    assert reality.equal_kwh < run.energy_kwh < reality.replanned_kwh
    assert words.energy(equal.energy_kwh) in figures_at(1.0, 10.0)[1]


def test_a_miss_comes_first_though_the_run_needs_more() -> None:
    main, equal, _ = figures_at(1.0, -20.0)
    assert re.match(r"Load 100 %, \u221220 m [\d.]+ (s late|m short of the stop)", main)
    assert re.match(r"Energy at equal arrival \+\d", equal)


def test_a_run_in_time_at_its_stop_is_shown_by_its_energy() -> None:
    scenario = load_scenario("liashenko-ii")
    cells = load_figures(compute_reality(scenario, {"disturbance.actual_load_factor": 0.0}), None)
    main, arrival, _ = map(plain, cells)
    assert re.match(r"Load 0 %, 0 m \+[\d.]+ % [\d.]+ kWh, for the actual load [\d.]+", main)
    assert arrival == "Arrival 0.0 s at the stop"


def test_an_early_run_has_its_energy_at_equal_arrival_too() -> None:
    changes = {"disturbance.actual_load_factor": 1.0, "disturbance.coordinate_error_m": 10.0}
    reality = compute_reality(load_scenario("ftorek-300s"), changes)
    main, arrival, _ = map(plain, load_figures(reality, None))
    assert main.startswith("Load 100 %, +10 m +1.1 %")
    # against the later timetable it looked more expensive than it is
    assert reality.equal_kwh is not None
    assert reality.replanned_kwh is not None
    assert reality.following.actual.energy_kwh > reality.equal_kwh > reality.replanned_kwh
    assert re.fullmatch(rf"Arrival {MINUS}2\.2 s \+[\d.]+ % energy at equal arrival", arrival)


def test_less_than_the_plan_by_a_miss_has_no_percentage() -> None:
    *_, plan = figures_at(0.25, 10.0)
    assert re.fullmatch(rf"Against the plan {MINUS}[\d.]+ kWh planned 7\.81", plan)
