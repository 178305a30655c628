from dataclasses import replace

import pytest

from railjoule.core.scenario import parse_scenario
from railjoule.core.trajectory import MEASURED
from railjoule.dashboard.keep.dropped import scenario_in_report
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.report.work import Reporting, file_name
from railjoule.dashboard.work.runs import RunsRequest, compute_runs
from railjoule.dashboard.workbench import Workbench


@pytest.fixture
def reporting() -> Reporting:
    """The reports of a workbench without a page around it: all work is done in the test's own turn."""
    state = Workbench()
    state.scenario.choose("liashenko-0")
    state.runs = compute_runs(RunsRequest(state.scenario.scenario(), ("optimal",)))
    reporting = Reporting(state)
    reporting.model.contents = Contents(("pinned",))
    return reporting


def test_a_report_holds_what_is_in_sight(reporting: Reporting) -> None:
    state, model = reporting.state, reporting.model
    state.scenario.load_percent = 30.0
    model.param.trigger("wanted")
    scenario = parse_scenario(scenario_in_report(model.text, "report.html"))
    assert scenario.vehicle.load_factor == 0.3
    assert scenario.disturbance.actual_load_factor is None
    assert not model.busy
    assert model.share == 1.0
    assert model.failure is None
    assert model.name_of_file == file_name(scenario.title)


def test_the_page_robustness_lays_its_reality_over_the_scenario(reporting: Reporting) -> None:
    reporting.state.page = "What if"
    reporting.state.day.actual_load_percent = 80.0
    reporting.model.param.trigger("wanted")
    assert parse_scenario(scenario_in_report(reporting.model.text, "report.html")).disturbance.actual_load_factor == 0.8


def test_a_failure_is_told_and_ends_with_the_next_report(reporting: Reporting) -> None:
    state, model = reporting.state, reporting.model
    time = state.scenario.travel_time_s
    state.scenario.travel_time_s = 10.0
    model.param.trigger("wanted")
    assert model.text == ""
    assert not model.busy
    assert "shorter than the shortest possible" in str(model.failure)
    state.scenario.travel_time_s = time
    model.param.trigger("wanted")
    assert model.failure is None
    assert model.text != ""


def test_pinned_runs_stand_beside_the_first_one(reporting: Reporting) -> None:
    state, model = reporting.state, reporting.model
    model.param.trigger("wanted")
    assert "Pinned runs" not in model.text
    state.pin()
    run = state.pins[0].trajectory
    measured = replace(state.pins[0], name="Measured, <b>", trajectory=replace(run, strategy=MEASURED))
    state.pins = (*state.pins, measured)
    model.param.trigger("wanted")
    assert model.text.count('<section id="pinned"') == 1
    assert "Measured, &lt;b&gt;" in model.text
    assert "A measured run has the speeds of a train\u2019s recorder" in model.text


@pytest.mark.parametrize(
    ("title", "name"),
    [
        ("Metro, profile II + I", "railjoule-metro-profile-ii-i.html"),
        ("../../<b>", "railjoule-b.html"),
        ("\u00e9\u00e9", "railjoule-report.html"),
        ("a" * 200, f"railjoule-{'a' * 60}.html"),
    ],
)
def test_a_file_is_called_after_its_scenario(title: str, name: str) -> None:
    assert file_name(title) == name
