"""The energy balance of a run: energy from the supply, and its parts; and the current of a supply power."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, overload

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.errors import ScenarioError
from railjoule.core.units import J_PER_KWH, J_PER_WH

if TYPE_CHECKING:
    import pandas

SMALL_ENERGY_KWH = 5.0
"""Energies below this are printed with three decimals: two hide up to a per mille of 5 kWh, and strategies often differ
by less."""
J_PER_UNIT: Mapping[str, float] = {"kWh": J_PER_KWH, "Wh": J_PER_WH, "MJ": 1e6, "J": 1.0}
EnergyUnit = Literal["kWh", "Wh", "MJ", "J"]
SMALL_REFERENCE = 0.01
"""A reference below this share of the energy is too small for a ratio."""


@dataclass(frozen=True)
class Energy:
    """The energies of a run [J].

    They balance: traction - recuperated = running and curve resistance + losses + kinetic + potential + magnetic
    field.

    Parameters
    ----------
    traction_j : float
        From the supply for traction.
    recuperated_j : float
        Fed back to the supply.
    auxiliary_j : float
        From the supply for light, heating and other auxiliaries.
    running_resistance_j, curve_resistance_j : float
        Lost to air resistance, bearings and rails.
    losses_j : mapping of str to float
        Lost in the drive, in brake resistors and in friction brakes, by kind.
    kinetic_j, potential_j : float
        Difference between end and start of the run.
    magnetic_field_j : float
        The same difference for the magnetic fields of the motors; only in simulations of the motors.
    """

    traction_j: float
    recuperated_j: float
    auxiliary_j: float
    running_resistance_j: float
    curve_resistance_j: float
    losses_j: Mapping[str, float]
    kinetic_j: float
    potential_j: float
    magnetic_field_j: float = 0.0

    def __post_init__(self) -> None:
        # a frozen dataclass does not freeze the content of its fields
        object.__setattr__(self, "losses_j", MappingProxyType(dict(self.losses_j)))

    @property
    def net_j(self) -> float:
        """Net energy at the line, auxiliaries included [J]."""
        return net_energy(self.traction_j, self.recuperated_j, self.auxiliary_j)

    @property
    def net_kwh(self) -> float:
        """Net energy at the line, auxiliaries included [kWh]."""
        return self.net_j / J_PER_KWH

    def to_frame(self, unit: EnergyUnit = "kWh") -> "pandas.DataFrame":
        """Return the parts as a table with their names as index and one column, such as `energy_kwh`.

        The first rows are what the train takes from its supply and gives back; the others are where the traction energy
        goes. `net` is the sum that a meter shows.

        Parameters
        ----------
        unit : str
            "kWh", "Wh", "MJ" or "J".

        Raises
        ------
        ScenarioError
            If there is no such unit.
        """
        import pandas  # noqa: PLC0415  (slow to import)

        if unit not in J_PER_UNIT:
            raise ScenarioError(f"unit = {unit!r} must be one of {', '.join(J_PER_UNIT)}.")
        parts = {
            "traction": self.traction_j,
            "recuperated": -self.recuperated_j,
            "auxiliaries": self.auxiliary_j,
            "net": self.net_j,
            "running_resistance": self.running_resistance_j,
            "curve_resistance": self.curve_resistance_j,
            **self.losses_j,
            "kinetic": self.kinetic_j,
            "potential": self.potential_j,
            "magnetic_field": self.magnetic_field_j,
        }
        index = pandas.Index(parts, name="part")
        return pandas.DataFrame({f"energy_{unit.lower()}": np.array([*parts.values()]) / J_PER_UNIT[unit]}, index)

    @property
    def imbalance(self) -> float:
        """Sum of all parts minus the energy from the supply, over the energy exchanged; 0 if the energies balance."""
        parts = self.running_resistance_j + self.curve_resistance_j + sum(self.losses_j.values())
        parts += self.kinetic_j + self.potential_j + self.magnetic_field_j
        # the energy exchanged, as the net energy may be zero; at least 1 J for a train at rest
        return (parts - self.traction_j + self.recuperated_j) / max(self.traction_j + self.recuperated_j, 1.0)


def net_energy(traction: float, recuperated: float, auxiliary: float) -> float:
    """Return the net energy of traction, recuperation and auxiliaries."""
    return traction - recuperated + auxiliary


@overload
def share_above(energy: float, reference: float) -> float: ...
@overload
def share_above(energy: FloatArray, reference: FloatArray | float) -> FloatArray: ...
def share_above(energy: FloatArray | float, reference: FloatArray | float) -> FloatArray | float:
    """Return the relative difference of energies to a reference: their ratio minus 1.

    It is NaN for a reference that is negative or almost zero, as the net energy of a long run downhill may be.

    Parameters
    ----------
    energy, reference : float or array
        In the same unit; arrays must broadcast.
    """
    energies, references = np.asarray(energy, dtype=float), np.asarray(reference, dtype=float)
    measured = references > SMALL_REFERENCE * np.abs(energies)
    # 1.0 avoids a warning for a division whose result is dropped
    share = np.where(measured, energies / np.where(measured, references, 1.0) - 1, np.nan)
    return share if share.ndim else float(share)


def energy_decimals(energy_kwh: float) -> int:
    """Return the number of decimals with which an energy [kWh] is printed."""
    return 3 if abs(energy_kwh) < SMALL_ENERGY_KWH else 2


def total_energy(parts: Sequence[Energy]) -> Energy:
    """Return the sum of the energies of consecutive runs."""
    kinds = dict.fromkeys(kind for part in parts for kind in part.losses_j)
    losses = {kind: sum(part.losses_j.get(kind, 0.0) for part in parts) for kind in kinds}
    sums = {
        field.name: sum(getattr(part, field.name) for part in parts)
        for field in fields(Energy)
        if field.name != "losses_j"
    }
    return Energy(losses_j=losses, **sums)


def supply_current_a(supply_power_w: FloatArray, line_voltage_v: float | None) -> FloatArray | None:
    """Return the current at the line, power over voltage; None where the voltage is not known.

    Parameters
    ----------
    supply_power_w : array of shape (n,)
        Power taken from the line, auxiliaries included; negative where energy goes back [W].
    line_voltage_v : float or None
        Voltage at the vehicle, taken as constant [V]. On an alternating voltage this is the active part of the current.

    Returns
    -------
    array of shape (n,) or None
        Negative where energy goes back [A].
    """
    return None if line_voltage_v is None else frozen_array(supply_power_w / line_voltage_v)


def power_of_supply_current_w(current_a: FloatArray, line_voltage_v: FloatArray | float) -> FloatArray:
    """Return the power taken from the line, current times voltage [W]; negative where energy goes back.

    Parameters
    ----------
    current_a : array of shape (n,)
        Current at the line, negative where energy goes back [A]; on an alternating voltage its active part.
    line_voltage_v : array of shape (n,) or float
        Voltage at the vehicle [V].
    """
    return frozen_array(current_a * line_voltage_v)
