"""The cost of a wrong rotor resistance in the motor control: energy, current and tracking over its factor.

Source: the question of Ftorek et al. 2025, Figure 1, whose control needs the rotor's resistance for the angle of its
flux; a warm rotor has up to half more than a cold one.
"""

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor

import numpy as np

from railjoule.core.errors import InfeasibleLineError, ScenarioError, SolverError
from railjoule.core.scenario import Scenario
from railjoule.core.simulation.field_oriented import simulate_field_oriented
from railjoule.core.strategies import solve
from railjoule.core.studies.rows import RowByRow, rows_in_order
from railjoule.core.studies.table import StudyTable
from railjoule.core.trajectory import Trajectory

# 0.67 to 1.5 is what temperature does; the rest shows where the loop fails
FACTORS = (0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, 2.0)
COLUMNS = ("energy_kwh", "magnetising_loss_kwh", "max_current_a", "max_phase_voltage_v", "max_tracking_error_m")


def detuning_steps(
    scenario: Scenario,
    factors: Sequence[float] = FACTORS,
    plan: Trajectory | None = None,
    executor: Executor | None = None,
) -> Iterator[StudyTable]:
    """Yield a table over the rotor resistance that the control assumes: empty, and again after each run.

    The label is `rotor_resistance_factor`. The columns are `energy_kwh`, the input energy of the machines,
    `magnetising_loss_kwh`, the part that the current of the flux loses in the stator, `max_current_a`,
    `max_phase_voltage_v`, and `max_tracking_error_m`, the largest distance from the planned place. NaN stands where the
    loop does not hold the train.

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
    if not factors:
        raise ScenarioError("a table over the rotor resistance needs at least one factor.")
    # all of them before the first run: a factor out of its bounds is no result
    variants = {float(factor): scenario.replace(**{"simulation.rotor_resistance_factor": factor}) for factor in factors}
    # one plan for all factors: only the control differs in the table
    planned = plan if plan is not None else solve(scenario)

    def simulated(sample: Sequence[float]) -> tuple[float, ...]:
        (factor,) = sample
        run = simulate_field_oriented(variants[factor], planned)
        peaks = run.max_current_a, run.max_phase_voltage_v, run.max_tracking_error_m
        return run.energy_by_input_power_kwh, run.magnetising_loss_kwh, *peaks

    # a loop that loses the train is a result of this study and no error of it: its row stays NaN
    work = RowByRow(simulated, len(COLUMNS), (InfeasibleLineError, SolverError))
    labels = {"rotor_resistance_factor": tuple(factors)}
    attributes = {"title": scenario.title, "strategy": scenario.strategy}
    values = np.full((len(factors), len(COLUMNS)), np.nan)
    for rows in rows_in_order(work, np.array(factors, dtype=float)[:, None], executor):
        done = len(rows.values)
        values[:done] = rows.values
        columns = dict(zip(COLUMNS, values.T, strict=True))
        yield StudyTable(scenario, labels, columns, attributes, done)
