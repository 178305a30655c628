"""How large an on-board storage must be to keep what braking generates, and what each size saves.

The drop of the cumulative energy at the link, (13), from one of its heights to the lowest point after it is what a
storage without losses would have to hold. A storage charges with what braking generates, as far as its size and power
reach, and gives it back to the next driving and to the auxiliaries; what it cannot take is burnt in resistors. A run
counts as one of many alike: it begins with the charge with which it ends.

Source: Shtompel, Khvorost 2025, (13) and conclusion 2; the storage with losses is ours.
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

DAY_S = 86_400.0
MOST_REPEATS, SAME_CHARGE = 200, 1e-9


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
    charging_efficiency: float = 0.95
    discharging_efficiency: float = 0.95

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
        The same without storage, all that comes back burnt [kWh].
    with_receptive_line_kwh : float
        The same where the line takes all that comes back [kWh].
    storage_loss_kwh, burnt_kwh : float
        Lost in the storage, and in the resistors beside it [kWh].
    cycles : float
        Full cycles of the storage in a run.
    """

    storage: Storage
    energy_kwh: float
    with_resistors_kwh: float
    with_receptive_line_kwh: float
    storage_loss_kwh: float
    burnt_kwh: float
    cycles: float

    @property
    def saved_kwh(self) -> float:
        """Less from the line than with resistors [kWh]."""
        return self.with_resistors_kwh - self.energy_kwh

    @property
    def share_of_receptive_line(self) -> float:
        """What it saves over what a line would save that takes everything."""
        most = self.with_resistors_kwh - self.with_receptive_line_kwh
        return self.saved_kwh / most if most > 0 else 0.0


def link_power_w(run: Trajectory) -> tuple[FloatArray, FloatArray]:
    """Return power at the link, auxiliaries included, negative where braking feeds it, and durations of all cells.

    Both of shape (n,), in W and s; whatever the line takes back.
    """
    vehicle = run.scenario.vehicle
    duration, length = np.diff(run.time_s), np.diff(run.position_m)
    speed = np.divide(length, duration, out=np.zeros_like(duration), where=duration > 0)
    effort = run.tractive_effort_n - run.electric_braking_n
    power = make_drive(vehicle.drive).electrical_power_w(effort, speed) + vehicle.auxiliary_power_kw * W_PER_KW
    return power, duration


def storage_need(run: Trajectory, service_time_s: float = 64_800.0, turnaround_s: float = 30.0) -> StorageNeed:
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
    charging_efficiency: float = 0.95,
    discharging_efficiency: float = 0.95,
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
    charge = 0.0
    for _ in range(MOST_REPEATS):
        drawn, burnt, taken, given, after = _one_run(
            power_w, duration_s, size, most, storage.charging_efficiency, storage.discharging_efficiency, charge
        )
        if abs(after - charge) <= SAME_CHARGE * max(size, 1.0):
            break
        charge = after
    demand = float(np.sum(np.maximum(power_w, 0.0) * duration_s))
    offered = float(-np.sum(np.minimum(power_w, 0.0) * duration_s))
    return StorageRun(
        storage=storage,
        energy_kwh=drawn / J_PER_KWH,
        with_resistors_kwh=demand / J_PER_KWH,
        with_receptive_line_kwh=(demand - offered) / J_PER_KWH,
        storage_loss_kwh=(taken - given) / J_PER_KWH,
        burnt_kwh=burnt / J_PER_KWH,
        cycles=taken * storage.charging_efficiency / size if size > 0 else 0.0,
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
    """Return energies drawn, burnt, taken and given by a storage [J], and its charge at the end [J]."""
    drawn = burnt = taken = given = 0.0
    for i in range(power.shape[0]):
        energy, limit = power[i] * duration[i], most * duration[i]
        if energy < 0.0:
            into = min(-energy, limit, (size - charge) / charging)
            charge += into * charging
            taken += into
            burnt += -energy - into
        else:
            out = min(energy, limit, charge * discharging)
            charge -= out / discharging
            given += out
            drawn += energy - out
    return drawn, burnt, taken, given, charge
