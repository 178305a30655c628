"""A drive: what the line gives or takes for an effort at a speed, and where the rest goes."""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.kernels import electrical_power_array
from railjoule.core.drive.kinds import CAPABILITIES
from railjoule.core.drive.line_power import line_power, resistor_power


@dataclass(frozen=True, eq=False)
class Drive:
    """The loss model of a vehicle's drive, for arrays of effort and speed.

    Efforts act at the wheels of the whole train; a negative effort is electric braking.

    Parameters
    ----------
    kind : int
        Which kernels of `railjoule.core.drive.kernels` belong to it.
    parameters : array
        What those kernels need.
    recuperation_factor : float
        Share of the generated energy that the line takes back.
    loss_kind : str
        What its losses are called in the energy account.
    amperes_per_newton : float or None
        Current of one motor over tractive effort of the train [A/N], if the model has a current.
    """

    kind: int
    parameters: FloatArray
    recuperation_factor: float
    loss_kind: str
    amperes_per_newton: float | None

    def __post_init__(self) -> None:
        if not 0 <= self.kind < len(CAPABILITIES):
            raise ValueError(f"drive kind {self.kind} has no row in railjoule.core.drive.kinds.CAPABILITIES.")

    @property
    def jumps_at_no_effort(self) -> bool:
        """Whether it takes power without effort when it is on, and none when it is off."""
        return CAPABILITIES[self.kind].jumps_at_no_effort

    def electrical_power_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the power at the terminals of the drive [W], negative where it generates; shape as the arguments'."""
        effort, speed = np.broadcast_arrays(np.asarray(effort_n, float), np.asarray(speed_ms, float))
        power = np.empty(effort.size)
        electrical_power_array(self.kind, self.parameters, effort.ravel(), speed.ravel(), power)
        return power.reshape(effort.shape)

    def line_power_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the power taken from the line [W], negative where energy goes back; shape as the arguments'."""
        return line_power(self.electrical_power_w(effort_n, speed_ms), self.recuperation_factor)

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> dict[str, FloatArray]:
        """Return the losses by kind [W]: those of the drive, and what the brake resistors dissipate."""
        power = self.electrical_power_w(effort_n, speed_ms)
        return {
            # what the terminals take beyond the work at the wheels; in braking both are negative
            self.loss_kind: power - np.multiply(effort_n, speed_ms),
            "brake_resistors": resistor_power(power, self.recuperation_factor),
        }

    def current_a(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray | None:
        """Return the current of one motor [A], or None if the model knows no current; shape as the arguments'."""
        # such a model takes the flux as constant, so that torque and current are in proportion
        return None if self.amperes_per_newton is None else self.amperes_per_newton * np.asarray(effort_n)

    def effort_limit_n(self, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the largest effort that the drive itself allows [N]; infinite where it sets no limit."""
        return np.full(np.shape(speed_ms), np.inf)

    def weakening_limit_n(self, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the part of that limit that varies with speed [N], without the constant part that caps it."""
        return self.effort_limit_n(speed_ms, braking)

    def limit_corners_ms(self, braking: bool = False) -> FloatArray:
        """Return the speeds at which the slope of that part jumps [m/s], as far as they are known; shape (k,)."""
        return np.zeros(0)

    def require_speed(self, speed_ms: float) -> None:
        """Raise ScenarioError if the model knows nothing of a speed [m/s]; most know all speeds."""

    def effort_at_current_n(self, current_a: float, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the largest effort [N] of motors that carry at most a current [A]; shape as the speeds'.

        Infinite where the model knows no current.
        """
        # the current of such a model does not depend on speed
        effort = np.inf if self.amperes_per_newton is None else current_a / self.amperes_per_newton
        return np.full(np.shape(speed_ms), effort)
