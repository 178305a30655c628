"""The glossary: every term and every number that the pages show, from assets/texts/glossary.toml.

Entries of strategies are in `railjoule.core.strategies`.
"""

import re
import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from railjoule.core import strategy
from railjoule.dashboard.look.markup import Markup, markup

# an entry opens within the page, and pushes down the content below it
MOST_WORDS = 35


@dataclass(frozen=True)
class Term:
    """One entry.

    Parameters
    ----------
    name : str
        Label by which it is looked up.
    text : str
        Meaning here.
    labels : tuple of str
        Other names on the pages: labels of numbers and of fields.
    """

    name: str
    text: str
    labels: tuple[str, ...] = ()

    @property
    def slug(self) -> str:
        """Its name in addresses and attributes."""
        return re.sub(r"[^a-z0-9]+", "-", self.name.lower()).strip("-")


STRATEGIES = tuple(Term(one.label, one.help, one.labels) for one in strategy.STRATEGIES.values() if one.help)
_TEXTS = tomllib.loads((files("railjoule.assets") / "texts" / "glossary.toml").read_text(encoding="utf-8"))
GROUPS: dict[str, tuple[Term, ...]] = {
    "Strategies": STRATEGIES,
    **{
        group: tuple(Term(**{**entry, "labels": tuple(entry.get("labels", ()))}) for entry in entries)
        for group, entries in _TEXTS.items()
    },
}
"""All terms as Help lists them."""
TERMS = tuple(term for terms in GROUPS.values() for term in terms)


@cache
def _by_label() -> dict[str, Term]:
    return {label: term for term in TERMS for label in (term.name, *term.labels)}


def find_term(label: str) -> Term | None:
    """Return the entry that explains a label or a term, if there is one."""
    return _by_label().get(label)


def texts() -> dict[str, dict[str, str]]:
    """Return name and text of each entry by its slug, as the browser shows them."""
    return {term.slug: {"name": term.name, "text": term.text} for term in TERMS}


def info(label: str) -> Markup:
    """Return the button that explains a label; nothing where the glossary does not know it."""
    term = find_term(label)
    if term is None:
        return Markup()
    return markup(
        "<button class=info data-term='{}' aria-expanded=false aria-label='What is meant: {}'></button>",
        term.slug,
        term.name,
    )
