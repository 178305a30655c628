"""One phase of a run, and the arrays of a run that its phases are found in."""

from dataclasses import dataclass
from typing import Literal, NamedTuple

from railjoule.core.arrays import FloatArray

PhaseName = Literal["full_power", "part_power", "hold", "coast", "brake", "stand"]
# in the order of NAMES
FULL_POWER, PART_POWER, HOLD, COAST, BRAKE, STAND = range(6)
NAMES: tuple[PhaseName, ...] = ("full_power", "part_power", "hold", "coast", "brake", "stand")


@dataclass(frozen=True)
class Phase:
    """A stretch of a run over which the driver does one thing with one aim.

    Phases follow one another without a gap; two of the same name may follow one another, such as part power to one
    speed and then, with less of it, to another. A border may lie within a cell of the mesh.

    Parameters
    ----------
    phase : str
        The driver's action.
    start_m, end_m, start_s, end_s, start_ms, end_ms : float
        Place [m], time [s] and speed [m/s] at its ends.
    energy_j : float
        Energy from the line for driving, less the energy that braking returns [J]. Auxiliaries are not included, as
        they run in each phase: the energies of all phases are those of the run without its auxiliaries.
    effort_share : float or None
        Of a brake, the share of the effort of all brakes that it uses; of a speed that is held by turns of power and
        coasting, the share of full power that is used; else None.
    """

    phase: PhaseName
    start_m: float
    end_m: float
    start_s: float
    end_s: float
    start_ms: float
    end_ms: float
    energy_j: float
    effort_share: float | None = None

    @property
    def mean_speed_ms(self) -> float:
        """Length over time [m/s]."""
        return (self.end_m - self.start_m) / (self.end_s - self.start_s)


class RunData(NamedTuple):
    """A run of n cells; a dwell is a cell without length.

    Parameters
    ----------
    position_m, time_s, speed_ms : array of shape (n + 1,)
        Place [m], time [s] and speed [m/s] at the nodes.
    energy_j : array of shape (n + 1,)
        Energy taken from the line so far, without auxiliaries [J].
    effort_n : array of shape (n,)
        Effort at the wheels in each cell, braking negative [N].
    max_effort_n, max_braking_n : array of shape (n,)
        Largest tractive and braking effort at the speed of each cell, both positive [N].
    limit_ms : array of shape (n,)
        Speed limit of each cell [m/s].
    inertia_kg : float
        Mass that resists acceleration [kg].
    max_deceleration_ms2 : float
        The strongest deceleration allowed, infinite where there is no bound [m/s2].
    """

    position_m: FloatArray
    time_s: FloatArray
    speed_ms: FloatArray
    energy_j: FloatArray
    effort_n: FloatArray
    max_effort_n: FloatArray
    max_braking_n: FloatArray
    limit_ms: FloatArray
    inertia_kg: float
    max_deceleration_ms2: float

    def work_j(self, first: int, last: int) -> tuple[float, float]:
        """Return the work of the effort over cells, and that of the largest effort [J]."""
        lengths = self.position_m[first + 1 : last + 1] - self.position_m[first:last]
        return float(lengths @ self.effort_n[first:last]), float(lengths @ self.max_effort_n[first:last])

    def keeps_one_limit(self, first: int, last: int, excess_ms: float) -> bool:
        """Return whether all speeds of cells keep the lowest limit of them, with an excess allowed [m/s]."""
        return bool(self.speed_ms[first : last + 1].max() <= self.limit_ms[first:last].min() + excess_ms)
