"""What is looked at of a study: numbers, points or a raster of them, histograms, a map, shares, and the chosen runs.

All of it is worked out in a process of its own, as is the estimate of a study that is still to begin.
"""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from railjoule.core import RailjouleError, Scenario
from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.studies.rows import worker_count
from railjoule.core.studies.sweep import Study, SweepTable, make_study, sensitivities
from railjoule.core.studies.sweep.engine import solve_rows
from railjoule.core.studies.sweep.table_files import write_rows
from railjoule.core.units import J_PER_WH
from railjoule.dashboard.look import words

ENERGY = "energy_kwh"
MAX_POINTS = 50_000
"""With more runs the points are drawn as a raster."""
BINS = 40
CELLS = 5
"""Of the map, in each direction."""
QUANTILES = (0.05, 0.5, 0.95)
SHOWN = (0.0005, 0.9995)
"""Of the values this part is drawn."""
TRIED, TRIED_S = 24, 0.6
"""An estimate is made of so many runs, or of those that this time takes [s]."""
Bounds = Mapping[str, tuple[float, float]]


@dataclass(frozen=True)
class ResultColumn:
    """How a result is told.

    Parameters
    ----------
    words : str
        Quantity and unit, as on an axis.
    show : callable
        How a number in that unit reads.
    scale : float
        What a number of the table is multiplied by for that unit.
    """

    words: str
    show: Callable[[float], str]
    scale: float = 1.0


RESULTS: Mapping[str, ResultColumn] = {
    ENERGY: ResultColumn("Energy, kWh", words.energy),
    "lower_bound_kwh": ResultColumn("Lower bound, kWh", words.energy),
    "travel_time_s": ResultColumn("Time of the run, s", words.time),
    "price_of_time_w": ResultColumn("Extra second saves, Wh/s", partial(words.number, digits=1), 1 / J_PER_WH),
    "max_speed_kmh": ResultColumn("Highest speed, km/h", partial(words.number, digits=1)),
    "traction_energy_kwh": ResultColumn("Energy for traction, kWh", words.energy),
    "recuperated_kwh": ResultColumn("Recuperated, kWh", words.energy),
    "auxiliary_kwh": ResultColumn("Auxiliaries, kWh", words.energy),
    "running_resistance_kwh": ResultColumn("Running resistance, kWh", words.energy),
    "curve_resistance_kwh": ResultColumn("Curves, kWh", words.energy),
    "kinetic_kwh": ResultColumn("Kinetic energy, kWh", words.energy),
    "potential_kwh": ResultColumn("Potential energy, kWh", words.energy),
    "losses_kwh": ResultColumn("Losses, kWh", words.energy),
    "brake_resistors_kwh": ResultColumn("Brake resistors, kWh", words.energy),
    "friction_brakes_kwh": ResultColumn("Friction brakes, kWh", words.energy),
}
"""What may come out of a run, by the names of a sweep's columns."""


@dataclass(frozen=True, eq=False)
class LookRequest:
    """What is to be looked at of a table.

    Parameters
    ----------
    table : SweepTable
        The rows so far.
    x, y, colour : str
        Columns: to the right, upwards, in colours.
    map_x, map_y : str
        The fields of the map.
    choice : mapping
        Bounds by column, of the runs that are chosen.
    shown : int
        How many of them are listed.
    raster_px : tuple of int
        Width and height of a raster.
    """

    table: SweepTable
    x: str
    y: str
    colour: str
    map_x: str
    map_y: str
    choice: Bounds
    shown: int
    raster_px: tuple[int, int]


@dataclass(frozen=True, eq=False)
class Points:
    """Runs as points; arrays of shape (runs,), the numbers of the rows among them."""

    x: FloatArray
    y: FloatArray
    colour: FloatArray
    row: IntArray


@dataclass(frozen=True, eq=False)
class Raster:
    """Runs as a raster; arrays of shape (rows of pixels, columns of pixels), NaN and 0 where there is no run."""

    mean: FloatArray
    count: IntArray


@dataclass(frozen=True, eq=False)
class Histogram:
    """How often values came out, with the values at `QUANTILES`."""

    edges: FloatArray
    counts: IntArray
    places: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Medians:
    """Medians of the energy over two fields: edges of the cells, and an array of shape (y, x) [kWh]."""

    x_edges: FloatArray
    y_edges: FloatArray
    kwh: FloatArray


@dataclass(frozen=True)
class Shares:
    """Sobol' indices, the greatest total first; shares of 1, with half an interval that holds 95 of 100."""

    fields: tuple[str, ...]
    first: tuple[float, ...]
    total: tuple[float, ...]
    error: tuple[float, ...]
    explained: float


