"""Quantities of a run that charts draw: each once, with unit, digits and title."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.units import J_PER_KWH, MS_PER_KMH

S_PER_MIN = 60.0
N_PER_KN, W_PER_MW = 1e3, 1e6


@dataclass(frozen=True)
class Quantity:
    """A quantity of a run.

    Parameters
    ----------
    name : str
        The name of its column.
    words : str
        Quantity and unit, as captions and axes write them.
    unit, digits
        With which the cursor writes its values.
    values : callable
        Takes a run (of any kind that has it), returns its values at the run's nodes in that unit.
    stepped : bool
        Whether it is constant in each cell.
    """

    name: str
    words: str
    unit: str
    digits: int
    values: Callable[[Any], FloatArray]
    stepped: bool = False


def at_nodes(cells: FloatArray) -> FloatArray:
    """Return the values of cells at the nodes: each node has that of the cell before it, as steps are drawn."""
    return np.append(cells[:1], cells)


def read(attribute: str, divisor: float = 1.0) -> Callable[[Any], FloatArray]:
    """Return a function that reads a quantity at the nodes of a run; a constant counts everywhere."""

    def values(run: Any) -> FloatArray:
        found = np.asarray(getattr(run, attribute), dtype=float) / divisor
        return found if found.ndim else np.full(len(run.time_s), float(found))

    return values


def read_cells(attribute: str, divisor: float = 1.0) -> Callable[[Any], FloatArray]:
    """Return a function that reads a quantity in the cells of a run; zero where the run has none."""

    def values(run: Any) -> FloatArray:
        cells = getattr(run, attribute)
        return np.zeros(len(run.time_s)) if cells is None else at_nodes(cells) / divisor

    return values


POSITION = Quantity("position", "Distance, m", "m", 0, read("position_m"))
TIME = Quantity("time", "Time, s", "s", 1, read("time_s"))
SPEED = Quantity("speed", "Speed, km/h", "km/h", 1, read("speed_ms", MS_PER_KMH))
ENERGY = Quantity("energy", "Energy from the supply so far, kWh", "kWh", 2, read("supply_energy_j", J_PER_KWH))
EFFORT = Quantity(
    "effort", "Tractive (+) and braking (\u2212) effort, kN", "kN", 0, read_cells("effort_n", N_PER_KN), stepped=True
)
LARGEST_EFFORT = Quantity(
    "largest", "Largest tractive effort, kN", "kN", 0, read_cells("max_effort_n", N_PER_KN), stepped=True
)
MOTOR_CURRENT = Quantity("current", "Current of one motor, A", "A", 0, read_cells("current_a"), stepped=True)
SUPPLY_CURRENT = Quantity("current", "Current from the supply, A", "A", 0, read_cells("supply_current_a"), stepped=True)
POWER = Quantity("power", "Power from the supply, MW", "MW", 2, read_cells("supply_power_w", W_PER_MW), stepped=True)
PATH = Quantity("path", "Train path: time, min", "min", 2, read("time_s", S_PER_MIN))


def along(over_time: bool) -> Quantity:
    """Return the quantity of a shared x axis: time or distance."""
    return TIME if over_time else POSITION
