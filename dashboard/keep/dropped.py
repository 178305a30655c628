"""The scenario in a file that a user brings: a TOML file, or a report that carries one."""

import re
from pathlib import PurePath

from railjoule.core import RailjouleError, ScenarioError
from railjoule.core.scenario.text_file import MAX_FILE_BYTES, TomlError
from railjoule.dashboard.limits import LONGEST_TEXT

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
        Name of its file.

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


# by its first letters: a report is one under any name of its file
PAGE = re.compile(r"\s*(<!doctype html|<html)", re.IGNORECASE)
LARGEST_REPORT_BYTES, LARGEST_SCENARIO_BYTES = MAX_FILE_BYTES, LONGEST_TEXT
REPORTS, SCENARIOS, TABLES = (".html", ".htm"), (".toml",), (".csv", ".tsv", ".xls", ".xlsx", ".ods")
WHAT_CAN_BE_OPENED = "Only scenarios (.toml) and reports of railjoule (.html) can be opened"
ELSEWHERE = "; bring tables of a line on the page Files, or paste one into its list in the editor"
NO_SCENARIO, NO_TEXT = "it contains no scenario", "it is not UTF-8 text"
TOO_LARGE = (
    f"it is larger than the {LARGEST_SCENARIO_BYTES / 1e6:g} MB of a scenario or the {LARGEST_REPORT_BYTES / 1e6:g} MB "
    "of a report"
)


def scenario_text(text: str, name: str) -> str:
    """Return the TOML of a file: the file itself, or what a report embeds.

    Raises
    ------
    ScenarioError
        If the file is too large, or a page without a scenario.
    """
    # once more than in the browser, as any client can send more
    if len(text) > LARGEST_REPORT_BYTES:
        raise ScenarioError(refused_file(name, TOO_LARGE))
    # editors on Windows begin a file with this mark, which TOML refuses
    text = text.removeprefix("\ufeff")
    toml = scenario_in_report(text, name) if PAGE.match(text) else text
    if len(toml) > LARGEST_SCENARIO_BYTES:
        raise ScenarioError(refused_file(name, TOO_LARGE))
    return toml


def words_of(refusal: RailjouleError, name: str) -> str:
    """Return why the scenario of a file is refused; what is wrong in a TOML file only where it is meant to be one."""
    foreign = PurePath(name).suffix.lower() not in {*SCENARIOS, *REPORTS}
    return refused_file(name, NO_SCENARIO) if foreign and isinstance(refusal, TomlError) else str(refusal)


def refused_file(name: str, reason: str) -> str:
    """Return why a file cannot be opened, and what can."""
    suffix = PurePath(name).suffix.lower()
    return f"{name}: {reason}. {WHAT_CAN_BE_OPENED}{ELSEWHERE if suffix in TABLES else ''}."