@dataclass(frozen=True)
class Listed:
    """A run in the list: the number of its row, and its values in the order of the columns."""

    row: int
    values: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Look:
    """What is drawn of a study.

    Parameters
    ----------
    request : tuple of str
        Columns to the right, upwards, in colours, and both fields of the map.
    done, driven : int
        Rows that are done, and those of them with a run.
    ends : tuple of two pairs
        What both axes show.
    colour_ends : pair
        What the colours show.
    runs : Points or Raster or None
        What is drawn; None where there is no run.
    along_x, along_y : Histogram or None
    medians : Medians or None
    shares : Shares or None
        What each field decides of the energy.
    shares_refusal : str
        Why that is not known.
    lowest, median, highest : Listed or None
        By their energy.
    choice : mapping
        Bounds by column, of the runs that are chosen.
    chosen : int
        How many they are.
    listed : tuple of Listed
        The first of them by their energy.
    reason : str
        Why the first row without a run has none.
    """

    request: tuple[str, str, str, str, str]
    done: int
    driven: int
    ends: tuple[tuple[float, float], tuple[float, float]]
    colour_ends: tuple[float, float]
    runs: Points | Raster | None
    along_x: Histogram | None
    along_y: Histogram | None
    medians: Medians | None
    shares: Shares | None
    shares_refusal: str
    lowest: Listed | None
    median: Listed | None
    highest: Listed | None
    choice: Bounds
    chosen: int
    listed: tuple[Listed, ...]
    reason: str


