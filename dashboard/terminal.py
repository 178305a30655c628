"""Results as text for a terminal, made from the plain values of `railjoule.dashboard.summary`."""

import shutil
import textwrap
from collections.abc import Iterable, Sequence

from railjoule.dashboard.look.words import PHASE_WORDS, SMALL_ENERGY_KWH, STRATEGY_WORDS, decimals
from railjoule.dashboard.summary import Summary

PROVEN_GAP = 1e-6
"""From this gap on, a run is called proven optimal."""
WIDEST = 110
LABEL_WIDTH = 15
SMALLEST_SHOWN_KWH = 5e-4

Cell = tuple[str, ...]


def number(value: float, digits: int = 1) -> str:
    """Return a number with commas between thousands, and no minus before a zero."""
    text = f"{value:,.{digits}f}"
    return text.lstrip("-") if not text.strip("-0.,") else text


def energy(kwh: float) -> str:
    """Return an energy in kWh: two decimals, three below 5 kWh."""
    return number(kwh, 3 if abs(kwh) < SMALL_ENERGY_KWH else 2)


def printable(text: str) -> str:
    """Return a text of one line without characters that could steer a terminal."""
    return "".join(character if character.isprintable() else " " for character in text)


def title_words(title: str) -> str:
    """Return what a scenario is called."""
    return printable(title) or "Untitled scenario"


def solution_text(summary: Summary) -> str:
    """Return one run for people: energy, proof, time, account, what the driver does."""
    title = title_words(summary["title"])
    lines = [
        f"{title}: {STRATEGY_WORDS[summary['strategy']]}",
        f"{number(summary['distance_m'], 0)} m in {number(summary['travel_time_s'])} s, "
        f"at most {number(summary['max_speed_kmh'])} km/h",
        "",
        *_labelled("Energy", f"{energy(summary['energy_kwh'])} kWh at the line, {gap_words(summary['gap'])}"),
        *_bound_lines(summary),
        *_labelled("Time", _time_words(summary)),
        *_price_lines(summary),
        *_labelled("Driver", phase_words(summary["phases"])),
        "",
        "Account, kWh",
        *_account_lines(summary),
        "",
        f"Solved in {number(1e3 * summary['solve_time_s'])} ms{_iteration_words(summary)}.",
        *_wrapped(" ".join(summary["notes"])),
    ]
    return "\n".join(lines)


def checked_solution_text(summary: Summary) -> str:
    """Return one run for people, with the rules that it breaks, if any, and the verdict of its check."""
    check = summary["check"]
    broken = [each for each in check["checks"] if _is_broken(each)]
    table = ["", *_check_lines(broken)] if broken else []
    return "\n".join([solution_text(summary), *table, *_labelled("Check", check["verdict"])])


def check_text(check: Summary) -> str:
    """Return the rules that a run was held against, those that could not be checked, and the verdict."""
    lines = _check_lines(check["checks"])
    for rule in check["not_checked"]:
        lines += _wrapped(f"Not checked: {rule['name']}: {rule['reason']}.")
    return "\n".join([*lines, "", *_wrapped(check["verdict"])])


def comparison_text(comparison: Summary) -> str:
    """Return several runs over one scenario as a table, and who refused it."""
    results = comparison["results"]
    lines = _comparison_table(results) if results else []
    for refusal in comparison["refused"]:
        lines += _wrapped(_about(STRATEGY_WORDS[refusal["strategy"]], refusal["reason"]))
    for result in results:
        word = STRATEGY_WORDS[result["strategy"]]
        lines += [line for note in result["notes"] for line in _wrapped(_about(word, note))]
    return "\n".join(lines)


def following_text(following: Summary) -> str:
    """Return a plan and what became of it."""
    planned, actual = following["planned"], following["actual"]
    more = following["overconsumption"]
    share = "" if more is None else f"{100 * more:+.2f} % energy, "
    return "\n".join(
        [
            f"{title_words(planned['title'])}: {STRATEGY_WORDS[planned['strategy']]}, followed",
            "",
            *_two_runs({"planned": planned, "driven": actual}),
            "",
            f"{share}{following['delay_s']:+.2f} s, stopped {following['stop_error_m']:+.2f} m from the place.",
            f"Driver: {phase_words(actual['phases'])}",
        ]
    )


