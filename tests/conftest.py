"""Settings that all tests share."""

import os
import tempfile

import pytest
from hypothesis import settings

from railjoule.core.compilation import require_compiled

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
