"""The parts of Import that the browser draws: the files with their columns, and what can be taken of them."""

from collections.abc import Callable
from typing import Any

import param

from railjoule.core import Scenario
from railjoule.core.imports import ImportedLine
from railjoule.core.imports.vehicle import ImportedVehicle
from railjoule.core.scenario._sentences import counted
from railjoule.dashboard.editor.forms import Form
from railjoule.dashboard.look import words
from railjoule.dashboard.look.scripts import module
from railjoule.dashboard.pages.imports.brought import ENCODING, KIND_WORDS, SHEET, TABLE_WORDS
from railjoule.dashboard.pages.imports.cards import Card, Choice
from railjoule.dashboard.pages.imports.compute import Offer, Stretch, examples, waiting_words
from railjoule.dashboard.pages.imports.model import MAX_FILE_BYTES, ImportModel, Wanted

ACCEPTED = ".csv,.tsv,.txt,.xlsx,.json"
FORMATS = (
    "Tables of gradients, speed limits, curves, tunnels or neutral sections (CSV, XLSX; also as SNCF and RINF publish "
    f"them), TTOBench (JSON); at most {MAX_FILE_BYTES / 1e6:g} MB each. The example is an invented line in the "
    "columns of SNCF."
)
ROLE_WORDS = {"from": "from", "to": "to", "value": "value", "direction": "rises or falls"}
NEEDED = ("from", "value", "position_unit", "value_unit", SHEET, ENCODING)
OFFER_WORDS = {"both": "Take both", "line": "Take this line", "train": "Take this train"}
ABOUT = {
    "both": "Line and train become the scenario.",
    "line": "The scenario\u2019s vehicle stays: {vehicle}.",
    "train": "The scenario\u2019s line stays: {line}.",
}


class FilesForm(Form):
    """The place where files are dropped, and a card for each."""

    cards = param.List(default=[], doc="What each card shows.")
    refusal = param.String(default="", doc="Why a file was not taken.")
    accept = param.String(default=ACCEPTED, doc="Ends of the names of files to choose.")
    formats = param.String(default=FORMATS, doc="What can be brought, in words.")
    max_bytes = param.Integer(default=MAX_FILE_BYTES, doc="Larger files are not sent.")
    version = param.Integer(default=0, doc="Counts what was sent: the browser redraws at each.")

    _esm = module("import_files")

    def __init__(self, model: ImportModel) -> None:
        super().__init__(self._take)
        self.model = model

    def show(self) -> None:
        """Show all cards; of files that are still being read their names."""
        read = {card.number: card for card in self.model.reading.cards}
        cards = [card_words(read.get(file.number) or Card(file.number, file.name)) for file in self.model.files]
        for card, file in zip(cards, self.model.files, strict=True):
            card["about"] = card["about"] if file.number in read else "being read"
        self.param.update(cards=cards, refusal=self.model.refusal, version=self.version + 1)

    def _take(self, message: dict[str, Any]) -> None:
        what, model = message.get("what"), self.model
        if what == "add":
            model.add(str(message.get("name")), str(message.get("content", "")))
        elif what == "too_large":
            model.refuse_large(str(message.get("name")))
        elif what == "example":
            model.add_sources(examples())
        file = model.numbered(message.get("number"))
        if file is None:
            return
        value = str(message.get("value", ""))
        if what == "remove":
            model.remove(file.number)
        elif what == "kind" and value in TABLE_WORDS:
            model.replace(file.with_kind(value))  # type: ignore[arg-type]
        elif what == "say" and self._can_say(file.number, str(message.get("key")), value):
            model.replace(file.told(str(message.get("key")), value))

    def _can_say(self, number: int, key: str, value: str) -> bool:
        """Return whether a card offers this: a message may hold anything."""
        card = next((one for one in self.model.reading.cards if one.number == number), None)
        if card is None:
            return False
        chosen = any(one.key == key and value in dict(one.options) for one in card.choices)
        return chosen or any(one.key == key and value in {one.value, one.kept} for one in card.questions)