def ride_text(ride: Summary) -> str:
    """Return a plan, what the train learned on its way, and the ride."""
    planned, actual = ride["planned"], ride["actual"]
    more = ride["overconsumption"]
    share = "" if more is None else f"{100 * more:+.2f} % energy, "
    learned = [
        f"At {number(notice['position_m'], 0)} m, after {number(notice['time_s'])} s: {notice['event']}."
        for notice in ride["notices"]
    ]
    return "\n".join(
        [
            f"{title_words(planned['title'])}: {STRATEGY_WORDS[planned['strategy']]}, disturbed",
            "",
            *_two_runs({"undisturbed": planned, "driven": actual}),
            "",
            *learned,
            f"{share}{ride['delay_s']:+.2f} s against the timetable.",
            *ride["notes"],
            f"Driver: {phase_words(actual['phases'])}",
        ]
    )


def field_oriented_text(run: Summary) -> str:
    """Return a plan, what the machines made of it, and what that took of current, voltage and energy."""
    planned, actual, parts = run["planned"], run["actual"], run["parts_kwh"]
    more = run["overconsumption"]
    share = "" if more is None else f"{100 * more:+.2f} % energy, "
    rows = [(kind.replace("_", " "), f"{kwh:.4f}") for kind, kwh in parts.items()]
    rows += [
        ("sum of the parts", f"{run['energy_by_parts_kwh']:.4f}"),
        ("input power over time", f"{run['energy_by_input_power_kwh']:.4f}"),
    ]
    tracking = number(run["max_tracking_error_m"], 3)
    current, voltage = number(run["max_current_a"]), number(run["max_phase_voltage_v"], 0)
    return "\n".join(
        [
            f"{title_words(planned['title'])}: {STRATEGY_WORDS[planned['strategy']]}, in closed loop",
            "",
            *_two_runs({"planned": planned, "driven": actual}),
            "",
            f"{share}{run['delay_s']:+.2f} s, stopped {run['stop_error_m']:+.3f} m from the place.",
            f"At most {tracking} m from the planned place, {current} A and {voltage} V of "
            f"{number(run['voltage_limit_v'], 0)} V a phase.",
            "",
            *table_lines(("energy of the machines", "kWh"), rows),
            "",
            *(line for note in run["notes"] for line in _wrapped(note)),
        ]
    )


def _two_runs(runs: dict[str, Summary]) -> list[str]:
    rows = [
        (
            name,
            energy(run["energy_kwh"]),
            number(run["travel_time_s"]),
            number(run["max_speed_kmh"]),
            energy(run["recuperated_kwh"]),
        )
        for name, run in runs.items()
    ]
    return table_lines(("run", "kWh", "time, s", "top, km/h", "recuperated, kWh"), rows)


def validations_text(validations: Summary) -> str:
    """Return all papers' printed numbers beside ours."""
    return "\n\n".join(validation_text(validation) for validation in validations["papers"])


def validation_text(validation: Summary) -> str:
    """Return a paper's printed numbers beside ours, with the reasons of differences as footnotes."""
    lines = _wrapped(validation["citation"])
    for table in validation["tables"]:
        place = f" ({table['place']})" if table["place"] else ""
        lines += ["", f"{table['title']}{place}"]
        lines += _validation_table(table)
    lines += ["", "Errata"]
    for erratum in validation["errata"]:
        words = f"{erratum['place']}: {erratum['printed']} must be {erratum['corrected']}: {erratum['reason']}."
        lines += _wrapped(words, "  ")
    return "\n".join(lines)


