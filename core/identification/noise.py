"""How errors of measurement become errors of a simulated speed, and how to weigh those.

The speed that is simulated from a section's first measured speed differs from the measured one by

    r_i = e_i + u_i,    u_i = k_i u_(i-1) + p_i,    k_i = exp(-R'(v_i) dt / m)

with the errors e of the recorder's speed, independent of each other, and the errors p of what drove the train in each
step: they stay in the simulated speed u ever after, so that the r_i are anything but independent, and intervals that
take them for it are far too narrow. A simulated train that is too fast also meets more resistance, so that k is a few
thousandths a second less than 1: without it, half a metre a second too much at the end of an acceleration would be a
resistance that is too small all through the coasting. Each r_i less k_i times the one before it is
p_i + e_i - k_i e_(i-1): only neighbours share an error, and the covariance is tridiagonal. Its Cholesky factor turns
these into independent numbers of variance 1, in O(n). That is generalised least squares on the simulated speed; no
measured speed is differentiated on the way to an effort.

The variance of p_i in a step of dt is that of an effort that is off by a share of itself, of one that changes at an
unknown moment between two samples, and of whatever else pushes the train:

    (dt / m)^2 (share^2 (F_i^2 + F_(i+1)^2) / 4 + (F_(i+1) - F_i)^2 / 12) + push^2 dt

where the effort of a step is the mean of both samples, whose own errors it shares with its neighbours. The share, the
push, and by how much the recorder's speed is worse than its steps are the most likely ones, with weak priors: short
runs hardly tell them.
"""

import math
from dataclasses import dataclass

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray
from railjoule.core.identification.steps import Steps

# where the search for them begins, and how far it may go: 1 % of an effort; 3 mm/s after a second of gusts
FIRST_SHARE, FIRST_PUSH, FIRST_WORSE = 0.01, 0.003, 0.03
PRIOR_DEVIATION = 1.0
"""Of the logarithms: within a factor of e about two times in three."""
LEAST, MOST = np.log([0.01, 1e-4, 1e-4]), np.log([1.0, 1.0, 1.0])
"""Bounds of the share, the push and the recorder's: no recorder measures an effort better than to 1 %."""
MAX_EVALUATIONS = 200
# a recorder without steps still has one in its last digit
MIN_VARIANCE_MS2 = 1e-6
"""Of a recorder's speed [m2/s2]."""


@dataclass(frozen=True)
class Noise:
    """How large the errors are.

    Parameters
    ----------
    effort_share : float
        Of the effort, as a share of it.
    push_ms : float
        Of the speed after a second, by wind and all that the model does not know [m/s].
    speed_factor : float
        Deviation of the recorder's speed over that of its steps.
    """

    effort_share: float = FIRST_SHARE
    push_ms: float = FIRST_PUSH
    speed_factor: float = 1.0


@dataclass(frozen=True, eq=False)
class Driven:
    """Inertia and efforts of a train in n steps, and how much of an error of its speed stays.

    Parameters
    ----------
    inertia_kg : float
        Mass that resists acceleration [kg].
    end_effort_n : array of shape (n,)
        Efforts at the ends of the steps [N].
    kept : array of shape (n,)
        Share of an error of the speed at the start of a step that is left at its end.
    """

    inertia_kg: float
    end_effort_n: FloatArray
    kept: FloatArray


class Whitener:
    """Turns residuals of the speed into independent numbers of variance 1."""

    def __init__(self, steps: Steps, train: Driven, noise: Noise) -> None:
        self.kept = np.where(steps.begins, 0.0, train.kept)
        recorder = np.maximum(steps.speed_variance * noise.speed_factor**2, MIN_VARIANCE_MS2)
        per_force = steps.step_s / train.inertia_kg
        at_end = (0.5 * noise.effort_share * train.end_effort_n) ** 2
        # of the sample before: that at the end of the step before, or where a section begins about the same
        at_start = np.where(steps.begins, at_end, np.roll(at_end, 1))
        bands = np.zeros((2, steps.count))
        bands[0] = per_force**2 * (at_start + at_end + steps.effort_jump_n**2 / 12)
        bands[0] += noise.push_ms**2 * steps.step_s + (1 + train.kept**2) * recorder
        # The error of a speed is in the differences before and after it, once with each sign, that of an effort with
        # the same; sections share none.
        shared = per_force[:-1] * per_force[1:] * at_end[:-1] - train.kept[1:] * recorder[:-1]
        bands[1, :-1] = np.where(steps.begins[1:], 0.0, shared)
        self.factor = scipy.linalg.cholesky_banded(bands, lower=True, check_finite=False)
        # of the determinant of the covariance
        self.logarithm = 2 * float(np.sum(np.log(self.factor[0])))

    def __call__(self, residual_ms: FloatArray) -> FloatArray:
        """Return independent numbers for residuals of the speed at the ends of steps [m/s]; shape (n,)."""
        # where a section begins, nothing is kept of the one before
        difference = residual_ms - self.kept * np.append(0.0, residual_ms[:-1])
        return np.asarray(scipy.linalg.solve_banded((1, 0), self.factor, difference, check_finite=False))


