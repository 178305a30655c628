"""`railjoule study`: many variants of a scenario as a labelled table, and the plan that is robust against chance.

The sweep, which may take hours and a cluster, has a module of its own.
"""

import argparse
import math
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

from railjoule.core import Scenario
from railjoule.core.strategies import prepare_task
from railjoule.core.studies import (
    StudyTable,
    assumption_effects,
    energy_time_frontier,
    frontier_times,
    monte_carlo,
    study_braking_sensors,
)
from railjoule.core.studies import sensitivity as sensitivity_of
from railjoule.core.studies.montecarlo import punctuality
from railjoule.core.studies.robust_plan import Candidate, DrawnRuns, RobustPlan, find_robust_plan
from railjoule.core.studies.rows import worker_count
from railjoule.dashboard.command import files
from railjoule.dashboard.command.files import refusals_named, show
from railjoule.dashboard.command.summary import Summary, picked
from railjoule.dashboard.command.terminal import (
    delay,
    energy,
    energy_difference,
    number,
    share,
    table_lines,
    title_words,
    wrapped,
)
from railjoule.dashboard.command.values import shortened


@contextmanager
def _workers(scenario: Scenario) -> Iterator[Executor]:
    """Yield what computes runs; a refusal of the scenario's strategy names it."""
    with ThreadPoolExecutor(worker_count(), "study") as executor, refusals_named(scenario.strategy):
        yield executor


def _study(options: argparse.Namespace, compute: Callable[[Scenario, Executor], StudyTable]) -> StudyTable:
    """Write the table of a study, print its shape, and return it."""
    scenario = files.scenario(options)
    with _workers(scenario) as executor:
        found = compute(scenario, executor)
    table = found.to_xarray()
    files.write_labelled_table(table, options.output)
    shape = " x ".join(f"{size} {dimension}" for dimension, size in table.sizes.items())
    print(f"{shortened(options.output)}: {shape}")
    return found


def tradeoff(options: argparse.Namespace) -> None:
    """Solve a scenario for many travel times."""

    def frontier(scenario: Scenario, executor: Executor) -> StudyTable:
        task = prepare_task(scenario)
        return energy_time_frontier(task, frontier_times(task), executor=executor)

    _study(options, frontier)


def sensitivity(options: argparse.Namespace) -> None:
    """Drive a plan with other loads and errors of place than planned."""
    _study(options, lambda scenario, executor: sensitivity_of(scenario, executor=executor))


def montecarlo(options: argparse.Namespace) -> None:
    """Drive a plan under what chance brings."""
    rows = [
        (
            row.place,
            delay(row.mean_delay_s),
            delay(row.late_delay_s),
            share(row.share_on_time),
            "" if row.energy_kwh is None else energy(row.energy_kwh),
        )
        for row in punctuality(_study(options, monte_carlo))
    ]
    if rows:
        header = ("arrival", "mean delay, s", "95 % at most, s", "on time, %", "mean energy, kWh")
        print("\n".join(table_lines(header, rows)))


def assumptions(options: argparse.Namespace) -> None:
    """Solve with each assumed value of the vehicle too low and too high, and list the effects."""
    scenario = files.scenario(options)
    with _workers(scenario) as executor:
        table = assumption_effects(scenario, executor=executor)
    files.write_labelled_table(table.to_xarray(), options.output)
    change = share(table.change)
    rows = [
        (name.removeprefix("vehicle."), *map(_difference, differences))
        for name, *differences in zip(
            table.assumption, table["lower_value_difference"], table["higher_value_difference"], strict=True
        )
    ]
    print(f"{title_words(scenario.title)}: {energy(table.energy_kwh)} kWh; change in per cent if a value is off\n")
    for (name, *cells), basis, reason in zip(rows, table.bases, table.reasons, strict=True):
        print("\n".join(wrapped(f"{cells[0]:>7} {cells[1]:>7}  {name}: {basis}. {reason}".rstrip())))
    print(f"\nLeft: {change} % lower, right: {change} % higher; of efficiencies the losses.")
    print(f"{shortened(options.output)}: {len(rows)} assumptions")


