"""Whether a run's account is the sum of its parts, and its bound below its energy.

    traction, recuperated     sums of the line power above and below 0 over time, auxiliaries apart
    auxiliaries               their power times the whole time
    running, curve resistance, friction brakes, potential    forces times distance
    kinetic                   inertia (v_end^2 - v_start^2) / 2
    losses of the drive       its formulas, over time; brake resistors: what is generated and not taken back
    traction - recuperated    = resistances + losses + kinetic + potential

Deviations are shares of the work at the wheels or at the line, with either sign.
"""

from collections.abc import Iterator, Mapping

import numpy as np

from railjoule.core.check.case import Case
from railjoule.core.check.result import Check, Finding, Unchecked, largest_of

# Sums over some 1e5 cells in another order than that of the product differ by 1e-11 of their parts. 1e-7 leaves room
# for what a solver leaves of the balance of forces, and is a thousandth of the last digit that is printed.
SUM_TOLERANCE = 1e-7
# A bound holds for every driving; the account of a run over cells takes each at its mean speed, and may be too low by
# that: by 1.6e-3 at most in 300 random scenarios over their own meshes, in cells next to stops.
BOUND_TOLERANCE = 2e-3
"""How far below a bound the account over cells may put an energy, as a share of the bound."""
# The statement of the product, written down again: what is compared with it must not come from the same line. On a
# line downhill the net energy crosses zero, where a share of it would mean nothing.
SMALL_ENERGY_SHARE = 0.1
"""A bound near zero counts as this share of the kinetic energy at the mean speed."""
FLOWS = ("traction_j", "recuperated_j", "auxiliary_j")
"""What the line gives and takes; the other entries of an account are where it goes."""


def account_findings(case: Case) -> Iterator[Finding]:
    """Yield all findings about a run's energies."""
    yield _so_far(case)
    yield from _account(case)
    yield from _bound(case)


def _so_far(case: Case) -> Finding:
    record = case.record
    if record.line_energy_j is None or record.line_power_w is None:
        return Unchecked("energy so far", "the table has not both columns line_power_kw and line_energy_kwh")
    # auxiliaries included, and cells without length too: a standing train takes their power
    energy = np.append(0.0, np.cumsum(record.line_power_w * np.diff(record.time_s)))
    misses = np.abs(record.line_energy_j - energy) / case.energy_scale_j
    return largest_of("energy so far", "the energy moved", SUM_TOLERANCE, misses, record.position_m)


def _account(case: Case) -> Iterator[Finding]:
    record = case.record
    reported, losses = record.energies_j, record.losses_j
    if reported is None or losses is None or record.line_power_w is None:
        yield Unchecked("account", "a table of nodes has none")
        return
    # the account has the auxiliaries apart, so they are taken off before the sign tells driving from recuperating
    power, seconds = record.line_power_w - case.auxiliary_power_w, np.diff(record.time_s)
    sums = {
        "traction_j": np.sum(np.maximum(power, 0.0) * seconds),
        "recuperated_j": np.sum(np.maximum(-power, 0.0) * seconds),
        "auxiliary_j": case.auxiliary_power_w * (record.time_s[-1] - record.time_s[0]),
        "running_resistance_j": np.sum(case.resistance_n * record.length_m),
        "curve_resistance_j": np.sum(case.curve_n * record.length_m),
        "kinetic_j": 0.5 * case.train.inertia_kg * (record.speed_ms[-1] ** 2 - record.speed_ms[0] ** 2),
        "potential_j": np.sum(case.gradient_n * record.length_m),
    }
    for name, joules in sums.items():
        yield _energy(case, f"account: {name.removesuffix('_j').replace('_', ' ')}", reported[name] - joules)
    # a copy, as the kinds that are compared are taken out of it one by one
    yield from _losses(case, dict(losses))
    # That each entry is right and that they add up are two rules: an entry that one side lacks breaks this one alone.
    parts = sum(losses.values()) + sum(joules for name, joules in reported.items() if name not in FLOWS)
    miss = parts - reported["traction_j"] + reported["recuperated_j"]
    yield _energy(case, "account: closes", miss, SUM_TOLERANCE + _rounded_effort_work_j(case) / case.energy_scale_j)
    yield _energy(case, "account: no negative loss", -min(losses.values(), default=0.0), signed=True)
    if record.line_energy_j is not None:
        yield _energy(case, "account: net energy", record.line_energy_j[-1] - _net_j(reported))


def _losses(case: Case, reported_j: dict[str, float]) -> Iterator[Finding]:
    """Compare each kind of loss; kinds that only one side knows are compared in their sum."""
    record = case.record
    assert record.line_power_w is not None
    assert record.friction_braking_n is not None
    friction = np.sum(record.moving(record.friction_braking_n) * record.length_m)
    yield _energy(case, "account: friction brakes", reported_j.pop("friction_brakes", 0.0) - friction)
    if not np.isfinite(case.terminal_power_w).all():
        yield Unchecked("account: losses of the drive", "its motors cannot do what the run asks of them")
        return
    losses = dict(case.losses_w)
    # what is generated and not taken back; a draw in braking is no loss of theirs, hence the minimum with 0
    losses["brake_resistors"] = -(1 - case.recuperation_factor) * np.minimum(case.terminal_power_w, 0.0)
    sums = {kind: float(np.sum(watts * record.duration_s)) for kind, watts in losses.items()}
    # a product that tabulates its losses may be off by that much in each cell, all in the same direction at worst
    uncertain_j = float(np.sum(case.loss_uncertainty_w * record.duration_s)) + _rounded_effort_work_j(case)
    allowed = SUM_TOLERANCE + uncertain_j / case.energy_scale_j
    for kind in sorted(sums.keys() & reported_j.keys()):
        miss = reported_j.pop(kind) - sums.pop(kind)
        yield _energy(case, f"account: {kind.replace('_', ' ')}", miss, allowed)
    if reported_j or sums:
        yield _energy(case, "account: other losses", sum(reported_j.values()) - sum(sums.values()), allowed)


def _rounded_effort_work_j(case: Case) -> float:
    """Return the work of efforts that are rounding while the drive is off [J], which is a loss of no reported kind."""
    return float(np.sum(np.where(case.off, np.abs(case.electric_n) * case.record.length_m, 0.0)))


def _energy(case: Case, name: str, miss_j: float, allowed: float = SUM_TOLERANCE, signed: bool = False) -> Check:
    return largest_of(name, "the energy moved", allowed, (miss_j if signed else abs(miss_j)) / case.energy_scale_j)


def _net_j(reported_j: Mapping[str, float]) -> float:
    """Return traction less recuperated, with auxiliaries [J]."""
    return reported_j["traction_j"] - reported_j["recuperated_j"] + reported_j["auxiliary_j"]


def _bound(case: Case) -> Iterator[Finding]:
    record = case.record
    if record.bound_j is None or record.energies_j is None or record.gap is None:
        yield Unchecked("bound below the energy", "the run carries no bound")
        return
    net = _net_j(record.energies_j)
    mean_speed = (record.position_m[-1] - record.position_m[0]) / (record.time_s[-1] - record.time_s[0])
    kinetic = 0.5 * case.train.inertia_kg * mean_speed**2
    gap = (net - record.bound_j) / max(abs(record.bound_j), SMALL_ENERGY_SHARE * kinetic)
    # above 1 relative, below absolute: the gap of a proven optimum is itself nothing but rounding
    yield largest_of("gap", "the gap, at least 1", SUM_TOLERANCE, abs(gap - record.gap) / max(abs(gap), 1.0))
    yield largest_of("bound below the energy", "the bound", BOUND_TOLERANCE, -gap)
