"""The tab of lines and trains: a card of each file, the line drawn, and the scenarios that can be made of it."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
from panel.viewable import Viewable

from railjoule.core.scenario._sentences import counted
from railjoule.core.studies import StudyTable
from railjoule.dashboard.browser import one_message
from railjoule.dashboard.editor.fields_of import Field, parts_of, plain
from railjoule.dashboard.look import words
from railjoule.dashboard.look.key_names import split_unit, without_keys, words_of
from railjoule.dashboard.look.markup import Markup, markup
from railjoule.dashboard.look.theme import padded
from railjoule.dashboard.look.typed import parse_time
from railjoule.dashboard.page import Page, Request, shows, study, work
from railjoule.dashboard.pages.files.brought import TABLE_WORDS, Brought
from railjoule.dashboard.pages.files.card_view import FileCard, message_lists
from railjoule.dashboard.pages.files.cards import Card
from railjoule.dashboard.pages.files.compute import (
    LONGEST_TIME_S,
    Offer,
    Reading,
    Stretch,
    assumed_effects,
    read_files,
    taken,
)
from railjoule.dashboard.pages.files.compute import Request as FilesRequest
from railjoule.dashboard.pages.files.line_charts import LINE_PLOTS, previews
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.parts.choices import box
from railjoule.dashboard.parts.number_field import tie
from railjoule.dashboard.state.draft import Opened, open_scenario
from railjoule.dashboard.state.kept import result

LINE = "line"
SOURCE = "the import"
OFFER_WORDS = {"both": "Use both", "line": "Use this line", "train": "Use this train"}
ABOUT = {
    "both": "Line and train become the scenario.",
    "line": "The scenario\u2019s vehicle stays: {vehicle}.",
    "train": "The scenario\u2019s line stays: {line}.",
}
ASSUMED = '{}<br><span class="muted small">{} {}</span>'
COLUMNS_CSS = """
:host { display: grid; grid-template-columns: minmax(0, 1fr); align-items: start; }
@media (min-width: 1100px) { :host { grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); } }
"""
SIDE_CSS = padded("4px 20px 20px", "4px 14px 16px")


def read_taken(offer: Offer, time_s: float, _press: object) -> Opened:
    """Return the scenario of an offer, read as that of any file."""
    return open_scenario(taken(offer, time_s), SOURCE)


class LineTab(Page):
    """The line and the train that the files describe."""

    files = param.ClassSelector(class_=tuple, default=(), doc="The files from the user.")
    begin = param.String(default="", doc="Begin of the wanted part of the line, as it was typed.")
    end = param.String(default="", doc="End of the wanted part, as it was typed.")
    reverse = param.Boolean(default=False, doc="Whether it is run in falling chainage.")
    line_name = param.String(default="", doc="Name of the line, in the place of that which its files give.")
    refusal = param.String(default="", doc="Why a file, or a scenario, was not taken.")
    reading = result(Reading, "The line and the train that were read.")
    effects = result(StudyTable, "Effects of the assumptions of the train.")
    wanted = result(tuple, "The offer that is to be taken, its travel time, and the press that asked for it.")
    opened = result(Opened, "The scenario that was taken last.")

    @study("files", "begin", "end", "reverse", "line_name", "scenario", into="reading")
    def _read(self) -> Request:
        stretch = Stretch(self.begin, self.end, self.reverse, self.line_name[:200])
        asked = FilesRequest(self.files, stretch, self.desk.scenario.scenario())
        return (read_files, asked) if self.files else None

    @study("reading", into="effects", tab=LINE)
    def _weigh_assumptions(self) -> Request:
        reading = self.reading
        if reading is None or reading.vehicle is None or not reading.vehicle.vehicle.assumptions:
            return None
        offer = next((one for one in reading.offers or () if one.what != "line" and not one.failure), None)
        return None if offer is None else (assumed_effects, offer)

    @work("wanted", into="opened")
    def _take_wanted(self) -> Request:
        return None if self.wanted is None else (read_taken, *self.wanted)

    def open_taken(self, *_: Any) -> None:
        """Turn to Drive with the scenario that was taken."""
        opened = self.opened
        if opened is not None:
            # or the same would be taken once more when the page is in sight again
            self.wanted = None
            self.desk.scenario.open(opened.toml, SOURCE)
            self.desk.page = "Drive"

    def use(self, offer: Offer, time: str) -> None:
        """Take an offer with the typed travel time, or show the error."""
        # up to the tenth of a second that the page shows
        least = round(offer.shortest_s, 1)
        try:
            time_s = parse_time(time[:40], (None, None), "Travel time")
            if not least <= time_s <= LONGEST_TIME_S:
                raise ValueError(
                    f"Travel time: {time_s:g} s must be at least the shortest possible {least:.1f} s and at most "
                    f"{LONGEST_TIME_S:g} s."
                )
        except ValueError as refusal:
            self.refusal = str(refusal)
            return
        self.param.update(refusal="", wanted=(offer, time_s, object()))

    def say(self, number: int, key: str, value: str) -> None:
        """Take a choice of the user about a file, if its card offers that."""
        file = next((one for one in self.files if one.number == number), None)
        card = next((one for one in self.cards if one.number == number), None)
        if file is None or card is None:
            return
        if key == "kind" and value in TABLE_WORDS:
            self.put(file.with_kind(value))
        elif card.allows(key, value):
            self.put(file.with_choice(key, value))

    def put(self, file: Brought) -> None:
        """Replace the file of the same number."""
        self.files = tuple(file if one.number == file.number else one for one in self.files)

    def remove(self, number: int) -> None:
        """Remove a file."""
        files = tuple(one for one in self.files if one.number != number)
        has_example = any(file.is_example for file in files)
        self.param.update(files=files, example=self.example and has_example, refusal="")

    @property
    def cards(self) -> tuple[Card, ...]:
        """The cards of the files that are read."""
        return () if self.reading is None else self.reading.cards

    # ---- what it shows

    def layout_line(self) -> Viewable:
        """Make the parts of the tab."""
        self._views: dict[int, tuple[FileCard, Card]] = {}
        self._offered: object = None
        self.card_place, self.offer_place = parts.stack(), parts.stack()
        self.title, self.messages, self.train, self.status, self.worth = (parts.html_pane() for _ in range(5))
        small: dict[str, Any] = {"size": "small", "margin": (6, 8, 2, 0)}
        fields = {
            "line_name": pmui.TextInput(
                label="Name of the line", value=self.line_name, max_length=200, width=300, **small
            ),
            "begin": pmui.TextInput(label="From", value=self.begin, max_length=40, width=110, **small),
            "end": pmui.TextInput(label="To", value=self.end, max_length=40, width=110, **small),
        }
        for name, field in fields.items():
            tie(field, self, name)
        falling = box(self, "reverse", "Falling chainage", margin=(8, 0))
        hint = parts.html_pane("<p class=note>From and to as 12+300, 12.3km or metres; empty for all of it.</p>")
        self.place = parts.stack(pn.FlexBox(fields["begin"], fields["end"], falling, margin=0), hint)
        self.stretch = parts.stack(fields["line_name"], self.place)
        self.drawn = parts.stack(*(self.host.plots[plot.name].host for plot in LINE_PLOTS), visible=False)
        right = (
            self.title,
            self.stretch,
            self.status,
            self.offer_place,
            self.drawn,
            self.messages,
            self.worth,
            self.train,
        )
        return parts.stack(
            parts.stack(self.card_place, css=SIDE_CSS),
            parts.stack(*right, css=SIDE_CSS),
            css=COLUMNS_CSS,
        )

    @shows("files", "reading", tab=LINE)
    def _show_cards(self) -> None:
        known = {card.number: card for card in self.cards}
        cards = {file.number: known.get(file.number) or Card(file.number, file.name) for file in self.files}
        shown = {number: card for number, card in cards.items() if not card.is_run}
        for number, card in shown.items():
            view, before = self._views.get(number) or (self._new_card(number), None)
            # while a file is read again its widgets keep what was chosen
            if card is not before and (number in known or before is None):
                view.show(card)
            self._views[number] = view, card
        views = [self._views[number][0].view for number in shown]
        if views != list(self.card_place):
            with one_message():
                self.card_place[:] = views

    def _new_card(self, number: int) -> FileCard:
        return FileCard(lambda key, value: self.say(number, key, value), lambda: self.remove(number))

    @shows("reading", "failure", tab=LINE)
    def _show_reading(self) -> None:
        reading = self.reading or Reading(offers=())
        self.title.object = markup("<div class=block><h2>{}</h2></div>", find_title(reading))
        self.messages.object = message_lists(
            [("Noticed of the line", reading.findings), ("Not used of the line", reading.unused)]
        )
        self.train.object = train_table(reading)
        imported = reading.line
        is_there = imported is not None or reading.vehicle is not None
        self.place.visible = bool(reading.tables) or Stretch(self.begin, self.end, self.reverse) != Stretch()
        self.stretch.visible = imported is not None or self.place.visible
        self.drawn.visible = imported is not None
        waits = "Computing the shortest travel time." if is_there and reading.offers is None else ""
        refused = parts.refusal(reading.failure) if reading.failure else ""
        self.status.object = markup("<p class='muted small' role=status>{}</p>{}", waits, refused)
        if reading.offers is not self._offered:
            self._offered = reading.offers
            with one_message():
                self.offer_place[:] = [self._offer(one, k == 0) for k, one in enumerate(reading.offers or ())]
        if imported is not None:
            self.host.axes[LINE].fit(imported.line.length_m, roomy=False)
            drawn = previews(reading, imported)
            for plot in LINE_PLOTS:
                self.host.draw([plot], drawn[plot.name])

    @shows("effects", tab=LINE)
    def _show_effects(self) -> None:
        self.worth.object = "" if self.effects is None else effects_table(self.effects)

    def _offer(self, offer: Offer, first: bool) -> Viewable:
        """Return the button that takes an offer, its travel time, and why it has to wait."""
        label, base = OFFER_WORDS[offer.what], self.desk.scenario.edited
        if offer.failure:
            return parts.html_pane(markup("<b>{}</b>{}", label, parts.refusal(offer.failure)))
        small: dict[str, Any] = {"size": "small", "margin": (8, 10, 0, 0)}
        time = pmui.TextInput(
            label="Travel time, s",
            value=f"{offer.time_s:g}",
            max_length=40,
            width=130,
            **{**small, "margin": (14, 10, 0, 0)},
        )

        def button(words_of_it: str, variant: str, **more: Any) -> pmui.Button:
            return pmui.Button(
                label=words_of_it, variant=variant, on_click=lambda _: self.use(offer, time.value), **small, **more
            )

        waits = bool(offer.waits_for)
        row = [button(label, "contained" if first else "outlined", disabled=waits)]
        if waits:
            row.append(button(f"{label} without {' and '.join(offer.waits_for)}", "outlined"))
        about = ABOUT[offer.what].format(vehicle=base.vehicle.name or "unnamed", line=base.line.name or "unnamed")
        note = f"Shortest possible: {words.time(offer.shortest_s)} s; proposed: {offer.why}. {about}"
        reason = parts.refusal(offer.waiting) if waits else ""
        text = parts.html_pane(markup("{}<p class=note>{}</p>", reason, note))
        text.stylesheets = [*text.stylesheets, ".message { margin: 8px 0 0; }"]
        return parts.stack(pn.FlexBox(*row, time, align_items="center", margin=0), text)


def find_title(reading: Reading) -> str:
    """Return line and train of the files, in a few words."""
    found = []
    if reading.line is not None:
        line = reading.line.line
        counts = [counted(len(line.sections), "section")]
        counts += [counted(len(line.stations), "station")] if line.stations else []
        found.append(f"{line.name or 'Line'}: {words.distance(line.length_m)} km, {', '.join(counts)}")
    if reading.vehicle is not None:
        vehicle = reading.vehicle.vehicle
        found.append(f"{vehicle.name or 'Train'}: {words.number(vehicle.total_mass_kg / 1000, 0)} t")
    return "; ".join(found)


def train_table(reading: Reading) -> Markup:
    """Return the vehicle that was read as a table."""
    if reading.vehicle is None:
        return Markup("")
    document = reading.vehicle.document["vehicle"]
    assumed = {one.key for one in reading.vehicle.vehicle.assumptions}
    columns = 3 if assumed else 2
    rows = [(name, value, "assumed" if key in assumed else "") for key, name, value in vehicle_rows(document)]
    head = ("Quantity", "Value", "Origin")[:columns]
    return parts.table("Train", head, [(row[:columns], False) for row in rows], "train")


def effects_table(table: StudyTable) -> Markup:
    """Return the assumptions with the change of energy if they are off, the largest first."""
    change = words.share(table.change)
    differences = zip(table["lower_value_difference"], table["higher_value_difference"], strict=True)
    rows = [
        (markup(ASSUMED, assumption_words(label), basis, without_keys(reason)), *map(_percent, pair))
        for label, pair, basis, reason in zip(table.assumption, differences, table.bases, table.reasons, strict=True)
    ]
    head = ("Assumed value", f"{change} % lower", f"{change} % higher")
    note = (
        f"Change of the {words.energy(table.energy_kwh)} kWh in the same time, in per cent. Look up the first values "
        "first. Of an efficiency, the losses are varied. Assumed values stay marked in the saved scenario and in the "
        "report until another value replaces them."
    )
    shown = parts.table("Effect of each assumption", head, [(row, False) for row in rows], "assumptions")
    return markup("{}<p class=note>{}</p>", shown, note)


def assumption_words(label: str) -> str:
    """Return the name of assumed values from their keys."""
    first, _, others = label.partition(",")
    if others:
        return words_of(first.rpartition(".")[0])
    return words_of(split_unit(first.rpartition(".")[2])[0])


def _percent(part: float) -> str:
    return words.UNKNOWN if math.isnan(part) else words.signed(100 * part, 1)


def vehicle_rows(document: Mapping[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield the keys of a vehicle's table, with their names and units in words and their values."""
    model = str(document.get("drive", {}).get("model", ""))
    inner = ((f"vehicle.{key}", value) for key, value in document.items() if isinstance(value, dict))
    for table, values in (("vehicle", document), *inner):
        labels = {part.name: part.label for part in parts_of(table, model) if isinstance(part, Field)}
        group = "" if table == "vehicle" else f"{words_of(table)}: "
        for key, value in values.items():
            if isinstance(value, dict) or key == "assumed":
                continue
            number = isinstance(value, int | float) and not isinstance(value, bool)
            shown = f"{len(value)} points" if isinstance(value, list) else plain(value) if number else str(value)
            path = f"{table}.{key}".removeprefix("vehicle.") if table == "vehicle.drive" else f"{table}.{key}"
            yield path, f"{group}{labels.get(key) or words_of(key)}", shown
