"""Pieces of text, numbers and tables, as HTML; every text that a user brings is escaped."""

import html
import re
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any
from weakref import WeakKeyDictionary

import panel as pn
from bokeh.document import Document
from bokeh.model import Model
from bokeh.models import InlineStyleSheet

from railjoule.core import Phase, Trajectory
from railjoule.core.advice import AT_REST_MS
from railjoule.core.units import J_PER_KWH, MS_PER_KMH
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.look.tokens import DASHES, PIN_DASHES, line_width
from railjoule.dashboard.models.pages import PAGES
from railjoule.dashboard.models.pins import Pin
from railjoule.dashboard.store import Runs

SAME_STOP_M = 0.5
MOST_IN_SIGHT = 10
"""So many instructions stand above the charts; more are scrolled."""
LOSS_WORDS = {
    "drive": "Powertrain losses",
    "copper": "Copper loss",
    "magnetising": "Magnetising loss",
    "iron": "Iron loss",
    "mechanical": "Friction in the motors",
    "motors_and_inverters": "Motors and inverters",
    "gear": "Gears",
    "standstill_brake": "Standstill brake",
    "brake_resistors": "Brake resistors",
    "friction_brakes": "Friction brakes",
}
WRAP_CSS = "@media (max-width: 899px) { :host { flex-wrap: wrap; } }"
"""Of a row of controls that takes more lines on a narrow screen."""


SHEETS: WeakKeyDictionary[Document, dict[str, InlineStyleSheet]] = WeakKeyDictionary()
"""Style sheets of each document: there are hundreds of panes, and it is sent each sheet once."""


class Words(pn.pane.HTML):
    """HTML that changes often: only the new text goes to the browser, not every property of the pane anew."""

    def _get_properties(self, doc: Document | None) -> dict[str, Any]:
        properties: dict[str, Any] = super()._get_properties(doc)
        if doc is not None and "stylesheets" in properties:
            known = SHEETS.setdefault(doc, {})
            properties["stylesheets"] = [
                known.setdefault(sheet, InlineStyleSheet(css=sheet)) if isinstance(sheet, str) else sheet
                for sheet in properties["stylesheets"]
            ]
        return properties

    def _update(self, ref: str, model: Model) -> None:
        model.text = self._transform_object(self.object)["object"]


def html_pane(text: str = "", **params: Any) -> Words:
    """Return a pane for one of this module's pieces."""
    return Words(text, **{"stylesheets": [parts_css()], "sizing_mode": "stretch_width", "margin": 0, **params})


def stack(*objects: Any, css: str = "", **params: Any) -> pn.Column:
    """Return objects below each other, as high as they need; `css` styles the column."""
    # the library's button for scrolling, which is never seen, would take a place in a grid
    free = ":host { max-height: none; } .scroll-button { display: none; }"
    return pn.Column(*objects, **{"margin": 0, "sizing_mode": "stretch_width", "stylesheets": [free + css], **params})


def escaped(text: str) -> str:
    """Return a text that may come from a user, fit for HTML."""
    return html.escape(text)


def swatch(name: str) -> str:
    """Return a sample of the line of a strategy or a pinned run."""
    dash = PIN_DASHES.get(name) or DASHES[name]  # type: ignore[index]
    pattern = "" if dash == "solid" else f'stroke-dasharray="{" ".join(map(str, dash))}"'
    return (
        '<svg width="22" height="8" aria-hidden="true"><line x1="0" y1="4" x2="22" y2="4" '
        f'stroke="var(--rj-{name.replace("_", "-")})" stroke-width="{line_width(name):g}" {pattern}/></svg>'
    )


def heading(page: str, title: str, subtitle: str, aside: str) -> str:
    """Return the heading of a page: the question that it answers, and beneath it the scenario and more."""
    return (
        f'<div class="head"><h1>{PAGES[page].question}</h1>'
        f'<p class="muted"><span class="scenario">{html.escape(title)}</span> {html.escape(subtitle)}</p>'
        f'<span class="push"></span><span class="muted small wide">{html.escape(aside)}</span></div>'
    )


def failure(what: str, why: str, shown: str) -> str:
    """Return the message above a run that is not the one asked for."""
    rest = html.escape(f"{why} {shown}")
    return f'<div class="message" role="alert"><b>{html.escape(what)}</b> {rest}</div>'


def refusal(sentence: str) -> str:
    """Return the message about what was not taken; what it is about comes first, up to a colon."""
    about, colon, rest = sentence.partition(": ")
    bold, plain = (f"{about}{colon}", rest) if colon else (sentence, "")
    return f'<div class="message" role="alert"><b>{html.escape(bold)}</b>{html.escape(plain)}</div>'


