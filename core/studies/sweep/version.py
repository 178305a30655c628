"""The version of all that computes the rows of a sweep."""

import platform
from functools import cache
from importlib.metadata import version
from pathlib import Path

from railjoule.core.kernel_cache import source_hash

CORE = Path(__file__).parents[2]
# by whose releases the last digits of a run, or a row of a sample, may differ
LIBRARIES = ("numba", "numpy", "scipy")


@cache
def solver_version() -> str:
    """Return what tells apart all that a run's last digit hangs on: the sources, the libraries, the processor."""
    libraries = " ".join(f"{name} {version(name)}" for name in LIBRARIES)
    # not the processor's exact model: nodes of one cluster differ in it, and their results hardly ever
    return f"core {source_hash(CORE)} {libraries} {platform.machine()}"
