"""The size of an on-board storage that keeps all braking energy, and the savings of each size.

A storage without losses must hold the largest drop of the cumulative energy at the link, (13), from any point to any
later one. A storage charges with braking energy within its size and power, and discharges for traction and auxiliaries;
resistors dissipate the rest. A run is one of many equal ones: it begins with the charge with which it ends.

Source: Shtompel, Khvorost 2025, (13) and conclusion 2; the storage with losses is railjoule's.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.compiled import njit
from railjoule.core.drive import make_drive
from railjoule.core.errors import ScenarioError
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH, W_PER_KW

# Shtompel and Khvorost print no efficiency. Assumed: a storage with its converter returns about 0.9 of its input, with
# equal losses in both directions. A saving is at most the product of both efficiencies times the braking energy.
ASSUMED_EFFICIENCY = 0.95
"""Default efficiency of charging and of discharging."""
# Assumed: 18 hours of service, and half a minute at a terminus. Only the cycles per day depend on these two, in
# proportion to the first.
ASSUMED_SERVICE_S, ASSUMED_TURNAROUND_S = 64_800.0, 30.0
"""Default service in a day, and standing time between two runs [s]."""
DAY_S = 86_400.0
SAME_CHARGE_SHARE = 1e-9
"""Charges that differ by less than this share of the size are equal: far below the last printed digit of a saving, far
above the rounding of sums over thousands of cells."""


@dataclass(frozen=True)
class Storage:
    """An on-board storage.

    Parameters
    ----------
    size_kwh : float
        Usable energy [kWh].
    power_kw : float
        Maximum power at the link, in both directions [kW].
    charging_efficiency, discharging_efficiency : float
        Stored energy over energy taken, and energy given over stored energy.
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
    """Requirements of a run on a storage without losses that keeps all braking energy.

    Parameters
    ----------
    max_drop_kwh : float
        Largest drop of the cumulative energy at the link [kWh].
    charging_peak_kw, discharging_peak_kw : float
        Largest powers at the link [kW].
    generated_kwh : float
        Braking energy beyond the auxiliaries [kWh].
    cycles : float
        Full cycles of that size in a run.
    cycles_per_day : float
        Full cycles in a day of service.
    """

    max_drop_kwh: float
    charging_peak_kw: float
    discharging_peak_kw: float
    generated_kwh: float
    cycles: float
    cycles_per_day: float