class TakeForm(Form):
    """The wanted part of the line, and what can be taken."""

    offers = param.List(default=[], doc="What each offer shows.")
    stretch = param.Dict(default={"begin": "", "end": "", "reverse": False}, doc="The wanted part of the line.")
    has_stretch = param.Boolean(default=False, doc="Whether there are tables of which a part can be wanted.")
    status = param.String(default="", doc="What is going on.")
    refusal = param.String(default="", doc="Why there is no line.")
    version = param.Integer(default=0, doc="Counts what was sent: the browser redraws at each.")

    _esm = module("import_take")

    def __init__(self, model: ImportModel, scenario: Callable[[], Scenario]) -> None:
        super().__init__(self._take)
        self.model, self._scenario = model, scenario

    def show(self) -> None:
        """Show what can be taken."""
        reading, stretch = self.model.reading, self.model.stretch
        is_there = reading.line is not None or reading.vehicle is not None
        base = self._scenario()
        about = {"vehicle": base.vehicle.name or "unnamed", "line": base.line.name or "unnamed"}
        offers = reading.offers or ()
        self.param.update(
            offers=[
                {**offer_words(offer, about), "main": index == 0 and not offer.failure}
                for index, offer in enumerate(offers)
            ],
            stretch={"begin": stretch.begin, "end": stretch.end, "reverse": stretch.reverse},
            has_stretch=bool(reading.tables) or stretch != Stretch(),
            status="Computing the shortest travel time." if is_there and reading.offers is None else "",
            refusal=reading.failure,
            version=self.version + 1,
        )

    def _take(self, message: dict[str, Any]) -> None:
        what = message.get("what")
        if what == "take":
            time, without = str(message.get("time", ""))[:40], message.get("without") is True
            self.model.wanted = Wanted(str(message.get("offer")), time, without)
        elif what == "stretch":
            key, value, now = message.get("key"), str(message.get("value", ""))[:40], self.model.stretch
            if key == "reverse":
                self.model.stretch = Stretch(now.begin, now.end, value == "1")
            elif key == "begin":
                self.model.stretch = Stretch(value, now.end, now.reverse)
            elif key == "end":
                self.model.stretch = Stretch(now.begin, value, now.reverse)


def card_words(card: Card) -> dict[str, Any]:
    """Return what the browser shows of a card."""
    roles = {choice.value: ROLE_WORDS[choice.key] for choice in card.choices if choice.key in ROLE_WORDS}
    roles |= {choice.key.removeprefix("rows "): "rows" for choice in card.choices if choice.key.startswith("rows ")}
    is_table = card.kind in TABLE_WORDS
    kinds = [*([] if is_table else [["", "choose"]]), *map(list, TABLE_WORDS.items())]
    return {
        "number": card.number,
        "name": card.name,
        "kind": card.kind,
        "kind_words": KIND_WORDS.get(card.kind, ""),
        "kinds": kinds if card.header and (is_table or not card.kind) else [],
        "about": about_words(card),
        "header": list(card.header),
        "used": [roles.get(name, "") for name in card.header],
        "rows": [list(row) for row in card.rows],
        "choices": [choice_words(choice) for choice in card.choices],
        "questions": [
            {"sentence": one.sentence, "use": one.use, "keep": one.keep, "key": one.key, "value": one.value,
             "kept": one.kept}
            for one in card.questions
        ],
        "findings": list(card.findings),
        "unused": list(card.unused),
        "failure": card.failure,
    }  # fmt: skip


def about_words(card: Card) -> str:
    """Return how much is in a file, in a few words."""
    result = card.result
    if isinstance(result, ImportedLine):
        return f"{words.distance(result.line.length_m)} km, {counted(len(result.line.sections), 'section')}"
    if isinstance(result, ImportedVehicle):
        vehicle = result.vehicle
        mass, speed = vehicle.total_mass_kg / 1000, vehicle.traction.max_speed_kmh
        return f"{words.number(mass, 0)} t, {words.number(speed, 0)} km/h"
    return counted(card.row_count, "row") if card.row_count else ""


def choice_words(choice: Choice) -> dict[str, Any]:
    """Return what the browser shows of a choice."""
    return {
        "key": choice.key,
        "label": choice.label,
        "options": [list(option) for option in choice.options],
        "value": choice.value,
        "needed": choice.key in NEEDED or choice.key.startswith("rows "),
    }


def offer_words(offer: Offer, about: dict[str, str]) -> dict[str, Any]:
    """Return what the browser shows of an offer."""
    shortest = f"Shortest possible: {words.time(offer.shortest_s)} s. "
    return {
        "what": offer.what,
        "label": OFFER_WORDS[offer.what],
        "time": f"{offer.time_s:g}",
        "why": offer.why,
        "about": shortest + ABOUT[offer.what].format(**about),
        "failure": offer.failure,
        "waits": waiting_words(offer) if offer.waits_for else "",
        "without": f"{OFFER_WORDS[offer.what]} without {' and '.join(offer.waits_for)}",
    }
