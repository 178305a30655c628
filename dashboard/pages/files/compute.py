"""The line and the train in the files that a user brings, and the scenarios that can be made of them."""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from railjoule.core import RailjouleError, Scenario, ScenarioError
from railjoule.core.imports import TABLE_KINDS, ImportedLine, ImportedTable, LineTable, build_line
from railjoule.core.imports.numbers import parse_position
from railjoule.core.imports.ttobench import read_ttobench
from railjoule.core.imports.vehicle import ImportedVehicle
from railjoule.core.scenario import format_scenario, parse_scenario, scenario_from_document
from railjoule.core.scenario.document import to_document
from railjoule.core.strategies import prepare_task
from railjoule.core.studies import StudyTable, assumption_steps
from railjoule.dashboard.pages.files.brought import TABLE_WORDS, Brought
from railjoule.dashboard.pages.files.cards import Card, card_of
from railjoule.dashboard.pages.files.columns import RunFile

SLACK = 0.1
"""Of the travel time that is proposed, over the shortest."""
LONGEST_TIME_S = 86_400.0
KINDS_OF_LINES = (*TABLE_KINDS, "track", "journey")
TABLES_AND_LINE = "the line of the tables is taken"


@dataclass(frozen=True)
class Stretch:
    """The part of the line that is wanted, as it was typed, whether it is run in falling chainage, and its name."""

    begin: str = ""
    end: str = ""
    reverse: bool = False
    name: str = ""


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
        The origin of the proposed time.
    failure : str
        Why no train can run it.
    waits_for : tuple of str
        In words what is missing, as its files could not be read: the user must say that it is to be taken without.
    """

    what: str
    document: Mapping[str, Any]
    shortest_s: float = 0.0
    time_s: float = 0.0
    why: str = ""
    failure: str = ""
    waits_for: tuple[str, ...] = ()

    @property
    def waiting(self) -> str:
        """Why it is not taken."""
        parts = " and ".join(self.waits_for)
        return f"It waits for {parts}, which cannot be read: answer what the file\u2019s card asks, or use it without."


@dataclass(frozen=True)
class Request:
    """All files, the wanted stretch, and the scenario whose vehicle or line stays where none is brought."""

    files: tuple[Brought, ...]
    stretch: Stretch
    base: Scenario


@dataclass(frozen=True, eq=False)
class Reading:
    """The line, the train and the runs of all files together.

    Parameters
    ----------
    cards : tuple of Card
    line : ImportedLine or None
    tables : tuple of ImportedTable
        Of which the line was put together.
    vehicle : ImportedVehicle or None
    travel_time_s : float or None
        That of a journey.
    findings, unused : tuple of str
        Of the line as a whole.
    runs : tuple of RunFile
        Recorded runs.
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
    runs: tuple[RunFile, ...] = ()
    failure: str = ""
    offers: tuple[Offer, ...] | None = None
    extra: Mapping[str, Any] = field(default_factory=dict)


def read_files(request: Request) -> Iterator[Reading]:
    """Yield what the files give, then the same with the scenarios that can be made of it."""
    reading = put_together(tuple(card_of(file) for file in request.files), request)
    yield reading
    yield replace(reading, offers=tuple(offers_of(reading, request.base)))


# ---- all files together


def put_together(cards: Sequence[Card], request: Request) -> Reading:
    """Return the line and the vehicle of all cards; of two that tell of the same the last one counts."""
    read = [card for card in cards if not card.failure]
    runs = tuple(run for card in read if card.is_run for run in card.result)
    read = [card for card in read if not card.is_run]
    kinds = {card.kind: card for card in read}
    unused = [f"{card.name}: {kinds[card.kind].name} is taken for it." for card in read if kinds[card.kind] is not card]
    tables = {card.kind: card.result for card in kinds.values() if isinstance(card.result, LineTable)}
    track = kinds.get("track")
    if track is not None and tables:
        unused.append(f"{track.name}: {TABLES_AND_LINE}.")
    # of a train of TTOBench and one of a data sheet the last one counts, too
    trains = [card for card in kinds.values() if isinstance(card.result, ImportedVehicle)]
    train = max(trains, key=lambda card: card.number).result if trains else None
    reading = Reading(tuple(cards), vehicle=train, unused=tuple(unused), runs=runs)
    try:
        if tables:
            return with_name(_with_tables(reading, tables, request.stretch), request.stretch.name)
        if track is not None:
            return with_name(_with_track(reading, kinds, request.files), request.stretch.name)
    except RailjouleError as error:
        return replace(reading, failure=str(error))
    if "journey" in kinds:
        return replace(reading, failure=f"{kinds['journey'].name}: it needs its track and its train; add both.")
    return reading


