"""The price of time at which the cheapest run meets the timetable, on ever finer grids around the run found so far."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import scipy

from railjoule.core.arrays import FloatArray
from railjoule.core.dynamic_programming.grid import speed_band
from railjoule.core.dynamic_programming.labels import no_labels
from railjoule.core.dynamic_programming.power_table import NO_POWERS
from railjoule.core.dynamic_programming.recursion import roll_out, sweep_back
from railjoule.core.dynamic_programming.steps import Steps, tabulate_steps
from railjoule.core.errors import SolverError
from railjoule.core.motion import running_time
from railjoule.core.motion.passes import slowed_to_reach
from railjoule.core.physics.energy_balance import run_energy
from railjoule.core.physics.mesh_data import MeshData

# Each constant that shapes a run was halved and doubled over 13 shipped scenarios; parts per million (ppm) are of the
# run's energy, the mean over the scenarios. Single runs move by more: a drive with idle losses has many local
# optima, and any change ends in another of them, -560 to +630 ppm away for trams. Means under 50 ppm are scatter.

# Speeds at each node on the first grid, which spans all of them: 12 or 48 change no mean by more than 50 ppm, 48 take
# a quarter longer
FIRST_POINTS = 24
# Speeds on the next grids; the last number stays. (7, 5, 5) cost 195 ppm, (25, 17, 13) gain 90 in 1.8 times the time
POINTS = (13, 9, 7)
# Half of the second grid's band over the greatest speed, somewhat more than two steps of the first grid, as its run may
# lie a step aside. 0.05 cost 29 ppm, 0.2 gain 33 in 1.5 times the time
FIRST_BAND_SHARE = 0.1
# By what the band narrows once the run is steady: over 7 points the step is a third of the half band, so that the next
# band still holds the neighbours of each point. 0.15 cost 192 ppm, 0.6 gain 64 in 1.9 times the time
NARROWING = 0.3
# A run is steady if a new grid makes it cheaper by less than this share of its kinetic energy at the mean speed. Ten
# times as much cost 100 ppm, a tenth gains 17 in 1.4 times the time
STEADY_SHARE = 5e-4
# The search ends with bands this narrow: linear cost to go and a golden section find the rest. 0.2 cost 320 ppm, 0.1
# 16 ppm; half of it gains 2
MIN_BAND_MS = 0.02
# Seven levels cost 40 ppm, as the runs that wander most have not become steady; 28 change nothing
MAX_LEVELS = 14
# How close to the running time a level's run must come, as a share of it: at first, halved from level to level. The
# rest is made up by mixing it with the next run, which costs energy if they differ much. Half or double of the last
# changes under 1 ppm; half of the first takes a fifth more sweeps and gains 17 ppm
FIRST_TIME_TOLERANCE, MIN_TIME_TOLERANCE = 2e-3, 5e-5
# Golden sections between grid points: 0 cost 98 ppm, 2 cost 54, 8 gain 15
NARROWINGS = 4
# By how much the first bracket of the price widens, step by step. From level to level prices hardly change.
# Energies scatter by less than 50 ppm with factors of 2 to 64 and of 1.005 to 1.2, which take up to a fifth more sweeps
FIRST_FACTOR, NEXT_FACTOR = 8.0, 1.02
# From the price at which a sweep would have its run in time, which is off by some thousandths
ESTIMATED_FACTOR = 1.005
# Both runs are of one price if the logarithms of their prices differ by less: the time jumps there. A thousandth
# and a tenth as much change 4 ppm at most
MIN_LOG_WIDTH = 1e-3
# Each widening is 1.5 times the one before in the logarithm, so that 16 cover the whole range of prices, and 10 sweeps
# close nearly all brackets (0.03 ppm): both numbers but keep a fault from running for ever
MAX_WIDENINGS, MAX_SWEEPS = 20, 60
WIDENING_GROWTH = 1.5
# The least and the greatest price that is tried, over kinetic energy at the mean speed by running time: far
# beyond what runs need, as a range from 1e-3 to 1e2 changes one scenario, by 10 ppm, and a wider one none
PRICE_SHARES = (1e-6, 1e4)
# the logarithm of a power that may be 0
TINY = 1e-300
# A band that holds no run is widened; a search that meets so many ends with the best run so far and a note.
# No shipped scenario meets one: they come where a climb needs momentum and all of the grid is too slow for it
WIDENING, MAX_FAILURES = 2.0, 3
NO_RUN = "dynamic programming found no run that reaches the end on its grid of speeds."

Lateness = Callable[[float], float]
"""By how much the run of a logarithm of price is late [s]."""


@dataclass(frozen=True, eq=False)
class Level:
    """One grid with its steps, and the two runs on it whose times bracket the timetable.

    Parameters
    ----------
    grid : array of shape (nodes, points)
        Squares of speed [m2/s2].
    steps : Steps
        All steps between them.
    price_w : float
        Price of a second between those of the two runs [J/s].
    slower, faster : array of shape (nodes,)
        Squares of speed of both runs [m2/s2].
    sweeps : int
        How many backward inductions it took.
    """

    grid: FloatArray
    steps: Steps
    price_w: float
    slower: FloatArray
    faster: FloatArray
    sweeps: int


def search_level(
    mesh: MeshData,
    grid: FloatArray,
    fastest_speed2: FloatArray,
    time_s: float,
    first_price_w: float,
    widening_factor: float,
    time_tolerance_s: float,
) -> Level:
    """Return the runs on one grid that bracket a running time.

    Parameters
    ----------
    mesh : MeshData
        The line and the train.
    grid : array of shape (nodes, points)
        Squares of speed [m2/s2].
    fastest_speed2 : array of shape (nodes,)
        The fastest run [m2/s2], which bounds the search where the grid's own runs are all too slow.
    time_s : float
        Running time allowed [s].
    first_price_w, widening_factor : float
        Price of a second, auxiliaries included, where the search begins [J/s], and by which factor its bracket widens.
    time_tolerance_s : float
        The search ends with a run whose time is this close [s], or with prices that hardly differ.

    Raises
    ------
    SolverError
        If no run reaches the end on this grid.
    """
    steps, labels = tabulate_steps(mesh, grid, NO_POWERS, by_regime=False), no_labels(len(grid) - 1)

    @cache
    def sweep(log_price: float) -> tuple[FloatArray, float]:
        cost, _, taken_s = sweep_back(steps, grid, math.exp(log_price), labels, keeps_cost=True)
        if cost[0, 0, 0] == math.inf:
            raise SolverError(NO_RUN)
        return cost, taken_s - time_s

    @cache
    def run(log_price: float) -> tuple[FloatArray, float]:
        speed2, _ = roll_out(mesh, grid, sweep(log_price)[0], math.exp(log_price), labels, NARROWINGS)
        if speed2[-1] < 0:
            raise SolverError(NO_RUN)
        return speed2, running_time(mesh.cell_length_m, speed2) - time_s

    def estimated_lateness_s(log_price: float) -> float:
        return sweep(log_price)[1]

    def lateness_s(log_price: float) -> float:
        return run(log_price)[1]

    prices, first = log_price_range(mesh, time_s), math.log(first_price_w)
    # a sweep estimates how late its run is, for a fraction of the cost of rolling one out
    about = meeting_prices(estimated_lateness_s, first, widening_factor, prices, time_tolerance_s)
    first = min(about, key=lambda price: abs(estimated_lateness_s(price)))
    slow, fast = meeting_prices(lateness_s, first, ESTIMATED_FACTOR, prices, time_tolerance_s)
    price, slower, faster = 0.5 * (slow + fast), run(slow)[0], run(fast)[0]
    if lateness_s(slow) <= 0:
        # the cheapest run at any price is early, and at the least price it is the cheapest of all
        price = min(slow, fast)
        slower = faster = run(price)[0]
    elif lateness_s(fast) > 0:
        price, faster = fast, fastest_speed2
    return Level(grid, steps, math.exp(price), slower, faster, sweep.cache_info().currsize)


def log_price_range(mesh: MeshData, time_s: float) -> tuple[float, float]:
    """Return the logarithms of the least and the greatest price of a second [J/s] that are tried for a running time."""
    # a second costs at least what the auxiliaries take: a run that is early at that price had better be early
    floor = math.log(max(mesh.auxiliary_power_w, TINY))
    least, most = (max(math.log(price_scale_w(mesh, time_s) * share), floor) for share in PRICE_SHARES)
    return least, most


def meeting_prices(
    lateness_s: Lateness, first: float, factor: float, prices: tuple[float, float], tolerance_s: float
) -> tuple[float, float]:
    """Return two logarithms of prices that bracket the timetable, one of them within a tolerance of it if any is.

    The first is that of the slower run. The bracket widens from `first` on, by `factor` at first and within `prices`.
    """
    least, most = prices
    slow, fast = _bracket(lateness_s, min(max(first, least), most), factor, least, most)
    if lateness_s(slow) <= 0 or lateness_s(fast) > 0:
        return slow, fast
    for _ in range(MAX_SWEEPS):
        closest = min(abs(lateness_s(slow)), abs(lateness_s(fast)))
        if closest <= tolerance_s or abs(slow - fast) <= MIN_LOG_WIDTH:
            break
        # regula falsi, drawn to the middle: times jump where the cheapest run changes its kind
        fraction = lateness_s(slow) / (lateness_s(slow) - lateness_s(fast))
        between = slow + (0.5 * fraction + 0.25) * (fast - slow)
        if lateness_s(between) >= 0:
            slow = between
        else:
            fast = between
    return slow, fast


def _bracket(lateness_s: Lateness, first: float, factor: float, least: float, most: float) -> tuple[float, float]:
    """Return two logarithms of prices, of the slower run and of the faster one: one late, one early, if there are any.

    A run that is late needs a higher price; from the first price on they go up or down in growing steps.
    """
    other = first
    for number in range(MAX_WIDENINGS):
        wider = other + math.copysign(math.log(factor) * WIDENING_GROWTH**number, lateness_s(first))
        other = min(max(wider, least), most)
        if lateness_s(first) * lateness_s(other) <= 0 or other != wider:
            break
        first = other
    return (first, other) if lateness_s(first) >= lateness_s(other) else (other, first)


def meet_time(mesh: MeshData, slower: FloatArray, faster: FloatArray, time_s: float) -> FloatArray:
    """Return the run between two that takes the running time, within 1e-6 s; squares of speed of shape (nodes,).

    The mean of two runs in the square of speed keeps all limits but those of power, which are met by slowing down.
    """

    def between(weight: float) -> FloatArray:
        return slowed_to_reach(mesh, slower + weight * (faster - slower))

    def lateness(weight: float) -> float:
        return running_time(mesh.cell_length_m, between(weight)) - time_s

    if lateness(0.0) <= 0:
        return between(0.0)
    if lateness(1.0) >= 0:
        return between(1.0)
    weight = scipy.optimize.brentq(lateness, 0.0, 1.0, xtol=1e-14, rtol=1e-14)
    return between(float(weight))


@dataclass(frozen=True, eq=False)
class Found:
    """The cheapest run.

    Parameters
    ----------
    speed2 : array of shape (nodes,)
        Squares of speed [m2/s2].
    price_w : float
        Price of a second, auxiliaries included [J/s].
    first : Level
        The first grid, which spans all speeds.
    sweeps : int
        Backward inductions on all grids together.
    unrefined_ms : float or None
        Half of the width of the band of speeds [m/s] that ended the search because it held no run; None where the
        search ended by itself.
    """

    speed2: FloatArray
    price_w: float
    first: Level
    sweeps: int
    unrefined_ms: float | None = None


def search(mesh: MeshData, fastest_speed2: FloatArray, time_s: float) -> Found:
    """Return the cheapest run that meets a running time, by backward induction.

    Parameters
    ----------
    mesh : MeshData
        The line and the train.
    fastest_speed2 : array of shape (nodes,)
        Greatest feasible squares of speed [m2/s2].
    time_s : float
        Running time allowed [s]; longer than the shortest possible.

    Raises
    ------
    SolverError
        If no run on the grid meets the timetable.
    """
    scale = price_scale_w(mesh, time_s)
    half_width = math.sqrt(fastest_speed2.max())
    tolerance = FIRST_TIME_TOLERANCE * time_s
    grid = speed_band(mesh, fastest_speed2, 0.25 * fastest_speed2, half_width, FIRST_POINTS)
    first = level = search_level(mesh, grid, fastest_speed2, time_s, scale, FIRST_FACTOR, tolerance)
    speed2, sweeps = meet_time(mesh, first.slower, first.faster, time_s), first.sweeps
    best, least, price = speed2, supply_energy_j(mesh, speed2), first.price_w
    half_width *= FIRST_BAND_SHARE
    failures, unrefined, steady_at = 0, None, math.inf
    for number in range(MAX_LEVELS):
        tolerance = max(0.5 * tolerance, MIN_TIME_TOLERANCE * time_s)
        points = POINTS[min(number, len(POINTS) - 1)]
        grid = speed_band(mesh, fastest_speed2, speed2, half_width, points)
        try:
            level = search_level(mesh, grid, fastest_speed2, time_s, level.price_w, NEXT_FACTOR, tolerance)
        except SolverError:
            failures, unrefined = failures + 1, half_width
            if failures == MAX_FAILURES:
                break
            half_width *= WIDENING
            continue
        speed2, sweeps, unrefined = meet_time(mesh, level.slower, level.faster, time_s), sweeps + level.sweeps, None
        energy = supply_energy_j(mesh, speed2)
        if energy < least:
            best, least, price = speed2, energy, level.price_w
        before, steady_at = steady_at, min(steady_at, energy)
        if before - steady_at <= STEADY_SHARE * scale * time_s or number == 0:
            if half_width < MIN_BAND_MS:
                break
            half_width *= NARROWING
    return Found(best, price, first, sweeps, unrefined)


def price_scale_w(mesh: MeshData, time_s: float) -> float:
    """Return a natural price of time [J/s]: kinetic energy at the mean speed by running time."""
    mean = float(mesh.cell_length_m.sum()) / time_s
    return mesh.half_inertia_kg * mean**2 / time_s


def supply_energy_j(mesh: MeshData, speed2: FloatArray) -> float:
    """Return the line energy of a run with auxiliaries on its way [J], as the optimum counts it."""
    return float(run_energy(mesh, speed2) + mesh.auxiliary_power_w * running_time(mesh.cell_length_m, speed2))
