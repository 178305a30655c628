"""Driving advice: the phases of a run as instructions, with only the numbers that are printed.

A driver who follows them keeps the timetable, the limits and the energy of the run: speeds to a tenth of a km/h, as
half a km/h at the end of full power would change a run's energy by percents; positions to a metre, brakes early and
power late, so that no limit is broken. `railjoule.core.simulation.advised` drives them.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from railjoule.core.phases import Phase, PhaseName, RunData
from railjoule.core.phases.borders import FULL_BRAKING_SHARE, spare_braking_n
from railjoule.core.phases.labels import FULL_SHARE, HOLD_TOLERANCE_MS
from railjoule.core.units import MS_PER_KMH

if TYPE_CHECKING:
    from railjoule.core.trajectory import Trajectory

BRAKING_RESERVE_MS = HOLD_TOLERANCE_MS
"""A brake is begun so early that it still suffices for a train that is faster by this: it reads the same speed."""
SWING_KMH = 2 * HOLD_TOLERANCE_MS / MS_PER_KMH
"""How far an alternating hold swings to each side of its speed, or less far up and farther down below a limit."""
PRINTED_MS = 0.05 * MS_PER_KMH
"""By so much a speed is rounded where it is printed."""
# rounding of sums of cells; far enough from a node to lie in its neighbour; what counts as standing
SAME_PLACE_M, BESIDE_M, AT_REST_MS = 1e-6, 1e-3, 1e-3
POWERED: tuple[PhaseName, ...] = ("full_power", "part_power")


@dataclass(frozen=True)
class Instruction:
    """One line of the advice, its numbers rounded as they are printed.

    An instruction holds until the next one begins. Coasting after full power begins when the speed of the full power
    is reached, at about its position; everything else begins at its position.

    Parameters
    ----------
    action : str
        Action of the driver.
    from_m : float
        Begin, in whole metres; at a start or a stop the exact position [m].
    to_kmh : float or None
        The speed that power or a brake leads to, or that is held: in tenths; None for coasting, for standing, and for
        full power that loses speed uphill [km/h].
    at_m : float or None
        Position at which part power or a brake reaches that speed, or coasting comes to a stop, in whole metres; at a
        stop the exact position [m].
    between_kmh : tuple of two floats or None
        Speeds at which power is switched on and off, for a speed held by turns [km/h].
    power_share : float or None
        Share of full power for a speed held by turns, in hundredths.
    fully : bool
        Whether a brake takes all that the brakes have.
    stand_s : float or None
        How long the train stands, in tenths of a second [s].
    """

    action: PhaseName
    from_m: float
    to_kmh: float | None = None
    at_m: float | None = None
    between_kmh: tuple[float, float] | None = None
    power_share: float | None = None
    fully: bool = False
    stand_s: float | None = None


def advise(run: "Trajectory") -> tuple[Instruction, ...]:
    """Return one instruction for each phase of a run, in order."""
    phases, data = run.phases, run.run_data
    begins = [_begin_m(phase, before, data) for before, phase in zip((None, *phases), phases, strict=False)]
    # a brake's reserve ends where the phase before it begins
    # a brake may be moved before the start of the phase that it ends, and an instruction cannot begin before its
    # predecessor
    begins = [begins[0], *(max(place, before) for before, place in pairwise(begins))]
    ends = [*begins[1:], phases[-1].end_m]
    return tuple(_instruction(phase, begin, end, data) for phase, begin, end in zip(phases, begins, ends, strict=True))


def _begin_m(phase: Phase, before: Phase | None, data: RunData) -> float:
    """Return the begin of a phase [m]: brakes with their reserve, power no earlier than a limit may end."""
    if phase.start_ms <= AT_REST_MS or phase.start_m == data.position_m[0] or before is None:
        return phase.start_m
    if phase.phase == "brake":
        start, end = (phase.start_m, phase.start_ms), (phase.end_m, phase.end_ms)
        if before.phase == "brake":
            # the train has the speed of the advice, and would creep through a longer reserve before a stop
            by_full_brake_m = brake_place_m(data, start, end, PRINTED_MS)
            place_m = max(by_full_brake_m, _place_when_faster_m(phase, phase.start_ms + PRINTED_MS))
        else:
            place_m = brake_place_m(data, start, end, BRAKING_RESERVE_MS)
        return float(math.floor(place_m + SAME_PLACE_M))
    if phase.phase in POWERED:
        # power late and brakes early: rounding the other way could break a limit by up to a metre
        return float(math.ceil(phase.start_m - SAME_PLACE_M))
    limit_ms = _limit_kmh(data, phase.end_m - BESIDE_M, phase.end_m + BESIDE_M) * MS_PER_KMH
    if phase.phase == "coast" and before.phase == "hold" and phase.end_ms >= limit_ms - PRINTED_MS:
        return float(round(_place_when_faster_m(phase, _held_kmh(before, data) * MS_PER_KMH)))
    return float(round(phase.start_m))


def _place_when_faster_m(phase: Phase, speed_ms: float) -> float:
    """Return the begin of a phase that slows down for a train faster than the run, to end as the run does [m]."""
    lost2 = phase.start_ms**2 - phase.end_ms**2
    if speed_ms <= phase.start_ms or lost2 <= 0.0:
        return phase.start_m
    return phase.end_m - (phase.end_m - phase.start_m) * (speed_ms**2 - phase.end_ms**2) / lost2


def _held_kmh(hold: Phase, data: RunData) -> float:
    """Return the printed speed of a hold [km/h]."""
    return _printed_kmh(hold.mean_speed_ms, _limit_kmh(data, hold.start_m, hold.end_m))


def _instruction(phase: Phase, from_m: float, end_m: float, data: RunData) -> Instruction:
    action = phase.phase
    if action == "stand":
        return Instruction(action, from_m, stand_s=round(phase.end_s - phase.start_s, 1))
    if action == "hold":
        limit_kmh, speed = _limit_kmh(data, phase.start_m, phase.end_m), _held_kmh(phase, data)
        if phase.effort_share is None:
            return Instruction(action, from_m, speed)
        # the run itself may swing faster and less far, as its mesh lets it; the energy of turns hardly depends on that
        high = min(speed + SWING_KMH, limit_kmh)
        between = round(high - 2 * SWING_KMH, 1), round(high, 1)
        share = 1.0 if phase.effort_share >= FULL_SHARE else round(phase.effort_share, 2)
        return Instruction(action, from_m, speed, None, between, share)
    if action == "coast" and phase.end_ms > AT_REST_MS:
        return Instruction(action, from_m)
    speed = _printed_kmh(phase.end_ms, _limit_kmh(data, phase.end_m - BESIDE_M, phase.end_m + BESIDE_M))
    if action == "full_power":
        # uphill the train may get slower: the driver would take power back immediately for a speed below his own
        return Instruction(action, from_m, speed if phase.end_ms > phase.start_ms else None)
    if action != "brake":
        return Instruction(action, from_m, speed, end_m)
    if speed > 0 and phase.end_m < data.position_m[-1]:
        # a limit begins where many brakes end
        end_m = max(min(float(math.floor(phase.end_m + SAME_PLACE_M)), end_m), from_m)
    return Instruction(action, from_m, speed, end_m, fully=(phase.effort_share or 0.0) >= FULL_BRAKING_SHARE)


def _limit_kmh(data: RunData, start_m: float, end_m: float) -> float:
    """Return the lowest limit between two places, in whole tenths [km/h]."""
    first = int(np.searchsorted(data.position_m, start_m + SAME_PLACE_M)) - 1
    end = int(np.searchsorted(data.position_m, end_m - SAME_PLACE_M))
    limit_kmh = float(np.min(data.limit_ms[max(first, 0) : max(end, 1)])) / MS_PER_KMH
    return math.floor(10 * limit_kmh + SAME_PLACE_M) / 10 if math.isfinite(limit_kmh) else limit_kmh


def _printed_kmh(speed_ms: float, limit_kmh: float) -> float:
    # rounded up, a speed could exceed a limit that is no tenth; the limit is rounded down for the same reason
    return min(round(speed_ms / MS_PER_KMH, 1), limit_kmh)


def brake_place_m(run: RunData, start: tuple[float, float], end: tuple[float, float], reserve_ms: float) -> float:
    """Return the last place, up to the start of a brake, from which all brakes suffice for a faster train [m].

    Parameters
    ----------
    run : RunData
        The run.
    start, end : tuple of two floats
        Place [m] and speed [m/s] where its brake begins and ends.
    reserve_ms : float
        By how much the train is faster than in the run where it begins to brake [m/s].
    """
    # Backwards from the end, in v^2: the full brakes gain on the run's own brake until they take the surplus of a
    # train that is faster by the reserve. Beyond the start of the brake the faster train still follows the phase
    # before.
    i = int(np.searchsorted(run.position_m, end[0] - 1e-9)) - 1
    # the square of speed from which full braking ends as the run does, backwards from there
    place, speed, reached2 = end[0], end[1], end[1] ** 2
    braking = True
    while i >= 0 and run.position_m[i + 1] > run.position_m[i]:
        braking = braking and place > start[0]
        if not braking and reached2 >= (speed + reserve_ms) ** 2:
            return float(place)
        left, entering = run.position_m[i], run.speed_ms[i]
        whole = (run.speed_ms[i + 1] ** 2 - entering**2) / (run.position_m[i + 1] - left)
        if braking and left < start[0]:
            left, entering = start
        slope = (speed**2 - entering**2) / (place - left)
        # d(v^2)/dx = 2 F / m, of what the brakes have beyond what the run uses
        more = 2.0 * spare_braking_n(run, i, slope - whole) / run.inertia_kg
        entering_reached2 = reached2 + (more - slope) * (place - left)
        missing, surplus = (speed + reserve_ms) ** 2 - reached2, entering_reached2 - (entering + reserve_ms) ** 2
        if not braking and surplus >= 0.0:
            return float(place - (place - left) * missing / (missing + surplus))
        place, speed, reached2 = left, entering, entering_reached2
        if place == run.position_m[i]:
            i -= 1
    return float(place)
