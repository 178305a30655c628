"""Results as text for a terminal, made from the plain values of `railjoule.dashboard.command.summary`.

Its numbers are those of the pages, from `railjoule.dashboard.look`, in characters that every terminal has.
"""

import shutil
import textwrap
from collections.abc import Collection, Sequence

from railjoule.core.advice import Instruction
from railjoule.core.lower_bound import Reference
from railjoule.core.units import J_PER_KWH, J_PER_WH
from railjoule.dashboard.command.summary import Summary
from railjoule.dashboard.command.values import printable
from railjoule.dashboard.look import comparisons, side_by_side, words
from railjoule.dashboard.look.words import CAUSE_WORDS, STRATEGY_WORDS, advice_in_words, decimals

WIDEST = 110
LABEL_WIDTH = 15

Cell = tuple[str, ...]

number = words.plain(words.number)
energy = words.plain(words.energy)
energy_difference = words.plain(words.energy_difference)
share = words.plain(words.share)
distance = words.plain(words.distance)
time = words.plain(words.time)
delay = words.plain(words.delay)
load = words.plain(words.load)
price = words.plain(words.price)
notice = words.plain(words.notice)


def title_words(title: str) -> str:
    """Return the name of a scenario."""
    return words.title(printable(title))


def solution_text(summary: Summary) -> str:
    """Return one run for people: energy, proof, time, account, driver's advice, and the rules that its check broke."""
    bound, saved = summary["lower_bound_kwh"], summary["price_of_time_wh_per_s"]
    iterations = f", {summary['iterations']} iterations" if summary["iterations"] else ""
    lines = [
        f"{title_words(summary['title'])}: {STRATEGY_WORDS[summary['strategy']]}",
        f"{distance(summary['distance_m'])} km in {time(summary['travel_time_s'])} s, "
        f"at most {number(summary['max_speed_kmh'])} km/h",
        *_crush_load_lines(summary),
        "",
        *labelled("Energy", f"{energy(summary['energy_kwh'])} kWh from the supply, {verdict(summary)}"),
        *(labelled("Bound", f"{energy(bound)} kWh. {summary['bound_statement']}") if bound is not None else []),
        *labelled("Time", _time_words(summary)),
        *(labelled("Extra second", f"would save {price(saved * J_PER_WH)} Wh") if saved is not None else []),
        *labelled("Driver", driver_words(summary["advice"])),
        "",
        "Account, kWh",
        *_account_lines(summary),
        "",
        f"Solved in {number(1e3 * summary['solve_time_s'])} ms{iterations}.",
        *wrapped(" ".join(summary["notes"])),
    ]
    if check := summary.get("check"):
        broken = [each for each in check["checks"] if _is_broken(each)]
        lines += ["", *_check_lines(broken)] if broken else []
        lines += labelled("Check", check["verdict"])
    return "\n".join(lines)


def check_text(check: Summary) -> str:
    """Return the rules that a run was checked against, those that could not be checked, and the verdict."""
    lines = _check_lines(check["checks"])
    for rule in check["not_checked"]:
        lines += wrapped(f"Not checked: {rule['name']}: {rule['reason']}.")
    return "\n".join([*lines, "", *wrapped(check["verdict"])])


def comparison_text(comparison: Summary) -> str:
    """Return several runs over one scenario as a table, and who refused it."""
    results = comparison["results"]
    lines = [*_comparison_table(results), *_crush_load_lines(results[0])] if results else []
    if results and results[0]["arrivals"]:
        head = ("arrival, s", *(arrival["station"] for arrival in results[0]["arrivals"]))
        rows = [
            (STRATEGY_WORDS[result["strategy"]], *(time(arrival["arrival_s"]) for arrival in result["arrivals"]))
            for result in results
        ]
        lines += ["", *table_lines(head, rows), ""]
    for refusal in comparison["refused"]:
        lines += wrapped(words.about(STRATEGY_WORDS[refusal["strategy"]], refusal["reason"]))
    notes = {STRATEGY_WORDS[result["strategy"]]: result["notes"] for result in results}
    lines += [line for note in words.notes_by_run(notes) for line in wrapped(note)]
    return "\n".join(lines)


def pair_text(pair: Summary) -> str:
    """Return the runs of two scenarios side by side, and what differs in the scenarios."""
    names = ("First", "Second")
    lines = []
    for name, run in zip(names, pair["results"], strict=True):
        strategy = STRATEGY_WORDS[run["strategy"]]
        lines += labelled(name, f"{title_words(run['title'])}: {strategy}, {verdict(run)}")
    lines += ["", *wrapped(printable(pair["scenarios"])), "", *table_lines(side_by_side.HEAD, pair["table"])]
    notes = {name: run["notes"] for name, run in zip(names, pair["results"], strict=True)}
    lines += [line for note in words.notes_by_run(notes) for line in wrapped(note)]
    return "\n".join(lines)


