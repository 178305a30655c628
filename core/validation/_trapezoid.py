"""A trapezoidal run sampled over time: the extremes of current and energy that (12) does not give."""

import numpy as np
from scipy.integrate import cumulative_simpson

from railjoule.core.arrays import frozen_array
from railjoule.core.strategies.plain_line import PlainLine, SampledRun

# The power is a polynomial of fourth degree in time, which Simpson integrates with an error of the fourth power of the
# step: 1001 samples are far below the printed digits, and place the extremes to a thousandth of a part.
SAMPLES_A_PART = 1001


def sample_trapezoid(line: PlainLine, travel_time_s: float, acceleration_time_s: float) -> SampledRun:
    """Return ENOC's run between rest and rest, Ftorek et al. 2025, Figure 2 and (11).

    Parameters
    ----------
    line : PlainLine
        Length, inertia, resistance and copper loss.
    travel_time_s, acceleration_time_s : float
        T_m and T_e [s]; T_e is at most half of T_m.
    """
    peak = line.distance_m / (travel_time_s - acceleration_time_s)
    ramp_ms2 = peak / acceleration_time_s
    parts = (
        (acceleration_time_s, 0.0, ramp_ms2),
        (travel_time_s - 2 * acceleration_time_s, peak, 0.0),
        (acceleration_time_s, peak, -ramp_ms2),
    )
    columns = []
    # part by part, as the effort jumps at the corners and Simpson across a jump would be of first order
    start_s, start_m, start_j, shaft = 0.0, 0.0, 0.0, 0.0
    for duration_s, start_ms, acceleration_ms2 in parts:
        if duration_s <= 0:  # a triangle has no cruise
            continue
        time = np.linspace(0, duration_s, SAMPLES_A_PART)
        speed = start_ms + acceleration_ms2 * time
        resistance = line.resistance_n(speed)
        effort = line.inertia_kg * acceleration_ms2 + resistance
        power = effort * speed + line.loss_coefficient * effort**2
        energies = start_j + cumulative_simpson(power, x=time, initial=0)
        places = start_m + (start_ms + 0.5 * acceleration_ms2 * time) * time
        columns.append((start_s + time, places, speed, np.full_like(time, acceleration_ms2), effort, energies))
        start_s, start_m, start_j = start_s + duration_s, float(places[-1]), float(energies[-1])
        shaft += float(cumulative_simpson(resistance * speed, x=time)[-1])
    joined = (frozen_array(np.concatenate(column)) for column in zip(*columns, strict=True))
    time, place, speed, accelerations, effort, energies = joined
    return SampledRun(time, place, speed, accelerations, effort, energies, shaft)