@dataclass(frozen=True)
class StorageRun:
    """Energies of a run with a storage and without one.

    Parameters
    ----------
    storage : Storage
    energy_kwh : float
        Energy from the supply with the storage; nothing is fed back [kWh].
    with_resistors_kwh : float
        Energy from the supply without storage, all braking energy dissipated [kWh].
    with_receptive_line_kwh : float
        Net energy from the supply without storage, all braking energy fed back [kWh].
    storage_loss_kwh, dissipated_kwh : float
        Losses of the storage, and of the resistors beside it [kWh].
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
        """Energy saved against resistors [kWh]."""
        return self.with_resistors_kwh - self.energy_kwh


def link_power_w(run: Trajectory) -> tuple[FloatArray, FloatArray]:
    """Return power at the link [W], auxiliaries included, negative while braking, and duration [s] of all cells.

    Both have the shape (n,) and do not depend on the receptivity of the supply.
    """
    vehicle = run.scenario.vehicle
    duration, length = np.diff(run.time_s), np.diff(run.position_m)
    # a dwell has no length: only the auxiliaries take power at speed 0
    speed = np.divide(length, duration, out=np.zeros_like(duration), where=duration > 0)
    effort = run.tractive_effort_n - run.electric_braking_n
    power = make_drive(vehicle.drive).electrical_power_w(effort, speed) + vehicle.auxiliary_power_kw * W_PER_KW
    return power, duration


def storage_need(
    run: Trajectory, service_time_s: float = ASSUMED_SERVICE_S, turnaround_s: float = ASSUMED_TURNAROUND_S
) -> StorageNeed:
    """Return the requirements of a run on a storage.

    Parameters
    ----------
    run : Trajectory
        One run, or a whole line with its stations.
    service_time_s : float
        Service in a day [s].
    turnaround_s : float
        Standing time between two such runs [s].

    Raises
    ------
    ScenarioError
        If a time is negative or longer than a day.
    """
    for name, value, most in (("service_time_s", service_time_s, DAY_S), ("turnaround_s", turnaround_s, DAY_S)):
        if not 0 <= value <= most:
            raise ScenarioError(f"{name} = {value:g} must be from 0 to {most:g}.")
    power, duration = link_power_w(run)
    energy = np.append(0.0, np.cumsum(power * duration))
    # the largest fall from any point to any later one: this energy is stored at the same time
    drop = float(np.max(np.maximum.accumulate(energy) - energy))
    generated = float(-np.sum(np.minimum(power, 0.0) * duration))
    cycles = generated / drop if drop > 0 else 0.0
    return StorageNeed(
        max_drop_kwh=drop / J_PER_KWH,
        charging_peak_kw=float(-np.min(power, initial=0.0)) / W_PER_KW,
        discharging_peak_kw=float(np.max(power, initial=0.0)) / W_PER_KW,
        generated_kwh=generated / J_PER_KWH,
        cycles=cycles,
        cycles_per_day=cycles * service_time_s / (run.travel_time_s + turnaround_s),
    )


def with_storage(run: Trajectory, storage: Storage) -> StorageRun:
    """Return the energies of a run with a storage, which does not change how it is driven."""
    return _stored(*link_power_w(run), storage)


def saving_over_size(
    run: Trajectory,
    sizes_kwh: Sequence[float] | FloatArray,
    power_kw: float,
    charging_efficiency: float = ASSUMED_EFFICIENCY,
    discharging_efficiency: float = ASSUMED_EFFICIENCY,
) -> FloatArray:
    """Return the energy saved against resistors for several sizes [kWh]; shape of the sizes.

    Parameters
    ----------
    run : Trajectory
        One run, or a whole line with its stations.
    sizes_kwh : sequence of float
        Sizes [kWh].
    power_kw : float
        Power [kW].
    charging_efficiency, discharging_efficiency : float
        As in `Storage`.

    Raises
    ------
    ScenarioError
        If a size or the power is negative, or an efficiency is not within 0 to 1.
    """
    power, duration = link_power_w(run)
    storages = [Storage(float(size), power_kw, charging_efficiency, discharging_efficiency) for size in sizes_kwh]
    return frozen_array([_stored(power, duration, storage).saved_kwh for storage in storages])


def _stored(power_w: FloatArray, duration_s: FloatArray, storage: Storage) -> StorageRun:
    size_j, max_w = storage.size_kwh * J_PER_KWH, storage.power_kw * W_PER_KW
    efficiencies = storage.charging_efficiency, storage.discharging_efficiency

    def one_run(charge_j: float) -> tuple[float, float, float, float, float]:
        return _one_run(power_w, duration_s, size_j, max_w, *efficiencies, charge_j)

    # The charge with which each of many equal runs begins and ends: a cell either raises the charge by an amount of its
    # own, at most to full, or lowers it, at most to empty. So a run maps a charge c to min(max(c + a, low), high).
    # Repeated from empty, this stays at `low` from the first run on unless a > 0; then it rises by a each time to
    # `high`, after any number of runs, and one run from full ends there as well.
    first = one_run(0.0)[-1]
    is_steady = abs(one_run(first)[-1] - first) <= SAME_CHARGE_SHARE * max(size_j, 1.0)
    drawn, dissipated, taken, given, _ = one_run(first if is_steady else one_run(size_j)[-1])
    demand = float(np.sum(np.maximum(power_w, 0.0) * duration_s))
    offered = float(-np.sum(np.minimum(power_w, 0.0) * duration_s))
    return StorageRun(
        storage=storage,
        energy_kwh=drawn / J_PER_KWH,
        with_resistors_kwh=demand / J_PER_KWH,
        with_receptive_line_kwh=(demand - offered) / J_PER_KWH,
        storage_loss_kwh=(taken - given) / J_PER_KWH,
        dissipated_kwh=dissipated / J_PER_KWH,
        cycles=taken * storage.charging_efficiency / size_j if size_j > 0 else 0.0,
    )


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
            # the size limits the stored energy, which is the input times the efficiency
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
