"""Whether the line's power is what the drive takes, and the account its sums; and the bound below the energy.

    traction, recuperated     sums of the line power above and below 0 over time, auxiliaries apart
    auxiliaries               their power times the whole time
    running, curve resistance, friction brakes, potential    forces times way
    kinetic                   inertia (v_end^2 - v_start^2) / 2
    losses of the drive       its formulas, over time; brake resistors: what is generated and not taken back
    traction - recuperated    = resistances + losses + kinetic + potential

Deviations of energies are shares of the work at the wheels with either sign.
"""

from collections.abc import Iterator

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.check.case import Case
from railjoule.core.check.efforts import electric_limit_n
from railjoule.core.check.result import Check, Finding, Unchecked, largest_of

ROUNDED_SUM = 1e-7
ROUNDED_POWER = 1e-8
ROUNDED_CURRENT = 1e-6
BOUND = 1e-6
"""How far below a bound rounding may put an energy, as a share of the bound."""
SMALL_ENERGY_SHARE = 0.1
"""A bound near zero counts as this share of the kinetic energy at the mean speed."""
LEAST_COVERED_MS = 0.1
"""A bound covers runs that go nowhere slower between their stops, 0.36 km/h."""
OFF = 1e-6
"""Efforts below this share of the largest one may be rounding, and then the drive is off."""
SHARES, SEARCHES = 17, 4
"""How many ways to share the brakes are looked at where nothing tells how they do, and how often around the best."""


def energy_findings(case: Case) -> Iterator[Finding]:
    """Yield all findings about a run's powers and energies."""
    yield from _powers(case)
    yield _so_far(case)
    yield from _account(case)
    yield from _bound(case)


def _powers(case: Case) -> Iterator[Finding]:
    record = case.record
    if record.line_power_w is None or record.effort_n is None:
        missing = "effort_kn" if record.effort_n is None else "line_power_kw"
        yield Unchecked("line power", f"the table has no column {missing}")
        return
    told, standing = record.moving(record.line_power_w) - _auxiliaries_w(case), record.line_power_w[~record.moves]
    effort, speed = record.moving(record.effort_n), record.mean_speed_ms
    large = float(np.max(np.abs(told), initial=0.0))
    scale = np.maximum(np.abs(told), np.abs(effort * speed)) + OFF * large + 1.0
    if record.electric_braking_n is None:
        electric = effort
        misses = _outside_sharing(case, told)
        yield Unchecked(
            "line power of electric braking",
            "the table tells one effort for both brakes, so only whether it is possible",
        )
    else:
        electric = _electric_n(case)
        misses = np.abs(told - _expected_w(case, told))
    misses = np.maximum(misses - case.unsure_w(electric), 0.0)
    misses = np.append(np.nan_to_num(misses / scale), np.abs(standing - _auxiliaries_w(case)) / (large + 1.0))
    places = np.append(record.middle_m, record.position_m[:-1][~record.moves])
    yield largest_of("line power", "the power", ROUNDED_POWER, misses, places)
    # no drive gives more than it gets, whatever its losses
    work = np.where(_is_off(case, effort, told), 0.0, effort * speed)
    least = np.where(work > 0, work, case.recuperation_factor * work)
    yield largest_of("no power from nothing", "the power", ROUNDED_POWER, (least - told) / scale, record.middle_m)
    yield from _current(case, told)


def _electric_n(case: Case) -> FloatArray:
    record = case.record
    assert record.tractive_effort_n is not None
    assert record.electric_braking_n is not None
    return record.moving(record.tractive_effort_n - record.electric_braking_n)


def _is_off(case: Case, effort_n: FloatArray, told_w: FloatArray) -> BoolArray:
    """Return where a drive is off: without effort, or with one that the run itself takes for rounding."""
    off: BoolArray = (effort_n == 0) | ((np.abs(effort_n) <= OFF * case.large_effort_n) & (told_w == 0))
    return off


def _expected_w(case: Case, told_w: FloatArray) -> FloatArray:
    """Return the line power of the drive by its formulas [W]; NaN where its motors cannot give the effort."""
    electric = _electric_n(case)
    return case.line_power_w(np.where(_is_off(case, electric, told_w), 0.0, electric))


