"""A meshed line: all that a run of this vehicle over this line obeys, as arrays over the mesh."""

from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array, midpoints
from railjoule.core.budget import current_budget
from railjoule.core.drive import Drive, make_drive
from railjoule.core.errors import ScenarioError
from railjoule.core.motion.line_geometry import LineGeometry, TrainExtent, geometry_at, meshed_geometry
from railjoule.core.motion.line_profile import limits_by_place
from railjoule.core.motion.permitted_speed import curve_steps, permitted_speed2
from railjoule.core.physics.adhesion import adhesion_coefficient, adhesive_weight, friction_limit_n
from railjoule.core.physics.cell import mean_speed, needed_force
from railjoule.core.physics.mesh_data import MeshData, all_cells, data_between
from railjoule.core.physics.place_limits import NO_TABLES, Efforts, PlaceLimits, PlaceTables, place_tables
from railjoule.core.physics.resistance import (
    curve_force_n,
    gradient_force_n,
    mean_starting_resistance,
    resistance_coefficients,
    running_resistance,
    starting_terms,
)
from railjoule.core.physics.vehicle_limit import effort_limit
from railjoule.core.scenario import Scenario
from railjoule.core.units import MS_PER_KMH, W_PER_KW

FREE = np.nan
"""Mark of a node whose speed is not prescribed."""

PER_CELL = ("gradient_permille", "tunnel_factor", "gradient_force_n", "curve_force_n", "cell_limit_ms")
"""The arrays of a meshed line with one entry a cell, beside those of its data."""

# an interior-point method needs a strictly feasible start: between no effort and a largest one of zero there is none
MISSING_BRAKE_SHARE = 1e-9
"""A missing electric brake counts as this share of the tractive effort."""
NEUTRAL_SHARE = 1e-9
"""Share of the limits of the drive that is left in a neutral section, for the same reason."""


@dataclass(frozen=True, eq=False)
class MeshedLine:
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
        Limit of line and vehicle within each cell [m/s], without braking curves before lower ones.
    dwell_s : array of shape (n + 1,)
        How long the train stands at each node [s].
    drive : Drive
        The vehicle's loss model.
    data : MeshData
        The same for compiled code.
    permitted_deceleration_ms2 : float
        The least deceleration of the vehicle's braking curve [m/s2], infinite where it has none; braking at this rate
        towards a place on the curve stays under the curve.
    curve_steps : array of shape (2, k)
        The steps of that curve, as `railjoule.core.motion.permitted_speed.curve_steps` returns them.
    """

    position_m: FloatArray
    gradient_permille: FloatArray
    tunnel_factor: FloatArray
    gradient_force_n: FloatArray
    curve_force_n: FloatArray
    cell_limit_ms: FloatArray
    dwell_s: FloatArray
    drive: Drive
    data: MeshData
    permitted_deceleration_ms2: float = np.inf
    curve_steps: FloatArray = field(default_factory=lambda: np.zeros((2, 0)))

    def between(self, first: int, last: int) -> "MeshedLine":
        """Return the meshed line between two nodes, over the same mesh; the train does not stand at its ends."""
        cells, nodes = slice(first, last), slice(first, last + 1)
        dwell = self.dwell_s[nodes].copy()
        dwell[[0, -1]] = 0.0
        return replace(
            self,
            **{name: getattr(self, name)[cells] for name in PER_CELL},
            position_m=self.position_m[nodes],
            dwell_s=dwell,
            data=data_between(self.data, first, last),
        )

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
        # at the means that `needed_force` takes, or the account of the energy would not close
        data, speed = self.data, np.sqrt(speed2)
        running = running_resistance(
            data.resistance_constant_n,
            data.resistance_linear,
            data.resistance_quadratic,
            midpoints(speed),
            midpoints(speed2),
        )
        starting = mean_starting_resistance(data.starting_n, data.starting_ends_ms, speed2[:-1], speed2[1:])
        return running + starting

    def net_force_n(self, speed2: FloatArray) -> FloatArray:
        """Return the force at the wheels [N] that brings each cell from one node's square of speed to the next's."""
        return self.force_between_n(speed2[:-1], speed2[1:])

    def force_between_n(self, entering_speed2: FloatArray, leaving_speed2: FloatArray) -> FloatArray:
        """Return the force at the wheels [N] from squares of speed at the starts of cells to those at their ends.

        All of shape (..., n).
        """
        v = mean_speed(np.sqrt(entering_speed2), np.sqrt(leaving_speed2))
        return needed_force(all_cells(self.data), entering_speed2, leaving_speed2, v)


def train_extent(scenario: Scenario) -> TrainExtent:
    """Return how far a scenario's train reaches behind its front."""
    vehicle = scenario.vehicle
    return TrainExtent(vehicle.length_m, vehicle.car_count, vehicle.gradient_at, scenario.limits_last_m)