def simple_advice_text(advice: Summary) -> str:
    """Return runs with few changes of regime as a table, and one order a line."""
    header = ("changes", "kWh", "more than the optimum")
    rows = [
        (str(run["changes"]), energy(run["energy_kwh"]), _price_of_orders(run, advice["optimum_kwh"]))
        for run in advice["runs"]
    ]
    orders = advice_in_words([Instruction(**entry) for entry in advice["advice"]], number)
    return "\n".join(
        [
            f"{title_words(advice['title'])}: simple advice",
            "",
            *table_lines(header, rows),
            "",
            f"Orders with at most {advice['changes']} changes of regime between two stops",
            "(braking for limits and keeping to them come on top)",
            *(f"  {place}. {order}" for place, order in enumerate(orders, 1)),
            *advice["notes"],
        ]
    )


def _price_of_orders(run: Summary, optimum_kwh: float | None) -> str:
    """Return the extra energy of a simple run over the optimum, in kWh and per cent."""
    if run["price_kwh"] is None or not optimum_kwh:
        return "no optimum known"
    return f"{energy(run['price_kwh'])} kWh, {number(100 * run['price_kwh'] / abs(optimum_kwh), 2)} %"


def _crush_load_lines(summary: Summary) -> list[str]:
    """Return the line on a load above the capacity."""
    return [f"{load(summary['load_factor']).capitalize()}."] if summary["load_factor"] > 1 else []


def following_text(following: Summary) -> str:
    """Return a plan and the run that follows it."""
    return _beside_plan(following, "followed", _outcome(following), *following["notes"], _driver_line(following))


def ride_text(ride: Summary) -> str:
    """Return a plan, the events on the way, and the run."""
    learned = [notice(one["position_m"], one["time_s"], one["event"]) for one in ride["notices"]]
    causes = [f"{CAUSE_WORDS[cause].lower()} {energy_difference(kwh)} kWh" for cause, kwh in ride["causes_kwh"].items()]
    added = [f"Added in this order: {', '.join(causes)}."] if len(causes) > 1 else []
    lines = [*learned, _outcome(ride), *added, *ride["notes"], _driver_line(ride)]
    return _beside_plan(ride, "disturbed", *lines, planned="undisturbed")


def field_oriented_text(run: Summary) -> str:
    """Return a plan, how the machines drove it, and the current, voltage and energy that this took."""
    parts = {words.PART_WORDS[kind].lower(): kwh for kind, kwh in run["parts_kwh"].items()}
    parts |= {
        "sum of the parts": run["energy_by_parts_kwh"],
        "input power over time": run["energy_by_input_power_kwh"],
    }
    return _beside_plan(
        run,
        "in closed loop",
        _outcome(run),
        f"At most {number(run['max_tracking_error_m'], 3)} m from the planned position, at most "
        f"{number(run['max_current_a'])} A and {number(run['max_phase_voltage_v'], 0)} V of "
        f"{number(run['voltage_limit_v'], 0)} V per phase.",
        "",
        *table_lines(("energy of the machines", "kWh"), [(name, energy(kwh)) for name, kwh in parts.items()]),
        "",
        *(line for note in run["notes"] for line in wrapped(note)),
    )


def _beside_plan(run: Summary, how: str, *lines: str, planned: str = "planned") -> str:
    """Return a plan and what was driven as a table, with lines below it."""
    plan, actual = run["planned"], run["actual"]
    rows = [
        (
            name,
            energy(one["energy_kwh"]),
            time(one["travel_time_s"]),
            number(one["max_speed_kmh"]),
            energy(one["recuperated_kwh"]),
        )
        for name, one in ((planned, plan), ("driven", actual))
    ]
    head = ("run", "kWh", "time, s", "top, km/h", "recuperated, kWh")
    title = f"{title_words(plan['title'])}: {STRATEGY_WORDS[plan['strategy']]}, {how}"
    return "\n".join([title, "", *table_lines(head, rows), *_crush_load_lines(actual), "", *lines])


def _outcome(run: Summary) -> str:
    """Return the result of following a plan."""
    energies = run["actual"]["energy_kwh"], run["planned"]["energy_kwh"]
    return words.plain_text(comparisons.outcome(*energies, run["delay_s"], run["stop_error_m"]))


def _driver_line(run: Summary) -> str:
    return f"Driver: {driver_words(run['actual']['advice'])}"


def validations_text(validations: Summary) -> str:
    """Return all papers' published numbers compared with railjoule's."""
    return "\n\n".join(validation_text(validation) for validation in validations["papers"].values())


