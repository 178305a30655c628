"""The scenario within a report, so that the report can be loaded in the place of the scenario's file."""

import re

from railjoule.core import ScenarioError

OPENING = '<script type="application/toml" id="scenario">'
CLOSING = "</script>"
MARKUP_ESCAPES = {"<": "\\u003C", ">": "\\u003E"}
"""How TOML's basic strings write what HTML could take for a tag."""
# a backslash is taken with the sign after it, as an escaped quote ends no string
STRING = re.compile(r'"(?:\\.|[^"\\])*"')


def embedded(toml: str) -> str:
    """Return a scenario's TOML as an element of HTML.

    Within the strings of TOML all signs of markup are escaped in TOML's own way, so that what stands there is still the
    scenario and no text in it can end the element.

    Parameters
    ----------
    toml : str
        As `railjoule.core.scenario.format_scenario` writes it, without literal strings and comments.
    """
    return f"{OPENING}\n{STRING.sub(lambda string: _without_markup(string.group()), toml)}{CLOSING}"


def _without_markup(text: str) -> str:
    for sign, escape in MARKUP_ESCAPES.items():
        text = text.replace(sign, escape)
    return text


def scenario_in_report(html: str, name: str) -> str:
    """Return the TOML of the scenario that a report holds.

    Parameters
    ----------
    html : str
        The report.
    name : str
        What its file is called.

    Raises
    ------
    ScenarioError
        If there is none.
    """
    _, opening, rest = html.partition(OPENING)
    toml, closing, _ = rest.partition(CLOSING)
    if not opening or not closing:
        raise ScenarioError(f"{name}: not a report of railjoule: it contains no scenario.")
    return toml.lstrip("\r\n")
