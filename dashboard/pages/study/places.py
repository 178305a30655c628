"""The figures of a study by name, and what of a look their shape depends on."""

from railjoule.dashboard.pages.study.compute import Look, Raster

RUNS, ALONG_X, ALONG_Y, MAP = FIGURES = ("study_runs", "study_along_x", "study_along_y", "study_map")


def shape_of(look: Look) -> tuple[object, ...]:
    """Return what must be the same where numbers are put into figures that are there."""
    cells = None if look.medians is None else (tuple(look.medians.x_edges), tuple(look.medians.y_edges))
    return (*look.request, isinstance(look.runs, Raster), look.along_x is None, look.along_y is None, cells)