def _outside_sharing(case: Case, told_w: FloatArray) -> FloatArray:
    """Return how far a power lies beside those of all ways to share the brakes [W]."""
    record = case.record
    assert record.effort_n is not None
    effort = record.moving(record.effort_n)
    effort = np.where(_is_off(case, effort, told_w), 0.0, effort)
    braking = np.maximum(-effort, 0.0)
    most = np.minimum(braking, electric_limit_n(case))
    least = np.minimum(np.maximum(braking - case.scenario.vehicle.braking.friction_effort_kn * 1e3, 0.0), most)
    low, high = np.full(len(effort), np.inf), np.full(len(effort), -np.inf)
    for _ in range(SEARCHES):
        shared = [least + share * (most - least) for share in np.linspace(0, 1, SHARES)]
        powers = np.array([case.line_power_w(-braking) for braking in shared])
        low, high = np.fmin(low, np.fmin.reduce(powers)), np.fmax(high, np.fmax.reduce(powers))
        # the least power lies between the neighbours of the least found, the greatest at an end or a jump
        best = np.argmin(np.nan_to_num(powers, nan=np.inf), axis=0)
        least, most = (np.choose(np.clip(best + side, 0, SHARES - 1), shared) for side in (-1, 1))
    beside = np.maximum(np.maximum(low - told_w, told_w - high), 0.0)
    return np.where(effort < 0, beside, np.abs(told_w - case.line_power_w(effort)))


def _current(case: Case, told_w: FloatArray) -> Iterator[Finding]:
    record = case.record
    if record.current_a is None or record.electric_braking_n is None:
        if record.current_a is not None:
            yield Unchecked("motor current", "the table tells one effort for both brakes")
        return
    electric = _electric_n(case)
    current = case.losses.current_a(electric, record.mean_speed_ms)
    if current is None:
        yield Unchecked("motor current", "the drive's model has none")
        return
    current = np.where(_is_off(case, electric, told_w), 0.0, current)
    large = float(np.nanmax(np.abs(current), initial=1e-9))
    misses = np.nan_to_num(np.abs(record.moving(record.current_a) - current)) / large
    yield largest_of("motor current", "the largest current", ROUNDED_CURRENT, misses, record.middle_m)


def _so_far(case: Case) -> Finding:
    record = case.record
    if record.line_energy_j is None or record.line_power_w is None:
        return Unchecked("energy so far", "the table has not both columns line_power_kw and line_energy_kwh")
    energy = np.append(0.0, np.cumsum(record.line_power_w * np.diff(record.time_s)))
    misses = np.abs(record.line_energy_j - energy) / case.moved_j
    return largest_of("energy so far", "the energy moved", ROUNDED_SUM, misses, record.position_m)


def _account(case: Case) -> Iterator[Finding]:
    record = case.record
    told, losses = record.energies_j, record.losses_j
    if told is None or losses is None or record.line_power_w is None:
        yield Unchecked("account", "a table of nodes has none")
        return
    power, seconds = record.line_power_w - _auxiliaries_w(case), np.diff(record.time_s)
    sums = {
        "traction_j": np.sum(np.maximum(power, 0.0) * seconds),
        "recuperated_j": np.sum(np.maximum(-power, 0.0) * seconds),
        "auxiliary_j": _auxiliaries_w(case) * (record.time_s[-1] - record.time_s[0]),
        "running_resistance_j": np.sum(case.resistance_n * record.length_m),
        "curve_resistance_j": np.sum(case.curve_n * record.length_m),
        "kinetic_j": 0.5 * case.train.inertia_kg * (record.speed_ms[-1] ** 2 - record.speed_ms[0] ** 2),
        "potential_j": np.sum(case.gradient_n * record.length_m),
    }
    for name, joules in sums.items():
        yield _energy(case, f"account: {name.removesuffix('_j').replace('_', ' ')}", told[name] - joules)
    yield from _losses(case, dict(losses))
    parts = sum(losses.values()) + sum(
        joules for name, joules in told.items() if name not in ("traction_j", "recuperated_j", "auxiliary_j")
    )
    yield _energy(case, "account: closes", parts - told["traction_j"] + told["recuperated_j"])
    yield _energy(case, "account: no negative loss", -min(losses.values(), default=0.0), signed=True)
    if record.line_energy_j is not None:
        net = told["traction_j"] - told["recuperated_j"] + told["auxiliary_j"]
        yield _energy(case, "account: net energy", record.line_energy_j[-1] - net)


