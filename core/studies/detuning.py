"""The cost of a wrong rotor resistance in the motor control: energy, current and tracking over its factor.

Source: the question of Ftorek et al. 2025, Figure 1, whose control needs the rotor's resistance for the angle of its
flux; a warm rotor has up to half more than a cold one.
"""

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from railjoule.core.arrays import FloatArray, frozen_array
from railjoule.core.errors import InfeasibleLineError, ScenarioError, SolverError
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.field_oriented import simulate_field_oriented
from railjoule.core.strategies import solve
from railjoule.core.studies.sweep.rows import RowByRow
from railjoule.core.studies.sweep.running import rows_in_order
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import J_PER_KWH

if TYPE_CHECKING:
    import xarray

# 0.67 to 1.5 is what temperature does; the rest shows where the loop fails
FACTORS = (0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, 2.0)
UNITS = {
    "energy_kwh": "kWh",
    "magnetising_loss_kwh": "kWh",
    "max_current_a": "A",
    "max_phase_voltage_v": "V",
    "max_tracking_error_m": "m",
}
"""The columns of the table, in order."""


@dataclass(frozen=True, eq=False)
class DetuningTable:
    """Runs over k factors; NaN where the loop does not hold the train, and where nothing is computed yet.

    Parameters
    ----------
    scenario : Scenario
        The simulated scenario, but for the factor.
    rotor_resistance_factors : tuple of float
        Rotor resistance that the control assumes, over the true one.
    energy_kwh, magnetising_loss_kwh : array of shape (k,)
        Input energy of the machines, and the part that the flux's current loses in the stator [kWh].
    max_current_a, max_phase_voltage_v : array of shape (k,)
        Peaks [A, V].
    max_tracking_error_m : array of shape (k,)
        Largest distance from the planned place [m].
    done : int
        Number of computed runs.
    """

    scenario: Scenario
    rotor_resistance_factors: tuple[float, ...]
    energy_kwh: FloatArray
    magnetising_loss_kwh: FloatArray
    max_current_a: FloatArray
    max_phase_voltage_v: FloatArray
    max_tracking_error_m: FloatArray
    done: int = 0

    def to_dataset(self) -> "xarray.Dataset":
        """Return the table with its labels and units."""
        import xarray  # noqa: PLC0415  (slow to import)

        return xarray.Dataset(
            {name: (("rotor_resistance_factor",), getattr(self, name), {"units": u}) for name, u in UNITS.items()},
            coords={"rotor_resistance_factor": list(self.rotor_resistance_factors)},
            attrs={"title": self.scenario.title, "strategy": self.scenario.strategy},
        )


def detuning(
    scenario: Scenario,
    factors: Sequence[float] = FACTORS,
    plan: Trajectory | None = None,
    executor: Executor | None = None,
) -> DetuningTable:
    """Return energy, current, voltage and tracking over the rotor resistance that the control assumes.

    Parameters
    ----------
    scenario : Scenario
        The simulated scenario, but for the factor.
    factors : sequence of float
        Assumed over true rotor resistance.
    plan : Trajectory, optional
        The run to follow; the scenario's own strategy where absent.
    executor : Executor, optional
        Executor of the runs; by default this thread.

    Raises
    ------
    RailjouleError
        As `railjoule.core.simulation.field_oriented.simulate_field_oriented`.
    """
    *_, last = detuning_steps(scenario, factors, plan, executor)
    return last


def detuning_steps(
    scenario: Scenario,
    factors: Sequence[float] = FACTORS,
    plan: Trajectory | None = None,
    executor: Executor | None = None,
) -> Iterator[DetuningTable]:
    """Yield the table of `detuning` empty, and again after each run; arguments and errors as there."""
    if not factors:
        raise ScenarioError("a table over the rotor resistance needs at least one factor.")
    # all of them before the first run: a factor out of its bounds is no result
    for factor in factors:
        _variant(scenario, factor)
    # one plan for all factors: only the control differs in the table
    planned = plan if plan is not None else solve(scenario)
    values = np.full((len(UNITS), len(factors)), np.nan)
    yield _table(scenario, factors, values, 0)
    # a loop that loses the train is a result of this study and no error of it: its column stays NaN
    work = RowByRow(partial(_simulated, scenario, planned), len(UNITS), (InfeasibleLineError, SolverError))
    for rows in rows_in_order(work, np.array(factors, dtype=float)[:, None], executor):
        done = len(rows.values)
        values[:, :done] = rows.values.T
        yield _table(scenario, factors, values, done)


def _table(scenario: Scenario, factors: Sequence[float], values: FloatArray, done: int) -> DetuningTable:
    energy, magnetising, current, voltage, tracking = map(frozen_array, values)
    return DetuningTable(scenario, tuple(factors), energy, magnetising, current, voltage, tracking, done)


def _variant(scenario: Scenario, factor: float) -> Scenario:
    return scenario.replace(**{"simulation.rotor_resistance_factor": float(factor)})


def _simulated(
    scenario: Scenario, planned: Trajectory, factor: Sequence[float]
) -> tuple[float, float, float, float, float]:
    run = simulate_field_oriented(_variant(scenario, *factor), planned)
    return (
        float(run.energy_by_input_power_j[-1]) / J_PER_KWH,
        run.magnetising_loss_kwh,
        run.max_current_a,
        run.max_phase_voltage_v,
        run.max_tracking_error_m,
    )
