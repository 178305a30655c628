"""One cell of a course: the speed that an effort leads to, and what the way from one speed to another costs."""

import math
from typing import NamedTuple

from railjoule.core.arrays import FloatArray
from railjoule.core.compiled import njit
from railjoule.core.drive.kernels import driving_power, generated_power
from railjoule.core.motion.course import CourseData
from railjoule.core.motion.effort_limit import EffortLimit, largest_effort

FULL_TRACTION, COAST, FULL_BRAKE = range(3)
STEPS = 12
EXACT = 1e-13
ALLOWED_EXCESS = 1e-7


class Cell(NamedTuple):
    """What one cell of a course asks for, as plain numbers: inner loops that carry arrays are ten times slower.

    `inertia` is the force over the change of speed squared [N s2/m2], `against_n` what resists at any speed.
    """

    length_m: float
    inertia: float
    against_n: float
    linear: float
    quadratic: float
    traction_n: float
    traction_w: float
    braking_n: float
    braking_w: float
    friction_n: float
    max_acceleration_ms2: float
    max_deceleration_ms2: float
    drive_kind: int
    recuperation_factor: float


@njit(cache=True, error_model="numpy")
def cell_of(course: CourseData, number: int) -> Cell:
    """Return one cell of a course."""
    return Cell(
        course.cell_length_m[number],
        course.half_inertia_kg / course.cell_length_m[number],
        course.resistance_constant_n + course.line_force_n[number],
        course.resistance_linear,
        course.resistance_quadratic[number],
        course.traction.constant_n,
        course.traction.power_w,
        course.braking.constant_n,
        course.braking.power_w,
        course.friction_effort_n,
        course.max_acceleration_ms2,
        course.max_deceleration_ms2,
        course.drive_kind,
        course.recuperation_factor,
    )


@njit(cache=True, error_model="numpy")
def effort_at(constant_n: float, power_w: float, table: FloatArray, step_ms: float, speed: float) -> float:
    """Return the largest effort [N] at a speed [m/s]."""
    if table.shape[0] == 0:
        return min(constant_n, power_w / speed)
    return largest_effort(EffortLimit(constant_n, power_w, table, step_ms), speed)


@njit(cache=True, error_model="numpy")
def exit_speed2(
    cell: Cell, traction: FloatArray, braking: FloatArray, step_ms: float, entering_speed2: float, control: int
) -> float:
    """Return the square of speed [m2/s2] to which a control leads; negative where the train comes to a stand.

    Full traction and full braking keep the limits of acceleration and deceleration. The effort depends on the mean
    speed of the cell, hence on the result: a fixed point that is found in a few steps.
    """
    known = (cell.inertia - 0.5 * cell.quadratic) * entering_speed2 - cell.against_n
    entry = math.sqrt(entering_speed2)
    leaving_speed2 = entering_speed2
    for _ in range(STEPS):
        mean_speed = max(0.5 * (entry + math.sqrt(max(leaving_speed2, 0.0))), 1e-9)
        force = known - cell.linear * mean_speed
        if control == FULL_TRACTION:
            force += effort_at(cell.traction_n, cell.traction_w, traction, step_ms, mean_speed)
        elif control == FULL_BRAKE:
            force -= effort_at(cell.braking_n, cell.braking_w, braking, step_ms, mean_speed) + cell.friction_n
        before = leaving_speed2
        leaving_speed2 = force / (cell.inertia + 0.5 * cell.quadratic)
        if abs(leaving_speed2 - before) <= EXACT * entering_speed2:
            break
    if control == FULL_TRACTION:
        leaving_speed2 = min(leaving_speed2, entering_speed2 + 2.0 * cell.max_acceleration_ms2 * cell.length_m)
    elif control == FULL_BRAKE:
        leaving_speed2 = max(leaving_speed2, entering_speed2 - 2.0 * cell.max_deceleration_ms2 * cell.length_m)
    return leaving_speed2


@njit(cache=True, error_model="numpy")
def cell_cost(
    cell: Cell,
    traction: FloatArray,
    braking: FloatArray,
    step_ms: float,
    drive: FloatArray,
    entering_speed2: float,
    leaving_speed2: float,
) -> tuple[float, float, bool]:
    """Return line energy without auxiliaries [J], time [s], and whether the limits of effort allow the way.

    The electric brake comes first, friction does what it cannot; drawing power to brake counts in full.
    """
    mean_speed = 0.5 * (math.sqrt(entering_speed2) + math.sqrt(leaving_speed2))
    if mean_speed <= 0.0:
        return math.inf, math.inf, False
    duration = cell.length_m / mean_speed
    force = cell.inertia * (leaving_speed2 - entering_speed2) + cell.against_n
    force += cell.linear * mean_speed + cell.quadratic * 0.5 * (entering_speed2 + leaving_speed2)
    tolerance = ALLOWED_EXCESS * cell.traction_n
    if force >= 0.0:
        most = effort_at(cell.traction_n, cell.traction_w, traction, step_ms, mean_speed)
        power = driving_power(cell.drive_kind, drive, force, mean_speed)[0]
        return duration * power, duration, force <= most + tolerance
    electric = effort_at(cell.braking_n, cell.braking_w, braking, step_ms, mean_speed)
    power = generated_power(cell.drive_kind, drive, min(-force, electric), mean_speed)[0]
    if power > 0.0:
        power *= cell.recuperation_factor
    elif cell.friction_n > 0.0:
        # friction brakes spare the drive what it would have to draw
        least = max(-force - cell.friction_n, 0.0)
        power = max(power, generated_power(cell.drive_kind, drive, least, mean_speed)[0])
    return -duration * power, duration, -force <= electric + cell.friction_n + tolerance
