"""Start: the product in one sentence and one picture, and the scenarios to begin with."""

from datetime import datetime

import panel as pn
from panel.viewable import Viewable

from railjoule.core import RailjouleError
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.page import Page, Request, shows, study
from railjoule.dashboard.pages.start.cards import card_html, hero
from railjoule.dashboard.pages.start.compute import Card, card_names, compute_cards, outline, scenario_groups
from railjoule.dashboard.parts.html import html_pane, stack
from railjoule.dashboard.scenario_folder import ListedFile
from railjoule.dashboard.state.files import FilesModel
from railjoule.dashboard.state.kept import result

START_CSS = """
.hero { padding: 22px 20px 6px; }
.hero h1 { font-size: 25px; line-height: 1.25; max-width: 32em; text-wrap: balance; }
.hero p { font-size: 14px; margin-top: 8px; max-width: 62em; color: var(--rj-ink2); }
.hero svg { display: block; width: 100%; height: 230px; margin-top: 14px; }
.hero .key { display: flex; flex-wrap: wrap; gap: 2px 22px; font-size: 12px; margin-top: 6px; color: var(--rj-ink2); }
.hero .key b { color: var(--rj-accent); font-weight: 600; }
.hero .key i { display: inline-block; width: 10px; height: 10px; margin-right: 5px; border: 1px solid var(--rj-line2); }
h2.begin { padding: 16px 20px 4px; font-size: 15px; }
h2.begin span { margin-left: 8px; font-size: 13px; font-weight: 400; }
.hero .plot { position: relative; margin: 14px 0 0 44px; padding-bottom: 36px; }
.hero .plot svg { margin: 0; }
.hero .plot span { position: absolute; font-size: 11px; line-height: 14px; color: var(--rj-ink3); }
.hero .plot .y { right: calc(100% + 8px); transform: translateY(-50%); }
.hero .plot .x { bottom: 18px; transform: translateX(-50%); }
.hero .plot .title { bottom: 0; left: 50%; transform: translateX(-50%); font-size: 12px; color: var(--rj-ink2); }
.hero .name { margin-top: 14px; font-size: 12px; color: var(--rj-ink2); }
.hero .name + .plot { margin-top: 4px; }
@media (min-width: 1600px) { .hero svg { height: 320px; } }
@media (max-width: 899px) {
  .hero { padding: 14px 14px 4px; } .hero h1 { font-size: 20px; } .hero svg { height: 150px; }
  h2.begin { padding-left: 14px; }
}
.cards { display: grid; grid-template-columns: repeat(auto-fill, minmax(236px, 1fr)); gap: 0 24px;
  padding: 4px 20px 24px; align-items: stretch; }
/* in line, for the mark of the summary is before its first line */
summary h2.begin { display: inline; padding: 0 0 0 4px; }
summary { padding: 16px 20px 4px; cursor: pointer; }
.hero .asks { padding: 6px 0 0; margin-left: -8px; }
.card { border-top: 1px solid var(--rj-line); padding: 12px 0 10px; }
.card button { display: block; min-height: 24px; padding: 0; border: 0; background: none; text-align: left;
  font: 600 13.5px/1.3 var(--rj-font); color: var(--rj-accent); cursor: pointer; }
.card button:hover { text-decoration: underline; }
.card button:active { color: var(--rj-ink); }
.card button:focus-visible { outline: 2px solid var(--rj-accent); outline-offset: 2px; }
.card p { font-size: 12px; color: var(--rj-ink3); }
.card p.for { color: var(--rj-ink2); min-height: 34px; text-wrap: pretty; }
.card svg { display: block; width: 100%; height: 54px; margin: 8px 0 2px; }
@media (max-width: 899px) { .cards { padding: 4px 14px 24px; } summary { padding-left: 14px; padding-right: 14px; } }
"""
EMPTY = (
    "Nothing saved yet. \u201cSave scenario\u201d beside the other pages saves here, and scenario files that are "
    "put into the folder appear here."
)
FILES_CSS = """
.my-files { padding: 4px 20px 4px; }
.my-files table { width: 100%; table-layout: fixed; }
.my-files td, .my-files th { text-align: left; padding: 3px 14px 3px 0; vertical-align: baseline; white-space: normal;
  overflow-wrap: anywhere; }
.my-files th:first-child { width: 34%; }
.my-files .date { width: 126px; padding-right: 0; white-space: nowrap; }
.my-files td.date { color: var(--rj-ink2); }
.my-files button { min-height: 24px; padding: 0; border: 0; background: none; text-align: left; overflow-wrap: anywhere;
  font: 600 13px/1.3 var(--rj-font); color: var(--rj-accent); cursor: pointer; }
.my-files button:hover { text-decoration: underline; }
.my-files button:active { color: var(--rj-ink); }
.my-files button:focus-visible { outline: 2px solid var(--rj-accent); outline-offset: 2px; }
.my-files .refused { color: var(--rj-warn); }
@media (max-width: 899px) { .my-files { padding: 4px 14px; } }
@media (max-width: 599px) {
  .my-files table, .my-files tbody { display: block; }
  .my-files thead { display: none; }
  .my-files tr { display: flex; flex-wrap: wrap; gap: 0 8px; padding: 4px 0; border-bottom: 1px solid var(--rj-line); }
  .my-files td { padding: 0; border: 0; min-width: 0; }
  .my-files td:first-child { flex: 0 0 100%; }
}
"""
FOLDED = "From the papers"
"""The group of cards that is folded at first."""


