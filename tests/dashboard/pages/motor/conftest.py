import pytest

from railjoule.dashboard.pages.host import make_works
from railjoule.dashboard.state.workbench import Workbench

SHORT = {"line": {"sections": [{"length_m": 1000.0}]}, "timetable.travel_time_s": 75.0}
"""A run that takes little time to compute."""


@pytest.fixture(scope="package")
def opened():
    """A workbench whose page Motor is in sight; all work is done in the test's own turn."""
    state = Workbench()
    make_works("Motor")(state)
    state.scenario.choose("ftorek-300s")
    state.chosen = "enoc"
    state.scenario.edit(SHORT)
    state.page = "Motor"
    return state


@pytest.fixture
def state(opened):
    """The same; what a test changes is put back."""
    yield opened
    opened.page = "Drive"
    opened.scenario.choose("ftorek-300s")
    opened.chosen = "enoc"
    opened.pages["Motor"].take(opened.scenario.base)
    opened.scenario.edit(SHORT)
    opened.page = "Motor"
