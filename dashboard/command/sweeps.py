"""`railjoule study sweep`: very many runs of a scenario whose numbers vary, as one table in a file."""

import shutil
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from railjoule.core.scenario import StrategyName
from railjoule.core.studies.sweep import DEFAULT_COLUMNS, Method, SweepTable, sweep
from railjoule.core.workspace import Workspace
from railjoule.core.written import require_writable
from railjoule.dashboard.command.commands import (
    CommandError,
    Output,
    announce_compilation,
    failures_named,
    load,
    shortened,
    table_file,
    write_table,
)

if TYPE_CHECKING:
    import argparse

# a number of 17 digits with sign, point and comma in text; in Parquet 8, and what little of repetition it saves
BYTES_A_NUMBER = {".csv": 20, ".parquet": 8}


def study_sweep(options: "argparse.Namespace", changes: Mapping[str, Any], own: Workspace | None = None) -> None:
    """Solve the rows of a sweep, write them as a table, and tell how many there are.

    Raises
    ------
    RailjouleError
        If anything is wrong with the scenario, a range, the sample or the file to write.
    """
    path, over = table_file(options.output, "-o"), parsed_ranges(options.over)
    columns = (*DEFAULT_COLUMNS, *options.columns)
    _require_disk(path, options.sample * (len(over) + len(columns)))
    scenario = load(options.file, changes, own)
    # before hours of runs, not after them
    with failures_named(path):
        require_writable(path)
    announce_compilation()
    table = sweep(
        scenario,
        over,
        options.sample,
        cast("Method", options.method),
        seed=options.seed,
        strategy=cast("StrategyName | None", options.strategy),
        columns=columns,
        progress=_progress(options.sample),
    )
    write_table(table.to_dataframe(), path, index=False)
    Output(options.json).show(summarise_sweep(table), lambda values: _text(str(path), values))


def summarise_sweep(table: SweepTable) -> dict[str, Any]:
    """Return what a sweep took as plain values."""
    return {
        "rows": table.rows,
        "without_run": len(table.reasons),
        "first_reason": next(iter(table.reasons.values()), None),
        "seconds": table.seconds,
        "runs_per_s": table.runs_per_s,
    }


def parsed_ranges(words: Sequence[str]) -> dict[str, tuple[float, float]]:
    """Return the ranges that 'field=low:high' words ask for.

    Raises
    ------
    CommandError
        If a word is none of that shape, or a field comes twice.
    """
    ranges: dict[str, tuple[float, float]] = {}
    for word in words:
        field, equals, ends = word.partition("=")
        low, colon, high = ends.partition(":")
        field = field.strip()
        try:
            if not (field and equals and colon):
                raise ValueError
            ranged = float(low), float(high)
        except ValueError:
            raise CommandError(
                f"--over {shortened(word)}: must be FIELD=LOW:HIGH, such as vehicle.load_factor=0:1."
            ) from None
        if field in ranges:
            raise CommandError(f"--over {shortened(word)}: {shortened(field)} is named twice.")
        ranges[field] = ranged
    return ranges


def _require_disk(path: Path, numbers: int) -> None:
    """Raise CommandError if a table of so many numbers does not fit beside a file."""
    with failures_named(path):
        free = shutil.disk_usage(path.parent).free
    needed = numbers * BYTES_A_NUMBER[path.suffix.lower()]
    if needed > free:
        raise CommandError(
            f"{shortened(str(path))} would take about {needed / 1e9:.3g} GB, and there are {free / 1e9:.3g} GB left."
        )


def _progress(rows: int) -> Callable[[int], None] | None:
    # not into a pipe or a file, whose readers look for errors
    if not sys.stderr.isatty():
        return None

    def show(done: int) -> None:
        end = "\n" if done == rows else ""
        print(f"\r{done:,} of {rows:,} runs", end=end, file=sys.stderr, flush=True)

    return show


def _text(name: str, values: Mapping[str, Any]) -> str:
    rows, seconds, rate = values["rows"], values["seconds"], values["runs_per_s"]
    told = f"{shortened(name)}: {rows:,} rows in {seconds:.1f} s, {rate:,.0f} a second"
    if values["without_run"]:
        told += f"\n{values['without_run']:,} of them without a run, such as: {values['first_reason']}"
    return told
