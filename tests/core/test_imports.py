"""What the core loads before anything is asked of it: a terminal waits for that each time."""

import importlib
import pkgutil
import subprocess
import sys
from types import ModuleType

import pytest

import railjoule.core

SLOW_PARTS = (
    "scipy.integrate",
    "scipy.interpolate",
    "scipy.ndimage",
    "scipy.optimize",
    "scipy.stats",
    "pandas",
    "xarray",
)


def test_slow_parts_are_loaded_when_they_are_first_used():
    """They double the time that `import railjoule.core` takes."""
    told = f"import sys, railjoule.core; print([part for part in {SLOW_PARTS} if part in sys.modules])"
    done = subprocess.run([sys.executable, "-c", told], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


PACKAGES = [part.name for part in pkgutil.walk_packages(railjoule.core.__path__, "railjoule.core.") if part.ispkg]


@pytest.mark.parametrize("name", ["railjoule.core", *PACKAGES])
def test_no_name_of_a_package_hides_a_module_of_it(name):
    """`import railjoule.core.strategies.optimal as m` returns the package's attribute, which must be the module."""
    package = importlib.import_module(name)
    modules = [part.name for part in pkgutil.iter_modules(package.__path__)]
    assert [part for part in modules if not isinstance(getattr(package, part, package), ModuleType)] == []
