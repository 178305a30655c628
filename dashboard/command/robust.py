"""`railjoule study robust`: the plan with the least expected energy that is on time with a chosen probability."""

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from railjoule.core.studies.robust_plan import Candidate, DrawnRuns, RobustPlan, find_robust_plan
from railjoule.core.studies.rows import worker_count
from railjoule.dashboard.command.commands import (
    LABELLED_SUFFIXES,
    Output,
    load,
    refusals_named,
    shortened,
    table_file,
    write_labelled_table,
    write_table,
)
from railjoule.dashboard.command.summary import Summary
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

if TYPE_CHECKING:
    import argparse


def study_robust(options: "argparse.Namespace", changes: Mapping[str, Any]) -> None:
    """Find the robust plan of a scenario, write the table of its candidates, and show it beside the scenario's plan.

    Raises
    ------
    RailjouleError
        If anything is wrong with the scenario or a file, or no plan is on time as often as it should be.
    """
    path = table_file(options.output, "-o", LABELLED_SUFFIXES)
    trajectory = None if options.trajectory is None else table_file(options.trajectory)
    scenario = load(options.file, changes)
    with ThreadPoolExecutor(worker_count(), "study") as executor, refusals_named(scenario.strategy):
        found = find_robust_plan(scenario, options.probability, options.candidates, executor)
    write_labelled_table(found.to_table().to_xarray(), path)
    if trajectory is not None and found.chosen is not None:
        write_table(found.chosen.plan.to_dataframe(), trajectory, index=False)
    Output(options.json).show(summarise_robust(found), lambda values: _text(values, str(path)))


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
    return {
        "load_factor": candidate.load_factor,
        "resistance_factor": candidate.resistance_factor,
        "reserve_s": candidate.reserve_s,
        "planned_kwh": candidate.plan.energy_kwh,
        "planned_time_s": candidate.plan.travel_time_s,
        "search": _runs(candidate.drawn),
        "check": _runs(checked),
    }


def _runs(drawn: DrawnRuns) -> Summary:
    low, high = drawn.share_interval
    return {
        "runs": drawn.runs,
        "expected_kwh": drawn.expected_kwh,
        "share_on_time": drawn.share_on_time,
        "share_interval": [low, high],
    }


def _text(values: Summary, file: str) -> str:
    """Return the robust plan and the scenario's plan as a table, and whether the check holds."""
    accepted = values["accepted_delay_s"]
    late = f", at most {number(accepted)} s late" if accepted else ""
    header = (
        "plan",
        "load, %",
        "resistance",
        "reserve, s",
        "search, kWh",
        "on time, %",
        "check, kWh",
        "on time, %",
        "interval",
    )
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
