"""Help: the way to the documentation, the keys, what each page answers, how to read a proof, the whole glossary."""

from collections.abc import Mapping
from typing import Any

import panel_material_ui as pmui
from panel.viewable import Viewable

from railjoule.dashboard.limits import limits
from railjoule.dashboard.look.glossary import GROUPS, Term
from railjoule.dashboard.look.markup import Markup, joined, markup
from railjoule.dashboard.look.theme import parts_css
from railjoule.dashboard.page import Page
from railjoule.dashboard.page_list import KEYED, PAGES
from railjoule.dashboard.parts import html as parts
from railjoule.dashboard.provenance import is_built

KEYS = (
    ("?", "open this page"),
    ("1 to 9", "open a page, in the order of the bar"),
    ("P", "pin the run, or unpin it"),
    ("Ctrl + Z", "undo"),
    ("Ctrl + Shift + Z", "redo"),
    ("Escape", "close an explanation, a list of pages, sharing or the full screen of a figure"),
    ("Left, right", "move a slider by one step; Home and End to its ends"),
)
"""The keys and their uses; letters, digits and signs only while nothing is typed."""
USES: Mapping[str, str] = {
    "Start": "Begin with a shipped scenario or a file of your own.",
    "Drive": "Read, play and print the driving advice; move an instruction; count the saving of a year.",
    "Compare": "Read energies, times and bounds in one table; see what two scenarios differ in.",
    "Trade-off": "See what each further second saves, and choose a travel time.",
    "What if": "Change load and position, add red signals and limits, draw at random, find a robust plan.",
    "Set speeds": "Find one set speed for each section, and its cost against the optimum.",
    "Motor": "Drive the plan with controlled motors: currents, flux, slip and losses.",
    "Line": "Distribute the running time supplement among the legs between stations.",
    "Explore": "Vary several inputs together, and open any of the runs on Drive.",
    "Learn": "Drive by hand, guess, draw; open a class for the phones of students.",
    "Files": "Import a line, a train or recorded runs; compare recorded runs with the best.",
    "Papers": "Look up every printed number and claim beside those of railjoule.",
    "Help": "Look up a key, a term or the reading of a proof.",
}
"""The use of each page."""
PROOF = (
    (
        "The lower bound",
        "The solver finds a run, and separately a lower bound: no way of driving this train over this line in this "
        "time uses less energy, whatever the driver does and wherever. A tick marks a run as proven: it lies above the "
        "bound by at most the tolerance of the scenario, 0.05 % unless set otherwise, and counts as the optimum.",
    ),
    (
        "How it is proven",
        "Each place of the line has a price of force: the energy that a joule at the wheels is worth there. With these "
        "prices, and a price of time, each metre has a least cost, whatever the speed and effort. The sum of these "
        "costs is the bound. On Drive, \u201cShow price of force\u201d draws the prices along the line.",
    ),
    (
        "When there is a gap",
        "A half circle stands for a gap above the tolerance. The least energy lies between the bound and the run, so "
        "the gap is the most that another run could still save. Such a run is called the best known, not the optimum.",
    ),
    (
        "A tighter bound",
        "A drive with idle losses takes power as soon as it is on, and the first bound of a slow run is loose. On "
        "Drive a second one follows half a second later, for runs over the cells of one mesh with one effort in each; "
        "Prove further continues, and the bound never falls. The sentence below the numbers states both bounds.",
    ),
    (
        "How long the cells are",
        "The line is cut into cells, each with one effort. For drives without idle losses the cells are halved until "
        "the run lies within the tolerance of the bound, so that finer cells save no more than that. For others the "
        "length stays as set. Both, the longest cell and the tolerance, are under Strategy options.",
    ),
    (
        "Limits of a proof",
        "It holds for the model: for this vehicle, line and timetable as entered. The sentence below the numbers on "
        "Drive states what the bound assumes of the powertrain. Other strategies are compared with the proven run.",
    ),
)
HELP_CSS = """
.help p a { display: inline-block; min-height: 24px; color: var(--rj-accent); font-weight: 600; }
.help { padding: 4px 20px 8px; max-width: 1240px; }
.help h2 { font-size: 15px; margin: 22px 0 6px; }
.help h3 { font-size: 13px; font-weight: 600; color: var(--rj-ink); margin: 14px 0 2px; break-after: avoid; }
.help table { width: auto; font-size: 13px; }
.help td { text-align: left; white-space: normal; padding: 4px 0 4px 20px; }
.help th { text-align: left; padding: 4px 0 4px 20px; }
.help th:first-child { padding-left: 0; }
.help td:first-child { min-width: 0; padding-left: 0; white-space: nowrap; }
.help .limits td:first-child { white-space: normal; min-width: 140px; }
.help kbd { display: inline-block; min-width: 24px; box-sizing: border-box; padding: 1px 7px; border-radius: 4px;
  border: 1px solid var(--rj-line2); font: 500 12px/1.5 var(--rj-font); text-align: center; }
.help .open-page { min-height: 24px; padding: 0; border: 0; background: none; color: var(--rj-accent); cursor: pointer;
  font: 600 13px/1.4 var(--rj-font); text-align: left; white-space: nowrap; }
.help .open-page:hover { text-decoration: underline; }
.help .columns { columns: 2; column-gap: 44px; }
.help dl { margin: 0; }
.help dl div { break-inside: avoid; padding: 5px 0; border-top: 1px solid var(--rj-line); }
.help dl div:focus { outline: 2px solid var(--rj-accent); outline-offset: 3px; }
.help dt { font-weight: 600; }
.help dt span { font-weight: 400; color: var(--rj-ink3); }
.help dd { margin: 0; max-width: 68ch; color: var(--rj-ink2); }
.help .columns > div { break-inside: avoid; }
.help .columns > div p { max-width: 68ch; color: var(--rj-ink2); }
.help .first { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(420px, 100%), 1fr)); gap: 0 44px; }
.help summary h2 { display: inline; }
.help summary { margin-top: 22px; cursor: pointer; }
@media (max-width: 899px) { .help { padding: 2px 14px 24px; } .help .columns { columns: 1; } }
"""


