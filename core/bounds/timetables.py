"""What bounds of several timetables of one scenario say of one another.

A bound holds for all runs within its time, so that one of a longer time holds for every shorter one as well. The least
energy never rises with the time; what is proven of it may, where a proof happens to be tighter at the longer time.
"""

from collections.abc import Sequence

import numpy as np

from railjoule.core.trajectory import Bound


def strongest_bounds(bounds: Sequence[Bound]) -> list[Bound]:
    """Return for each bound of a scenario the greatest of all that cover whatever it covers.

    Parameters
    ----------
    bounds : sequence of Bound
        Of the same scenario but for the timetable's times, in any order; one over a mesh says nothing of other meshes.

    Returns
    -------
    list of Bound
        In the same order, each a given one with its own statement. Over one mesh they do not rise with the time.
    """
    return [
        max((other for other in bounds if _includes(other, own)), key=lambda bound: bound.energy_j) for own in bounds
    ]


def _includes(other: Bound, own: Bound) -> bool:
    """Return whether all runs that a bound covers are covered by another one, too."""
    # the numbers first: they rule out half of all pairs
    return (
        other.travel_time_s >= own.travel_time_s
        and other.energy_j >= own.energy_j
        and set(other.windows) <= set(own.windows)
        and _covers_mesh(other, own)
    )


def _covers_mesh(other: Bound, own: Bound) -> bool:
    """Return whether a bound holds over every mesh, or over that of another one for runs that are as slow."""
    if other.position_m is None or own.position_m is None:
        return other.position_m is None
    return np.array_equal(other.position_m, own.position_m) and bool(np.all(other.slowest_ms <= own.slowest_ms))
