"""Energy-optimal driving of one electric rail vehicle: the solver core, the dashboard, and their data."""

from typing import Any


def __getattr__(name: str) -> Any:
    # the metadata takes longer to read than most commands need to start
    if name == "__version__":
        from importlib.metadata import version  # noqa: PLC0415

        return version("railjoule")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