def _losses(case: Case, told_j: dict[str, float]) -> Iterator[Finding]:
    """Compare each kind of loss; kinds that only one side knows are compared in their sum."""
    record = case.record
    assert record.line_power_w is not None
    assert record.friction_braking_n is not None
    friction = np.sum(record.moving(record.friction_braking_n) * record.length_m)
    yield _energy(case, "account: friction brakes", told_j.pop("friction_brakes", 0.0) - friction)
    electric, speed = _electric_n(case), record.mean_speed_ms
    off = _is_off(case, electric, record.moving(record.line_power_w) - _auxiliaries_w(case))
    losses = {kind: np.where(off, 0.0, watts) for kind, watts in case.losses.losses_w(electric, speed).items()}
    power = np.where(off, 0.0, electric * speed) + sum(losses.values(), np.zeros(len(speed)))
    if not np.isfinite(power).all():
        yield Unchecked("account: losses of the drive", "its motors cannot do what the run asks of them")
        return
    losses["brake_resistors"] = -(1 - case.recuperation_factor) * np.minimum(power, 0.0)
    sums = {kind: float(np.sum(watts * record.duration_s)) for kind, watts in losses.items()}
    # what a drive that is off does of an effort counts as a loss, of any kind
    unsure = case.unsure_w(electric) + np.where(off, np.abs(electric) * speed, 0.0)
    allowed = ROUNDED_SUM + float(np.sum(unsure * record.duration_s)) / case.moved_j
    for kind in sums.keys() & told_j.keys():
        miss = told_j.pop(kind) - sums.pop(kind)
        yield _energy(case, f"account: {kind.replace('_', ' ')}", miss, allowed)
    if told_j or sums:
        yield _energy(case, "account: other losses", sum(told_j.values()) - sum(sums.values()), allowed)


def _energy(case: Case, name: str, miss_j: float, allowed: float = ROUNDED_SUM, signed: bool = False) -> Check:
    return largest_of(name, "the energy moved", allowed, (miss_j if signed else abs(miss_j)) / case.moved_j)


def _bound(case: Case) -> Iterator[Finding]:
    record = case.record
    if record.bound_j is None or record.energies_j is None or record.gap is None:
        yield Unchecked("bound below the energy", "the run carries no bound")
        return
    told = record.energies_j
    net = told["traction_j"] - told["recuperated_j"] + told["auxiliary_j"]
    mean_speed = (record.position_m[-1] - record.position_m[0]) / (record.time_s[-1] - record.time_s[0])
    kinetic = 0.5 * case.train.inertia_kg * mean_speed**2
    gap = (net - record.bound_j) / max(abs(record.bound_j), SMALL_ENERGY_SHARE * kinetic)
    yield largest_of("gap", "the gap, at least 1", ROUNDED_SUM, abs(gap - record.gap) / max(abs(gap), 1.0))
    slowest = _slowest_between_stops(record.speed_ms)
    if slowest < LEAST_COVERED_MS:
        yield Unchecked(
            "bound below the energy",
            f"the run goes as slow as {3.6 * slowest:.2g} km/h, and bounds cover none below 0.36",
        )
        return
    yield largest_of("bound below the energy", "the bound", BOUND, -gap)


def _slowest_between_stops(speed_ms: FloatArray) -> float:
    """Return the least speed to which a run slows down without stopping [m/s], infinite where it never does."""
    before, here, after = speed_ms[:-2], speed_ms[1:-1], speed_ms[2:]
    dips = here[(here > 0) & (here <= before) & (here <= after)]
    return float(np.min(dips, initial=np.inf))


def _auxiliaries_w(case: Case) -> float:
    return case.scenario.vehicle.auxiliary_power_kw * 1e3
