import pytest

from railjoule.core.validation import benchmark as module
from railjoule.core.validation.benchmark import INTERIOR_POINT, TEXTBOOK, TUNED, benchmark, warm_median_s


def test_the_first_call_does_not_count():
    calls = []
    warm_median_s(lambda: calls.append(1), budget_s=0.0)
    assert len(calls) == 1 + module.FEWEST_CALLS


def test_calls_end_at_a_largest_number():
    calls = []
    warm_median_s(lambda: calls.append(1), budget_s=60.0)
    assert len(calls) == 1 + module.MAX_CALLS


@pytest.fixture
def one_scenario(monkeypatch):
    monkeypatch.setattr(module, "preset_names", lambda _: ("ftorek-300s",))


@pytest.mark.nightly
def test_every_solver_is_timed_on_the_same_problem(one_scenario):
    pytest.importorskip("casadi", reason="CasADi is not installed, so there is no IPOPT to time")
    timings = {timing.solver: timing for timing in benchmark(budget_s=0.0)}
    assert list(timings) == [
        "optimal",
        "bellman",
        "eoc",
        "enoc",
        "phases",
        "speed_limits",
        "linear_reserve",
        "fastest",
        INTERIOR_POINT,
        TEXTBOOK,
        TUNED,
    ]
    energy = timings["optimal"].energy_kwh
    for solver in (INTERIOR_POINT, TEXTBOOK, TUNED):
        # they solve one problem, each to a relative 1e-7 or better
        assert timings[solver].energy_kwh == pytest.approx(energy, rel=2e-7)
        assert timings[solver].iterations > 0
    assert {timing.cell_count for timing in timings.values()} == {1006}
    assert all(timing.median_s > 0 for timing in timings.values())


def test_strategies_that_refuse_are_left_out(monkeypatch):
    monkeypatch.setattr(module, "preset_names", lambda _: ("liashenko-0",))
    monkeypatch.setattr(module, "is_installed", lambda: False)
    assert [timing.solver for timing in benchmark(budget_s=0.0)] == [
        "optimal",
        "bellman",
        "phases",
        "speed_limits",
        "linear_reserve",
        "fastest",
        INTERIOR_POINT,
    ]