class MeshedLineParts(NamedTuple):
    """The parts of a meshed line that take longest to make, and that few changes of a scenario's numbers touch.

    Parameters
    ----------
    line : LineGeometry
        The line over its mesh, as the train meets it.
    drive : Drive
        The vehicle's loss model.
    efforts : Efforts
        Limits of vehicle and drive together, where the line lowers none.
    places : PlaceTables
        Limits of the line's other places.
    """

    line: LineGeometry
    drive: Drive
    efforts: Efforts
    places: PlaceTables


def build_meshed_line(
    scenario: Scenario,
    initial_speed_ms: float | None = None,
    final_speed_ms: float | None = None,
    position_m: FloatArray | None = None,
) -> MeshedLine:
    """Return the meshed line of a scenario.

    Parameters
    ----------
    scenario : Scenario
        Vehicle, line and mesh.
    initial_speed_ms, final_speed_ms : float, optional
        Speeds at the ends of the run [m/s]; those of the timetable where absent.
    position_m : array of shape (n + 1,), optional
        Nodes [m] instead of those that the scenario's mesh length gives.

    Raises
    ------
    ScenarioError
        If the scenario has more rows or the mesh more cells than the current budget, a limit of effort is missing, or
        an end's speed is none.
    """
    line, drive = build_line(scenario, position_m), build_drive(scenario)
    return assemble_meshed_line(
        scenario, MeshedLineParts(line, drive, *build_limits(scenario, line, drive)), initial_speed_ms, final_speed_ms
    )


def build_line(scenario: Scenario, position_m: FloatArray | None = None) -> LineGeometry:
    """Return a scenario's line over its mesh or over given nodes [m]; arguments and errors as `build_meshed_line`."""
    _require_few_rows(scenario)
    if position_m is None:
        return meshed_geometry(scenario.line, scenario.solver.mesh_m, train_extent(scenario))
    nodes = np.asarray(position_m, dtype=float)
    return geometry_at(scenario.line.in_running_order(), nodes, train_extent(scenario))


def build_drive(scenario: Scenario) -> Drive:
    """Return the drive of a scenario's vehicle.

    Raises
    ------
    ScenarioError
        If its data end below the vehicle's largest speed.
    """
    drive = make_drive(scenario.vehicle.drive)
    # the error is raised here, before any solver looks beyond the end of a table
    drive.require_speed(scenario.vehicle.traction.max_speed_kmh * MS_PER_KMH)
    return drive


def build_limits(scenario: Scenario, line: LineGeometry, drive: Drive) -> tuple[Efforts, PlaceTables]:
    """Return the efforts of a scenario with its drive where the line lowers none, and at its other places.

    Raises
    ------
    ScenarioError
        If a limit of effort is missing.
    """
    _, least, others = line.limits_by_place
    own = _efforts(scenario, drive, least)
    if not others:
        return own, NO_TABLES
    found = [_efforts(scenario, drive, place) for place in others]
    limits = [one.traction for one in found], [one.braking for one in found]
    # compiled code takes tables of one shape: where one limit has one, all get theirs
    traction, braking = (any(len(limit.table) for limit in side) for side in limits)
    if traction or braking:
        found = [_efforts(scenario, drive, place, traction, braking) for place in others]
    return own, place_tables(found)


def _efforts(
    scenario: Scenario, drive: Drive, place: PlaceLimits, traction: bool = False, braking: bool = False
) -> Efforts:
    """Return the efforts of a train at a kind of place; flags tell which limits get a table."""
    vehicle, condition = scenario.vehicle, place.rail_condition
    driven_n = adhesive_weight(scenario, condition).driven_n
    pulling = effort_limit(vehicle, drive, False, driven_n, place, traction)
    electric = effort_limit(vehicle, drive, True, driven_n, place, braking)
    min_braking = MISSING_BRAKE_SHARE * pulling.constant_n
    electric = electric._replace(constant_n=max(electric.constant_n, min_braking))
    friction_n = friction_limit_n(scenario, electric, condition)
    if vehicle.braking.friction_effort_kn > 0 and condition is not None:
        friction_n = max(friction_n, min_braking)
    return Efforts(pulling, electric, friction_n, min(drive.recuperation_factor, place.recuperation_factor))


def driven_adhesion_n(scenario: Scenario, position_m: FloatArray, speed_ms: FloatArray) -> FloatArray | None:
    """Return the largest force of the driven axles [N] at places [m] and speeds [m/s]; None where nothing limits it.

    It is infinite where adhesion sets no limit.
    """
    number, least, others = limits_by_place(scenario.line.in_running_order(), position_m)
    driven_n = [adhesive_weight(scenario, place.rail_condition).driven_n for place in (*others, least)]
    if np.isinf(driven_n).all():
        return None
    return np.array(driven_n)[number] * adhesion_coefficient(speed_ms)


