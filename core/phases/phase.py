"""One phase of a run: a stretch over which the driver does one thing with one aim."""

from dataclasses import dataclass
from typing import Literal

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
        What the driver does.
    start_m, end_m, start_s, end_s, start_ms, end_ms : float
        Place [m], time [s] and speed [m/s] at its ends.
    energy_j : float
        Taken at the line to drive, less what braking gives back [J]. Auxiliaries are apart, as they run whatever the
        driver does: the energies of all phases are those of the run without its auxiliaries.
    effort_share : float or None
        Of a brake, the share of what all brakes have that it uses; of a speed that is held by turns of power and
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
