"""What the core loads before anything is asked of it: a terminal waits for that each time."""

import subprocess
import sys

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