def figure(label: str, value: str, unit: str, detail: str, kind: str = "", whole: str = "", term: str = "") -> str:
    """Return one number with its label and what it means, as HTML.

    A kind is `main` or `extra`; `whole` is a sentence that a resting mouse shows where there is no room for it; `term`
    is what the glossary calls the number, where its label changes.
    """
    title = f' title="{html.escape(whole)}"' if whole else ""
    return (
        f'<div class="figure {kind}"{title}><div class="label"><span>{label}</span>{info(term or label)}</div>'
        f'<div class="value">{value}<span>{unit}</span></div><div class="detail">{detail}</div></div>'
    )


def figures(cells: Iterable[str], stale: bool = False) -> str:
    """Return a row of numbers."""
    return f'<div class="{"stale" if stale else ""}"><div class="figures" role="status">{"".join(cells)}</div></div>'


def figures_in_place(cells: Iterable[str], former: Iterable[str]) -> str:
    """Return a row of numbers no lower than a former one, so that what lies beneath it stays where it is."""
    # a former row that nobody sees lies in the same cell of a grid, and keeps its height whatever the window's width
    kept = f'<div style="grid-area: 1 / 1; visibility: hidden" aria-hidden="true">{figures(former)}</div>'
    return f'<div style="display: grid">{kept}<div style="grid-area: 1 / 1">{figures(cells)}</div></div>'


def change(now: float, before: float) -> str:
    """Return by how much an energy [kWh] has changed against the pinned one, as HTML."""
    amount = comparisons.above(now, before)
    if amount.is_none:
        return f"as pinned, {words.energy(before)}"
    sign, kind = ("\u25bc", "better") if amount.is_less else ("\u25b2", "worse")
    return f'<span class="{kind}">{sign} {amount.size} {amount.unit}</span> against pinned {words.energy(before)}'


def proof_figure(run: Trajectory) -> str:
    """Return how far a run is from the best known one, or from its bound where it is that one and not proven."""
    amount, reference = comparisons.above_reference(run), run.reference
    if amount is not None and reference is not None and not comparisons.is_reference(run):
        label = "Above the optimum" if reference.proven else "Above best known"
        told = comparisons.reference_words(reference, run.scenario.travel_time_s)
        return figure(label, *amount, comparisons.reference_detail(run), whole=f"{amount.sentence} the {told}")
    if run.is_proven:
        return figure("Above the optimum", *comparisons.NOTHING, '<span class="proven">\u2713 proven</span>')
    amount = comparisons.above_own_bound(run)
    if amount is None:
        return figure("Above the bound", words.UNKNOWN, "", "no bound is known")
    detail = f'<span class="open">\u25d0 bound</span> {words.energy(run.lower_bound_kwh or 0.0)} kWh'
    return figure("Above the bound", *amount, detail, whole="Not proven: it is at most this far above the optimum")


def price_figure(run: Trajectory, optimum: Trajectory) -> str:
    """Return the price of a second: that of the run, or where its strategy tells none, that of the optimum."""
    priced, whole = (run, "") if run.price_of_time_w is not None else (optimum, "That of the optimum")
    price = priced.price_of_time_w
    if price is None:
        return figure("Extra second saves", words.UNKNOWN, "", "")
    saved = comparisons.above(priced.energy_kwh - price / J_PER_KWH, priced.energy_kwh)
    return figure("Extra second saves", words.price(price), "Wh/s", f"1 s more: {saved}", whole=whole)


def run_figures(runs: Runs, run: Trajectory, pinned: Trajectory | None, stale: bool) -> str:
    """Return the numbers of Drive."""
    energy = run.energy
    waiting = comparisons.waiting_of(run) and f": {comparisons.waiting_of(run)}"
    main = change(run.energy_kwh, pinned.energy_kwh) if pinned else f"for {words.time(run.travel_time_s)} s{waiting}"
    slack = f"{words.time(run.travel_time_s - runs.shortest_time_s)} s of slack"
    mean = run.distance_m / run.travel_time_s / MS_PER_KMH
    share = f"{words.share(energy.recuperated_j / energy.traction_j)} % of traction" if energy.traction_j > 0 else ""
    mass = run.scenario.vehicle.total_mass_kg / 1000
    per_tonne = energy.net_j / (J_PER_KWH / 1000) / mass / (run.distance_m / 1000)
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
            figure("Highest speed", words.number(run.max_speed_kmh), "km/h", f"mean {words.number(mean)}"),
            figure(
                "Recuperated",
                words.energy(energy.recuperated_j / J_PER_KWH),
                "kWh",
                share,
            ),
            figure(
                "Per tonne and km",
                words.number(per_tonne),
                "Wh",
                f"{words.number(mass, 0)} t, {words.distance(run.distance_m)} km",
                kind="extra",
            ),
        ],
        stale,
    )


