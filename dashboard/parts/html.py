"""Pieces of text, numbers and tables, as HTML.

Whatever stands in one is escaped, unless it is itself HTML: see `railjoule.dashboard.look.markup`.
"""

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

import panel as pn

from railjoule.core import Phase, Trajectory
from railjoule.core.advice import AT_REST_MS
from railjoule.core.measures import energy_per_tonne_km_wh, mean_speed_kmh
from railjoule.core.units import J_PER_KWH
from railjoule.dashboard.library_workarounds import HtmlPane
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.markup import Markup, escaped, joined, markup, safe
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.look.tokens import variable
from railjoule.dashboard.page_list import PAGES
from railjoule.dashboard.state.pins import Pin
from railjoule.dashboard.work.runs import Runs

SAME_STOP_M = 0.5
LEAST_BAR = 0.004
"""Share of the whole that a bar takes at least, so that it is seen."""
MOST_IN_SIGHT = 10
"""So many instructions stand above the charts; more are scrolled."""
# without quotes and end tags where HTML can do without: a move of a slider sends most of this module's pieces again
PROVEN = Markup("<span class=proven>\u2713 proven</span>")
NO_SWATCH = Markup("<svg class=stroke aria-hidden=true></svg>")
WRAP_CSS = "@media (max-width: 899px) { :host { flex-wrap: wrap; } }"
"""Of a row of controls that takes more lines on a narrow screen."""


def html_pane(text: str = "", **params: Any) -> HtmlPane:
    """Return a pane for one of this module's pieces."""
    return HtmlPane(text, **{"stylesheets": [parts_css()], "sizing_mode": "stretch_width", "margin": 0, **params})


def stack(*objects: Any, css: str = "", **params: Any) -> pn.Column:
    """Return objects below each other, as high as they need; `css` styles the column."""
    # the library's button for scrolling, which is never seen, would take a place in a grid
    free = ":host { max-height: none; } .scroll-button { display: none; }"
    return pn.Column(*objects, **{"margin": 0, "sizing_mode": "stretch_width", "stylesheets": [free + css], **params})


def swatch(name: str) -> Markup:
    """Return a sample of the line of a strategy or a pinned run."""
    return markup("<svg class='stroke {}' aria-hidden=true><path d=M0,4h22 /></svg>", variable(name))


def patch(token: str) -> Markup:
    """Return a sample of a colour."""
    return markup("<i class='patch {}'></i>", variable(token))


def heading(page: str, title: str, subtitle: str, aside: str) -> Markup:
    """Return the heading of a page: the question that it answers, and below it the scenario and more."""
    return markup(
        "<div class=head><h1>{question}</h1><p class=muted><span class=scenario>{title}</span> {subtitle}</p>"
        "<span class=push></span><span class='muted small wide'>{aside}</span></div>",
        question=PAGES[page].question,
        title=title,
        subtitle=subtitle,
        aside=aside,
    )


def finding(*sentences: str | Markup) -> Markup:
    """Return the first paragraph of a page: what it finds, in numbers, and the next step."""
    return markup("<p class=finding>{}</p>", Markup(" ").join(sentence for sentence in sentences if sentence))


def failure(what: str, why: str, shown: str) -> Markup:
    """Return the message above a run that is not the one asked for."""
    return markup('<div class="message" role="alert"><b>{}</b> {} {}</div>', what, words.grouped(why), shown)


def refusal(sentence: str) -> Markup:
    """Return the message about what was not taken; what it is about comes first, up to a colon."""
    about, colon, rest = sentence.partition(": ")
    bold, plain = (f"{about}{colon}", rest) if colon else (sentence, "")
    return markup('<div class="message" role="alert"><b>{}</b>{}</div>', bold, plain)


def figure(label: str, value: str, unit: str, detail: str, kind: str = "", whole: str = "", term: str = "") -> Markup:
    """Return one number with its label and what it means, as HTML.

    A kind is `main` or `extra`; `whole` is a sentence that a resting mouse shows where there is no room for it; `term`
    is what the glossary calls the number, where its label changes.
    """
    return markup(
        "<div class='{kind}'{title}><div class=label><span>{label}</span>{info}</div>"
        "<div class=value>{value}<span>{unit}</span></div><div class=detail>{detail}</div></div>",
        kind=f"figure {kind}".rstrip(),
        title=markup(" title='{}'", whole) if whole else "",
        label=label,
        info=info(term or label),
        value=value,
        unit=unit,
        detail=detail,
    )


