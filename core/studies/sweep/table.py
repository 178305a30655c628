"""The entry of a sweep: all its rows as one table in memory."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path

from railjoule.core.scenario import Scenario, as_scenario
from railjoule.core.studies.sweep.columns import DEFAULT_COLUMNS
from railjoule.core.studies.sweep.results import MemoryResults, SweepTable, table_of
from railjoule.core.studies.sweep.running import run_study
from railjoule.core.studies.sweep.sampling import Method
from railjoule.core.studies.sweep.study import study_of


def sweep(
    scenario: Scenario | str | Path,
    over: Mapping[str, tuple[float, float]],
    sample: int,
    method: Method = "sobol",
    *,
    seed: int = 0,
    strategy: str | None = None,
    columns: Sequence[str] = DEFAULT_COLUMNS,
    executor: Executor | None = None,
    workers: Callable[[], int] | None = None,
    progress: Callable[[int], None] | None = None,
) -> SweepTable:
    """Return runs of a scenario whose numbers vary, as one table.

    A row is the same as that of `solve` for the scenario with its values, and does not depend on the executor. A study
    that is to outlive the process is made by `study_of`, kept in a `SweepFile`, and run by `run_study`.

    Parameters
    ----------
    scenario : Scenario, str or Path
        Where all other numbers stand: a scenario, the name of a shipped one, or the path of a file.
    over : mapping of str to (float, float)
        Lowest and highest value of each field, by its path in the file, such as "vehicle.load_factor".
    sample : int
        How many rows.
    method : str
        How they are drawn: "grid", "random", "sobol" or "halton".
    seed : int
        The same seed draws the same rows; a grid needs none.
    strategy : str, optional
        Overrides the scenario's own.
    columns : sequence of str
        What is told of each run, of `COLUMNS`.
    executor, workers, progress
        As in `run_study`.

    Raises
    ------
    ScenarioError
        If a field is unknown or no number, its range leads out of its bounds, there is no such method, strategy or
        column, or the table would be too large. A row that cannot be driven stands in the table with its reason.
    InterruptedStudyError
        As `run_study`.
    """
    study = study_of(as_scenario(scenario), over, sample, method, seed=seed, strategy=strategy, columns=columns)
    results = MemoryResults(study)
    run_study(results, executor=executor, workers=workers, progress=progress)
    return table_of(results)
