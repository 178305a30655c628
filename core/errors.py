"""Everything that railjoule's core raises on purpose, each with one sentence for its reader."""

import math
from typing import Any


class RailjouleError(Exception):
    """Base of all errors that user input causes; the text is one clear sentence."""


class ScenarioError(RailjouleError):
    """A scenario, vehicle or line that cannot be read, or a value out of its bounds."""


class ChoiceError(ScenarioError):
    """A file that holds several things of which one is wanted.

    Parameters
    ----------
    source, what : str
        The file, and what each of the things is: a sheet, a train, a path.
    names : tuple of str
        Name of the kind in messages.
    """

    def __init__(self, source: str, what: str, names: tuple[str, ...]) -> None:
        # kept beside the text for callers that offer them
        self.what, self.names = what, names
        shown = ", ".join(name if len(name) <= 40 else f"{name[:37]}..." for name in names[:8])
        more = f" and {len(names) - 8} more" if len(names) > 8 else ""
        super().__init__(f"{source}: holds {len(names)} {what}s, {shown}{more}; choose one {what} by its name.")


class UnitError(ScenarioError):
    """A column of a file of which the unit is in doubt, and must be named.

    Parameters
    ----------
    source, doubt : str
        The file, and in words why it is in doubt.
    setting : tuple of (str, str)
        The kind of table and the key of the unit.
    units : tuple of str
        Those that there are.
    likely : tuple of str
        Those that the numbers suggest, the likeliest first.
    """

    def __init__(
        self, source: str, doubt: str, setting: tuple[str, str], units: tuple[str, ...], likely: tuple[str, ...] = ()
    ) -> None:
        self.key, self.likely = setting[1], likely
        example = f"{'.'.join(setting)}={(likely or units)[0]}"
        super().__init__(f"{source}: {doubt}; name the unit, as {example}, of {', '.join(units)}.")


class EncodingError(ScenarioError):
    """A text file that is not UTF-8, and of which the code page must be named.

    Parameters
    ----------
    source, doubt : str
        The file, and in words what is known of its code page.
    likely : tuple of str
        Code pages in which it is a text.
    """

    def __init__(self, source: str, doubt: str, likely: tuple[str, ...] = ()) -> None:
        self.likely = likely
        example = (likely or ("cp1252",))[0]
        super().__init__(
            f"{source}: not UTF-8, {doubt}; save it as UTF-8, or name its code page, as --encoding {example}."
        )


class DriveRangeError(ScenarioError):
    """An effort or a speed beyond what the map of a drive holds."""


class TimetableError(RailjouleError):
    """A timetable that no train can keep.

    Parameters
    ----------
    travel_time_s : float
        The running time asked for [s].
    shortest_time_s : float
        The shortest possible running time [s].
    key : str
        The key of the scenario that asks for it.
    """

    def __init__(self, travel_time_s: float, shortest_time_s: float, key: str = "timetable.travel_time_s") -> None:
        # kept as numbers beside the text, for callers that offer the shortest time instead
        self.travel_time_s = travel_time_s
        self.shortest_time_s = shortest_time_s
        super().__init__(
            f"{key} = {travel_time_s:.6g} s is shorter than the shortest possible {self.min_tenth_s:.1f} s."
        )

    @property
    def min_tenth_s(self) -> float:
        """The least time in whole tenths of a second that can be kept [s]."""
        # always above the shortest time, never equal to it: at that time itself there is no run to choose
        return (math.floor(self.shortest_time_s * 10) + 1) / 10


class InfeasibleLineError(RailjouleError):
    """A line that the vehicle cannot run over at all, whatever the timetable."""


class StrategyRefusedError(RailjouleError):
    """A strategy that cannot honour a scenario; the text gives the reason."""


class CheckError(RailjouleError):
    """A run that breaks a rule of its scenario, found by the independent check.

    Parameters
    ----------
    run : Trajectory
        The run, whose `check` lists all that was checked.
    """

    # Any: the module of trajectories imports this one
    def __init__(self, run: Any) -> None:
        self.run = run
        super().__init__(f"{run.strategy}: {run.check.verdict}")


class RecordingError(RailjouleError):
    """A measured run that cannot be read, does not fit its scenario, or does not hold what a fit needs."""


class SolverError(RailjouleError):
    """A solver that ended without the accuracy asked for."""
