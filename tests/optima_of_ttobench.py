"""Certified optima of all tracks of TTOBench with all its trains: `python -m tests.optima_of_ttobench > OUT.csv`.

No optimum of these tracks has been published but one, for which two solvers agree. Each row is a track and a train as
their files state them (all stops, no dwells, at rest at both ends), in 1.1 times its shortest time, over the mesh that
`MESH_M` gives, refined towards the tolerance of the solver; a journey has no other choices. The energy is that of the
line without auxiliaries; the bound is what no driving of the train undercuts. The table lies in
assets/docs/ttobench_optima.csv, and a test computes some of its rows again.
"""

import csv
import sys
from collections.abc import Iterator
from time import perf_counter

from railjoule.core import Scenario, solve
from railjoule.core.errors import RailjouleError
from railjoule.core.imports.source_file import SourceFile
from railjoule.core.imports.ttobench.track import read_ttobench
from railjoule.core.motion import max_speeds
from railjoule.core.scenario import scenario_from_document
from railjoule.core.task import prepare_task
from tests.ttobench import ABSENT, TRACKS, TRAINS, track_names, train_names

RESERVE = 1.1
"""Travel time over the shortest one."""
MESH_M = 20.0
COLUMNS = (
    *("track", "train", "length_m", "stops", "mesh_m", "cells", "shortest_time_s", "travel_time_s"),
    *("energy_kwh", "lower_bound_kwh", "gap", "price_of_time_wh_per_s"),
)
# a first call of a kernel reads it from the cache
REPEATS = 5


def scenario_of(track: str, train: str, travel_time_s: float = 86_400.0) -> Scenario:
    """Return a track with a train; a day where no time is given."""
    files = SourceFile.read(TRACKS / f"{track}.json"), SourceFile.read(TRAINS / f"{train}.json")
    found = read_ttobench(*files, travel_time_s=travel_time_s)
    return scenario_from_document({**found.document, "solver": {"mesh_m": MESH_M}})


def row_of(track: str, train: str) -> dict[str, str]:
    """Return a row of the table as texts."""
    shortest_s = prepare_task(scenario_of(track, train)).shortest_time_s
    scenario = scenario_of(track, train, round(RESERVE * shortest_s, 1))
    run = solve(scenario)
    assert run.lower_bound_kwh is not None
    assert run.gap is not None
    assert run.price_of_time_w is not None
    values = (
        *(track, train, f"{scenario.line.length_m:.1f}", str(len(scenario.line.inner_stations)), f"{MESH_M:g}"),
        *(str(len(run.effort_n)), f"{shortest_s:.3f}", f"{scenario.travel_time_s:.1f}", f"{run.energy_kwh:.5f}"),
        *(f"{run.lower_bound_kwh:.5f}", f"{run.gap:.1e}", f"{run.price_of_time_w / 3600:.3f}"),
    )
    return dict(zip(COLUMNS, values, strict=True))


def rows() -> Iterator[dict[str, str]]:
    """Yield all rows; a pair that has no run is told on standard error."""
    for track in track_names():
        for train in train_names():
            try:
                yield row_of(track, train)
            except RailjouleError as error:
                print(f"{track}, {train}: {error}", file=sys.stderr)


def fastest_ms(track: str, train: str) -> float:
    """Return the least time of some calls that find the fastest run of a track and a train [ms]."""
    mesh = prepare_task(scenario_of(track, train)).mesh
    seconds = []
    for _ in range(REPEATS):
        started = perf_counter()
        max_speeds(mesh.data)
        seconds.append(perf_counter() - started)
    return 1e3 * min(seconds)


def main() -> None:
    """Print the table."""
    if not TRACKS.is_dir():
        sys.exit(f"There is nothing to solve: {ABSENT}.")
    table = csv.DictWriter(sys.stdout, COLUMNS, lineterminator="\n")
    table.writeheader()
    for row in rows():
        table.writerow(row)
        sys.stdout.flush()
    slowest = max(fastest_ms(track, train) for track in track_names() for train in train_names())
    print(f"The fastest run of each pair takes at most {slowest:.2f} ms.", file=sys.stderr)


if __name__ == "__main__":
    main()
