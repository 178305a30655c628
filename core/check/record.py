"""The numbers of a run as the check takes them, from a trajectory or from a table of its nodes."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.errors import ScenarioError
from railjoule.core.scenario import Vehicle
from railjoule.core.units import J_PER_KWH, MS_PER_KMH, N_PER_KN, W_PER_KW

NEEDED_COLUMNS = ("position_m", "time_s", "speed_kmh")
FEWEST_NODES = 2


@dataclass(frozen=True, eq=False)
class Record:
    """A run with n + 1 nodes and n cells; None where its source does not tell.

    Parameters
    ----------
    strategy : str
        Strategy of the run.
    position_m, speed_ms, time_s : array of nodes
        Places [m], speeds [m/s] and times [s].
    effort_n : array of cells or None
        Effort at the wheels, braking negative [N].
    tractive_effort_n, electric_braking_n, friction_braking_n : array of cells or None
        Its parts, all positive [N].
    supply_power_w : array of cells or None
        Power taken from the line, auxiliaries included [W].
    supply_energy_j : array of nodes or None
        Energy taken from it so far [J].
    gradient_permille : array of cells or None
        Mean gradient under the train.
    current_a : array of cells or None
        Current of one motor [A].
    energies_j, losses_j : mapping of str to float, or None
        The account [J]: its entries but losses, and losses by kind.
    bound_j, gap, price_of_time_w : float or None
        Lower bound of the energy [J], energy over it less 1, and what a second more would save [W].
    """

    strategy: str
    position_m: FloatArray
    speed_ms: FloatArray
    time_s: FloatArray
    effort_n: FloatArray | None = None
    tractive_effort_n: FloatArray | None = None
    electric_braking_n: FloatArray | None = None
    friction_braking_n: FloatArray | None = None
    supply_power_w: FloatArray | None = None
    supply_energy_j: FloatArray | None = None
    gradient_permille: FloatArray | None = None
    current_a: FloatArray | None = None
    energies_j: Mapping[str, float] | None = None
    losses_j: Mapping[str, float] | None = None
    bound_j: float | None = None
    gap: float | None = None
    price_of_time_w: float | None = None

    def numbers(self) -> Iterator[FloatArray]:
        """Yield all numbers of the run; those of the run as a whole as arrays of shape (1,)."""
        for value in (getattr(self, field.name) for field in fields(self)):
            if isinstance(value, Mapping):
                yield from (np.array([joules], dtype=float) for joules in value.values())
            elif isinstance(value, np.ndarray | float):
                yield np.atleast_1d(np.asarray(value, dtype=float))


def record_of_run(run: Any) -> Record:
    """Return the record of a `railjoule.core.Trajectory`, or of anything with its fields."""
    bound = run.bound
    # by name and not by the fields of `Energy`: importing that class would tie the check to what it checks
    energies = {name: float(value) for name, value in vars(run.energy).items() if name != "losses_j"}
    return Record(
        strategy=run.strategy,
        position_m=np.asarray(run.position_m, dtype=float),
        speed_ms=np.asarray(run.speed_ms, dtype=float),
        time_s=np.asarray(run.time_s, dtype=float),
        effort_n=run.tractive_effort_n - run.electric_braking_n - run.friction_braking_n,
        tractive_effort_n=run.tractive_effort_n,
        electric_braking_n=run.electric_braking_n,
        friction_braking_n=run.friction_braking_n,
        supply_power_w=run.supply_power_w,
        supply_energy_j=run.supply_energy_j,
        gradient_permille=run.gradient_permille,
        current_a=run.current_a,
        energies_j=energies,
        losses_j=dict(run.energy.losses_j),
        # a bound whose proof has yet to run has no gap
        bound_j=None if bound is None or run.gap is None else float(bound.energy_j),
        gap=None if bound is None or run.gap is None else float(run.gap),
        price_of_time_w=None if run.price_of_time_w is None else float(run.price_of_time_w),
    )


def record_of_table(table: Mapping[str, Any], vehicle: Vehicle, strategy: str) -> Record:
    """Return the record of a table of nodes, with the columns of `Trajectory.to_dataframe`.

    Parameters
    ----------
    table : mapping of str to array of nodes
        A data frame is one; efforts and powers are those of the cells that begin at the nodes.
    vehicle : Vehicle
        Without friction brakes, all of its braking is electric.
    strategy : str
        Strategy of the run.

    Raises
    ------
    ScenarioError
        If a column is missing or holds no numbers, or there are fewer than two nodes.
    """
    if missing := [name for name in NEEDED_COLUMNS if name not in table]:
        raise ScenarioError(f"has no column {missing[0]}; a run needs at least {', '.join(NEEDED_COLUMNS)}.")
    position, time, speed = (_column(table, name) for name in NEEDED_COLUMNS)
    if len(position) < FEWEST_NODES:
        raise ScenarioError(f"has {len(position)} of at least {FEWEST_NODES} rows that a run needs.")
    # the last row of a table is a node at which no cell begins, and repeats the values of the cell before
    effort = _cells(table, "effort_kn", N_PER_KN)
    electric = friction = None
    if effort is not None and vehicle.braking.friction_effort_kn == 0:
        # one column is enough where a train has one kind of brake
        electric, friction = np.maximum(-effort, 0.0), np.zeros(len(effort))
    return Record(
        strategy=strategy,
        position_m=position,
        speed_ms=speed * MS_PER_KMH,
        time_s=time,
        effort_n=effort,
        tractive_effort_n=None if effort is None else np.maximum(effort, 0.0),
        electric_braking_n=electric,
        friction_braking_n=friction,
        supply_power_w=_cells(table, "line_power_kw", W_PER_KW),
        supply_energy_j=_column(table, "line_energy_kwh") * J_PER_KWH if "line_energy_kwh" in table else None,
        gradient_permille=_cells(table, "gradient_permille", 1.0),
        current_a=_cells(table, "current_a", 1.0),
    )


def _cells(table: Mapping[str, Any], name: str, factor: float) -> FloatArray | None:
    return _column(table, name)[:-1] * factor if name in table else None


def _column(table: Mapping[str, Any], name: str) -> FloatArray:
    try:
        return np.asarray(table[name], dtype=float)
    except (TypeError, ValueError):
        raise ScenarioError(f"holds something that is no number in its column {name}.") from None
