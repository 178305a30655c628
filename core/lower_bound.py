"""The yardsticks of a run: a lower bound of the energy, and the best known run."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.units import J_PER_KWH

if TYPE_CHECKING:
    from railjoule.core.trajectory import Trajectory

# a millisecond in a quarter of an hour
LATE_SHARE = 1e-6
"""A run that is later than a bound's time by less than this share of it is in time but for rounding."""
BELOW_SHARE = 1e-5
"""By this share of its bound a run may lie below it: the last digits of a solver. More is a fault of its mesh."""
# the rest that a solver leaves of its time
ON_TIME_S = 1e-5
"""An arrival this close to its window keeps it."""
Window = tuple[float, float, float]
"""A window of arrival: position of the station [m], earliest and latest arrival [s]."""


@dataclass(frozen=True, eq=False)
class Costate:
    """The price of force along a line, from which a lower bound is proven.

    Parameters
    ----------
    position_m : array of shape (m,)
        Places [m], rising; where the price jumps, one place comes twice.
    force_price : array of shape (m,)
        Energy at the line over work at the wheels [J/J]. Next to a stop it grows without limit.
    """

    position_m: FloatArray
    force_price: FloatArray


@dataclass(frozen=True, eq=False)
class Bound:
    """A lower bound of the energy of a scenario.

    Parameters
    ----------
    energy_j : float
        No run that it covers needs less [J].
    statement : str
        The same in one sentence, with what it assumes.
    travel_time_s : float
        The longest time of a run that it covers, dwells included [s].
    every_run_j : float
        Minimum energy of every driving of this train [J]; less than `energy_j` where that covers runs over one mesh.
    position_m : array of shape (n + 1,) or None
        The nodes of the only mesh over which it holds [m]; None where it covers every run.
    slowest_ms : float or array of shape (n + 1,)
        The least speeds at these nodes of a run that it covers [m/s].
    premise : str
        Assumption of the bound about the powertrain, in a clause; empty where there is none.
    windows : tuple of Window
        Windows of arrival that a run that it covers keeps.
    costate : Costate or None
        The price of force that proves `every_run_j`, where there is one along the whole line.
    """

    energy_j: float
    statement: str
    travel_time_s: float
    every_run_j: float
    position_m: FloatArray | None = None
    slowest_ms: FloatArray | float = 0.0
    premise: str = ""
    windows: tuple[Window, ...] = ()
    costate: Costate | None = None

    @property
    def covers_every_run(self) -> bool:
        """Whether it holds for every driving of the train, not only for runs over one mesh."""
        return self.position_m is None

    def covers(self, run: "Trajectory") -> bool:
        """Return whether a run is no later, keeps the bound's windows, and is over its mesh, if it has one."""
        if run.travel_time_s > self.travel_time_s * (1 + LATE_SHARE):
            return False
        if self.position_m is not None:
            if not np.array_equal(run.nodes_m, self.position_m):
                return False
            if np.any(run.node_speed_ms < self.slowest_ms * (1 - LATE_SHARE)):
                return False
        return all(run.keeps(window) for window in self.windows)


@dataclass(frozen=True)
class Reference:
    """The best run that is known of a scenario among those that arrive within a time.

    Parameters
    ----------
    energy_j : float
        Its energy [J].
    strategy : str
        Its strategy.
    within_s : float
        The time [s].
    proven : bool
        Whether its bound proves that it is the optimum.
    windows : tuple of Window
        Windows of arrival that bind it, and that runs measured against it keep.
    """

    energy_j: float
    strategy: str
    within_s: float
    proven: bool
    windows: tuple[Window, ...] = ()

    @property
    def energy_kwh(self) -> float:
        """Its energy [kWh]."""
        return self.energy_j / J_PER_KWH
