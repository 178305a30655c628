"""Whether a run's energy balance is the sum of its parts, and its bound below its energy.

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

from railjoule.core.check.case import Case
from railjoule.core.check.result import Finding, Unchecked, find_largest

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


def account_findings(case: Case) -> Iterator[Finding]:
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
