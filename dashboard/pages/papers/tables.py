"""Claims, tables and corrections of a paper as HTML and CSV."""

import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping

from railjoule.core.csv_text import csv_of_rows
from railjoule.core.validation import Claim, Erratum, Row, Table, Validation, first_comparisons
from railjoule.core.validation.table import CLOSE_PERCENT, Verdict
from railjoule.dashboard.look import comparisons, words
from railjoule.dashboard.look.glossary import info
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.pages.papers.compute import AUTHORS
from railjoule.dashboard.parts import html as parts

COLUMNS = (
    "table",
    "place",
    "case",
    "quantity",
    "unit",
    "printed",
    "railjoule",
    "difference_percent",
    "difference_points",
    "note",
)
FROM_NUMBER = re.compile(r"\d.*", re.DOTALL)
MOST_REASONS = 6
VERDICTS: dict[Verdict, tuple[str, str]] = {
    "supports": ("good", "supported"),
    "refutes": ("bad", "refuted"),
    "cannot be decided": ("ink2", "cannot be decided"),
}
"""Colour and word of each verdict."""


HYPHEN_MINUS = re.compile(r"(?<![\w.\-])-(?=\d)")
SYMBOL = re.compile(r"\b([A-Za-z])_(\w+)")
LOW_SYMBOL = re.compile(r"\b([A-Za-z])_([aehklmnopst]+)\b")
LOWERED = str.maketrans("aehklmnopst", "\u2090\u2091\u2095\u2096\u2097\u2098\u2099\u2092\u209a\u209b\u209c")
"""Letters that Unicode has as subscripts."""


def typeset(text: str) -> Markup:
    """Return a text of a paper with a true minus, raised and lowered signs: 'T_m', 'm/s2' and '-5 %' are for files."""
    pieces = SYMBOL.split(HYPHEN_MINUS.sub(words.MINUS, text).replace("m/s2", "m/s\u00b2"))
    # a symbol, its index and what follows, after what stands before the first
    more = zip(pieces[1::3], pieces[2::3], pieces[3::3], strict=True)
    return markup("{}{}", pieces[0], joined(markup("{}<sub>{}</sub>{}", *three) for three in more))


def typeset_plain(text: str) -> str:
    """Return a text of a paper for a figure, which takes no HTML: 'T_m' with a subscript, and 'm/s2' raised."""
    return LOW_SYMBOL.sub(lambda found: found[1] + found[2].translate(LOWERED), text).replace("m/s2", "m/s\u00b2")


def tables_csv(tables: tuple[Table, ...]) -> str:
    """Return all rows of tables as CSV."""
    rows: list[tuple[object, ...]] = [COLUMNS]
    for table in tables:
        for row in table.rows:
            cells = (row.case, row.quantity, row.unit, row.printed, row.value)
            differences = row.difference_percent, row.difference_points
            rows.append((table.title, table.place, *cells, *differences, row.note))
    return csv_of_rows(rows)


def paper_html(paper: Validation) -> Markup:
    """Return the claims and tables of a paper, and its corrections."""
    tables = joined(table_html(table) for table in paper.tables)
    return markup('<div class="tables">{}{}{}</div>', claims_html(paper.claims), tables, errata_html(paper.errata))


def table_html(table: Table) -> Markup:
    """Return one table, with the reasons of its differences below it."""
    notes = list(dict.fromkeys(row.note for row in table.rows if row.note))
    rows = [(row_cells(row, notes), False) for row in table.rows]
    header = ("Case", "Quantity", table.reference, "railjoule", "difference", "")
    listed = joined(markup("<li>{}</li>", typeset(note)) for note in notes)
    return markup(
        '<details class="rows"><summary>{title}<span>{place}, {summary}</span></summary><div class="scroll" '
        'tabindex="0" role="region" aria-label="{title}">{body}</div>{reasons}</details>',
        title=table.title,
        place=f", {table.place}" if table.place else "",
        summary=summary_words(table),
        body=parts.table("", header, rows, table.title),
        reasons=markup("<ol>{}</ol>", listed) if notes else "",
    )


def row_cells(row: Row, notes: list[str]) -> tuple[str, ...]:
    """Return the cells of a row; a difference that is not close in warm."""
    difference = comparisons.printed_difference(row.difference_percent, row.difference_points)
    if difference and not row.is_close:
        difference = parts.markup('<span class="open">{}</span>', difference)
    unit = f" [{row.unit}]" if row.unit else ""
    mark = f"({notes.index(row.note) + 1})" if row.note else ""
    return (
        typeset(row.case),
        typeset(f"{row.quantity}{unit}"),
        "\u2013" if row.printed is None else words.number(row.printed, words.decimals(row.printed)),
        words.number(row.value, words.decimals(row.printed) + 1),
        difference,
        mark,
    )


def summary_words(table: Table) -> str:
    """Return how many rows lie how close to the print, and by which measure."""
    compared = [row for row in table.rows if row.difference is not None]
    if not compared:
        return f"{len(table.rows)} rows, nothing to compare with"
    percentages = sum(row.is_percentage for row in compared)
    within = f"{CLOSE_PERCENT:g} percentage point" if percentages == len(compared) else f"{CLOSE_PERCENT:g} %"
    if 0 < percentages < len(compared):
        within += f", percentages within {CLOSE_PERCENT:g} percentage point"
    close = [row for row in compared if row.is_close]
    others = [row for row in compared if not row.is_close]
    because = ", the others for the reasons given" if close else ", for the reasons given"
    because = because if others and all(row.note for row in others) else ""
    if not close:
        return f"{len(others)} differ by more than {within}{because}"
    return f"{len(close)} of {len(compared)} within {within}{because}"


