"""Whether the line's power is what the drive takes by its formulas, and its motors carry the current that they must.

A drive takes F v and its losses; of what it generates the line takes back the share kr. Auxiliaries come on top.
"""

from collections.abc import Iterator

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.check.case import OFF_SHARE, Case
from railjoule.core.check.efforts import ROUNDED_CORNERS
from railjoule.core.check.result import Finding, Unchecked, find_largest

ROUNDED_POWER, ROUNDED_CURRENT = 1e-7, 1e-6
# A smooth power has its least at the middle of a bracket to second order: three zooms by 12 leave 6e-4 of the
# interval, and of the power the square of that. The rest is for kinks and for jumps at no effort.
SEARCH_TOLERANCE = 1e-4
"""How well a search over ways to share the brakes finds the least power."""
# a grid and not a descent, as drives that jump at no effort have a least power at the jump besides that of the slope
SHARES, SEARCHES = 25, 3
"""How many such ways are looked at, and how often around the best."""


def power_findings(case: Case) -> Iterator[Finding]:
    """Yield all findings about a run's powers."""
    record = case.record
    if record.supply_power_w is None or record.effort_n is None:
        missing = "effort_kn" if record.effort_n is None else "line_power_kw"
        yield Unchecked("line power", f"the table has no column {missing}")
        return
    effort, reported = case.moving(record.effort_n), case.drive_power_w
    work = np.where(case.off, 0.0, effort * case.mean_speed_ms)
    large = float(np.max(np.abs(record.supply_power_w))) + float(np.max(np.abs(work), initial=0.0)) + 1.0
    scale = np.maximum(np.abs(reported), np.abs(work)) + OFF_SHARE * large
    if record.electric_braking_n is not None:
        allowed, misses = ROUNDED_POWER, np.abs(reported - case.supply_power_of_terminal_w(case.terminal_power_w))
    else:
        # A table of nodes has one effort for both brakes. Any way to share them is then allowed, and only a power
        # that none of them has is an error.
        allowed, misses = SEARCH_TOLERANCE, _outside_sharing(case)
        yield Unchecked("line power of each brake", "the table tells one effort for both, so only what is possible")
    # where motors cannot give an effort there is no power to compare with: the limits of efforts judge it
    misses = np.nan_to_num(np.maximum(misses - case.loss_uncertainty_w, 0.0)) / scale
    standing = np.abs(record.supply_power_w[~case.moves] - case.auxiliary_power_w) / large
    places = np.append(case.middle_m, record.position_m[:-1][~case.moves])
    yield find_largest("line power", "the power", allowed, np.append(misses, standing), places)
    # no drive gives more than it gets, whatever its losses
    # The one rule that needs no loss model: a train that drives takes at least F v, and of what it brakes the line
    # gets at most its share. It holds for runs whose losses cannot be checked.
    least = np.where(work > 0, work, case.recuperation_factor * work)
    yield find_largest("no power from nothing", "the power", ROUNDED_POWER, (least - reported) / scale, case.middle_m)
    yield from _current(case)


def _outside_sharing(case: Case) -> FloatArray:
    """Return the distance of powers from those of all ways to share the brakes [W]."""
    reported, brakes = case.drive_power_w, ~case.off & (case.electric_n < 0)
    misses = np.abs(reported - case.supply_power_of_terminal_w(case.terminal_power_w))
    braking, limit, speed = -case.electric_n[brakes], case.electric_limit_n[brakes], case.mean_speed_ms[brakes]
    most = np.minimum(braking, limit * (1 + ROUNDED_CORNERS))
    least = np.minimum(np.maximum(braking - case.friction_limit_n, 0.0), most)
    # right at its limit a motor has losses, and beyond it perhaps none are known
    low = high = case.supply_power_of_effort_w(-np.clip(limit, least, most), speed)
    for _ in range(SEARCHES):
        shared = [least + share * (most - least) for share in np.linspace(0, 1, SHARES)]
        powers = np.array([case.supply_power_of_effort_w(-electric, speed) for electric in shared])
        low, high = np.fmin(low, np.fmin.reduce(powers)), np.fmax(high, np.fmax.reduce(powers))
        # the least power lies between the neighbours of the least found, the greatest at an end or a jump
        best = np.argmin(np.nan_to_num(powers, nan=np.inf), axis=0)
        least, most = (np.choose(np.clip(best + side, 0, SHARES - 1), shared) for side in (-1, 1))
    beside = np.maximum(np.maximum(low - reported[brakes], reported[brakes] - high), 0.0)
    misses[brakes] = np.where(np.isfinite(beside), beside, np.nan)
    return misses


def _current(case: Case) -> Iterator[Finding]:
    record = case.record
    current = case.model.current_a(case.electric_n, case.mean_speed_ms)
    # a run that only coasts has no current to be a share of
    scale = case.model.current_a(np.full(len(case.electric_n), case.effort_scale_n), case.mean_speed_ms)
    if current is None or scale is None:
        yield Unchecked("motor current", "the drive's model has none")
        return
    if record.current_a is None or record.electric_braking_n is None:
        reason = "has no column current_a" if record.current_a is None else "tells one effort for both brakes"
        yield Unchecked("motor current", f"the table {reason}")
        return
    # a drive that is off has no current, though its formula would tell that of its flux
    current = np.where(case.off, 0.0, current)
    large = float(np.nanmax(np.abs(np.append(current, scale)), initial=1e-9))
    misses = np.nan_to_num(np.abs(case.moving(record.current_a) - current)) / large
    yield find_largest("motor current", "the largest current", ROUNDED_CURRENT, misses, case.middle_m)