def figures(cells: Iterable[str], stale: bool = False, role: str = "status") -> Markup:
    """Return a row of numbers; with the role `timer` screen readers do not read each change."""
    kind = "figures stale" if stale else "figures"
    return markup("<div class='{}' role={}>{}</div>", kind, role, joined(cells))


def figures_in_place(cells: Iterable[str], former: Iterable[str]) -> Markup:
    """Return a row of numbers no lower than a former one, so that the content below it stays in place."""
    # a former row that nobody sees lies in the same cell of a grid, and keeps its height whatever the window's width
    return markup(
        '<div style="display: grid"><div style="grid-area: 1 / 1; visibility: hidden" aria-hidden="true">{}</div>'
        '<div style="grid-area: 1 / 1">{}</div></div>',
        figures(former),
        figures(cells),
    )


def change(now: float, before: float) -> Markup:
    """Return by how much an energy [kWh] has changed against the pinned one, as HTML."""
    amount = comparisons.above(now, before)
    if amount.is_none:
        return markup("as pinned, {}", words.energy(before))
    sign, kind = ("\u25bc", "better") if amount.is_less else ("\u25b2", "worse")
    return markup(
        '<span class="{}">{} {} {}</span> against pinned {}',
        kind,
        sign,
        amount.size,
        amount.unit,
        words.energy(before),
    )


def proof_figure(run: Trajectory) -> Markup:
    """Return how far a run is from the best known one, or from its bound where it is that one itself."""
    amount, reference = comparisons.above_reference(run), run.reference
    if comparisons.off_time(run):
        return off_time_figure(run)
    if amount is not None and reference is not None and not comparisons.is_reference(run):
        label = "Above the optimum" if reference.proven else "Above best known"
        reference_text = comparisons.reference_words(reference, run.scenario.travel_time_s)
        return figure(
            label, *amount, comparisons.reference_detail(run), whole=f"{amount.sentence} the {reference_text}"
        )
    amount = comparisons.above_own_bound(run)
    if amount is None:
        return figure("Above the bound", words.UNKNOWN, "", "no bound is known")
    if run.is_proven:
        whole = "Proven: no run needs less by more than the tolerance of the scenario"
        return figure("Above the bound", *amount, PROVEN, whole=whole)
    detail = markup('<span class="open">\u25d0 bound</span> {} kWh', words.energy(run.lower_bound_kwh or 0.0))
    return figure("Above the bound", *amount, detail, whole="Not proven: it is at most this far above the optimum")


def off_time_figure(run: Trajectory) -> Markup:
    """Return how late or early a run is, and how far above the best known one in a time that is named."""
    amount, reference, asked_s = comparisons.above_reference(run), run.reference, run.scenario.travel_time_s
    detail = whole = ""
    if amount is not None and reference is not None:
        noun = comparisons.reference_noun(reference.proven)
        detail = f"{amount.sentence} the {noun} in {words.time(reference.within_s)} s"
        whole = f"{amount.sentence} the {comparisons.reference_words(reference, asked_s)}"
    more = run.travel_time_s - asked_s
    label = "Late" if more > 0 else "Early"
    return figure(label, words.time(abs(more)), "s", detail, whole=whole, term="Above the optimum")


def price_figure(run: Trajectory, optimum: Trajectory) -> Markup:
    """Return the price of a second: that of the run, or that of the optimum if its strategy has none."""
    priced, whole = (run, "") if run.price_of_time_w is not None else (optimum, "Value of the optimum")
    price = priced.price_of_time_w
    if price is None:
        return figure("Extra second saves", words.UNKNOWN, "", "")
    saved = comparisons.above(priced.energy_kwh - price / J_PER_KWH, priced.energy_kwh)
    return figure("Extra second saves", words.price(price), "Wh/s", f"1 s more: {saved}", whole=whole)


