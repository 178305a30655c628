"""A meshed line as compiled code takes it: the numbers of a train and of the line under it."""

from typing import NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import borrowed, njit
from railjoule.core.physics.cell import NEARLY_AT_REST_MS, Cell
from railjoule.core.physics.effort_limit import EffortLimit, borrowed_limit, supplied_effort
from railjoule.core.physics.place_limits import (
    BRAKING,
    NO_PLACE,
    TRACTION,
    PlaceTables,
    borrowed_tables,
    limit_at_place,
)

# an empty array, not None: compiled code needs one type of each field
SWITCHED_AT_WILL = np.zeros(0, dtype=np.int64)
MODES = 3
OFF, DRIVE, BRAKE = range(MODES)
"""Modes of a drive in a cell."""
PER_CELL = ("cell_length_m", "line_force_n", "resistance_quadratic", "mode", "supply_share", "place")
PER_NODE = ("limit_speed2", "fixed_speed2")
"""The arrays of a meshed line's data with one entry a cell, and with one a node."""


class MeshData(NamedTuple):
    """The numbers of a meshed line of n cells.

    Parameters
    ----------
    cell_length_m : array of shape (n,)
        Lengths of the cells [m].
    line_force_n : array of shape (n,)
        Forces of gradients and curves against the train [N].
    limit_speed2, fixed_speed2 : array of shape (n + 1,)
        Squares of the limit of speed at the nodes, and of prescribed speeds; NaN where a node is free [m2/s2].
    half_inertia_kg : float
        Half of the mass that resists acceleration [kg].
    resistance_constant_n, resistance_linear : float
        A and B of the running resistance [N, N s/m].
    resistance_quadratic : array of shape (n,)
        C with the factor of tunnels [N s2/m2].
    starting_n, starting_ends_ms : float
        As in `Cell`.
    traction, braking : EffortLimit
        Largest efforts of the drive and of the electric brake where the line does not lower them.
    friction_effort_n : float
        Largest effort of the friction brakes there [N].
    max_acceleration_ms2, max_deceleration_ms2 : float
        Limits of dv/dt, infinite where there is none [m/s2].
    auxiliary_power_w : float
        Taken all the time [W].
    drive_kind, drive_parameters : int and array
        What `railjoule.core.drive.kernels` take.
    recuperation_factor : float
        Share of the generated energy that the line takes back there.
    supply_share : array of shape (n,)
        As in `Cell`.
    place : array of shape (n,)
        Whose row of `places` holds in each cell; NO_PLACE where the train's own limits do.
    places : PlaceTables
        Limits of effort and recuperation at other places, none above the train's own.
    mode : array of shape (n,) or (0,)
        Decision of a drive with idle losses in each cell, DRIVE, BRAKE or OFF; empty where it may be switched at will
        within a cell.
    """

    cell_length_m: FloatArray
    line_force_n: FloatArray
    limit_speed2: FloatArray
    fixed_speed2: FloatArray
    half_inertia_kg: float
    resistance_constant_n: float
    resistance_linear: float
    resistance_quadratic: FloatArray
    starting_n: float
    starting_ends_ms: float
    traction: EffortLimit
    braking: EffortLimit
    friction_effort_n: float
    max_acceleration_ms2: float
    max_deceleration_ms2: float
    auxiliary_power_w: float
    drive_kind: int
    drive_parameters: FloatArray
    recuperation_factor: float
    supply_share: FloatArray
    place: IntArray
    places: PlaceTables
    mode: IntArray = SWITCHED_AT_WILL


class Train(NamedTuple):
    """The plain numbers of a meshed line's train, named as in `MeshData`.

    Only plain numbers: two limits of effort and the drive's parameters, which hold arrays, are arguments of their own.
    """

    drive_kind: int
    recuperation_factor: float
    friction_effort_n: float
    max_acceleration_ms2: float
    max_deceleration_ms2: float


class TrainLimits(NamedTuple):
    """A train as the physics of all cells needs it, made once for a meshed line.

    To make such a tuple costs little, but for each cell it would count references to its arrays.

    Parameters
    ----------
    train : Train
        Its plain numbers.
    traction, braking : EffortLimit
        Largest efforts of the drive and of the electric brake.
    drive : array
        Parameters of the drive.
    """

    train: Train
    traction: EffortLimit
    braking: EffortLimit
    drive: FloatArray


