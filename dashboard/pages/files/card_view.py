"""The card of a file as widgets: its kind, the meanings and units of its columns, and the questions."""

from collections.abc import Callable, Iterable
from typing import Any

import panel as pn
import panel_material_ui as pmui

from railjoule.core.imports import ImportedLine
from railjoule.core.imports.numbers import text_of_cell
from railjoule.core.imports.vehicle import ImportedVehicle
from railjoule.core.scenario._sentences import counted
from railjoule.dashboard.browser import one_message
from railjoule.dashboard.look import words
from railjoule.dashboard.look.markup import Markup, joined, markup, safe
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.pages.files.brought import KIND_WORDS, TABLE_WORDS
from railjoule.dashboard.pages.files.cards import ROLE_LABELS, Card, Choice
from railjoule.dashboard.pages.files.columns import Question
from railjoule.dashboard.parts import html as parts

LIST = '<div class="block listed"><h3>{}</h3><ul class="differences">{}</ul></div>'
CARD_CSS = ":host { border-bottom: 1px solid var(--rj-line); padding: 6px 0 10px; }"
TEXT_CSS = """
h2, h3 { margin: 0; font-size: 13px; font-weight: 600; overflow-wrap: anywhere; }
.listed { padding: 4px 0 0; font-size: 12px; }
.scroll { overflow-x: auto; margin: 6px 0; }
.scroll table { width: auto; min-width: 60%; }
.scroll td, .scroll th { padding: 2px 8px; border-left: 1px solid var(--rj-line); }
.scroll td:first-child, .scroll th:first-child { border-left: 0; padding-left: 0; }
.scroll span { display: block; font-size: 11px; color: var(--rj-ink3); }
.scroll b + span { color: var(--rj-accent); }
.message { margin: 6px 0; }
"""
FIRST_ROWS = 4
"""Rows of each file that are shown."""
MENU_CSS = """
:host { font-size: 13px; }
label { max-width: 100%; font-size: 11px; color: var(--rj-ink2); background: var(--rj-surface) !important;
  overflow: hidden; text-overflow: ellipsis; white-space: nowrap; }
.bk-input { min-height: 30px; padding: 3px 4px 3px 8px; font: inherit; color: var(--rj-ink); border-radius: 6px;
  border: 1px solid var(--rj-line2); background: var(--rj-surface) !important; appearance: auto !important; }
.bk-input:focus { border-color: var(--rj-accent); outline: 1px solid var(--rj-accent); box-shadow: none; }
:host(.missing) .bk-input { border-color: var(--rj-warn); box-shadow: 0 0 0 1px var(--rj-warn); }
"""
SELECT_PX, UNIT_PX = 170, 120
SMALL: dict[str, Any] = {"size": "small", "margin": (6, 8, 2, 0)}


