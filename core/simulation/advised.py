"""A driver who only follows the advice: open loop, without observing the run or the clock.

The driver is familiar with train and line, so he can hold a speed, change it steadily, and set the brake for a speed at
a position. All numbers are those of the instructions, as printed; the run itself is unknown to him.

- Full power: all the power that the train has, until the speed is reached, which the driver then keeps until the next
  instruction; coasting begins immediately. Uphill, where the train gets slower, until the next instruction.
- Part power: a steady change of speed squared to the speed at the place.
- Hold: the speed, by power or brakes; what differs from it fades within metres. By turns: the power named up to the
  upper speed, then coasting down to the lower one.
- Coast: neither power nor brakes; to a stop that coasting leads to, the last seconds are driven as part power is. He
  lets no train come to a stand elsewhere: slower than creeping he holds his speed.
- Brake: a steady change of speed squared, as with part power. Fully: nearly all that the brakes have, one fraction of
  it set once where it begins, so that the speed is reached at the place.
- Stand: for the time of the instruction.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from railjoule.core.advice import Instruction
from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.errors import InfeasibleLineError
from railjoule.core.motion import build_meshed_line
from railjoule.core.motion.cell_step import COAST, FULL_BRAKE, FULL_TRACTION, exit_speed2
from railjoule.core.motion.mesh import finer_at_stops, line_borders, with_nodes_at
from railjoule.core.phases.labels import SHORTEST_S
from railjoule.core.physics.cell import Cell
from railjoule.core.physics.mesh_data import MeshData, cell_at, limits_at, part_of_cell, shared_by_cells
from railjoule.core.scenario import Scenario
from railjoule.core.trajectory import Trajectory, make_trajectory
from railjoule.core.units import MS_PER_KMH

# A driver reacts within a metre or so; towards a stop cells are halved four times, to 6 cm, as a train that
# brakes at 0.5 m/s2 still has 1 m/s a metre before it stands.
CELL_M, HALVINGS_AT_STOPS = 1.0, 4
ADJUSTED_WITHIN_M = 20.0
"""Over this length a difference from a speed to hold falls to 1/e; assumed."""
CREEPING_MS = 3.0 * MS_PER_KMH
"""Slower than this a driver does not wait whether coasting brings him to a stand; assumed."""
# Halvings of an interval of 1: the last digits of the braking fraction.
BISECTIONS = 50
# Pieces of cells below this are rounding, and driving them would never end.
SHORTEST_M = 1e-9
# A train that passes a stop with less stands there for its passengers.
STANDING_MS = 1e-3


def drive_advice(
    scenario: Scenario, advice: Sequence[Instruction], strategy: str = "advised", initial_speed_ms: float | None = None
) -> Trajectory:
    """Return the run of a driver who follows the advice.

    Parameters
    ----------
    scenario : Scenario
        The train and its line; its timetable does not bind the run.
    advice : sequence of Instruction
        The advice, in order.
    strategy : str
        Whose advice it is.
    initial_speed_ms : float, optional
        Speed at the start [m/s]; that of the timetable where absent.

    Raises
    ------
    InfeasibleLineError
        If the train comes to a stand before a stop, or runs past one.
    """
    mesh = build_meshed_line(scenario, position_m=_mesh(scenario, advice))
    moving = [instruction for instruction in advice if instruction.action != "stand"]
    entry_ms = scenario.timetable.end_speeds_ms[0] if initial_speed_ms is None else initial_speed_ms
    place, speed2 = _drive_cells(mesh.data, mesh.position_m, moving, entry_ms**2)
    driven = build_meshed_line(scenario, position_m=place)
    dwell = np.zeros(len(place))
    for stop in (instruction for instruction in advice if instruction.to_kmh == 0 or instruction.stand_s is not None):
        node = int(np.argmin(np.abs(place - (stop.from_m if stop.at_m is None else stop.at_m))))
        if speed2[node] > STANDING_MS**2:
            speed_kmh = np.sqrt(speed2[node]) / MS_PER_KMH
            raise InfeasibleLineError(f"The train passes the stop at {place[node]:.0f} m with {speed_kmh:.1f} km/h.")
        speed2[node] = 0.0
        dwell[node] += stop.stand_s or 0.0
    return make_trajectory(scenario, replace(driven, dwell_s=dwell), strategy, speed2)


def _mesh(scenario: Scenario, advice: Sequence[Instruction]) -> FloatArray:
    """Return nodes [m] at distances of a metre, at all places of line and advice, and closer at the stops."""
    line = scenario.line.in_running_order()
    stops = [0.0, *(station.position_m for station in line.inner_stations), line.length_m]
    named = [place for order in advice for place in (order.from_m, order.at_m) if place is not None]
    fixed = np.unique([*line_borders(line, scenario.limits_last_m), *named, *stops])
    nodes = np.append(np.arange(0.0, line.length_m, CELL_M), line.length_m)
    nodes = with_nodes_at(nodes, fixed[(fixed > 0) & (fixed < line.length_m)])
    return finer_at_stops(nodes, stops, HALVINGS_AT_STOPS)


def _drive_cells(
    mesh: MeshData, position_m: FloatArray, orders: Sequence[Instruction], speed2: float
) -> tuple[FloatArray, FloatArray]:
    """Return nodes and places between them at which power is switched [m], and squares of speed there [m2/s2].

    Parameters
    ----------
    mesh : MeshData
        Train and line.
    position_m : array of shape (n + 1,)
        Nodes of the meshed line [m], all places of the orders among them.
    orders : sequence of Instruction
        The advice to a moving train.
    speed2 : float
        Square of speed at the first node [m2/s2].
    """
    # coasting after full power begins when the speed is reached, wherever that is: the printed position is rounded
    follows = [False, *(order.action == "full_power" and order.to_kmh is not None for order in orders[:-1])]
    begins = [
        math.inf if order.action == "coast" and after_power else order.from_m
        for order, after_power in zip(orders, follows, strict=True)
    ]
    places, squares, nodes = [position_m[0]], [speed2], position_m.tolist()
    k, switched, braking = 0, False, -1.0
    for i in range(len(nodes) - 1):
        cell, x, end_m = cell_at(mesh, i), nodes[i], nodes[i + 1]
        left = end_m - x
        while left > SHORTEST_M:
            reached = max((n for n in range(k, len(orders)) if begins[n] <= x + SHORTEST_M), default=k)
            if reached != k:
                k, switched = reached, orders[reached].action == "hold" and speed2 >= _swing2(orders[reached])[1]
            if orders[k].fully and x == begins[k]:
                last = int(np.searchsorted(position_m, _at_m(orders[k]) - SHORTEST_M))
                braking = _braking_fraction(mesh, i, last, speed2, _aim2(orders[k]))
            part_left = part_of_cell(cell, left)
            reach = _reach(mesh, i, part_left, speed2)
            after, part, switched = _driven(orders[k], reach, left, (x, speed2), switched, braking)
            # the speed is reached within the cell: coasting takes over in the rest of it
            if switched and orders[k].action == "full_power" and begins[k + 1 : k + 2] == [math.inf]:
                k, switched = k + 1, False
            if part * left <= SHORTEST_M:
                continue
            speed2, x, left = max(after, 0.0), x + part * left, left - part * left
            places.append(x if left > SHORTEST_M else end_m)
            squares.append(speed2)
            if speed2 <= 0.0 and (left > SHORTEST_M or orders[k].to_kmh != 0 or places[-1] != orders[k].at_m):
                raise InfeasibleLineError(f"At {places[-1]:.0f} m the train comes to a stand before its stop.")
    return np.array(places), np.array(squares)


def _aim2(order: Instruction) -> float:
    """Return the square of the speed that an order leads to [m2/s2]; NaN where it leads to none."""
    return math.nan if order.to_kmh is None else (order.to_kmh * MS_PER_KMH) ** 2


def _at_m(order: Instruction) -> float:
    """Return the place at which an order reaches its speed [m]; NaN where it names none."""
    return math.nan if order.at_m is None else order.at_m


def _swing2(order: Instruction) -> tuple[float, float]:
    """Return the squares of the speeds between which a hold swings [m2/s2]; NaN for a steady one."""
    low, high = order.between_kmh or (math.nan, math.nan)
    return (low * MS_PER_KMH) ** 2, (high * MS_PER_KMH) ** 2


def _driven(
    order: Instruction,
    reach: tuple[float, float, float],
    length_m: float,
    state: tuple[float, float],
    switched: bool,
    braking: float,
) -> tuple[float, float, bool]:
    """Return the speed at the end of a cell, or of its part until power is switched.

    Parameters
    ----------
    order : Instruction
    reach : tuple of three floats
        Squares of speed that full braking, coasting and full power lead to [m2/s2].
    length_m : float
        Of the cell [m].
    state : tuple of two floats
        Place [m] and square of speed [m2/s2] at its begin.
    switched, braking : bool and float
        As returned below, of the cell before; and fraction of full braking, negative for none.

    Returns
    -------
    speed2 : float
        Square of speed [m2/s2].
    part : float
        Which part of the cell is driven.
    switched : bool
        Whether the speed of full power is reached; by turns, whether power is off; coasting, whether it was faster
        than creeping.
    """
    low, free, top = reach
    place, speed2 = state
    action, aim2, ahead_m = order.action, _aim2(order), _at_m(order) - place
    if action == "coast":
        # coasting to a stop: its last seconds, or too slow; every comparison with NaN is false
        is_creeping = switched and speed2 <= CREEPING_MS**2 and order.at_m is not None
        if not (is_creeping or 2.0 * ahead_m <= SHORTEST_S * math.sqrt(speed2)):
            rolling = min(speed2, CREEPING_MS**2, top) if switched else 0.0
            return max(free, rolling), 1.0, switched or free > CREEPING_MS**2
    if action == "full_power" and not switched:
        # every comparison with NaN is false
        if not top >= aim2:
            return top, 1.0, False
        return max(speed2, aim2), _part_until(speed2, top, aim2), True
    if action == "hold" and order.power_share:
        request = free if switched else free + order.power_share * (top - free)
        limit2 = _swing2(order)[0 if switched else 1]
        if (request > limit2) if switched else (request < limit2):
            return request, 1.0, switched
        return limit2, _part_until(speed2, request, limit2), not switched
    if order.fully and braking >= 0.0 and ahead_m > SHORTEST_M:
        return free + braking * (low - free), 1.0, False
    if action == "hold":
        request = aim2 + (speed2 - aim2) * math.exp(-length_m / ADJUSTED_WITHIN_M)
    elif action == "full_power":
        request = aim2
    else:
        # constant acceleration is v^2 linear over distance; the rest of the meshed line shrinks with each cell
        request = speed2 + (aim2 - speed2) * min(length_m / max(ahead_m, SHORTEST_M), 1.0)
    return min(max(request, low), top), 1.0, switched


def _part_until(entering2: float, leaving2: float, wanted2: float) -> float:
    """Return in which part of a cell the square of speed, which changes linearly, comes to a wanted one."""
    if leaving2 == entering2:
        return 0.0
    return min(max((wanted2 - entering2) / (leaving2 - entering2), 0.0), 1.0)


@njit(cache=True, error_model="numpy", nogil=True)
def _reach(mesh: MeshData, number: int, cell: Cell, speed2: float) -> tuple[float, float, float]:
    """Return the squares of speed to which full braking, coasting and full power lead in a part of a numbered cell."""
    train, traction, braking, _ = limits_at(shared_by_cells(mesh), number)
    return (
        exit_speed2(cell, train, traction, braking, speed2, FULL_BRAKE),
        exit_speed2(cell, train, traction, braking, speed2, COAST),
        exit_speed2(cell, train, traction, braking, speed2, FULL_TRACTION),
    )


@njit(cache=True, error_model="numpy", nogil=True)
def _braking_fraction(mesh: MeshData, first: int, last: int, speed2: float, aim2: float) -> float:
    """Return which fraction of full braking leads to a speed after cells; negative where none is needed."""
    if _braked(mesh, first, last, speed2, 0.0) <= aim2:
        return -1.0
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if _braked(mesh, first, last, speed2, middle) > aim2:
            low = middle
        else:
            high = middle
    # the weaker side: too much braking would end in a stand before the place
    return low


@njit(cache=True, error_model="numpy", nogil=True)
def _braked(mesh: MeshData, first: int, last: int, speed2: float, fraction: float) -> float:
    """Return the square of speed after cells under part of full braking; negative where it stands before."""
    for i in range(first, last):
        low, free, _ = _reach(mesh, i, cell_at(mesh, i), speed2)
        speed2 = free + fraction * (low - free)
        if speed2 <= 0.0:
            # further below zero the earlier it stands, so that bisection sees which of two fractions is larger
            return speed2 - (last - 1 - i)
    return speed2
