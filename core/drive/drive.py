"""A drive: the supply power for an effort at a speed, and the losses."""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.drive.kinds import CAPABILITIES
from railjoule.core.drive.line_power import line_power, resistor_power


@dataclass(frozen=True, eq=False)
class Drive:
    """The loss model of a vehicle's drive, for arrays of effort and speed.

    Efforts act at the wheels of the whole train; a negative effort is electric braking.

    Parameters
    ----------
    kind : int
        Number of `railjoule.core.drive.kinds`.
    parameters : array
        Parameters of the kernels of this kind.
    recuperation_factor : float
        Share of the generated energy that is recuperated.
    loss_kind : str
        Name of its losses in the energy balance.
    amperes_per_newton : float or None
        Current of one motor over tractive effort of the train [A/N], if the model has a current: such a model has a
        constant flux, so that torque and current are proportional.
    """

    kind: int
    parameters: FloatArray
    recuperation_factor: float
    loss_kind: str
    amperes_per_newton: float | None = None

    def __post_init__(self) -> None:
        if not 0 <= self.kind < len(CAPABILITIES):
            raise ValueError(f"drive kind {self.kind} has no row in railjoule.core.drive.kinds.CAPABILITIES.")

    @property
    def has_idle_losses(self) -> bool:
        """Whether it has idle losses: it takes power without effort while it is on, and none while it is off."""
        return CAPABILITIES[self.kind].has_idle_losses

    def electrical_power_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the power at the terminals of the drive [W], negative where it generates; shape as the arguments'."""
        # the registry imports the files of all drives, which import this one
        from railjoule.core.drive.kernels import electrical_power_array  # noqa: PLC0415

        effort, speed = np.broadcast_arrays(np.asarray(effort_n, float), np.asarray(speed_ms, float))
        power = np.empty(effort.size)
        electrical_power_array(self.kind, self.parameters, effort.ravel(), speed.ravel(), power)
        return power.reshape(effort.shape)

    def supply_power_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the supply power [W], negative where energy is recuperated; shape as the arguments'."""
        return line_power(self.electrical_power_w(effort_n, speed_ms), self.recuperation_factor)

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> dict[str, FloatArray]:
        """Return the losses by kind [W]: those of the drive, and those of the brake resistors."""
        power = self.electrical_power_w(effort_n, speed_ms)
        return {
            # in braking both power and work are negative
            self.loss_kind: power - np.multiply(effort_n, speed_ms),
            "brake_resistors": resistor_power(power, self.recuperation_factor),
        }

    def current_a(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray | None:
        """Return the current of one motor [A], or None if the model has no current; shape as the arguments'."""
        return None if self.amperes_per_newton is None else self.amperes_per_newton * np.asarray(effort_n)

    def effort_limit_n(self, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the largest effort that the drive itself allows [N]; infinite where it sets no limit."""
        return np.full(np.shape(speed_ms), np.inf)

    def weakening_limit_n(self, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the part of that limit that varies with speed [N], without the constant part that caps it."""
        return self.effort_limit_n(speed_ms, braking)

    def limit_corners_ms(self, braking: bool = False) -> FloatArray:
        """Return the known speeds at which the slope of that part jumps [m/s]; shape (k,)."""
        return np.zeros(0)

    def require_speed(self, speed_ms: float) -> None:
        """Raise DriveRangeError if the model has no values at a speed [m/s]; most models have no such limit."""

    def effort_at_current_n(self, current_a: float, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the largest effort [N] of motors that carry at most a current [A]; shape as the speeds'.

        Infinite where the model has no current.
        """
        effort = np.inf if self.amperes_per_newton is None else current_a / self.amperes_per_newton
        return np.full(np.shape(speed_ms), effort)
