"""The tables of Ftorek et al. 2025 beside ours.

Two of them come out only with a change that the paper does not tell, so each stands here twice: Table 1 with the
work of drag left out of EOC's cost and with the whole cost, Table 3 with a larger and with its own copper loss.
"""

from dataclasses import replace
from functools import partial

from railjoule.core.energy import share_above
from railjoule.core.scenario import Scenario
from railjoule.core.strategies import prepare_task
from railjoule.core.strategies.enoc import (
    acceleration_time_for_peak,
    best_acceleration_time,
    enoc_coefficients,
    enoc_energy,
)
from railjoule.core.strategies.plain_line import PlainLine, plain_line
from railjoule.core.units import J_PER_WH, MS_PER_KMH
from railjoule.core.validation._ftorek_rows import (
    FOLLOWS,
    QUANTITIES,
    TABLE_1,
    TABLE_2,
    Printed,
    as_if_heavier,
    printed_row,
)
from railjoule.core.validation.claim import list_claims
from railjoule.core.validation.claims.ftorek import EXAMINATIONS
from railjoule.core.validation.figures.ftorek import FIGURES
from railjoule.core.validation.ftorek_closed_loop import closed_loop_tables
from railjoule.core.validation.ftorek_nameplate import nameplate
from railjoule.core.validation.ftorek_runs import (
    BASE_TIME_S,
    LAST_DIGIT_POINTS,
    TABLE_3_COPPER_WEIGHT,
    amperes_per_newton,
    change_percent,
    enoc_run,
    eoc_run,
    optimal_run,
    paper,
    paper_scenario,
    run_values,
    surface_minimum,
    table_change_percent,
)
from railjoule.core.validation.papers import citation, errata
from railjoule.core.validation.table import Comparison, Row, Table, Validation

TABLE_3 = "Table 3"
FILTERED = "The current starts with its maximum, a jump, and the paper filtered short transients."
MATCHED_PEAK = (
    "The paper takes the ramps that give EOC's peak speed, (15), which cost {:.1f} % more than ENOC's own best."
)
BEATEN = "The printed run leaves the work of drag out of its cost; with the whole cost, less energy is possible."
NOT_BEATEN = "No less energy is possible."
MISPRINT = "By the paper's own {} it is {:+.2f} %."
PRINTED_TABLES = {"eoc": TABLE_1, "enoc": TABLE_2}
OTHER_WEIGHT = "With the copper loss that fits Table 2 the surface has its minimum elsewhere."


def validate_ftorek() -> Validation:
    """Return all printed results of Ftorek et al. 2025 beside ours."""
    return ftorek_comparison().validation()


def ftorek_comparison(scenario: Scenario | None = None) -> Comparison:
    """Return what is to be compared of Ftorek et al. 2025.

    Parameters
    ----------
    scenario : Scenario, optional
        Train and line of the tables; those of the paper where absent, which claims and figures always take.
    """
    printed, scenario = paper(), scenario or paper_scenario()
    line, amperes = plain_line(prepare_task(scenario)), amperes_per_newton(scenario)
    return Comparison(
        paper="ftorek",
        citation=citation(printed),
        tables=(
            partial(eoc_as_printed, line, amperes, printed["table_1"]),
            partial(true_optimum, line, scenario, printed["true_optimum"]),
            partial(claimed_optimum, scenario, printed["table_1"]),
            partial(enoc_as_printed, line, amperes, printed["table_2"]),
            partial(enoc_at_its_best, line, printed["table_2"]),
            # the first comparison of a number is the one that counts, and the larger copper loss was matched to these
            partial(surface_points, line, printed["table_3"], 1.0),
            partial(surface_points, line, printed["table_3"], TABLE_3_COPPER_WEIGHT),
            *closed_loop_tables(scenario, printed),
            partial(headline_percentages, line, amperes, printed["change_percent"]),
            partial(nameplate, scenario, printed["nameplate"]),
        ),
        errata=errata(printed),
        claims=list_claims(printed, EXAMINATIONS),
        figures=FIGURES,
    )


def eoc_as_printed(line: PlainLine, amperes: float, printed: list[Printed]) -> Table:
    """Return Table 1 beside EOC without the work of drag in its cost."""
    rows: list[Row] = []
    for entry in printed:
        values = run_values(eoc_run(line, entry["travel_time_s"]), amperes)
        notes = _notes(entry, values) | {"max_current_a": FILTERED}
        rows += [printed_row(TABLE_1, entry, key, number, notes.get(key, "")) for key, number in values.items()]
    return Table("EOC as printed, the work of drag left out of its cost", tuple(rows), TABLE_1)


def _notes(entry: Printed, values: dict[str, float]) -> dict[str, str]:
    """Return the notes on the energies of a run, by their keys in the paper's file."""
    shaft = as_if_heavier(entry, values["shaft_energy_wh"])
    return {"shaft_energy_wh": shaft, "peak_energy_wh": FOLLOWS, "total_energy_wh": FOLLOWS}


def true_optimum(line: PlainLine, scenario: Scenario, reference: list[Printed]) -> Table:
    """Return the optimum with the whole cost, by the boundary value problem and by the interior point."""
    rows: list[Row] = []
    for entry in reference:
        eoc = eoc_run(line, entry["travel_time_s"], "optimal")
        optimal = optimal_run(scenario, entry["travel_time_s"])
        row = partial(printed_row, "", entry)
        rows += [
            row("max_speed_kmh", float(eoc.speed_ms.max()) / MS_PER_KMH, by="eoc"),
            row("max_speed_kmh", optimal.max_speed_kmh, by="optimal"),
            row("total_energy_wh", eoc.total_energy_j / J_PER_WH, by="eoc"),
            row("total_energy_wh", optimal.energy.net_j / J_PER_WH, by="optimal"),
        ]
    return Table("The true optimum of the same runs, with the whole cost", tuple(rows), reference="independent")


