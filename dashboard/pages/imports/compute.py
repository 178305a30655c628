"""What is read from the files that a user brings, and the scenarios that can be made of it."""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.resources import files
from typing import Any

from railjoule.core import RailjouleError, Scenario, ScenarioError
from railjoule.core.errors import ChoiceError
from railjoule.core.imports import (
    INTERVAL_KINDS,
    Finding,
    ImportedLine,
    ImportedTable,
    SourceFile,
    line_of,
    read_intervals,
)
from railjoule.core.imports.columns import VALUE_UNITS, ResolvedColumns, resolve
from railjoule.core.imports.findings import OtherUnit, without_name
from railjoule.core.imports.intervals import SHORTEST_LINE_M
from railjoule.core.imports.numbers import COMPOUND_UNITS, POSITION_UNITS, position_of, text_of_cell
from railjoule.core.imports.osrd_run import read_osrd_line
from railjoule.core.imports.osrd_stock import read_osrd_stock
from railjoule.core.imports.parts import checked_vehicle
from railjoule.core.imports.railtoolkit import read_railtoolkit
from railjoule.core.imports.ttobench import read_track, read_train, read_ttobench
from railjoule.core.imports.vehicle import ImportedVehicle, questions, short_numbers
from railjoule.core.scenario import format_scenario, scenario_from_document
from railjoule.core.scenario.document import document_of
from railjoule.core.strategies import prepare_task
from railjoule.dashboard.pages.imports.brought import CHOSEN, SHEET, Brought, selectors_of

FIRST_ROWS = 4
"""Rows of each file that are shown."""
MOST_CHOICES = 300
"""Lines or tracks of one table among which the page lets choose."""
SLACK = 0.1
"""Of the travel time that is proposed, over the shortest."""
LONGEST_TIME_S = 86_400.0
EXAMPLES = ("limits", "gradients", "curves")
TOLD_IN_A_TERMINAL = re.compile(rf",? as (?:{'|'.join(INTERVAL_KINDS)})\.[^=]+=[^.,]*")
"""How an option of the command line is written, in sentences that both tell; on the page there are menus for it."""
TABLES_AND_LINE = "the line of the tables is taken"


@dataclass(frozen=True)
class Choice:
    """One thing that can be chosen of a file: its key, what it is called, what there is, and what is chosen."""

    key: str
    label: str
    options: tuple[tuple[str, str], ...]
    value: str


@dataclass(frozen=True)
class Question:
    """A number in doubt: in words, and both answers with what each says when it is sent."""

    sentence: str
    use: str
    keep: str
    key: str
    value: str
    kept: str


