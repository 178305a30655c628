"""One cell of a meshed line: the speed that a control leads to, and what it costs to go from one speed to another."""

import math

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.physics.cell import NEARLY_AT_REST_MS, Cell, mean_speed, reached_speed2
from railjoule.core.physics.effort_limit import EffortLimit, supplied_effort
from railjoule.core.physics.energy_balance import cell_balance
from railjoule.core.physics.mesh_data import Train, can_start

FULL_TRACTION, COAST, FULL_BRAKE = range(3)
# A step of the fixed point shrinks its error by what effort and resistance change over what the change of speed takes.
# Near rest, where that is much, twelve steps left efforts up to 6e-5 above their limits; forty leave rounding.
STEPS = 40
EXACT = 1e-13
# of the largest tractive effort: above what the fixed point and the solver's 1e-8 leave, too little to save any energy
ALLOWED_EXCESS = 1e-7
CANNOT_START = -1.0
"""Square of speed that stands for a train that full traction does not start [m2/s2]."""


@njit(cache=True, error_model="numpy")
def exit_speed2(
    cell: Cell, train: Train, traction: EffortLimit, braking: EffortLimit, entering_speed2: float, control: int
) -> float:
    """Return the square of speed [m2/s2] to which a control leads; negative where the train comes to a stand.

    Full traction and full braking keep the limits of acceleration and deceleration. The effort depends on the mean
    speed of the cell, hence on the result: a fixed point that is found in a few steps.
    """
    if control == FULL_TRACTION and entering_speed2 <= 0.0 and not can_start(cell, traction):
        return CANNOT_START
    entry = math.sqrt(entering_speed2)
    leaving_speed2, last_change = entering_speed2, 0.0
    for _ in range(STEPS):
        v = max(mean_speed(entry, math.sqrt(max(leaving_speed2, 0.0))), NEARLY_AT_REST_MS)
        force = 0.0
        if control == FULL_TRACTION:
            force = supplied_effort(traction, cell.supply_share, v)
        elif control == FULL_BRAKE:
            force = -(supplied_effort(braking, cell.supply_share, v) + train.friction_effort_n)
        before = leaving_speed2
        leaving_speed2 = reached_speed2(cell, entering_speed2, leaving_speed2, v, force)
        change = leaving_speed2 - before
        if change * last_change < 0.0 and abs(change) > 0.5 * abs(last_change):
            # in long cells an effort that falls fast with speed throws the result to and fro
            leaving_speed2 = before + 0.5 * change
        last_change = change
        if abs(leaving_speed2 - before) <= EXACT * entering_speed2:
            break
    if control == FULL_TRACTION:
        leaving_speed2 = min(leaving_speed2, entering_speed2 + 2.0 * train.max_acceleration_ms2 * cell.length_m)
    elif control == FULL_BRAKE:
        leaving_speed2 = max(leaving_speed2, entering_speed2 - 2.0 * train.max_deceleration_ms2 * cell.length_m)
    return leaving_speed2


@njit(cache=True, error_model="numpy")
def cell_cost(
    cell: Cell,
    train: Train,
    traction: EffortLimit,
    braking: EffortLimit,
    drive: FloatArray,
    entering_speed2: float,
    leaving_speed2: float,
) -> tuple[float, float, bool]:
    """Return line energy without auxiliaries [J], time [s], and whether the limits of effort allow the step."""
    if entering_speed2 <= 0.0 and leaving_speed2 <= 0.0:
        return math.inf, math.inf, False
    account = cell_balance(cell, train, traction, braking, drive, entering_speed2, leaving_speed2)
    allowed = account.excess_n <= ALLOWED_EXCESS * traction.constant_n
    return account.supply_power_w * account.duration_s, account.duration_s, allowed