class SharedLimits(NamedTuple):
    """A train with its own limits, and those of each cell, for the loops of a compiled function.

    Parameters
    ----------
    own : TrainLimits
        The train with its own limits, which no place lowers.
    place, places
        As in `MeshData`.
    """

    own: TrainLimits
    place: IntArray
    places: PlaceTables


@njit(cache=True)
def train_data(mesh: MeshData) -> Train:
    """Return the plain numbers of a meshed line's train."""
    return Train(
        mesh.drive_kind,
        mesh.recuperation_factor,
        mesh.friction_effort_n,
        mesh.max_acceleration_ms2,
        mesh.max_deceleration_ms2,
    )


@njit(cache=True)
def shared_by_cells(mesh: MeshData) -> SharedLimits:
    """Return the train as the physics of all cells needs it.

    For the loops of a compiled function that has the mesh as an argument: the arrays are `borrowed` from it. Python
    must not call it: there the arrays would outlive the loan.
    """
    traction, braking = borrowed_limit(mesh.traction), borrowed_limit(mesh.braking)
    own = TrainLimits(train_data(mesh), traction, braking, borrowed(mesh.drive_parameters))
    return SharedLimits(own, borrowed(mesh.place), borrowed_tables(mesh.places))


# inlined: to hand over so many arrays takes longer than the physics of a cell
@njit(cache=True, forceinline=True)
def limits_at(shared: SharedLimits, number: int) -> TrainLimits:
    """Return the train as the physics of one cell needs it."""
    place = shared.place[number]
    return shared.own if place == NO_PLACE else _limits_at_place(shared, place)


@njit(cache=True)
def _limits_at_place(shared: SharedLimits, place: int) -> TrainLimits:
    train, places = shared.own.train, shared.places
    return TrainLimits(
        Train(
            train.drive_kind,
            places.recuperation_factor[place],
            places.friction_n[place],
            train.max_acceleration_ms2,
            train.max_deceleration_ms2,
        ),
        limit_at_place(places, TRACTION, place),
        limit_at_place(places, BRAKING, place),
        shared.own.drive,
    )


@njit(cache=True)
def recuperation_at(mesh: MeshData, number: int) -> float:
    """Return the share of the generated energy that the supply takes back in a cell."""
    place = mesh.place[number]
    factor: float = mesh.recuperation_factor if place == NO_PLACE else mesh.places.recuperation_factor[place]
    return factor


@njit(cache=True, error_model="numpy")
def cell_at(mesh: MeshData, number: int) -> Cell:
    """Return one cell of a meshed line."""
    return Cell(
        mesh.cell_length_m[number],
        mesh.half_inertia_kg / mesh.cell_length_m[number],
        mesh.resistance_constant_n + mesh.line_force_n[number],
        mesh.resistance_linear,
        mesh.resistance_quadratic[number],
        mesh.supply_share[number],
        mesh.starting_n,
        mesh.starting_ends_ms,
    )


@njit(cache=True, error_model="numpy")
def scaled_cell_at(mesh: MeshData, number: int, scale: float) -> Cell:
    """Return one cell of a meshed line whose forces come out in shares of an effort [N], as the solver wants them."""
    # the force is linear in k, A, B and C, so that dividing these divides it, at any speeds
    return Cell(
        mesh.cell_length_m[number],
        mesh.half_inertia_kg / (mesh.cell_length_m[number] * scale),
        (mesh.resistance_constant_n + mesh.line_force_n[number]) / scale,
        mesh.resistance_linear / scale,
        mesh.resistance_quadratic[number] / scale,
        mesh.supply_share[number],
        mesh.starting_n / scale,
        mesh.starting_ends_ms,
    )


@njit(cache=True, error_model="numpy")
def can_start(cell: Cell, traction: EffortLimit) -> bool:
    """Return whether the drive overcomes the starting resistance of a standing train; True where it has none."""
    if cell.starting_n <= 0.0:
        return True
    needed: float = cell.constant_n + cell.starting_n
    return supplied_effort(traction, cell.supply_share, NEARLY_AT_REST_MS) > needed