@dataclass(frozen=True, eq=False)
class Card:
    """What is known of one file.

    Parameters
    ----------
    number, name, kind : int, str, str
    header, rows : tuple
        The first rows of a table.
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
    header: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    row_count: int = 0
    choices: tuple[Choice, ...] = ()
    result: Any = None
    findings: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()
    questions: tuple[Question, ...] = ()
    failure: str = ""


@dataclass(frozen=True)
class Stretch:
    """The part of the line that is wanted, as it was typed, and whether it is run in falling chainage."""

    begin: str = ""
    end: str = ""
    reverse: bool = False


@dataclass(frozen=True, eq=False)
class Offer:
    """A scenario that can be taken: with the line, with the train, or with both.

    Parameters
    ----------
    what : str
    document : mapping
        It, without the timetable.
    shortest_s, time_s : float
        The shortest travel time, and the one that is proposed.
    why : str
        Where the proposed time is from.
    failure : str
        Why no train can run it.
    """

    what: str
    document: Mapping[str, Any]
    shortest_s: float = 0.0
    time_s: float = 0.0
    why: str = ""
    failure: str = ""


@dataclass(frozen=True, eq=False)
class Request:
    """All files, the wanted stretch, and the scenario whose vehicle or line stays where none is brought."""

    files: tuple[Brought, ...]
    stretch: Stretch
    base: Scenario


@dataclass(frozen=True, eq=False)
class Reading:
    """What all files together give.

    Parameters
    ----------
    cards : tuple of Card
    line : ImportedLine or None
    tables : tuple of ImportedTable
        Of which the line was put together.
    vehicle : ImportedVehicle or None
    travel_time_s : float or None
        What a journey says.
    findings, unused : tuple of str
        Of the line as a whole.
    failure : str
        Why there is no line.
    offers : tuple of Offer or None
        None while they are being computed.
    """

    cards: tuple[Card, ...] = ()
    line: ImportedLine | None = None
    tables: tuple[ImportedTable, ...] = ()
    vehicle: ImportedVehicle | None = None
    travel_time_s: float | None = None
    findings: tuple[str, ...] = ()
    unused: tuple[str, ...] = ()
    failure: str = ""
    offers: tuple[Offer, ...] | None = None
    extra: Mapping[str, Any] = field(default_factory=dict)


@cache
def examples() -> tuple[SourceFile, ...]:
    """Return the files of the shipped example, an invented line in the columns that SNCF publishes."""
    folder = files("railjoule.assets") / "imports"
    return tuple(SourceFile(f"example-{name}.csv", (folder / f"example-{name}.csv").read_bytes()) for name in EXAMPLES)


def read_files(request: Request) -> Iterator[Reading]:
    """Yield what the files give, then the same with the scenarios that can be made of it."""
    if not request.files:
        yield Reading(offers=())
        return
    reading = put_together(tuple(card_of(file) for file in request.files), request)
    yield reading
    yield replace(reading, offers=tuple(offers_of(reading, request.base)))


# ---- one file


def card_of(file: Brought) -> Card:
    """Return what is known of a file; what is wrong with it is told, never raised."""
    card = Card(file.number, file.name)
    try:
        card = replace(card, kind=file.kind)
        if file.kind in INTERVAL_KINDS:
            return _with_several(_with_table(card, file), file)
        return _with_several(_with_result(card, file, _read_other(file)), file)
    except ChoiceError as error:
        return replace(card, failure=str(error), choices=(_one_of(error.what, error.names, ""),))
    except RailjouleError as error:
        return _failed(card, file, str(error))
    except (MemoryError, RecursionError):
        return replace(card, failure=f"{file.name}: it is too large or too deeply nested to be read.")


def _with_several(card: Card, file: Brought) -> Card:
    """Return the card of a file that holds several sheets, trains or paths with the choice among them first."""
    several = _others(file)
    return card if several is None else replace(card, choices=(several, *card.choices))


def _others(file: Brought) -> Choice | None:
    """Return the choice among what a file holds several of; None where it holds one alone."""
    if file.columns.sheet is not None:
        return _one_of(SHEET, file.cells.sheets, file.columns.sheet)
    if file.chosen is None:
        return None
    try:
        _read_other(replace(file, chosen=None))
    except ChoiceError as error:
        return _one_of(error.what, error.names, file.chosen)
    return None


def _one_of(what: str, names: Sequence[str], value: str) -> Choice:
    options = (("", "choose"), *((name, name) for name in names[:MOST_CHOICES]))
    return Choice(SHEET if what == SHEET else CHOSEN, what.capitalize(), options, value)


def _failed(card: Card, file: Brought, sentence: str) -> Card:
    """Return the card of a file that could not be read: of a table nobody knows, with its first rows."""
    card = replace(card, failure=TOLD_IN_A_TERMINAL.sub("", sentence))
    if card.kind:
        return card
    try:
        return _with_rows(card, file)
    except RailjouleError:
        return card


def _with_rows(card: Card, file: Brought) -> Card:
    cells = file.cells
    rows = tuple(tuple(map(text_of_cell, row)) for _, row in cells.rows[:FIRST_ROWS])
    return replace(card, header=cells.header, rows=rows, row_count=len(cells.rows))


def _with_table(card: Card, file: Brought) -> Card:
    """Return the card of a table of intervals, with its columns even where it cannot be read yet."""
    cells, kind = file.cells, file.kind
    assert kind in INTERVAL_KINDS
    card = _with_rows(card, file)
    try:
        found: ResolvedColumns | None = resolve(cells, kind, file.wanted)
    except RailjouleError as error:
        found, card = None, _failed(card, file, str(error))
    card = replace(card, choices=tuple(_choices(file, found)))
    if found is None and not any("ILL_GradProfile" in column for column in cells.header):
        return card
    try:
        table = read_intervals(file.source, kind, file.wanted)
    except RailjouleError as error:
        return _failed(card, file, str(error))
    card, asked = _with_result(card, file, table), tuple(_about_positions(file, table))
    told = {without_name(question.sentence, file.name) for question in asked}
    return replace(card, questions=asked, findings=tuple(one for one in card.findings if one not in told))


def _choices(file: Brought, found: ResolvedColumns | None) -> Iterator[Choice]:
    """Yield what can be said of a table's columns."""
    cells, kind, wanted = file.cells, file.kind, file.wanted
    columns = tuple((name, name) for name in cells.header)
    named = wanted.columns
    roles = [("from", "From", found and found.begin), ("to", "To", found and found.end)]
    if kind != "neutral":
        roles.append(("value", "Value", found and found.value))
    if kind == "gradients":
        roles.append(("direction", "Rises or falls", found and found.direction))
    for role, label, column in roles:
        free = (("", "none" if found else "choose"), *columns)
        yield Choice(role, label, free, column or named.get(role, ""))
    units = (*POSITION_UNITS, *COMPOUND_UNITS)
    guess = (found and found.position_unit) or wanted.position_unit or "m"
    yield Choice("position_unit", "Positions in", tuple((unit, unit) for unit in units), guess)
    if values := VALUE_UNITS[kind]:  # type: ignore[index]
        unit = (found and found.value_unit) or wanted.value_unit or values[0]
        words = {"permille": "per mille", "percent": "per cent", "ratio": "1:n", "m2": "m\u00b2"}
        yield Choice("value_unit", "Values in", tuple((value, words.get(value, value)) for value in values), unit)
    used = (found.begin, found.end, found.value, found.direction) if found else ()
    for column in selectors_of(cells, used):
        texts = sorted({text_of_cell(cell) for _, cell in cells.column(column)} - {""})
        if len(texts) > 1:
            options = (("", "choose"), *((text, text) for text in texts[:MOST_CHOICES]))
            yield Choice(f"rows {column}", f"Only {column}", options, wanted.rows.get(column, ""))


