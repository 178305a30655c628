"""Numbers and sentences of Line: the row above its charts, the verdict, the tables of the legs."""

from collections.abc import Mapping, Sequence

from railjoule.core.studies.whole_line import Sharing, WholeLine
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.typed import clock
from railjoule.dashboard.pages.line.charts import SHARING_TOKENS, SHARING_WORDS
from railjoule.dashboard.pages.line.compute import WORTH_SHARE, LineRuns
from railjoule.dashboard.parts import html as parts

EXAMPLE_NOTE = "{} has no stations between its ends; the editor has them under Track. The page shows an example."
OTHERS: tuple[Sharing, ...] = ("given", "proportional", "equal")
SHORT: Mapping[Sharing, str] = {
    "optimum": "optimal",
    "proportional": "proportional",
    "equal": "equal",
    "given": "present",
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
        parts.figure(
            "Energy of the whole line", words.energy(best.run.energy_kwh), "kWh", SHARING_WORDS["optimum"], "main"
        ),
        *others,
        parts.figure(
            "Extra second saves",
            price,
            "Wh/s",
            "same on every leg" if one else "same between arrivals that bind",
        ),
        parts.proof_figure(best.run),
        # a row has space for six numbers, and a table below contains this one, too
        *([] if "given" in runs.runs else [supplement]),
    ]


def sharing_words(runs: LineRuns) -> list[str]:
    """Return the saving by the optimal supplement in sentences, and whether it is worth a new timetable."""
    best = runs.best.run.energy_kwh
    costs = []
    for other in runs.measured_by:
        # the figure of the row above the charts
        verb, amount = comparisons.saving(runs.runs[other].run.energy_kwh, best)
        costs.append(f"the {SHARING_WORDS[other]} {verb} {amount}{' more' if verb == 'costs' else ''}")
    compared = f"Compared with the optimal supplement, {words.energy(best)} kWh, {' and '.join(costs)}"
    less = f"less than {words.share(WORTH_SHARE)} %"
    if not costs:
        verdict = "No other distribution of the supplement keeps the arrival windows."
    elif runs.pays:
        verdict = f"{compared}."
    else:
        verdict = f"{compared}: {less}, so a new timetable hardly pays here."
    refused = f"The present timetable is not shown. {runs.refusal}" if runs.refusal else ""
    return [sentence for sentence in (verdict, refused) if sentence]


def missed_words(runs: LineRuns) -> list[str]:
    """Return the arrival windows that the rules and the given timetable miss."""
    return [
        f"{SHARING_WORDS[sharing].capitalize()}: {sentence}"
        for sharing, sentences in runs.missed.items()
        if sharing in runs.runs
        for sentence in sentences
    ]


def heading(runs: LineRuns) -> Markup:
    """Return the heading of the page."""
    best, scenario = runs.best, runs.best.run.scenario
    standing = sum(station.dwell_s for station in scenario.line.inner_stations)
    what = (
        f"{words.distance(best.run.distance_m)} km, {len(best.legs)} legs in {words.time(best.run.travel_time_s)} s, "
        f"including {words.time(standing)} s of dwell"
    )
    return parts.heading("Line", f"{'Example: ' if runs.is_example else ''}{scenario.title}", what, "")


def key_words(runs: LineRuns, other: Sharing) -> Markup:
    """Return the colours of lines and bars, and their meaning."""
    bar = '<span style="margin-right:16px"><span class="patch" style="background:var(--rj-{})"></span>{}</span>'
    drawn = {"optimum", other, *(["given"] if "given" in runs.runs else [])}
    there = {sharing: token for sharing, token in SHARING_TOKENS.items() if sharing in drawn}
    return markup(
        '<p class="small" style="padding:2px 20px 0;color:var(--rj-ink2)">{}numbers above bars: {}</p>',
        joined(markup(bar, token.replace("_", "-"), SHARING_WORDS[sharing]) for sharing, token in there.items()),
        SHARING_WORDS["optimum"],
    )


def legs_table(runs: LineRuns, other: Sharing) -> Markup:
    """Return times and energies of the legs, of the optimum beside another way of sharing."""
    lines: Lines = [("optimum", runs.best), (other, runs.runs[other])]
    # a rule has no price of its own
    priced = [(sharing, line) for sharing, line in lines if sharing in {"optimum", "given"}]
    header = (
        "Leg",
        "m",
        "shortest, s",
        *(f"{SHORT[sharing]}: {what}" for sharing, _ in lines for what in ("arrives, min:s", "supplement, s", "kWh")),
        *(f"{SHORT[sharing]}: Wh/s" for sharing, _ in priced),
    )
    rows: list[tuple[tuple[str, ...], bool]] = []
    for number, leg in enumerate(runs.best.legs):
        shown = [line.legs[number] for _, line in lines]
        cells = (
            f"{leg.departs_from} \u2013 {leg.arrives_at}",
            words.number(leg.end_m - leg.start_m, 0),
            words.number(leg.shortest_time_s),
            *(cell for one in shown for cell in leg_cells(one.arrival_s, one.supplement_s, one.energy_j)),
            *(words.price(line.legs[number].price_of_time_w) for _, line in priced),
        )
        rows.append((cells, False))
    legs = runs.best.legs
    sums = [
        cell
        for _, line in lines
        for cell in leg_cells(None, sum(leg.supplement_s for leg in line.legs), sum(leg.energy_j for leg in line.legs))
    ]
    length = words.number(legs[-1].end_m - legs[0].start_m, 0)
    total = ("All legs", length, words.number(sum(leg.shortest_time_s for leg in legs)), *sums, *("" for _ in priced))
    table = parts.table("Legs", header, [*rows, (total, True)])
    return markup('<div style="overflow-x:auto" tabindex="0" role="region" aria-label="Legs">{}</div>', table)


def leg_cells(arrival_s: float | None, supplement_s: float, energy_j: float) -> tuple[str, str, str]:
    """Return the cells of a leg, or of all legs, which have no arrival of their own."""
    arrival = "" if arrival_s is None else clock(arrival_s)
    return arrival, words.number(supplement_s), words.energy(energy_j / J_PER_KWH)