class Start(Page):
    """The page on which a new session begins."""

    page = "Start"
    follows_scenario = False
    cards = result(tuple, "Cards of the shipped scenarios, with the runs that are computed so far.")

    @study(into="cards")
    def _cards(self) -> Request:
        return compute_cards, card_names()

    def goes_on(self, into: str) -> bool:
        """Return True: each card is computed once for all pages of the process."""
        return True

    def layout(self) -> Viewable:
        """Make the parts of the page, and return them laid out."""
        sheets = [parts_css(), START_CSS, FILES_CSS]
        self.hero = html_pane(hero(None), stylesheets=sheets)
        self.files = html_pane(stylesheets=sheets, visible=self.desk.files.folder is not None)
        self.groups = {group: html_pane(stylesheets=sheets) for group in scenario_groups(card_names())}
        self.host.heading.visible = False
        self.host.browser.listen("scenario", lambda message: self._open(str(message.get("name"))))
        self.host.browser.listen("open_saved", lambda message: self._open_file(str(message.get("name"))))
        first, *others = self.groups.values()
        return stack(self.hero, first, self.files, *others)

    @shows("desk.runs")
    def _show_picture(self) -> None:
        if self.desk.runs is not None:
            self.hero.object = hero(self.desk.runs)

    @shows("cards")
    def _show_cards(self) -> None:
        cards = {name: outline(name) for name in card_names()} | {card.name: card for card in self.cards or ()}
        for group, pane in self.groups.items():
            shown = [cards[name] for name in group[2]]
            # a list that was unfolded would fold whenever it is written again
            if group[0] != FOLDED or not pane.object or all(card.run is not None for card in shown):
                pane.object = group_html(group[0], group[1], shown)

    @shows("desk.files.listing", "desk.files.refusal", "desk.files.current")
    def _show_files(self) -> None:
        if self.desk.files.folder is not None:
            self.files.object = files_html(self.desk.files)

    def _open_file(self, name: str) -> None:
        """Open a file of the folder on Drive."""

        def turn() -> None:
            self.desk.param.update(page="Drive", notice="")

        def refuse(error: RailjouleError) -> None:
            self.desk.notice = str(error)
            self.desk.files.look()

        self.desk.files.open(name, turn, refuse)

    def _open(self, name: str) -> None:
        if name in card_names():
            with pn.io.hold():
                # before the page is turned: what Drive asks for first is of this scenario
                self.desk.scenario.choose(name)
                self.desk.page = "Drive"


def group_html(title: str, shows: str, cards: list[Card]) -> Markup:
    """Write the heading of a group of scenarios, and its cards."""
    heading = markup('<h2 class="begin">{} <span class="muted">{}</span></h2>', title, shows)
    grid = markup('<div class="cards">{}</div>', joined(map(card_html, cards)))
    template = "<details><summary>{}</summary>{}</details>" if title == FOLDED else "{}{}"
    return markup(template, heading, grid)


def files_html(files: FilesModel) -> Markup:
    """Return the heading and the table of the folder's files."""
    label = "" if files.folder is None else files.folder.label
    note = "scenario files in the folder"
    heading = markup('<h2 class="begin">My files <span class="muted">{} {}</span></h2>', note, label)
    pieces: list[Markup] = []
    listing = files.listing
    if files.refusal:
        pieces.append(markup('<p class="error" role="alert">{}</p>', files.refusal))
    elif listing is not None and not listing.files:
        pieces.append(markup('<p class="muted">{}</p>', EMPTY))
    elif listing is not None:
        head = Markup('<th scope="col">Name</th><th scope="col">Title</th><th scope="col" class="date">Changed</th>')
        rows = joined([_row(file, file.name == files.current) for file in listing.files])
        pieces.append(
            markup('<table aria-label="My files"><thead><tr>{}</tr></thead><tbody>{}</tbody></table>', head, rows)
        )
    if listing is not None and listing.more:
        pieces.append(markup('<p class="muted">{} more files are not listed: open them as a file.</p>', listing.more))
    return markup("{}<div class=my-files>{}</div>", heading, joined(pieces))


def _row(file: ListedFile, is_open: bool) -> Markup:
    name = markup("<b>{}</b>", file.name)
    if not file.refusal:
        name = markup(
            '<button type="button" data-ask="open_saved" data-name="{0}" aria-label="Open {0}">{0}</button>', file.name
        )
    mark = Markup(' <span class="muted small">open</span>') if is_open else ""
    about = markup('<span class="refused">Cannot be opened: {}</span>', file.refusal) if file.refusal else file.title
    changed = datetime.fromtimestamp(file.changed_s)
    date = f"{changed.day} {changed:%b %Y, %H:%M}"
    return markup("<tr><td>{}{}</td><td>{}</td><td class=date>{}</td></tr>", name, mark, about, date)
