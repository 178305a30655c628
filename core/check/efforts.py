"""Whether the efforts keep the limits of vehicle and motors, and the brakes share as they must.

Limits hold at a cell's mean speed, where its effort acts. What the last stated digit of the speeds makes of a force is
taken off first.
"""

from collections.abc import Iterator

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.check.case import Case
from railjoule.core.check.limits import curve_limit_n, limit_beyond_breakdown_n
from railjoule.core.check.result import Check, Finding, Unchecked, largest_of
from railjoule.core.units import N_PER_KN, W_PER_KW

# Interior points stop just inside a limit, exact coasting and joined runs put some efforts just beyond it. 2e-6 of the
# largest effort is below a newton for trains of up to 500 kN.
ROUNDED_LIMIT = 2e-6
"""A vehicle without an electric brake may have a billionth of its tractive effort, and solvers stop near a limit."""
# Where two limits cross, the smaller of both has a kink that a cubic per piece of speed cannot follow. Larger, and a
# limit that is wrong by half a per cent would pass; smaller, and a run along a rounded corner would be called a fault.
ROUNDED_CORNERS = 2e-3
"""The product rounds the corners of limits that vary with speed, those of motors and curves; here they are exact."""
# the pull-out torque of machines without voltage to spare falls towards nothing at high speed
LEAST_SHARE = 0.01
"""Of the largest effort; limits below it count as this much, or a deviation would be a share of nothing."""


def effort_findings(case: Case) -> Iterator[Finding]:
    """Yield all findings about a run's efforts."""
    record = case.record
    if record.effort_n is None or record.tractive_effort_n is None:
        yield Unchecked("efforts and their limits", "the table has no column effort_kn")
        return
    yield from _traction(case, record.moving(record.tractive_effort_n))
    if case.route.neutral:
        yield _neutral(case)
    if record.electric_braking_n is None or record.friction_braking_n is None:
        yield from _all_brakes(case, np.maximum(-record.moving(record.effort_n), 0.0))
        return
    electric, friction = record.moving(record.electric_braking_n), record.moving(record.friction_braking_n)
    yield from _brakes(case, electric, friction)
    yield _signs(case)
    yield _sharing(case, electric, friction)


def _traction(case: Case, effort_n: FloatArray) -> Iterator[Check]:
    traction, speed = case.scenario.vehicle.traction, case.record.mean_speed_ms
    if traction.max_effort_kn is not None:
        yield _effort(case, "tractive effort", effort_n, np.full(len(effort_n), traction.max_effort_kn * N_PER_KN))
    if traction.max_power_kw is not None:
        yield _power(case, "tractive power", effort_n, traction.max_power_kw * W_PER_KW)
    if traction.curve is not None:
        # the product tabulates the same curve with rounded corners
        limit = curve_limit_n(traction.curve, speed)
        yield _effort(case, "curve of tractive effort", effort_n, limit, ROUNDED_CORNERS)
    if traction.breakdown_speed_kmh is not None:
        limit = limit_beyond_breakdown_n(traction, speed)
        yield _effort(case, "breakdown of tractive effort", effort_n, limit, ROUNDED_CORNERS)
    if case.scenario.line.rail_condition is not None:
        yield _effort(case, "adhesion of the driven axles", effort_n, case.adhesion_n[0])
    yield from _motors(case, "motors while driving", effort_n, False)


def _neutral(case: Case) -> Check:
    """Compare the effort of the drive with none where there is no traction power."""
    # where one number tells of all brakes, the drive's share is known of driving alone
    record = case.record
    told = record.electric_braking_n is not None
    effort = np.abs(case.electric_n) if told else np.maximum(case.electric_n, 0.0)
    used = np.where(case.neutral, effort - case.rounding_n, 0.0)
    return largest_of(
        "neutral sections", "the largest effort", ROUNDED_LIMIT, used / case.effort_scale_n, record.middle_m
    )


def _brakes(case: Case, electric_n: FloatArray, friction_n: FloatArray) -> Iterator[Check]:
    braking = case.scenario.vehicle.braking
    if braking.max_effort_kn is not None:
        limit = np.full(len(electric_n), braking.max_effort_kn * N_PER_KN)
        yield _effort(case, "electric braking effort", electric_n, limit)
    if braking.max_power_kw is not None:
        yield _power(case, "electric braking power", electric_n, braking.max_power_kw * W_PER_KW)
    if braking.curve is not None:
        limit = curve_limit_n(braking.curve, case.record.mean_speed_ms)
        yield _effort(case, "curve of electric braking effort", electric_n, limit, ROUNDED_CORNERS)
    if braking.breakdown_speed_kmh is not None:
        limit = limit_beyond_breakdown_n(braking, case.record.mean_speed_ms)
        yield _effort(case, "breakdown of electric braking effort", electric_n, limit, ROUNDED_CORNERS)
    yield from _motors(case, "motors while braking", electric_n, True)
    limit = np.full(len(friction_n), braking.friction_effort_kn * N_PER_KN)
    yield _effort(case, "friction braking effort", friction_n, limit)
    if case.scenario.line.rail_condition is not None:
        yield _effort(case, "adhesion under the electric brake", electric_n, case.adhesion_n[0])
        yield _effort(case, "adhesion of the braked axles", electric_n + friction_n, case.adhesion_n[1])