def validation_text(validation: Summary) -> str:
    """Return a paper's published numbers and claims compared with those of railjoule."""
    lines = wrapped(validation["citation"])
    for table in validation["tables"]:
        place = f" ({table['place']})" if table["place"] else ""
        lines += ["", f"{table['title']}{place}"]
        lines += _validation_table(table)
    lines += ["", "Claims"]
    for claim in validation["claims"]:
        lines += wrapped(f"{claim['place']}: {claim['claim']}", "  ")
        lines += wrapped(f"{claim['verdict']}: {claim['railjoule']}. {claim['reason']}", "    ")
    lines += ["", "Errata"]
    for erratum in validation["errata"]:
        sentence = f"{erratum['place']}: {erratum['printed']} must be {erratum['corrected']}: {erratum['reason']}."
        lines += wrapped(sentence, "  ")
    return "\n".join(lines)


def benchmark_text(benchmark: Summary) -> str:
    """Return the times of all solvers, scenario by scenario."""
    results = benchmark["results"]
    rows = [
        (
            # once, before the first solver of a scenario
            *((one["scenario"], number(one["cell_count"], 0)) if one["scenario"] != before else ("", "")),
            STRATEGY_WORDS.get(one["solver"], one["solver"]),
            f"{one['energy_kwh']:.4f}",
            str(one["iterations"] or ""),
            number(1e3 * one["median_s"], 2),
        )
        for one, before in zip(results, ["", *(one["scenario"] for one in results)], strict=False)
    ]
    lines = table_lines(("scenario", "cells", "solver", "kWh", "iterations", "median, ms"), rows, left={0, 2})
    if not benchmark["ipopt"]:
        lines.append("CasADi is not installed, so there is no comparison with IPOPT: pip install casadi.")
    return "\n".join(lines)


def verdict(summary: Summary) -> str:
    """Return in words how far a run is from the best known one, or from its bound where it is that one itself."""
    known = summary["reference"]
    if known is None or (known["strategy"], known["energy_kwh"]) == (summary["strategy"], summary["energy_kwh"]):
        return bound_words(summary)
    reference = Reference(known["energy_kwh"] * J_PER_KWH, known["strategy"], known["within_s"], known["proven"])
    more = comparisons.above(summary["energy_kwh"], known["energy_kwh"])
    of = comparisons.reference_words(reference, summary["allowed_time_s"])
    late = comparisons.late(summary["travel_time_s"], summary["allowed_time_s"])
    return words.plain_text(f"{f'{late}, ' if late else ''}{more.sentence} the {of}")


def bound_words(summary: Summary) -> str:
    """Return in words how far a run is from its bound."""
    amount = comparisons.above_bound(summary["energy_kwh"], summary["lower_bound_kwh"], summary["gap"])
    bound = "no bound known" if amount is None else f"{amount.sentence} the bound"
    return words.plain_text(f"{'proven optimal, ' if summary['proven'] and amount is not None else ''}{bound}")


def driver_words(advice: Sequence[Summary]) -> str:
    """Return the driving advice, such as 'full power to 57.2 km/h, coast from 342 m'."""
    return ", ".join(advice_in_words([Instruction(**entry) for entry in advice], number))


# by hand, as rich takes 50 ms more at each command and is one more dependency
def table_lines(head: Cell, rows: Sequence[Cell], left: Collection[int] = (0,)) -> list[str]:
    """Return the lines of a table with columns as wide as they need, numbers to the right."""
    widths = [max(len(row[column]) for row in (head, *rows)) for column in range(len(head))]
    forms = [f"{{:{'<' if column in left else '>'}{width}}}" for column, width in enumerate(widths)]
    lines = ("  ".join(forms).format(*cells).rstrip() for cells in (head, *rows))
    return [next(lines), "  ".join("-" * width for width in widths), *lines]


def _is_broken(check: Summary) -> bool:
    # a deviation that is no number breaks a rule, too
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
    return table_lines(("rule", "largest deviation", "permitted", "share of", "position, m", ""), rows, left={0, 3, 5})


def _comparison_table(results: Sequence[Summary]) -> list[str]:
    first = results[0]
    known, bound = first["reference"], first["lower_bound_kwh"]
    rows = [
        (
            STRATEGY_WORDS[result["strategy"]],
            energy(result["energy_kwh"]),
            *_above(result),
            time(result["travel_time_s"]),
            number(result["max_speed_kmh"]),
            energy(result["recuperated_kwh"]),
            number(1e3 * result["solve_time_s"]),
        )
        for result in results
    ]
    above = f"above {comparisons.reference_name(known is not None and known['proven'])}, %"
    head = ("strategy", "kWh", above, "above bound, %", "time, s", "top, km/h", "recuperated, kWh", "solved in, ms")
    lines = [
        title_words(first["title"]),
        f"{distance(first['distance_m'])} km, {_time_words({**first, 'travel_time_s': first['allowed_time_s']})}",
        "",
        *table_lines(head, rows),
    ]
    if known is not None:
        best = f"{energy(known['energy_kwh'])} kWh by {STRATEGY_WORDS[known['strategy']]}"
        proof = (
            f"The optimum, {best}, is proven optimal"
            if known["proven"]
            else f"The best known run, {best}, is not proven"
        )
        lines.append(f"{proof}: {'no bound is known' if bound is None else f'the bound is {energy(bound)} kWh'}.")
    others = ((STRATEGY_WORDS[result["strategy"]], _other_time(result)) for result in results)
    return [*lines, *(f"{word}: {sentence}." for word, sentence in others if sentence)]


