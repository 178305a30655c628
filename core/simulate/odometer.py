"""Where a train believes it is: a place measured with errors, put right by sensors before the stop.

Source: Liashenko, Yatsko 2025, (10) and Figure 2. D1 sets the place; from D1 to D2 the measured way is compared with
the known one, which calibrates speed and way from there on; D3 sets the place again.
"""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.scenario.options import SimulationOptions

Place = TypeVar("Place", float, FloatArray)


@dataclass(frozen=True)
class Stretch:
    """A part of a way between two sensors: the believed place is `believed_m` + `scale` (place - `from_m`).

    Parameters
    ----------
    from_m : float
        Where it begins [m].
    believed_m : float
        Where the train believes to be there [m].
    scale : float
        Measured speed over the true one.
    sensor : str
        Which sensor it begins at: D1, D2, D3; empty at a start.
    """

    from_m: float
    believed_m: float
    scale: float
    sensor: str = ""

    def believed(self, position_m: Place) -> Place:
        """Return the believed place [m] at a true one [m]."""
        return self.believed_m + self.scale * (position_m - self.from_m)

    def true(self, believed_m: Place) -> Place:
        """Return the true place [m] of a believed one [m]."""
        return self.from_m + (believed_m - self.believed_m) / self.scale


def stretches(start_m: float, stop_m: float, coordinate_error_m: float, options: SimulationOptions) -> list[Stretch]:
    """Return the stretches of the way from one stop to the next, in order.

    Parameters
    ----------
    start_m, stop_m : float
        Where the train starts, and where it should stop [m].
    coordinate_error_m : float
        How much further on the train believes to be at its start [m].
    options : SimulationOptions
        Sensors and errors of measurement.
    """
    measured = 1.0 + options.speed_error
    way = [Stretch(start_m, start_m + coordinate_error_m, measured)]
    if not options.target_braking:
        return way
    errors, reset, calibration = options.sensor_errors_m, options.reset_sensor_m, options.calibration_length_m
    scale = measured
    if reset is not None and stop_m - reset + errors[0] > start_m:
        first = stop_m - reset + errors[0]
        way.append(Stretch(first, stop_m - reset, scale, "D1"))
        second = stop_m - reset + (calibration or 0.0) + errors[1]
        if calibration is not None and second > first:
            scale *= calibration / (measured * (second - first))
            way.append(Stretch(second, way[-1].believed(second), scale, "D2"))
    if options.stop_sensor_m is not None and stop_m - options.stop_sensor_m + errors[2] > way[-1].from_m:
        way.append(Stretch(stop_m - options.stop_sensor_m + errors[2], stop_m - options.stop_sensor_m, scale, "D3"))
    return way


def stopping_place(way: list[Stretch], stop_m: float) -> float:
    """Return where the train stands when it believes to be at the stop [m], or passes the next sensor for that."""
    for stretch, after in zip(way, [*way[1:], None], strict=True):
        place = stretch.true(stop_m)
        if after is None or place <= after.from_m:
            return place
    raise AssertionError("the last stretch has no end")


def believed_places(way: list[Stretch], position_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the believed places [m] and the scales of the measured speed at true places [m]; both of its shape."""
    starts = np.array([stretch.from_m for stretch in way])
    index = np.clip(np.searchsorted(starts, position_m, side="right") - 1, 0, len(way) - 1)
    offset = np.array([stretch.believed_m for stretch in way])[index]
    scale = np.array([stretch.scale for stretch in way])[index]
    return offset + scale * (position_m - starts[index]), scale
