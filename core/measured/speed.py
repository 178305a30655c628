"""Speeds without the steps in which a recorder writes them, and without its noise.

A speed in steps of q is off by up to q / 2, one with noise by more. From one sample to the next that is an acceleration
which the train never had, and a model would pay for it in traction and brakes in turn: 30 % of the energy of a metro
that coasts most of its way in steps of 0.1 m/s, and as much again as the whole energy at a noise of 0.6 km/h. The steps
leave open a band of q / 2 to both sides of each sample; noise of a standard deviation s leaves it by |e_i|, in the mean
by s sqrt(2 / pi). Of all meshed lines of speed v that differ by so much from the samples the one is taken whose effort
changes least,

    minimise    sum |f_(i+1) - f_i| + epsilon sum |f_i|       f_i = (v_(i+1) - v_i) / dt + pull_i
    subject to  |v_i + e_i - measured_i| <= q / 2             zero stays zero
                |e_i| <= 3.5 s,  sum |e_i| <= n s sqrt(2 / pi)

with effort f and the pull of resistance, gradients and curves in m/s2, the latter taken at the samples. It is a linear
program; the changes that are left are those that the measured speeds force. The small second term decides what the
first leaves open: between driving and braking lies coasting. An effort of next to nothing is coasting too, since many
drives take power as soon as they are on.

The second half of the file estimates the errors of a recorder's speed: the steps in which it is given, its noise, and
its readings of a train at rest.
"""

import numpy as np
import scipy

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.errors import SolverError

FEWEST_POINTS = 4
"""Between fewer samples there is no change of effort."""
MAX_POINTS = 1500
"""Of a stretch that is longer, means of some samples are smoothed: the time of the linear program grows faster."""
# at 1 Hz half of it is 5 mm/s2, the effort that holds a metro against a tenth of its resistance
MIN_STEP_MS = 0.01
"""No recorder is more accurate than this [m/s]."""
COASTING_WEIGHT = 0.05
"""Epsilon: any small number, so that changes of effort count first."""
SLOWEST_SHARE = 0.01
"""Of a step: a train that moves is not let stand."""
MAX_DEVIATIONS = 3.5
"""Noise exceeds so many standard deviations in one of 2,000 samples."""
MEAN_OF_NORMAL = np.sqrt(2 / np.pi)
"""Mean of the absolute values of a normal variable with deviation 1."""
COASTING_S = 20.0
"""An effort that takes longer to change the speed by a step looks like none."""


