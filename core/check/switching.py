"""Whether the drive of a run stays on or off for as long as the scenario asks, to the nearest cell.

A run is switched where its cells meet, so that no stretch can be held to a time more closely than by half of a cell.
From driving to braking a drive passes through no effort, for however short a time. A stretch that a neutral section
cuts has no rule, as the section switches there.
"""

from collections.abc import Iterator

import numpy as np

from railjoule.core.check.case import Case
from railjoule.core.check.result import Finding, Unchecked, find_largest

NAME = "stretches of the drive"
# the rules of the others decide when to switch, and may hold a speed by turns within a cell
JUDGED = ("optimal", "bellman")
"""The strategies that choose when to switch."""
NO_EFFORT = 1e-5
"""Efforts below this share of the largest that a run has are none."""
ROUNDED = 1e-6
"""Tolerance for the rounding of a time."""


def switching_findings(case: Case) -> Iterator[Finding]:
    """Yield the finding about the minimum on/off time of a run's drive; none without such a rule."""
    least = getattr(case.scenario.vehicle.drive, "least_switching_s", 0.0)
    record = case.record
    if not least or record.strategy not in JUDGED:
        return
    if record.tractive_effort_n is None or record.electric_braking_n is None:
        yield Unchecked(NAME, "the table does not tell electric from friction brakes")
        return
    driving, braking = record.moving(record.tractive_effort_n), record.moving(record.electric_braking_n)
    none = NO_EFFORT * max(float(np.max(driving, initial=0.0)), float(np.max(braking, initial=0.0)))
    does = np.where(driving > none, 1, np.where(braking > none, -1, 0))
    departs = record.entering_speed2 == 0
    cut = np.append(False, case.neutral[1:] != case.neutral[:-1])
    borders = np.flatnonzero(np.append(True, departs[1:] | cut[1:] | (np.diff(does) != 0)))
    ends = np.append(borders[1:], len(does))
    # nobody switches at a stop or at the end, and a train that is moving at the beginning was switched before
    whole = (ends < len(does)) & ~np.append(departs | cut, True)[ends] & ((borders > 0) | departs[0]) & ~cut[borders]
    # what the drive does before and after each; a departure has nothing before it
    actions = does[borders]
    before, after = np.where(departs[borders], 0, np.append(0, actions[:-1])), np.append(actions[1:], 0)
    whole &= (actions != 0) | (before == after)
    lasts = np.add.reduceat(record.duration_s, borders) + 0.5 * np.maximum.reduceat(record.duration_s, borders)
    missing = np.where(whole, (least - lasts) / least, 0.0)
    yield find_largest(NAME, "drive.least_switching_s", ROUNDED, missing, record.middle_m[borders])
