"""Speeds without the steps in which a recorder writes them, and without its noise.

A speed in steps of q is off by up to q / 2, one with noise by more. From one sample to the next that is an acceleration
which the train never had, and a model would pay for it in traction and brakes in turn: 30 % of the energy of a metro
that coasts most of its way in steps of 0.1 m/s, and as much again as the whole energy at a noise of 0.6 km/h. The steps
leave open a band of q / 2 to both sides of each sample; noise of a standard deviation s leaves it by |e_i|, in the mean
by s sqrt(2 / pi). Of all courses of speed v that differ by so much from the samples the one is taken whose effort
changes least,

    minimise    sum |f_(i+1) - f_i| + epsilon sum |f_i|       f_i = (v_(i+1) - v_i) / dt + pull_i
    subject to  |v_i + e_i - measured_i| <= q / 2             zero stays zero
                |e_i| <= 3.5 s,  sum |e_i| <= n s sqrt(2 / pi)

with effort f and the pull of resistance, gradients and curves in m/s2, the latter taken at the samples. It is a linear
program; the changes that are left are those that the measured speeds force. The small second term decides what the
first leaves open: between driving and braking lies coasting. An effort of next to nothing is coasting too, since many
drives take power as soon as they are on.
"""

import numpy as np
import scipy

from railjoule.core.arrays import BoolArray, FloatArray
from railjoule.core.errors import SolverError

FEWEST_POINTS = 4
"""Between fewer samples there is no change of effort."""
MOST_POINTS = 1500
"""Of a stretch that is longer, means of some samples are smoothed: the time of the linear program grows faster."""
# at 1 Hz half of it is 5 mm/s2, the effort that holds a metro against a tenth of its resistance
LEAST_STEP_MS = 0.01
"""No recorder knows a speed better than this [m/s]."""
COASTING_WEIGHT = 0.05
"""Epsilon: any small number, so that changes of effort count first."""
SLOWEST_SHARE = 0.01
"""Of a step: a train that moves is not let stand."""
LARGEST_DEVIATIONS = 3.5
"""Noise exceeds so many standard deviations in one of 2,000 samples."""
MEAN_OF_NORMAL = np.sqrt(2 / np.pi)
"""Mean of the absolute values of a normal variable with deviation 1."""
COASTING_S = 20.0
"""An effort that takes longer to change the speed by a step cannot be told from none."""


def smoothed_speed(
    time_s: FloatArray, speed_ms: FloatArray, step_ms: float, noise_ms: float, pull_ms2: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Return speeds without their steps and their noise [m/s], and between which samples the train coasts.

    Parameters
    ----------
    time_s, speed_ms : array of shape (n,)
        Samples.
    step_ms : float
        In such steps the speeds are given, at least `LEAST_STEP_MS` [m/s].
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
    for first, last in moving_stretches(speed_ms):
        if last + 1 - first >= FEWEST_POINTS:
            samples, cells = slice(first, last + 1), slice(first, last)
            smoothed[samples] = _smoothed_stretch(
                time_s[samples], speed_ms[samples], step_ms, noise_ms, pull_ms2[cells]
            )
            effort = np.diff(smoothed[samples]) / np.diff(time_s[samples]) + pull_ms2[cells]
            coasts[cells] = np.abs(effort) < step_ms / COASTING_S
    return smoothed, coasts


def moving_stretches(speed_ms: FloatArray) -> list[tuple[int, int]]:
    """Return first and last sample of each stretch in motion, samples at rest at its ends included."""
    moving = np.concatenate([[False], speed_ms > 0, [False]]).astype(int)
    starts, ends = np.flatnonzero(np.diff(moving) > 0), np.flatnonzero(np.diff(moving) < 0)
    last = len(speed_ms) - 1
    return [(max(int(start) - 1, 0), min(int(end), last)) for start, end in zip(starts, ends, strict=True)]


def _smoothed_stretch(
    time_s: FloatArray, speed_ms: FloatArray, step_ms: float, noise_ms: float, pull_ms2: FloatArray
) -> FloatArray:
    """Return the smoothed speeds of one stretch [m/s], of many samples by means of several."""
    inner = len(speed_ms) - 2
    size = -(-inner // MOST_POINTS)
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
        most = np.where(moving, LARGEST_DEVIATIONS * noise_ms, 0.0)
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
