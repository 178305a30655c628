"""Settings that all tests share, how they are distributed, and the file of their durations."""

import os
import tempfile
from collections import defaultdict
from pathlib import Path

import pytest
from hypothesis import settings
from xdist.scheduler import LoadFileScheduling

from railjoule.core.compilation import require_compiled

TESTS = Path(__file__).parent
BROWSER = TESTS / "browser"
SELF_CONTAINED = {"test_away", "test_documentation", "test_report", "test_scripts"}
"""Files of browser tests that need neither the common server nor its window: any process may take them."""
DURATIONS, SLOWEST = TESTS.parent / "build" / "durations.txt", 80
NICENESS = 10

# what commands print is wrapped to the terminal, and not every runner has one
os.environ["COLUMNS"] = "120"
# no test sees, or adds to, the files of whoever runs it
os.environ["XDG_DATA_HOME"] = os.environ["LOCALAPPDATA"] = tempfile.mkdtemp(prefix="railjoule-test-")

# examples are drawn alike in every run, and no run fails because the machine is busy
settings.register_profile("railjoule", deadline=None, derandomize=True, max_examples=30)
settings.load_profile("railjoule")


@pytest.fixture(scope="session", autouse=True)
def _compiled() -> None:
    """Compile the solver before the first test, as pages wait for it; `./run test` has done so already."""
    require_compiled()


class Scheduling(LoadFileScheduling):
    """Distribute by file, and all browser tests with a common server to one process."""

    def _split_scope(self, nodeid: str) -> str:
        file = super()._split_scope(nodeid)
        return str(BROWSER) if place(TESTS.parent / file) == 0 else file


def place(path: Path) -> int:
    """Return when a file's turn comes: first the longest part of a run, then its long files, then all others."""
    return 2 if not path.is_relative_to(BROWSER) else int(path.stem in SELF_CONTAINED)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: object) -> Scheduling:
    # files stay in the order of `pytest_collection_modifyitems`, not in that of their numbers of tests
    config.option.loadscopereorder = False
    return Scheduling(config, log)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the browser tests: the process that is free first takes the short files at the end."""
    items.sort(key=lambda item: place(item.path))


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Give way to a browser that waits for its server: other tests keep both processors busy."""
    if "PYTEST_XDIST_WORKER" in os.environ and not item.path.is_relative_to(BROWSER) and os.nice(0) == 0:
        os.nice(NICENESS)


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Write the durations of each folder and file, and the slowest steps of tests, to a file."""
    reports = [one for some in terminalreporter.stats.values() for one in some if hasattr(one, "duration")]
    totals: defaultdict[str, float] = defaultdict(float)
    for one in reports:
        file = one.nodeid.split("::")[0]
        for name in {file, "/".join(file.split("/")[:2])}:
            totals[name] += one.duration
    reports.sort(key=lambda one: one.duration, reverse=True)
    lines = [f"{seconds:8.2f}s {name}" for name, seconds in sorted(totals.items())]
    lines += ["", *(f"{one.duration:8.2f}s {one.when:<8} {one.nodeid}" for one in reports[:SLOWEST])]
    DURATIONS.parent.mkdir(exist_ok=True)
    DURATIONS.write_text("\n".join(lines) + "\n", encoding="utf-8")