class FileCard:
    """Shows a card; changes take effect immediately.

    Parameters
    ----------
    say : callable
        Called with a key of the card, or `kind`, and the chosen value.
    remove : callable
    """

    def __init__(self, say: Callable[[str, str], None], remove: Callable[[], None]) -> None:
        self.say, self._quiet = say, False
        self.head, self.messages, self.table = (_text() for _ in range(3))
        self.kind = menu("Kind of file", SELECT_PX)
        self.kind.param.watch(lambda event: self._choose("kind", event.new), "value")
        self.remove = pmui.Button(variant="text", on_click=lambda _: remove(), **SMALL)
        self.choices, self.questions = parts.stack(), parts.stack()
        self._keys: list[str] = []
        self._asked: tuple[Question, ...] = ()
        self.selects: list[pn.widgets.Select] = []
        self.samples: list[Any] = []
        line = pn.FlexBox(self.kind, self.remove, align_items="center", margin=0)
        self.view = parts.stack(self.head, line, self.table, self.choices, self.questions, self.messages, css=CARD_CSS)

    def show(self, card: Card) -> None:
        """Show the card of a file."""
        before, self._quiet = self._quiet, True
        with pn.io.hold():
            failure = parts.refusal(card.failure) if card.failure else ""
            self.head.object = (
                markup("<h2>{}</h2><span class='muted small'>{}</span>", card.name, about(card)) + failure
            )
            known = card.kind in TABLE_WORDS
            kinds = TABLE_WORDS if known else {"": "choose", **TABLE_WORDS}
            # a file without rows is no table of any kind
            visible = known or bool(card.cells and not card.kind)
            fill(self.kind, kinds.items(), card.kind if known else "", visible=visible)
            self.remove.label = f"Remove {card.name}"
            self.table.object = first_rows(card)
            self.messages.object = message_lists([("Noticed", card.findings), ("Not used", card.unused)])
            self._show_choices(card.choices)
            self._show_questions(card.questions)
        self._quiet = before

    def _show_choices(self, choices: tuple[Choice, ...]) -> None:
        if self._keys != [choice.key for choice in choices]:
            self._keys = [choice.key for choice in choices]
            self.selects = [self._select(choice) for choice in choices]
            self.samples = [_text(sizing_mode=None, margin=(12, 0, 0, 0)) for _ in choices]
            rows: list[list[Any]] = [[]]
            for choice, select, sample in zip(choices, self.selects, self.samples, strict=True):
                rows[-1] += [select, sample] if choice.sample else [select]
                if choice.sample:
                    rows.append([])
            with one_message():
                self.choices[:] = [pn.FlexBox(*row, align_items="center", margin=0) for row in rows if row]
        for choice, select, sample in zip(choices, self.selects, self.samples, strict=True):
            classes = ["missing"] if choice.is_missing else []
            fill(select, choice.options, choice.value, visible=bool(choice.options), css_classes=classes)
            sample.object = markup("<span class='muted small'>{}</span>", choice.sample)

    def _select(self, choice: Choice) -> pn.widgets.Select:
        width = UNIT_PX if choice.key.endswith("_unit") else SELECT_PX
        made = fill(menu(choice.label, width), choice.options, choice.value)
        made.param.watch(lambda event: self._choose(choice.key, event.new), "value")
        return made

    def _show_questions(self, questions: tuple[Question, ...]) -> None:
        if questions == self._asked:
            return
        self._asked = questions
        made = []
        for question in questions:
            made.append(_text(markup("<p class=note>{}</p>", question.sentence)))
            answers = [self._answer(question.key, *answer, first=k == 0) for k, answer in enumerate(question.answers)]
            made.append(pn.FlexBox(*answers, margin=0))
        with one_message():
            self.questions[:] = made

    def _answer(self, key: str, word: str, value: str, first: bool) -> pmui.Button:
        variant = "contained" if first else "outlined"
        return pmui.Button(label=word, variant=variant, on_click=lambda _: self.say(key, value), **SMALL)

    def _choose(self, key: str, value: Any) -> None:
        if not self._quiet and value is not None:
            self.say(key, str(value))


def menu(label: str, width: int) -> pn.widgets.Select:
    """Return a menu without options."""
    # not panel-material-ui's, which no key opens: its Select listens to clicks, and not to MUI's `onOpen`
    return pn.widgets.Select(name=label, width=width, margin=SMALL["margin"], stylesheets=[MENU_CSS])


def fill(select: pn.widgets.Select, options: Iterable[tuple[str, str]], value: str, **more: Any) -> pn.widgets.Select:
    """Offer values with the words for them, and choose one; return the menu."""
    select.param.update(options={word: one for one, word in options}, value=value, **more)
    return select


def _text(text: str = "", **params: Any) -> Any:
    return parts.html_pane(text, stylesheets=[parts_css() + TEXT_CSS], **params)


def about(card: Card) -> str:
    """Return kind and size of a file, in a few words."""
    result, kind = card.result, "" if card.kind in TABLE_WORDS else KIND_WORDS.get(card.kind, "")
    size = counted(len(card.cells.rows), "row") if card.cells else ""
    if isinstance(result, ImportedLine):
        size = f"{words.distance(result.line.length_m)} km, {counted(len(result.line.sections), 'section')}"
    elif isinstance(result, ImportedVehicle):
        vehicle = result.vehicle
        mass, speed = vehicle.total_mass_kg / 1000, vehicle.traction.max_speed_kmh
        size = f"{words.number(mass, 0)} t, {words.number(speed, 0)} km/h"
    return ", ".join(filter(None, [kind, size]))


def first_rows(card: Card) -> Markup:
    """Return the first rows of a table, with what each column is used for."""
    cells = card.cells
    if cells is None:
        return Markup("")
    roles = {choice.value: choice.label.lower() for choice in card.choices if choice.key in ROLE_LABELS}
    roles |= {choice.key.removeprefix("rows "): "rows" for choice in card.choices if choice.key.startswith("rows ")}
    header = [
        markup("<b>{}</b><span>{}</span>", name, roles[name])
        if roles.get(name)
        else markup("{}<span>not used</span>", name)
        for name in cells.header
    ]
    table = parts.plain_table(
        header, [([safe(text_of_cell(cell)) for cell in row], False) for _, row in cells.rows[:FIRST_ROWS]]
    )
    name = f"First rows of {card.name}"
    return markup("<div class=scroll tabindex=0 role=region aria-label='{}'>{}</div>", name, table)


def message_lists(lists: Iterable[tuple[str, Iterable[str]]]) -> Markup:
    """Return lists of sentences under their headings; nothing of those that are empty."""
    return joined(
        markup(LIST, title, joined(markup("<li>{}</li>", one) for one in sentences))
        for title, sentences in lists
        if sentences
    )
