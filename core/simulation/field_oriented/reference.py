"""What a closed loop follows: position, speed, acceleration and jerk of any planned run, its corners rounded.

Within a cell of a plan the acceleration is constant, so its speed is a polygon over time. Two moving averages, each
over half of a window that lies evenly around its instant, make acceleration continuous and jerk finite. They are
differences of the plan's own integrals, exact to rounding: nothing rings, and nothing comes late. The reference begins
and ends half a window outside the plan.
"""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.trajectory import Trajectory

# Time between two samples; within it the kernel goes on with the jerk. Much shorter than any window over which corners
# are rounded (0.02 s at least), so that the jerk is resolved; shorter still only takes more memory.
STEP_S = 0.002
# So many seconds are rounded on a clock of their own. Second differences of double integrals lose digits with the
# square of the clock's reading over the window: 10 s over 0.01 s leave ten of sixteen digits, an hour would leave five.
BLOCK_S = 10.0


@dataclass(frozen=True, eq=False)
class Reference:
    """Samples of a planned run, `step_s` apart; all arrays of shape (n,).

    Parameters
    ----------
    start_s, step_s : float
        Time of the first sample on the plan's clock, and between two [s].
    position_m, speed_ms, acceleration_ms2, jerk_ms3 : array
        Position and its derivatives [m, m/s, m/s2, m/s3].
    """

    start_s: float
    step_s: float
    position_m: FloatArray
    speed_ms: FloatArray
    acceleration_ms2: FloatArray
    jerk_ms3: FloatArray

    @property
    def time_s(self) -> FloatArray:
        """Return the times of the samples on the plan's clock [s]; shape (n,)."""
        time: FloatArray = self.start_s + self.step_s * np.arange(len(self.position_m), dtype=np.float64)
        return time


def make_reference(planned: Trajectory, window_s: float, step_s: float = STEP_S) -> Reference:
    """Return a plan as a reference without corners.

    Parameters
    ----------
    planned : Trajectory
        The plan.
    window_s : float
        Over how long a corner is rounded [s].
    step_s : float
        Between two samples [s].
    """
    plan, half = PlannedMotion.of(planned), 0.5 * window_s
    duration = planned.travel_time_s + window_s
    time = planned.time_s[0] - half + step_s * np.arange(int(np.ceil(duration / step_s)) + 1)
    count = max(int(BLOCK_S / step_s), 1)
    parts = [_rounded(plan, time[first : first + count], half) for first in range(0, len(time), count)]
    position, speed, acceleration, jerk = np.concatenate(parts, axis=1)
    return Reference(
        start_s=float(time[0]),
        step_s=step_s,
        position_m=frozen_array(position),
        speed_ms=frozen_array(speed),
        acceleration_ms2=frozen_array(acceleration),
        jerk_ms3=frozen_array(jerk),
    )


@dataclass(frozen=True, eq=False)
class PlannedMotion:
    """A plan as a polygon of speed over time, standing before and after it; k + 1 corners.

    Parameters
    ----------
    time_s, speed_ms, position_m : array of shape (k + 1,)
        Corners.
    """

    time_s: FloatArray
    speed_ms: FloatArray
    position_m: FloatArray

    @classmethod
    def of(cls, planned: Trajectory) -> "PlannedMotion":
        """Return the motion of a plan, without cells that take no time."""
        corner = np.append(True, np.diff(planned.time_s) > 0)
        return cls(planned.time_s[corner], planned.speed_ms[corner], planned.position_m[corner])

    def between(self, from_s: float, to_s: float) -> "PlannedMotion":
        """Return the part that covers an interval of time, with clock and position counted from its first corner."""
        first = max(int(np.searchsorted(self.time_s, from_s, side="right")) - 1, 0)
        last = int(np.searchsorted(self.time_s, to_s)) + 1
        time, position = self.time_s[first:last], self.position_m[first:last]
        return PlannedMotion(time - time[0], self.speed_ms[first:last], position - position[0])

    def integrals_at(self, time_s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Return double and single integral of position [m s2, m s], position [m] and speed [m/s]; as many as times."""
        step = np.diff(self.time_s)
        speed, position = self.speed_ms, self.position_m
        # constant acceleration in each cell, so all four are its polynomials; beyond the last corner the train stands
        acceleration = np.append(np.diff(speed) / step, 0.0)
        once = np.append(
            0.0, np.cumsum((position[:-1] + (speed[:-1] / 2 + acceleration[:-1] * step / 6) * step) * step)
        )
        twice_step = once[:-1] + (position[:-1] / 2 + (speed[:-1] / 6 + acceleration[:-1] * step / 24) * step) * step
        twice = np.append(0.0, np.cumsum(twice_step * step))
        cell = np.clip(np.searchsorted(self.time_s, time_s, side="right") - 1, 0, len(self.time_s) - 1)
        since, before = time_s - self.time_s[cell], time_s < self.time_s[0]
        v, a = np.where(before, 0.0, speed[cell]), np.where(before, 0.0, acceleration[cell])
        return (
            twice[cell] + (once[cell] + (position[cell] / 2 + (v / 6 + a * since / 24) * since) * since) * since,
            once[cell] + (position[cell] + (v / 2 + a * since / 6) * since) * since,
            position[cell] + (v + a * since / 2) * since,
            v + a * since,
        )

    def position_at(self, time_s: FloatArray) -> FloatArray:
        """Return the planned position [m]; shape as the times'."""
        return self.integrals_at(time_s)[2]


def _rounded(plan: PlannedMotion, time_s: FloatArray, half_s: float) -> FloatArray:
    """Return position, speed, acceleration and jerk of the rounded plan; shape (4, n).

    The clock starts at zero shortly before: integrals over hours would leave nothing of a difference over tenths of a
    second.
    """
    first = max(int(np.searchsorted(plan.time_s, time_s[0] - half_s, side="right")) - 1, 0)
    here = plan.between(time_s[0] - half_s, time_s[-1] + half_s)
    local = time_s - plan.time_s[first]
    before, at, after = (here.integrals_at(local + shift) for shift in (-half_s, 0.0, half_s))
    # Two moving averages over half of the window each are the second difference of the double integral over half_s^2.
    # Of the four integrals it gives the rounded position and its first three derivatives, the speed's being the jerk.
    rounded = np.array([(after[k] - 2 * at[k] + before[k]) / half_s**2 for k in range(4)])
    rounded[0] += plan.position_m[first]
    return rounded
