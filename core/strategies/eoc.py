"""Ftorek's energy optimal control: a boundary value problem of Pontryagin's principle, solved by collocation.

Source: Ftorek et al. 2025, (7)-(10), in the coordinates of the train and with the tractive effort F in the place of
the costate of speed, p = -2 h m F:

    s' = v,   m v' = F - (A + B v + C v^2),   2 h m F' = A + 2 B v + 3 C v^2 + 2 h F (B + 2 C v) + price,

h the copper loss per effort squared and `price` the constant costate of distance. The third equation is the costate's,
p' = -dH/dv, of the Hamiltonian H = h F^2 + R(v) v + q v + p v' with R = A + B v + C v^2: H is least over F where
2 h F = -p / m, and the derivative of R v by speed gives A + 2 B v + 3 C v^2. The term 3 C v^2 stands for the
work of drag in the cost. The printed results come out only without it: that is the variant `as_printed`.
"""

from typing import Literal

import numpy as np
import scipy

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.errors import SolverError, StrategyRefusedError
from railjoule.core.motion import running_time
from railjoule.core.physics.resistance import resistance_slope
from railjoule.core.strategies.plain_line import PlainLine, SampledRun, check_feasible, plain_line
from railjoule.core.strategy import Strategy, register
from railjoule.core.task import Task
from railjoule.core.trajectory import Trajectory, make_trajectory

Variant = Literal["optimal", "as_printed"]
# Relative residual of the collocation: energies are right to 1e-12, with some 2000 nodes; 1e-6 gives 3e-10 with 400
TOLERANCE = 1e-8
# Nodes of the first guess, and where the solver gives up: 20 times what runs of 200 to 1200 s on Ftorek's line need
FIRST_NODES, MAX_NODES = 101, 50_000
# Samples of the solution, on which Simpson's rule gives energies to 2e-12; 401 samples to 2e-8
SAMPLES = 4001
# A scaling of the speeds between moving ends leaves the share of the time in the first and the last cell of its error
SCALINGS = 3
# Beyond, the mesh does not resolve the run: 5 m leave 1e-5 of runs between stops
MAX_SCALED = 0.01
# Share of the mean speed below which a speed is rest: rounding of the solution leaves 1e-9 of it
SAME_SPEED = 1e-6


def solve_eoc(line: PlainLine, travel_time_s: float, variant: Variant = "optimal") -> SampledRun:
    """Return the energy optimal control of a plain line.

    Parameters
    ----------
    line : PlainLine
        Length, inertia, resistance, copper loss and speeds at the ends.
    travel_time_s : float
        Time of the run [s].
    variant : str
        `optimal` with the whole cost, `as_printed` without the work of drag.

    Raises
    ------
    SolverError
        If the boundary value solver does not converge.
    StrategyRefusedError
        If the optimum rolls back: the travel time is too long for moving ends.
    """
    m, h, b, c = line.inertia_kg, line.loss_coefficient, line.linear, line.quadratic
    # in units of distance, travel time and mean speed all unknowns are about 1, as the solver's tolerance wants them
    mean = line.distance_m / travel_time_s
    unit = m * mean / travel_time_s
    first, last = line.initial_speed_ms / mean, line.final_speed_ms / mean
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
        return np.array([start[0], start[1] - first, end[0] - 1, end[1] - last])

    grid = np.linspace(0, 1, FIRST_NODES)
    # the parabola of speed, which is the solution without resistance
    parabola = scipy.interpolate.CubicHermiteSpline([0, 1], [0, 1], [first, last])
    guess = np.vstack([parabola(grid, order) for order in range(3)])
    solution = scipy.integrate.solve_bvp(
        derivatives, end_conditions, grid, guess, p=[0.0], tol=TOLERANCE, max_nodes=MAX_NODES
    )
    if not solution.success:
        raise SolverError(f"the boundary value problem of EOC was not solved: {solution.message}")
    fine = np.linspace(0, 1, SAMPLES)
    y = solution.sol(fine)
    time, speed, effort = fine * travel_time_s, mean * y[1], unit * y[2]
    if np.min(speed) < -SAME_SPEED * mean:
        raise StrategyRefusedError(
            f"needs less time: within {travel_time_s:.1f} s its optimum between these speeds of the ends rolls back."
        )
    resistance = line.resistance_n(speed)
    shaft = resistance * speed
    kinetic = 0.5 * m * (speed**2 - speed[0] ** 2)
    losses = scipy.integrate.cumulative_simpson(h * effort**2 + shaft, x=time, initial=0)
    return SampledRun(
        time_s=frozen_array(time),
        position_m=frozen_array(line.distance_m * y[0]),
        speed_ms=frozen_array(speed),
        acceleration_ms2=frozen_array((effort - resistance) / m),
        effort_n=frozen_array(effort),
        energy_j=frozen_array(losses + kinetic),
        shaft_energy_j=float(scipy.integrate.cumulative_simpson(shaft, x=time)[-1]),
    )


def speed2_at(solution: SampledRun, line: PlainLine, position_m: FloatArray) -> FloatArray:
    """Return the squares of speed [m2/s2] at places [m], by cubics that meet value and derivative at each sample.

    The derivative of v^2 over distance is 2 dv/dt, finite even at rest, where that of speed is not.
    """
    v = solution.speed_ms
    place = solution.position_m
    # two samples at rest may share a place
    rising = np.append(True, np.diff(np.maximum.accumulate(place)) > 0)
    curve = scipy.interpolate.CubicHermiteSpline(place[rising], v[rising] ** 2, 2 * solution.acceleration_ms2[rising])
    speed2: FloatArray = np.maximum(curve(np.clip(position_m, 0, place[rising][-1])), 0.0)
    speed2[[0, -1]] = line.initial_speed_ms**2, line.final_speed_ms**2
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
    speed2 = speed2_at(solution, line, task.mesh.position_m)
    # between the nodes of the mesh the run is a polygon of speed squared: keep its time, not its samples
    for _ in range(SCALINGS):
        factor = running_time(task.mesh.data.cell_length_m, speed2) / task.running_time_s
        if abs(factor - 1) > MAX_SCALED:
            raise StrategyRefusedError("needs less time, or a shorter solver.mesh_m, as it all but stands on its way.")
        speed2[1:-1] *= factor**2
    check_feasible(task.mesh, speed2)
    notes = line.notes
    if variant == "as_printed":
        notes = ("EOC as printed: the work of drag is left out of its cost.", *notes)
    return make_trajectory(task.scenario, task.mesh, "eoc", speed2, notes=notes)


register(
    Strategy(
        name="eoc",
        run=eoc,
        order=30,
        label="EOC",
        colour=("#A62B0E", "#F26B2C"),
        dash=(8, 3),
        help=(
            "Energy-optimal control of the Ftorek paper: the effort that the optimality conditions prescribe, a "
            "boundary value problem. It changes smoothly over the run. For level lines without limits."
        ),
        applies_to="copper loss; no limits of the line, no stops, no neutral sections",
        source="ftorek-2025",
        is_light=True,
    )
)
