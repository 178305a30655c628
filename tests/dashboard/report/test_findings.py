from dataclasses import replace

import numpy as np
import pytest

from railjoule.core import TimetableError, load_scenario, solve
from railjoule.core.simulation.disturbances import DisturbedRun
from railjoule.core.simulation.following import Following
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.report.contents import Contents
from railjoule.dashboard.report.findings import OPTIMA_COUNT, Findings, ReportRequest, compute_findings


def found(name: str, changes: dict[str, object] | None = None) -> Findings:
    *_, findings = compute_findings(ReportRequest(load_scenario(name, changes)))
    return findings


@pytest.fixture(scope="module")
def steps() -> list[Findings]:
    return list(compute_findings(ReportRequest(load_scenario("liashenko-ii"))))


def test_the_work_goes_on_to_its_end(steps: list[Findings]) -> None:
    shares = [step.share for step in steps]
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert len(steps) > 50


def test_every_strategy_runs_or_refuses(steps: list[Findings]) -> None:
    runs = steps[-1].runs
    assert {*runs.runs, *runs.refused} == set(STRATEGIES)


def test_the_optimum_of_the_timetable_is_among_the_optima(steps: list[Findings]) -> None:
    optima = steps[-1].optima
    times = np.array([run.travel_time_s for run in optima])
    energies = np.array([run.energy_kwh for run in optima])
    assert len(optima) == OPTIMA_COUNT
    assert np.all(np.diff(times) > 0)
    # more time never costs more, as a train may always arrive late
    assert np.all(np.diff(energies) < 0)
    own = solve(load_scenario("liashenko-ii"))
    assert np.min(np.abs(times - own.travel_time_s)) < 1e-6
    assert energies[np.argmin(np.abs(times - own.travel_time_s))] == pytest.approx(own.energy_kwh, rel=1e-6)


def test_reality_is_asked_for_by_a_disturbance(steps: list[Findings]) -> None:
    assert steps[-1].reality is None
    assert isinstance(found("liashenko-0", {"disturbance.coordinate_error_m": 10.0}).reality, Following)
    # nothing of the run differs from the plan, as the pages have it: no plan under target braking curves beside it
    assert found("liashenko-0", {"disturbance.departure_delay_s": 5.0}).reality is None
    stop = [{"position_m": 400.0, "duration_s": 5.0}]
    assert isinstance(found("liashenko-0", {"disturbance.stops": stop}).reality, DisturbedRun)


def test_a_timetable_that_cannot_be_kept_is_refused() -> None:
    with pytest.raises(TimetableError):
        next(compute_findings(ReportRequest(load_scenario("liashenko-0", {"timetable.travel_time_s": 10.0}))))


def test_the_requested_strategy_comes_first() -> None:
    findings = next(compute_findings(ReportRequest(load_scenario("liashenko-0", {"strategy": "fastest"}))))
    assert findings.run.strategy == "fastest"
    assert findings.scenario.strategy == "fastest"


def test_a_report_tells_the_bound_that_is_known_or_proves_as_much_as_the_commands() -> None:
    scenario = load_scenario("tram-950m-recuperating", {"solver.mesh_m": 20.0})
    first = next(compute_findings(ReportRequest(scenario, prove_seconds=0))).runs.best
    steps = compute_findings(ReportRequest(scenario))
    usual = next(steps).runs.best
    assert usual.bound.energy_j == solve(scenario, "optimal").bound.energy_j > first.bound.energy_j
    # the optimum of the timetable is told twice
    own = next(step.optima[-1] for step in steps if step.optima[-1].travel_time_s > usual.travel_time_s - 1e-6)
    assert own.bound is usual.bound
    known = replace(usual.bound, energy_j=usual.bound.energy_j + 1.0)
    assert next(compute_findings(ReportRequest(scenario, bound=known))).runs.best.bound is known


def test_what_no_section_tells_is_not_computed() -> None:
    scenario = load_scenario("ftorek-300s", {"disturbance.actual_load_factor": 1.0})

    def told(*sections: str) -> tuple[bool, ...]:
        steps = list(compute_findings(ReportRequest(scenario, contents=Contents(sections))))
        assert steps[-1].share == 1.0
        last = steps[-1]
        return (bool(last.optima), last.enoc_map is not None, last.reality is not None, last.table is not None)

    assert told("proof", "scenario", "energy", "file", "pinned") == (False, False, False, False)
    assert told("result") == (True, False, False, False)
    assert told("trade-off") == (True, True, False, False)
    assert told("reality") == (False, False, True, False)
    assert told("robustness") == (False, False, False, True)
