"""Where a train estimates to be: a position measured with errors, corrected by sensors before the stop.

Source: Liashenko, Yatsko 2025, (10) and Figure 2. D1 sets the position; from D1 to D2 the measured distance is compared
with the known one, which calibrates speed and distance from there on; D3 sets the position again.
"""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.scenario.options import SimulationOptions

Position = TypeVar("Position", float, FloatArray)


@dataclass(frozen=True)
class Stretch:
    """A part of a course between two sensors: the estimate is `estimated_m` + `scale` (position - `from_m`).

    Parameters
    ----------
    from_m : float
        Where it begins [m].
    estimated_m : float
        Where the train estimates to be there [m].
    scale : float
        Measured speed over the true one.
    sensor : str
        Which sensor it begins at: D1, D2, D3; empty at a start.
    """

    from_m: float
    estimated_m: float
    scale: float
    sensor: str = ""

    def estimated(self, position_m: Position) -> Position:
        """Return the estimated position [m] at a true one [m]."""
        return self.estimated_m + self.scale * (position_m - self.from_m)

    def true(self, estimated_m: Position) -> Position:
        """Return the true position [m] of an estimated one [m]."""
        return self.from_m + (estimated_m - self.estimated_m) / self.scale


def stretches(start_m: float, stop_m: float, coordinate_error_m: float, options: SimulationOptions) -> list[Stretch]:
    """Return the stretches of the course from one stop to the next, in order.

    Parameters
    ----------
    start_m, stop_m : float
        Where the train starts, and where it should stop [m].
    coordinate_error_m : float
        How much further on the train estimates to be at its start [m].
    options : SimulationOptions
        Sensors and errors of measurement.
    """
    measured = 1.0 + options.speed_error
    # sensors belong to the target braking: without it the train drives to its stop on its own estimate
    course = [Stretch(start_m, start_m + coordinate_error_m, measured)]
    if not options.target_braking:
        return course
    errors, reset, calibration = options.sensor_errors_m, options.reset_sensor_m, options.calibration_length_m
    scale = measured
    if reset is not None and stop_m - reset + errors[0] > start_m:
        first = stop_m - reset + errors[0]
        course.append(Stretch(first, stop_m - reset, scale, "D1"))
        # D2 calibrates only a train that comes to it after D1: errors of the sensors may reverse their order
        second = stop_m - reset + (calibration or 0.0) + errors[1]
        if calibration is not None and second > first:
            # what the distance between the sensors should measure, over what it measured
            scale *= calibration / (measured * (second - first))
            course.append(Stretch(second, course[-1].estimated(second), scale, "D2"))
    if options.stop_sensor_m is not None and stop_m - options.stop_sensor_m + errors[2] > course[-1].from_m:
        course.append(Stretch(stop_m - options.stop_sensor_m + errors[2], stop_m - options.stop_sensor_m, scale, "D3"))
    return course


def stopping_position(course: list[Stretch], stop_m: float) -> float:
    """Return where the train stands when it estimates to be at the stop [m]: after the last sensor that it passes."""
    for stretch, after in zip(course, [*course[1:], None], strict=True):
        position = stretch.true(stop_m)
        if after is None or position <= after.from_m:
            return position
    raise AssertionError("the last stretch has no end")


def estimated_positions(course: list[Stretch], position_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the estimated positions [m] and the scales of the measured speed at true positions [m]; as many."""
    starts = np.array([stretch.from_m for stretch in course])
    index = np.clip(np.searchsorted(starts, position_m, side="right") - 1, 0, len(course) - 1)
    offset = np.array([stretch.estimated_m for stretch in course])[index]
    scale = np.array([stretch.scale for stretch in course])[index]
    return offset + scale * (position_m - starts[index]), scale
