"""A plan of phases: one start / cruise / coast / brake run, and its phases."""

from dataclasses import dataclass
from typing import Literal

FirstPhase = Literal["start", "coast", "brake"]
FIRST_PHASES: tuple[FirstPhase, ...] = ("start", "coast", "brake")


@dataclass(frozen=True)
class PhasePlan:
    """One run from stop to stop, or from the place of a train: its phases and the speeds between them.

    Parameters
    ----------
    distance_m, running_time_s : float
        Distance [m] and time [s] of the run.
    initial_speed_ms, final_speed_ms : float
        Speeds at its ends [m/s].
    first : str
        Phase from the initial speed to that of the cruise: start, coast or brake.
    cruise_speed_ms, cruise_m : float
        Speed [m/s] and length [m] of the cruise, which may be zero.
    brake_speed_ms : float
        Speed at which braking begins [m/s]; that of the cruise where it does not coast.
    cycles : int
        Number of starts; between two starts it coasts.
    restart_speed_ms : float
        Speed at which it starts again [m/s].
    starting_current_a : float or None
        Current of its starts [A]; the largest one where None.
    energy_j : float
        Line energy without auxiliaries [J].
    fastest : bool
        Whether it is the fastest run, which leaves no choice.
    """

    distance_m: float
    running_time_s: float
    initial_speed_ms: float
    final_speed_ms: float
    first: FirstPhase
    cruise_speed_ms: float
    cruise_m: float
    brake_speed_ms: float
    cycles: int
    restart_speed_ms: float
    starting_current_a: float | None
    energy_j: float
    fastest: bool = False

    @property
    def legs(self) -> list[tuple[str, float, float]]:
        """Phases in order, with the speeds at their ends [m/s]; they may have no length."""
        cruise = self.cruise_speed_ms
        cycle = [("coast", cruise, self.restart_speed_ms), ("start", self.restart_speed_ms, cruise)]
        return [
            (self.first, self.initial_speed_ms, cruise),
            *cycle * (self.cycles - 1),
            ("cruise", cruise, cruise),
            ("coast", cruise, self.brake_speed_ms),
            ("brake", self.brake_speed_ms, self.final_speed_ms),
        ]


@dataclass(frozen=True)
class PlannedPhase:
    """One phase of a plan: its name, distance [m], time [s], speeds at its ends [m/s] and line energy [J]."""

    phase: str
    distance_m: float
    duration_s: float
    start_ms: float
    end_ms: float
    energy_j: float