@njit(cache=True, error_model="numpy")
def part_of_cell(cell: Cell, length_m: float) -> Cell:
    """Return a part of a cell [m]: as its force is constant, only its length differs, and inertia over length."""
    # k = m / (2 h)
    inertia = cell.inertia * (cell.length_m / length_m)
    return Cell(
        length_m,
        inertia,
        cell.constant_n,
        cell.linear,
        cell.quadratic,
        cell.supply_share,
        cell.starting_n,
        cell.starting_ends_ms,
    )


def data_between(mesh: MeshData, first: int, last: int) -> MeshData:
    """Return the data of a meshed line between two nodes, over the same mesh."""
    cells = {name: getattr(mesh, name)[first:last] for name in PER_CELL}
    # one node more than cells; of an array that is empty, as `mode` may be, an empty part
    nodes = {name: getattr(mesh, name)[first : last + 1] for name in PER_NODE}
    return mesh._replace(**cells, **nodes)


def all_cells(mesh: MeshData) -> Cell:
    """Return all cells of a meshed line, as arrays of shape (n,)."""
    return Cell(
        mesh.cell_length_m,
        mesh.half_inertia_kg / mesh.cell_length_m,
        mesh.resistance_constant_n + mesh.line_force_n,
        mesh.resistance_linear,
        mesh.resistance_quadratic,
        mesh.supply_share,
        mesh.starting_n,
        mesh.starting_ends_ms,
    )


def at_place(mesh: MeshData, place: int) -> MeshData:
    """Return a meshed line whose train has everywhere the limits of one kind of place."""
    if place == NO_PLACE:
        return mesh
    places = mesh.places
    return mesh._replace(
        traction=places.limit(TRACTION, place),
        braking=places.limit(BRAKING, place),
        friction_effort_n=float(places.friction_n[place]),
        recuperation_factor=float(places.recuperation_factor[place]),
    )


def recuperation_factors(mesh: MeshData) -> FloatArray:
    """Return the share of the generated energy that the supply takes back in each cell; shape (n,)."""
    return np.append(mesh.places.recuperation_factor, mesh.recuperation_factor)[mesh.place]


def friction_limits_n(mesh: MeshData) -> FloatArray:
    """Return the largest effort of the friction brakes in each cell [N]; shape (n,)."""
    return np.append(mesh.places.friction_n, mesh.friction_effort_n)[mesh.place]


def tractive_limit_n(mesh: MeshData, speed_ms: FloatArray) -> FloatArray:
    """Return the largest tractive effort [N] of each cell at speeds above zero [m/s], of shape (n,) or (n, k)."""
    return _supplied_n(mesh, TRACTION, speed_ms)


def electric_limit_n(mesh: MeshData, speed_ms: FloatArray) -> FloatArray:
    """Return the largest electric braking effort [N] of each cell; speeds as for `tractive_limit_n`."""
    return _supplied_n(mesh, BRAKING, speed_ms)


def _supplied_n(mesh: MeshData, side: int, speed_ms: FloatArray) -> FloatArray:
    supplied = np.empty(speed_ms.shape)
    for place in np.unique(mesh.place).tolist():
        data, cells = at_place(mesh, place), mesh.place == place
        limit = data.traction if side == TRACTION else data.braking
        effort, most = limit.effort_n(speed_ms[cells]), limit.constant_n * mesh.supply_share[cells]
        supplied[cells] = np.minimum(effort, most if effort.ndim == 1 else most[:, None])
    return supplied


def lowered_limits(mesh: MeshData, share: float) -> MeshData:
    """Return a meshed line whose limits of effort, speed and rate of change of speed are lower by a share."""
    # a limit of speed is kept as its square: it is the square that falls by the share
    kept = 1.0 - share
    return mesh._replace(
        limit_speed2=kept * mesh.limit_speed2,
        traction=mesh.traction.lowered(share),
        braking=mesh.braking.lowered(share),
        friction_effort_n=kept * mesh.friction_effort_n,
        places=mesh.places.lowered(share),
        max_acceleration_ms2=kept * mesh.max_acceleration_ms2,
        max_deceleration_ms2=kept * mesh.max_deceleration_ms2,
    )