def _about_positions(file: Brought, table: ImportedTable) -> Iterator[Question]:
    """Yield the question about positions that make a line too short for any train."""
    if 0 < table.end_m - table.begin_m < SHORTEST_LINE_M and file.columns.position_unit is None:
        told = next(one.sentence for one in table.findings if one.kind == "question")
        yield Question(told, "Use km", "Keep m", "position_unit", "km", "m")


def _read_other(file: Brought) -> ImportedLine | ImportedVehicle | None:
    """Return the line or vehicle of a file; of a journey nothing, as it is read with its track."""
    source = file.source
    if file.kind == "track":
        return read_track(source)
    if file.kind == "train":
        return with_factors(read_train(source), file.factors)
    if file.kind == "stock":
        return with_factors(read_osrd_stock(source, wanted=file.chosen), file.factors)
    if file.kind == "osrd_run":
        return read_osrd_line(source, sheet=file.columns.sheet)
    if file.kind == "railtoolkit":
        found = read_railtoolkit(source, file.chosen)
        return with_factors(found, file.factors) if isinstance(found, ImportedVehicle) else found
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
    asked = [finding for finding in result.findings if finding.other_unit is not None]
    told = [finding for finding in result.findings if finding.other_unit is None and finding.kind != "question"]
    plain = [finding for finding in result.findings if finding.other_unit is None and finding.kind == "question"]
    # questions that the user answers by other means stand with what is told
    return replace(
        card,
        result=result,
        findings=tuple(without_name(finding.sentence, file.name) for finding in (*plain, *told)),
        unused=tuple(without_name(sentence, file.name) for sentence in result.unused),
        questions=tuple(_asked(finding) for finding in asked),
    )


