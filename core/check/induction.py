"""Induction machines: what they lose with the flux of least loss, and the most that current, voltage and flux allow.

In the frame of the rotor flux, amplitudes per phase, sigma = 1 - M^2 / (Ls Lr), g = Rr / Lr, w the rotor's electrical
speed, flux current Ix > 0 and torque current Iy:

    slip    wr = g Iy / Ix          w1 = w + wr          torque  T = kT Ix Iy,  kT = 3/2 p M^2 / Lr
    Ux = Rs Ix - w1 sigma Ls Iy     Uy = Rs Iy + w1 Ls Ix
    copper  3/2 Rs (Ix^2 + Iy^2) + T wr / p
    iron    (Ph |w1| / wN + Pe (w1 / wN)^2) (Ix / Imu)^2

With q = |Iy| / Ix and kappa = Ix |Iy| = |T| / kT, Ix^2 = kappa / q and |U|^2 = kappa D(q) / q, D a quartic. So at a
torque the rated flux asks for q >= kappa / Imu^2, the voltage for kappa D(q) <= Um^2 q, and the losses are
kappa (a / q + b q + c), convex in 1 / q wherever the field turns: the least are at the free minimum, where the field
stands still, or at an end of what is allowed, which roots of quartics tell. The greatest torque is the greatest of
q min(Imu^2, I^2 / (1 + q^2), Um^2 / D(q)), where one of the three has its maximum or two of them meet.
The motor's friction Tm and the gear's efficiency stand between T and the wheel: driving
F = n x (T - Tm) eta, braking F = n x (T - Tm) / eta, T < 0.

Source: Rawicki, "New software for energy saving control of a tram vehicle", (1)-(43).
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.check.loss_model import EDGE, GearedModel, Losses, product, real_roots, values
from railjoule.core.scenario.drive import Induction
from railjoule.core.units import H_PER_MH

# Efforts along the rounded corners of the product's limits exceed the exact pull-out by this share,
# `efforts.ROUNDED_CORNERS`. Without it such a cell would have no losses to compare with.
OVERLOAD = 2e-3
"""A torque so little beyond the greatest takes the power that it has at the ratio of the pull-out."""


class InductionModel(GearedModel, model="induction"):
    """The machines of a train, each with the flux of least loss, and their gears.

    Torques [N m] of one machine are negative where it generates, speeds those of its shaft [rad/s].
    """

    parameters: Induction

    def __init__(self, parameters: Induction) -> None:
        super().__init__(parameters)
        rotor, mutual = parameters.rotor_inductance_mh * H_PER_MH, parameters.mutual_inductance_mh * H_PER_MH
        rated = 2 * math.pi * parameters.rated_frequency_hz
        self.pole_pairs = parameters.pole_pairs
        self.stator_ohm = parameters.stator_resistance_ohm
        self.stator_h = parameters.stator_inductance_mh * H_PER_MH
        self.leakage_h = self.stator_h - mutual**2 / rotor
        self.slip_rate = parameters.rotor_resistance_ohm / rotor
        self.torque_constant = 1.5 * parameters.pole_pairs * mutual**2 / rotor
        self.flux2 = parameters.rated_magnetising_current_a**2
        self.voltage2 = parameters.max_phase_voltage_v**2
        self.hysteresis = parameters.hysteresis_loss_w / rated / self.flux2
        self.eddy = parameters.eddy_loss_w / rated**2 / self.flux2

    def shaft_over_wheel(self) -> tuple[float, float]:
        """Return 1 / eta for driving, in which the motor also gives the gear's loss, and eta for braking."""
        return 1 / self.parameters.gear_efficiency, self.parameters.gear_efficiency

    def torque_nm(self, effort_n: FloatArray) -> FloatArray:
        """Return the electromagnetic torque of each machine for an effort [N m]."""
        return self.parameters.mechanical_loss_torque_nm + self.shaft_torque_nm(effort_n)

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> Losses:
        """Return the losses by kind [W]; NaN where no flux carries the torque within the voltage.

        A standstill brake brakes wherever the machines would need supply power for it.
        """
        drive, work = self.parameters, effort_n * speed_ms
        torque, speed = self.torque_nm(effort_n), self.turns_per_metre * speed_ms
        copper, iron, _ = self._min_losses(torque, speed)
        losses = {
            "copper": drive.motors * copper,
            "iron": drive.motors * iron,
            "mechanical": drive.motors * drive.mechanical_loss_torque_nm * speed,
            "gear": self.gear_loss_w(effort_n, speed_ms),
            "standstill_brake": np.zeros(len(work)),
        }
        if not drive.standstill_brake:
            return losses
        # decided for the whole train, by the power at the terminals: above 0, braking would cost power
        draws = (effort_n < 0) & (work + sum(losses.values()) > 0)
        losses = {kind: np.where(draws, 0.0, watts) for kind, watts in losses.items()}
        return losses | {"standstill_brake": np.where(draws, -work, 0.0)}

    def max_torque_nm(self, speed_rads: FloatArray, braking: bool) -> FloatArray:
        """Return the greatest torque of a shaft within current, voltage and rated flux [N m]."""
        drive = self.parameters
        current = drive.braking_current_a if braking else drive.starting_current_a
        torque = self._max_torque(speed_rads, current, braking)
        # friction of the motor helps to brake and hinders in driving, in which it may leave nothing for the wheel
        sign = -1.0 if braking else 1.0
        return np.maximum(torque - sign * drive.mechanical_loss_torque_nm, 0.0)

    def current_a(self, effort_n: FloatArray, speed_ms: FloatArray) -> FloatArray:
        """Return the current of a machine that is on, negative where it generates [A]."""
        losses = self.losses_w(effort_n, speed_ms)
        torque = self.torque_nm(effort_n)
        current = self._min_losses(torque, self.turns_per_metre * speed_ms)[2]
        return np.where(losses["standstill_brake"] > 0, 0.0, np.copysign(current, torque))

    def _min_losses(self, torque: FloatArray, speed: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return copper and iron loss [W] and the current [A] with the flux of least loss; NaN where there is none."""
        sign, strength = np.where(torque < 0, -1.0, 1.0), np.abs(torque) / self.torque_constant
        rotor = self.pole_pairs * speed
        ratios = self._candidates(sign, strength, rotor)
        flux = np.sqrt(strength[:, None] / ratios)
        copper, iron = self._losses(sign[:, None], ratios, flux, rotor[:, None])
        total = np.where(np.isfinite(ratios), copper + iron, np.inf)
        least = np.argmin(total, axis=1)
        rows = np.arange(len(torque))
        none = ~np.isfinite(total[rows, least])
        found = copper, iron, np.hypot(flux, ratios * flux)
        copper_w, iron_w, current = (np.where(none, np.nan, these[rows, least]) for these in found)
        return copper_w, iron_w, current

    def _max_torque(self, speed: FloatArray, current_a: float, braking: bool) -> FloatArray:
        """Return the greatest torque without sign [N m] that a current, the voltage and the rated flux allow."""
        quartic = self._quartic(np.full(len(speed), -1.0 if braking else 1.0), self.pole_pairs * speed)
        flux_meets_voltage = self.flux2 * quartic - self.voltage2 * np.eye(5)[0]
        circle = self.voltage2 * (np.eye(5)[0] + np.eye(5)[2])
        current_meets_voltage = current_a**2 * quartic - circle
        corner = math.sqrt(max(current_a**2 / self.flux2 - 1, 0.0))
        ratios = np.column_stack(
            [
                *(_positive(each) for each in (_pull_out(quartic), flux_meets_voltage, current_meets_voltage)),
                np.full(len(speed), corner),
                np.ones(len(speed)),
            ]
        )
        by_current = current_a**2 / (1 + ratios**2)
        by_voltage = self.voltage2 / values(quartic, ratios)
        strength = ratios * np.minimum(np.minimum(self.flux2, by_current), by_voltage)
        return np.asarray(self.torque_constant * np.nanmax(strength, axis=1))

    def _candidates(self, sign: FloatArray, strength: FloatArray, rotor: FloatArray) -> FloatArray:
        """Return ratios of the currents among which the one of least loss is; NaN where not allowed; (k, 9)."""
        quartic = self._quartic(sign, rotor)
        rated = strength / self.flux2
        # a and b of the losses kappa (a / q + b q + c), a for a field that turns forwards and for one backwards
        rising = [1.5 * self.stator_ohm + (side * self.hysteresis + self.eddy * rotor) * rotor for side in (1.0, -1.0)]
        rotor_copper = self.torque_constant * self.slip_rate / self.pole_pairs
        falling = 1.5 * self.stator_ohm + rotor_copper + self.eddy * self.slip_rate**2
        with np.errstate(invalid="ignore"):
            free = [np.sqrt(weight / falling) for weight in rising]
        inside = np.column_stack([*free, rotor / self.slip_rate, rated])
        # at its ends the voltage is full
        full_voltage = strength[:, None] * quartic - self.voltage2 * np.eye(5)[1]
        last = np.fmin.reduce(_positive(_pull_out(quartic)), axis=1)
        ratios = np.column_stack([inside, _positive(full_voltage), last])
        slack = np.array([EDGE] * inside.shape[1] + [np.inf] * 4 + [OVERLOAD])
        with np.errstate(invalid="ignore"):
            voltage2 = strength[:, None] * values(quartic, ratios) / ratios
            allowed = (ratios > 0) & (ratios >= rated[:, None] * (1 - EDGE)) & (voltage2 <= self.voltage2 * (1 + slack))
        return np.where(allowed, ratios, np.nan)

    def _losses(
        self, sign: FloatArray, ratio: FloatArray, flux: FloatArray, rotor: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return copper and iron loss [W] at ratios of the currents and flux currents [A]."""
        across = sign * ratio * flux
        slip = sign * self.slip_rate * ratio
        field = rotor + slip
        torque = self.torque_constant * flux * across
        copper = 1.5 * self.stator_ohm * (flux**2 + across**2) + torque * slip / self.pole_pairs
        return copper, (self.hysteresis * np.abs(field) + self.eddy * field**2) * flux**2

    def _quartic(self, sign: FloatArray, rotor: FloatArray) -> FloatArray:
        """Return the coefficients of D(q) [ohm2], constant first; shape (k, 5).

        |Ux + j Uy|^2 / Ix^2 with w1 = w + s g q: two polynomials in q, squared and added.
        """
        none = np.zeros(len(rotor))
        slip = sign * self.slip_rate
        along = np.column_stack([np.full(len(rotor), self.stator_ohm), -rotor * sign * self.leakage_h,
                                 -slip * sign * self.leakage_h])  # fmt: skip
        across = np.column_stack([rotor * self.stator_h, self.stator_ohm * sign + slip * self.stator_h, none])
        return product(along, along) + product(across, across)


def _pull_out(quartic: FloatArray) -> FloatArray:
    """Return D - q D', whose least root is the ratio of the greatest torque under the voltage; shape (k, 5)."""
    return quartic * (1 - np.arange(5.0))


def _positive(polynomial: FloatArray) -> FloatArray:
    """Return the positive roots of polynomials, NaN in the place of others."""
    roots = real_roots(polynomial)
    return np.where(roots > 0, roots, np.nan)
