"""Data of the figures of a table of runs, the shares of the inputs in the spread, and the preview of a study."""

import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from railjoule.core import RailjouleError, Scenario
from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.studies.rows import Chunk, worker_count
from railjoule.core.studies.sweep import MemoryResults, Study, SweepTable, make_study, sensitivities
from railjoule.core.studies.sweep.engine import solve_rows
from railjoule.core.studies.sweep.sobol import ROWS_PER_TERM
from railjoule.core.studies.sweep.table_files import read_study, write_rows
from railjoule.dashboard.work.run_table import Ends, RunTable

ENERGY = "energy_kwh"
MAX_POINTS = 50_000
"""With more runs the points are drawn as a raster."""
RASTER_PX = (440, 300)
BINS = 40
"""Of a histogram of many runs."""
CELLS = 5
"""Of the map, in each direction."""
QUANTILES = (0.05, 0.5, 0.95)
SHOWN = (0.0005, 0.9995)
"""Quantiles between which values are drawn."""
PREVIEW_RUNS, PREVIEW_S, MOST_PREVIEW_S = 64, 3.0, 12.0
"""Runs of a preview, intervals at which it is shown, and longest time for which it goes on beyond the first [s]."""
Bounds = Mapping[str, Ends]


@dataclass(frozen=True)
class LookRequest:
    """A view of a table: axes, colour and selection.

    Parameters
    ----------
    x, y, colour : str
        Columns of the horizontal axis, the vertical axis and the colours.
    map_x, map_y : str
        Inputs of the columns and rows of the map; empty where there is none.
    choice : mapping
        Bounds of the selected runs, by column.
    listed : int
        Number of selected runs that are listed.
    """

    x: str
    y: str
    colour: str
    map_x: str
    map_y: str
    choice: Bounds
    listed: int


@dataclass(frozen=True, eq=False)
class Raster:
    """Runs as a raster; arrays of shape (rows of pixels, columns of pixels), NaN and 0 where there is no run.

    `mean` and `count` are those of the selected runs, `others` is the number of all others.
    """

    mean: FloatArray
    count: IntArray
    others: IntArray


@dataclass(frozen=True, eq=False)
class Histogram:
    """Counts of values in all and in the selected runs, and the values at `QUANTILES`."""

    edges: FloatArray
    counts: IntArray
    held: IntArray
    places: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Medians:
    """Medians of the energy over two inputs: edges of the cells, and an array of shape (y, x) [kWh]."""

    x_edges: FloatArray
    y_edges: FloatArray
    kwh: FloatArray


@dataclass(frozen=True)
class Shares:
    """Sobol' indices, the greatest total first; shares of 1, with half an interval that holds 95 of 100.

    If they are not known, `refusal` is the reason.
    """

    fields: tuple[str, ...] = ()
    first: tuple[float, ...] = ()
    total: tuple[float, ...] = ()
    error: tuple[float, ...] = ()
    explained: float = 1.0
    refusal: str = ""


@dataclass(frozen=True, eq=False)
class Look:
    """Data of the figures of a table.

    Parameters
    ----------
    table : RunTable
    asked : LookRequest
    ends : mapping
        The ends of each column's axis.
    colour_ends : tuple of float
        The ends of the scale of colours.
    held : array of shape (feasible,)
        Whether each run is selected.
    raster : Raster or None
        The runs where they are too many for points.
    histograms : mapping
        By column.
    medians : Medians or None
    ranked : array
        Places in the table of the runs with the lowest and the highest energy.
    chosen : int
        Number of selected runs.
    listed : array
        Places of the first of them by their energy.
    middles : mapping
        Medians of the selected and of all runs, of the results that are drawn; empty without a selection.
    """

    table: RunTable
    asked: LookRequest
    ends: Bounds
    colour_ends: Ends = (0.0, 1.0)
    held: Any = None
    raster: Raster | None = None
    histograms: Mapping[str, Histogram] = field(default_factory=dict)
    medians: Medians | None = None
    ranked: Any = ()
    chosen: int = 0
    listed: Any = ()
    middles: Mapping[str, Ends] = field(default_factory=dict)

    @property
    def axes(self) -> tuple[str, str]:
        """The columns of the horizontal and the vertical axis."""
        return self.asked.x, self.asked.y