def _asked(finding: Finding) -> Question:
    unit = _unit(finding)
    sentence = finding.sentence.partition(": ")[2]
    return Question(sentence, f"Use {unit.meant}", f"Keep {unit.given}", f"factor {unit.key}", f"{unit.factor:g}", "1")


# ---- all files together


def put_together(cards: Sequence[Card], request: Request) -> Reading:
    """Return the line and the vehicle of all cards; of two that tell of the same the last one counts."""
    kinds = {card.kind: card for card in cards if not card.failure}
    unused = [
        f"{card.name}: {kinds[card.kind].name} is taken for it."
        for card in cards
        if not card.failure and kinds[card.kind] is not card
    ]
    taken = list(kinds.values())
    tables = {card.kind: card.result for card in taken if isinstance(card.result, ImportedTable)}
    lines = [card for card in taken if isinstance(card.result, ImportedLine)]
    trains = [card for card in taken if isinstance(card.result, ImportedVehicle)]
    unused += [f"{card.name}: {TABLES_AND_LINE}." for card in lines if tables]
    unused += [f"{card.name}: the line of {lines[-1].name} is taken." for card in lines[:-1] if not tables]
    unused += [f"{card.name}: the train of {trains[-1].name} is taken." for card in trains[:-1]]
    reading = Reading(tuple(cards), vehicle=trains[-1].result if trains else None, unused=tuple(unused))
    try:
        if tables:
            return _with_tables(reading, tables, request.stretch)
        if lines:
            return _with_line(reading, lines[-1], taken, request.files)
    except RailjouleError as error:
        return replace(reading, failure=str(error))
    if "journey" in kinds:
        return replace(reading, failure=f"{kinds['journey'].name}: it needs its track and its train; add both.")
    return reading


def _with_tables(reading: Reading, tables: Mapping[str, ImportedTable], stretch: Stretch) -> Reading:
    """Return the reading with the line that tables make."""
    line = line_of(
        **tables,  # type: ignore[arg-type]
        begin_m=_place("From", stretch.begin),
        end_m=_place("To", stretch.end),
        reverse=stretch.reverse,
        name=_line_name(tables),
    )
    known = {finding.sentence for table in tables.values() for finding in table.findings}
    unused = {sentence for table in tables.values() for sentence in table.unused}
    return replace(
        reading,
        line=line,
        tables=tuple(tables.values()),
        findings=tuple(one.sentence for one in line.findings if one.sentence not in known),
        unused=(*reading.unused, *(sentence for sentence in line.unused if sentence not in unused)),
    )


def _line_name(tables: Mapping[str, ImportedTable]) -> str:
    first = next(iter(tables.values())).source
    return f"Line of {first.rpartition('.')[0] or first}"[:200]


def _place(label: str, text: str) -> float | None:
    if not text.strip():
        return None
    try:
        return position_of(text.strip(), "m", ".")
    except ValueError as error:
        raise ScenarioError(f"{label}: {text[:40]!r} {error}.") from None