def benchmark_text(benchmark: Summary) -> str:
    """Return the times of all solvers, scenario by scenario."""
    rows = []
    results = benchmark["results"]
    before = ""
    for result in results:
        rows.append(
            (
                result["scenario"] if result["scenario"] != before else "",
                number(result["cell_count"], 0) if result["scenario"] != before else "",
                STRATEGY_WORDS.get(result["solver"], result["solver"]),
                f"{result['energy_kwh']:.4f}",
                str(result["iterations"] or ""),
                number(1e3 * result["median_s"], 2),
            )
        )
        before = result["scenario"]
    head = ("scenario", "cells", "solver", "kWh", "iterations", "median, ms")
    lines = table_lines(head, rows, left={0, 2})
    if not benchmark["ipopt"]:
        lines.append("CasADi is not installed, so IPOPT is not beside them: pip install casadi.")
    return "\n".join(lines)


def gap_words(gap: float | None) -> str:
    """Return in words how far a run is from the best."""
    if gap is None:
        return "no bound known"
    if abs(gap) <= PROVEN_GAP:
        return "proven optimal"
    share = f"{100 * abs(gap):.2g} %" if abs(gap) < 0.001 else f"{number(100 * abs(gap), 2)} %"
    return f"{share} above the bound" if gap > 0 else f"{share} under the bound of another mesh"


def phase_words(phases: Sequence[Summary]) -> str:
    """Return what the driver does, such as 'full power to 57 km/h in 21 s, coast from 342 m'."""
    return ", ".join(_one_phase(phase) for phase in phases)


def table_lines(head: Cell, rows: Sequence[Cell], left: Iterable[int] = (0,)) -> list[str]:
    """Return the lines of a table with columns as wide as they need, numbers to the right."""
    to_left = set(left)
    widths = [max(len(row[column]) for row in (head, *rows)) for column in range(len(head))]

    def line(cells: Cell) -> str:
        words = [
            cell.ljust(width) if column in to_left else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(cells, widths, strict=True))
        ]
        return "  ".join(words).rstrip()

    return [line(head), "  ".join("-" * width for width in widths), *(line(row) for row in rows)]


def _one_phase(phase: Summary) -> str:
    name, words = phase["phase"], PHASE_WORDS[phase["phase"]]
    if name in {"full_power", "part_power"}:
        duration = number(phase["end_s"] - phase["start_s"], 0)
        return f"{words} to {number(phase['end_kmh'], 0)} km/h in {duration} s"
    if name == "hold":
        return f"{words} {number(phase['end_kmh'], 0)} km/h to {number(phase['end_m'], 0)} m"
    if name == "stand":
        return f"{words} {number(phase['end_s'] - phase['start_s'], 0)} s at {number(phase['start_m'], 0)} m"
    return f"{words} from {number(phase['start_m'], 0)} m"


def _is_broken(check: Summary) -> bool:
    return check["largest"] is None or bool(check["largest"] > check["allowed"])


def _check_lines(checks: Sequence[Summary]) -> list[str]:
    rows = [
        (
            check["name"],
            "no number" if check["largest"] is None else f"{check['largest']:.2g}",
            f"{check['allowed']:.2g}",
            check["share_of"],
            "" if check["at_m"] is None else number(check["at_m"]),
            "broken" if _is_broken(check) else "",
        )
        for check in checks
    ]
    return table_lines(("rule", "largest deviation", "allowed", "share of", "at, m", ""), rows, left={0, 3, 5})


def _comparison_table(results: Sequence[Summary]) -> list[str]:
    first = results[0]
    rows = [
        (
            STRATEGY_WORDS[result["strategy"]],
            energy(result["energy_kwh"]),
            gap_words(result["gap"]),
            number(result["travel_time_s"]),
            number(result["max_speed_kmh"]),
            energy(result["recuperated_kwh"]),
            number(1e3 * result["solve_time_s"]),
        )
        for result in results
    ]
    head = ("strategy", "kWh", "against the bound", "time, s", "top, km/h", "recuperated, kWh", "solved in, ms")
    return [
        title_words(first["title"]),
        f"{number(first['distance_m'], 0)} m, {_time_words({**first, 'travel_time_s': first['allowed_time_s']})}",
        "",
        *table_lines(head, rows, left={0, 2}),
    ]