def _difference(part: float) -> str:
    return "-" if math.isnan(part) else f"{100 * part:+.1f}".replace("-0.0", "+0.0")


def braking(options: argparse.Namespace) -> None:
    """Stop with errors of the braking sensors, with precision braking and without."""
    _study(options, lambda scenario, executor: study_braking_sensors(scenario, executor).table)


def robust(options: argparse.Namespace) -> None:
    """Find the robust plan of a scenario, write the table of its candidates, and show it beside the scenario's plan."""
    scenario = files.scenario(options)
    with _workers(scenario) as executor:
        found = find_robust_plan(scenario, options.probability, options.candidates, executor)
    files.write_labelled_table(found.to_table().to_xarray(), options.output)
    if options.trajectory is not None and found.chosen is not None:
        files.write_table(found.chosen.plan.to_dataframe(), options.trajectory)
    show(options, summarise_robust(found), lambda values: _text(values, options.output))


def summarise_robust(found: RobustPlan) -> Summary:
    """Return the robust plan of a whole search beside the scenario's plan as plain values."""
    assert found.chosen is not None
    assert found.checked is not None
    extra, error = found.extra_kwh
    return {
        "title": found.scenario.title,
        "strategy": found.scenario.strategy,
        "probability": found.probability,
        "accepted_delay_s": found.scenario.disturbance.accepted_delay_s,
        "candidates": len(found.candidates),
        "refused": found.refused,
        "nominal": _plan(found.nominal, found.checked[0]),
        "robust": _plan(found.chosen, found.checked[1]),
        "extra_kwh": extra,
        "extra_error_kwh": error,
        "is_held": found.is_held,
    }


def _plan(candidate: Candidate, checked: DrawnRuns) -> Summary:
    drawn = {"search": candidate.drawn, "check": checked}
    return {
        **picked(candidate, "load_factor", "resistance_factor", "reserve_s"),
        "planned_kwh": candidate.plan.energy_kwh,
        "planned_time_s": candidate.plan.travel_time_s,
        **{
            name: {**picked(runs, "runs", "expected_kwh", "share_on_time"), "share_interval": list(runs.share_interval)}
            for name, runs in drawn.items()
        },
    }


def _text(values: Summary, file: Path) -> str:
    """Return the robust plan and the scenario's plan as a table, and whether the check holds."""
    accepted = values["accepted_delay_s"]
    late = f", at most {number(accepted)} s late" if accepted else ""
    costs = ("search, kWh", "on time, %", "check, kWh", "on time, %")
    header = ("plan", "load, %", "resistance", "reserve, s", *costs, "interval")
    rows = [_row(name, values[name]) for name in ("nominal", "robust")]
    search, check = values["robust"]["search"], values["robust"]["check"]
    held = "is" if values["is_held"] else "is not"
    return "\n".join(
        [
            f"{title_words(values['title'])}: robust plan, on time with {share(values['probability'])} %{late}",
            "",
            *table_lines(header, rows),
            "",
            *wrapped(
                f"Of {values['candidates']:,} plans the robust one has the least expected energy of those on time in "
                f"{search['runs']:,} draws. In the check by {check['runs']:,} other draws it needs "
                f"{energy_difference(values['extra_kwh'])} ± {number(values['extra_error_kwh'], 4)} kWh against the "
                f"nominal plan, and it {held} on time in at least {share(values['probability'])} % of the runs. "
                "Intervals are those of 95 %."
            ),
            f"{shortened(file)}: {values['candidates']} candidates",
        ]
    )


def _row(name: str, plan: Summary) -> tuple[str, ...]:
    search, check = plan["search"], plan["check"]
    low, high = check["share_interval"]
    return (
        name,
        number(100 * plan["load_factor"]),
        number(plan["resistance_factor"], 3),
        delay(plan["reserve_s"]).removeprefix("+"),
        energy(search["expected_kwh"]),
        share(search["share_on_time"]),
        energy(check["expected_kwh"]),
        share(check["share_on_time"]),
        f"{share(low)} to {share(high)}",
    )
