"""The papers' files: printed numbers, and the descriptions of the tables and claims that are compared with railjoule.

Rows and claims are data of `assets/papers/<paper>.toml`; the modules of the papers compute the quantities that they
name.

- `[[comparison]]` is one table: `title`, `place` and `reference` as in `Table`, and its `groups` of rows.
- A group names the function that computes its quantities, `compute`, and one argument for each call, `each`: the key
  of a list in the same file, or the list itself. The function returns a mapping of quantities, or several of them. For
  each mapping, the group has the same `rows`; what they have in common stands in the group.
- A row has `case`, `quantity`, `unit`, `note` and `source` as in `Row`, and the paths of its numbers, `printed` and
  `value`, such as `above[1]`. A note is a text or the key of one in `[notes]`; it is shown where the quantity of the
  path `when` is true, if there is one. Texts can contain the argument, or its items.
- A `[[claim]]` has `compute` and the argument `of` for its quantities, its `place` and `text` in the paper, the texts
  `found` and `reason`, and its tolerances: it is supported if each quantity of `holds_between` lies strictly between
  its two bounds, and cannot be decided without bounds. Claims of one kind share the entries of `[kinds]` that they
  name as their `kind`. Several mappings are the list `all`.
- A `[[rebuilt]]` figure has `place`, `caption`, `scenario` and `changes` as in `PaperFigure`, and `compute` with the
  argument `of` for its data.

All texts can contain quantities as in `str.format`.
"""

from collections.abc import Iterator, Mapping
from functools import partial
from string import Formatter
from types import ModuleType
from typing import Any

from railjoule.core.citation import printed_numbers
from railjoule.core.validation.table import Claim, Comparison, Erratum, PaperFigure, Row, Table, Verdict

Quantities = Mapping[str, Any]


def citation(paper: dict[str, Any]) -> str:
    """Return authors, title, journal and year of a paper in one line."""
    place = paper.get("journal") or f"doi {paper['doi']}"
    authors = ", ".join(name.rpartition(" ")[2] for name in paper["authors"])
    return f"{authors}: {paper['title']}, {place}, {paper['year']}"


def compare(name: str, quantities: ModuleType, figures: ModuleType) -> Comparison:
    """Return the tables and claims of a paper, not computed yet.

    Parameters
    ----------
    name : str
        Name of its file, such as 'ftorek-2025'.
    quantities : module
        Contains the functions that tables and claims of the file name.
    figures : module
        Contains the functions that its figures name.
    """
    paper = printed_numbers(name)
    return Comparison(
        paper=name.partition("-")[0],
        citation=citation(paper),
        tables=tuple(partial(_table, paper, quantities, table) for table in paper["comparison"]),
        errata=tuple(Erratum(**entry) for entry in paper["erratum"]),
        claims=tuple(partial(_claim, paper, quantities, claim) for claim in paper["claim"]),
        figures=tuple(_figure(figures, entry) for entry in paper.get("rebuilt", ())),
    )


def _table(paper: Quantities, module: ModuleType, table: Quantities) -> Table:
    rows = tuple(row for group in table["groups"] for row in _rows(paper, module, group))
    return Table(table["title"], rows, table.get("place", ""), table.get("reference", "printed"))


def _rows(paper: Quantities, module: ModuleType, group: Quantities) -> Iterator[Row]:
    each = group.get("each", [None])
    for argument in paper[each] if isinstance(each, str) else each:
        entry = argument if isinstance(argument, Mapping) else {"argument": argument}
        computed = _computed(module, group, argument)
        for quantities in computed if isinstance(computed, list) else [computed]:
            for row in group["rows"]:
                yield _row({**group, **row}, quantities, entry, paper["notes"])


def _row(row: Quantities, quantities: Quantities, entry: Quantities, notes: Mapping[str, str]) -> Row:
    # A printed number and the computed one can have the same name in an entry of the file and in the quantities.
    words = {**entry, **quantities}
    words |= {key: row.get(key, "").format_map(words) for key in ("case", "quantity")}
    is_noted = "note" in row and ("when" not in row or _at(row["when"], words))
    note = row["note"].format_map(words) if is_noted else ""
    return Row(
        case=words["case"],
        quantity=words["quantity"],
        unit=row.get("unit", "").format_map(words),
        printed=_at(row["printed"], {**quantities, **entry}) if "printed" in row else None,
        value=float(_at(row["value"], quantities)),
        note=notes[note].format_map(words) if note in notes else note,
        source=row.get("source", "").format_map(words),
    )


def _claim(paper: Quantities, module: ModuleType, claim: Quantities) -> Claim:
    claim = {**(paper["kinds"][claim["kind"]] if "kind" in claim else {}), **claim}
    quantities = _computed(module, claim, claim.get("of")) if "compute" in claim else {}
    if isinstance(quantities, list):
        quantities = {"all": quantities}
    bounds = claim.get("holds_between", {})
    holds = all(low < _at(path, quantities) < high for path, (low, high) in bounds.items())
    verdict: Verdict = "cannot be decided" if not bounds else "supports" if holds else "refutes"
    found, reason = (claim[key].format_map(quantities) for key in ("found", "reason"))
    return Claim(claim["place"], claim["text"], found, verdict, reason)


def _figure(module: ModuleType, entry: Quantities) -> PaperFigure:
    compute = partial(_computed, module, entry, entry.get("of"))
    return PaperFigure(entry["place"], entry["caption"], compute, entry["scenario"], entry.get("changes", {}))


def _computed(module: ModuleType, entry: Quantities, argument: Any) -> Any:
    """Return the quantities of a group or claim, or the data of a figure, for one argument."""
    function = getattr(module, entry["compute"])
    return function() if argument is None else function(argument)


def _at(path: str, quantities: Quantities) -> Any:
    """Return the quantity at a path such as `above[1]`."""
    return Formatter().get_field(path, (), quantities)[0]