def _with_line(reading: Reading, card: Card, taken: Sequence[Card], brought: Sequence[Brought]) -> Reading:
    """Return the reading with the line of one file; that of TTOBench with what its train and its journey say of it."""
    by_kind = {one.kind: next(file for file in brought if file.number == one.number) for one in taken}
    if card.kind != "track" or "train" not in by_kind:
        return replace(reading, line=card.result)
    journey = by_kind.get("journey")
    made = read_ttobench(by_kind["track"].source, by_kind["train"].source, journey.source if journey else None)
    line = replace(card.result, document={"line": made.document["line"]}, line=made.line)
    told = (*card.result.sentences, *(reading.vehicle.sentences if reading.vehicle else ()))
    return replace(
        reading,
        line=line,
        travel_time_s=made.travel_time_s,
        extra={key: value for key, value in made.document.get("timetable", {}).items() if key != "travel_time_s"},
        findings=tuple(one.sentence for one in made.findings if one.sentence not in told and one.other_unit is None),
        unused=(*reading.unused, *(sentence for sentence in made.unused if sentence not in told)),
    )


# ---- scenarios


def offers_of(reading: Reading, base: Scenario) -> Iterator[Offer]:
    """Yield the scenarios that can be made of a reading and of what stands on the page."""
    if reading.line is None and reading.vehicle is None:
        return
    own = document_of(base)
    kept: dict[str, Any] = {key: own[key] for key in ("vehicle", "drive") if key in own}
    line = reading.line.document["line"] if reading.line is not None else None
    train = _vehicle_of(reading.vehicle, base) if reading.vehicle is not None else None
    if line is not None and train is not None:
        yield _offer("both", {**train, "line": line}, reading, None)
    if line is not None:
        yield _offer("line", {**kept, "line": line}, reading, None)
    if train is not None:
        yield _offer("train", {**train, "line": own["line"]}, reading, base.travel_time_s)


def _vehicle_of(imported: ImportedVehicle, base: Scenario) -> dict[str, Any]:
    """Return the vehicle's table with as many on board as now, as far as it carries them."""
    vehicle = imported.document["vehicle"]
    if not imported.vehicle.capacity_passengers * imported.vehicle.passenger_mass_kg:
        return {"vehicle": vehicle}
    load = min(base.vehicle.load_factor, imported.vehicle.crush_load_factor)
    return {"vehicle": {**vehicle, "load_factor": load}}


def _offer(what: str, document: Mapping[str, Any], reading: Reading, now_s: float | None) -> Offer:
    """Return a scenario with its shortest time and the time that is proposed."""
    timetable = reading.extra if what == "both" else {}
    titled: dict[str, Any] = {**document, "timetable": {**timetable, "travel_time_s": LONGEST_TIME_S}}
    try:
        scenario = scenario_from_document(titled, "the import")
        titled["title"] = f"{scenario.line.name or 'Own line'}, {scenario.vehicle.name or 'own train'}"[:200]
        shortest = prepare_task(scenario).shortest_travel_time_s
    except RailjouleError as error:
        return Offer(what, titled, failure=str(error))
    except MemoryError:
        return Offer(what, titled, failure="It takes more memory than the server has.")
    time, why = float(math.ceil((1 + SLACK) * shortest)), "1.1 \u00d7 the shortest"
    if what == "both" and reading.travel_time_s is not None:
        time, why = reading.travel_time_s, "the journey\u2019s"
    elif now_s is not None and now_s >= shortest:
        time, why = round(now_s, 1), "as now"
    return Offer(what, titled, shortest, time, why)


def taken(offer: Offer, time_s: float) -> str:
    """Return the scenario of an offer with a travel time, as TOML.

    Raises
    ------
    ScenarioError
        If the time is too short or too long.
    """
    # up to the tenth of a second that the page shows
    if not offer.shortest_s - 0.05 <= time_s <= LONGEST_TIME_S:
        raise ScenarioError(
            f"Travel time: {time_s:g} s must be at least the shortest possible {offer.shortest_s:.1f} s and at most "
            f"{LONGEST_TIME_S:g} s."
        )
    timetable = {**offer.document["timetable"], "travel_time_s": time_s}
    return format_scenario(scenario_from_document({**offer.document, "timetable": timetable}, "the import"))