def counts(papers: Collection[Validation]) -> dict[str, int]:
    """Count the claims of papers by verdict, and their printed numbers, each once, by agreement with railjoule."""
    verdicts = Counter(claim.verdict for paper in papers for claim in paper.claims)
    rows = [row for paper in papers for row in first_comparisons(paper.tables)]
    close = sum(row.is_close for row in rows)
    explained = sum(not row.is_close and bool(row.note) for row in rows)
    return {
        "Claims": sum(verdicts.values()),
        "Supported": verdicts["supports"],
        "Refuted": verdicts["refutes"],
        "Undecided": verdicts["cannot be decided"],
        "Printed numbers": len(rows),
        "Numbers that agree": close,
        "Differ, with a reason": explained,
        "Differ, unexplained": len(rows) - close - explained,
    }


def finding(papers: Collection[Validation]) -> Markup:
    """Return how far railjoule agrees with the papers."""
    claims, supported, refuted, undecided, numbers, close, explained, unexplained = counts(papers).values()
    return parts.finding(
        f"railjoule supports {supported} of {claims} claims of the papers, refutes {refuted} and leaves {undecided} "
        f"undecided. Of {numbers} printed numbers {close} agree within {CLOSE_PERCENT:g} %, {explained} differ for a "
        f"stated reason and {unexplained or 'none'} without one.",
        "The tab of a paper lists every claim and number, and draws its figures with those of railjoule.",
    )


def overview_html(papers: Mapping[str, Validation]) -> Markup:
    """Return the counts of each paper and of all of them as a table."""
    sums = {**{AUTHORS[name]: counts([paper]) for name, paper in papers.items()}, "All": counts(papers.values())}
    rows = [((name, *(f"{count}" for count in of.values())), name == "All") for name, of in sums.items()]
    header = ("Paper", *(markup("{}{}", word, info(word)) for word in counts(())))
    table = parts.table("", header, rows, "Papers")
    return markup('<div class="wide-table" tabindex="0" role="region" aria-label="Papers">{}</div>', table)


def reasons_html(papers: Mapping[str, Validation]) -> Markup:
    """Return the most frequent reasons of differences; those that differ only from a number on are one reason."""
    notes: dict[tuple[str, str], list[str]] = {}
    for name, paper in papers.items():
        for row in first_comparisons(paper.tables):
            if not row.is_close:
                notes.setdefault((AUTHORS[name], FROM_NUMBER.sub("", row.note)), []).append(row.note)
    often = sorted(notes.items(), key=lambda item: -len(item[1]))[:MOST_REASONS]
    rows = [
        ((author, f"{len(found)}", typeset(Counter(found).most_common(1)[0][0])), False) for (author, _), found in often
    ]
    table = parts.table("Main reasons of the differences", ("Paper", "Numbers", "Reason, or one of its cases"), rows)
    return markup('<div class="claims reasons"><div class="scroll" tabindex="0">{}</div></div>', table)


def refuted_html(papers: Mapping[str, Validation]) -> Markup:
    """Return the claims that railjoule refutes, with its own numbers."""
    rows = [
        ((f"{AUTHORS[name]}, {claim.place}", typeset(claim.claim), typeset(claim.found)), False)
        for name, paper in papers.items()
        for claim in paper.claims
        if claim.verdict == "refutes"
    ]
    if not rows:
        return Markup()
    table = parts.table("Refuted claims", ("Place", "Claim", "railjoule"), rows)
    return markup('<div class="claims refuted"><div class="scroll" tabindex="0">{}</div></div>', table)


def claims_html(claims: tuple[Claim, ...]) -> Markup:
    """Return the claims of a paper with the numbers of railjoule and the verdicts."""
    if not claims:
        return Markup()
    # what differs from the paper comes first
    order = ("refutes", "cannot be decided", "supports")
    rows = [(_claim_cells(claim), False) for claim in sorted(claims, key=lambda claim: order.index(claim.verdict))]
    return markup(
        '<details class="claims" open><summary>Claims<span>, {summary}</span></summary><div class="scroll" '
        'tabindex="0" role="region" aria-label="Claims">{body}</div></details>',
        summary=verdict_words(claims),
        body=parts.table("", ("Place", "Claim", "railjoule", "Verdict", "Reason"), rows, "Claims"),
    )


def verdict_words(claims: Iterable[Claim]) -> str:
    """Return how many claims have which verdict."""
    counts = Counter(claim.verdict for claim in claims)
    return f"{counts['supports']} supported, {counts['refutes']} refuted, {counts['cannot be decided']} undecided"


def _claim_cells(claim: Claim) -> tuple[str, ...]:
    token, word = VERDICTS[claim.verdict]
    verdict = markup('<b style="color:var(--rj-{})">{}</b>', token, word)
    return claim.place, typeset(claim.claim), typeset(claim.found), verdict, typeset(claim.reason)


def errata_html(errata: tuple[Erratum, ...]) -> Markup:
    """Return the corrections of a paper."""
    if not errata:
        return Markup()
    template = "<li>{}: printed {}, corrected: {}. {}</li>"
    items = joined(markup(template, *map(typeset, (e.place, e.printed, e.corrected, e.reason))) for e in errata)
    template = "<details><summary>Corrections <span>{}</span></summary><ol>{}</ol></details>"
    return markup(template, len(errata), items)
