"""Whether powers and energies are those of the drive's formulas, and the balance the sum of its parts.

A drive takes F v and its losses; of what it generates the line takes back the share kr. Auxiliaries come on top.

    traction, recuperated     sums of the supply power above and below 0 over time, auxiliaries excluded
    auxiliaries               their power times the whole time
    running, curve resistance, friction brakes, potential    forces times distance
    kinetic                   inertia (v_end^2 - v_start^2) / 2
    losses of the drive       its formulas, over time; brake resistors: generated and not recuperated
    traction - recuperated    = resistances + losses + kinetic + potential

Deviations are shares of the work at the wheels or at the supply, with either sign.
"""

from collections.abc import Iterator, Mapping

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
# Sums over some 1e5 cells in another order than that of the product differ by 1e-11 of their parts. 1e-7 leaves room
# for the residue of a solver in the balance of forces, and is a thousandth of the last digit that is printed.
SUM_TOLERANCE = 1e-7
# A bound holds for every driving; the balance of a run over cells takes each at its mean speed, and may be too low by
# that: by 1.6e-3 at most in 300 random scenarios over their own meshes, in cells next to stops.
BOUND_TOLERANCE = 2e-3
"""How far below a bound the balance over cells may put an energy, as a share of the bound."""
# The statement of the product, written down again: the compared value must not come from the same line. On a line
# downhill the net energy crosses zero, where a share of it would mean nothing.
SMALL_ENERGY_SHARE = 0.1
"""A bound near zero counts as this share of the kinetic energy at the mean speed."""
BOUND, NO_BOUND = "bound below the energy", "the run carries no bound"
FLOWS = ("traction_j", "recuperated_j", "auxiliary_j")
"""Energies from and to the supply; the other entries of a balance are their uses."""

Rule = tuple[str, float, float]
"""Name, deviation [J] and allowed share of the energy moved."""


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
        yield Unchecked("line power of each brake", "the table gives one effort for both, so only what is possible")
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
    low = high = case.supply_power_of_effort_w(-np.clip(limit, least, most), speed, brakes)
    for _ in range(SEARCHES):
        shared = [least + share * (most - least) for share in np.linspace(0, 1, SHARES)]
        powers = np.array([case.supply_power_of_effort_w(-electric, speed, brakes) for electric in shared])
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
        reason = "has no column current_a" if record.current_a is None else "gives one effort for both brakes"
        yield Unchecked("motor current", f"the table {reason}")
        return
    # a drive that is off has no current, though its formula would tell that of its flux
    current = np.where(case.off, 0.0, current)
    large = float(np.nanmax(np.abs(np.append(current, scale)), initial=1e-9))
    misses = np.nan_to_num(np.abs(case.moving(record.current_a) - current)) / large
    yield find_largest("motor current", "the largest current", ROUNDED_CURRENT, misses, case.middle_m)


def balance_findings(case: Case) -> Iterator[Finding]:
    """Yield all findings about a run's energies."""
    record, energies, losses = case.record, case.record.energies_j, case.record.losses_j
    if record.supply_energy_j is None or record.supply_power_w is None:
        yield Unchecked("energy so far", "the table has not both columns line_power_kw and line_energy_kwh")
    else:
        # auxiliaries included, and cells without length too: a standing train takes their power
        energy = np.append(0.0, np.cumsum(record.supply_power_w * np.diff(record.time_s)))
        misses = np.abs(record.supply_energy_j - energy) / case.energy_scale_j
        yield find_largest("energy so far", "the energy moved", SUM_TOLERANCE, misses, record.position_m)
    if energies is None or losses is None:
        yield Unchecked("account", "a table of nodes has none")
        yield Unchecked(BOUND, NO_BOUND)
        return
    # with auxiliaries
    net_j = energies["traction_j"] - energies["recuperated_j"] + energies["auxiliary_j"]
    rules = (*_flow_rules(case, energies), *_loss_rules(case, dict(losses)), *_sum_rules(case, energies, losses, net_j))
    for name, miss_j, allowed in rules:
        yield find_largest(f"account: {name}", "the energy moved", allowed, miss_j / case.energy_scale_j)
    if not np.isfinite(case.terminal_power_w).all():
        yield Unchecked("account: losses of the drive", "its motors cannot do what the run asks of them")
    if record.bound_j is None or record.gap is None:
        yield Unchecked(BOUND, NO_BOUND)
        return
    mean_speed = (record.position_m[-1] - record.position_m[0]) / (record.time_s[-1] - record.time_s[0])
    kinetic = 0.5 * case.train.inertia_kg * mean_speed**2
    gap = (net_j - record.bound_j) / max(abs(record.bound_j), SMALL_ENERGY_SHARE * kinetic)
    # above 1 relative, below absolute: the gap of a proven optimum is itself nothing but rounding
    yield find_largest("gap", "the gap, at least 1", SUM_TOLERANCE, abs(gap - record.gap) / max(abs(gap), 1.0))
    yield find_largest(BOUND, "the bound", BOUND_TOLERANCE, -gap)


