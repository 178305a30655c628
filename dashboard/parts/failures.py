"""Errors that a user can mend, in words."""

from railjoule.core import RailjouleError, ScenarioError, TimetableError
from railjoule.dashboard.look import words


def failure_words(failure: RailjouleError) -> tuple[str, str]:
    """Return an error as what is wrong and why."""
    if isinstance(failure, TimetableError):
        asked, shortest = words.number(failure.travel_time_s), words.number(failure.shortest_time_s)
        return f"{asked} s is too short.", f"The shortest possible run takes {shortest} s."
    if isinstance(failure, ScenarioError):
        return "This input cannot be read.", str(failure)
    return "This run is not possible.", str(failure)
