import pytest

from railjoule.dashboard.page_work import PageWorks
from railjoule.dashboard.pages.set_speeds import page
from railjoule.dashboard.workbench import Workbench

RUNS = {}
"""Runs and searches by what was asked for: each takes half a second, and most tests begin with the same."""


@pytest.fixture
def state(monkeypatch):
    """A workbench whose page Set speeds is in sight; all work is done in the test's own turn."""
    compute, count = page.compute_limit_run, page.compute_counts

    def computed_once(*request):
        key = repr(request)
        if key not in RUNS:
            RUNS[key] = compute(*request)
        return RUNS[key]

    def counted_once(*request):
        key = repr(request)
        if key not in RUNS:
            RUNS[key] = list(count(*request))
        return iter(RUNS[key])

    monkeypatch.setattr(page, "compute_limit_run", computed_once)
    monkeypatch.setattr(page, "compute_counts", counted_once)
    state = Workbench()
    PageWorks(state.pages["Set speeds"])
    state.scenario.choose("kharkiv-like-40kmh")
    state.page = "Set speeds"
    return state
