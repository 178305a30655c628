"""The table of a study: columns of numbers over labelled dimensions, with units."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.scenario import Scenario

if TYPE_CHECKING:
    import pandas
    import xarray

UNITS = {"_wh_per_s": "Wh/s", "_kwh": "kWh", "_m": "m", "_s": "s", "_a": "A", "_v": "V"}
"""Units by the end of a column's name; the first that fits counts."""


@dataclass(frozen=True, eq=False)
class StudyTable:
    """Columns of numbers over labelled dimensions; labels, columns and attributes are also read as `table.name`.

    Parameters
    ----------
    scenario : Scenario
    labels : mapping of str to sequence
        Labels of each dimension by its name, in the order of the axes of the columns.
    columns : mapping of str to array
        Values by name, copied and frozen; NaN where there is none. A column may lack the last dimensions.
    attributes : mapping of str to value
        Facts about the whole table.
    done : int
        Completed rows or cells.
    """

    scenario: Scenario
    labels: Mapping[str, Any]
    columns: Mapping[str, Any]
    attributes: Mapping[str, Any] = field(default_factory=dict)
    done: int = 0

    def __post_init__(self) -> None:
        frozen = {name: np.array(values) for name, values in self.columns.items()}
        for array in frozen.values():
            array.setflags(write=False)
        object.__setattr__(self, "columns", frozen)

    def __getitem__(self, name: str) -> FloatArray:
        """Return a column."""
        column: FloatArray = self.columns[name]
        return column

    def __getattr__(self, name: str) -> Any:
        """Return a column, labels or an attribute."""
        # `vars`, as an object that is being unpickled has no fields yet
        for group in ("columns", "labels", "attributes"):
            if name in vars(self).get(group, ()):
                return vars(self)[group][name]
        raise AttributeError(f"the table of the study has no {name}.")

    def to_xarray(self) -> "xarray.Dataset":
        """Return the table with labels and units; a tuple of notes becomes one text."""
        import xarray  # noqa: PLC0415  (slow to import)

        dimensions = tuple(self.labels)
        columns = {
            name: (dimensions[: np.ndim(values)], values, {"units": unit(name)})
            for name, values in self.columns.items()
        }
        texts = {name: " ".join(of) if isinstance(of, tuple) else of for name, of in self.attributes.items()}
        return xarray.Dataset(columns, {name: list(labels) for name, labels in self.labels.items()}, texts)

    def to_dataframe(self) -> "pandas.DataFrame":
        """Return the table with its labels as index."""
        return self.to_xarray().to_dataframe()


def unit(column: str) -> str:
    """Return the unit in which the name of a column ends, or "1"."""
    return next((unit for end, unit in UNITS.items() if column.endswith(end)), "1")
