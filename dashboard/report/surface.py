"""The surface of ENOC's energy, which assets/scripts/surface.js draws and turns."""

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.dashboard.charts.surface import CIVIDIS, TALLEST, round_step
from railjoule.dashboard.look import words
from railjoule.dashboard.look.tokens import LIGHT
from railjoule.dashboard.pages.trade_off.compute import EnocMap

TICKS, CORNER_SHARE = 5, 0.06
MAX_NODES = 40
"""Along an axis: a finer surface looks the same, and the file has all its numbers."""
NEARER = 0.02
"""Lines and dots on faces are drawn as if they were so much nearer to the eye, in lengths of an axis."""
Piece = tuple[list[list[float]], str, float, str, float]
"""Places, colour and width of their line, colour within it (empty for none), how much nearer it counts."""


def enoc_surface(found: EnocMap, run: Trajectory | None = None) -> dict[str, Any]:
    """Return ENOC's energy over travel time and acceleration time, with its valley and its run.

    Places are shares of the axes of travel time [s], acceleration time [s] and energy [kWh], 0 to 1.
    """
    rows, columns = (_thinned(len(axis)) for axis in (found.acceleration_time_s, found.travel_time_s))
    energy = found.energy_kwh[np.ix_(rows, columns)]
    top = TALLEST * np.nanmin(energy)
    energy = np.where(energy > top, np.nan, energy)
    x, y = found.travel_time_s[columns], found.acceleration_time_s[rows]
    axes = [(float(np.nanmin(axis)), float(np.nanmax(axis))) for axis in (x, y, energy)]
    low, height = np.array(axes)[:, 0], np.ptp(np.array(axes), axis=1)

    def shares(places: FloatArray) -> list[list[float]]:
        kept = places[np.all((places >= low) & (places <= low + height), axis=1)]
        rounded: list[list[float]] = np.round((kept - low) / height, 4).tolist()
        return rounded

    valley = np.column_stack([found.travel_time_s, found.best_acceleration_s, found.best_energy_kwh])
    # the first phase of ENOC's run is the ramp
    place = [] if run is None else [[run.travel_time_s, run.phases[0].end_s, run.energy_kwh]]
    places = np.dstack([*np.meshgrid(x, y), energy])
    grid = np.round((places - low) / height, 4)
    dots = shares(np.reshape(place, (-1, 3)))
    caption = "ENOC: energy, kWh, over travel time and acceleration time; line: the best acceleration time"
    edges = " to ".join(words.energy(edge) for edge in axes[2])
    return {
        "caption": f"{caption}; dot: its run" if dots else caption,
        "alternative": f"{caption}, from {edges}; the arrow keys turn it",
        "titles": ["Travel time, s", "Acceleration time, s"],
        "ticks": [_ticks(*ends, show) for ends, show in zip(axes, (_whole, _whole, words.energy), strict=True)],
        "pieces": [*_faces(grid), *_lines(shares(valley)), *_dots(dots)],
    }


def _faces(grid: FloatArray) -> Iterator[Piece]:
    """Yield the faces between four places each, in the colours of their heights."""
    for rows in range(grid.shape[0] - 1):
        for columns in range(grid.shape[1] - 1):
            corners = grid[[rows, rows, rows + 1, rows + 1], [columns, columns + 1, columns + 1, columns]]
            if not np.any(np.isnan(corners)):
                colour = _shade(float(corners[:, 2].mean()))
                yield corners.tolist(), colour, 0.7, colour, 0


def _lines(places: Sequence[list[float]]) -> Iterator[Piece]:
    for ends in pairwise(places):
        yield list(ends), "#FFFFFF", 3, "", NEARER


def _dots(places: Sequence[list[float]]) -> Iterator[Piece]:
    """Yield a round mark with an edge for each place: a thick line with round ends."""
    for x, y, z in places:
        # a canvas draws no line without a length
        ends = [[x, y, z], [x, y, z + 1e-3]]
        yield ends, "#FFFFFF", 14, "", 2 * NEARER
        yield ends, LIGHT["accent"], 10, "", 3 * NEARER


def _shade(share: float) -> str:
    """Return the colour of a height."""
    parts = np.array([[int(colour[k : k + 2], 16) for k in (1, 3, 5)] for colour in CIVIDIS])
    steps = np.linspace(0, 1, len(CIVIDIS))
    return "#" + "".join(f"{round(float(np.interp(share, steps, part))):02X}" for part in parts.T)


def _whole(value: float) -> str:
    return words.number(value, 0)


def _ticks(low: float, high: float, show: Callable[[float], str]) -> list[tuple[float, str]]:
    """Return shares of an axis with round numbers, none at its corners, and their texts."""
    step = round_step((high - low) / TICKS)
    values = step * np.arange(np.ceil(low / step), np.floor(high / step) + 1)
    shares = (values - low) / (high - low)
    inside = (shares > CORNER_SHARE) & (shares < 1 - CORNER_SHARE)
    return [(share, show(value)) for share, value in zip(shares[inside].tolist(), values[inside].tolist(), strict=True)]


def _thinned(count: int) -> FloatArray:
    return np.unique(np.linspace(0, count - 1, min(count, MAX_NODES)).round().astype(int))
