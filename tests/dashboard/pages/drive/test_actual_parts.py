"""What Drive tells of an actual run that needs less than its plan."""

import html
import re

from railjoule.core import load_scenario
from railjoule.core.simulate.actual_run import ActualRun, actual_run
from railjoule.dashboard.pages.drive.actual_parts import actual_figures, causes_block
from railjoule.dashboard.work.runs import RunsRequest, compute_runs


def plain(markup: str) -> str:
    return " ".join(html.unescape(re.sub(r"<[^>]+>", " ", markup)).split())


def told(load_factor: float, error_m: float) -> tuple[ActualRun, str, str]:
    changes = {"disturbance.actual_load_factor": load_factor, "disturbance.coordinate_error_m": error_m}
    scenario = load_scenario("metro-with-limit", {"simulation.target_braking": False, **changes})
    runs = compute_runs(RunsRequest(load_scenario("metro-with-limit"), ("optimal",)))
    actual = actual_run(scenario)
    return actual, plain(actual_figures(actual, runs, runs.best)), plain(causes_block(actual))


def test_less_energy_by_a_miss_is_no_saving() -> None:
    actual, head, causes = told(0.25, 10.0)
    assert actual.extra_kwh < 0
    assert actual.stop_error_m == -10
    assert re.match(r"Actual run [\d.]+ m short of the stop [\d.]+ kWh against 7\.81 planned", head)
    assert "Where the 0." in causes
    assert "kWh less comes from" in causes
    assert "run saves" not in head
    assert "saved" not in causes


def test_less_energy_in_time_is_a_saving() -> None:
    actual, head, causes = told(0.0, 0.0)
    assert actual.extra_kwh < 0
    assert head.startswith("Actual run saves \u2212")
    assert "Where the saved " in causes