def _flow_rules(case: Case, energies_j: Mapping[str, float]) -> Iterator[Rule]:
    """Compare each energy with its sum over the run."""
    record, seconds = case.record, np.diff(case.record.time_s)
    assert record.supply_power_w is not None
    # the balance has the auxiliaries separately, so they are subtracted before the sign decides about recuperation
    power = record.supply_power_w - case.auxiliary_power_w
    sums = {
        "traction_j": np.maximum(power, 0.0) @ seconds,
        "recuperated_j": np.maximum(-power, 0.0) @ seconds,
        "auxiliary_j": case.auxiliary_power_w * (record.time_s[-1] - record.time_s[0]),
        "running_resistance_j": case.resistance_n @ case.length_m,
        "curve_resistance_j": case.curve_n @ case.length_m,
        "kinetic_j": 0.5 * case.train.inertia_kg * (record.speed_ms[-1] ** 2 - record.speed_ms[0] ** 2),
        "potential_j": case.gradient_n @ case.length_m,
    }
    for name, joules in sums.items():
        yield name.removesuffix("_j").replace("_", " "), abs(energies_j[name] - joules), SUM_TOLERANCE


def _loss_rules(case: Case, reported: dict[str, float]) -> Iterator[Rule]:
    """Compare each kind of loss, taken out of those reported; kinds of only one side are compared in their sum."""
    assert case.record.friction_braking_n is not None
    friction = float(case.moving(case.record.friction_braking_n) @ case.length_m)
    yield "friction brakes", abs(reported.pop("friction_brakes", 0.0) - friction), SUM_TOLERANCE
    if not np.isfinite(case.terminal_power_w).all():
        return
    # generated and not recuperated; a draw in braking is no loss of resistors, hence the minimum with 0
    resistors = -(1 - case.recuperation_factor) * np.minimum(case.terminal_power_w, 0.0)
    losses = {**case.losses_w, "brake_resistors": resistors}
    sums = {kind: float(watts @ case.duration_s) for kind, watts in losses.items()}
    # tabulated losses may be off by their accuracy in each cell, all in the same direction at worst
    uncertain_j = float(case.loss_uncertainty_w @ case.duration_s) + case.rounded_effort_work_j
    allowed = SUM_TOLERANCE + uncertain_j / case.energy_scale_j
    for kind in sorted(sums.keys() & reported.keys()):
        yield kind.replace("_", " "), abs(reported.pop(kind) - sums.pop(kind)), allowed
    if reported or sums:
        yield "other losses", abs(sum(reported.values()) - sum(sums.values())), allowed


def _sum_rules(
    case: Case, energies_j: Mapping[str, float], losses_j: Mapping[str, float], net_j: float
) -> Iterator[Rule]:
    """Compare the entries with one another: an entry that one side lacks breaks only these rules."""
    parts = sum(losses_j.values()) + sum(joules for name, joules in energies_j.items() if name not in FLOWS)
    miss = abs(parts - energies_j["traction_j"] + energies_j["recuperated_j"])
    yield "closes", miss, SUM_TOLERANCE + case.rounded_effort_work_j / case.energy_scale_j
    yield "no negative loss", -min(losses_j.values(), default=0.0), SUM_TOLERANCE
    if case.record.supply_energy_j is not None:
        yield "net energy", abs(case.record.supply_energy_j[-1] - net_j), SUM_TOLERANCE
