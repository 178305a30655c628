"""Ftorek's energy near-optimal control: a trapezoid of speed with two ramps of equal time, its energy in closed form.

Source: Ftorek et al. 2025, (11)-(15), in the coordinates of the train instead of those of the motor. Two printed
terms are misprints and corrected here: k2 = h A^2 + B, which must be h B^2 + B, and in (13) -(2/3) ks Tm^2 and
-7 k1, which must be -(8/3) ks Tm^2 and -7 k1 Tm.

Moving ends, which (10) has and the paper's (12) has not: with w the mean of both end speeds and u = v - w, the ramps
begin at -d and end at d, d half of the difference of the end speeds, and the cruise has u = (S - w T) / (T - Te). So
(12) holds for u with S - w T in the place of S and the resistance as a polynomial of u; the integral of u^n over both
ramps has a further 2/3 d^2 Te for n = 2, 1/2 d^2 u Te for n = 3 and 2/5 d^2 (u^2 + d^2) Te for n = 4.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import Value
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.motion import build_meshed_line
from railjoule.core.motion.mesh import with_nodes_at
from railjoule.core.strategies.plain_line import PlainLine, check_feasible, plain_line
from railjoule.core.strategy import Strategy, register
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory
from railjoule.core.units import MS_PER_KMH

# The imaginary part of a real root, over the root: numpy's eigenvalues of a companion matrix are good to 1e-12
NO_IMAGINARY_PART = 1e-9


@dataclass(frozen=True)
class EnocCoefficients:
    """The constants of (12), of speeds relative to the mean of the end speeds.

    h is the copper loss per effort squared, A + B u + C u^2 the resistance over relative speed u, m the mass.
    """

    k1: float
    k3: float
    k5: float
    k6_and_constant: float
    ka: float
    ks: float
    distance_m: float
    mean_end_ms: float
    """w: mean of both end speeds [m/s]."""
    half_difference_ms: float
    """d: half of the difference of the end speeds [m/s]."""
    kinetic_j: float
    """Change of kinetic energy and the part of the copper loss that grows with effort times acceleration [J]."""

    def relative_distance_m(self, travel_time_s: Value) -> Value:
        """Compute the distance beyond that at the mean of the end speeds, S - w T [m]."""
        distance: Value = self.distance_m - self.mean_end_ms * travel_time_s
        return distance

    def cruise_speed_ms(self, travel_time_s: Value, acceleration_time_s: Value) -> Value:
        """Compute the speed between both ramps [m/s]."""
        speed: Value = self.mean_end_ms + self.relative_distance_m(travel_time_s) / (
            travel_time_s - acceleration_time_s
        )
        return speed

    def longest_acceleration_s(self, travel_time_s: float) -> float:
        """Compute the longest ramp that neither overlaps the other nor needs a cruise that rolls back [s]."""
        # the cruise speed is 0 where both ramps cover the distance
        covered_s = self.distance_m / self.mean_end_ms if self.mean_end_ms else np.inf
        return min(travel_time_s / 2, covered_s)


def enoc_coefficients(line: PlainLine) -> EnocCoefficients:
    """Return the constants of (12) for a plain line."""
    # Power is h F^2 + R v + m a v with F = R + m a, here sorted by powers of u = v - w. h (m a)^2 over both ramps is
    # 2 h m^2 (u^2 + d^2) / T_e. 2 h R m a is 2 h m times the integral of R over speed, the same on every way.
    h, m = line.loss_coefficient, line.inertia_kg
    w, d = (line.final_speed_ms + line.initial_speed_ms) / 2, (line.final_speed_ms - line.initial_speed_ms) / 2
    a, b, c = float(line.resistance_n(np.array(w))), line.linear + 2 * line.quadratic * w, line.quadratic
    return EnocCoefficients(
        k1=2 * h * m**2,
        k3=h * c**2,
        k5=2 * h * b * c + c,
        k6_and_constant=2 * h * a * b + a + b * w,
        ka=h * a**2 + a * w,
        ks=h * b**2 + b + 2 * h * a * c + c * w,
        distance_m=line.distance_m,
        mean_end_ms=w,
        half_difference_ms=d,
        kinetic_j=2 * m * d * (2 * h * (a + c * d**2 / 3) + w),
    )


def enoc_energy(
    coefficients: EnocCoefficients, travel_time_s: FloatArray | float, acceleration_time_s: FloatArray | float
) -> FloatArray:
    """Return the energy of a trapezoidal run [J], (12); the arguments broadcast.

    Parameters
    ----------
    coefficients : EnocCoefficients
        Constants of vehicle and line.
    travel_time_s : array or float
        T_m [s].
    acceleration_time_s : array or float
        T_e, length of each ramp [s], above 0 and at most half of T_m.
    """
    k = coefficients
    time, ramp = np.asarray(travel_time_s, float), np.asarray(acceleration_time_s, float)
    distance, d2 = k.relative_distance_m(time), k.half_difference_ms**2
    # a ramp to P has the integral P^n T_e / (n + 1) of v^n, so the trapezoid P^n (T_m - 2 n / (n + 1) T_e)
    peak = distance / (time - ramp)
    by_square = k.k1 / ramp + k.ks * (time - 4 / 3 * ramp)
    by_fourth = k.k3 * (time - 8 / 5 * ramp) * peak
    by_cube = k.k5 * (time - 3 / 2 * ramp)
    varying: FloatArray = peak * peak * (by_square + peak * (by_cube + by_fourth))
    between = k.k1 / ramp + (2 / 3 * k.ks + k.k5 * peak / 2 + 2 / 5 * k.k3 * (peak**2 + d2)) * ramp
    energy: FloatArray = varying + (k.ka * time + k.k6_and_constant * distance) + d2 * between + k.kinetic_j
    return energy


def best_acceleration_time(coefficients: EnocCoefficients, travel_time_s: float) -> float:
    """Return the acceleration time of least energy [s] for a travel time [s]: a root of the corrected (13).

    With E(Te) = P^2 (k1 / Te + ks (T - 4/3 Te) + ...) and the peak speed P = S / (T - Te), dE/dTe times
    Te^2 (T - Te)^5 / S^2 is a polynomial of the fifth degree in Te, whose coefficients are collected below. Moving ends
    add the derivative of d^2 (k1 / Te + 2/3 ks Te + ...), of the seventh degree.

    It is half of the travel time if the triangle without a cruise is best.
    """
    k, t, d2 = coefficients, travel_time_s, coefficients.half_difference_ms**2
    s = k.relative_distance_m(t)
    slope = Polynomial(
        [
            -k.k1 * t**3,
            5 * k.k1 * t**2,
            -7 * k.k1 * t + 2 / 3 * k.ks * t**3 + 3 / 2 * k.k5 * s * t**2 + 12 / 5 * k.k3 * s**2 * t,
            3 * k.k1 - 8 / 3 * k.ks * t**2 - 9 / 2 * k.k5 * s * t - 24 / 5 * k.k3 * s**2,
            10 / 3 * k.ks * t + 3 * k.k5 * s,
            -4 / 3 * k.ks,
        ]
    )
    if d2 > 0:
        ramp, rest = Polynomial([0, 1]), Polynomial([t, -1])
        between = (2 / 3 * k.ks + 2 / 5 * k.k3 * d2) * ramp**2 - k.k1
        by_peak = 0.5 * k.k5 * s * t * rest + 2 / 5 * k.k3 * s**2 * (ramp + t)
        slope = s**2 * slope + d2 * rest**2 * (rest**3 * between + ramp**2 * by_peak)
    # the inverses of the roots, by the coefficients in reverse: the constant one is never small beside the others
    inverse = np.roots(slope.coef)
    # a real root comes out with an imaginary part of its rounding
    real = inverse.real[np.abs(inverse.imag) < NO_IMAGINARY_PART * np.abs(inverse)]
    # beyond half of the travel time the ramps would overlap; there the triangle is the border
    longest = k.longest_acceleration_s(t)
    candidates = np.append(1 / real[real > 1 / longest], longest)
    return float(candidates[np.argmin(enoc_energy(k, t, candidates))])


def acceleration_time_for_peak(coefficients: EnocCoefficients, travel_time_s: float, peak_speed_ms: float) -> float:
    """Return the acceleration time [s] that gives a cruising speed [m/s], (15)."""
    return travel_time_s - coefficients.relative_distance_m(travel_time_s) / (peak_speed_ms - coefficients.mean_end_ms)


def enoc_surface(
    coefficients: EnocCoefficients, travel_times_s: FloatArray, acceleration_times_s: FloatArray
) -> FloatArray:
    """Return the energy [J] over travel time and acceleration time, shape (acceleration times, travel times).

    NaN where the ramps do not fit into the travel time, or the cruise would roll back.
    """
    times, ramps = np.asarray(travel_times_s)[None, :], np.asarray(acceleration_times_s)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        energy = enoc_energy(coefficients, times, ramps)
        energy[(2 * ramps > times) | (coefficients.cruise_speed_ms(times, ramps) < 0)] = np.nan
    return energy


def enoc(task: Task) -> Trajectory:
    """Return the trapezoidal run, with the best acceleration time unless the scenario gives one.

    Raises
    ------
    TimetableError
        If the timetable cannot be kept.
    StrategyRefusedError
        If the line has stops or limits, the drive no copper loss, or the run needs more than the vehicle has.
    """
    task.require_timetable()
    line = plain_line(task)
    coefficients = enoc_coefficients(line)
    time = task.running_time_s
    ramp = task.scenario.enoc.acceleration_time_s or best_acceleration_time(coefficients, time)
    if 2 * ramp > time * (1 + 1e-12):
        raise StrategyRefusedError(f"needs an acceleration time of at most {time / 2:.1f} s, half of the travel time.")
    first, last = line.initial_speed_ms, line.final_speed_ms
    peak = float(coefficients.cruise_speed_ms(time, ramp))
    if peak <= 0:
        raise StrategyRefusedError(
            f"needs less time: within {time:.1f} s its ramps between these speeds of the ends cover the whole line."
        )
    corners = (0.5 * (first + peak) * ramp, line.distance_m - 0.5 * (peak + last) * ramp)
    nodes = with_nodes_at(task.mesh.position_m, corners)
    mesh = build_meshed_line(task.scenario, *task.end_speeds_ms, nodes)
    # at constant acceleration the square of speed is linear over distance, so that corners at nodes make the run exact
    speed2 = np.interp(nodes, (0.0, *corners, line.distance_m), np.square((first, peak, peak, last)))
    check_feasible(mesh, speed2)
    ramps = "accelerates and brakes" if peak >= max(first, last) else "changes its speed at both ends"
    note = f"ENOC {ramps} for {ramp:.1f} s each, cruising at {peak / MS_PER_KMH:.1f} km/h between."
    return make_trajectory(task.scenario, mesh, "enoc", speed2, notes=(note, *line.notes))


register(
    Strategy(
        name="enoc",
        run=enoc,
        order=40,
        label="ENOC",
        colour=("#C27C00", "#F5C542"),
        dash=(8, 3, 2, 3),
        help=(
            "Energy near-optimal control of the same paper: accelerate evenly, cruise, brake evenly, with ramps "
            "of equal length. Its energy is a closed formula. For level lines without limits."
        ),
        applies_to="copper loss; no limits of the line, no stops, no neutral sections",
        source="ftorek-2025",
        labels=("ENOC energy",),
    )
)
