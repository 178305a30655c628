"""What the browser is sent of the lines of a chart."""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.dashboard.charts.run_lines import RunLines


def sent(chart: RunLines, line: str) -> tuple[FloatArray, FloatArray]:
    """Return the places and values from which the browser draws a line; none where it hides it."""
    chart.axis.settle("m", 0)
    drawn = chart.renderers[line]
    data = drawn.data_source.data
    x, y = (np.asarray(data[getattr(drawn.glyph, axis)], dtype=float) for axis in ("x", "y"))
    return (x, y) if drawn.visible else (x[:0], y[:0])
