"""Synchronous reluctance machines with magnets: what they and their inverters lose, and the most they can do.

In the frame of the magnets, amplitudes per phase, w the electrical speed, y = psi - (Lq - Ld) id:

    torque   T = 3/2 p iq y          ud = R id - w Lq iq          uq = R iq + w (psi + Ld id)

The current along the magnets is that of least current, id y^3 + (Lq - Ld) (2 T / 3 p)^2 = 0; where that asks for more
voltage than there is, it is increased against the magnets until the voltage is just full, a root of the quartic
(R id y - w Lq c)^2 + (R c + w (psi + Ld id) y)^2 = Um^2 y^2, c = 2 T / (3 p). Losses of a motor with its inverter:

    copper      3/2 R(w) i^2, R by Dowell's formula for layers of conductors in a slot
    iron        (Ph w / wN + Pe (w / wN)^2) (psi_s / psi_N)^2
    mechanical  Tm w_shaft + k w_shaft^3
    harmonics   3/2 R(w_h) (U_h / (w_h Lh))^2 of each harmonic; of six steps the orders 6 k -+ 1 with U / order, of
                space vectors the side bands of a double Fourier series; Lh averages 1 / L^2 of both inductances
    inverter    3 (V0 2 i / pi + r i^2 / 2) and 3 f E (2 i / pi) U_dc / (i_E U_E), f the fundamental in six steps

The product tabulates these losses over 36 torques and 41 speeds, so its line power agrees with these as well as its
table does: to a hundred-thousandth of the losses in the median, to a tenth where six steps take over from space vectors
and the losses jump. The greatest torque is that along id of the current's circle or the voltage's ellipse.

Sources: Morimoto, Sanada, Takeda, IEEE Transactions on Industry Applications 30, 1994; Dowell, Proceedings of the IEE
113, 1966; Holmes, Lipo: Pulse width modulation for power converters, 2003, chapters 3 and 6.
"""

import math
from functools import lru_cache

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.check.loss_model import EDGE, GearedModel, Losses, product, real_roots
from railjoule.core.scenario.drive import Synchronous
from railjoule.core.units import H_PER_MH, M_PER_MM

# It is this large for the jump of the losses where six steps take over within one cell of the table; in the median the
# table is good to 1e-5. A bound by kind of cell would need the product's own table, which the check must not know.
TABLE_ACCURACY = 0.12
"""The largest difference between table and formulas that 40 random machines had in 640,000 points was 0.102."""
# 1.68e-8 ohm m at 20 degrees, 0.39 % more for each further one; a number of the model and not of a machine, in the
# product as well
COPPER_OHM_M, VACUUM_H_PER_M = 2.2e-8, 4e-7 * math.pi
"""Resistivity of the windings at 100 degrees Celsius, and permeability."""
CARRIERS, BANDS, STEPS = 4, 16, 8
"""Multiples of the carrier, side bands on either side of each, and pairs of harmonics of six steps that count."""
# The integral over an angle of a periodic function converges faster than any power of the step, so 240 angles are
# exact to rounding but for the kinks of the middle phase; depths are interpolated linearly, to second order.
DEPTHS, ANGLES = 193, 240
# each zoom leaves four of 48 intervals: six of them end at 3e-7 of the largest current
ZOOMS, POINTS = 6, 49