def _all_brakes(case: Case, braking_n: FloatArray) -> Iterator[Finding]:
    """Compare the sum of the brakes alone, where nothing tells how they share."""
    friction = case.scenario.vehicle.braking.friction_effort_kn * N_PER_KN
    # the weakest true statement: whatever the sharing, both brakes together do not do more than both can
    limit = np.minimum(case.electric_limit_n + friction, case.adhesion_n[1])
    excess = (braking_n - limit - case.rounding_n) / case.effort_scale_n
    yield largest_of("effort of all brakes", "the largest effort", ROUNDED_CORNERS, excess, case.record.middle_m)
    for name in ("electric braking effort", "friction braking effort", "sharing of the brakes"):
        yield Unchecked(name, "the table tells one effort for both brakes")


def _effort(case: Case, name: str, effort_n: FloatArray, limit_n: FloatArray, allowed: float = ROUNDED_LIMIT) -> Check:
    excess = (effort_n - limit_n - case.rounding_n) / case.effort_scale_n
    return largest_of(name, "the largest effort", allowed, excess, case.record.middle_m)


def _power(case: Case, name: str, effort_n: FloatArray, limit_w: float) -> Check:
    # power at the wheels, at the mean speed: effort times distance over time is then exactly the work over the time
    excess = (effort_n - case.rounding_n) * case.record.mean_speed_ms / limit_w - 1
    return largest_of(name, "the limit", ROUNDED_LIMIT, excess, case.record.middle_m)


def _motors(case: Case, name: str, effort_n: FloatArray, braking: bool) -> Iterator[Check]:
    """Compare with the largest effort of the motors, if they have a limit of their own."""
    used = effort_n > 0
    limit = case.model.largest_effort_n(case.record.mean_speed_ms[used], braking)
    if np.isinf(limit).all():
        return
    # the rounding of a limit of its own comes on top of that of the corners, hence it is taken off here
    scale = np.maximum(limit, LEAST_SHARE * case.effort_scale_n)
    excess = (effort_n[used] - limit - case.rounding_n[used]) / scale - ROUNDED_LIMIT
    yield largest_of(name, "the motors' largest effort", ROUNDED_CORNERS, excess, case.record.middle_m[used])


def _signs(case: Case) -> Check:
    """Compare each part with zero, and driving with braking: never both at once."""
    record = case.record
    assert record.tractive_effort_n is not None
    assert record.electric_braking_n is not None
    assert record.friction_braking_n is not None
    parts = np.array([record.tractive_effort_n, record.electric_braking_n, record.friction_braking_n])
    both = np.minimum(parts[0], parts[1] + parts[2])
    misses = np.maximum(both, -parts.min(axis=0)) / case.effort_scale_n
    return largest_of("drives or brakes, not both", "the largest effort", ROUNDED_LIMIT, misses, record.position_m[:-1])


def _sharing(case: Case, electric_n: FloatArray, friction_n: FloatArray) -> Check:
    """Compare with a full electric brake: friction may only do what it cannot, or what would cost line power."""
    used = friction_n > ROUNDED_LIMIT * case.effort_scale_n
    electric, speed = electric_n[used], case.record.mean_speed_ms[used]
    # What the electric brake could have done of the whole braking. That friction helps is no fault where the full
    # electric brake would have drawn power: so the line power of both sharings is compared, not the efforts.
    full = np.minimum(electric + friction_n[used], np.maximum(case.electric_limit_n[used], electric))
    lost = case.line_power_of_effort_w(-electric, speed) - case.line_power_of_effort_w(-full, speed)
    if case.record.line_power_w is not None:
        # twice, as both powers of the difference are uncertain
        lost = lost - 2 * case.loss_uncertainty_w[used]
    scale = np.maximum(full * speed, 1e-3 * case.effort_scale_n * np.max(speed, initial=1.0))
    share = np.nan_to_num(lost / scale)
    return largest_of("sharing of the brakes", "the braking power", ROUNDED_CORNERS, share, case.record.middle_m[used])