def _about(word: str, note: str) -> str:
    """Return a note that names its strategy."""
    return note if note.startswith(word) else f"{word}: {note}"


def _bound_lines(summary: Summary) -> list[str]:
    if summary["lower_bound_kwh"] is None:
        return []
    return _labelled("Bound", f"{energy(summary['lower_bound_kwh'])} kWh. {summary['bound_statement']}")


def _time_words(summary: Summary) -> str:
    words, shortest = f"{number(summary['travel_time_s'])} s", summary["shortest_time_s"]
    if shortest is None:
        return words
    slack = summary["allowed_time_s"] - shortest
    share = number(100 * slack / shortest, 0)
    return (
        f"{words}; shortest possible {number(shortest)} s, allowed {number(summary['allowed_time_s'])} s: "
        f"slack {number(slack)} s ({share} %)"
    )


def _price_lines(summary: Summary) -> list[str]:
    price = summary["price_of_time_wh_per_s"]
    return [] if price is None else _labelled("A second more", f"would save {number(price)} Wh")


def _iteration_words(summary: Summary) -> str:
    return f", {summary['iterations']} iterations" if summary["iterations"] else ""


def _account_lines(summary: Summary) -> list[str]:
    taken = [
        ("traction", summary["traction_energy_kwh"]),
        ("recuperated", -summary["recuperated_kwh"]),
        ("auxiliaries", summary["auxiliary_kwh"]),
    ]
    spent = [(kind.replace("_", " "), kwh) for kind, kwh in summary["losses_kwh"].items()]
    spent += [
        ("kinetic, end less start", summary["kinetic_kwh"]),
        ("potential, end less start", summary["potential_kwh"]),
    ]
    digits = 3 if abs(summary["traction_energy_kwh"]) < SMALL_ENERGY_KWH else 2
    width = max(len(name) for name, _ in taken + spent)

    def lines(entries: list[tuple[str, float]]) -> list[str]:
        return [
            f"  {name.ljust(width)}  {number(kwh, digits).rjust(10)}"
            for name, kwh in entries
            if abs(kwh) >= SMALLEST_SHOWN_KWH
        ]

    return [*lines(taken), "  of traction less recuperated go to", *lines(spent)]


def _validation_table(table: Summary) -> list[str]:
    notes: list[str] = []
    rows = []
    for row in table["rows"]:
        if row["note"] and row["note"] not in notes:
            notes.append(row["note"])
        mark = f"[{notes.index(row['note']) + 1}]" if row["note"] else ""
        difference = row["difference_percent"]
        rows.append(
            (
                row["case"],
                row["quantity"],
                row["unit"],
                "" if row["printed"] is None else _plain(row["printed"]),
                number(row["ours"], decimals(row["printed"]) + 1),
                "" if difference is None else f"{difference:+.3f} %",
                mark,
            )
        )
    head = ("case", "quantity", "unit", table["reference"], "ours", "difference", "")
    lines = table_lines(head, rows, left={0, 1, 2, 6})
    for index, note in enumerate(notes, 1):
        lines += _wrapped(f"[{index}] {note}", "  ")
    return lines


def _plain(value: float) -> str:
    return number(value, decimals(value))


def _labelled(label: str, words: str) -> list[str]:
    lines = textwrap.wrap(words, _width() - LABEL_WIDTH) or [""]
    return [f"{(label if index == 0 else ''):{LABEL_WIDTH}}{line}" for index, line in enumerate(lines)]


def _wrapped(words: str, indent: str = "") -> list[str]:
    return textwrap.wrap(words, _width(), initial_indent=indent, subsequent_indent=indent + "  ")


def _width() -> int:
    return max(min(shutil.get_terminal_size((WIDEST, 40)).columns, WIDEST), 60)