def compute_look(request: LookRequest) -> Look:
    """Return what is drawn of a study's rows so far."""
    table = request.table
    everything = {**table.samples, **{name: RESULTS[name].scale * told for name, told in table.columns.items()}}
    driven = np.isfinite(everything[ENERGY])
    values = {name: column[driven] for name, column in everything.items()}
    rows = table.index[driven]
    names = request.x, request.y, request.colour, request.map_x, request.map_y
    shares, refusal = _shares(table)
    reason = next(iter(table.reasons.values()), "")
    count = len(rows)
    if not count:
        nothing = ((0.0, 1.0), (0.0, 1.0))
        none = (None,) * 3
        return Look(
            names, table.rows, 0, nothing, (0.0, 1.0), *none, None, None, refusal, *none, request.choice, 0, (), reason
        )
    x, y, colour = values[request.x], values[request.y], values[request.colour]
    ends = _ends(x), _ends(y)
    by_energy = np.argsort(values[ENERGY], kind="stable")
    lowest, median, highest = (_listed(values, rows, by_energy[place]) for place in (0, (count - 1) // 2, count - 1))
    held = by_energy[_held(values, request.choice)[by_energy]]
    return Look(
        names,
        table.rows,
        count,
        ends,
        _ends(colour, room=0.0),
        Points(x, y, colour, rows) if count <= MAX_POINTS else raster_of(x, y, colour, ends, request.raster_px),
        histogram_of(x, ends[0]),
        histogram_of(y, ends[1]),
        medians_of(table.study, values, request.map_x, request.map_y),
        shares,
        refusal,
        lowest,
        median,
        highest,
        request.choice,
        len(held),
        tuple(_listed(values, rows, place) for place in held[: request.shown]),
        reason,
    )


def _listed(values: Mapping[str, FloatArray], rows: IntArray, place: int) -> Listed:
    return Listed(int(rows[place]), tuple(float(column[place]) for column in values.values()))


def _held(values: Mapping[str, FloatArray], choice: Bounds) -> Any:
    held = np.ones(len(next(iter(values.values()))), dtype=bool)
    for name, (low, high) in choice.items():
        if name in values:
            held &= (values[name] >= low) & (values[name] <= high)
    return held


def _ends(values: FloatArray, room: float = 0.02) -> tuple[float, float]:
    """Return the ends of an axis on which nearly all values lie."""
    known = values[np.isfinite(values)]
    if not len(known):
        return 0.0, 1.0
    low, high = (float(end) for end in np.quantile(known, SHOWN))
    # where all values are one, the axis must still have a length
    wide = max(high - low, 1e-6 * max(abs(low), abs(high)), 1e-9)
    return low - room * wide, high + max(room, 1e-9) * wide


def raster_of(
    x: FloatArray,
    y: FloatArray,
    colour: FloatArray,
    ends: tuple[tuple[float, float], tuple[float, float]],
    size_px: tuple[int, int],
) -> Raster:
    """Return points as a raster: how many runs each pixel holds, and the mean of their colour's values."""
    # slow to load and to compile, and needed for many points alone
    import datashader  # noqa: PLC0415
    import pandas  # noqa: PLC0415

    canvas = datashader.Canvas(*size_px, x_range=ends[0], y_range=ends[1])
    frame = pandas.DataFrame({"x": x, "y": y, "colour": colour})
    counted = datashader.summary(count=datashader.count(), mean=datashader.mean("colour"))
    found = canvas.points(frame, "x", "y", agg=counted)
    return Raster(np.asarray(found["mean"], dtype=float), np.asarray(found["count"], dtype=np.int64))


def histogram_of(values: FloatArray, ends: tuple[float, float]) -> Histogram | None:
    """Return how often values came out between the ends of an axis."""
    known = values[np.isfinite(values)]
    if not len(known):
        return None
    counts, edges = np.histogram(known, bins=BINS, range=ends)
    return Histogram(edges, counts, tuple(float(place) for place in np.quantile(known, QUANTILES)))


def medians_of(study: Study, values: Mapping[str, FloatArray], x: str, y: str) -> Medians | None:
    """Return the median energy in cells of two fields; None where there is one field alone."""
    ranges = {field.name: (field.low, field.high) for field in study.fields}
    if x == y or any(low == high for low, high in (ranges[x], ranges[y])):
        return None
    edges = [np.linspace(*ranges[name], CELLS + 1) for name in (x, y)]
    column, row = (
        np.clip(np.searchsorted(edge, values[name], "right") - 1, 0, CELLS - 1)
        for edge, name in zip(edges, (x, y), strict=True)
    )
    cell, energy = row * CELLS + column, values[ENERGY]
    order = np.argsort(cell, kind="stable")
    parts = np.split(energy[order], np.searchsorted(cell[order], np.arange(1, CELLS**2)))
    kwh = np.array([np.median(part) if len(part) else np.nan for part in parts]).reshape(CELLS, CELLS)
    return Medians(edges[0], edges[1], kwh)


def _shares(table: SweepTable) -> tuple[Shares | None, str]:
    """Return what each field decides of the energy, or why that is not known."""
    try:
        found = sensitivities(table, ENERGY)
    except RailjouleError as refusal:
        return None, str(refusal)
    order = np.argsort(-found.total, kind="stable")

    def ranked(values: FloatArray) -> tuple[float, ...]:
        return tuple(float(values[k]) for k in order)

    errors = np.maximum(found.first_error, 0.0)
    names = tuple(found.fields[k] for k in order)
    return Shares(names, ranked(found.first), ranked(found.total), ranked(errors), found.explained), ""


def write_table(table: SweepTable, path: Path) -> None:
    """Write all rows so far as the command line writes them; raises RailjouleError where the disk refuses."""
    try:
        write_rows(table, path)
    except OSError as error:
        raise RailjouleError(f"The file cannot be written: {error.strerror or error}.") from None


# ---- before it begins


@dataclass(frozen=True)
class EstimateRequest:
    """A study that may be begun: as `make_study` takes it."""

    scenario: Scenario
    over: tuple[tuple[str, float, float], ...]
    sample: int
    method: str
    seed: int
    strategy: str
    columns: Sequence[str]

    def study(self) -> Study:
        """Return the study; raises ScenarioError if anything of it cannot be."""
        over = {path: (low, high) for path, low, high in self.over}
        return make_study(
            self.scenario,
            over,
            self.sample,
            self.method,
            seed=self.seed,
            strategy=self.strategy,
            columns=self.columns,
        )


@dataclass(frozen=True)
class Estimate:
    """How long a study takes [s] on this computer; None, with the reason, where it cannot be begun."""

    request: EstimateRequest
    seconds: float | None
    refusal: str = ""


def compute_estimate(request: EstimateRequest) -> Estimate:
    """Return how long a study takes, by a few of its runs."""
    try:
        study = request.study()
    except RailjouleError as refusal:
        return Estimate(request, None, str(refusal))
    samples = study.draw(0, min(TRIED, study.sample))
    # the first run loads the kernels and makes what all others share
    solve_rows(study, samples[:1])
    started, count = time.perf_counter(), 0
    for row in range(len(samples)):
        solve_rows(study, samples[row : row + 1])
        count += 1
        if time.perf_counter() - started > TRIED_S:
            break
    each_s = (time.perf_counter() - started) / max(count, 1)
    return Estimate(request, each_s * study.sample / worker_count())
