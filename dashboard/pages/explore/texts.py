"""The numbers and sentences of the page, as HTML."""

from collections.abc import Mapping

import numpy as np

from railjoule.dashboard.charts.chart import SHAPES
from railjoule.dashboard.look import words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.pages.explore.charts import colours_for
from railjoule.dashboard.pages.explore.compute import Bounds, Look, Shares
from railjoule.dashboard.pages.explore.running import Progress
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.work.run_table import Column, RunTable

TOO_FEW = "too few runs yet"
FURTHER = 2
"""So many inputs are named after the one that decides most."""
WELL_EXPLAINED = 0.99
"""Below this share of the spread a note states how much the indices explain."""


def duration_words(seconds: float) -> str:
    """Return a time that is known roughly."""
    if seconds < 90:
        return f"{words.number(max(seconds, 1), 0)} s"
    return f"{words.number(seconds / 60, 0)} min" if seconds < 5400 else f"{words.number(seconds / 3600, 1)} h"


def status_html(progress: Progress, note: str) -> Markup:
    """Return the progress of a study, and a note."""
    counts = (words.number(progress.done, 0), words.number(progress.runs, 0))
    pieces = [markup("<span><b>{}</b> of {} runs</span>", *counts)]
    if progress.state == "running" and progress.per_s:
        pieces.append(markup("<span><b>{}</b> runs a second</span>", words.number(progress.per_s, 0)))
        pieces.append(markup("<span><b>{}</b> left</span>", duration_words(progress.left_s or 0.0)))
    state = {
        "running": "" if progress.per_s else "starting",
        "stopping": "stopping after the runs that are under way",
        "stopped": "stopped",
        "done": "done",
    }.get(progress.state, "")
    role = "alert" if progress.state == "failed" else "status"
    pieces += [markup("<span>{}</span>", state)] if state else []
    pieces += [markup('<span role="{}">{}</span>', role, progress.message)] if progress.message else []
    pieces += [markup('<span class="push"></span><span role="status">{}</span>', note)] if note else []
    return markup(
        '<div class="study-status"><progress aria-label="{}" max="{}" value="{}"></progress><p>{}</p></div>',
        "Completed runs of the study",
        max(progress.runs, 1),
        progress.done,
        joined(pieces),
    )


def intro_html(sentence: str, is_sketched: bool) -> Markup:
    """Return the sentence before the first study; a sketch of the figures until a preview is there."""
    sketch = markup('<svg viewBox="0 0 100 100" preserveAspectRatio="none" aria-hidden="true">{}</svg>', SHAPES["bars"])
    return markup('<div class="study-intro"><p>{}</p>{}</div>', sentence, sketch if is_sketched else "")


def finding_html(shares: Shares | None, columns: Mapping[str, Column], note: str) -> Markup:
    """Return in a sentence which inputs decide the energy, and a note; nothing as long as that is not known."""
    if shares is None or shares.refusal:
        return Markup()
    most, *others = zip(shares.fields, (words.number(100 * share, 0) for share in shares.first), strict=True)
    further = [f"{columns[name].within_sentence} {share} %" for name, share in others[:FURTHER] if share != "0"]
    sentence = f"{columns[most[0]].quantity} decides {most[1]} % of the spread in energy"
    return parts.finding(f"{', then '.join([sentence, *further])}.", note)


def number_figures(look: Look, shares: Shares | None) -> list[Markup]:
    """Return the row of numbers."""
    table, count = look.table, words.number(len(look.table.rows), 0)
    energy = table.columns[table.answer]
    fields = table.inputs if shares is None or not shares.fields else shares.fields
    share = words.number(100 * len(table.rows) / table.done, 0) if table.done else words.UNKNOWN
    feasible = parts.figure("Feasible", share, "%", f"{count} of {words.number(table.done, 0)}", whole=table.reason)
    if not len(table.rows):
        return [feasible]
    lowest, highest = look.ranked

    values = table.values[table.answer]

    def of(place: int) -> tuple[str, str, str]:
        return energy.show(values[place]), energy.unit, inputs_words(table, place, fields)

    return [
        *([] if shares is None else [_decides(shares, table.columns)]),
        parts.figure("Lowest", *of(lowest)),
        parts.figure("Median", energy.show(float(np.median(values))), energy.unit, f"of {count} runs"),
        parts.figure("Highest", *of(highest)),
        feasible,
    ]


