"""Errors of a recorder's speed: the steps in which it is given, its noise, and what it shows of a train at rest."""

import numpy as np

from railjoule.core.arrays import BoolArray, FloatArray

MOST_PARTS = 5
"""Where few levels occur, no two of them may lie a single step apart, but hardly more than so many."""
LEAST_SHARE = 1e-4
"""Of the largest value: a step as small is none."""
MOST_DECIMALS = 9
DECIMALS_PER_STEP = 1.99
"""Of a step of fewer last decimals, nearly all levels are multiples within half a decimal."""
CHANCE = 0.01
"""Largest probability that levels without a step have the one that is found."""
GRID_PER_DECIMAL = 4
"""Steps on trial for each half of a last decimal in the largest level."""
STEADY_WEIGHTS = np.array([1.0, -4.0, 6.0, -4.0, 1.0]) / np.sqrt(70.0)
"""Fourth difference, of which independent errors keep their variance and a smooth speed leaves next to nothing."""
MAD_OF_NORMAL = 0.6745
"""Median of the absolute values of a normal variable with deviation 1."""
LEAST_ERROR = 0.6
"""Of the deviation that steps have: an even change of speed, rounded to decimals, has less."""
CLIPPED, CLIPPED_VARIANCE, CLIPPING_ROUNDS = 2.5, 0.9113, 5
"""A normal variable of deviation 1 within 2.5 to both sides has this variance."""
FEWEST_DIFFERENCES = 10
"""Fewer do not estimate a noise."""
NOISE_FACTOR = 1.6
"""Errors of steps are not quite independent: only beyond this factor of theirs is an estimate that of a noise."""
UNIFORM = 1 / np.sqrt(12.0)
"""Standard deviation of an error spread evenly over a step of 1."""
STANDSTILL_MS, MOST_STANDSTILL_MS = 0.2, 0.6
"""A train at rest may show the first: sensors have an offset, receivers of satellites a noise; no train creeps at less
than the second."""
STANDSTILL_S = 2.0
"""A train that brakes or starts by 0.1 m/s2 is slower than `STANDSTILL_MS` for no longer."""
# emergency brakes of trams, magnetic track brakes included, reach some 3 m/s2
LARGEST_CHANGE_MS2 = 5.0
"""More no train does: the recorder was reset, or columns are mixed up."""
CHANGE_S = 1.0
"""Over so long a change counts: a reading may be off by a step, and a stop lies anywhere between two samples."""
DEVIATIONS = 3.0
"""Noise exceeds so many standard deviations in one of 400 samples."""


def quantisation(values: FloatArray) -> float:
    """Return the step in which values are given: the largest number whose multiples they are; 0 where there is none.

    Values may have been rounded twice, as those of a recorder in steps of 1 km/h that are written as m/s with two
    decimals. A step is then one of which each level is a multiple within half of its last decimal.

    Parameters
    ----------
    values : array
        In the unit in which they are written.
    """
    levels = np.unique(np.abs(np.round(values, MOST_DECIMALS)))
    differences = np.diff(levels)
    if len(differences) < 2:
        return 0.0
    decimal = _last_decimal(levels)
    least, largest = float(np.min(differences)), float(levels[-1])
    # values of a continuous quantity hardly repeat, and have tiny differences
    for parts in range(1, MOST_PARTS + 1):
        low = max((least - decimal) / parts, LEAST_SHARE * largest, DECIMALS_PER_STEP * decimal)
        high = (least + decimal) / parts
        if high > low and (step := _common_step(levels, decimal, low, high)) and _has_errors_of(step, values):
            return step
    return decimal if decimal > LEAST_SHARE * largest else 0.0


def _last_decimal(levels: FloatArray) -> float:
    """Return the value of the last decimal with which levels are written."""
    for digits in range(MOST_DECIMALS):
        if np.all(np.abs(levels - np.round(levels, digits)) < 10.0**-MOST_DECIMALS):
            return 10.0**-digits
    return 10.0**-MOST_DECIMALS


