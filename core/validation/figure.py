"""Printed figures of a paper, rebuilt from runs: printed numbers as points, those of railjoule as lines."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from railjoule.core.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Line:
    """One curve of a panel.

    Parameters
    ----------
    label : str
        Its entry in the legend.
    x, y : array of shape (n,)
        In the units of the panel's axes.
    is_printed : bool
        Whether the paper prints these numbers; they are drawn as points.
    """

    label: str
    x: FloatArray
    y: FloatArray
    is_printed: bool = False


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes.

    Parameters
    ----------
    x_title, y_title : str
        Quantity and unit of each axis, such as 'Speed, km/h'.
    lines : tuple of Line
    """

    x_title: str
    y_title: str
    lines: tuple[Line, ...]


@dataclass(frozen=True, eq=False)
class FigureData:
    """The content of a rebuilt figure.

    Parameters
    ----------
    panels : tuple of Panel
    note : str
        One or two sentences on agreement with the print.
    """

    panels: tuple[Panel, ...]
    note: str = ""


@dataclass(frozen=True)
class PaperFigure:
    """A printed figure that can be rebuilt.

    Parameters
    ----------
    place : str
        Its name in the paper, such as 'Fig. 4'; figures that are drawn together share one entry.
    caption : str
        Its content.
    compute : callable
        Returns its `FigureData`; takes seconds.
    scenario : str
        Name of the scenario that the workbench opens.
    changes : mapping
        Fields of the scenario that differ there, by dotted path as in `Scenario.with_`.
    """

    place: str
    caption: str
    compute: Callable[[], FigureData]
    scenario: str
    changes: Mapping[str, Any] = field(default_factory=dict)
