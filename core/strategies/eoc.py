"""Ftorek's energy optimal control: a boundary value problem of Pontryagin's principle, solved by collocation.

Source: Ftorek et al. 2025, (7)-(10), in the coordinates of the train and with the tractive effort F in the place of
the costate of speed, p = -2 h m F:

    s' = v,   m v' = F - (A + B v + C v^2),   2 h m F' = A + 2 B v + 3 C v^2 + 2 h F (B + 2 C v) + price,

h the copper loss per effort squared and `price` the constant costate of distance. The third equation is the costate's,
p' = -dH/dv, of the Hamiltonian H = h F^2 + R(v) v + q v + p v' with R = A + B v + C v^2: H is least over F where
2 h F = -p / m, and the derivative of R v by speed gives A + 2 B v + 3 C v^2. The term 3 C v^2 stands for the
work of drag in the cost. The printed results come out only without it: that is the variant `as_printed`.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.errors import SolverError
from railjoule.core.motion import running_time
from railjoule.core.physics.resistance import resistance_slope
from railjoule.core.strategies.plain_line import PlainLine, check_feasible, plain_line
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory

Variant = Literal["optimal", "as_printed"]
# Relative residual of the collocation: energies are right to 1e-12, with some 2000 nodes; 1e-6 gives 3e-10 with 400
TOLERANCE = 1e-8
# Nodes of the first guess, and where the solver gives up: 20 times what runs of 200 to 1200 s on Ftorek's line need
FIRST_NODES, MOST_NODES = 101, 50_000
# Samples of the solution, on which Simpson's rule gives energies to 2e-12; 401 samples to 2e-8
SAMPLES = 4001


@dataclass(frozen=True, eq=False)
class EocSolution:
    """The solution of the boundary value problem over time, arrays of shape (m,).

    Parameters
    ----------
    time_s, position_m, speed_ms, effort_n : array
        Samples of the run.
    energy_j : array
        Energy taken so far, copper loss and work at the shaft [J].
    shaft_energy_j : float
        Work at the shaft over the whole run [J].
    """

    time_s: FloatArray
    position_m: FloatArray
    speed_ms: FloatArray
    effort_n: FloatArray
    energy_j: FloatArray
    shaft_energy_j: float

    @property
    def total_energy_j(self) -> float:
        """Energy of the whole run, all braking energy returned [J]."""
        return float(self.energy_j[-1])

    @property
    def peak_energy_j(self) -> float:
        """Most energy taken at any time [J]."""
        return float(np.max(self.energy_j))


def solve_eoc(line: PlainLine, travel_time_s: float, variant: Variant = "optimal") -> EocSolution:
    """Return the energy optimal control of a plain line.

    Parameters
    ----------
    line : PlainLine
        Length, inertia, resistance and copper loss.
    travel_time_s : float
        Time of the run [s].
    variant : str
        `optimal` with the whole cost, `as_printed` without the work of drag.

    Raises
    ------
    SolverError
        If the boundary value solver does not converge.
    """
    m, h, b, c = line.inertia_kg, line.loss_coefficient, line.linear, line.quadratic
    # in units of distance, travel time and mean speed all unknowns are about 1, as the solver's tolerance wants them
    mean = line.distance_m / travel_time_s
    unit = m * mean / travel_time_s
    drag_work = 3 * c if variant == "optimal" else 0.0
    price_unit = 2 * h * m * unit / travel_time_s + (b + c * mean) * mean

    def derivatives(_: FloatArray, y: FloatArray, price: FloatArray) -> FloatArray:
        v, f = mean * y[1], unit * y[2]
        acceleration = (f - line.resistance_n(v)) / m
        # A + price, of which the one may vanish, is one unknown
        costate = (2 * b + drag_work * v) * v + 2 * h * f * resistance_slope(b, c, v) + price_unit * price[0]
        effort_rate = costate / (2 * h * m)
        return np.vstack([y[1], acceleration * travel_time_s / mean, effort_rate * travel_time_s / unit])

    def end_conditions(start: FloatArray, end: FloatArray, _: FloatArray) -> FloatArray:
        return np.array([start[0], start[1], end[0] - 1, end[1]])

    grid = np.linspace(0, 1, FIRST_NODES)
    # the parabola of speed, which is the solution without resistance
    guess = np.vstack([grid**2 * (3 - 2 * grid), 6 * grid * (1 - grid), 6 - 12 * grid])
    solution = scipy.integrate.solve_bvp(
        derivatives, end_conditions, grid, guess, p=[0.0], tol=TOLERANCE, max_nodes=MOST_NODES
    )
    if not solution.success:
        raise SolverError(f"the boundary value problem of EOC was not solved: {solution.message}")
    fine = np.linspace(0, 1, SAMPLES)
    y = solution.sol(fine)
    time, speed, effort = fine * travel_time_s, mean * y[1], unit * y[2]
    shaft = line.resistance_n(speed) * speed
    kinetic = 0.5 * m * (speed**2 - speed[0] ** 2)
    losses = scipy.integrate.cumulative_simpson(h * effort**2 + shaft, x=time, initial=0)
    return EocSolution(
        time_s=frozen_array(time),
        position_m=frozen_array(line.distance_m * y[0]),
        speed_ms=frozen_array(speed),
        effort_n=frozen_array(effort),
        energy_j=frozen_array(losses + kinetic),
        shaft_energy_j=float(scipy.integrate.cumulative_simpson(shaft, x=time)[-1]),
    )


def speed2_at(solution: EocSolution, line: PlainLine, position_m: FloatArray) -> FloatArray:
    """Return the squares of speed [m2/s2] at places [m], by cubics that meet value and derivative at each sample.

    The derivative of v^2 over distance is 2 dv/dt, finite even at rest, where that of speed is not.
    """
    v = solution.speed_ms
    acceleration = (solution.effort_n - line.resistance_n(v)) / line.inertia_kg
    place = solution.position_m
    # two samples at rest may share a place
    rising = np.append(True, np.diff(np.maximum.accumulate(place)) > 0)
    curve = scipy.interpolate.CubicHermiteSpline(place[rising], v[rising] ** 2, 2 * acceleration[rising])
    speed2: FloatArray = np.maximum(curve(np.clip(position_m, 0, place[rising][-1])), 0.0)
    speed2[[0, -1]] = 0.0
    return speed2


def eoc(task: Task) -> Trajectory:
    """Return the energy optimal control, in the variant that the scenario names.

    Raises
    ------
    TimetableError
        If the timetable cannot be kept.
    StrategyRefusedError
        If the line has stops or limits, the drive no copper loss, or the run needs more than the vehicle has.
    SolverError
        If the boundary value solver does not converge.
    """
    task.require_timetable()
    line = plain_line(task)
    variant = task.scenario.eoc.variant
    solution = solve_eoc(line, task.running_time_s, variant)
    speed2 = speed2_at(solution, line, task.course.position_m)
    time = running_time(task.course.data.cell_length_m, speed2)
    # between the nodes of the mesh the run is a polygon of speed squared: keep its time, not its samples
    speed2 *= (time / task.running_time_s) ** 2
    check_feasible(task.course, speed2)
    notes = line.notes
    if variant == "as_printed":
        notes = ("EOC as printed: the work of drag is left out of its cost.", *notes)
    return make_trajectory(task.scenario, task.course, "eoc", speed2, notes=notes)
