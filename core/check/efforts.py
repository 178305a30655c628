"""Whether the efforts keep the limits of vehicle and motors, the brakes share as they must, and the drive stays on.

Limits hold at a cell's mean speed, where its effort acts. The force of a rounding of the speeds is subtracted first.

A drive stays on or off for as long as the scenario asks, to the nearest cell: a run is switched where its cells meet,
so that no stretch can be held to a time more closely than by half of a cell. From driving to braking a drive passes
through no effort, for however short a time. A stretch that a neutral section cuts has no rule, as the section switches
there.
"""

from collections.abc import Iterator

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.check.case import Case
from railjoule.core.check.result import Check, Finding, Unchecked, find_largest
from railjoule.core.check.train import STANDSTILL_MS, stated_limits_n

# Interior points stop just inside a limit, exact coasting and joined runs put some efforts just beyond it. 2e-6 of the
# largest effort is below a newton for trains of up to 500 kN.
ROUNDED_LIMIT = 2e-6
"""A vehicle without an electric brake may have a billionth of its tractive effort, and solvers stop near a limit."""
# At a crossing of two limits, the smaller of both has a kink that a cubic per piece of speed cannot follow. Larger, and
# a limit that is wrong by half a per cent would pass; smaller, and a run along a rounded corner would be a fault.
ROUNDED_CORNERS = 2e-3
"""The product rounds the corners of limits that vary with speed, those of motors and curves; here they are exact."""
# the pull-out torque of machines without voltage to spare falls towards nothing at high speed
MIN_SHARE = 0.01
"""Of the largest effort; limits below it count as this much, or a deviation would be a share of nothing."""
STATED = {
    "effort": ("{} effort", "the largest effort", ROUNDED_LIMIT),
    "power": ("{} power", "the limit", ROUNDED_LIMIT),
    # the product tabulates the same curve with rounded corners
    "curve": ("curve of {} effort", "the largest effort", ROUNDED_CORNERS),
    "breakdown": ("breakdown of {} effort", "the largest effort", ROUNDED_CORNERS),
}
"""Name, scale and tolerance of the rule for each limit that a scenario states."""

SWITCHING = "stretches of the drive"
# the rules of the others decide when to switch, and may hold a speed by turns within a cell
JUDGED = ("optimal", "bellman")
"""The strategies that choose when to switch."""
NO_EFFORT = 1e-5
"""Efforts below this share of the largest that a run has are none."""
ROUNDED_TIME = 1e-6
"""Tolerance for the rounding of a time."""


def effort_findings(case: Case) -> Iterator[Finding]:
    """Yield all findings about a run's efforts."""
    record = case.record
    if record.effort_n is None or record.tractive_effort_n is None:
        yield Unchecked("efforts and their limits", "the table has no column effort_kn")
        return
    yield from _limits(case, case.moving(record.tractive_effort_n), False)
    if case.route.restricted:
        yield from _limits_of_places(case, case.moving(record.tractive_effort_n))
    if case.route.neutral:
        # where one number is the effort of all brakes, only driving is known to be the drive's
        effort = np.maximum(case.electric_n, 0.0 if record.electric_braking_n is None else -case.electric_n)
        yield _effort(case, "neutral sections", np.where(case.neutral, effort, 0.0), 0.0)
    if record.electric_braking_n is None or record.friction_braking_n is None:
        yield from _all_brakes(case, np.maximum(-case.moving(record.effort_n), 0.0))
        return
    electric, friction = case.moving(record.electric_braking_n), case.moving(record.friction_braking_n)
    yield from _limits(case, electric, True)
    yield _effort(case, "friction braking effort", friction, case.friction_limit_n)
    if case.scenario.line.all_rail_conditions != {None}:
        yield _effort(case, "adhesion of the braked axles", electric + friction, case.adhesion_n[1])
    # driving and braking together, or a negative part
    parts = np.array([record.tractive_effort_n, record.electric_braking_n, record.friction_braking_n])
    misses = np.maximum(np.minimum(parts[0], parts[1] + parts[2]), -parts.min(axis=0)) / case.effort_scale_n
    name = "drives or brakes, not both"
    yield find_largest(name, "the largest effort", ROUNDED_LIMIT, misses, record.position_m[:-1])
    yield _sharing(case, electric, friction)


def _limits(case: Case, effort_n: FloatArray, braking: bool) -> Iterator[Check]:
    """Compare efforts of the drive in one direction with all its limits."""
    vehicle = case.scenario.vehicle
    words = "electric braking" if braking else "tractive"
    stated = stated_limits_n(vehicle.braking if braking else vehicle.traction, case.mean_speed_ms)
    factor = 1.0 if braking else case.effort_factor
    for key, own in stated.items():
        limit = factor * own
        name, scale, allowed = STATED[key]
        # the share of a power is the share of the effort that has it at this speed
        over = limit if key == "power" else case.effort_scale_n
        excess = (effort_n - limit - case.rounding_n) / over
        yield find_largest(name.format(words), scale, allowed, excess, case.middle_m)
    if case.scenario.line.all_rail_conditions != {None}:
        name = "adhesion under the electric brake" if braking else "adhesion of the driven axles"
        yield _effort(case, name, effort_n, case.adhesion_n[0])
    used = effort_n > 0
    limit = case.model.max_effort_n(case.mean_speed_ms[used], braking) * (1.0 if braking else case.effort_factor[used])
    if np.isinf(limit).all():
        return
    # the rounding of a limit comes on top of that of its corners
    over = np.maximum(limit, MIN_SHARE * case.effort_scale_n)
    excess = (effort_n[used] - limit - case.rounding_n[used]) / over - ROUNDED_LIMIT
    name = "motors while braking" if braking else "motors while driving"
    yield find_largest(name, "the motors' largest effort", ROUNDED_CORNERS, excess, case.middle_m[used])