def compute_look(table: RunTable, asked: LookRequest) -> Look:
    """Return the data of the figures of a table of runs."""
    values, rows = table.values, table.rows
    if not len(rows):
        return Look(table, asked, dict.fromkeys(values, (0.0, 1.0)))
    ends = {name: axis_ends(column) for name, column in values.items()}
    by_energy = np.argsort(values[table.answer], kind="stable")
    held = within(values, asked.choice)
    chosen = by_energy[held[by_energy]]

    x, y, colour = values[asked.x], values[asked.y], values[asked.colour]
    drawn = dict.fromkeys((asked.y, asked.colour, table.answer)) if asked.choice and len(chosen) else {}
    results = (name for name in drawn if name not in table.inputs)
    middles = {name: (float(np.median(values[name][held])), float(np.median(values[name]))) for name in results}
    return Look(
        table,
        asked,
        ends,
        axis_ends(colour, room=0.0),
        held,
        None if len(rows) <= MAX_POINTS else raster(x, y, colour, held, (ends[asked.x], ends[asked.y]), RASTER_PX),
        {name: histogram(column, held, ends[name]) for name, column in values.items()},
        medians(table, asked.map_x, asked.map_y),
        by_energy[[0, -1]],
        len(chosen),
        chosen[: asked.listed],
        middles,
    )


def within(values: Mapping[str, FloatArray], choice: Bounds) -> Any:
    """Return whether each run lies within all bounds, the ends included."""
    held = np.ones(len(next(iter(values.values()))), dtype=bool)
    for name, (low, high) in choice.items():
        if name in values:
            held &= (values[name] >= low) & (values[name] <= high)
    return held


def axis_ends(values: FloatArray, room: float = 0.02) -> Ends:
    """Return the ends of an axis on which nearly all values lie."""
    known = values[np.isfinite(values)]
    if not len(known):
        return 0.0, 1.0
    low, high = (float(end) for end in np.quantile(known, SHOWN))
    # where all values are equal, the axis must still have a length
    wide = max(high - low, 1e-6 * max(abs(low), abs(high)), 1e-9)
    return low - room * wide, high + max(room, 1e-9) * wide


def raster(
    x: FloatArray, y: FloatArray, colour: FloatArray, held: Any, ends: tuple[Ends, Ends], size_px: tuple[int, int]
) -> Raster:
    """Return points as a raster: runs in each pixel, and the mean of their colour's values."""
    # slow to load and to compile, and needed only for many points
    import datashader  # noqa: PLC0415
    import pandas  # noqa: PLC0415

    canvas = datashader.Canvas(*size_px, x_range=ends[0], y_range=ends[1])
    frame = pandas.DataFrame({"x": x, "y": y, "colour": colour})
    asked = datashader.summary(count=datashader.count(), mean=datashader.mean("colour"))
    found = canvas.points(frame[held], "x", "y", agg=asked)
    others = canvas.points(frame[~held], "x", "y", agg=datashader.count())
    return Raster(np.asarray(found["mean"], dtype=float), np.asarray(found["count"], dtype=int), np.asarray(others))


def histogram(values: FloatArray, held: Any, ends: Ends) -> Histogram:
    """Return the histogram of values between the ends of an axis."""
    known = values[np.isfinite(values)]
    # few runs in many bins would look like a comb
    bins = int(np.clip(2 * np.sqrt(len(known)), 8, BINS))
    counts, edges = np.histogram(known, bins, ends)
    picked = counts if held.all() else np.histogram(values[held & np.isfinite(values)], bins, ends)[0]
    places = np.quantile(known, QUANTILES) if len(known) else ()
    return Histogram(edges, counts, picked, tuple(float(place) for place in places))


