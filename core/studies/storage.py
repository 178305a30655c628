"""How large an on-board storage must be to keep what braking generates, and what each size saves.

The drop of the cumulative energy at the link, (13), from one of its heights to the lowest point after it is what a
storage without losses would have to hold. A storage charges with what braking generates, as far as its size and power
reach, and gives it back to the next driving and to the auxiliaries; what it cannot take is dissipated in resistors. A
run counts as one of many alike: it begins with the charge with which it ends.

Source: Shtompel, Khvorost 2025, (13) and conclusion 2; the storage with losses is ours.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compiled import njit
from railjoule.core.drive import make_drive
from railjoule.core.errors import ScenarioError
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH, W_PER_KW

# Shtompel and Khvorost print no efficiency. Assumed: a storage with its converter keeps about 0.9 of what goes in and
# out again, lost in equal parts. A saving is at most the product of both efficiencies times what braking generates.
ASSUMED_EFFICIENCY = 0.95
"""What a storage keeps of what it takes, and gives of what it keeps, where nothing else is stated."""
# Assumed: 18 hours of service, and half a minute at a terminus. Only the cycles per day depend on these two, in
# proportion to the first.
ASSUMED_SERVICE_S, ASSUMED_TURNAROUND_S = 64_800.0, 30.0
"""Service in a day, and standing time between two runs [s], where nothing else is stated."""
DAY_S = 86_400.0
# far below the last printed digit of a saving, far above the rounding of sums over thousands of cells
SAME_CHARGE_SHARE = 1e-9
"""Charges that differ by less than this share of a storage's size are the same."""


@dataclass(frozen=True)
class Storage:
    """An on-board storage.

    Parameters
    ----------
    size_kwh : float
        What it holds [kWh].
    power_kw : float
        Its largest power at the link, either way [kW].
    charging_efficiency, discharging_efficiency : float
        What it stores of what it takes, and gives of what it stores.
    """

    size_kwh: float
    power_kw: float
    charging_efficiency: float = ASSUMED_EFFICIENCY
    discharging_efficiency: float = ASSUMED_EFFICIENCY

    def __post_init__(self) -> None:
        for name in ("size_kwh", "power_kw"):
            value = getattr(self, name)
            if not 0 <= value < np.inf:
                raise ScenarioError(f"storage.{name} = {value:g} must be a number of at least 0.")
        for name in ("charging_efficiency", "discharging_efficiency"):
            value = getattr(self, name)
            if not 0 < value <= 1:
                raise ScenarioError(f"storage.{name} = {value:g} must be above 0 and at most 1.")


@dataclass(frozen=True)
class StorageNeed:
    """What a run asks of a storage that would keep all that it generates without loss.

    Parameters
    ----------
    largest_drop_kwh : float
        Of the cumulative energy at the link [kWh].
    charging_peak_kw, discharging_peak_kw : float
        Largest powers at the link [kW].
    generated_kwh : float
        What braking generates beyond the auxiliaries [kWh].
    cycles : float
        Full cycles of that size in a run.
    cycles_per_day : float
        The same in a day of service.
    """

    largest_drop_kwh: float
    charging_peak_kw: float
    discharging_peak_kw: float
    generated_kwh: float
    cycles: float
    cycles_per_day: float


@dataclass(frozen=True)
class StorageRun:
    """A run with a storage, beside the same without one.

    Parameters
    ----------
    storage : Storage
    energy_kwh : float
        Taken from the line [kWh]; nothing goes back.
    with_resistors_kwh : float
        The same without storage, all that comes back dissipated [kWh].
    with_receptive_line_kwh : float
        The same where the line takes all that comes back [kWh].
    storage_loss_kwh, dissipated_kwh : float
        Lost in the storage, and dissipated in the resistors beside it [kWh].
    cycles : float
        Full cycles of the storage in a run.
    """

    storage: Storage
    energy_kwh: float
    with_resistors_kwh: float
    with_receptive_line_kwh: float
    storage_loss_kwh: float
    dissipated_kwh: float
    cycles: float

    @property
    def saved_kwh(self) -> float:
        """Less from the line than with resistors [kWh]."""
        return self.with_resistors_kwh - self.energy_kwh


def link_power_w(run: Trajectory) -> tuple[FloatArray, FloatArray]:
    """Return power at the link, auxiliaries included, negative where braking feeds it, and durations of all cells.

    Both of shape (n,), in W and s; whatever the line takes back.
    """
    vehicle = run.scenario.vehicle
    duration, length = np.diff(run.time_s), np.diff(run.position_m)
    # a dwell has no length: at speed 0 only the auxiliaries take power
    speed = np.divide(length, duration, out=np.zeros_like(duration), where=duration > 0)
    effort = run.tractive_effort_n - run.electric_braking_n
    power = make_drive(vehicle.drive).electrical_power_w(effort, speed) + vehicle.auxiliary_power_kw * W_PER_KW
    return power, duration