def assemble_meshed_line(
    scenario: Scenario,
    parts: MeshedLineParts,
    initial_speed_ms: float | None = None,
    final_speed_ms: float | None = None,
) -> MeshedLine:
    """Return the meshed line of a scenario from its parts, which others of its kind may share.

    Parameters
    ----------
    scenario, initial_speed_ms, final_speed_ms
        As for `build_meshed_line`.
    parts : MeshedLineParts
        The parts of this scenario: nothing here checks that.

    Raises
    ------
    ScenarioError
        If an end's speed is none.
    """
    entry_ms, exit_ms = scenario.timetable.end_speeds_ms
    initial_speed_ms = entry_ms if initial_speed_ms is None else initial_speed_ms
    final_speed_ms = exit_ms if final_speed_ms is None else final_speed_ms
    for name, speed in (("initial_speed_ms", initial_speed_ms), ("final_speed_ms", final_speed_ms)):
        if not 0 <= speed < np.inf:
            raise ScenarioError(f"{name} = {speed:g} must be a finite number of at least 0.")
    vehicle, line, steps = scenario.vehicle, parts.line, curve_steps(scenario.vehicle)
    gradient_force = gradient_force_n(vehicle, line.gradient_permille)
    curve_force = curve_force_n(vehicle, line.curvature_per_m)
    fixed = np.full(len(line.position_m), FREE)
    fixed[list(line.stop_nodes)] = 0.0
    for node, passing_ms in line.passing_ms:
        fixed[node] = passing_ms**2
    fixed[[0, -1]] = initial_speed_ms**2, final_speed_ms**2
    return MeshedLine(
        position_m=line.position_m,
        gradient_permille=line.gradient_permille,
        tunnel_factor=line.tunnel_factor,
        gradient_force_n=frozen_array(gradient_force),
        curve_force_n=frozen_array(curve_force),
        cell_limit_ms=frozen_array(np.minimum(line.cell_limit_ms, vehicle.traction.max_speed_kmh * MS_PER_KMH)),
        dwell_s=line.dwell_s,
        drive=parts.drive,
        data=_mesh_data(scenario, parts, gradient_force + curve_force, fixed),
        permitted_deceleration_ms2=float(steps[1].min(initial=np.inf)),
        curve_steps=steps,
    )


def _require_few_rows(scenario: Scenario) -> None:
    budget = current_budget()
    for key, rows in (
        ("line.sections", scenario.line.sections),
        ("line.speed_limits", scenario.line.speed_limits),
        ("line.neutral_sections", scenario.line.neutral_sections),
        ("line.traction_limits", scenario.line.traction_limits),
        ("line.rail_conditions", scenario.line.rail_conditions),
        ("drive.points", getattr(scenario.vehicle.drive, "points", ())),
    ):
        if len(rows) > budget.row_count:
            raise ScenarioError(f"{key} has {len(rows):,} entries; {budget.name} takes at most {budget.row_count:,}.")


def _mesh_data(
    scenario: Scenario, parts: MeshedLineParts, line_force_n: FloatArray, fixed_speed2: FloatArray
) -> MeshData:
    vehicle, line, drive = scenario.vehicle, parts.line, parts.drive
    constant, linear, quadratic = resistance_coefficients(vehicle, scenario.line.head_wind_kmh * MS_PER_KMH)
    traction, braking, starting = vehicle.traction, vehicle.braking, starting_terms(vehicle)
    cell_length = np.diff(line.position_m)
    limit2 = np.minimum(line.speed_limit_ms, traction.max_speed_kmh * MS_PER_KMH) ** 2
    return MeshData(
        cell_length_m=cell_length,
        line_force_n=line_force_n,
        limit_speed2=permitted_speed2(vehicle, cell_length, limit2, fixed_speed2),
        fixed_speed2=fixed_speed2,
        half_inertia_kg=0.5 * vehicle.total_inertia_kg,
        resistance_constant_n=constant,
        resistance_linear=linear,
        # tunnels hold up the air, not the bearings
        resistance_quadratic=quadratic * line.tunnel_factor,
        starting_n=starting[0],
        starting_ends_ms=starting[1],
        traction=parts.efforts.traction,
        braking=parts.efforts.braking,
        friction_effort_n=parts.efforts.friction_n,
        # infinite, not None: compiled code compares numbers
        max_acceleration_ms2=traction.max_acceleration_ms2 or np.inf,
        max_deceleration_ms2=braking.max_deceleration_ms2 or np.inf,
        auxiliary_power_w=vehicle.auxiliary_power_kw * W_PER_KW,
        drive_kind=drive.kind,
        drive_parameters=drive.parameters,
        recuperation_factor=drive.recuperation_factor,
        supply_share=np.where(line.neutral, NEUTRAL_SHARE, 1.0),
        place=line.limits_by_place.number,
        places=parts.places,
    )