class SynchronousModel(GearedModel, model="synchronous"):
    """The motors of a train with their inverters and gears; torques of a shaft [N m] and its speeds [rad/s]."""

    parameters: Synchronous
    accuracy = TABLE_ACCURACY

    def __init__(self, parameters: Synchronous) -> None:
        super().__init__(parameters)
        self.direct_h = parameters.direct_inductance_mh * H_PER_MH
        self.quadrature_h = parameters.quadrature_inductance_mh * H_PER_MH
        self.saliency_h = self.quadrature_h - self.direct_h
        self.harmonic_h = math.sqrt(2 / (self.direct_h**-2 + self.quadrature_h**-2))
        self.space_vector_voltage_v = parameters.link_voltage_v / math.sqrt(3)
        six_steps = parameters.modulation == "six_step"
        self.max_voltage_v = parameters.link_voltage_v * 2 / math.pi if six_steps else self.space_vector_voltage_v

    def losses_w(self, effort_n: FloatArray, speed_ms: FloatArray) -> Losses:
        """Return the losses by kind [W]; NaN beyond current or voltage."""
        p, speed = self.parameters, self.turns_per_metre * speed_ms
        rads = p.pole_pairs * speed
        drag = self._drag(speed)
        along, across = self._currents(self.shaft_torque_nm(effort_n) + drag, rads)
        current = np.hypot(along, across)
        flux_d, flux_q = p.magnet_flux_vs + self.direct_h * along, self.quadrature_h * across
        resistance = p.stator_resistance_ohm
        voltage = np.hypot(resistance * along - rads * flux_q, resistance * across + rads * flux_d)
        share = rads / (2 * math.pi * p.rated_frequency_hz)
        iron = p.hysteresis_loss_w * share + p.eddy_loss_w * share**2
        # beyond the inscribed circle of the hexagon no space vector reaches, and the inverter goes over to blocks
        blocks = voltage > self.space_vector_voltage_v
        # the mean of a rectified sine: conduction at a threshold and switching losses go with it
        mean = 2 / math.pi * current
        conduction = 3 * (p.device_threshold_v * mean + 0.5 * p.device_resistance_ohm * current**2)
        frequency = np.where(blocks, rads / (2 * math.pi), p.switching_frequency_hz)
        energy = p.switching_energy_j * mean / p.switching_current_a * p.link_voltage_v / p.switching_voltage_v
        harmonics = np.where(blocks, self._six_step_loss_w(rads, voltage), self._space_vector_loss_w(rads, voltage))
        of_one = {
            "copper": 1.5 * self._resistance(rads) * current**2,
            "iron": iron * (flux_d**2 + flux_q**2) / p.rated_flux_vs**2,
            "mechanical": drag * speed,
            "harmonics": harmonics if p.harmonic_losses else 0.0 * current,
            "inverter": conduction + 3 * frequency * energy,
        }
        of_all = {kind: p.motors * loss_w for kind, loss_w in of_one.items()}
        return {**of_all, "gear": self.gear_loss_w(effort_n, speed_ms)}

    def _drag(self, speed: FloatArray) -> FloatArray:
        """Return the torque that friction and ventilation take [N m]."""
        p = self.parameters
        return p.mechanical_loss_torque_nm + p.ventilation_loss_w_per_rads3 * speed**2

    def max_torque_nm(self, speed_rads: FloatArray, braking: bool) -> FloatArray:
        """Return the greatest torque of the shaft within current and voltage, without sign [N m]."""
        p, rads, sign = self.parameters, self.parameters.pole_pairs * speed_rads[:, None], -1.0 if braking else 1.0

        def torque(along: FloatArray) -> FloatArray:
            by_current = np.sqrt(np.maximum(p.max_current_a**2 - along**2, 0.0))
            # |u|^2 = a iq^2 + 2 b iq + c
            flux = p.magnet_flux_vs + self.direct_h * along
            a = p.stator_resistance_ohm**2 + (rads * self.quadrature_h) ** 2
            b = sign * p.stator_resistance_ohm * rads * (flux - self.quadrature_h * along)
            c = (p.stator_resistance_ohm * along) ** 2 + (rads * flux) ** 2 - self.max_voltage_v**2
            with np.errstate(invalid="ignore"):
                by_voltage = (-b + np.sqrt(b * b - a * c)) / a
            across = np.where(np.isnan(by_voltage), -np.inf, np.minimum(by_current, by_voltage))
            return 1.5 * p.pole_pairs * across * (p.magnet_flux_vs - self.saliency_h * along)

        middle, width = np.full((len(speed_rads), 1), -0.5 * p.max_current_a), p.max_current_a
        for _ in range(ZOOMS):
            along = np.clip(middle + width * np.linspace(-0.5, 0.5, POINTS), -p.max_current_a, 0.0)
            found = torque(along)
            best = np.argmax(found, axis=1)[:, None]
            middle, width = np.take_along_axis(along, best, axis=1), width * 4 / (POINTS - 1)
        return np.asarray(np.maximum(found.max(axis=1) - sign * self._drag(speed_rads), 0.0))

    def _currents(self, torque: FloatArray, rads: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the currents along and across the magnets [A]; NaN where current or voltage do not allow them."""
        p, one = self.parameters, np.ones(len(torque))
        c = torque / (1.5 * p.pole_pairs)
        resistance, most = p.stator_resistance_ohm, p.max_current_a
        y = np.column_stack([p.magnet_flux_vs * one, -self.saliency_h * one])
        along = np.column_stack([0 * one, one])
        flux = np.column_stack([p.magnet_flux_vs * one, self.direct_h * one])
        constant = np.column_stack([one, 0 * one, 0 * one])
        least = product(along, product(y, product(y, y))) + self.saliency_h * c[:, None] ** 2 * np.eye(5)[0]
        roots = real_roots(least)
        first = np.nanmax(np.where(roots <= 0, roots, -most), axis=1)
        # without torque the root is 0 itself, which rounding may put on the wrong side of 0
        first = np.where(c == 0, 0.0, first)
        direct = resistance * product(along, y) - (rads * self.quadrature_h * c)[:, None] * constant
        quadrature = rads[:, None] * product(flux, y) + (resistance * c)[:, None] * constant
        square = product(direct, direct) + product(quadrature, quadrature)
        square[:, :3] -= self.max_voltage_v**2 * product(y, y)
        at_first = sum(square[:, power] * first**power for power in range(5))
        with np.errstate(all="ignore"):
            ends = real_roots(square)
        full = np.where((ends < first[:, None]) & (ends >= -most), ends, -np.inf).max(axis=1)
        chosen = np.where(at_first > 0, full, first)
        with np.errstate(invalid="ignore"):
            across = c / (p.magnet_flux_vs - self.saliency_h * chosen)
            feasible = np.isfinite(chosen) & (np.hypot(chosen, across) <= most * (1 + EDGE))
        return np.where(feasible, chosen, np.nan), np.where(feasible, across, np.nan)

    def _resistance(self, rads: FloatArray) -> FloatArray:
        """Return the resistance of a phase at angular frequencies, by Dowell's formula [ohm]."""
        p = self.parameters
        depth = np.sqrt(2 * COPPER_OHM_M / (np.maximum(rads, 1e-6) * VACUUM_H_PER_M))
        x = np.clip(p.conductor_height_mm * M_PER_MM / depth, 1e-2, 50.0)
        skin = x * (np.sinh(2 * x) + np.sin(2 * x)) / (np.cosh(2 * x) - np.cos(2 * x))
        proximity = 2 * x * (np.sinh(x) - np.sin(x)) / (np.cosh(x) + np.cos(x))
        return np.asarray(p.stator_resistance_ohm * (skin + (p.conductor_layers**2 - 1) / 3 * proximity))

    def _six_step_loss_w(self, rads: FloatArray, voltage: FloatArray) -> FloatArray:
        orders = np.array([6 * k + side for k in range(1, STEPS + 1) for side in (-1, 1)])
        frequency = np.maximum(rads, 1e-6)[:, None] * orders
        current = voltage[:, None] / orders / (frequency * self.harmonic_h)
        return np.asarray(np.sum(1.5 * self._resistance(frequency) * current**2, axis=1))

    def _space_vector_loss_w(self, rads: FloatArray, voltage: FloatArray) -> FloatArray:
        half = 0.5 * self.parameters.link_voltage_v
        depth, table = side_bands()
        at = np.clip(np.nan_to_num(voltage) / half, 0.0, depth[-1]) / depth[1]
        low = np.minimum(at.astype(int), len(depth) - 2)
        share = (at - low)[:, None, None]
        amplitude = half * ((1 - share) * table[low] + share * table[low + 1])
        carrier = 2 * math.pi * self.parameters.switching_frequency_hz * np.arange(1, CARRIERS + 1)[:, None]
        frequency = np.abs(carrier + np.arange(-BANDS, BANDS + 1) * rads[:, None, None])
        # what is slower than the fundamental is no harmonic
        counts = frequency > rads[:, None, None]
        current = np.where(counts, amplitude / (np.where(counts, frequency, 1.0) * self.harmonic_h), 0.0)
        return np.asarray(np.sum(1.5 * self._resistance(frequency) * current**2, axis=(1, 2)))


@lru_cache(maxsize=1)
def side_bands() -> tuple[FloatArray, FloatArray]:
    """Return depths of modulation, and the amplitudes of the side bands of space vectors over half the link voltage.

    A leg that is asked for u gives pulses of the width pi (1 + u) of its carrier, whose n-th harmonic has the amplitude
    4 sin(n pi (1 + u) / 2) / (n pi); u is the phase less the middle of the largest and the smallest of the three.

    Returns
    -------
    depth : array of shape (DEPTHS,)
        Amplitude of the phase over half the link voltage, from 0 to 2 / sqrt(3).
    amplitude : array of shape (DEPTHS, CARRIERS, 2 BANDS + 1)
        At n carriers and k fundamentals; 0 where k is a multiple of three, for such are alike in all phases.
    """
    depth = np.linspace(0.0, 2 / math.sqrt(3), DEPTHS)
    angle = 2 * math.pi * np.arange(ANGLES) / ANGLES
    phases = [depth[:, None] * np.cos(angle - 2 * math.pi * phase / 3) for phase in range(3)]
    leg = phases[0] - 0.5 * (np.max(phases, axis=0) + np.min(phases, axis=0))
    n, k = np.arange(1, CARRIERS + 1), np.arange(-BANDS, BANDS + 1)
    pulses = 4 * np.sin(n[:, None] * math.pi * (1 + leg[:, None, :]) / 2) / (n[:, None] * math.pi)
    amplitude = np.abs(pulses @ np.exp(-1j * np.outer(angle, k))) / ANGLES
    return depth, np.where(k % 3 == 0, 0.0, amplitude)
