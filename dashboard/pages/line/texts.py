"""What Line tells in numbers and sentences: the row above its charts, the verdict, the tables of the legs."""

from collections.abc import Mapping, Sequence

from railjoule.core.studies.whole_line import Leg, Sharing, WholeLine
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.pages.line.charts import SHARING_TOKENS, SHARING_WORDS
from railjoule.dashboard.pages.line.compute import WORTH_SHARE, LineRuns
from railjoule.dashboard.parts import html as parts

OTHERS: tuple[Sharing, ...] = ("given", "proportional", "equal")
SHORT: Mapping[Sharing, str] = {
    "optimum": "optimal",
    "proportional": "proportional",
    "equal": "equal",
    "given": "given",
}
Lines = Sequence[tuple[Sharing, WholeLine]]


def figure_cells(runs: LineRuns) -> list[str]:
    """Return the numbers above the charts."""
    best = runs.best
    prices = [leg.price_of_time_w for leg in best.legs]
    # up to rounding: where no window binds all legs have one price
    one = max(prices) - min(prices) <= 1e-9 * max(map(abs, prices))
    ends = [words.price(price) for price in (min(prices), max(prices))]
    price = "\u2013".join(dict.fromkeys(ends))
    others = []
    for other in OTHERS:
        if other in runs.runs:
            energy = runs.runs[other].run.energy_kwh
            # a line whose windows it misses is another one
            missed = runs.missed.get(other)
            cost = (words.UNKNOWN, "") if missed else comparisons.above(energy, best.run.energy_kwh)
            others.append(parts.figure(SHARING_WORDS[other].capitalize(), *cost, f"{words.energy(energy)} kWh"))
    supplement = parts.figure(
        "Running-time supplement",
        words.number(best.run.travel_time_s - runs.shortest_time_s),
        "s",
        f"shortest {words.number(runs.shortest_time_s)} s",
    )
    return [
        parts.figure("Energy of the whole line", words.energy(best.run.energy_kwh), "kWh", "optimal reserve", "main"),
        *others,
        parts.figure(
            "Extra second saves",
            price,
            "Wh/s",
            "same on every leg" if one else "same between arrivals that bind",
        ),
        parts.proof_figure(best.run),
        # a row has room for six numbers, and a table beneath has this one, too
        *([] if "given" in runs.runs else [supplement]),
    ]


def sharing_words(runs: LineRuns) -> list[str]:
    """Return what sharing the slack by the optimum saves, and whether that is worth a new timetable."""
    best = runs.best.run.energy_kwh
    costs = []
    for other in runs.measured_by:
        # the figure of the row above the charts
        verb, amount = comparisons.saving(runs.runs[other].run.energy_kwh, best)
        costs.append(f"the {SHARING_WORDS[other]} {verb} {amount}{' more' if verb == 'costs' else ''}")
    told = f"Against the optimal reserve, {' and '.join(costs)}"
    less = f"less than {words.share(WORTH_SHARE)} %"
    if not costs:
        verdict = "No other way of sharing the slack that is shown keeps the windows of arrival."
    elif runs.pays:
        verdict = f"{told}."
    else:
        verdict = (
            f"{told}: {less}, so a new timetable hardly pays here. It pays most where legs differ in gradient, length "
            "or speed limits."
        )
    refused = f"The given timetable is not shown. {runs.refusal}" if runs.refusal else ""
    return [sentence for sentence in (verdict, refused) if sentence]


def missed_words(runs: LineRuns) -> list[str]:
    """Return which windows of arrival the rules and the given timetable miss."""
    return [
        f"{SHARING_WORDS[sharing].capitalize()}: {sentence}"
        for sharing, sentences in runs.missed.items()
        if sharing in runs.runs
        for sentence in sentences
    ]


def key_words(runs: LineRuns) -> Markup:
    """Return what the colours of lines and bars mean."""
    bar = '<span style="margin-right:16px"><span class="patch" style="background:var(--rj-{})"></span>{}</span>'
    there = {sharing: token for sharing, token in SHARING_TOKENS.items() if sharing in runs.runs}
    return markup(
        '<p class="small" style="padding:2px 20px 0;color:var(--rj-ink2)">{}numbers above bars: {}</p>',
        joined(markup(bar, token.replace("_", "-"), SHARING_WORDS[sharing]) for sharing, token in there.items()),
        SHARING_WORDS["optimum"],
    )


def legs_tables(runs: LineRuns) -> Markup:
    """Return the legs with what each way of sharing gives them of time, and what energy they need for it."""
    lines = [(sharing, runs.runs[sharing]) for sharing in SHARING_TOKENS if sharing in runs.runs]
    return joined([times_table(lines), energies_table(lines)])


def times_table(lines: Lines) -> Markup:
    """Return arrivals, running times and supplements of the legs."""
    (_, best), *others = lines
    names = [f"{SHORT[sharing]} supplement, s" for sharing, _ in lines]
    header = ("Leg", "m", "arrives, s", "runs, s", "shortest, s", *names)
    rows: list[tuple[tuple[str, ...], bool]] = []
    for number, leg in enumerate(best.legs):
        cells = (
            leg_words(leg),
            words.number(leg.end_m - leg.start_m, 0),
            *map(words.number, (leg.arrival_s, leg.running_time_s, leg.shortest_time_s, leg.supplement_s)),
            *(words.number(line.legs[number].supplement_s) for _, line in others),
        )
        rows.append((cells, False))
    sums = [sum(leg.supplement_s for leg in line.legs) for _, line in lines]
    running, shortest = sum(leg.running_time_s for leg in best.legs), sum(leg.shortest_time_s for leg in best.legs)
    length = best.legs[-1].end_m - best.legs[0].start_m
    total = (words.number(length, 0), "", *map(words.number, (running, shortest, *sums)))
    return parts.table("Legs: times", header, [*rows, (("All legs", *total), True)])


def energies_table(lines: Lines) -> Markup:
    """Return energies of the legs and what an extra second saves on them."""
    priced = [(sharing, line) for sharing, line in lines if sharing in {"optimum", "given"}]
    header = (
        "Leg",
        *(f"{SHORT[sharing]}, kWh" for sharing, _ in lines),
        *(f"{SHORT[sharing]}, Wh/s" for sharing, _ in priced),
    )
    rows: list[tuple[tuple[str, ...], bool]] = [
        (
            (
                leg_words(leg),
                *(words.energy(line.legs[number].energy_j / J_PER_KWH) for _, line in lines),
                *(words.price(line.legs[number].price_of_time_w) for _, line in priced),
            ),
            False,
        )
        for number, leg in enumerate(lines[0][1].legs)
    ]
    sums = [words.energy(sum(leg.energy_j for leg in line.legs) / J_PER_KWH) for _, line in lines]
    return parts.table(
        "Legs: energy, and what an extra second saves",
        header,
        [*rows, (("All legs", *sums, *("" for _ in priced)), True)],
    )


def leg_words(leg: Leg) -> str:
    """Return a leg by its stations."""
    return f"{leg.departs_from} \u2013 {leg.arrives_at}"
