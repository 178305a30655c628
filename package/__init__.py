"""Energy-optimal driving of one electric rail vehicle.

    import railjoule as rj

    run = rj.solve("liashenko-ii")
    print(run.energy_kwh, run.lower_bound_kwh)

The public names are those of `railjoule.core`. They load when one is first used, because the solver takes half a second
to import, and the command line answers `--help` without it.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from railjoule.core import *  # noqa: F403

    __version__: str

CORE = f"{__name__}.core"


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version  # noqa: PLC0415  (slow to read)

        return version("railjoule")
    # the import system asks for submodules and for special names, before the core can be imported
    if name != "core" and not name.startswith("_"):
        core = import_module(CORE)
        if name in core.__all__:
            return getattr(core, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*import_module(CORE).__all__, "__version__"]
