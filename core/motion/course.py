"""A course: all that a run of this vehicle over this line obeys, as arrays over the mesh."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.budget import current_budget
from railjoule.core.drive import Drive, make_drive
from railjoule.core.errors import ScenarioError
from railjoule.core.motion.effort_limit import NO_TABLE, TABLE_STEP_MS, EffortLimit, table_speeds, tabulated_limit
from railjoule.core.motion.line_geometry import LineGeometry, geometry_at, meshed_geometry
from railjoule.core.scenario import Scenario, Vehicle
from railjoule.core.units import MS_PER_KMH, STANDARD_GRAVITY_MS2

FREE = -1.0
"""Mark of a node whose speed is not prescribed."""

W_PER_KW = 1e3
N_PER_KN = 1e3
SWITCHED_AT_WILL = np.zeros(0)
LEAST_BRAKING_SHARE = 1e-9
"""A missing electric brake counts as this share of the tractive effort: an interior point needs an inside."""


class CourseData(NamedTuple):
    """The numbers of a course in a form that compiled code takes; n cells, squares of speed in m2/s2.

    The net force of a cell is `half_inertia_kg` times the change of speed squared over its length. Running
    resistance is constant + linear v + quadratic v^2, at the cell's mean v and mean v^2; its quadratic part rises in
    tunnels. `machines_on` tells for each cell whether a drive that takes power without effort is on, 1, or off, 0,
    while no brake is used; empty where it may be switched at will within a cell.
    """

    cell_length_m: FloatArray
    line_force_n: FloatArray
    largest_speed2: FloatArray
    fixed_speed2: FloatArray
    half_inertia_kg: float
    resistance_constant_n: float
    resistance_linear: float
    resistance_quadratic: FloatArray
    traction: EffortLimit
    braking: EffortLimit
    friction_effort_n: float
    max_acceleration_ms2: float
    max_deceleration_ms2: float
    auxiliary_power_w: float
    drive_kind: int
    drive_parameters: FloatArray
    recuperation_factor: float
    machines_on: FloatArray = SWITCHED_AT_WILL


@dataclass(frozen=True, eq=False)
class Course:
    """All that a run of a vehicle over a line obeys.

    Parameters
    ----------
    position_m : array of shape (n + 1,)
        Nodes of the mesh [m].
    gradient_permille : array of shape (n,)
        Mean gradient under the train in each cell.
    tunnel_factor : array of shape (n,)
        Mean factor of tunnels on the quadratic resistance under the train.
    gradient_force_n, curve_force_n : array of shape (n,)
        Forces of the line against the train [N].
    cell_limit_ms : array of shape (n,)
        Limit of line and vehicle within each cell [m/s].
    dwell_s : array of shape (n + 1,)
        How long the train stands at each node [s].
    drive : Drive
        The vehicle's loss model.
    data : CourseData
        The same for compiled code.
    """

    position_m: FloatArray
    gradient_permille: FloatArray
    tunnel_factor: FloatArray
    gradient_force_n: FloatArray
    curve_force_n: FloatArray
    cell_limit_ms: FloatArray
    dwell_s: FloatArray
    drive: Drive
    data: CourseData

    @property
    def cell_count(self) -> int:
        """Number of cells."""
        return len(self.gradient_permille)

    @property
    def length_m(self) -> float:
        """Length of the run [m]."""
        return float(self.position_m[-1] - self.position_m[0])

    def running_resistance_n(self, speed2: FloatArray) -> FloatArray:
        """Return the running resistance [N] of each cell for squares of speed at the nodes; shape (n,)."""
        return self._resistance_between_n(speed2[:-1], speed2[1:])

    def net_force_n(self, speed2: FloatArray) -> FloatArray:
        """Return the force at the wheels [N] that brings each cell from one node's square of speed to the next's."""
        return self.force_between_n(speed2[:-1], speed2[1:])

    def force_between_n(self, entering_speed2: FloatArray, leaving_speed2: FloatArray) -> FloatArray:
        """Return the force at the wheels [N] from squares of speed at the starts of cells to those at their ends.

        All of shape (..., n).
        """
        inertia = self.data.half_inertia_kg * (leaving_speed2 - entering_speed2) / self.data.cell_length_m
        return inertia + self._resistance_between_n(entering_speed2, leaving_speed2) + self.data.line_force_n

    def _resistance_between_n(self, entering_speed2: FloatArray, leaving_speed2: FloatArray) -> FloatArray:
        data = self.data
        mean_speed = 0.5 * (np.sqrt(leaving_speed2) + np.sqrt(entering_speed2))
        mean_speed2 = 0.5 * (leaving_speed2 + entering_speed2)
        return (
            data.resistance_constant_n + data.resistance_linear * mean_speed + data.resistance_quadratic * mean_speed2
        )


def build_course(
    scenario: Scenario,
    initial_speed_ms: float = 0.0,
    final_speed_ms: float = 0.0,
    position_m: FloatArray | None = None,
) -> Course:
    """Return the course of a scenario.

    Parameters
    ----------
    scenario : Scenario
        Vehicle, line and mesh.
    initial_speed_ms, final_speed_ms : float
        Speeds at the ends of the run [m/s].
    position_m : array of shape (n + 1,), optional
        Nodes [m] instead of those that the scenario's mesh length gives.

    Raises
    ------
    ScenarioError
        If the scenario has more rows or the mesh more cells than the current budget, a limit of effort is missing, or
        an end's speed is none.
    """
    for name, speed in (("initial_speed_ms", initial_speed_ms), ("final_speed_ms", final_speed_ms)):
        if not 0 <= speed < np.inf:
            raise ScenarioError(f"{name} = {speed:g} must be a finite number of at least 0.")
    _require_few_rows(scenario)
    vehicle = scenario.vehicle
    train = vehicle.length_m, vehicle.car_count
    if position_m is None:
        line = meshed_geometry(scenario.line, scenario.solver.mesh_m, *train)
    else:
        line = geometry_at(scenario.line.in_running_order(), np.asarray(position_m, dtype=float), *train)
    weight_kn = vehicle.total_mass_kg * STANDARD_GRAVITY_MS2 / N_PER_KN
    gradient_force = weight_kn * line.gradient_permille
    curve_force = weight_kn * vehicle.resistance.curve_constant_m_n_per_kn * line.curvature_per_m
    fixed = np.full(len(line.position_m), FREE)
    fixed[list(line.stop_nodes)] = 0.0
    fixed[[0, -1]] = initial_speed_ms**2, final_speed_ms**2
    drive = make_drive(vehicle.drive)
    return Course(
        position_m=line.position_m,
        gradient_permille=line.gradient_permille,
        tunnel_factor=line.tunnel_factor,
        gradient_force_n=frozen_array(gradient_force),
        curve_force_n=frozen_array(curve_force),
        cell_limit_ms=frozen_array(np.minimum(line.cell_limit_ms, vehicle.traction.max_speed_kmh * MS_PER_KMH)),
        dwell_s=line.dwell_s,
        drive=drive,
        data=_course_data(vehicle, drive, line, gradient_force + curve_force, fixed),
    )


def _require_few_rows(scenario: Scenario) -> None:
    budget = current_budget()
    for key, rows in (
        ("line.sections", scenario.line.sections),
        ("line.speed_limits", scenario.line.speed_limits),
        ("drive.points", getattr(scenario.vehicle.drive, "points", ())),
    ):
        if len(rows) > budget.row_count:
            raise ScenarioError(f"{key} has {len(rows):,} entries; {budget.taker} takes at most {budget.row_count:,}.")


def _course_data(
    vehicle: Vehicle, drive: Drive, line: LineGeometry, line_force_n: FloatArray, fixed_speed2: FloatArray
) -> CourseData:
    constant, linear, quadratic = resistance_coefficients(vehicle)
    traction, braking = vehicle.traction, vehicle.braking
    drive.require_speed(traction.max_speed_kmh * MS_PER_KMH)
    pulling, electric = _traction_limit(vehicle, drive), _braking_limit(vehicle, drive)
    least_braking = LEAST_BRAKING_SHARE * pulling.constant_n
    return CourseData(
        cell_length_m=np.diff(line.position_m),
        line_force_n=line_force_n,
        largest_speed2=np.minimum(line.speed_limit_ms, traction.max_speed_kmh * MS_PER_KMH) ** 2,
        fixed_speed2=fixed_speed2,
        half_inertia_kg=0.5 * vehicle.total_inertia_kg,
        resistance_constant_n=constant,
        resistance_linear=linear,
        resistance_quadratic=quadratic * line.tunnel_factor,
        traction=pulling,
        braking=electric._replace(constant_n=max(electric.constant_n, least_braking)),
        friction_effort_n=braking.friction_effort_kn * N_PER_KN,
        max_acceleration_ms2=traction.max_acceleration_ms2 or np.inf,
        max_deceleration_ms2=braking.max_deceleration_ms2 or np.inf,
        auxiliary_power_w=vehicle.auxiliary_power_kw * W_PER_KW,
        drive_kind=drive.kind,
        drive_parameters=drive.parameters,
        recuperation_factor=drive.recuperation_factor,
    )


def resistance_coefficients(vehicle: Vehicle) -> tuple[float, float, float]:
    """Return constant [N], linear [N s/m] and quadratic [N s2/m2] coefficient of running resistance."""
    resistance, specific = vehicle.resistance, vehicle.specific_resistance
    weight_kn = vehicle.total_mass_kg * STANDARD_GRAVITY_MS2 / N_PER_KN
    return (
        weight_kn * specific.constant_n_per_kn + resistance.constant_n,
        (weight_kn * specific.linear_n_per_kn_per_kmh + resistance.linear_n_per_kmh) / MS_PER_KMH,
        (weight_kn * specific.quadratic_n_per_kn_per_kmh2 + resistance.quadratic_n_per_kmh2) / MS_PER_KMH**2,
    )


def vehicle_limit_n(vehicle: Vehicle, speed_ms: FloatArray, braking: bool = False) -> FloatArray:
    """Return the largest effort [N] that a vehicle's own limits allow, its drive's apart; shape as the speeds'.

    Infinite where it sets none.
    """
    speed = np.asarray(speed_ms, dtype=float)
    limits = vehicle.braking if braking else vehicle.traction
    effort = np.full(speed.shape, np.inf)
    if limits.max_effort_kn is not None:
        effort = np.minimum(effort, limits.max_effort_kn * N_PER_KN)
    if limits.max_power_kw is not None:
        effort = np.minimum(effort, limits.max_power_kw * W_PER_KW / np.maximum(speed, 1e-3))
    if not braking and vehicle.traction.curve:
        knots = np.array(vehicle.traction.curve)
        effort = np.minimum(effort, np.interp(speed, knots[:, 0] * MS_PER_KMH, knots[:, 1] * N_PER_KN))
    return effort


def _traction_limit(vehicle: Vehicle, drive: Drive) -> EffortLimit:
    traction = vehicle.traction
    curve = traction.curve or ()
    top = max((effort for _, effort in curve), default=np.inf)
    constant = min(traction.max_effort_kn or np.inf, top) * N_PER_KN
    return _effort_limit(vehicle, drive, constant, traction.max_power_kw, curve, "traction")


def _braking_limit(vehicle: Vehicle, drive: Drive) -> EffortLimit:
    braking = vehicle.braking
    constant = np.inf if braking.max_effort_kn is None else braking.max_effort_kn * N_PER_KN
    return _effort_limit(vehicle, drive, constant, braking.max_power_kw, (), "braking")


def _effort_limit(
    vehicle: Vehicle,
    drive: Drive,
    constant_n: float,
    power_kw: float | None,
    curve: tuple[tuple[float, float], ...],
    table: str,
) -> EffortLimit:
    """Combine the limits of a vehicle's table with those of its drive."""
    braking = table == "braking"
    power = np.inf if power_kw is None else power_kw * W_PER_KW
    top_speed = vehicle.traction.max_speed_kmh * MS_PER_KMH
    speeds = table_speeds(top_speed)
    by_drive = drive.effort_limit_n(speeds, braking)
    constant = min(constant_n, float(np.max(by_drive)))
    if not np.isfinite(constant):
        raise ScenarioError(f"vehicle.{table}.max_effort_kn is missing: this drive sets no limit of effort.")
    weakening = drive.weakening_limit_n(speeds, braking)
    if not curve and not np.isfinite(weakening).any():
        return EffortLimit(constant, power, NO_TABLE, TABLE_STEP_MS)
    # the constant caps it: a corner there would be rounded by the table
    limit = np.minimum(weakening, power / np.maximum(speeds, 1e-3))
    if curve:
        knots = np.array(curve)
        limit = np.minimum(limit, np.interp(speeds, knots[:, 0] * MS_PER_KMH, knots[:, 1] * N_PER_KN))
    return tabulated_limit(constant, np.minimum(limit, 2 * constant))
