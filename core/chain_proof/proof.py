"""A lower bound of all runs with one effort in each cell, that tightens level by level.

Weak duality: for a price of time lambda >= 0 every run in time needs E >= sum(e_i + L tau_i) - lambda T, L = lambda
plus the auxiliary power. Each of its cells lies in a box of its mode, whose planes lie below e_i and tau_i, so that
the value of the best chain of boxes less lambda T lies below E, whatever the prices. A box whose best chain is not
below a target is dropped for good: each run through it needs at least the target. The others are halved. So every run
needs at least the lesser of target and value, and the target itself once no box is left.
"""

import math

import numpy as np

from railjoule.core.arrays import FloatArray, midpoints
from railjoule.core.chain_proof.boxes import Pairs, fill_boxes
from railjoule.core.chain_proof.chain import chain
from railjoule.core.chain_proof.grid import all_pairs, first_grid, halved
from railjoule.core.chain_proof.prices import interval_prices, worth_of_speed
from railjoule.core.chain_proof.table import DriveTable, tabulate
from railjoule.core.physics.mesh_data import MeshData

MAX_LEVELS = 12
SEARCHED_LEVEL = 2
"""From this level on other prices are tried: before, planes are too coarse to tell."""
MAX_TRIALS = 3
FIRST_STEP = 0.03
"""By which share the price of time changes at first."""


class ChainProof:
    """A proof that is continued level by level; its bound holds at any time.

    Parameters
    ----------
    mesh : MeshData
        Its machines are on or off for whole cells.
    running_time_s : float
        Time allowed, dwells not included [s].
    fastest2, slowest2 : array of shape (n + 1,)
        Squares of the greatest speeds of any run, and of the least that are covered [m2/s2].
    around2 : array of shape (n + 1,)
        Squares of speed of a good run: around it the first intervals are narrow [m2/s2].
    node_price : array of shape (n + 1,)
        Slopes of the cost to go by the square of speed [J s2/m2]. Any prove a bound.
    price_of_time_w : float
        Price of a second, without auxiliaries [J/s].
    target_j : float
        The bound to be proven, which is never exceeded [J].
    """

    def __init__(
        self,
        mesh: MeshData,
        running_time_s: float,
        fastest2: FloatArray,
        slowest2: FloatArray,
        around2: FloatArray,
        node_price: FloatArray,
        price_of_time_w: float,
        target_j: float,
    ) -> None:
        self._mesh, self._running_time_s = mesh, running_time_s
        self._node_price, self._price = np.array(node_price), max(price_of_time_w, 0.0)
        self.target_j, self.bound_j, self.boxes = target_j, -math.inf, 0
        self.levels = 0
        self._step = FIRST_STEP
        self._table = drive_table(mesh, fastest2, slowest2)
        self._around_ms, self._window = np.sqrt(around2), worth_of_speed(mesh, self._table)
        self._grid = first_grid(mesh, fastest2, slowest2, around2)
        self._pairs = all_pairs(mesh, self._grid)

    @property
    def proven(self) -> bool:
        """Whether the target is proven."""
        return self.bound_j >= self.target_j

    @property
    def next_boxes(self) -> int:
        """Number of boxes in the next level."""
        return len(self._pairs.start)

    def may_advance(self, budget: int) -> bool:
        """Return whether there is something left to prove, and a budget of boxes in all is enough for a level more."""
        return not self.proven and 0 < self.next_boxes <= budget - self.boxes and self.levels < MAX_LEVELS

    def advance(self) -> float:
        """Do one level more: boxes of the present intervals, chains, then halves of what is left; return the bound."""
        grid = self._grid
        second = self._price + self._mesh.auxiliary_power_w
        prices = interval_prices(self._node_price, self._around_ms, self._window, grid.low, grid.high)
        boxes, rows = fill_boxes(self._mesh, self._table, grid, self._pairs, prices, second)
        value, through = self._search(boxes, rows, prices)
        alive = through < self.target_j
        self.boxes += self.next_boxes
        self._grid, self._pairs = halved(grid, boxes, alive)
        if self.levels == 0 and not math.isfinite(value):
            # nothing is dropped yet, so that there is no run to prove anything of
            value = -math.inf
        elif not alive.any() or (self._grid.counts == 0).any():
            # no run is left below the target
            value = math.inf
        self.bound_j = max(self.bound_j, min(value, self.target_j))
        self.levels += 1
        return self.bound_j

    def _search(self, boxes: Pairs, rows: FloatArray, prices: FloatArray) -> tuple[float, FloatArray]:
        """Return the greatest value of some prices [J], and the best chains through each box less the time's price."""
        best, through, price = -math.inf, np.zeros(0), self._price
        trials = MAX_TRIALS if self.levels >= SEARCHED_LEVEL else 1
        for _ in range(trials):
            second, paid_j = price + self._mesh.auxiliary_power_w, price * self._running_time_s
            value, values, time_s = chain(self._grid, boxes, rows, prices, second)
            if value - paid_j > best:
                best, through, late = value - paid_j, values - paid_j, time_s - self._running_time_s
                self._price = price
            else:
                self._step *= 0.5
            if best >= self.target_j:
                break
            price = max(self._price * (1.0 + math.copysign(self._step, late)), 0.0)
        return best, through


def drive_table(mesh: MeshData, fastest2: FloatArray, slowest2: FloatArray) -> DriveTable:
    """Return the table of a meshed line's drive for all mean speeds of cells between two runs' squares of speed."""
    fixed = mesh.fixed_speed2 >= 0.0
    slow = np.sqrt(np.where(fixed, mesh.fixed_speed2, slowest2))
    fastest = math.sqrt(float(max(fastest2.max(), np.nanmax(mesh.fixed_speed2))))
    # a little beyond both, so that rounding leaves no speed outside
    return tabulate(mesh, 0.999 * float(midpoints(slow).min()), 1.001 * fastest)
