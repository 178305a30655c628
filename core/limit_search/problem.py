"""A task as a search for limits sees it, and one evaluation of it.

The ideal regulators brake or coast within cells, so that every vector of limits has a factor with which its trip takes
the allowed time. The literal regulator has none that does so exactly: its time jumps by some hundredths of a second
with its switches. Its vectors begin where the ideal regulator that brakes keeps the time, and are scaled by its own
runs until one ends shortly before the window of (14) does.

Source: Shtompel, Khvorost 2025, (14), (15).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.limit_search.regulation import Regulation, make_regulation
from railjoule.core.limit_search.trip import regulated_trip
from railjoule.core.motion.meshed_line import MeshedLine
from railjoule.core.physics.mesh_data import MeshData

MIN_SECTION_M = 1.0
"""A section that the search may move is never shorter."""
EXACT = 1e-9
"""How close a trip comes to its time, as a share: a millionth of a second of a quarter of an hour."""
# as many halvings bring any bracket below rounding
MAX_TRIPS = 60
MAX_REPEATS = 4
"""After so many secants on one side of the time the bracket is halved."""
# At constant speed time falls by the factor by which limits rise. A step goes this many times as far, so that it ends
# beyond the time: two trips on either side of it make a bracket, two on the same side do not.
OVERSHOOT = 1.2
FIRST_WIDENING = 0.1
"""How far beyond the factor that a trip at constant speed would need, as a logarithm, the other side is looked for."""
STANDING_WIDENING = 0.7
"""By so much, a factor of 2, limits rise under which the train stands."""
NARROWEST = 1e-13
"""Bracket of logarithms that rounding does not let grow narrower."""


@njit(cache=True)
def _scaled(limits_ms: FloatArray, logarithm: float, min_ms: float, most_ms: float) -> FloatArray:
    return np.minimum(np.maximum(limits_ms * math.exp(logarithm), min_ms), most_ms)


@njit(cache=True, error_model="numpy", nogil=True)
def scale_to_time(
    mesh: MeshData,
    regulation: Regulation,
    borders_m: FloatArray,
    limits_ms: FloatArray,
    min_ms: float,
    most_ms: float,
    running_time_s: float,
) -> tuple[FloatArray, float, float]:
    """Return limits scaled so that a trip takes a time: Illinois' rule on the logarithms of factor and time.

    Parameters
    ----------
    mesh, regulation, borders_m, limits_ms
        As in `railjoule.core.limit_search.trip.trip`.
    min_ms, most_ms : float
        Between which limits stay [m/s].
    running_time_s : float
        The time [s].

    Returns
    -------
    limits_ms : array of shape (k,)
        The scaled limits [m/s].
    running_time_s, energy_j : float
        Of their trip; if even the greatest limits take longer, theirs.
    """
    low, high = math.log(min_ms / limits_ms.max()), math.log(most_ms / limits_ms.min())
    x = min(max(0.0, low), high)
    width, last_side, repeats = FIRST_WIDENING, 0, 0
    late_known = early_known = False
    late = early = excess = 0.0
    found, time, energy = limits_ms, math.inf, math.inf
    for _ in range(MAX_TRIPS):
        found = _scaled(limits_ms, x, min_ms, most_ms)
        _, _, time, energy = regulated_trip(mesh, regulation, borders_m, found)
        excess = math.log(time / running_time_s)
        # at an end of what limits may be, no other factor brings the time closer
        if abs(excess) <= EXACT or (excess > 0.0 and x >= high) or (excess < 0.0 and x <= low):
            break
        side = 1 if excess > 0.0 else -1
        repeats = repeats + 1 if side == last_side else 0
        # Illinois' rule: an end that stays again counts half, which moves the secant towards it; else it might stay
        # for ever while the other end creeps
        if side > 0:
            early = 0.5 * early if repeats else early
            low, late, late_known = x, excess, True
        else:
            late = 0.5 * late if repeats else late
            high, early, early_known = x, excess, True
        last_side = side
        if late_known and early_known:
            # a secant does not leave limits under which the train stands, or a range of them that hardly bind
            share = 0.5 if late == math.inf or repeats >= MAX_REPEATS else late / (late - early)
            x = low + (high - low) * share
        elif side > 0:
            x = min(x + (OVERSHOOT * excess + width if excess < math.inf else STANDING_WIDENING), high)
            width *= 2.0
        else:
            x = max(x + OVERSHOOT * excess - width, low)
            width *= 2.0
        if high - low <= NARROWEST:
            break
    if excess > EXACT and early_known:
        # time jumps where a train just passes a hill, or stands: the run that arrives is the early one
        found = _scaled(limits_ms, high, min_ms, most_ms)
        _, _, time, energy = regulated_trip(mesh, regulation, borders_m, found)
    return found, time, energy


@dataclass(frozen=True, eq=False)
class Evaluation:
    """One vector of limits that a search looked at.

    Parameters
    ----------
    stage : str
        'sample' in the first, even search, 'refine' in the second, 'given' where there is no search.
    unscaled_ms, limits_ms : array of shape (k,)
        Limits as they were drawn and as they were scaled to the time [m/s].
    boundaries_m : array of shape (k - 1,)
        Between the sections [m].
    running_time_s, energy_j : float
        Of the trip: time [s], and net energy at the line [J], infinite if it is late.
    """

    stage: str
    unscaled_ms: FloatArray
    limits_ms: FloatArray
    boundaries_m: FloatArray
    running_time_s: float
    energy_j: float


class SetSpeedRun(NamedTuple):
    """A run under set speeds of sections.

    Parameters
    ----------
    mesh : MeshedLine
        Over its own nodes, with its dwells.
    speed2 : array of shape (n + 1,)
        Squares of speed at the nodes [m2/s2].
    limits_ms : array of shape (k,)
        Of the sections [m/s].
    boundaries_m : array of shape (k - 1,)
        Between them [m].
    switches : int
        Changes of the literal regulator between driving, no effort and braking; 0 with other regulators.
    """

    mesh: MeshedLine
    speed2: FloatArray
    limits_ms: FloatArray
    boundaries_m: FloatArray
    switches: int = 0


RelayDrive = Callable[[FloatArray, FloatArray], tuple[float, float]]
"""Time [s] and net energy at the line [J] of the literal regulator's run under limits [m/s] with boundaries [m]."""
WINDOW_END_SHARE = 1e-3
"""A run of the relay is late enough where it ends by less than this share of its time before the window does."""
MAX_RELAY_RUNS = 8
# At constant speed time falls by the factor by which limits rise, less where acceleration takes most of the time. The
# slope between two runs is not trusted beyond these bounds, as times of close runs differ only by their switches.
STEEPEST, FLATTEST = 2.0, 0.2