def medians(table: RunTable, x: str, y: str) -> Medians | None:
    """Return the median energy in cells of two inputs; None without two that vary."""
    ranges = [table.columns[name].range for name in (x, y) if name]
    if x == y or len(ranges) < 2 or any(ends is None or ends[0] == ends[1] for ends in ranges):
        return None
    edges = [np.linspace(*ends, CELLS + 1) for ends in ranges if ends is not None]
    column, row = (
        np.clip(np.searchsorted(edge, table.values[name], "right") - 1, 0, CELLS - 1)
        for edge, name in zip(edges, (x, y), strict=True)
    )
    cell, energy = row * CELLS + column, table.values[table.answer]
    order = np.argsort(cell, kind="stable")
    parts = np.split(energy[order], np.searchsorted(cell[order], np.arange(1, CELLS**2)))
    kwh = np.array([np.median(part) if len(part) else np.nan for part in parts]).reshape(CELLS, CELLS)
    return Medians(edges[0], edges[1], kwh)


def compute_shares(table: SweepTable) -> Shares:
    """Return the share of each input in the spread of the energy, or why it is not known."""
    try:
        found = sensitivities(table, ENERGY)
    except RailjouleError as refusal:
        return Shares(refusal=str(refusal))
    order = np.argsort(-found.total, kind="stable")
    columns = (found.first, found.total, np.maximum(found.first_error, 0.0))
    first, total, error = (tuple(float(values[k]) for k in order) for values in columns)
    return Shares(tuple(found.fields[k] for k in order), first, total, error, found.explained)


# ---- files


def table_file(table: SweepTable, suffix: str) -> BytesIO:
    """Return the file of all rows so far, as the command line writes it.

    Raises
    ------
    RailjouleError
        If the disk refuses.
    """
    with tempfile.TemporaryDirectory(prefix="railjoule-") as folder:
        path = Path(folder) / f"study{suffix}"
        try:
            write_rows(table, path)
            return BytesIO(path.read_bytes())
        except OSError as error:
            raise RailjouleError(f"The file cannot be written: {error.strerror or error}.") from None


@dataclass(frozen=True, eq=False)
class Opened:
    """A study from a file with its rows, and whether more can be added; or why it was not opened."""

    table: SweepTable | None = None
    results: MemoryResults | None = None
    is_same_solver: bool = True
    refusal: str = ""


def open_study(name: str, content: bytes, most_runs: int) -> Opened:
    """Return the study of a file."""
    try:
        table, is_same_solver = read_study(content, name, most_runs)
    except RailjouleError as refusal:
        return Opened(refusal=str(refusal))
    if ENERGY not in table.columns:
        return Opened(refusal=f"{name}: the column {ENERGY} is missing, without which a study is not shown.")
    results = MemoryResults(table.study)
    for chunk in table.chunks():
        results.append(chunk, 0.0)
    return Opened(table, results, is_same_solver)


# ---- before a study begins


@dataclass(frozen=True)
class Settings:
    """A study that may be begun: the arguments of `make_study`."""

    scenario: Scenario
    over: tuple[tuple[str, float, float], ...]
    sample: int
    method: str
    seed: int
    strategy: str
    columns: Sequence[str]

    def study(self) -> Study:
        """Return the study; raises ScenarioError if it is impossible."""
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


@dataclass(frozen=True, eq=False)
class Preview:
    """The first runs of a study, and its estimated duration on this computer [s]; or why it cannot be begun."""

    settings: Settings
    table: SweepTable | None = None
    seconds: float = 0.0
    refusal: str = ""


def preview_steps(settings: Settings) -> Iterator[Preview]:
    """Yield the first runs of a study, as many as its indices take, and an estimate of the time that all runs take."""
    try:
        study = settings.study()
    except RailjouleError as refusal:
        yield Preview(settings, refusal=str(refusal))
        return
    count = min(max(PREVIEW_RUNS, ROWS_PER_TERM * (len(study.fields) + 1)), study.sample)
    results, samples = MemoryResults(study), study.draw(0, count)
    # the first run loads the kernels and makes what all others share
    solve_rows(study, samples[:1])
    started, done, shown_s = time.perf_counter(), 0, 0.0
    while done < count:
        part = samples[done : done + 4]
        results.append(Chunk(done, part, solve_rows(study, part)), 0.0)
        done += len(part)
        passed_s = time.perf_counter() - started
        if done == count or passed_s >= shown_s + PREVIEW_S:
            shown_s, each_s = passed_s, passed_s / done
            yield Preview(settings, results.to_table(), each_s * study.sample / worker_count())
            if each_s * count > MOST_PREVIEW_S:
                return
