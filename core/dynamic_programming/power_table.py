"""A table of a drive's power and action over speed and effort, which prices a step of backward induction in 10 ns.

The account of a cell asks the drive's model for its power, which takes 0.3 us, and a grid of 61 speeds has half a
million steps. A table of the losses is read at the same price for any drive. Only a search for decisions may use it,
which are solved exactly afterwards.
"""

import math
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import has_standstill_brake
from railjoule.core.physics.cell import Cell, duration, mean_speed, needed_force
from railjoule.core.physics.effort_limit import SLOWEST_MS, max_effort
from railjoule.core.physics.energy_balance import cell_balance
from railjoule.core.physics.mesh_data import OFF, MeshData, shared_by_cells
from railjoule.core.physics.stretches import NEXT_TO_NOTHING, action_of_cell

SPEEDS, EFFORTS = 96, 64
"""Of a table: from rest to the highest speed, and from none to the largest effort at each of them."""
DRIVING_SIDE, BRAKING_SIDE = range(2)


class PowerTable(NamedTuple):
    """Losses and actions of a train's drive at an effort at its wheels, which friction brakes share.

    Parameters
    ----------
    step_ms, min_n : float
        Step of speed [m/s], and the effort below which the drive is off [N].
    largest_n : array of shape (2, SPEEDS)
        Largest effort of driving, and of all brakes together [N].
    loss_w : array of shape (2, SPEEDS, EFFORTS)
        Power from the supply less the power at the wheels [W]; the latter is negative in braking.
    action : array of shape (2, SPEEDS, EFFORTS)
        Off, driving or braking, as `physics.stretches` counts.
    """

    step_ms: float
    min_n: float
    largest_n: FloatArray
    loss_w: FloatArray
    action: IntArray


NO_POWERS = PowerTable(1.0, 0.0, np.zeros((2, 0)), np.zeros((2, 0, 0)), np.zeros((2, 0, 0), dtype=np.int64))


@njit(cache=True, error_model="numpy", nogil=True)
def tabulate_powers(mesh: MeshData) -> PowerTable:
    """Return the table of a meshed line's train."""
    train, traction, braking, drive = shared_by_cells(mesh).own
    another = has_standstill_brake(mesh.drive_kind, mesh.drive_parameters)
    least = NEXT_TO_NOTHING * traction.constant_n
    step = math.sqrt(mesh.limit_speed2.max()) / (SPEEDS - 1)
    largest, loss = np.empty((2, SPEEDS)), np.empty((2, SPEEDS, EFFORTS))
    action = np.empty((2, SPEEDS, EFFORTS), dtype=np.int64)
    for k in range(SPEEDS):
        v = max(k * step, SLOWEST_MS)
        largest[DRIVING_SIDE, k] = max_effort(traction, v)
        largest[BRAKING_SIDE, k] = max_effort(braking, v) + train.friction_effort_n
        for side in range(2):
            for j in range(EFFORTS):
                # at no effort the power jumps: there stands what the least effort takes
                force = max(largest[side, k] * j / (EFFORTS - 1), 2.0 * least)
                force = force if side == DRIVING_SIDE else -force
                # a cell whose only resistance is that force, passed at one speed
                cell = Cell(1.0, 0.0, force, 0.0, 0.0, 1.0, 0.0, 1.0)
                account = cell_balance(cell, train, traction, braking, drive, v * v, v * v)
                loss[side, k, j] = account.supply_power_w - force * v
                action[side, k, j], _ = action_of_cell(account, traction, another)
    return PowerTable(step, least, largest, loss, action)


@njit(cache=True, error_model="numpy")
def tabulated_cost(
    table: PowerTable, cell: Cell, entering_speed2: float, leaving_speed2: float
) -> tuple[float, float, int]:
    """Return energy from the supply without auxiliaries [J], time [s] and action of a step within its limits."""
    v = mean_speed(math.sqrt(entering_speed2), math.sqrt(leaving_speed2))
    force, seconds = needed_force(cell, entering_speed2, leaving_speed2, v), duration(cell.length_m, v)
    # in a neutral section no drive is on
    if abs(force) <= table.min_n or cell.supply_share < 1.0:
        return 0.0, seconds, OFF
    side = DRIVING_SIDE if force > 0.0 else BRAKING_SIDE
    k = min(int(v / table.step_ms), SPEEDS - 2)
    x = min(v / table.step_ms - k, 1.0)
    largest, loss = table.largest_n[side], table.loss_w[side]
    share = min(abs(force) / (largest[k] + x * (largest[k + 1] - largest[k])), 1.0) * (EFFORTS - 1)
    j = min(int(share), EFFORTS - 2)
    y = share - j
    slow = loss[k, j] + y * (loss[k, j + 1] - loss[k, j])
    fast = loss[k + 1, j] + y * (loss[k + 1, j + 1] - loss[k + 1, j])
    power = force * v + slow + x * (fast - slow)
    return power * seconds, seconds, table.action[side, k + int(x + 0.5), j + int(y + 0.5)]