@dataclass(frozen=True, eq=False)
class RelayRuns:
    """Runs of the literal regulator within a window of time.

    Parameters
    ----------
    earliest_s, latest_s : float
        Ends of the window [s].
    drive : callable
        See `RelayDrive`; both infinite where the relay drives no run.
    """

    earliest_s: float
    latest_s: float
    drive: RelayDrive

    def fit_window(self, ideal: Evaluation, min_ms: float, most_ms: float) -> Evaluation:
        """Return an evaluation of an ideal regulator with its limits scaled until the relay's own run fits the window.

        The energy is infinite where no factor was found.
        """
        best = replace(ideal, running_time_s=np.inf, energy_j=np.inf)
        aim_s = self.latest_s * (1 - 0.5 * WINDOW_END_SHARE)
        x, slope, before = 0.0, -1.0, None
        for _ in range(MAX_RELAY_RUNS):
            limits = np.clip(ideal.limits_ms * math.exp(x), min_ms, most_ms)
            time, energy = self.drive(limits, ideal.boundaries_m)
            if self.earliest_s < time < self.latest_s and energy < best.energy_j:
                best = replace(ideal, limits_ms=limits, running_time_s=time, energy_j=energy)
            excess = math.log(time / aim_s)
            if excess == math.inf or abs(excess) < 0.5 * WINDOW_END_SHARE:
                break
            if before is not None and before[0] != x:
                slope = (excess - before[1]) / (x - before[0])
                slope = min(max(slope, -STEEPEST), -FLATTEST)
            before = x, excess
            x -= excess / slope
        return best


@dataclass(frozen=True, eq=False)
class LimitProblem:
    """Trips of a train under limits of sections, in a given time.

    Parameters
    ----------
    mesh : MeshedLine
        Train and line.
    regulation : Regulation
        The same for its regulator.
    min_ms, most_ms : float
        Between which limits stay [m/s].
    running_time_s : float
        The longest time that a trip may take [s].
    relay : RelayRuns, optional
        The literal regulator, where vectors are judged by its runs.
    """

    mesh: MeshedLine
    regulation: Regulation
    min_ms: float
    most_ms: float
    running_time_s: float
    relay: RelayRuns | None = None

    def evaluate(self, stage: str, limits_ms: FloatArray, boundaries_m: FloatArray) -> Evaluation:
        """Return the trip under limits [m/s] and boundaries [m], scaled until it takes the allowed time."""
        scaled, time, energy = scale_to_time(
            self.mesh.data, self.regulation, boundaries_m, limits_ms, self.min_ms, self.most_ms, self.running_time_s
        )
        # the scaling meets the time to 1e-9 where any factor does; what it misses by more has none
        late = time > self.running_time_s * (1 + 1e-6)
        found = Evaluation(
            stage, limits_ms, scaled, boundaries_m, time, np.inf if late else self._with_auxiliaries(time, energy)
        )
        return found if late or self.relay is None else self.relay.fit_window(found, self.min_ms, self.most_ms)

    def as_given(self, limits_ms: FloatArray, boundaries_m: FloatArray) -> Evaluation:
        """Return the trip under limits [m/s] as they are, whatever its time."""
        _, _, time, energy = regulated_trip(self.mesh.data, self.regulation, boundaries_m, limits_ms)
        return Evaluation("given", limits_ms, limits_ms, boundaries_m, time, self._with_auxiliaries(time, energy))

    def over(self, mesh: MeshedLine, whole_cells: bool = False) -> "LimitProblem":
        """Return the same problem over another mesh; with `whole_cells` its trips are runs over that mesh."""
        regulation = make_regulation(mesh, self.regulation.deceleration_ms2, self.regulation.brakes)
        return replace(self, mesh=mesh, regulation=regulation._replace(whole_cells=whole_cells))

    def place_nodes(self, limits_ms: FloatArray, boundaries_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return places [m] and squares of speed [m2/s2] of a trip, cut wherever its regulator changes its effort.

        A trip that fails ends where it does.
        """
        position, speed2, _, _ = regulated_trip(self.mesh.data, self.regulation, boundaries_m, limits_ms)
        return position, speed2

    def _with_auxiliaries(self, time_s: float, energy_j: float) -> float:
        dwell = float(self.mesh.dwell_s.sum())
        return energy_j + self.mesh.data.auxiliary_power_w * (time_s + dwell)
