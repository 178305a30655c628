"""An independent check of a run: from the scenario's own keys and the equations, with none of the product's kernels.

It checks whether motion, efforts, powers, times and sums of a run are consistent, and keep every limit of scenario,
vehicle and motors. Each rule has its largest deviation, as a share of a stated scale, and its tolerance. The equations
and their sources stand in the modules: `train` (masses, line, running resistance), `motion`, `efforts`,
`account`, and the drives' loss models in `drives`, `loss_map`, `induction` and `synchronous`. import-linter verifies
that none of it imports a drive, a solver or the energy balance that it checks.

It cannot judge whether the vehicle's data are right, nor whether a run could be cheaper; the bound is only compared
with the energy. The shortest running times of a timetable with a reserve are those of `fastest`. The losses of
synchronous motors are exact here and tabulated in the product, so that they agree only within a share of the losses,
`synchronous.TABLE_ACCURACY`.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from railjoule.core.check.case import Case
from railjoule.core.check.efforts import effort_findings, switching_findings
from railjoule.core.check.energy_balance import balance_findings, power_findings
from railjoule.core.check.motion import find_disorder, motion_findings
from railjoule.core.check.record import Record, record_of_run, record_of_table
from railjoule.core.check.result import Check, CheckResult, Finding, Unchecked
from railjoule.core.scenario import Scenario
from railjoule.core.units import MS_PER_KMH

__all__ = ["Check", "CheckResult", "Unchecked", "check_run", "check_table"]


def check_run(
    scenario: Scenario, run: Any, *, initial_speed_ms: float | None = None, final_speed_ms: float | None = None
) -> CheckResult:
    """Return how well a run keeps the rules of its scenario.

    Parameters
    ----------
    scenario : Scenario
        Of the run.
    run : Trajectory
        Or anything with its fields.
    initial_speed_ms, final_speed_ms : float, optional
        Speeds at the ends of the run [m/s]; those of the timetable where absent.
    """
    return _check(scenario, record_of_run(run), initial_speed_ms, final_speed_ms)


def check_table(
    scenario: Scenario,
    table: Mapping[str, Any],
    strategy: str | None = None,
    *,
    initial_speed_ms: float | None = None,
    final_speed_ms: float | None = None,
) -> CheckResult:
    """Return how well the nodes of a run keep the rules of its scenario, as far as a table has values.

    Parameters
    ----------
    scenario : Scenario
        Of the run.
    table : mapping of str to array of nodes
        Columns as `Trajectory.to_dataframe` has them, of which position_m, time_s and speed_kmh must be there.
    strategy : str, optional
        Of the run, the scenario's where absent: some may be late.
    initial_speed_ms, final_speed_ms : float, optional
        Speeds at the ends of the run [m/s]; those of the timetable where absent.

    Raises
    ------
    ScenarioError
        If a column that must be there is missing, or one holds no numbers.
    """
    record = record_of_table(table, scenario.vehicle, strategy or scenario.strategy)
    return _check(scenario, record, initial_speed_ms, final_speed_ms)


def _check(scenario: Scenario, record: Record, initial_ms: float | None, final_ms: float | None) -> CheckResult:
    timetable = scenario.timetable
    entry = timetable.entry_speed_kmh * MS_PER_KMH if initial_ms is None else initial_ms
    leaving = timetable.exit_speed_kmh * MS_PER_KMH if final_ms is None else final_ms
    # a table may hold numbers of any size: an overflow breaks a rule, and needs no warning
    with np.errstate(all="ignore"):
        findings = list(_findings(Case(scenario, record, entry, leaving)))
    checks = tuple(finding for finding in findings if isinstance(finding, Check))
    return CheckResult(checks, tuple(finding for finding in findings if isinstance(finding, Unchecked)))


def _findings(case: Case) -> Iterator[Finding]:
    # Later rules compare and integrate: with a NaN every comparison is false and a broken rule would look kept, and
    # with places that fall back the cells have no length to divide by. So each of the first two ends the check.
    for rule, reason in (
        (_count_not_finite, "the run has numbers that are not finite"),
        (find_disorder, "places, times or speeds fall where they must not"),
    ):
        found = rule(case)
        yield found
        if not found.ok:
            yield Unchecked("all other rules", reason)
            return
    for findings in (motion_findings, effort_findings, switching_findings, power_findings, balance_findings):
        yield from findings(case)


def _count_not_finite(case: Case) -> Check:
    """Count the numbers that are not finite; an array of cells counts at the nodes where its cells begin."""
    wrong = [~np.isfinite(values) for values in case.record.numbers()]
    nodes = [int(np.argmax(one)) for one in wrong if len(one) > 1 and one.any()]
    # the places themselves may be none
    place = float(case.record.position_m[min(nodes)]) if nodes else np.nan
    total = float(sum(one.sum() for one in wrong))
    return Check("finite numbers", total, 0.0, place if np.isfinite(place) else None, "one number")