def _limits_of_places(case: Case, effort_n: FloatArray) -> Iterator[Finding]:
    """Compare tractive efforts with the limits of traction on parts of the line."""
    yield _effort(case, "tractive effort by place", effort_n, case.place_effort_n)
    power_n = case.place_power_w / np.maximum(case.mean_speed_ms, STANDSTILL_MS)
    # the share of a power is the share of the effort that has it at this speed
    excess = (effort_n - power_n - case.rounding_n) / np.minimum(power_n, case.effort_scale_n)
    yield find_largest("tractive power by place", "the limit", ROUNDED_CORNERS, excess, case.middle_m)
    voltage = case.scenario.vehicle.line_voltage_v
    if voltage is None:
        return
    if case.record.supply_power_w is None:
        yield Unchecked("current by place", "the table has no column line_power_kw")
        return
    most_w = case.place_current_a * voltage
    # only driving is limited; what losses are tabulated to may be missing
    taken_w = np.where(effort_n > 0, case.moving(case.record.supply_power_w) - case.loss_uncertainty_w, 0.0)
    rounding_w = case.rounding_n * case.mean_speed_ms
    excess = (taken_w - rounding_w - most_w) / np.minimum(most_w, case.effort_scale_n * case.top_speed_ms)
    yield find_largest("current by place", "the limit", ROUNDED_CORNERS, excess, case.middle_m)


def _effort(
    case: Case, name: str, effort_n: FloatArray, limit_n: FloatArray | float, allowed: float = ROUNDED_LIMIT
) -> Check:
    excess = (effort_n - limit_n - case.rounding_n) / case.effort_scale_n
    return find_largest(name, "the largest effort", allowed, excess, case.middle_m)


def _all_brakes(case: Case, braking_n: FloatArray) -> Iterator[Finding]:
    """Compare the sum of the brakes where their shares are unknown."""
    # the weakest true statement: whatever the sharing, both brakes together do not do more than both can
    limit = np.minimum(case.electric_limit_n + case.friction_limit_n, case.adhesion_n[1])
    yield _effort(case, "effort of all brakes", braking_n, limit, ROUNDED_CORNERS)
    for name in ("electric braking effort", "friction braking effort", "sharing of the brakes"):
        yield Unchecked(name, "the table has one effort for both brakes")


def _sharing(case: Case, electric_n: FloatArray, friction_n: FloatArray) -> Check:
    """Compare with a full electric brake: friction may only replace it where it is too weak or needs supply power."""
    used = friction_n > ROUNDED_LIMIT * case.effort_scale_n
    electric, speed = electric_n[used], case.mean_speed_ms[used]
    # Friction is no fault where the full electric brake would have drawn power: so the supply power of both sharings
    # is compared, not the efforts.
    full = np.minimum(electric + friction_n[used], np.maximum(case.electric_limit_n[used], electric))
    taken, taken_by_full = (case.supply_power_of_effort_w(sharing, speed, used) for sharing in (-electric, -full))
    lost = taken - taken_by_full
    if case.record.supply_power_w is not None:
        # twice, as both powers of the difference are uncertain
        lost = lost - 2 * case.loss_uncertainty_w[used]
    scale = np.maximum(full * speed, 1e-3 * case.effort_scale_n * np.max(speed, initial=1.0))
    share = np.nan_to_num(lost / scale)
    return find_largest("sharing of the brakes", "the braking power", ROUNDED_CORNERS, share, case.middle_m[used])


def switching_findings(case: Case) -> Iterator[Finding]:
    """Yield the finding about the minimum on/off time of a run's drive; none without such a rule."""
    record, least = case.record, getattr(case.scenario.vehicle.drive, "least_switching_s", 0.0)
    if not least or record.strategy not in JUDGED:
        return
    if record.tractive_effort_n is None or record.electric_braking_n is None:
        yield Unchecked(SWITCHING, "the table does not tell electric from friction brakes")
        return
    driving, braking = case.moving(record.tractive_effort_n), case.moving(record.electric_braking_n)
    none = NO_EFFORT * max(float(np.max(driving, initial=0.0)), float(np.max(braking, initial=0.0)))
    does = np.where(driving > none, 1, np.where(braking > none, -1, 0))
    departs = case.entering_speed2 == 0
    cut = np.append(False, case.neutral[1:] != case.neutral[:-1])
    borders = np.flatnonzero(np.append(True, departs[1:] | cut[1:] | (np.diff(does) != 0)))
    ends = np.append(borders[1:], len(does))
    # nobody switches at a stop or at the end, and a train that is moving at the beginning was switched before
    whole = (ends < len(does)) & ~np.append(departs | cut, True)[ends] & ((borders > 0) | departs[0]) & ~cut[borders]
    # what the drive does before and after each; a departure has nothing before it
    actions = does[borders]
    before, after = np.where(departs[borders], 0, np.append(0, actions[:-1])), np.append(actions[1:], 0)
    whole &= (actions != 0) | (before == after)
    lasts = np.add.reduceat(case.duration_s, borders) + 0.5 * np.maximum.reduceat(case.duration_s, borders)
    missing = np.where(whole, (least - lasts) / least, 0.0)
    yield find_largest(SWITCHING, "drive.least_switching_s", ROUNDED_TIME, missing, case.middle_m[borders])
