"""The losses and limits of one kind of drive in the check, and the gear between motors and wheels.

Beside them functions of arrays of polynomials, with coefficients of shape (k, m), constant first.
"""

from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray

# far above the rounding of a torque from an effort, far below the accuracy of any limit
EDGE = 1e-9
"""How far rounding may exceed the end of a map, or a limit of current or voltage, as a share."""

# two equal roots separate by the square root of the rounding, 1e-8, into the complex plane; 1e-6 keeps them
SPLIT_ROOT = 1e-6
"""Imaginary over real part up to which a root is one of two equal ones that rounding has split."""

Losses = dict[str, FloatArray]

LOSS_MODELS: dict[str, type["LossModel"]] = {}
"""The loss model of each drive, by `drive.model`."""


# Written from the formulas with NumPy. The kernels of `core/drive` would be quicker and would repeat their own
# errors: a wrong sign there could never be found here.
class LossModel:
    """One kind of drive, for arrays of effort [N], braking negative, and speed [m/s] of shape (k,).

    A subclass is declared with the name of its drive, `class Name(LossModel, model="...")`.

    Parameters
    ----------
    parameters : DriveParameters
        Of the scenario.
    """

    accuracy = 0.0
    """The allowed difference of the product's losses, as a share of them and of a tenth of the run's largest: 0
    where the product evaluates the same formula, more where it tabulates one."""

    def __init__(self, parameters: Any) -> None:
        self.parameters = parameters

    def __init_subclass__(cls, model: str = "") -> None:
        if model:
            LOSS_MODELS[model] = cls

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> Losses:
        """Return the losses of a drive that is on by kind [W]; NaN beyond the limits of its motors."""
        raise NotImplementedError

    def max_effort_n(self, speed_ms: FloatArray, braking: bool) -> FloatArray:
        """Return the largest effort of the motors [N]; infinite where the model sets no limit."""
        return np.full(len(speed_ms), np.inf)

    def current_a(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray | None:
        """Return the current of a motor [A], negative in braking, or None where the model has none."""
        return None


class GearedModel(LossModel):
    """Motors behind gears.

    A gear loses g |F v|: a shaft has F (1 + g) / (n x) in driving and F (1 - g) / (n x) in braking, x = gear ratio over
    wheel radius.
    """

    def __init__(self, parameters: Any) -> None:
        super().__init__(parameters)
        self.turns_per_metre = parameters.gear_ratio / (0.5 * parameters.wheel_diameter_m)
        self.driving_share, self.braking_share = self.shaft_over_wheel()

    def shaft_over_wheel(self) -> tuple[float, float]:
        """Return the power of the shafts over power at the wheels in driving and in braking."""
        return 1 + self.parameters.gear_loss_share, 1 - self.parameters.gear_loss_share

    def shaft_torque_nm(self, effort_n: FloatArray) -> FloatArray:
        """Return the torque of each shaft, braking negative [N m]."""
        share = np.where(effort_n > 0, self.driving_share, self.braking_share)
        return np.asarray(effort_n * share / (self.parameters.motors * self.turns_per_metre))

    def gear_loss_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the loss of the gears [W]."""
        work: FloatArray = effort_n * speed_ms
        return np.where(work > 0, work * (self.driving_share - 1), work * (self.braking_share - 1))

    def max_effort_n(self, speed_ms: FloatArray, braking: bool) -> FloatArray:
        """Return the effort of the greatest torque [N]."""
        torque = self.max_torque_nm(self.turns_per_metre * speed_ms, braking)
        share = self.braking_share if braking else self.driving_share
        return np.asarray(self.parameters.motors * self.turns_per_metre * torque / share)

    def max_torque_nm(self, speed_rads: FloatArray, braking: bool) -> FloatArray:
        """Return the greatest torque of a shaft, without sign [N m]."""
        return np.full(len(speed_rads), np.inf)


def values(polynomial: FloatArray, at: FloatArray) -> FloatArray:
    """Return the values of polynomials of shape (k, m) at arguments of shape (k, l)."""
    return np.asarray(np.polynomial.polynomial.polyval(at, polynomial.T[:, :, None], tensor=False))


def product(first: FloatArray, second: FloatArray) -> FloatArray:
    """Return the products of polynomials of shape (k, m) and (k, l); shape (k, m + l - 1)."""
    result = np.zeros((len(first), first.shape[1] + second.shape[1] - 1))
    for power, coefficient in enumerate(first.T):
        result[:, power : power + second.shape[1]] += coefficient[:, None] * second
    return result


def real_roots(polynomial: FloatArray) -> FloatArray:
    """Return the real roots of polynomials of shape (k, m), NaN in the place of others; shape (k, m - 1).

    They are the eigenvalues of companion matrices. Polynomials whose last coefficient is 0 have none here.
    """
    degree = polynomial.shape[1] - 1
    companion = np.zeros((len(polynomial), degree, degree))
    companion[:, 1:, :-1] = np.eye(degree - 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        companion[:, :, -1] = -polynomial[:, :-1] / polynomial[:, -1:]
    # eigvals refuses a whole stack for one NaN, so polynomials of lower degree are replaced and their roots dropped
    known = np.isfinite(companion.sum(axis=(1, 2)))
    roots = np.linalg.eigvals(np.where(known[:, None, None], companion, 0.0))
    real = known[:, None] & (np.abs(roots.imag) <= SPLIT_ROOT * np.abs(roots.real))
    return np.where(real, roots.real, np.nan)