def run_figures(runs: Runs, run: Trajectory, pinned: Trajectory | None, stale: bool) -> Markup:
    """Return the numbers of Drive."""
    energy = run.energy
    waiting = comparisons.waiting_words(run) and f": {comparisons.waiting_words(run)}"
    main = change(run.energy_kwh, pinned.energy_kwh) if pinned else f"for {words.time(run.travel_time_s)} s{waiting}"
    slack = f"{words.time(run.travel_time_s - runs.shortest_time_s)} s of slack"
    mean = words.number(mean_speed_kmh(run))
    share = f"{words.share(energy.recuperated_j / energy.traction_j)} % of traction" if energy.traction_j > 0 else ""
    mass = run.scenario.vehicle.total_mass_kg / 1000
    return figures(
        [
            figure("Energy from the supply", words.energy(run.energy_kwh), "kWh", main, kind="main"),
            proof_figure(run),
            price_figure(run, runs.best),
            figure(
                "Travel time",
                words.time(run.travel_time_s),
                "s",
                comparisons.time_asked(run) or slack,
                whole=comparisons.other_time_of(run),
            ),
            figure("Highest speed", words.number(run.max_speed_kmh), "km/h", f"mean {mean}"),
            figure(
                "Recuperated",
                words.energy(energy.recuperated_j / J_PER_KWH),
                "kWh",
                share,
            ),
            figure(
                "Per tonne and km",
                words.number(energy_per_tonne_km_wh(run)),
                "Wh",
                f"{words.number(mass, 0)} t, {words.distance(run.distance_m)} km",
                kind="extra",
            ),
        ],
        stale,
    )


def advice(run: Trajectory, stale: bool, note: str = "") -> Markup:
    """Return the driving advice, by legs where the train stops on the way, with buttons that copy and print it.

    Parameters
    ----------
    run : Trajectory
    stale : bool
        Whether it is from before the last change.
    note : str
        A sentence below it.
    """
    groups = words.instruction_groups(run.advice)
    departures = [k for k, group in enumerate(groups) if k == 0 or _departs(run.phases[group[0]])]
    stops = [*(run.phases[groups[k][0]].start_m for k in departures), run.phases[-1].end_m]
    # a leg's name contains its start and end
    texts = list(words.advice_in_words(run.advice, named=stops if len(departures) > 1 else ()))
    texts[0] = texts[0][0].upper() + texts[0][1:]
    items = [markup("<li><b>{}</b>{}</li>", number, text) for number, text in enumerate(texts, 1)]
    if len(departures) > 1:
        borders = pairwise([*departures, len(items)])
        items = [_leg(run, ends, items[first:end]) for ends, (first, end) in zip(pairwise(stops), borders, strict=True)]
    if len(texts) > MOST_IN_SIGHT:
        # what is scrolled must be so by the keyboard too
        kind = "many legs" if len(departures) > 1 else "many"
        many = "<li><ol class='{}' tabindex=0 aria-label='All instructions'>{}</ol></li>"
        items = [markup(many, kind, joined(items))]
    button = "<button type=button class=save data-act={} aria-label='{} the advice'>{}</button>"
    return markup(
        "<div class=card data-title='{title}'><ol class='{kind}' aria-label='{name}'>"
        "{items}<li class=buttons>{tools}</li></ol>{note}</div>",
        title=f"{run.scenario.title or 'Run'}: {words.time(run.travel_time_s)} s",
        name="Driver\u2019s advice",
        kind="advice stale" if stale else "advice",
        items=joined(items),
        tools=joined(markup(button, act.lower(), act, act) for act in ("Copy", "Print")),
        note=markup("<p class='note advised' role=status aria-live=polite>{}</p>", note) if note else "",
    )


def stop_times(run: Trajectory) -> list[list[str]]:
    """Return the stops of a run in order: place, arrival and departure."""
    rows = [[_place_name(run, run.phases[0].start_m), "", f"departs {words.time(run.phases[0].start_s)} s"]]
    for phase in run.phases:
        if phase.phase == "stand":
            times = [f"arrives {words.time(phase.start_s)} s", f"departs {words.time(phase.end_s)} s"]
            rows.append([_place_name(run, phase.start_m), *times])
    return [*rows, [_place_name(run, run.phases[-1].end_m), f"arrives {words.time(run.phases[-1].end_s)} s", ""]]


def _departs(phase: Phase) -> bool:
    """Return whether a phase begins at rest, and drives on."""
    return phase.start_ms <= AT_REST_MS and phase.phase != "stand"


def _leg(run: Trajectory, ends_m: tuple[float, float], items: Sequence[str]) -> Markup:
    """Return the instructions of a leg between two stops [m] beside their names."""
    way = " \u2013 ".join(_place_name(run, place) for place in ends_m)
    return markup("<li class=leg><span class=way>{}</span><ol>{}</ol></li>", way, joined(items))


