"""What wrong load and wrong place cost: the energy of a followed plan over load factor and coordinate error.

Source: Liashenko, Yatsko 2025, (12) and Tables 4 to 7.
"""

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.energy import share_above
from railjoule.core.errors import InfeasibleLineError, ScenarioError
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.following import follow, plan_for, plan_knowing_load
from railjoule.core.studies.sweep.rows import RowByRow
from railjoule.core.studies.sweep.running import rows_in_order
from railjoule.core.trajectory import Trajectory

if TYPE_CHECKING:
    import xarray

LOAD_FACTORS = (0.0, 0.25, 0.5, 0.75, 1.0)
COORDINATE_ERRORS_M = (-25.0, -20.0, -10.0, 0.0, 10.0, 20.0, 25.0)
"""Those of the paper."""

Knows = Literal["nothing", "load", "place", "both"]
"""What the train learns before its start, so that it replans in each cell."""
DIMENSIONS = ("load_factor", "coordinate_error_m")
RESULTS = 3
"""Energy, delay and stopping error."""


@dataclass(frozen=True, eq=False)
class SensitivityTable:
    """Energy, delay and stopping error over k loads really carried and m errors of the place.

    NaN stands where the real train cannot pass the line, and in cells that are not computed yet.

    Parameters
    ----------
    scenario : Scenario
        The plan is for its load.
    both_directions : bool
        Whether the line is driven there and back, as in (12).
    knows : str
        What the train knows.
    load_factors, coordinate_errors_m : tuple of float
        Loads, of length k, and errors [m], of length m.
    planned_kwh : float
        Energy of the plan [kWh].
    replanned_kwh : array of shape (k,)
        Energy of the plans of a train that knows its load [kWh].
    energy_kwh, delay_s, stop_error_m : array of shape (k, m)
        Energy as driven [kWh], the later arrival [s], the stopping error that is larger in size [m].
    done : int
        How many cells are computed, in the order of the loads.
    """

    scenario: Scenario
    both_directions: bool
    knows: Knows
    load_factors: tuple[float, ...]
    coordinate_errors_m: tuple[float, ...]
    planned_kwh: float
    replanned_kwh: FloatArray
    energy_kwh: FloatArray
    delay_s: FloatArray
    stop_error_m: FloatArray
    done: int = 0

    @property
    def overconsumption(self) -> FloatArray:
        """Energy over that of the plan, less 1; shape (k, m)."""
        return share_above(self.energy_kwh, self.planned_kwh)

    @property
    def over_replanned(self) -> FloatArray:
        """Energy over that of the plan of a train that knows its load, less 1; shape (k, m)."""
        return share_above(self.energy_kwh, self.replanned_kwh[:, None])

    def to_dataset(self) -> "xarray.Dataset":
        """Return the table with its labels and units."""
        import xarray  # noqa: PLC0415  (slow to import, and seldom needed)

        columns = {
            "energy_kwh": (self.energy_kwh, "kWh"),
            "overconsumption": (self.overconsumption, "1"),
            "over_replanned": (self.over_replanned, "1"),
            "delay_s": (self.delay_s, "s"),
            "stop_error_m": (self.stop_error_m, "m"),
        }
        return xarray.Dataset(
            {name: (DIMENSIONS, values, {"units": unit}) for name, (values, unit) in columns.items()},
            coords={"load_factor": list(self.load_factors), "coordinate_error_m": list(self.coordinate_errors_m)},
            attrs={
                "title": self.scenario.title,
                "strategy": self.scenario.strategy,
                "planned_load_factor": self.scenario.vehicle.load_factor,
                "planned_energy_kwh": self.planned_kwh,
                "both_directions": int(self.both_directions),
                "knows": self.knows,
            },
        )


def sensitivity(
    scenario: Scenario,
    load_factors: Sequence[float] = LOAD_FACTORS,
    coordinate_errors_m: Sequence[float] = COORDINATE_ERRORS_M,
    both_directions: bool = True,
    knows: Knows = "nothing",
    executor: Executor | None = None,
) -> SensitivityTable:
    """Return energy, overconsumption (12), delay and stopping error over load factor and coordinate error.

    Parameters
    ----------
    scenario : Scenario
        The plan is for its load; its own disturbance counts but for load and place.
    load_factors : sequence of float
        Loads really carried.
    coordinate_errors_m : sequence of float
        Errors of the place [m].
    both_directions : bool
        Whether the line is driven there and back, as in (12).
    knows : str
        What the train learns before its start, so that it replans: its load, its place, both or nothing.
    executor : Executor, optional
        What does the runs; by default this thread.

    Raises
    ------
    ScenarioError
        If a load factor lies outside 0 to the vehicle's crush load, or an error of the place beyond the distance
        between two stops.
    RailjouleError
        As `railjoule.core.solve` for the plan.
    """
    *_, last = sensitivity_steps(scenario, load_factors, coordinate_errors_m, both_directions, knows, executor)
    return last


