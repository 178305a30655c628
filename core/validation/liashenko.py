"""The tables and figures of Liashenko, Yatsko 2025 beside ours."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.validation.claim import list_claims
from railjoule.core.validation.claims.liashenko import EXAMINATIONS
from railjoule.core.validation.figures.liashenko import FIGURES
from railjoule.core.validation.liashenko_runs import (
    LEAST_SHOWN,
    ComparedTable,
    above_own_time,
    both_directions,
    compared_table,
    example,
    paper_numbers,
    rms,
)
from railjoule.core.validation.papers import citation, errata
from railjoule.core.validation.table import Comparison, Row, Table, Validation

BY_PLAN, BY_LOAD = "overconsumption", "above a plan for the actual load"
"""Quantities of the two measures: the paper's own (12), and one without the change of load."""
ASSUMED = "The paper prints no controller, effort or resistance. They are assumed here, and none is fitted to it."
SMALL_PERCENT = 1e-6
"""A plan and its own run differ by less than this [%]."""


def validate_liashenko() -> Validation:
    """Return Tables 4 to 7 of Liashenko, Yatsko 2025 and the examples of Figures 3 to 6 beside ours."""
    return liashenko_comparison().validation()


def liashenko_comparison() -> Comparison:
    """Return the tables, claims and figures of Liashenko, Yatsko 2025, not computed yet."""
    paper = paper_numbers()
    return Comparison(
        paper="liashenko",
        citation=citation(paper),
        tables=(
            *(partial(overconsumption, entry["place"]) for entry in paper["table"]),
            partial(examples, tuple(figure["place"] for figure in paper["figure"])),
        ),
        errata=errata(paper),
        claims=list_claims(paper, EXAMINATIONS),
        figures=FIGURES,
    )


def overconsumption(place: str) -> Table:
    """Return one of Tables 4 to 7 beside ours by both measures, and the root mean squares of the differences."""
    table = compared_table(place)
    measures = (
        (BY_PLAN, table.by_plan, [_plan_note(table, k) for k in range(len(table.loads))]),
        (BY_LOAD, table.by_load, [_late_note(table, k) for k in range(len(table.loads))]),
    )
    rows = []
    for (m, k), printed in np.ndenumerate(table.printed):
        case = f"{table.errors_m[m]:+g} m, load {table.loads[k]:g}"
        for quantity, values, notes in measures:
            note = ASSUMED if quantity == BY_LOAD and values[m, k] >= 0 else notes[k]
            note = note if abs(values[m, k] - printed) > LEAST_SHOWN else ""
            rows.append(Row(case, quantity, "%", float(printed), float(values[m, k]), note, f"{place}, {case}"))
    title = f"{table.scenario.title}, 35 km/h, followed with wrong load and position, by two measures"
    return Table(title, (*rows, *summary_rows(table)), place)


def _plan_note(table: ComparedTable, k: int) -> str:
    """Return the note on the rows by (12) of one load."""
    change, mass = table.load_change[k], 100 * table.mass_change(table.loads[k])
    if k == table.planned_load:
        return ASSUMED
    if mass > 0:
        return f"The plan for a train {mass:.1f} % heavier needs {change:.1f} % more, and (12) counts that as well."
    note = f"The plan for a train {-mass:.1f} % lighter needs {-change:.1f} % less, and (12) counts that as well."
    below = table.by_plan[:, k] < 0
    if not below.any():
        return note
    return f"{note} Rows below zero: {_arrival(table.delay_s[below, k], table.stop_error_m[below, k])}."


def _arrival(delay_s: FloatArray, stop_error_m: FloatArray) -> str:
    """Return how late runs are and how far from the stop they stand."""
    late, missed = float(np.max(delay_s)), float(np.max(np.abs(stop_error_m)))
    arrival = f"at most {late:.1f} s late" if late >= LEAST_SHOWN else "not late"
    return f"{arrival}, stopping error at most {missed:.2f} m"


def _late_note(table: ComparedTable, k: int) -> str:
    """Return the note on the rows of one load below zero against the plan for the actual load."""
    below = table.by_load[:, k] < -SMALL_PERCENT
    if not below.any():
        return ASSUMED
    changes = {"disturbance.actual_load_factor": float(table.loads[k])}
    above = [
        above_own_time(both_directions(table.scenario, **changes, **{"disturbance.coordinate_error_m": float(error)}))
        for error in table.errors_m[below]
    ]
    return _own_time_sentence(float(np.max(table.delay_s[below, k])), above)


def _own_time_sentence(delay_s: float, above: Sequence[float]) -> str:
    """Return the reason of runs below zero that are late, with the shares of `above_own_time`."""
    return (
        f"Below zero, as the run is up to {delay_s:.1f} s late: against a plan for its load that takes as long it lies "
        f"{' to '.join(dict.fromkeys(f'{100 * share:.1f}' for share in (min(above), max(above))))} % above."
    )


def summary_rows(table: ComparedTable) -> list[Row]:
    """Return the root mean square of the differences of a table by each measure, with the nearer one."""
    by_plan, by_load = rms(table.by_plan - table.printed), rms(table.by_load - table.printed)
    nearer = f"Nearer in this table: {'(12)' if by_plan < by_load else 'the plan for the actual load'}."
    case, unit = "root mean square of the differences", "percentage points"
    corners = " ".join(_corner_sentence(table, k) for k in (0, len(table.loads) - 1))
    return [Row(case, BY_PLAN, unit, None, by_plan, corners), Row(case, BY_LOAD, unit, None, by_load, nearer)]


def _corner_sentence(table: ComparedTable, k: int) -> str:
    """Return the printed number at a load without a position error beside both measures."""
    row = table.planned_error
    printed, by_plan, by_load = (float(one[row, k]) for one in (table.printed, table.by_plan, table.by_load))
    measures = (("(12)", by_plan), ("the plan for the actual load", by_load))
    same = [name for name, ours in measures if ours * printed > 0]
    return (
        f"Load {table.loads[k]:g}, 0 m: printed {printed:+.1f} %, by (12) {by_plan:+.1f} %, against the plan for the "
        f"actual load {by_load:+.1f} %. Sign as printed: {' and '.join(same) or 'neither'}."
    )


def examples(places: tuple[str, ...]) -> Table:
    """Return the plans of Figures 3 to 6 and the runs that follow them."""
    rows = []
    for place in places:
        one = example(place)
        run, own = one.following, one.own_plan
        less = -100 * (own.energy_kwh / run.planned.energy_kwh - 1)
        delay = f"{abs(run.delay_s):.1f} s {'late' if run.delay_s > 0 else 'early'}"
        lighter = f"Below zero: the plan for the lighter train needs {less:.1f} % less. The run is {delay}."
        late = _own_time_sentence(run.delay_s, [above_own_time((one.scenario,))]) if one.by_load < 0 else ""
        rows += [
            Row(place, "planned energy", "kWh", None, run.planned.energy_kwh),
            Row(place, BY_PLAN, "%", None, 100 * run.overconsumption, lighter if run.overconsumption < 0 else ""),
            Row(place, BY_LOAD, "%", None, 100 * one.by_load, late),
            Row(place, "delay", "s", None, run.delay_s),
            Row(place, "stopping error", "m", None, run.stop_error_m),
        ]
    return Table("Examples of followed plans; no numbers are printed", tuple(rows))