def _place_name(run: Trajectory, place_m: float) -> str:
    """Return the name of a stop."""
    stations = run.scenario.line.in_running_order().stations
    near = (station.name for station in stations if abs(station.position_m - place_m) < SAME_STOP_M)
    return next(near, "") or f"{words.number(place_m, 0)} m"


def account(run: Trajectory) -> Markup:
    """Return the energy breakdown as bars that follow one another."""
    energy = run.energy
    gains = [
        ("From height lost", -energy.potential_j),
        ("From speed lost", -energy.kinetic_j),
        ("From the magnetic field", -energy.magnetic_field_j),
    ]
    uses = [
        ("Auxiliaries", energy.auxiliary_j),
        (words.LOSS_WORDS["running_resistance"], energy.running_resistance_j),
        (words.LOSS_WORDS["curve_resistance"], energy.curve_resistance_j),
        *((words.LOSS_WORDS[kind], joules) for kind, joules in energy.losses_j.items()),
        ("Height gained", energy.potential_j),
        ("Speed gained", energy.kinetic_j),
        ("Stored in the magnetic field", energy.magnetic_field_j),
    ]
    # as little as the diagram of these energies leaves out: SMALLEST_SHARE in pages/drive/sankey.py
    small = 1e-4 * max(energy.traction_j, 1.0)
    gains = [(word, joules) for word, joules in gains if joules > small]
    uses = [(word, joules) for word, joules in uses if joules > small]
    taken = energy.traction_j + energy.auxiliary_j
    scale = max(taken, sum(joules for _, joules in uses), 1.0)

    def bar(word: str, start: float, length: float, kind: str = "", strong: bool = False) -> Markup:
        left = max(min(start, start + length) / scale, 0.0)
        return flow_bar(word, words.energy(length / J_PER_KWH), left, abs(length) / scale, kind, strong)

    rows = [bar("Drawn from the supply", 0, taken, "supply")]
    if energy.recuperated_j > small:
        rows.append(bar("Recuperated", taken, -energy.recuperated_j, "back"))
    rows += [bar("Energy from the supply", 0, energy.net_j, "supply", strong=True), Markup("<span class=gap></span>")]
    rows += [bar(word, 0, joules) for word, joules in gains]
    place = 0.0
    for word, joules in uses:
        rows.append(bar(word, place, joules))
        place += joules
    given = " + ".join(words.energy(j / J_PER_KWH) for j in (energy.net_j, *(joules for _, joules in gains)))
    used = words.energy(sum(joules for _, joules in uses) / J_PER_KWH)
    closes = f"Total: {given} = {used} kWh." if gains else f"Total: {used} kWh."
    return markup(
        "<div class=block><h2>Energy breakdown, kWh</h2><div class=flow>{}</div><p class=note>{}</p></div>",
        joined(rows),
        closes,
    )


def flow_bar(word: str, amount: str, left: float, width: float, kind: str, strong: bool) -> Markup:
    """Return a bar of bars that follow one another; its place and width are shares of the whole.

    Its kind decides its colour: `supply`, `back`, `cost` or `all`; none for one like most.
    """
    return markup(
        "<b>{0}</b>{2}<b>{1}</b>" if strong else "<span>{0}</span>{2}<span>{1}</span>",
        word,
        amount,
        # a tenth of a percent is at most a pixel
        markup(
            "<i{} style=margin-left:{}%;width:{}%></i>",
            markup(" class='{}'", kind) if kind else "",
            f"{100 * left:.1f}",
            f"{100 * max(width, LEAST_BAR):.1f}",
        ),
    )


def plain_table(header: Sequence[str], rows: Iterable[tuple[Sequence[str], bool]], name: str = "") -> Markup:
    """Return a table; a row may be the chosen one. A table that has a name is saved under it."""
    # the widest tables have thousands of cells, so each is not a template of its own; nor is text added to a piece of
    # HTML, which would escape it
    head = "<th scope=col>".join(map(safe, ("", *header)))
    # HTML needs no end tags of cells and rows
    body = "".join(
        "<td>".join(map(safe, (Markup("<tr class=chosen>" if chosen else "<tr>"), *cells))) for cells, chosen in rows
    )
    opening = markup("<table data-name='{}'>", name) if name else Markup("<table>")
    return Markup(opening + Markup("<thead><tr>" + head + "<tbody>" + body + "</table>"))