def _common_step(levels: FloatArray, decimal: float, low: float, high: float) -> float | None:
    """Return the step between two bounds whose multiples the levels are within half a decimal; None without one."""
    # an error in the step grows with the level: at the largest one it must stay well within half a decimal
    relative = decimal / (2 * GRID_PER_DECIMAL * float(levels[-1]))
    steps = np.geomspace(high, low, int(np.ceil(np.log(high / low) / relative)) + 1)
    allowed = 0.5 * decimal * (1 + 1 / GRID_PER_DECIMAL)
    # any level is as close to a multiple by chance with the probability 2 allowed / step
    steps = steps[len(steps) * (2 * allowed / steps) ** (len(levels) - 1) < CHANCE]
    # the largest levels rule out most steps on trial
    for level in levels[::-1]:
        steps = steps[np.abs(level - steps * np.round(level / steps)) <= allowed]
        if not len(steps):
            return None
    misfits = [float(np.max(np.abs(levels - step * np.round(levels / step)))) for step in steps.tolist()]
    multiples = np.round(levels / steps[int(np.argmin(misfits))])
    return float(multiples @ levels / (multiples @ multiples))


def _has_errors_of(step: float, values: FloatArray) -> bool:
    """Return whether values that change in each sample err as those in steps do: an even change has equal steps too."""
    windows = _windows(values)
    changing = windows[np.all(np.diff(windows) != 0, axis=1)]
    # values that often stay have no even change
    if 2 * len(changing) <= len(windows):
        return True
    errors = changing @ STEADY_WEIGHTS
    return bool(np.sqrt(np.mean(errors**2)) > LEAST_ERROR * UNIFORM * step)


def _windows(values: FloatArray) -> FloatArray:
    """Return all runs of as many successive values as `STEADY_WEIGHTS` has; shape (m, 5)."""
    count = len(STEADY_WEIGHTS)
    if len(values) < count:
        return np.empty((0, count))
    return np.lib.stride_tricks.sliding_window_view(values, count)


def noise_deviation(speed_ms: FloatArray, step_ms: float) -> float:
    """Return the standard deviation of a speed's errors beyond those of its steps [m/s]; 0 where they explain all.

    Parameters
    ----------
    speed_ms : array of shape (n,)
        Samples.
    step_ms : float
        Their step [m/s].
    """
    windows = _windows(speed_ms)
    moving = windows[np.all(windows > 0, axis=1)]
    if len(moving) < FEWEST_DIFFERENCES:
        return 0.0
    errors = np.abs(moving @ STEADY_WEIGHTS)
    deviation = float(np.median(errors)) / MAD_OF_NORMAL
    for _ in range(CLIPPING_ROUNDS):
        # few samples lie beside a change of effort, and these are clipped
        kept = errors[errors <= CLIPPED * deviation]
        deviation = float(np.sqrt(np.mean(kept**2) / CLIPPED_VARIANCE)) if len(kept) else 0.0
    of_steps = UNIFORM * step_ms
    return float(np.sqrt(deviation**2 - of_steps**2)) if deviation > NOISE_FACTOR * of_steps else 0.0


def impossible_change(time_s: FloatArray, speed_ms: FloatArray) -> tuple[int, int] | None:
    """Return two samples between which the speed changes faster than that of any train; None where there are none.

    Parameters
    ----------
    time_s, speed_ms : array of shape (n,)
        Samples; times do not fall.
    """
    first = np.arange(len(time_s) - 1)
    within = np.searchsorted(time_s, time_s[:-1] + CHANGE_S, side="right") - 1
    # of samples many times a second, those a second apart too
    for later in (first + 1, np.maximum(within, first + 1)):
        allowed = LARGEST_CHANGE_MS2 * np.maximum(time_s[later] - time_s[first], CHANGE_S)
        for row in np.flatnonzero(np.abs(speed_ms[later] - speed_ms[first]) > allowed)[:1]:
            return int(row), int(later[row])
    return None


def standstill_ms(noise_ms: float) -> float:
    """Return up to which speed a recorder may show a train at rest [m/s]."""
    return min(max(STANDSTILL_MS, DEVIATIONS * noise_ms), MOST_STANDSTILL_MS)


def standing_samples(time_s: FloatArray, speed_ms: FloatArray, noise_ms: float) -> BoolArray:
    """Return the samples at which a speed above 0 is that of a train at rest.

    Parameters
    ----------
    time_s, speed_ms : array of shape (n,)
        Samples.
    noise_ms : float
        As `noise_deviation` returns it [m/s].
    """
    slow = speed_ms <= standstill_ms(noise_ms)
    edges = np.diff(np.concatenate([[False], slow, [False]]).astype(int))
    standing = np.zeros(len(slow), dtype=bool)
    for first, beyond in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
        # the samples beside a motion may be those of a train that starts or stops
        inner = speed_ms[first + (first > 0) : beyond - (beyond < len(slow))]
        if time_s[beyond - 1] - time_s[first] >= STANDSTILL_S and np.any(inner > 0):
            standing[first:beyond] = True
    return standing
