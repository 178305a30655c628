"""The drive of a train whose motors lose what a map says, for arrays of effort and speed."""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.drive.geared import NEGLIGIBLE_SHARE, GearedDrive
from railjoule.core.drive.geared_parameters import TURNS
from railjoule.core.drive.kinds import LOSS_MAP
from railjoule.core.drive.loss_map.loss import DRIVING_TABLE
from railjoule.core.drive.loss_map.table import loss_table
from railjoule.core.errors import DriveRangeError
from railjoule.core.units import MS_PER_KMH, N_PER_KN, distinct_numbers

ROUNDING = 1e-9
# runs use the largest effort to the last digit, and tabulated limits miss it by up to 1e-6
ALLOWED_EXCESS = 1e-6


@dataclass(frozen=True, eq=False)
class LossMap:
    """Losses of one motor with its inverter while it is on.

    Parameters
    ----------
    torque_nm : array of shape (n,)
        Rising from 0 [N m].
    speed_rads : array of shape (m,)
        Rising from 0 [rad/s].
    loss_w : array of shape (n, m)
        The losses [W].
    """

    torque_nm: FloatArray
    speed_rads: FloatArray
    loss_w: FloatArray


@dataclass(frozen=True, eq=False)
class MapDrive(GearedDrive):
    """A drive that knows its losses within a map, and refuses to guess beyond it.

    Parameters
    ----------
    greatest_speed_ms : float
        Speed of the train at the end of the map [m/s].
    driving_n, braking_n : array of shape (m,)
        Largest efforts of the train at the speeds of `limit_speed_ms` [N].
    limit_speed_ms : array of shape (m,)
        Speeds of the train [m/s].
    """

    greatest_speed_ms: float
    limit_speed_ms: FloatArray
    driving_n: FloatArray
    braking_n: FloatArray

    def electrical_power_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the power at the terminals of the drive [W]; shape as the arguments'.

        Raises
        ------
        DriveRangeError
            If an effort or a speed lies beyond the map.
        """
        self.require_speed(float(np.max(speed_ms, initial=0.0)))
        for sign, limit, action in ((1, self.driving_n, "drive"), (-1, self.braking_n, "brake")):
            most, largest = float(np.max(sign * np.asarray(effort_n), initial=0.0)), float(limit.max())
            if most > largest * (1 + ALLOWED_EXCESS):
                end, asked = distinct_numbers(largest / N_PER_KN, most / N_PER_KN)
                raise DriveRangeError(f"the map of the drive ends at {end} kN to {action} with, below {asked} kN.")
        return super().electrical_power_w(effort_n, speed_ms)

    def effort_limit_n(self, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the largest effort [N] for which the map holds losses; shape as the argument's."""
        limit = self.braking_n if braking else self.driving_n
        return np.interp(speed_ms, self.limit_speed_ms, limit)

    def weakening_limit_n(self, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
        """Return the part of that limit that varies with speed [N]; infinite where none does."""
        limit = self.braking_n if braking else self.driving_n
        return np.full(np.shape(speed_ms), np.inf) if np.ptp(limit) == 0 else self.effort_limit_n(speed_ms, braking)

    def limit_corners_ms(self, braking: bool = False) -> FloatArray:
        """Return the speeds at which the limit is given [m/s]: between them it is straight."""
        return self.limit_speed_ms

    def require_speed(self, speed_ms: float) -> None:
        """Raise DriveRangeError if the map ends below a speed [m/s]."""
        if speed_ms > self.greatest_speed_ms * (1 + ROUNDING):
            turns = self.parameters[TURNS]
            raise DriveRangeError(
                f"the map of the drive ends at {self.greatest_speed_ms * turns:.4g} rad/s of the motor, below the "
                f"{speed_ms * turns:.4g} rad/s of {speed_ms / MS_PER_KMH:.4g} km/h."
            )


def make_map_drive(
    driving: LossMap,
    braking: LossMap,
    motors: int,
    turns_per_metre: float,
    gear_loss_share: float,
    recuperation_factor: float,
    envelopes_nm: tuple[FloatArray, FloatArray] | None = None,
) -> MapDrive:
    """Return the drive of motors that lose what two maps say.

    Parameters
    ----------
    driving, braking : LossMap
        Over the size of the torque, with the same last speed.
    motors : int
    turns_per_metre : float
        Angle of the motor over the distance of the train [1/m].
    gear_loss_share : float
        Lost in the gears, over the power at the wheels.
    recuperation_factor : float
        Share of the generated energy that the line takes back.
    envelopes_nm : tuple of arrays of shape (m,), optional
        Largest torques in driving and braking at the speeds of `driving` [N m]; the maps' last ones where absent.
    """
    # both tables stand in one row of numbers behind the head, which says where that of braking begins
    tables = [loss_table(part.torque_nm, part.speed_rads, part.loss_w) for part in (driving, braking)]
    wheel = motors * turns_per_metre
    if envelopes_nm is None:
        # a rectangle: its limit is the same at both ends of the speeds
        speeds = driving.speed_rads[[0, -1]]
        envelopes_nm = np.full(2, driving.torque_nm[-1]), np.full(2, braking.torque_nm[-1])
    else:
        speeds = driving.speed_rads
    # gears take their share between motor and wheel: of what a motor gives, and from what the wheels give it
    pulling, slowing = wheel * envelopes_nm[0] / (1 + gear_loss_share), wheel * envelopes_nm[1] / (1 - gear_loss_share)
    head = np.zeros(DRIVING_TABLE)
    head[:] = motors, turns_per_metre, gear_loss_share, NEGLIGIBLE_SHARE * pulling.max(), DRIVING_TABLE + len(tables[0])
    return MapDrive(
        kind=LOSS_MAP,
        parameters=frozen_array(np.concatenate([head, *tables])),
        recuperation_factor=recuperation_factor,
        loss_kind="motors_and_inverters",
        amperes_per_newton=None,
        gear_loss_share=gear_loss_share,
        greatest_speed_ms=float(driving.speed_rads[-1] / turns_per_metre),
        limit_speed_ms=frozen_array(speeds / turns_per_metre),
        driving_n=frozen_array(pulling),
        braking_n=frozen_array(slowing),
    )