def smoothed_speed(
    time_s: FloatArray, speed_ms: FloatArray, step_ms: float, noise_ms: float, pull_ms2: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Return speeds without their steps and their noise [m/s], and between which samples the train coasts.

    Parameters
    ----------
    time_s, speed_ms : array of shape (n,)
        Samples.
    step_ms : float
        In such steps the speeds are given, at least `MIN_STEP_MS` [m/s].
    noise_ms : float
        Standard deviation of their errors beyond those of the steps [m/s].
    pull_ms2 : array of shape (n - 1,)
        Resistance, gradient and curve between the samples over inertia [m/s2].

    Returns
    -------
    speed_ms : array of shape (n,)
    coasts : array of bool of shape (n - 1,)
    """
    smoothed, coasts = np.array(speed_ms), np.zeros(len(speed_ms) - 1, dtype=bool)
    for start, beyond in true_runs(speed_ms > 0):
        # samples at rest at its ends included
        first, last = max(start - 1, 0), min(beyond, len(speed_ms) - 1)
        if last + 1 - first >= FEWEST_POINTS:
            samples, cells = slice(first, last + 1), slice(first, last)
            smoothed[samples] = _smoothed_stretch(
                time_s[samples], speed_ms[samples], step_ms, noise_ms, pull_ms2[cells]
            )
            effort = np.diff(smoothed[samples]) / np.diff(time_s[samples]) + pull_ms2[cells]
            coasts[cells] = np.abs(effort) < step_ms / COASTING_S
    return smoothed, coasts


def true_runs(mask: BoolArray) -> list[tuple[int, int]]:
    """List the stretches in which a mask is true, each by its first index and the one beyond its last."""
    edges = np.diff(np.concatenate([[False], mask, [False]]).astype(int))
    return list(zip(np.flatnonzero(edges > 0).tolist(), np.flatnonzero(edges < 0).tolist(), strict=True))


def _smoothed_stretch(
    time_s: FloatArray, speed_ms: FloatArray, step_ms: float, noise_ms: float, pull_ms2: FloatArray
) -> FloatArray:
    """Return the smoothed speeds of one stretch [m/s], of many samples by means of several."""
    inner = len(speed_ms) - 2
    size = -(-inner // MAX_POINTS)
    if size == 1:
        return _steadiest(time_s, speed_ms, step_ms, noise_ms, pull_ms2)
    # both ends, which may be at rest, stay samples of their own
    borders = np.concatenate([[0], np.arange(1, inner + 1, size), [inner + 1]])
    counts = np.diff(np.append(borders, inner + 2))
    times, speeds = (np.add.reduceat(values, borders) / counts for values in (time_s, speed_ms))
    pulls = np.interp(0.5 * (times[1:] + times[:-1]), 0.5 * (time_s[1:] + time_s[:-1]), pull_ms2)
    means = _steadiest(times, speeds, step_ms, noise_ms / float(np.sqrt(size)), pulls)
    smoothed: FloatArray = np.interp(time_s, times, means)
    return np.where(speed_ms > 0, smoothed, 0.0)


def _steadiest(
    time_s: FloatArray, speed_ms: FloatArray, step_ms: float, noise_ms: float, pull_ms2: FloatArray
) -> FloatArray:
    """Solve the linear program of one stretch; its variables are speeds, and parts of efforts, changes and errors."""
    n, step_s = len(speed_ms), np.diff(time_s)
    sparse = scipy.sparse
    change_of_speed = sparse.diags([-1 / step_s, 1 / step_s], [0, 1], shape=(n - 1, n))
    change_of_effort = sparse.diags([-np.ones(n - 2), np.ones(n - 2)], [0, 1], shape=(n - 2, n - 1))
    one, two = sparse.eye(n - 1), sparse.eye(n - 2)
    # f = (v' - v) / dt + pull = f+ - f-, and f' - f = c+ - c-; each absolute value is the sum of its two parts
    blocks = [[change_of_speed, -one, one, None, None], [None, change_of_effort, -change_of_effort, -two, two]]
    moving = speed_ms > 0
    low = np.where(moving, np.maximum(speed_ms - 0.5 * step_ms, SLOWEST_SHARE * step_ms), 0.0)
    high = np.where(moving, speed_ms + 0.5 * step_ms, 0.0)
    parts = 2 * (n - 1) + 2 * (n - 2)
    cost = np.concatenate([np.zeros(n), COASTING_WEIGHT * np.tile(step_s, 2) / step_s.mean(), np.ones(2 * (n - 2))])
    bounds = np.concatenate([np.column_stack([low, high]), np.tile([0.0, np.inf], (parts, 1))])
    budget = {}
    if noise_ms > 0:
        # the train moves at low + e+ - e-, or above
        most = np.where(moving, MAX_DEVIATIONS * noise_ms, 0.0)
        errors = np.concatenate([most, np.minimum(most, np.maximum(low - SLOWEST_SHARE * step_ms, 0.0))])
        blocks = [[*blocks[0], change_of_speed, -change_of_speed], [*blocks[1], None, None]]
        bounds = np.concatenate([bounds, np.column_stack([np.zeros(2 * n), errors])])
        budget = {
            "A_ub": sparse.csr_matrix(np.append(np.zeros(len(cost)), np.ones(2 * n))[None, :]),
            "b_ub": [MEAN_OF_NORMAL * noise_ms * np.count_nonzero(moving)],
        }
        cost = np.append(cost, np.zeros(2 * n))
    found = scipy.optimize.linprog(
        cost,
        A_eq=sparse.bmat(blocks),
        b_eq=np.append(-pull_ms2, np.zeros(n - 2)),
        bounds=bounds,
        method="highs",
        **budget,
    )
    if found.x is None:
        raise SolverError(f"The measured speed could not be smoothed: {found.message}")
    speeds: FloatArray = found.x[:n]
    if noise_ms > 0:
        speeds = speeds + found.x[-2 * n : -n] - found.x[-n:]
    return speeds


MAX_PARTS = 5
"""Among few levels, no two may differ by a single step, but hardly by more than so many."""
MIN_SHARE = 1e-4
"""Of the largest value: a step as small is none."""
MAX_DECIMALS = 9
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
MIN_ERROR = 0.6
"""Of the deviation that steps have: an even change of speed, rounded to decimals, has less."""
CLIPPED, CLIPPED_VARIANCE, CLIPPING_ROUNDS = 2.5, 0.9113, 5
"""A normal variable of deviation 1 within 2.5 to both sides has this variance."""
FEWEST_DIFFERENCES = 10
"""Fewer do not estimate a noise."""
NOISE_FACTOR = 1.6
"""Errors of steps are not quite independent: only beyond this factor of theirs is an estimate that of a noise."""
UNIFORM = 1 / np.sqrt(12.0)
"""Standard deviation of an error spread evenly over a step of 1."""
STANDSTILL_MS, MAX_STANDSTILL_MS = 0.2, 0.6
"""A train at rest may show the first: sensors have an offset, receivers of satellites a noise; no train creeps at less
than the second."""
STANDSTILL_S = 2.0
"""A train that brakes or starts by 0.1 m/s2 is slower than `STANDSTILL_MS` for no longer."""
# emergency brakes of trams, magnetic track brakes included, reach some 3 m/s2
MAX_CHANGE_MS2 = 5.0
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
    levels = np.unique(np.abs(np.round(values, MAX_DECIMALS)))
    differences = np.diff(levels)
    if len(differences) < 2:
        return 0.0
    decimal = _last_decimal(levels)
    least, largest = float(np.min(differences)), float(levels[-1])
    # values of a continuous quantity hardly repeat, and have tiny differences
    for parts in range(1, MAX_PARTS + 1):
        low = max((least - decimal) / parts, MIN_SHARE * largest, DECIMALS_PER_STEP * decimal)
        high = (least + decimal) / parts
        if high > low and (step := _common_step(levels, decimal, low, high)) and _has_step_errors(step, values):
            return step
    return decimal if decimal > MIN_SHARE * largest else 0.0


def _last_decimal(levels: FloatArray) -> float:
    """Return the value of the last decimal with which levels are written."""
    for digits in range(MAX_DECIMALS):
        if np.all(np.abs(levels - np.round(levels, digits)) < 10.0**-MAX_DECIMALS):
            return 10.0**-digits
    return 10.0**-MAX_DECIMALS


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


def _has_step_errors(step: float, values: FloatArray) -> bool:
    """Return whether values that change in each sample err as those in steps do: an even change has equal steps too."""
    windows = _windows(values)
    changing = windows[np.all(np.diff(windows) != 0, axis=1)]
    # values that often stay have no even change
    if 2 * len(changing) <= len(windows):
        return True
    errors = changing @ STEADY_WEIGHTS
    return bool(np.sqrt(np.mean(errors**2)) > MIN_ERROR * UNIFORM * step)


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
    # of samples many times a second, also pairs with a second between them
    for later in (first + 1, np.maximum(within, first + 1)):
        allowed = MAX_CHANGE_MS2 * np.maximum(time_s[later] - time_s[first], CHANGE_S)
        for row in np.flatnonzero(np.abs(speed_ms[later] - speed_ms[first]) > allowed)[:1]:
            return int(row), int(later[row])
    return None


def standstill_ms(noise_ms: float) -> float:
    """Return up to which speed a recorder may show a train at rest [m/s]."""
    return min(max(STANDSTILL_MS, DEVIATIONS * noise_ms), MAX_STANDSTILL_MS)


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
    standing = np.zeros(len(slow), dtype=bool)
    for first, beyond in true_runs(slow):
        # the samples beside a motion may be those of a train that starts or stops
        inner = speed_ms[first + (first > 0) : beyond - (beyond < len(slow))]
        if time_s[beyond - 1] - time_s[first] >= STANDSTILL_S and np.any(inner > 0):
            standing[first:beyond] = True
    return standing
