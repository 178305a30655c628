"""Rows of a study with labels and units."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray


def label_rows(
    dimension: str, columns: Mapping[str, tuple[Any, str]], attributes: Mapping[str, Any]
) -> "xarray.Dataset":
    """Return columns of one length as a dataset.

    Parameters
    ----------
    dimension : str
        The name of the rows, which are counted from 0.
    columns : mapping
        Values, shape (n,), and unit of each column, by its name.
    attributes : mapping
        Attributes of the dataset.
    """
    import xarray  # noqa: PLC0415  (slow to import)

    length = len(next(iter(columns.values()))[0])
    return xarray.Dataset(
        {name: (dimension, values, {"units": unit}) for name, (values, unit) in columns.items()},
        coords={dimension: np.arange(length)},
        attrs=dict(attributes),
    )
