"""What wrong load and wrong place cost: the energy of a followed plan over load factor and coordinate error.

Source: Liashenko, Yatsko 2025, (12) and Tables 4 to 7.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from railjoule.core.errors import InfeasibleLineError, SolverError, TimetableError
from railjoule.core.scenario import Scenario
from railjoule.core.simulate.following import follow, plan_for
from railjoule.core.trajectory import Trajectory

if TYPE_CHECKING:
    import xarray

LOAD_FACTORS = (0.0, 0.25, 0.5, 0.75, 1.0)
COORDINATE_ERRORS_M = (-25.0, -20.0, -10.0, 0.0, 10.0, 20.0, 25.0)
"""Those of the paper."""


def sensitivity(
    scenario: Scenario,
    load_factors: Sequence[float] = LOAD_FACTORS,
    coordinate_errors_m: Sequence[float] = COORDINATE_ERRORS_M,
    both_directions: bool = True,
    replan: bool = False,
) -> "xarray.Dataset":
    """Return energy, overconsumption (12), delay and stopping error over load factor and coordinate error.

    Parameters
    ----------
    scenario : Scenario
        The plan is for its load; its own disturbance counts but for load and place.
    load_factors : sequence of float
        Loads really carried, of length k.
    coordinate_errors_m : sequence of float
        Errors of the place [m], of length m.
    both_directions : bool
        Whether the line is driven there and back, as in (12).
    replan : bool
        Whether each load has a plan of its own, as if the train knew what it carries.

    Returns
    -------
    xarray.Dataset
        Dimensions load_factor and coordinate_error_m: energy_kwh, overconsumption (over the plan for the scenario's
        own load), over_replanned (over the plan of a train that knows its load), delay_s (the later arrival) and
        stop_error_m (the larger in size); NaN where the real train cannot pass the line.

    Raises
    ------
    RailjouleError
        As `railjoule.core.solve` for the plan.
    """
    import xarray  # noqa: PLC0415  (slow to import, and seldom needed)

    ways = [scenario, _turned(scenario)] if both_directions else [scenario]
    plans = [plan_for(way) for way in ways]
    planned = sum(plan.energy_kwh for plan in plans)
    values = np.full((3, len(load_factors), len(coordinate_errors_m)), np.nan)
    knowing = np.full(len(load_factors), np.nan)
    for k, load in enumerate(load_factors):
        loaded = [way.with_(**{"disturbance.actual_load_factor": load}) for way in ways]
        own = _plans_knowing(load, ways)
        knowing[k] = np.nan if own is None else sum(plan.energy_kwh for plan in own)
        followed = own if replan else plans
        for m, error in enumerate(coordinate_errors_m):
            changes = {"disturbance.coordinate_error_m": error}
            if followed is not None:
                values[:, k, m] = _followed(followed, [way.with_(**changes) for way in loaded])
    dimensions = ("load_factor", "coordinate_error_m")
    return xarray.Dataset(
        {
            "energy_kwh": (dimensions, values[0], {"units": "kWh"}),
            "overconsumption": (dimensions, values[0] / planned - 1, {"units": "1"}),
            "over_replanned": (dimensions, values[0] / knowing[:, None] - 1, {"units": "1"}),
            "delay_s": (dimensions, values[1], {"units": "s"}),
            "stop_error_m": (dimensions, values[2], {"units": "m"}),
        },
        coords={"load_factor": list(load_factors), "coordinate_error_m": list(coordinate_errors_m)},
        attrs={
            "title": scenario.title,
            "strategy": scenario.strategy,
            "planned_load_factor": scenario.vehicle.load_factor,
            "planned_energy_kwh": planned,
            "both_directions": int(both_directions),
            "replanned": int(replan),
        },
    )


def _plans_knowing(load_factor: float, ways: list[Scenario]) -> list[Trajectory] | None:
    """Return the plans of a train that knows its load, or None if there are none."""
    try:
        return [plan_for(way.with_(**{"vehicle.load_factor": load_factor})) for way in ways]
    except (InfeasibleLineError, TimetableError, SolverError):
        return None


def _turned(scenario: Scenario) -> Scenario:
    return scenario.with_(**{"line.reverse": not scenario.line.reverse})


def _followed(plans: list[Trajectory], ways: list[Scenario]) -> tuple[float, float, float]:
    """Return energy [kWh], delay [s] and stopping error [m] of all ways together; NaN if one cannot be driven."""
    try:
        driven = [follow(plan, way) for plan, way in zip(plans, ways, strict=True)]
    except InfeasibleLineError:
        return np.nan, np.nan, np.nan
    errors = [error for one in driven for error in one.stop_errors_m]
    return sum(one.actual.energy_kwh for one in driven), max(one.delay_s for one in driven), max(errors, key=abs)
