"""`railjoule study sweep`: very many runs of a scenario whose numbers vary, as one table in a file."""

import argparse
import logging
import shutil
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tqdm import tqdm

from railjoule.core import RailjouleError
from railjoule.core.studies.sweep import (
    DEFAULT_COLUMNS,
    SensitivityError,
    Study,
    SweepFile,
    make_study,
    run_study,
    sensitivities,
    write_rows,
)
from railjoule.core.written import require_writable
from railjoule.dashboard.command import files
from railjoule.dashboard.command.cluster import cluster
from railjoule.dashboard.command.files import CommandError, failures_named, show
from railjoule.dashboard.command.values import shortened

RUNS_SUFFIX = ".runs"
"""Of the file that keeps the rows until all are done; it stands beside the table."""
# a number of 17 digits with sign, point and comma in text; else 8, and what little a format adds or packs
BYTES_A_NUMBER = {".csv": 20, ".parquet": 8, ".nc": 8}
BYTES_KEPT = 8
STOPPED = "stopped: {done:,} of {rows:,} rows are kept in {file}; --resume goes on with them."


def sweep(options: argparse.Namespace) -> None:
    """Solve the rows of a sweep, write them as a table, and tell how many there are.

    Raises
    ------
    RailjouleError
        If anything is wrong with the scenario, a range, the sample, the cluster or a file; what was done is kept.
    """
    path: Path = options.output
    kept = path.with_name(path.name + RUNS_SUFFIX)
    study = make_study(
        files.scenario(options),
        _ranges(options.over),
        options.sample,
        options.method,
        seed=options.seed,
        strategy=options.strategy,
        columns=(*DEFAULT_COLUMNS, *options.columns),
    )
    # before hours of runs, not after them
    with failures_named(path):
        require_writable(path)
    with _results(study, path, kept, options.resume) as results:
        try:
            _require_disk(path, study, results.done)
            _run(results, kept, options.scheduler)
            with failures_named(path):
                write_rows(results, path)
            summary = summarise_sweep(results)
        except RailjouleError:
            # a file without rows would only be in the way of the next try
            if not results.done:
                results.remove()
            raise
        results.remove()
    show(options, summary, lambda values: _text(path, values))


def summarise_sweep(results: SweepFile) -> dict[str, Any]:
    """Return time and size of a sweep and the influence of each field on its energy, as plain values."""
    without = [reason for chunk in results.chunks() for reason in chunk.reasons.values()]
    return {
        "rows": results.done,
        "without_run": len(without),
        "first_reason": without[0] if without else None,
        "seconds": results.seconds,
        "runs_per_s": results.done / results.seconds,
        "fingerprint": results.study.fingerprint,
        "sensitivities": _summarise_sensitivities(results),
    }


def _summarise_sensitivities(results: SweepFile) -> dict[str, Any] | None:
    """Return Sobol' indices of the energy by field; None if the rows do not determine them."""
    try:
        indices = sensitivities(results)
    except SensitivityError:
        return None
    names = ("first", "total", "first_error", "total_error")
    return {
        field: {name: float(getattr(indices, name)[place]) for name in names}
        for place, field in enumerate(indices.fields)
    }


def _ranges(given: Sequence[tuple[str, tuple[float, float]]]) -> dict[str, tuple[float, float]]:
    ranges = dict(given)
    for field in ranges:
        if sum(name == field for name, _ in given) > 1:
            raise CommandError(f"--over: {shortened(field)} is named twice.")
    return ranges


def _results(study: Study, path: Path, kept: Path, resume: bool) -> SweepFile:
    """Return the file of the rows: a new one, or that of an unfinished sweep."""
    if kept.exists():
        if resume:
            return SweepFile.open(kept, study)
        raise CommandError(
            f"{shortened(kept)} keeps the rows of a sweep that did not come to its end: --resume goes on with it; "
            "to begin again, remove it."
        )
    # a script that is started again and again always has --resume
    if resume and path.exists():
        raise CommandError(
            f"--resume: {shortened(path)} is there, and nothing is left to be done for it; without --resume it is "
            "made again."
        )
    return SweepFile.create(kept, study)


def _run(results: SweepFile, kept: Path, scheduler: str | None) -> None:
    rows = results.study.sample
    with _workers(scheduler) as (executor, workers), _progress(results) as progress:
        try:
            run_study(results, executor=executor, workers=workers, progress=progress)
        except KeyboardInterrupt:
            print(STOPPED.format(done=results.done, rows=rows, file=shortened(kept)), file=sys.stderr)
            raise


@contextmanager
def _workers(scheduler: str | None) -> Iterator[tuple[Executor | None, Callable[[], int] | None]]:
    if scheduler is None:
        yield None, None
        return
    # what Dask logs of a lost worker is no news: its chunks are done again, or the sweep gives the reason in a sentence
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with cluster(scheduler) as workers:
        yield workers


@contextmanager
def _progress(results: SweepFile) -> Iterator[Callable[[int], None]]:
    # not into a pipe or a file, whose readers look for errors
    hidden = not sys.stderr.isatty()
    with tqdm(total=results.study.sample, initial=results.done, unit=" runs", disable=hidden) as bar:

        def show_done(done: int) -> None:
            bar.update(done - bar.n)

        yield show_done


def _require_disk(path: Path, study: Study, done: int) -> None:
    """Raise CommandError if the rows of a study, kept until the table is written, do not fit on the disk beside it."""
    with failures_named(path):
        free = shutil.disk_usage(path.parent).free
    table = study.sample * study.width * BYTES_A_NUMBER[path.suffix.lower()]
    needed = table + (study.sample - done) * study.width * BYTES_KEPT
    if needed > free:
        raise CommandError(
            f"{shortened(path)} would take about {needed / 1e9:.3g} GB, with the rows kept until it is written, "
            f"and there are {free / 1e9:.3g} GB left."
        )


def _text(path: Path, values: Mapping[str, Any]) -> str:
    rows, seconds, rate = values["rows"], values["seconds"], values["runs_per_s"]
    lines = [f"{shortened(path)}: {rows:,} rows in {seconds:.1f} s, {rate:,.0f} a second"]
    if values["without_run"]:
        lines.append(f"{values['without_run']:,} of them without a run, such as: {values['first_reason']}")
    if values["sensitivities"]:
        lines.append("Share of the energy's spread by field, of itself and with the others (Sobol' indices):")
        widest = max(map(len, values["sensitivities"]))
        lines += [
            f"  {field:{widest}}  {100 * of['first']:5.1f} % ± {100 * of['first_error']:.1f}"
            f"  {100 * of['total']:5.1f} % ± {100 * of['total_error']:.1f}"
            for field, of in values["sensitivities"].items()
        ]
    return "\n".join(lines)