class Help(Page):
    """The page of words and keys."""

    page = "Help"

    def layout(self) -> Viewable:
        """Make the parts of the page, and return them laid out."""
        self.host.heading.object = parts.heading(self.page, "Keys, pages, proofs and all terms", "", "")
        sheets = [parts_css(), HELP_CSS]
        self.terms = parts.html_pane(stylesheets=sheets)
        self.search = pmui.TextInput(label="Find a term", size="small", width=260, margin=(8, 20))
        self.search.param.watch(self._find, "value_input")
        # a term that is asked for on another page is not to be hidden here
        self.desk.param.watch(lambda *_: self.search.param.update(value="", value_input=""), "page")
        self._find()
        first = parts.html_pane(first_html(), stylesheets=sheets)
        return parts.stack(first, self.search, self.terms, parts.html_pane(last_html(), stylesheets=sheets))

    def _find(self, *_: Any) -> None:
        self.terms.object = glossary_html(self.search.value_input or "")


def first_html() -> Markup:
    """Return the pages and the keys."""
    both = markup('<div class="first"><div>{}</div><div>{}</div></div>', pages_html(), keys_html())
    return markup('<div class="help">{}{}<h2 id="terms">All terms</h2></div>', documentation_html(), both)


def last_html() -> Markup:
    """Return how to read a proof, and the limits."""
    return markup('<div class="help">{}{}</div>', proof_html(), limits_html())


def limits_html() -> Markup:
    """Write the table of limits."""
    row = "<tr><td>{}</td><td>{}</td><td>{}</td></tr>"
    rows = joined(markup(row, limit.of, limit.page, limit.library) for limit in limits())
    note = "Larger requests are refused in a sentence before anything is computed: all visitors share this server."
    template = (
        '<details><summary><h2 id="limits">Limits</h2></summary>{}<table class="limits"><thead><tr><th>Of</th>'
        "<th>On this page</th><th>In a terminal</th></tr></thead><tbody>{}</tbody></table></details>"
    )
    return markup(template, parts.note_paragraphs([note]), rows)


def documentation_html() -> Markup:
    """Return the link to the documentation, which the same server has; nothing where it is not built."""
    if not is_built():
        return Markup()
    # relative, as a proxy may serve the page below any path
    link = markup('<a href="docs/" target="_blank" rel="noopener">Documentation</a>')
    return markup("<p>{}: tutorials, how-to, the mathematics, Python and all commands.</p>", link)


def keys_html() -> Markup:
    """Write the table of keys."""
    rows = joined(markup("<tr><td><kbd>{}</kbd></td><td>{}</td></tr>", key, does) for key, does in KEYS)
    note = "The keys ?, 1 to 9 and P are off while you type in a field."
    return markup('<h2 id="keys">Keys</h2><table><tbody>{}</tbody></table>{}', rows, parts.note_paragraphs([note]))


def pages_html() -> Markup:
    """Return the pages with their questions and keys."""
    rows = []
    for name, entry in PAGES.items():
        key = str(KEYED.index(name) + 1) if name in KEYED else "?" if name == "Help" else ""
        # assets/scripts/browser.js turns to the page that data-open names
        button = markup('<button type="button" class="open-page" data-open="{0}">{0}</button>', name)
        pressed = markup("<kbd>{}</kbd>", key) if key else ""
        row = '<tr><td>{}</td><td>{}</td><td>{}<br><span class="muted">{}</span></td></tr>'
        rows.append(markup(row, button, pressed, entry.question, USES[name]))
    return markup('<h2 id="pages">Pages</h2><table><tbody>{}</tbody></table>', joined(rows))


def proof_html() -> Markup:
    """Return how to read a proof."""
    rows = joined(markup("<div><h3>{}</h3><p>{}</p></div>", title, text) for title, text in PROOF)
    return markup('<h2 id="proof">How to read a proof</h2><div class="columns">{}</div>', rows)


def glossary_html(part: str = "") -> Markup:
    """Return the terms that have a text in name, labels or explanation, by group; all without one."""
    groups = joined(
        markup("<h3>{}</h3><dl>{}</dl>", group, joined(map(entry_html, found)))
        for group, terms in GROUPS.items()
        if (found := [term for term in terms if part.lower() in _text(term)])
    )
    none = markup("<p role=status>No term has \u201c{}\u201d.</p>", part)
    return markup('<div class="help"><div class="columns">{}</div></div>', groups or none)


def _text(term: Term) -> str:
    return " ".join((term.name, *term.labels, term.text)).lower()


def entry_html(term: Term) -> Markup:
    """Return one term with what else it is called on the pages."""
    others = ", ".join(term.labels)
    also = markup(" <span>\u00b7 {}</span>", others) if others else ""
    template = '<div id="term-{}" tabindex="-1"><dt>{}{}</dt><dd>{}</dd></div>'
    return markup(template, term.slug, term.name, also, term.text)