def sensitivity_steps(
    scenario: Scenario,
    load_factors: Sequence[float] = LOAD_FACTORS,
    coordinate_errors_m: Sequence[float] = COORDINATE_ERRORS_M,
    both_directions: bool = True,
    knows: Knows = "nothing",
    executor: Executor | None = None,
) -> Iterator[SensitivityTable]:
    """Yield the table of `sensitivity` empty, and again after each cell; arguments and errors as there."""
    most = scenario.vehicle.crush_load_factor
    wrong = next((load for load in load_factors if not 0 <= load <= most), None)
    if wrong is not None:
        raise ScenarioError(f"a load factor of the table = {wrong:g} must lie between 0 and {most:g}.")
    directions = [scenario, _reversed(scenario)] if both_directions else [scenario]
    plans = [plan_for(direction) for direction in directions]
    shape = len(load_factors), len(coordinate_errors_m)
    replanned, values = np.full(shape[0], np.nan), np.full((RESULTS, *shape), np.nan)
    table = SensitivityTable(
        scenario,
        both_directions,
        knows,
        tuple(load_factors),
        tuple(coordinate_errors_m),
        sum(plan.energy_kwh for plan in plans),
        frozen_array(replanned),
        *(frozen_array(values[0]),) * 3,
    )
    yield table
    # load by load: all errors of one load share its plans, which cost more than the runs that follow them
    cells = np.array([(load, error) for load in load_factors for error in coordinate_errors_m]).reshape(-1, 2)
    for rows in rows_in_order(RowByRow(_Cells(directions, plans, knows).run, 1 + RESULTS, ()), cells, executor):
        done = len(rows.values)
        values.reshape(RESULTS, -1)[:, :done] = rows.values[:, 1:].T
        known = rows.values[:: shape[1], 0]
        replanned[: len(known)] = known
        yield replace(
            table,
            replanned_kwh=frozen_array(replanned),
            energy_kwh=frozen_array(values[0]),
            delay_s=frozen_array(values[1]),
            stop_error_m=frozen_array(values[2]),
            done=done,
        )


class _Cells:
    """Makes the cells of a table.

    Parameters
    ----------
    directions : list of Scenario
        What is driven.
    plans : list of Trajectory
        For each direction, for the scenario's own load.
    knows : str
    """

    def __init__(self, directions: list[Scenario], plans: list[Trajectory], knows: Knows) -> None:
        self._directions, self._plans, self._knows = directions, plans, knows
        # two threads may both plan for a load: they find the same
        self._own: dict[float, list[Trajectory]] = {}

    def run(self, cell: Sequence[float]) -> tuple[float, float, float, float]:
        """Return the energy of the load's own plans [kWh], then energy [kWh], delay [s] and stopping error [m]."""
        load, error_m = cell
        own = self._own.get(load)
        if own is None:
            planned = (plan_knowing_load(direction, load) for direction in self._directions)
            own = self._own[load] = [plan for plan in planned if plan is not None]
        # (12) is over both directions: with one of them infeasible the sum would be that of half a journey
        complete = len(own) == len(self._directions)
        replanned = sum(plan.energy_kwh for plan in own) if complete else np.nan
        followed = self._plans if self._knows in {"nothing", "place"} else own if complete else None
        if followed is None:
            return replanned, np.nan, np.nan, np.nan
        assumed_m = 0.0 if self._knows in {"place", "both"} else error_m
        real = [_disturbed(direction, load, assumed_m) for direction in self._directions]
        return replanned, *_followed(followed, real)


def _disturbed(direction: Scenario, load_factor: float, error_m: float) -> Scenario:
    update = {"actual_load_factor": load_factor, "coordinate_error_m": error_m}
    return direction.model_copy(update={"disturbance": direction.disturbance.model_copy(update=update)})


def _reversed(scenario: Scenario) -> Scenario:
    return scenario.replace(**{"line.reverse": not scenario.line.reverse})


def _followed(plans: list[Trajectory], directions: list[Scenario]) -> tuple[float, float, float]:
    """Return energy [kWh], delay [s] and stopping error [m] of all directions together; NaN if one cannot be driven."""
    try:
        driven = [follow(plan, direction) for plan, direction in zip(plans, directions, strict=True)]
    except InfeasibleLineError:
        return np.nan, np.nan, np.nan
    errors = [error for one in driven for error in one.stop_errors_m]
    # (12) adds energies; delays and stopping errors do not add, so the worse direction stands for both
    return sum(one.actual.energy_kwh for one in driven), max(one.delay_s for one in driven), max(errors, key=abs)