def claimed_optimum(scenario: Scenario, printed: list[Printed]) -> Table:
    """Return what Table 1 claims to be the least energy beside what is possible."""
    rows = []
    for entry in printed:
        least = optimal_run(scenario, entry["travel_time_s"]).energy.net_j / J_PER_WH
        note = BEATEN if least < entry["total_energy_wh"] else NOT_BEATEN
        rows.append(printed_row(TABLE_1, entry, "total_energy_wh", least, note))
    return Table("EOC, as published, against the optimum", tuple(rows), TABLE_1)


def enoc_as_printed(line: PlainLine, amperes: float, printed: list[Printed]) -> Table:
    """Return Table 2 beside ENOC with the printed acceleration times, and (15) beside ours."""
    coefficients = enoc_coefficients(line)
    rows: list[Row] = []
    for entry in printed:
        time, ramp, peak = entry["travel_time_s"], entry["acceleration_time_s"], entry["max_speed_kmh"] * MS_PER_KMH
        energy = float(enoc_energy(coefficients, time, ramp)) / J_PER_WH
        values = run_values(enoc_run(line, time), amperes) | {"total_energy_wh": energy}
        columns = {"acceleration_time_s": acceleration_time_for_peak(coefficients, time, peak)} | values
        notes = _notes(entry, values)
        rows += [printed_row(TABLE_2, entry, key, number, notes.get(key, "")) for key, number in columns.items()]
    return Table("ENOC with the printed acceleration times", tuple(rows), f"{TABLE_2}, (12), (15)")


def headline_percentages(line: PlainLine, amperes: float, printed: list[Printed]) -> Table:
    """Return the changes of section 3 beside those of railjoule: 10 % less and 10 % more time than 300 s."""
    rows: list[Row] = []
    for entry in printed:
        strategy, time = entry["strategy"], entry["travel_time_s"]
        case = f"{strategy.upper()}, T_m = {time} s against {BASE_TIME_S} s"
        for key, number in change_percent(line, amperes, strategy, time).items():
            symbol, own = QUANTITIES[key][0], table_change_percent(strategy, time, key)
            misprint = abs(own - entry[key]) > LAST_DIGIT_POINTS
            note = MISPRINT.format(PRINTED_TABLES[strategy], own) if misprint else ""
            rows.append(Row(case, symbol, "%", entry[key], number, note, f"section 3, {case}, {symbol}"))
    return Table("Changes with 10 % less and 10 % more time", tuple(rows), "section 3, section 4")


def enoc_at_its_best(line: PlainLine, printed: list[Printed]) -> Table:
    """Return what Table 2 prints beside ENOC with its own best acceleration time."""
    coefficients = enoc_coefficients(line)
    rows: list[Row] = []
    for entry in printed:
        ramp = best_acceleration_time(coefficients, entry["travel_time_s"])
        energy = float(enoc_energy(coefficients, entry["travel_time_s"], ramp))
        theirs = float(enoc_energy(coefficients, entry["travel_time_s"], entry["acceleration_time_s"]))
        note = MATCHED_PEAK.format(100 * share_above(theirs, energy))
        rows += [
            printed_row(TABLE_2, entry, "acceleration_time_s", ramp, note),
            printed_row(TABLE_2, entry, "total_energy_wh", energy / J_PER_WH, note),
        ]
    return Table("ENOC with its own best acceleration time", tuple(rows), f"{TABLE_2}, (13)")


def surface_points(line: PlainLine, printed: list[Printed], copper_weight: float) -> Table:
    """Return Table 3 beside ENOC's energy surface, with the copper loss times `copper_weight`."""
    # two tables from one function: that with the own copper loss explains in each row why it differs
    own = copper_weight == 1.0
    note, energy_note = (OTHER_WEIGHT, OTHER_WEIGHT) if own else ("", FOLLOWS)
    # the weight acts on (12) alone: a vehicle with more resistance would change its closed loop as well
    coefficients = enoc_coefficients(replace(line, loss_coefficient=copper_weight * line.loss_coefficient))

    longest, ramp = surface_minimum(coefficients)
    minimum, case = printed[0], "the minimum"
    rows = [
        Row(case, "T_m", "s", minimum["travel_time_s"], longest, note, f"{TABLE_3}, T_m"),
        Row(case, "T_e", "s", minimum["acceleration_time_s"], ramp, note, f"{TABLE_3}, T_e"),
    ]
    for point in printed:
        energy = float(enoc_energy(coefficients, point["travel_time_s"], point["acceleration_time_s"]))
        source = f"{TABLE_3}, {point['point']}"
        rows.append(Row(point["point"], "W_T", "Wh", point["total_energy_wh"], energy / J_PER_WH, energy_note, source))
    least = float(enoc_energy(coefficients, minimum["travel_time_s"], minimum["acceleration_time_s"]))
    for point in printed[1:]:
        energy = float(enoc_energy(coefficients, point["travel_time_s"], point["acceleration_time_s"]))
        source = f"{TABLE_3}, {point['point']}, increase"
        above = 100 * share_above(energy, least)
        rows.append(Row(point["point"], "above red", "%", point["increase_percent"], above, note, source))
    words = "the copper loss of Table 2" if own else f"{copper_weight:g} times the copper loss of Table 2"
    return Table(f"Points of ENOC's energy surface, with {words}", tuple(rows), TABLE_3)
