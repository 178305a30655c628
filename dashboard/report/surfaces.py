"""The surfaces of a report: what they show, and their places; a script of its own draws and turns them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from railjoule.core import Trajectory
from railjoule.core.arrays import FloatArray
from railjoule.core.studies.table import StudyTable
from railjoule.dashboard.charts.surface import CIVIDIS, TALLEST, round_step
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, markup
from railjoule.dashboard.look.tokens import COST_SCALES, ThemeName
from railjoule.dashboard.pages.trade_off.compute import EnocMap
from railjoule.dashboard.report.findings import Findings

TICKS, CORNER_SHARE = 5, 0.06
MAX_NODES = 40
"""Along an axis: a finer surface looks the same, and the file has all its numbers."""


def _none() -> FloatArray:
    return np.empty((0, 3))


@dataclass(frozen=True, eq=False)
class Surface:
    """A surface over two axes.

    Parameters
    ----------
    name : str
        Of its place in the file.
    caption : str
        What it shows.
    x, y : array of shape (m,), (k,)
        Its axes, rising evenly.
    z : array of shape (k, m)
        Its heights; NaN where there are none.
    titles : pair of str
        What the axes are.
    show : pair of callables
        Write a number of an axis, and a height.
    scale : mapping
        Colours from low to high, by theme.
    line, points : array of shape (n, 3)
        Places on the surface that are joined by a line, and such that stand alone: x, y and height of each.
    """

    name: str
    caption: str
    x: FloatArray
    y: FloatArray
    z: FloatArray
    titles: tuple[str, str]
    show: tuple[Callable[[float], str], Callable[[float], str]]
    scale: Mapping[ThemeName, Sequence[str]]
    line: FloatArray = field(default_factory=_none)
    points: FloatArray = field(default_factory=_none)

    @property
    def element(self) -> Markup:
        """Its place in the file."""
        low, high = (self.show[1](float(edge)) for edge in (np.nanmin(self.z), np.nanmax(self.z)))
        return markup(
            '<figure class="surface"><figcaption>{caption}</figcaption><canvas data-surface="{name}" tabindex="0" '
            'role="img" aria-label="{caption}, from {low} to {high}; the arrow keys turn it"></canvas></figure>',
            caption=self.caption,
            name=self.name,
            low=low,
            high=high,
        )

    @property
    def data(self) -> dict[str, Any]:
        """What the script draws."""
        across, up = self.show
        low, high = float(np.nanmin(self.z)), float(np.nanmax(self.z))
        return {
            "x": self.x.tolist(),
            "y": self.y.tolist(),
            # JSON knows no NaN; five digits are more than a surface can show, and keep the file small
            "z": [[None if np.isnan(value) else float(f"{value:.5g}") for value in row] for row in self.z],
            "titles": self.titles,
            "ticks": {
                "x": _ticks(float(self.x[0]), float(self.x[-1]), across),
                "y": _ticks(float(self.y[0]), float(self.y[-1]), across),
                "z": _ticks(low, high, up),
            },
            "line": self.line.tolist(),
            "points": self.points.tolist(),
            "scale": {theme: list(colours) for theme, colours in self.scale.items()},
        }


def _ticks(low: float, high: float, show: Callable[[float], str]) -> list[tuple[float, str]]:
    """Return where along an axis ticks lie, as shares of it, and their texts: round numbers, none at the corners."""
    # where all values are one, ticks must still have a step
    height = max(high - low, 1e-12)
    step = round_step(height / TICKS)
    values = step * np.arange(np.ceil(low / step), np.floor(high / step) + 1)
    shares = (values - low) / height
    inside = (shares > CORNER_SHARE) & (shares < 1 - CORNER_SHARE)
    ticks = zip(shares[inside].tolist(), values[inside].tolist(), strict=True)
    return [(share, show(value)) for share, value in ticks]


def enoc_surface(found: EnocMap, run: Trajectory | None = None) -> Surface:
    """Return ENOC's energy over travel time and acceleration time, with its valley and the place of ENOC's run."""
    rows, columns = (_thinned(len(axis)) for axis in (found.acceleration_time_s, found.travel_time_s))
    energy = found.energy_kwh[np.ix_(rows, columns)]
    top = TALLEST * np.nanmin(energy)
    energy = np.where(energy > top, np.nan, energy)
    valley = np.column_stack([found.travel_time_s, found.best_acceleration_s, found.best_energy_kwh])
    # its first phase is the ramp
    place = [] if run is None else [[run.travel_time_s, run.phases[0].end_s, run.energy_kwh]]
    caption = "ENOC: energy, kWh, over travel time and acceleration time; line: the best acceleration time"
    return Surface(
        "enoc",
        f"{caption}; dot: its run" if place else caption,
        found.travel_time_s[columns],
        found.acceleration_time_s[rows],
        energy,
        ("Travel time, s", "Acceleration time, s"),
        (lambda value: words.number(value, 0), words.energy),
        {"light": CIVIDIS, "dark": CIVIDIS},
        _inside(valley, found, top),
        _inside(np.reshape(place, (-1, 3)), found, top),
    )


def _inside(places: FloatArray, found: EnocMap, top: float) -> FloatArray:
    """Return those places that lie on the map, beneath the height at which it is cut."""
    kept = places[:, 2] <= top
    for column, axis in enumerate((found.travel_time_s, found.acceleration_time_s)):
        kept &= (places[:, column] >= axis[0]) & (places[:, column] <= axis[-1])
    return places[kept]


def cost_surface(table: StudyTable) -> Surface | None:
    """Return the overconsumption over load and position error; None where no cell of the table could be driven."""
    missed = comparisons.is_false_saving(table.energy_kwh, table.planned_energy_kwh, table.delay_s, table.stop_error_m)
    share = np.where(missed, np.nan, table.overconsumption)
    if not np.any(np.isfinite(share)):
        return None
    return Surface(
        "costs",
        "Overconsumption, %, over load and position error",
        np.array(table.coordinate_error_m),
        100 * np.array(table.load_factor),
        100 * share,
        ("Position error, m", "Load, %"),
        (lambda value: words.number(value, 0), lambda value: words.share_difference(value / 100)),
        COST_SCALES,
    )


def _thinned(count: int) -> FloatArray:
    return np.unique(np.linspace(0, count - 1, min(count, MAX_NODES)).round().astype(int))


def surfaces_of(findings: Findings) -> dict[str, Surface]:
    """Return the surfaces that a report shows, by the names of their places."""
    run = findings.runs.runs.get("enoc")
    found = [enoc_surface(findings.enoc_map, run)] if findings.enoc_map is not None else []
    costs = cost_surface(findings.table) if findings.table is not None else None
    return {surface.name: surface for surface in [*found, *([costs] if costs else [])]}
