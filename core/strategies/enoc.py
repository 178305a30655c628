"""Ftorek's energy near-optimal control: a symmetrical trapezoid of speed, its energy in closed form.

Source: Ftorek et al. 2025, (11)-(15), in the coordinates of the train instead of those of the motor. Two printed
terms are misprints and corrected here: k2 = h A^2 + B, which must be h B^2 + B, and in (13) -(2/3) ks Tm^2 and
-7 k1, which must be -(8/3) ks Tm^2 and -7 k1 Tm.
"""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import StrategyRefusedError
from railjoule.core.motion import build_course
from railjoule.core.motion.mesh import with_nodes_at
from railjoule.core.strategies.plain_line import PlainLine, check_feasible, plain_line
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory
from railjoule.core.units import MS_PER_KMH

# The imaginary part of a real root, over the travel time: numpy's eigenvalues of a companion matrix are good to 1e-12
NO_IMAGINARY_PART = 1e-9


@dataclass(frozen=True)
class EnocCoefficients:
    """The constants of (12): h the copper loss per effort squared, resistance A + B v + C v^2, mass m, distance S."""

    k1: float
    k3: float
    k5: float
    k6: float
    ka: float
    ks: float
    constant_n: float
    distance_m: float


def enoc_coefficients(line: PlainLine) -> EnocCoefficients:
    """Return the constants of (12) for a plain line."""
    # Power is h F^2 + R v + m a v with F = R + m a and R = A + B v + C v^2, here sorted by powers of v. Terms with a
    # alone cancel between both ramps; h (m a)^2 over 2 T_e with a = P / T_e is 2 h m^2 P^2 / T_e, P the peak speed.
    h, m = line.loss_coefficient, line.inertia_kg
    a, b, c = line.constant_n, line.linear, line.quadratic
    return EnocCoefficients(
        k1=2 * h * m**2,
        k3=h * c**2,
        k5=2 * h * b * c + c,
        k6=2 * h * a * b,
        ka=h * a**2,
        ks=h * b**2 + b + 2 * h * a * c,
        constant_n=a,
        distance_m=line.distance_m,
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
    # a ramp to P has the integral P^n T_e / (n + 1) of v^n, so the trapezoid P^n (T_m - 2 n / (n + 1) T_e)
    peak = k.distance_m / (time - ramp)
    by_square = k.k1 / ramp + k.ks * (time - 4 / 3 * ramp)
    by_fourth = k.k3 * (time - 8 / 5 * ramp) * peak
    by_cube = k.k5 * (time - 3 / 2 * ramp)
    varying: FloatArray = peak * peak * (by_square + peak * (by_cube + by_fourth))
    return varying + (k.ka * time + (k.k6 + k.constant_n) * k.distance_m)


def best_acceleration_time(coefficients: EnocCoefficients, travel_time_s: float) -> float:
    """Return the acceleration time of least energy [s] for a travel time [s]: a root of the corrected (13).

    With E(Te) = P^2 (k1 / Te + ks (T - 4/3 Te) + ...) and the peak speed P = S / (T - Te), dE/dTe times
    Te^2 (T - Te)^5 / S^2 is a polynomial of the fifth degree in Te, whose coefficients are collected below.

    Where the triangle without a cruise is best, that is half of the travel time.
    """
    k, t, s = coefficients, travel_time_s, coefficients.distance_m
    quintic = [
        -4 / 3 * k.ks,
        10 / 3 * k.ks * t + 3 * k.k5 * s,
        3 * k.k1 - 8 / 3 * k.ks * t**2 - 9 / 2 * k.k5 * s * t - 24 / 5 * k.k3 * s**2,
        -7 * k.k1 * t + 2 / 3 * k.ks * t**3 + 3 / 2 * k.k5 * s * t**2 + 12 / 5 * k.k3 * s**2 * t,
        5 * k.k1 * t**2,
        -k.k1 * t**3,
    ]
    roots = np.roots(quintic)
    # a real root comes out with an imaginary part of its rounding
    real = roots[np.abs(roots.imag) < NO_IMAGINARY_PART * t].real
    # beyond half of the travel time the ramps would overlap; there the triangle is the border
    candidates = np.append(real[(real > 0) & (real < t / 2)], t / 2)
    return float(candidates[np.argmin(enoc_energy(k, t, candidates))])


def acceleration_time_for_peak(coefficients: EnocCoefficients, travel_time_s: float, peak_speed_ms: float) -> float:
    """Return the acceleration time [s] that gives a peak speed [m/s], (15)."""
    return travel_time_s - coefficients.distance_m / peak_speed_ms


def enoc_surface(
    coefficients: EnocCoefficients, travel_times_s: FloatArray, acceleration_times_s: FloatArray
) -> FloatArray:
    """Return the energy [J] over travel time and acceleration time, shape (acceleration times, travel times).

    NaN where the ramps do not fit into the travel time.
    """
    times, ramps = np.asarray(travel_times_s)[None, :], np.asarray(acceleration_times_s)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        energy = enoc_energy(coefficients, times, ramps)
    energy[2 * ramps > times] = np.nan
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
    peak = line.distance_m / (time - ramp)
    corner = 0.5 * peak * ramp
    nodes = with_nodes_at(task.course.position_m, [corner, line.distance_m - corner])
    course = build_course(task.scenario, position_m=nodes)
    # at constant acceleration the square of speed is linear over distance, so that corners at nodes make the run exact
    speed2 = np.minimum(2 * peak / ramp * np.minimum(nodes, line.distance_m - nodes), peak**2)
    check_feasible(course, speed2)
    note = f"ENOC accelerates and brakes for {ramp:.1f} s each, cruising at {peak / MS_PER_KMH:.1f} km/h between."
    return make_trajectory(task.scenario, course, "enoc", speed2, notes=(note, *line.notes))
