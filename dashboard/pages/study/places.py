"""The figures of a study by name, and what of a look their shape depends on."""

from railjoule.dashboard.charts.surface import CIVIDIS
from railjoule.dashboard.pages.study.compute import Look, Raster

RUNS, ALONG_X, ALONG_Y, MAP = FIGURES = ("study_runs", "study_along_x", "study_along_y", "study_map")


def shape_of(look: Look) -> tuple[object, ...]:
    """Return what must be the same where numbers are put into figures that are there."""
    cells = None if look.medians is None else (tuple(look.medians.x_edges), tuple(look.medians.y_edges))
    return (*look.request, isinstance(look.runs, Raster), look.along_x is None, look.along_y is None, cells)


def colours_for(dark: bool) -> tuple[str, ...]:
    """Return the colours of runs, from the least number to the greatest."""
    # the darkest would not be seen on the dark sheet
    return CIVIDIS[2:] if dark else CIVIDIS
