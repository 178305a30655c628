"""The card of each file from the user: its content, and the open choices."""

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

from railjoule.core import RailjouleError
from railjoule.core.errors import ChoiceError, UnitError
from railjoule.core.imports import TABLE_KINDS, ImportedLine, read_line_table
from railjoule.core.imports.cells import CellTable
from railjoule.core.imports.columns import (
    ALL_POSITION_UNITS,
    STATION_ROLES,
    VALUE_UNITS,
    ResolvedColumns,
    resolve,
    resolve_stations,
)
from railjoule.core.imports.data_sheet import read_data_sheet_file
from railjoule.core.imports.findings import Finding, OtherUnit, without_name
from railjoule.core.imports.heights import USUAL_TOLERANCE_M
from railjoule.core.imports.numbers import text_of_cell
from railjoule.core.imports.source_file import encoding_mentioned
from railjoule.core.imports.ttobench import read_track, read_train
from railjoule.core.imports.vehicle import ImportedVehicle, checked_vehicle, questions, short_numbers
from railjoule.core.measured.columns import UNITS
from railjoule.dashboard.look.key_names import without_keys
from railjoule.dashboard.pages.files.brought import ENCODING, SHEET, Brought, find_selectors
from railjoule.dashboard.pages.files.columns import QUANTITY_WORDS, Meaning, Question
from railjoule.dashboard.pages.files.columns import UNIT_WORDS as RUN_UNIT_WORDS
from railjoule.dashboard.pages.files.measured import ReadRun

MOST_CHOICES = 300
"""Lines or tracks of one table among which the page lets choose."""
COMMAND_OPTION = re.compile(rf",? as (?:--encoding \w+|--reverse|(?:{'|'.join(TABLE_KINDS)})\.[^=]+=[^.,;]*)")
"""Form of an option of the command line in shared sentences; the page has menus for it."""

UNIT_WORDS = {
    "permille": "per mille",
    "percent": "per cent",
    "fraction": "m/m",
    "ratio": "1 in n",
    "deg": "degrees",
    "deg_arc": "degrees by arc",
    "per10000": "per 10 000",
    "m2": "m\u00b2",
    "pk": "km+m",
}
"""Names of units that are not their keys."""
CODE_PAGES = {
    "cp1250": "Central Europe (Windows-1250)",
    "cp1251": "Cyrillic (Windows-1251)",
    "cp1252": "Western Europe (Windows-1252)",
    "gb18030": "Chinese (GBK)",
    "iso8859_2": "Central Europe (Latin-2)",
    "koi8_u": "Cyrillic (KOI8)",
    "cp1253": "Greek (Windows-1253)",
    "cp1254": "Turkish (Windows-1254)",
    "cp932": "Japanese (Shift-JIS)",
    "cp949": "Korean (Windows-949)",
    "big5": "Chinese (Big5)",
}
"""Code pages that the user can choose for a text that is not UTF-8."""


ROLES_OF_KIND: Mapping[str, tuple[str, ...]] = {
    "gradients": ("from", "to", "value", "direction"),
    "heights": ("from", "value"),
    "neutral": ("from", "to"),
    "stations": STATION_ROLES,
}
"""Roles of columns, where they are not from, to and value."""
TOLERANCES_M = ("0.1", "0.3", "1", "2", "5", "10", "20")
"""Largest differences in height from which the user can choose [m]."""
ROLE_LABELS: Mapping[str, str] = {
    "from": "From",
    "to": "To",
    "value": "Value",
    "direction": "Rises or falls",
    "name": "Name",
    "position": "Position",
    "dwell": "Dwell time",
    "earliest": "Earliest arrival",
    "latest": "Latest arrival",
    "arrival": "Arrival",
    "departure": "Departure",
}
NEEDED = ("from", "value", "position", "position_unit", "value_unit", SHEET, ENCODING)
"""Keys of choices without which a file cannot be read."""


@dataclass(frozen=True)
class Choice:
    """One thing that can be chosen of a file.

    Parameters
    ----------
    key : str
    label : str
    options : tuple of (str, str)
        Values with the words for them; the choice is hidden where there are none.
    value : str
    sample : str
        The first values that it is about; what follows begins a new line.
    """

    key: str
    label: str
    options: tuple[tuple[str, str], ...]
    value: str
    sample: str = ""

    @property
    def is_missing(self) -> bool:
        """Whether the file cannot be read without it."""
        return not self.value and (self.key in NEEDED or self.key.startswith("rows "))


@dataclass(frozen=True, eq=False)
class Card:
    """The contents of one file.

    Parameters
    ----------
    number, name, kind : int, str, str
    cells : CellTable or None
        The cells of a table of the line.
    choices : tuple of Choice
        Its columns, units, line and track.
    result : ImportedTable or ImportedLine or ImportedVehicle or None
    findings, unused, questions : tuple
    failure : str
        Why it could not be read.
    """

    number: int
    name: str
    kind: str = ""
    cells: CellTable | None = None
    choices: tuple[Choice, ...] = ()
    result: Any = None
    findings: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()
    questions: tuple[Question, ...] = ()
    failure: str = ""

    @property
    def is_run(self) -> bool:
        """Whether it is a recorded run that could be read."""
        return self.kind == "run" and not self.failure

    def allows(self, key: str, value: str) -> bool:
        """Return whether the card offers a choice, as a message of a browser may hold anything."""
        chosen = any(one.key == key and value in dict(one.options) for one in self.choices)
        return chosen or any(one.key == key and value in dict(one.answers).values() for one in self.questions)