def _decides(shares: Shares, columns: Mapping[str, Column]) -> Markup:
    if shares.refusal:
        return parts.figure("Decides most", words.UNKNOWN, "", TOO_FEW, kind="main", whole=shares.refusal)
    share, name = words.number(100 * shares.first[0], 0), columns[shares.fields[0]].quantity
    return parts.figure(f"{name} decides", share, "%", "of the spread in energy", "main", term="Sobol\u2019 indices")


def inputs_words(table: RunTable, place: int, names: tuple[str, ...]) -> str:
    """Return the values of the inputs of a run that decide most."""
    shown = [(table.columns[name], table.values[name][place]) for name in names[:2] if name in table.columns]
    return ", ".join(f"{column.within_sentence} {column.with_unit(value)}" for column, value in shown)


def bounds_words(columns: Mapping[str, Column], bounds: Bounds) -> str:
    """Return the bounds of the selection."""
    return ", ".join(
        f"{columns[name].within_sentence} {columns[name].show(low)} to {columns[name].with_unit(high)}"
        for name, (low, high) in bounds.items()
        if name in columns
    )


def legend_html(look: Look, dark: bool) -> Markup:
    """Return the title of the figure of the runs, with its colours."""
    x, y, colour = (look.table.columns[name] for name in (look.asked.x, look.asked.y, look.asked.colour))
    low, high = (colour.show(end) for end in look.colour_ends)
    return markup(
        '<div class="legend"><span>{}, over {}</span><span class="push"></span><span class="scale">{} {}'
        '<i style="background:linear-gradient(to right,{})"></i>{}</span></div>',
        y.label,
        x.within_sentence,
        colour.within_sentence,
        low,
        ",".join(colours_for(dark)),
        f"{high} {colour.unit}".rstrip(),
    )


def indices_html(shares: Shares, columns: Mapping[str, Column]) -> Markup:
    """Return the share of each input in the spread, as bars with their numbers."""
    title = markup(
        '<div class="titled"><h2>Influences on the energy: Sobol\u2019 indices, %{}</h2></div>',
        info("Sobol\u2019 indices"),
    )
    if shares.refusal:
        refusal = shares.refusal[:1].upper() + shares.refusal[1:]
        return markup('<div class="block">{}<p class="note">{}</p></div>', title, refusal)
    keys = Markup(
        '<div class="keys"><span><i class="filled"></i>by itself</span><span><i></i>with the others</span></div>'
    )
    note = f"The polynomial behind them explains {words.share(shares.explained)} % of the spread."
    return markup(
        '<div class="block">{}<div class="shares">{}</div>{}{}</div>',
        title,
        joined(
            markup(
                '<span>{}</span><span class="bar" title="by itself {} %, with the others {} %">'
                '<u style="width:{}%"></u><i style="width:{}%"></i></span>'
                '<span><b>{}</b> <span class="muted">\u00b1 {}</span></span>',
                columns[name].quantity,
                words.number(100 * first),
                words.number(100 * total),
                f"{100 * min(max(total, 0.0), 1.0):.2f}",
                f"{100 * min(max(first, 0.0), 1.0):.2f}",
                words.number(100 * first),
                words.number(100 * error),
            )
            for name, first, total, error in zip(shares.fields, shares.first, shares.total, shares.error, strict=True)
        ),
        keys,
        parts.note_paragraphs([note] if shares.explained < WELL_EXPLAINED else []),
    )


def rows_html(look: Look) -> Markup:
    """Return the selected runs as a table, sorted by energy, with the medians of their results."""
    table, columns, choice = look.table, look.table.columns, look.asked.choice
    title = f"{'Selected' if choice else 'All'}: {words.number(look.chosen, 0)} runs"
    note = f"{bounds_words(columns, choice)} \u00b7 sorted by energy".removeprefix(" \u00b7 ")
    shown = [name for name in columns if name in table.inputs or name == table.answer]
    rows = [
        ((words.number(table.rows[k], 0), *(columns[name].show(table.values[name][k]) for name in shown)), False)
        for k in look.listed
    ]
    medians = ", ".join(
        f"{columns[name].within_sentence} {columns[name].with_unit(held)} (all: {columns[name].with_unit(every)})"
        for name, (held, every) in look.middles.items()
    )
    return markup(
        '<div class="titled"><h2>{} <span class="muted">{}</span></h2></div>{}'
        '<div class="wide-table" tabindex="0" role="region" aria-label="Runs">{}</div>',
        title,
        note,
        parts.note_paragraphs([f"Medians of these: {medians}."] if medians else []),
        parts.table("", ("Run", *(columns[name].label for name in shown)), rows, "Runs"),
    )
