"""A run that is drawn as a speed over the distance, snapped to what the train can do.

The drawing is a limit of speed: the run is the fastest one beneath it. Where the drawing rises faster than full effort
does, the train stays below it; where it falls faster than full braking does, the train brakes before.
"""

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import ScenarioError
from railjoule.core.motion import Course
from railjoule.core.motion.passes import slowed_to_reach
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.by_hand import WALKING_PACE_MS
from railjoule.core.simulation.driver import braking_envelope
from railjoule.core.trajectory import BY_HAND, Trajectory, make_trajectory


def drive_drawn(scenario: Scenario, course: Course, drawn_ms: FloatArray) -> Trajectory:
    """Return the fastest run beneath a drawn speed.

    Parameters
    ----------
    scenario : Scenario
        What was asked for.
    course : Course
        Its course, from rest or from a prescribed speed and without stops on the way.
    drawn_ms : array of shape (n + 1,)
        Speed at each node [m/s]; below WALKING_PACE_MS it counts as that, so that the train does not stand on its way.

    Raises
    ------
    ScenarioError
        If there is not one finite speed of at least 0 for each node, or the train cannot keep moving so slowly.
    """
    drawn = np.asarray(drawn_ms, dtype=float)
    if drawn.shape != (course.cell_count + 1,) or not np.all(np.isfinite(drawn) & (drawn >= 0)):
        raise ScenarioError(f"drawn_ms must have {course.cell_count + 1:,} finite entries of at least 0 m/s.")
    wanted = np.minimum(np.maximum(drawn, WALKING_PACE_MS) ** 2, braking_envelope(course))
    entering = max(float(course.data.fixed_speed2[0]), 0.0)
    wanted[0] = min(entering, wanted[0])
    speed2 = slowed_to_reach(course.data, wanted)
    standing = np.flatnonzero(~(speed2[1:-1] > 0))
    if len(standing):
        raise ScenarioError(f"The train comes to a stand at {course.position_m[standing[0] + 1]:g} m.")
    if speed2[0] < entering * (1 - 1e-9):
        raise ScenarioError(f"drawn_ms falls too soon for the speed of {entering**0.5:g} m/s at the start.")
    return make_trajectory(scenario, course, BY_HAND, speed2)