def build_card(file: Brought) -> Card:
    """Return the card of a file; an error in it becomes its failure, and is never raised."""
    card = Card(file.number, file.name)
    first = []
    try:
        card = replace(card, kind=file.kind)
        if file.kind == "run":
            card = replace(card, result=file.runs)
        else:
            is_table = file.kind in TABLE_KINDS
            card = _with_table(card, file) if is_table else _with_result(card, file, _read_other(file))
        if file.columns.sheet is not None:
            first.append(_menu(SHEET, "Sheet", file.cells.sheets, file.columns.sheet))
    except ChoiceError as error:
        card = replace(card, failure=str(error), choices=(_menu(SHEET, "Sheet", error.names),))
    except RailjouleError as error:
        card = _failed(card, file, str(error))
    except (MemoryError, RecursionError):
        return replace(card, failure=f"{file.name}: it is too large or too deeply nested to be read.")
    with suppress(RailjouleError):
        if file.code_page is not None:
            first.append(_menu(ENCODING, "Text in", tuple(CODE_PAGES), file.code_page, CODE_PAGES))
    return replace(card, choices=(*first, *card.choices))


def _menu(
    key: str,
    label: str,
    values: Sequence[str],
    value: str = "",
    shown: Mapping[str, str] | None = None,
    nothing: str = "choose",
) -> Choice:
    """Return a choice among values, or nothing; `shown` has the words for some of them."""
    options = ((one, (shown or {}).get(one, one)) for one in values[:MOST_CHOICES])
    return Choice(key, label, (("", nothing), *options), value)


def _failed(card: Card, file: Brought, sentence: str) -> Card:
    """Return the card of a file that could not be read: of an unknown table with its first rows."""
    card = replace(card, failure=COMMAND_OPTION.sub("", sentence))
    if not card.kind:
        with suppress(RailjouleError):
            return replace(card, cells=file.cells)
    return card


def _with_table(card: Card, file: Brought) -> Card:
    """Return the card of a table of intervals, with its columns even where it cannot be read yet."""
    cells, kind = file.cells, file.kind
    assert kind in TABLE_KINDS
    card = replace(card, cells=cells)
    columns: Mapping[str, str | None] = {}
    found: ResolvedColumns | None = None
    try:
        with encoding_mentioned(cells.findings):
            if kind == "stations":
                columns, found = resolve_stations(cells, file.wanted)
            else:
                found = resolve(cells, kind, file.wanted)
                columns = {"from": found.begin, "to": found.end, "value": found.value, "direction": found.direction}
    except RailjouleError as error:
        card = _failed(card, file, str(error))
    card = replace(card, choices=tuple(_choices(file, found, columns)))
    if found is None and not any("ILL_GradProfile" in column for column in cells.header):
        return card
    try:
        return _with_result(card, file, read_line_table(file.source, kind, file.wanted))
    except UnitError as error:
        # the menu beside it has the units under the names that the page has for them
        sentence = f"{str(error).partition('; name the unit')[0]}; choose the unit."
        return _with_unit_to_choose(_failed(card, file, sentence), error)
    except RailjouleError as error:
        return _failed(card, file, str(error))


def _with_unit_to_choose(card: Card, error: UnitError) -> Card:
    """Return a card on which a unit is to be chosen, with buttons where two are likely."""
    choices = tuple(replace(one, value="") if one.key == error.key else one for one in card.choices)
    if not error.likely:
        return replace(card, choices=choices)
    likely, kept = error.likely[0], error.likely[-1]
    use, keep = (UNIT_WORDS.get(unit, unit) for unit in (likely, kept))
    what = "Positions" if error.key == "position_unit" else "Values"
    answers = ((f"Use {use}", likely), (f"Keep {keep}", kept))
    question = Question(f"{what} in {use} or in {keep}?", error.key, answers)
    return replace(card, choices=choices, questions=(question,))


