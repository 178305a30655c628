"""Results as plain values for JSON: one shape for the command line, the report and other programs.

The keys are a contract: they may become more, but keep their names and meanings.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from railjoule.core import CheckResult, Comparison, Phase, Trajectory
from railjoule.core.lower_bound import Bound
from railjoule.core.measures import measure
from railjoule.core.units import J_PER_KWH, J_PER_WH, KG_PER_T, MS_PER_KMH
from railjoule.dashboard.look import side_by_side, words
from railjoule.dashboard.work.simple_advice import first_cheap_run

if TYPE_CHECKING:
    from railjoule.core.simulation.actual_run import ActualRun
    from railjoule.core.simulation.field_oriented import FieldOrientedRun
    from railjoule.core.simulation.following import Following
    from railjoule.core.studies.simple_advice import SimpleAdvice
    from railjoule.core.validation import Row, Table, Validation

Summary = dict[str, Any]

EVERY_RUN, MESH_RUNS = "every run", "runs over this mesh"
"""The runs that a bound covers: every driving of the train, or runs over one mesh with one effort in each cell."""
ALTERNATIVE_KEYS = ("quantity", "railjoule", "difference_percent", "difference_points", "note")
"""Keys of a further comparison of a printed number."""


def picked(result: object, *names: str) -> Summary:
    """Return attributes of a result by their names, which are the keys."""
    return {name: getattr(result, name) for name in names}


def _in_kwh(joules: Mapping[str, float]) -> dict[str, float]:
    return {kind: value / J_PER_KWH for kind, value in joules.items()}


def summarise(trajectory: Trajectory, shortest_travel_time_s: float | None = None) -> Summary:
    """Return one run as plain values.

    The losses hold everything that the line's energy is lost to, so that traction - recuperated =
    the sum of all losses + kinetic + potential + magnetic field.

    Parameters
    ----------
    trajectory : Trajectory
        The run.
    shortest_travel_time_s : float, optional
        Shortest possible time of the scenario, dwells included [s].
    """
    energy, known = trajectory.energy, trajectory.reference
    price = trajectory.price_of_time_w
    losses = {
        "running_resistance": energy.running_resistance_j,
        "curve_resistance": energy.curve_resistance_j,
        **energy.losses_j,
    }
    return {
        "title": trajectory.scenario.title,
        "strategy": trajectory.strategy,
        "load_factor": trajectory.scenario.vehicle.load_share,
        "load_t": trajectory.scenario.vehicle.load_mass_kg / KG_PER_T,
        "energy_kwh": trajectory.energy_kwh,
        "traction_energy_kwh": energy.traction_j / J_PER_KWH,
        "recuperated_kwh": energy.recuperated_j / J_PER_KWH,
        "auxiliary_kwh": energy.auxiliary_j / J_PER_KWH,
        "losses_kwh": _in_kwh(losses),
        "kinetic_kwh": energy.kinetic_j / J_PER_KWH,
        "potential_kwh": energy.potential_j / J_PER_KWH,
        "magnetic_field_kwh": energy.magnetic_field_j / J_PER_KWH,
        "travel_time_s": trajectory.travel_time_s,
        "allowed_time_s": trajectory.scenario.travel_time_s,
        "shortest_time_s": shortest_travel_time_s,
        "distance_m": trajectory.distance_m,
        "max_speed_kmh": trajectory.max_speed_kmh,
        "lower_bound_kwh": _finite(trajectory.lower_bound_kwh),
        "gap": _finite(trajectory.gap),
        "proven": trajectory.is_proven,
        **_bound(trajectory.bound),
        "cells": len(trajectory.nodes_m) - 1,
        "reference": known and picked(known, "strategy", "energy_kwh", "within_s", "proven"),
        "above_reference": trajectory.above_share,
        "price_of_time_wh_per_s": None if price is None else price / J_PER_WH,
        "solve_time_s": trajectory.solve_time_s,
        "iterations": trajectory.iterations,
        "phases": [_phase(phase) for phase in trajectory.phases],
        "advice": [asdict(instruction) for instruction in trajectory.advice],
        "arrivals": [
            dict(zip(("station", "position_m", "arrival_s"), arrival, strict=True))
            for arrival in trajectory.station_arrivals
        ],
        "notes": list(trajectory.all_notes),
    }


def summarise_check(result: CheckResult) -> Summary:
    """Return the result of a check as plain values; a deviation without a number is null."""
    return {
        "ok": result.ok,
        "verdict": result.verdict,
        "checks": [
            {**picked(check, "name", "largest", "allowed", "at_m", "share_of"), "largest": _finite(check.largest)}
            for check in result.checks
        ],
        "not_checked": [picked(rule, "name", "reason") for rule in result.not_checked],
    }


def summarise_comparison(found: Comparison) -> Summary:
    """Return several runs over one scenario, and why other strategies refuse it, as plain values."""
    return {
        "results": _summaries(found),
        "refused": [{"strategy": strategy, "reason": reason} for strategy, reason in found.refused.items()],
    }


def _summaries(found: Comparison) -> list[Summary]:
    return [summarise(run, shortest) for run, shortest in zip(found.runs, found.shortest_times_s, strict=True)]


def summarise_pair(found: Comparison) -> Summary:
    """Return the runs of two scenarios with their measures, the differences, and what differs in the scenarios."""
    first, second = found.runs
    return {
        "results": [{**one, **measure(run)} for one, run in zip(_summaries(found), found.runs, strict=True)],
        "differences": side_by_side.differences(first, second),
        "scenarios": words.plain_text(side_by_side.scenarios_differ(first.scenario, second.scenario)),
        "table": [[words.plain_text(cell) for cell in row] for row in side_by_side.pair_rows(first, second)],
    }


def _beside_plan(run: Any) -> Summary:
    """Return a plan and what became of it."""
    return {
        "planned": summarise(run.planned),
        "actual": summarise(run.actual),
        "overconsumption": _finite(run.overconsumption),
        "stop_error_m": run.stop_error_m,
    }


def summarise_following(following: "Following") -> Summary:
    """Return a plan and what became of it as plain values."""
    return {
        **_beside_plan(following),
        "stop_errors_m": list(following.stop_errors_m),
        "delay_s": following.delay_s,
        "notes": list(following.notes),
    }


def summarise_actual(run: "ActualRun") -> Summary:
    """Return a plan and a ride with events as plain values, and what each cause adds to the plan."""
    ride = run.disturbed
    assert ride is not None
    return {
        **_beside_plan(ride),
        "delay_s": run.delay_s,
        "notices": [{"position_m": place, "time_s": time, "event": words} for place, time, words in ride.notices],
        # the ride and the account of its causes may note the same
        "notes": list(dict.fromkeys((*ride.notes, *run.notes))),
        "causes_kwh": {cause.name: cause.energy_kwh for cause in run.causes},
    }


def summarise_field_oriented(run: "FieldOrientedRun") -> Summary:
    """Return a plan and how the machines drove it in closed loop as plain values."""
    return {
        **_beside_plan(run),
        **picked(run, "delay_s", "energy_by_input_power_kwh", "energy_by_parts_kwh"),
        "parts_kwh": _in_kwh(run.parts_j),
        **picked(run, "magnetising_loss_kwh", "max_tracking_error_m", "max_current_a", "max_torque_current_a"),
        **picked(run, "min_torque_current_a", "max_phase_voltage_v", "voltage_limit_v"),
        "saturated": [span._asdict() for span in run.saturated],
        "notes": list(run.notes),
    }


def summarise_validation(validation: "Validation") -> Summary:
    """Return a paper's printed numbers and claims with the values of railjoule.

    The rows have one entry for each printed number: the first comparison, with the others as alternatives. A reference
    that no paper prints, such as the energy of another solver, is no printed number and stands separately.
    """
    return {
        "citation": validation.citation,
        "rows": _rows(validation.tables),
        "claims": [
            {**picked(claim, "place", "claim"), "railjoule": claim.found, **picked(claim, "verdict", "reason")}
            for claim in validation.claims
        ],
        "tables": [
            {**picked(table, "title", "place", "reference"), "rows": [_row(row) for row in table.rows]}
            for table in validation.tables
        ],
        "errata": [asdict(erratum) for erratum in validation.errata],
    }


def _rows(tables: "Sequence[Table]") -> list[Summary]:
    rows: list[Summary] = []
    by_source: dict[str, Summary] = {}
    pairs = ((table, row) for table in tables for row in table.rows)
    for table, row in pairs:
        first = by_source.get(row.source) if row.source else None
        if first is not None:
            values = _row(row)
            first["alternatives"].append({"table": table.title} | {key: values[key] for key in ALTERNATIVE_KEYS})
            continue
        entry = {"table": table.title, "place": table.place, **_row(row), "independent": None, "alternatives": []}
        if row.source:
            by_source[row.source] = entry
        else:
            entry |= {"printed": None, "independent": row.printed}
        rows.append(entry)
    return rows


def _bound(bound: Bound | None) -> Summary:
    """Return which runs a bound covers, and where these are runs over one mesh, what every driving needs at least."""
    if bound is None:
        return {"bound_statement": None, "bound_covers": None}
    covers = EVERY_RUN if bound.covers_every_run else MESH_RUNS
    summary: Summary = {"bound_statement": bound.statement, "bound_covers": covers}
    if not bound.covers_every_run:
        summary["every_run_lower_bound_kwh"] = bound.every_run_j / J_PER_KWH
    return summary


def _phase(phase: Phase) -> Summary:
    return {
        "phase": phase.phase,
        "start_m": phase.start_m,
        "end_m": phase.end_m,
        "start_s": phase.start_s,
        "end_s": phase.end_s,
        "start_kmh": phase.start_ms / MS_PER_KMH,
        "end_kmh": phase.end_ms / MS_PER_KMH,
        "energy_kwh": phase.energy_j / J_PER_KWH,
    }


def _row(row: "Row") -> Summary:
    return {
        **picked(row, "case", "quantity", "unit", "printed"),
        "railjoule": row.value,
        **picked(row, "difference_percent", "difference_points"),
        "close": row.is_close,
        "note": row.note,
    }


def _finite(value: float | None) -> float | None:
    """Return a number that JSON can contain, or None."""
    return value if value is not None and math.isfinite(value) else None


def summarise_advice(advice: "SimpleAdvice", last: bool) -> Summary:
    """Return runs with few changes of regime as plain values, and the orders of one of them.

    Parameters
    ----------
    advice : SimpleAdvice
        The runs, from the fewest changes on.
    last : bool
        Whether the orders are those of the run with the most changes, and not of the first that costs little.
    """
    shown = advice.runs[-1] if last else first_cheap_run(advice)
    return {
        "title": shown.run.scenario.title,
        "optimum_kwh": advice.optimum and advice.optimum.energy_kwh,
        "runs": [
            {
                "changes": run.changes,
                **picked(run.run, "energy_kwh"),
                "price_kwh": _finite(advice.price_kwh(run)),
                **picked(run.run, "travel_time_s"),
            }
            for run in advice.runs
        ],
        "refused": [{"changes": changes, "reason": reason} for changes, reason in advice.refused],
        "changes": shown.changes,
        "advice": [asdict(instruction) for instruction in shown.run.advice],
        "notes": list(shown.run.notes),
    }