def estimated_noise(steps: Steps, train: Driven, residual_ms: FloatArray) -> Noise:
    """Return the errors that make the residuals of a fit most likely.

    Parameters
    ----------
    steps : Steps
        The measured steps.
    train : Driven
        Its inertia and efforts in them.
    residual_ms : array of shape (n,)
        Simulated less measured speed at their ends [m/s].
    """

    def unlikeliness(logarithms: FloatArray) -> float:
        clipped = np.clip(logarithms, LEAST, MOST)
        noise = _to_noise(clipped)
        whitener = Whitener(steps, train, noise)
        white = whitener(residual_ms)
        outside = float(np.sum((logarithms - clipped) ** 2))
        prior = 0.5 * float(np.sum(((clipped - first) / PRIOR_DEVIATION) ** 2))
        return 0.5 * float(white @ white) + 0.5 * whitener.logarithm + prior + 1e3 * outside

    first = np.log([FIRST_SHARE, FIRST_PUSH, FIRST_WORSE])
    found = scipy.optimize.minimize(
        unlikeliness, first, method="Nelder-Mead", options={"maxfev": MAX_EVALUATIONS, "xatol": 0.02, "fatol": 0.01}
    )
    return _to_noise(np.clip(found.x, LEAST, MOST))


def expected_residual_ms(steps: Steps, train: Driven) -> float:
    """Return the root mean square of simulated less measured speeds by errors of usual size [m/s].

    Parameters
    ----------
    steps, train
        As `estimated_noise`.
    """
    usual = Noise()
    recorder = np.maximum(steps.speed_variance, MIN_VARIANCE_MS2)
    variance = usual.effort_share**2 * train.end_effort_n**2 + steps.effort_jump_n**2 / 12
    driven = (steps.step_s / train.inertia_kg) ** 2 * variance
    added = np.cumsum(driven + usual.push_ms**2 * steps.step_s)
    firsts = np.flatnonzero(steps.begins)
    before = np.append(0.0, added)[firsts]
    within = added - np.repeat(before, np.diff(np.append(firsts, steps.count)))
    return float(np.sqrt(np.mean(within + 2 * recorder)))


def _to_noise(logarithms: FloatArray) -> Noise:
    share, push, worse = np.exp(logarithms)
    # never better than its steps
    return Noise(float(share), float(push), math.sqrt(1.0 + float(10 * worse) ** 2))


WINDOW_S = 30.0
"""Over this time sums of residuals are compared with those of independent ones: gusts and drifts are shorter."""
FEWEST_FREEDOM = 5.0


def scale_freedom(step_s: FloatArray) -> float:
    """Return the degrees of freedom of a variance by such windows, 1.5 for each that fits into the time of the steps.

    That is the equivalent number of Bartlett's estimate. Fewer than `FEWEST_FREEDOM` are never returned: the deviations
    of single samples are known better.
    """
    return max(1.5 * float(np.sum(step_s)) / WINDOW_S, FEWEST_FREEDOM)


def noise_inflation(residual: FloatArray, jacobian: FloatArray, bread: FloatArray, step_s: FloatArray) -> float:
    """Return the factor on the deviations of residuals by their correlation over time; at least 1.

    Independent errors almost cancel in a sum over many samples, those of a gust or a drift do not. The mean square of
    the sums of all windows (Bartlett's estimate of the variance at frequency zero) is divided by its expectation for
    independent residuals of variance 1, of which the fit has taken its share.

    Parameters
    ----------
    residual : array of shape (n,)
        Residuals of variance 1, if the errors are as assumed.
    jacobian : array of shape (n, unknowns)
        Their derivatives.
    bread : array of shape (unknowns, unknowns)
        Inverse of the product of the whole Jacobian with itself.
    step_s : array of shape (n,)
        Times between samples [s].
    """
    if not len(residual):
        return 1.0
    length = min(max(round(WINDOW_S / float(np.median(step_s))), 1), len(residual))
    sums, slopes = _window_sums(residual[:, None], length)[:, 0], _window_sums(jacobian, length)
    expected = length * len(residual) - float(np.sum((slopes @ bread) * slopes))
    return float(np.sqrt(max(float(np.sum(sums**2)) / expected, 1.0)))


def _window_sums(values: FloatArray, length: int) -> FloatArray:
    """Return sums over all windows of a length, with fewer values at both ends; shape (n + length - 1, columns)."""
    total = np.concatenate([np.zeros((length, values.shape[1])), np.cumsum(values, axis=0)])
    total = np.concatenate([total, np.repeat(total[-1:], length - 1, axis=0)])
    return np.asarray(total[length:] - total[:-length])
