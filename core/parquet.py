"""Whether tables can be read and written as Parquet, which needs a package that not everybody has."""

import importlib.util

NEEDED = "parquet needs pyarrow: pip install pyarrow."


def has_parquet() -> bool:
    """Return whether they can, without loading the package."""
    return importlib.util.find_spec("pyarrow") is not None