def _above(result: Summary) -> tuple[str, str]:
    """Return how far a run is above the best known one and above its bound; or how late or early it is."""
    known = result["reference"]
    off_time = comparisons.late(result["travel_time_s"], result["allowed_time_s"])
    if known is None or known["strategy"] != result["strategy"]:
        off_time = off_time or comparisons.early(result["travel_time_s"], result["allowed_time_s"])
    if off_time:
        return words.plain_text(off_time), words.plain_text(words.UNKNOWN)
    amount = None if known is None else comparisons.above(result["energy_kwh"], known["energy_kwh"])
    over_bound = comparisons.above_bound(result["energy_kwh"], result["lower_bound_kwh"], result["gap"])
    return words.plain_text(comparisons.cell(amount)), words.plain_text(comparisons.cell(over_bound))


def _time_words(summary: Summary) -> str:
    other, shortest = _other_time(summary), summary["shortest_time_s"]
    taken = f"{time(summary['travel_time_s'])} s{f', {other}' if other else ''}"
    if shortest is None:
        return taken
    slack = summary["allowed_time_s"] - shortest
    return (
        f"{taken}; shortest possible {time(shortest)} s, timetable {time(summary['allowed_time_s'])} s: "
        f"slack {time(slack)} s ({share(slack / shortest)} %)"
    )


def _other_time(summary: Summary) -> str:
    time = comparisons.other_time(summary["strategy"], summary["travel_time_s"], summary["allowed_time_s"])
    return words.plain_text(time)


def _account_lines(summary: Summary) -> list[str]:
    taken = [
        ("traction", summary["traction_energy_kwh"]),
        ("recuperated", -summary["recuperated_kwh"]),
        ("auxiliaries", summary["auxiliary_kwh"]),
    ]
    spent = [(words.LOSS_WORDS[kind].lower(), kwh) for kind, kwh in summary["losses_kwh"].items()]
    spent += [
        ("kinetic, end minus start", summary["kinetic_kwh"]),
        ("potential, end minus start", summary["potential_kwh"]),
        ("magnetic field, end minus start", summary["magnetic_field_kwh"]),
    ]
    width = max(len(name) for name, _ in taken + spent)
    lines = [
        f"  {name.ljust(width)}  {energy(kwh).rjust(10)}" if abs(kwh) >= words.LEAST_ENERGY_KWH else ""
        for name, kwh in taken + spent
    ]
    lines.insert(len(taken), "  traction minus recuperated goes to")
    return [line for line in lines if line]


def _validation_table(table: Summary) -> list[str]:
    notes = list(dict.fromkeys(row["note"] for row in table["rows"] if row["note"]))
    rows = [
        (
            row["case"],
            row["quantity"],
            row["unit"],
            "" if row["printed"] is None else number(row["printed"], decimals(row["printed"])),
            # one decimal more than was printed, which may have been rounded
            number(row["railjoule"], decimals(row["printed"]) + 1),
            words.plain_text(comparisons.printed_difference(row["difference_percent"], row["difference_points"])),
            f"[{notes.index(row['note']) + 1}]" if row["note"] else "",
        )
        for row in table["rows"]
    ]
    head = ("case", "quantity", "unit", table["reference"], "railjoule", "difference", "")
    wrapped_notes = (line for index, note in enumerate(notes, 1) for line in wrapped(f"[{index}] {note}", "  "))
    return [*table_lines(head, rows, left={0, 1, 2, 6}), *wrapped_notes]


def labelled(label: str, words: str) -> list[str]:
    """Return the lines of a text behind its label."""
    lines = textwrap.wrap(words, _width() - LABEL_WIDTH) or [""]
    return [f"{(label if index == 0 else ''):{LABEL_WIDTH}}{line}" for index, line in enumerate(lines)]


def wrapped(words: str, indent: str = "") -> list[str]:
    """Return the lines of a text; all but the first are indented further."""
    return textwrap.wrap(words, _width(), initial_indent=indent, subsequent_indent=indent + "  ")


def _width() -> int:
    return max(min(shutil.get_terminal_size((WIDEST, 40)).columns, WIDEST), 60)