def advice(run: Trajectory, stale: bool) -> str:
    """Return the advice to the driver, by legs where it stops on the way, with buttons that copy and print it."""
    departures = [k for k, phase in enumerate(run.phases) if k == 0 or _departs(phase)]
    stops = [*(run.phases[k].start_m for k in departures), run.phases[-1].end_m]
    # a leg's name tells where it starts and stops
    texts = list(words.advice_in_words(run.advice, named=stops if len(departures) > 1 else ()))
    texts[0] = texts[0][0].upper() + texts[0][1:]
    items = [f'<li class="told"><b>{number}</b>{text}</li>' for number, text in enumerate(texts, 1)]
    if len(departures) > 1:
        borders = pairwise([*departures, len(items)])
        items = [_leg(run, ends, items[first:end]) for ends, (first, end) in zip(pairwise(stops), borders, strict=True)]
    if len(texts) > MOST_IN_SIGHT:
        # what is scrolled must be so by the keyboard too
        kind = "many legs" if len(departures) > 1 else "many"
        items = [f'<li><ol class="{kind}" tabindex="0" aria-label="All instructions">{"".join(items)}</ol></li>']
    title = html.escape(f"{run.scenario.title or 'Run'}: {words.time(run.travel_time_s)} s")
    tools = "".join(
        f'<button type="button" class="save" data-act="{what.lower()}" aria-label="{what} the advice">{what}</button>'
        for what in ("Copy", "Print")
    )
    kind = "advice stale" if stale else "advice"
    return (
        f'<div class="card" data-title="{title}"><ol class="{kind}" aria-label="Driver\u2019s advice">'
        f'{"".join(items)}<li class="buttons">{tools}</li></ol></div>'
    )


def _departs(phase: Phase) -> bool:
    """Return whether a phase begins at rest, and drives on."""
    return phase.start_ms <= AT_REST_MS and phase.phase != "stand"


def _leg(run: Trajectory, ends_m: tuple[float, float], items: Sequence[str]) -> str:
    """Return the instructions of a leg between two stops [m] beside their names."""
    stations = run.scenario.line.in_running_order().stations
    names = []
    for place in ends_m:
        near = [station.name for station in stations if abs(station.position_m - place) < SAME_STOP_M]
        names.append((near and near[0]) or f"{words.number(place, 0)} m")
    way = escaped(" \u2013 ".join(names))
    return f'<li class="leg"><span class="way">{way}</span><ol>{"".join(items)}</ol></li>'


def account(run: Trajectory) -> str:
    """Return where the energy goes, as bars that follow one another."""
    energy = run.energy
    gains = [
        ("From height lost", -energy.potential_j),
        ("From speed lost", -energy.kinetic_j),
        ("From the magnetic field", -energy.magnetic_field_j),
    ]
    uses = [
        ("Auxiliaries", energy.auxiliary_j),
        ("Running resistance", energy.running_resistance_j),
        ("Curves", energy.curve_resistance_j),
        *((LOSS_WORDS[kind], joules) for kind, joules in energy.losses_j.items()),
        ("Height gained", energy.potential_j),
        ("Speed gained", energy.kinetic_j),
        ("Stored in the magnetic field", energy.magnetic_field_j),
    ]
    small = 1e-4 * max(energy.traction_j, 1.0)
    gains = [(word, joules) for word, joules in gains if joules > small]
    uses = [(word, joules) for word, joules in uses if joules > small]
    taken = energy.traction_j + energy.auxiliary_j
    scale = max(taken, sum(joules for _, joules in uses), 1.0)

    def bar(word: str, start: float, length: float, colour: str, strong: bool = False) -> str:
        left, width = 100 * min(start, start + length) / scale, 100 * abs(length) / scale
        name = f"<b>{word}</b>" if strong else word
        amount = words.energy(length / J_PER_KWH)
        return (
            f'<span>{name}</span><span class="track"><i style="left:{max(left, 0):.2f}%;width:{max(width, 0.4):.2f}%;'
            f'background:{colour}"></i></span><span class="amount">{f"<b>{amount}</b>" if strong else amount}</span>'
        )

    accent, pale, neutral = (
        "var(--rj-accent)",
        "color-mix(in srgb, var(--rj-accent) 40%, transparent)",
        "var(--rj-groundline)",
    )
    rows = [bar("Drawn from the supply", 0, taken, accent)]
    if energy.recuperated_j > small:
        rows.append(bar("Recuperated", taken, -energy.recuperated_j, pale))
    rows += [bar("Net from the supply", 0, energy.net_j, accent, strong=True), '<span class="gap"></span>']
    rows += [bar(word, 0, joules, neutral) for word, joules in gains]
    place = 0.0
    for word, joules in uses:
        rows.append(bar(word, place, joules, neutral))
        place += joules
    given = " + ".join(words.energy(j / J_PER_KWH) for j in (energy.net_j, *(joules for _, joules in gains)))
    used = words.energy(sum(joules for _, joules in uses) / J_PER_KWH)
    closes = f"Total: {given} = {used} kWh." if gains else f"Total: {used} kWh."
    bars = f'<div class="flow">{"".join(rows)}</div><p class="note">{closes}</p>'
    return f'<div class="block"><h2>Where the energy goes, kWh</h2>{bars}</div>'


