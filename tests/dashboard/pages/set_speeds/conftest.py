import pytest

from railjoule.dashboard.pages.host import make_works
from railjoule.dashboard.pages.set_speeds import page
from railjoule.dashboard.state.workbench import Workbench

RUNS = {}
"""Runs and searches by what was asked for: each takes half a second, and most tests begin with the same."""


@pytest.fixture
def state(monkeypatch):
    """A workbench whose page Set speeds is in sight; all work is done in the test's own turn."""
    compute = page.compute_limit_run

    def computed_once(request):
        key = repr(request)
        if key not in RUNS:
            RUNS[key] = compute(request)
        return RUNS[key]

    monkeypatch.setattr(page, "compute_limit_run", computed_once)
    state = Workbench()
    make_works("Set speeds")(state)
    state.scenario.choose("kharkiv-like-40kmh")
    state.page = "Set speeds"
    return state