def _choices(file: Brought, found: ResolvedColumns | None, columns: Mapping[str, str | None]) -> Iterator[Choice]:
    """Yield the choices about a table's columns."""
    cells, kind, wanted = file.cells, file.kind, file.wanted
    for role in ROLES_OF_KIND.get(kind, ("from", "to", "value")):
        nothing = "none" if found else "choose"
        yield _menu(
            role, ROLE_LABELS[role], cells.header, columns.get(role) or wanted.columns.get(role, ""), nothing=nothing
        )
    guess = (found and found.position.unit) or wanted.position_unit or "m"
    yield _menu("position_unit", "Positions in", ALL_POSITION_UNITS, guess, UNIT_WORDS)
    if values := VALUE_UNITS[kind]:  # type: ignore[index]
        guess = (found and found.amount.unit) or wanted.value_unit or values[0]
        yield _menu("value_unit", "Times in" if kind == "stations" else "Values in", values, guess, UNIT_WORDS)
    if kind == "heights":
        usual = f"{USUAL_TOLERANCE_M:g} m, usual"
        value = "" if wanted.tolerance_m is None else f"{wanted.tolerance_m:g}"
        yield _menu("tolerance_m", "Tolerance", TOLERANCES_M, value, {one: f"{one} m" for one in TOLERANCES_M}, usual)
    for column in find_selectors(cells, tuple(columns.values())):
        texts = sorted({text_of_cell(cell) for _, cell in cells.column(column)} - {""})
        if len(texts) > 1:
            yield _menu(f"rows {column}", f"Only {column}", texts, wanted.rows.get(column, ""))


def _read_other(file: Brought) -> ImportedLine | ImportedVehicle | None:
    """Return the line or vehicle of a file; of a journey nothing, as it is read with its track."""
    source = file.source
    if file.kind == "track":
        return read_track(source)
    if file.kind in {"train", "sheet"}:
        read = read_train if file.kind == "train" else read_data_sheet_file
        return with_factors(read(source), file.factors)
    return None


def with_factors(imported: ImportedVehicle, factors: Mapping[str, float]) -> ImportedVehicle:
    """Return a vehicle with numbers in other units, and the questions that are left."""
    if not factors:
        return imported
    vehicle = {**imported.document["vehicle"]}
    for key, factor in factors.items():
        *path, last = key.split(".")
        table = vehicle
        for name in path:
            table[name] = dict(table.get(name, {}))
            table = table[name]
        if isinstance(table.get(last), int | float):
            table[last] = short_numbers(float(table[last]) * factor)
    checked = checked_vehicle(vehicle, imported.source)
    others = [finding for finding in imported.findings if finding.other_unit is None]
    asked = [one for one in questions(checked, imported.source) if one.other_unit is not None]
    return replace(
        imported,
        vehicle=checked,
        document={**imported.document, "vehicle": vehicle},
        findings=(*others, *(one for one in asked if factors.get(_unit(one).key) is None)),
    )


def _unit(finding: Finding) -> OtherUnit:
    assert finding.other_unit is not None
    return finding.other_unit


def _with_result(card: Card, file: Brought, result: Any) -> Card:
    if result is None:
        return card
    others = [finding for finding in result.findings if finding.other_unit is None]
    # first the questions that the user answers by other means
    others.sort(key=lambda finding: finding.kind != "question")
    return replace(
        card,
        result=result,
        findings=tuple(_shown(without_name(finding.sentence, file.name), file) for finding in others),
        unused=tuple(without_name(sentence, file.name) for sentence in result.unused),
        questions=tuple(_asked(finding) for finding in result.findings if finding.other_unit is not None),
    )


def _shown(sentence: str, file: Brought) -> str:
    # of a data sheet each finding lists keys with their assumed values
    if file.kind != "sheet":
        return sentence
    named = without_keys(f"{sentence[:1].lower()}{sentence[1:]}")
    return f"{named[:1].upper()}{named[1:]}"


def _asked(finding: Finding) -> Question:
    unit = _unit(finding)
    sentence = finding.sentence.partition(": ")[2]
    answers = ((f"Use {unit.meant}", f"{unit.factor:g}"), (f"Keep {unit.given}", "1"))
    return Question(sentence, f"factor {unit.key}", answers)


def describe_run(read: ReadRun, number: int) -> Card:
    """Return the columns of a recorded run with their meanings, and the questions about them."""
    choices = (choice for column in read.meanings.items() for choice in _choices_of_column(read, *column))
    questions = tuple(replace(one, sentence=f"{one.header}: {one.sentence}") for one in read.doubts)
    name = read.file.name
    return Card(number, name, "run", choices=tuple(choices), questions=questions, failure=read.refusal)


def _choices_of_column(read: ReadRun, header: str, meaning: Meaning) -> Iterator[Choice]:
    """Yield quantities and units that a column of a run may hold; values are texts of meanings."""
    yield Choice(f"meaning {header}", header, tuple(QUANTITY_WORDS.items()), meaning.quantity)
    units = UNITS.get(meaning.quantity, {})
    options = tuple((Meaning(meaning.quantity, unit).text, RUN_UNIT_WORDS.get(unit, unit)) for unit in units)
    unnamed = (("", "choose"),) if options and not meaning.unit else ()
    samples = ", ".join(read.file.samples(header))
    yield Choice(
        f"unit {header}", f"Unit of {header}", (*unnamed, *options), meaning.text if meaning.unit else "", samples
    )


def read_meaning(key: str, value: str) -> tuple[str, str]:
    """Return the column that a choice of a run is about, and the text of what it then means."""
    what, _, header = key.partition(" ")
    first = next(iter(UNITS.get(value, {})), "")
    return header, Meaning(value, first).text if what == "meaning" else value