def plain_table(header: Sequence[str], rows: Iterable[tuple[Sequence[str], bool]]) -> str:
    """Return a table; cells are HTML, and a row may be the chosen one."""
    head = "".join(f'<th scope="col">{cell}</th>' for cell in header)
    body = "".join(
        f"<tr{' class=chosen' if chosen else ''}>{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"
        for cells, chosen in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def table(title: str, header: Sequence[str], rows: Iterable[tuple[Sequence[str], bool]]) -> str:
    """Return a table under a title, with a button that saves it; title and cells are HTML."""
    name = re.sub(r"<[^>]+>", "", title)
    save = f'<button type="button" class="save" data-act="csv" data-name="{name}" aria-label="Save {name} as CSV">'
    titled = f'<div class="titled"><h2>{title}</h2>{save}CSV</button></div>'
    return f'<div class="block">{titled}{plain_table(header, rows)}</div>'


def runs_table(runs: Runs, chosen: str, pins: Sequence[Pin] = ()) -> str:
    """Return all runs of the scenario and the pinned ones, side by side; the last one pinned is the reference."""
    pinned = pins[-1].trajectory if pins else None
    rows = []
    for name, run in runs.runs.items():
        rows.append(((f"{swatch(name)}{words.strategy(name)}", *_run_cells(run, pinned)), name == chosen))
    for pin in reversed(pins):
        line = swatch("pinned") if pin is pins[-1] else '<svg width="22" height="8" aria-hidden="true"></svg>'
        rows.append(((f"{line}Pinned: {escaped(pin.name)}", *_run_cells(pin.trajectory, pinned)), False))
    head = ("Run", "kWh", "to pinned, %" if pinned else "above, %", "s", "km/h")
    noun = comparisons.reference_noun(runs.is_proven)
    above = "" if pinned else f'<p class="note">Above the {noun} in the same time.</p>'
    return f"<div>{table('Runs', head, rows)}{above}{other_times(runs.runs.values())}</div>"


def _run_cells(run: Trajectory, pinned: Trajectory | None) -> tuple[str, str, str, str]:
    amount = comparisons.above(run.energy_kwh, pinned.energy_kwh) if pinned else comparisons.above_reference(run)
    return (
        words.energy(run.energy_kwh),
        comparisons.cell(amount),
        words.time(run.travel_time_s),
        words.number(run.max_speed_kmh),
    )


def other_times(runs: Iterable[Trajectory]) -> str:
    """Return which runs take another time than asked, as notes to a table."""
    told = ((words.strategy(run.strategy), comparisons.other_time_of(run)) for run in runs)
    return "".join(f'<p class="note">{name}: {sentence}.</p>' for name, sentence in told if sentence)


def phase_table(run: Trajectory) -> str:
    """Return the phases of a run as a table: where the driver begins and what he aims at, time and energy."""
    rows = []
    for number, (phase, told) in enumerate(zip(run.phases, run.advice, strict=True), 1):
        patch = f'<span class="patch" style="background:var(--rj-{phase.phase.replace("_", "-")})"></span>'
        cells = (
            f"{patch}{number} {words.PHASE_WORDS[phase.phase]}",
            words.number(told.from_m, 0),
            words.number(phase.end_s - phase.start_s),
            words.speed(phase.end_ms) if told.to_kmh is None else words.tenths(told.to_kmh),
            words.energy(phase.energy_j / J_PER_KWH),
        )
        rows.append((cells, False))
    if run.energy.auxiliary_j > 0:
        # the phases' energies and this make the net energy
        rows.append((("Auxiliaries", "", "", "", words.energy(run.energy.auxiliary_j / J_PER_KWH)), False))
    return table("Phases", ("Phase", "from, m", "s", "to, km/h", "kWh"), rows)


def notes(run: Trajectory) -> str:
    """Return what a run simplified, and what its bound covers."""
    return note_paragraphs([*run.notes, *([run.bound.statement] if run.bound is not None else [])])


def note_paragraphs(sentences: Iterable[str]) -> str:
    """Return sentences as notes, each a paragraph."""
    return "".join(f'<p class="note">{html.escape(sentence)}</p>' for sentence in sentences)
