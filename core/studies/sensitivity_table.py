"""The cost of a wrong load and a wrong place: energy of a followed plan over load factor and coordinate error.

Source: Liashenko, Yatsko 2025, (12) and Tables 4 to 7.
"""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from functools import cache
from typing import Literal

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.energy import share_above
from railjoule.core.errors import InfeasibleLineError, ScenarioError
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.following import follow, plan_for, plan_knowing_load
from railjoule.core.studies.rows import RowByRow, rows_in_order
from railjoule.core.studies.table import StudyTable
from railjoule.core.trajectory import Trajectory

LOAD_FACTORS = (0.0, 0.25, 0.5, 0.75, 1.0)
COORDINATE_ERRORS_M = (-25.0, -20.0, -10.0, 0.0, 10.0, 20.0, 25.0)
"""The values of the paper."""

Knows = Literal["nothing", "load", "place", "both"]
"""Facts that the train gets before its start, so that it replans in each cell."""
RESULTS = 3
"""Energy, delay and stopping error."""
Cell = tuple[float, float, float, float]


def sensitivity(
    scenario: Scenario,
    load_factors: Sequence[float] = LOAD_FACTORS,
    coordinate_errors_m: Sequence[float] = COORDINATE_ERRORS_M,
    both_directions: bool = True,
    knows: Knows = "nothing",
    executor: Executor | None = None,
) -> StudyTable:
    """Return energy, overconsumption (12), delay and stopping error over load factor and coordinate error.

    NaN stands where the real train cannot pass the line, and in cells that are not computed yet. The energy of the
    plans that know their load, `replanned_kwh`, has only the dimension of the loads.

    Parameters
    ----------
    scenario : Scenario
        The plan is for its load; its disturbance counts except for load and place.
    load_factors : sequence of float
        Actual loads.
    coordinate_errors_m : sequence of float
        Errors of the position [m].
    both_directions : bool
        Whether the line is driven there and back, as in (12).
    knows : str
        Facts that the train gets before its start, so that it replans: load, place, both or nothing.
    executor : Executor, optional
        Executor of the runs; by default this thread.

    Raises
    ------
    ScenarioError
        If a load factor lies outside 0 to the vehicle's crush load, or an error of the position exceeds the distance
        between two stops.
    RailjouleError
        As in `railjoule.core.solve` for the plan.
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
) -> Iterator[StudyTable]:
    """Yield the table of `sensitivity` empty, and again after each cell; arguments and errors as there."""
    most = scenario.vehicle.crush_load_factor
    wrong = next((load for load in load_factors if not 0 <= load <= most), None)
    if wrong is not None:
        raise ScenarioError(f"a load factor of the table = {wrong:g} must lie between 0 and {most:g}.")
    directions = [scenario]
    if both_directions:
        directions.append(scenario.replace(**{"line.reverse": not scenario.line.reverse}))
    plans = [plan_for(direction) for direction in directions]
    planned_kwh, shape = sum(plan.energy_kwh for plan in plans), (len(load_factors), len(coordinate_errors_m))
    attributes = {
        "title": scenario.title,
        "strategy": scenario.strategy,
        "planned_load_factor": scenario.vehicle.load_share,
        "planned_energy_kwh": planned_kwh,
        "both_directions": int(both_directions),
        "knows": knows,
    }
    # in the order of the loads: all errors of a load share its plans, which cost more than the runs that follow them
    cells = np.array([(load, error) for load in load_factors for error in coordinate_errors_m]).reshape(-1, 2)

    def table(results: FloatArray) -> StudyTable:
        values = np.full((len(cells), 1 + RESULTS), np.nan)
        values[: len(results)] = results
        replanned, energy, delay, stop_error = values.T.reshape(-1, *shape)
        columns = {
            "energy_kwh": energy,
            "overconsumption": share_above(energy, planned_kwh),
            "over_replanned": share_above(energy, replanned[:, :1]),
            "delay_s": delay,
            "stop_error_m": stop_error,
            "replanned_kwh": replanned[:, 0],
        }
        labels = {"load_factor": tuple(load_factors), "coordinate_error_m": tuple(coordinate_errors_m)}
        return StudyTable(scenario, labels, columns, attributes, len(results))

    work = RowByRow(_cell_run(directions, plans, knows), 1 + RESULTS, ())
    for rows in rows_in_order(work, cells, executor):
        yield table(rows.values)


def _cell_run(directions: list[Scenario], plans: list[Trajectory], knows: Knows) -> Callable[[Sequence[float]], Cell]:
    """Return a function that computes a cell from load and error.

    A cell has the energy of the plans for its load [kWh], energy [kWh], delay [s] and stopping error [m].

    Parameters
    ----------
    directions : list of Scenario
    plans : list of Trajectory
        For each direction, for the load of the scenario.
    knows : str
    """

    # two threads may both plan for a load, with equal results
    @cache
    def own_plans(load: float) -> list[Trajectory]:
        return [plan for one in directions if (plan := plan_knowing_load(one, load)) is not None]

    def run(cell: Sequence[float]) -> Cell:
        load, error_m = cell
        own = own_plans(load)
        # (12) is over both directions: with one of them infeasible the sum would be that of half a journey
        complete = len(own) == len(directions)
        replanned = sum(plan.energy_kwh for plan in own) if complete else np.nan
        followed = plans if knows in {"nothing", "place"} else own if complete else []
        place_m = 0.0 if knows in {"place", "both"} else error_m
        update = {"actual_load_factor": load, "actual_load_t": None, "coordinate_error_m": place_m}
        try:
            actual = [
                one.model_copy(update={"disturbance": one.disturbance.model_copy(update=update)}) for one in directions
            ]
            driven = [follow(plan, one) for plan, one in zip(followed, actual, strict=False)]
        except InfeasibleLineError:
            driven = []
        if not driven:
            return replanned, np.nan, np.nan, np.nan
        errors = [error for one in driven for error in one.stop_errors_m]
        # energies add; delays and stopping errors do not, so the worse direction counts
        energy_kwh, delay_s = sum(one.actual.energy_kwh for one in driven), max(one.delay_s for one in driven)
        return replanned, energy_kwh, delay_s, max(errors, key=abs)

    return run
