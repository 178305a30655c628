"""Decisions that keep a drive on or off for a minimum time, by backward induction in a band of speeds.

A label is what the drive does (off, driving, braking) and for how many cells it still has to, see `labels`. The minimum
number of cells of a stretch follows from the times of the run in the middle of the band, to the nearest cell.

The result is a decision to be solved and no run: forward, speeds are carried from grid point to grid point.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import has_standstill_brake
from railjoule.core.dynamic_programming.grid import speed_band
from railjoule.core.dynamic_programming.labels import Labels, on_off_labels
from railjoule.core.dynamic_programming.power_table import tabulate_powers
from railjoule.core.dynamic_programming.recursion import sweep_back
from railjoule.core.dynamic_programming.search import TINY, log_price_range, meeting_prices
from railjoule.core.dynamic_programming.steps import Steps, tabulate_steps
from railjoule.core.physics.mesh_data import BRAKE, OFF, MeshData
from railjoule.core.physics.stretches import NEUTRAL_SECTION, actions_of_run, min_stretch_cells

# A kernel's table grows with them. More than so many come where cells are short, next to stops, where a train that
# starts or brakes stays as it is anyway
MAX_BOUND_CELLS = 32
"""For how many cells a stretch is held to last, at most."""
# The decision's own solution meets the time: only what it does where has to be about right
TIME_TOLERANCE = 1e-2
"""How close to the running time a decision's run must come to end the search for its price, as a share of it."""
MAX_LATE = 2.0
"""A run that ends early counts as taking this many running times, so that the bracket stays finite."""


@njit(cache=True, error_model="numpy")
def _nearest(row: FloatArray, speed2: float, policy: IntArray) -> int:
    """Return the point of a row closest to a square of speed from which a step leads on; -1 if there is none."""
    found, distance = -1, math.inf
    for k in range(row.shape[0]):
        if policy[k] >= 0 and abs(row[k] - speed2) < distance:
            found, distance = k, abs(row[k] - speed2)
    return found


@njit(cache=True, error_model="numpy", nogil=True)
def follow(
    steps: Steps, grid: FloatArray, policy: IntArray, labels: Labels, has_standstill_brake: bool
) -> tuple[IntArray, float]:
    """Return the decision of a policy, an array of shape (n,), and about its time [s], infinite if it ends early."""
    nodes = grid.shape[0]
    decision, time = np.full(nodes - 1, OFF), 0.0
    speed2, label = grid[0, 0], 0
    for i in range(nodes - 1):
        k = _nearest(grid[i], speed2, policy[i, :, label])
        if k < 0:
            return decision, math.inf
        step = policy[i, k, label]
        action = steps.action[step]
        if not (action == BRAKE and has_standstill_brake and steps.energy_j[step] >= 0.0):
            decision[i] = action
        time, label = time + steps.time_s[step], labels.moves[i, label, action]
        # as far from a grid point as before: rounding to the nearest would change the time
        speed2 = steps.leaving_speed2[step] + speed2 - grid[i, k]
        speed2 = min(max(speed2, grid[i + 1, 0]), grid[i + 1, -1])
    return decision, time


class OnOffBand(NamedTuple):
    """A band of speeds around a run, in which decisions are searched.

    Parameters
    ----------
    half_width_share : float
        Half of its width over the top speed.
    points : int
        Number of speeds of each node.
    factor : float
        Factor by which the bracket of the price of time first widens.
    """

    half_width_share: float
    points: int
    factor: float


class OnOffDecisions(NamedTuple):
    """Decisions of the runs that bracket the timetable.

    Parameters
    ----------
    modes : list of array of shape (n,)
        Two decisions, modes of `mesh_data`, the more punctual one first, or one, or none if the band holds no run.
    price_w : float
        Price of a second of the more punctual one, auxiliaries included [J/s].
    sweeps : int
        Number of backward inductions.
    """

    modes: list[IntArray]
    price_w: float
    sweeps: int


def on_off_decisions(
    mesh: MeshData,
    fastest_speed2: FloatArray,
    time_s: float,
    centre_speed2: FloatArray,
    min_on_off_s: float,
    band: OnOffBand,
    price_w: float,
) -> OnOffDecisions:
    """Return the decisions in a band of speeds that keep a minimum on/off time and bracket a running time.

    Parameters
    ----------
    mesh : MeshData
        The line and the train.
    fastest_speed2, centre_speed2 : array of shape (nodes,)
        Greatest feasible squares of speed, and those in the middle of the band [m2/s2].
    time_s, min_on_off_s : float
        Running time allowed, and minimum on/off time [s].
    band : OnOffBand
    price_w : float
        First price of a second, auxiliaries included [J/s].
    """
    done = actions_of_run(mesh, centre_speed2)
    lasting = np.minimum(min_stretch_cells(done.duration_s, min_on_off_s), MAX_BOUND_CELLS)
    lasting[done.interrupted_by == NEUTRAL_SECTION] = 1
    labels = on_off_labels(lasting, done.interrupted_by)
    half_width_ms = band.half_width_share * math.sqrt(fastest_speed2.max())
    grid = speed_band(mesh, fastest_speed2, centre_speed2, half_width_ms, band.points)
    steps = tabulate_steps(mesh, grid, tabulate_powers(mesh), by_regime=False)
    another = bool(has_standstill_brake(mesh.drive_kind, mesh.drive_parameters))
    max_late_s = (MAX_LATE - 1.0) * time_s

    @cache
    def run(log_price: float) -> tuple[IntArray, float]:
        _, policy, _ = sweep_back(steps, grid, math.exp(log_price), labels, keeps_cost=False)
        modes, taken_s = follow(steps, grid, policy, labels, another)
        return modes, min(taken_s - time_s, max_late_s)

    def lateness_s(log_price: float) -> float:
        return run(log_price)[1]

    first = math.log(max(price_w, TINY))
    # a band that no run passes at one price holds none at another
    if lateness_s(first) == max_late_s:
        return OnOffDecisions([], price_w, 1)
    pair = meeting_prices(lateness_s, first, band.factor, log_price_range(mesh, time_s), TIME_TOLERANCE * time_s)
    closest = sorted(dict.fromkeys(pair), key=lambda price: abs(lateness_s(price)))
    modes = [run(price)[0] for price in closest if lateness_s(price) < max_late_s]
    return OnOffDecisions(modes, math.exp(closest[0]), run.cache_info().currsize)