def table(title: str, header: Sequence[str], rows: Iterable[tuple[Sequence[str], bool]], name: str = "") -> Markup:
    """Return a table under its title; without a title it is saved under its name."""
    heading = markup("<div class=titled><h2>{}</h2></div>", title) if title else ""
    # of a title that is HTML only the text: it becomes the name of the file
    return markup("<div class=block>{}{}</div>", heading, plain_table(header, rows, name or escaped(title).striptags()))


def runs_table(runs: Runs, chosen: str, pins: Sequence[Pin] = ()) -> Markup:
    """Return all runs of the scenario and the pinned ones, side by side; the last one pinned is the reference."""
    pinned = pins[-1].trajectory if pins else None
    rows = []
    for name, run in runs.runs.items():
        rows.append(((swatch(name) + words.strategy(name), *_run_cells(run, pinned)), name == chosen))
    # the last one first, as the runs above are compared with it
    for pin in reversed(pins):
        line = swatch("pinned") if pin is pins[-1] else NO_SWATCH
        rows.append(((line + f"Pinned: {pin.name}", *_run_cells(pin.trajectory, pinned)), False))
    head = ("Run", "kWh", "to pinned, %" if pinned else "above, %", "s", "km/h")
    noun, asked = comparisons.reference_noun(runs.is_proven), words.time(runs.scenario.travel_time_s)
    above = [] if pinned else [f"Above the {noun} in {asked} s."]
    notes = note_paragraphs(above) + other_times(runs.runs.values())
    return markup("<div>{}{}</div>", table("Runs", head, rows), notes)


def _run_cells(run: Trajectory, pinned: Trajectory | None) -> tuple[str, str, str, str]:
    return (
        words.energy(run.energy_kwh),
        comparisons.beside(run, pinned) if pinned else comparisons.in_time_asked(run),
        words.time(run.travel_time_s),
        words.number(run.max_speed_kmh),
    )


def other_times(runs: Iterable[Trajectory]) -> Markup:
    """Return which runs take another time than asked, as notes to a table."""
    sentences = ((words.strategy(run.strategy), comparisons.other_time_of(run)) for run in runs)
    return note_paragraphs(f"{name}: {sentence}." for name, sentence in sentences if sentence)


def phase_table(run: Trajectory) -> Markup:
    """Return the phases of a run as a table: where the driver begins and what he aims at, time and energy."""
    rows: list[tuple[tuple[str, ...], bool]] = []
    # further pieces of a gradual action have no number, as the advice has one line for all of them
    numbers = {group[0]: f"{number} " for number, group in enumerate(words.instruction_groups(run.advice), 1)}
    for k, (phase, instruction) in enumerate(zip(run.phases, run.advice, strict=True)):
        cells = (
            markup("{}{}{}", patch(phase.phase), numbers.get(k, ""), words.PHASE_WORDS[phase.phase]),
            words.number(instruction.from_m, 0),
            words.number(phase.end_s - phase.start_s),
            words.speed(phase.end_ms) if instruction.to_kmh is None else words.tenths(instruction.to_kmh),
            words.energy(phase.energy_j / J_PER_KWH),
        )
        rows.append((cells, False))
    if run.energy.auxiliary_j > 0:
        # the phases' energies and this make the net energy
        rows.append((("Auxiliaries", "", "", "", words.energy(run.energy.auxiliary_j / J_PER_KWH)), False))
    return table("Phases", ("Phase", "from, m", "s", "to, km/h", "kWh"), rows)


def inset(*pieces: str) -> Markup:
    """Return pieces with a little room at both sides, as below a chart."""
    return markup('<div style="padding:0 6px">{}</div>', joined(pieces))


def notes(run: Trajectory) -> Markup:
    """Return the simplifications of a run, and the runs that its bound covers."""
    return note_paragraphs([*run.all_notes, *([run.bound.statement] if run.bound is not None else [])])


def note_paragraphs(sentences: Iterable[str], style: str = "") -> Markup:
    """Return sentences as notes, each a paragraph."""
    styled = markup(" style='{}'", style) if style else ""
    # a piece of HTML is written as it is
    plain = (one if isinstance(one, Markup) else words.grouped(one) for one in sentences)
    return joined(markup("<p class=note{}>{}</p>", styled, sentence) for sentence in plain)