def storage_need(
    run: Trajectory, service_time_s: float = ASSUMED_SERVICE_S, turnaround_s: float = ASSUMED_TURNAROUND_S
) -> StorageNeed:
    """Return what a run asks of a storage.

    Parameters
    ----------
    run : Trajectory
        Over one run or a whole line with its stations.
    service_time_s : float
        Service in a day [s].
    turnaround_s : float
        Standing time between two such runs [s].

    Raises
    ------
    ScenarioError
        If a time is negative, or there is none at all.
    """
    for name, value, most in (("service_time_s", service_time_s, DAY_S), ("turnaround_s", turnaround_s, DAY_S)):
        if not 0 <= value <= most:
            raise ScenarioError(f"{name} = {value:g} must be from 0 to {most:g}.")
    power, duration = link_power_w(run)
    energy = np.append(0.0, np.cumsum(power * duration))
    # the largest fall from any height to any later point, not from the end: what is between them must be stored at
    # once
    drop = float(np.max(np.maximum.accumulate(energy) - energy))
    generated = float(-np.sum(np.minimum(power, 0.0) * duration))
    cycles = generated / drop if drop > 0 else 0.0
    return StorageNeed(
        largest_drop_kwh=drop / J_PER_KWH,
        charging_peak_kw=float(-np.min(power, initial=0.0)) / W_PER_KW,
        discharging_peak_kw=float(np.max(power, initial=0.0)) / W_PER_KW,
        generated_kwh=generated / J_PER_KWH,
        cycles=cycles,
        cycles_per_day=cycles * service_time_s / (run.travel_time_s + turnaround_s),
    )


def with_storage(run: Trajectory, storage: Storage) -> StorageRun:
    """Return what a storage makes of a run, which is driven as without it."""
    power, duration = link_power_w(run)
    return _stored(power, duration, storage)


def saving_over_size(
    run: Trajectory,
    sizes_kwh: Sequence[float] | FloatArray,
    power_kw: float,
    charging_efficiency: float = ASSUMED_EFFICIENCY,
    discharging_efficiency: float = ASSUMED_EFFICIENCY,
) -> FloatArray:
    """Return what storages of one power save against resistors [kWh]; shape as that of the sizes.

    Parameters
    ----------
    run : Trajectory
        Over one run or a whole line with its stations.
    sizes_kwh : sequence of float
        What they hold [kWh].
    power_kw : float
        Their power [kW].
    charging_efficiency, discharging_efficiency : float
        As in `Storage`.

    Raises
    ------
    ScenarioError
        If a size or the power is negative, or an efficiency no share.
    """
    power, duration = link_power_w(run)
    storages = [Storage(float(size), power_kw, charging_efficiency, discharging_efficiency) for size in sizes_kwh]
    return frozen_array([_stored(power, duration, storage).saved_kwh for storage in storages])


def _stored(power_w: FloatArray, duration_s: FloatArray, storage: Storage) -> StorageRun:
    size, most = storage.size_kwh * J_PER_KWH, storage.power_kw * W_PER_KW

    def one_run(charge_j: float) -> tuple[float, float, float, float, float]:
        efficiencies = storage.charging_efficiency, storage.discharging_efficiency
        return _one_run(power_w, duration_s, size, most, *efficiencies, charge_j)

    drawn, dissipated, taken, given, _ = one_run(_lasting_charge_j(lambda charge_j: one_run(charge_j)[-1], size))
    demand = float(np.sum(np.maximum(power_w, 0.0) * duration_s))
    offered = float(-np.sum(np.minimum(power_w, 0.0) * duration_s))
    return StorageRun(
        storage=storage,
        energy_kwh=drawn / J_PER_KWH,
        with_resistors_kwh=demand / J_PER_KWH,
        with_receptive_line_kwh=(demand - offered) / J_PER_KWH,
        storage_loss_kwh=(taken - given) / J_PER_KWH,
        dissipated_kwh=dissipated / J_PER_KWH,
        cycles=taken * storage.charging_efficiency / size if size > 0 else 0.0,
    )


def _lasting_charge_j(charge_after: Callable[[float], float], size_j: float) -> float:
    """Return the charge with which a run of many alike begins and ends [J].

    Parameters
    ----------
    charge_after : callable
        The charge at the end of a run over that at its start [J].
    size_j : float
        The full charge [J].
    """
    # Each cell either raises the charge by an amount of its own, at most to full, or lowers it so, at most to empty.
    # So a whole run makes min(max(c + a, low), high) of a charge c. Repeated from empty, that stays at `low` from the
    # first run on unless a > 0; then it rises by a each time to `high`, however many runs that takes, and one run from
    # full ends there as well.
    first = charge_after(0.0)
    second = charge_after(first)
    settled = abs(second - first) <= SAME_CHARGE_SHARE * max(size_j, 1.0)
    return first if settled else charge_after(size_j)


@njit(cache=True, nogil=True)
def _one_run(
    power: FloatArray,
    duration: FloatArray,
    size: float,
    most: float,
    charging: float,
    discharging: float,
    charge: float,
) -> tuple[float, float, float, float, float]:
    """Return energies drawn, dissipated, taken and given by a storage [J], and its charge at the end [J]."""
    drawn = dissipated = taken = given = 0.0
    for i in range(power.shape[0]):
        energy, limit = power[i] * duration[i], most * duration[i]
        if energy < 0.0:
            # energies at the link: what goes in shrinks by the efficiency before it counts against the size
            into = min(-energy, limit, (size - charge) / charging)
            charge += into * charging
            taken += into
            dissipated += -energy - into
        else:
            out = min(energy, limit, charge * discharging)
            charge -= out / discharging
            given += out
            drawn += energy - out
    return drawn, dissipated, taken, given, charge
