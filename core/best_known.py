"""Runs over one scenario beside each other: which of them is the best known, and what each is measured against.

A run is measured against the best that is known among those that arrive within the time of the timetable. A run that is
late, as one under speed limits may be, brings the optimum over its own time with it. A run that is proven
to be the optimum within the time stays the reference: a run on another mesh may need a hair less.

A run that misses a window of arrival which binds the optimum solves another problem: it is measured against nothing,
and no bound stands beside it.
"""

from collections.abc import Sequence
from dataclasses import replace

from railjoule.core.lower_bound import Reference, Window
from railjoule.core.trajectory import Trajectory

ON_TIME_S = 1e-3
"""A run that arrives later than this after a time is not within it: searches for a time end this close to it."""


def with_best_known(runs: Sequence[Trajectory]) -> list[Trajectory]:
    """Return runs over one scenario, each with its bound, or the first that covers it, and the best known run."""
    bounds = [run.bound for run in runs if run.bound is not None]
    windows = next((run.reference.windows for run in runs if run.reference is not None and run.reference.windows), ())
    kept = [run for run in runs if all(run.keeps(window) for window in windows)]
    return [
        replace(
            run,
            bound=run.bound or next((bound for bound in bounds if bound.covers(run)), None),
            reference=_reference(run, kept, windows),
        )
        if run in kept
        else replace(run, bound=None, reference=None)
        for run in runs
    ]


def _reference(run: Trajectory, runs: Sequence[Trajectory], windows: tuple[Window, ...]) -> Reference | None:
    """Return the reference of a run: the best of runs that keep the windows of arrival, as it does itself."""
    own, within = run.reference, run.scenario.travel_time_s
    if own is not None and own.within_s > within + ON_TIME_S:
        # a late run is not measured by the timetable, which it does not keep
        within = own.within_s

    def is_optimum(other: Trajectory) -> bool:
        # the bound of a run may be that of a shorter time
        return other.is_proven and other.reference is not None and other.reference.within_s >= within - ON_TIME_S

    # the optimum over less time than the timetable's is none over all of it
    known = [] if own is None or own.within_s < within - ON_TIME_S else [own]
    known += [
        Reference(other.energy.net_j, other.strategy, within, is_optimum(other), windows)
        for other in runs
        if other.travel_time_s <= within + ON_TIME_S
    ]
    # A proof holds on one mesh only. A run on a finer one may need a hair less, and would else turn the optimum into a
    # run "above the best known" by a difference that is none.
    proven = next((reference for reference in known if reference.proven), None)
    return proven or min(known, key=lambda reference: reference.energy_j, default=None)
