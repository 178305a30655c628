"""The energy account of a run: what the line gives, and where it goes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, overload

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import ScenarioError
from railjoule.core.units import J_PER_KWH, J_PER_WH

if TYPE_CHECKING:
    import pandas

# rounding to two decimals hides up to a per mille of 5 kWh, and strategies often differ by less
SMALL_ENERGY_KWH = 5.0
"""Energies below this are printed with a third decimal."""
J_PER_UNIT: Mapping[str, float] = {"kWh": J_PER_KWH, "Wh": J_PER_WH, "MJ": 1e6, "J": 1.0}
EnergyUnit = Literal["kWh", "Wh", "MJ", "J"]
# beyond a hundredfold a share says no more than that the reference is next to nothing
SMALL_REFERENCE = 0.01
"""A reference below this share of the energy is no measure of it."""


@dataclass(frozen=True)
class Energy:
    """One run's energies [J].

    The account closes: traction - recuperated = running and curve resistance + losses + kinetic + potential + magnetic
    field.

    Parameters
    ----------
    traction_j : float
        Taken from the line to drive.
    recuperated_j : float
        Given back to the line.
    auxiliary_j : float
        Taken from the line for light, heating and so on.
    running_resistance_j, curve_resistance_j : float
        Lost to air, bearings and rails.
    losses_j : mapping of str to float
        Lost in the drive, in brake resistors and in friction brakes, by kind.
    kinetic_j, potential_j : float
        What the train has more at the end than at the start.
    magnetic_field_j : float
        What the magnetic fields of its motors hold more at the end than at the start; only where they are simulated.
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
        # frozen dataclasses freeze the field and not what it holds: a dictionary could still be written to
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
        """Sum of all parts less what the line gave, over the energy that moved; 0 if the account closes."""
        parts = self.running_resistance_j + self.curve_resistance_j + sum(self.losses_j.values())
        parts += self.kinetic_j + self.potential_j + self.magnetic_field_j
        # the energy that moved, as the net energy may be zero; at least 1 J for a run that does not move at all
        return (parts - self.traction_j + self.recuperated_j) / max(self.traction_j + self.recuperated_j, 1.0)


def net_energy(traction: float, recuperated: float, auxiliary: float) -> float:
    """Return the net energy at the line of what is taken to drive, given back, and taken for auxiliaries."""
    return traction - recuperated + auxiliary


@overload
def share_above(energy: float, reference: float) -> float: ...
@overload
def share_above(energy: FloatArray, reference: FloatArray | float) -> FloatArray: ...
def share_above(energy: FloatArray | float, reference: FloatArray | float) -> FloatArray | float:
    """Return by which share energies lie above others: their ratio less 1.

    A net energy may be negative or next to nothing, as that of a long run downhill: such a reference is no measure, and
    the share is NaN. What is left to tell then is the difference itself.

    Parameters
    ----------
    energy, reference : float or array
        In the same unit; arrays of shapes that fit.
    """
    energies, references = np.asarray(energy, dtype=float), np.asarray(reference, dtype=float)
    measured = references > SMALL_REFERENCE * np.abs(energies)
    # 1.0 stands in where nothing is measured, so that no division warns before its result is dropped
    share = np.where(measured, energies / np.where(measured, references, 1.0) - 1, np.nan)
    return share if share.ndim else float(share)


def energy_decimals(energy_kwh: float) -> int:
    """Return with how many decimals an energy [kWh] is printed, wherever it is."""
    return 3 if abs(energy_kwh) < SMALL_ENERGY_KWH else 2


def total_energy(parts: Sequence[Energy]) -> Energy:
    """Return the account of runs that follow one another."""
    kinds = dict.fromkeys(kind for part in parts for kind in part.losses_j)
    losses = {kind: sum(part.losses_j.get(kind, 0.0) for part in parts) for kind in kinds}
    sums = {
        field.name: sum(getattr(part, field.name) for part in parts)
        for field in fields(Energy)
        if field.name != "losses_j"
    }
    return Energy(losses_j=losses, **sums)
