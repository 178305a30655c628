"""Limits of effort and recuperation that hold on part of a line, in a form that compiled code takes."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from railjoule.core.arrays import FloatArray, IntArray
from railjoule.core.compiled import borrowed, njit
from railjoule.core.physics.effort_limit import EffortLimit

if TYPE_CHECKING:
    # at run time, each change of the input models would compile the kernels again
    from railjoule.core.scenario.line import RailCondition

NO_PLACE = -1
"""Stands for the places at which a train has its own limits."""
TRACTION, BRAKING = range(2)


class PlaceLimits(NamedTuple):
    """Limits of traction, recuperation and adhesion at a place of a line.

    Parameters
    ----------
    max_effort_n, max_power_w, max_current_a : float
        Largest tractive effort [N], tractive power at the wheels [W] and current from the supply [A]; infinite where
        there is none.
    effort_factor : float
        Share of the largest tractive effort that is left.
    recuperation_factor : float
        Share of the generated energy that the supply takes back at most.
    rail_condition : str or None
        By which adhesion limits the efforts.
    """

    max_effort_n: float = np.inf
    max_power_w: float = np.inf
    max_current_a: float = np.inf
    effort_factor: float = 1.0
    recuperation_factor: float = 1.0
    rail_condition: "RailCondition | None" = None


UNLIMITED = PlaceLimits()
"""The limits of a place that restricts nothing."""


class Efforts(NamedTuple):
    """Largest efforts of a train at one kind of place, and what the supply takes back.

    Parameters
    ----------
    traction, braking : EffortLimit
        Largest efforts of the drive and of the electric brake.
    friction_n : float
        Largest effort of the friction brakes [N].
    recuperation_factor : float
        Share of the generated energy that the supply takes back.
    """

    traction: EffortLimit
    braking: EffortLimit
    friction_n: float
    recuperation_factor: float


class PlaceTables(NamedTuple):
    """The efforts of k kinds of places.

    Tables of one direction have equal shapes: compiled code then takes one of them without a count of references.

    Parameters
    ----------
    constant_n, power_w : array of shape (2, k)
        As in `EffortLimit`, of traction and of the electric brake.
    traction_table, braking_table : array of shape (k, m, 5)
        Tables, ended by pieces that begin at infinite speed; m is 0 where no limit has a table.
    traction_first, braking_first : array of shape (k, s)
        Numbers of first pieces.
    friction_n, recuperation_factor : array of shape (k,)
        As in `Efforts`.
    """

    constant_n: FloatArray
    power_w: FloatArray
    traction_table: FloatArray
    traction_first: IntArray
    braking_table: FloatArray
    braking_first: IntArray
    friction_n: FloatArray
    recuperation_factor: FloatArray

    def limit(self, side: int, place: int) -> EffortLimit:
        """Return the limit of one kind of place; `side` is TRACTION or BRAKING."""
        table = (self.traction_table, self.braking_table)[side][place]
        first = (self.traction_first, self.braking_first)[side][place]
        return EffortLimit(float(self.constant_n[side, place]), float(self.power_w[side, place]), table, first)

    def lowered(self, share: float) -> "PlaceTables":
        """Return tables whose efforts are lower by a share."""
        kept = 1.0 - share
        tables = [table.copy() for table in (self.traction_table, self.braking_table)]
        for table in tables:
            table[:, :, 1:] *= kept
        return self._replace(
            constant_n=kept * self.constant_n,
            power_w=kept * self.power_w,
            traction_table=tables[0],
            braking_table=tables[1],
            friction_n=kept * self.friction_n,
        )


def place_tables(efforts: Sequence[Efforts]) -> PlaceTables:
    """Return the tables of kinds of places; of one direction either all limits have a table or none has."""
    limits = [[one.traction for one in efforts], [one.braking for one in efforts]]
    tables = [_stacked(side) for side in limits]
    return PlaceTables(
        np.array([[limit.constant_n for limit in side] for side in limits]).reshape(2, -1),
        np.array([[limit.power_w for limit in side] for side in limits]).reshape(2, -1),
        *tables[0],
        *tables[1],
        np.array([one.friction_n for one in efforts]),
        np.array([one.recuperation_factor for one in efforts]),
    )


def _stacked(limits: Sequence[EffortLimit]) -> tuple[FloatArray, IntArray]:
    """Return tables and first pieces of limits with equal shapes."""
    pieces = max((len(limit.table) for limit in limits), default=0)
    steps = max((len(limit.first_piece) for limit in limits), default=0)
    table, first = np.zeros((len(limits), pieces, 5)), np.zeros((len(limits), steps), dtype=np.int64)
    table[:, :, 0] = np.inf
    for number, limit in enumerate(limits):
        table[number, : len(limit.table)] = limit.table
        # the last piece goes on
        first[number] = np.pad(limit.first_piece, (0, steps - len(limit.first_piece)), "edge") if steps else 0
    return table, first


@njit(cache=True)
def borrowed_tables(tables: PlaceTables) -> PlaceTables:
    """Return tables whose arrays are `borrowed`, for the loops of a compiled function."""
    return PlaceTables(
        borrowed(tables.constant_n),
        borrowed(tables.power_w),
        borrowed(tables.traction_table),
        borrowed(tables.traction_first),
        borrowed(tables.braking_table),
        borrowed(tables.braking_first),
        borrowed(tables.friction_n),
        borrowed(tables.recuperation_factor),
    )


@njit(cache=True)
def limit_at_place(tables: PlaceTables, side: int, place: int) -> EffortLimit:
    """Return `PlaceTables.limit` in compiled code."""
    table, first = tables.traction_table[place], tables.traction_first[place]
    if side == BRAKING:
        table, first = tables.braking_table[place], tables.braking_first[place]
    return EffortLimit(tables.constant_n[side, place], tables.power_w[side, place], table, first)


NO_TABLES = place_tables(())