def _with_tables(reading: Reading, tables: Mapping[str, LineTable], stretch: Stretch) -> Reading:
    """Return the reading with the line that tables make."""
    line = build_line(
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
        tables=tuple(table for table in tables.values() if isinstance(table, ImportedTable)),
        findings=tuple(one.sentence for one in line.findings if one.sentence not in known),
        unused=(*reading.unused, *(sentence for sentence in line.unused if sentence not in unused)),
    )


def _line_name(tables: Mapping[str, LineTable]) -> str:
    first = next(iter(tables.values())).source
    return f"Line of {first.rpartition('.')[0] or first}"[:200]


def with_name(reading: Reading, name: str) -> Reading:
    """Return the reading with another name of its line; an empty one changes nothing."""
    line = reading.line
    if not name or line is None:
        return reading
    document = {**line.document, "line": {**line.document["line"], "name": name}}
    return replace(reading, line=replace(line, document=document, line=line.line.model_copy(update={"name": name})))


def _place(label: str, text: str) -> float | None:
    if not text.strip():
        return None
    try:
        return parse_position(text.strip(), "m", ".")
    except ValueError as error:
        raise ScenarioError(f"{label}: {text[:40]!r} {error}.") from None


def _with_track(reading: Reading, kinds: Mapping[str, Card], files: Sequence[Brought]) -> Reading:
    """Return the reading with the line of TTOBench, and with what its train and its journey say of it."""
    track = kinds["track"].result
    if "train" not in kinds:
        return replace(reading, line=track)
    sources = {file.number: file.source for file in files}
    of_train, of_track = (sources[kinds[kind].number] for kind in ("train", "track"))
    journey = sources[kinds["journey"].number] if "journey" in kinds else None
    made = read_ttobench(of_track, of_train, journey)
    line = replace(track, document={"line": made.document["line"]}, line=made.line)
    told = (*track.sentences, *(reading.vehicle.sentences if reading.vehicle else ()))
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
    own = to_document(base)
    kept: dict[str, Any] = {key: own[key] for key in ("vehicle", "drive") if key in own}
    line = reading.line.document["line"] if reading.line is not None else None
    train = _vehicle_of(reading.vehicle, base) if reading.vehicle is not None else None
    if line is not None and train is not None:
        yield replace(_offer("both", {**train, "line": line}, reading, None), waits_for=refused_parts(reading, ()))
    if line is not None:
        offer = _offer("line", {**kept, "line": line}, reading, None)
        yield replace(offer, waits_for=refused_parts(reading, ("train",)))
    if train is not None:
        offer = _offer("train", {**train, "line": own["line"]}, reading, base.travel_time_s)
        yield replace(offer, waits_for=refused_parts(reading, KINDS_OF_LINES))


def refused_parts(reading: Reading, others: Collection[str]) -> tuple[str, ...]:
    """Return in words what the files tell that could not be read, but for `others`, kinds that do not matter."""
    refused = [card for card in reading.cards if card.failure and card.kind not in (*others, "run")]
    words = (f"the {TABLE_WORDS[card.kind].lower()}" if card.kind in TABLE_WORDS else card.name for card in refused)
    return tuple(dict.fromkeys(words))


def _vehicle_of(imported: ImportedVehicle, base: Scenario) -> dict[str, Any]:
    """Return the vehicle's table with as many on board as now, as far as it carries them."""
    vehicle = imported.document["vehicle"]
    if not imported.vehicle.capacity_passengers * imported.vehicle.passenger_mass_kg:
        return {"vehicle": vehicle}
    load = min(base.vehicle.load_share, imported.vehicle.crush_load_factor)
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
    by_stations = reading.line.travel_time_s if reading.line is not None else None
    if what != "train" and by_stations is not None:
        time, why = by_stations, "that of the table of stations"
    elif what == "both" and reading.travel_time_s is not None:
        time, why = reading.travel_time_s, "the journey\u2019s"
    elif now_s is not None and now_s >= shortest:
        time, why = round(now_s, 1), "as now"
    return Offer(what, titled, shortest, time, why)


def assumed_effects(offer: Offer) -> Iterator[StudyTable]:
    """Yield the effects of the vehicle's assumptions on the scenario of an offer in its proposed time, run by run."""
    yield from assumption_steps(parse_scenario(taken(offer, offer.time_s), "the import"))


def taken(offer: Offer, time_s: float) -> str:
    """Return the scenario of an offer with a travel time, as TOML."""
    timetable = {**offer.document["timetable"], "travel_time_s": time_s}
    return format_scenario(scenario_from_document({**offer.document, "timetable": timetable}, "the import"))
