"""The scenario in a file that a user drops: a TOML file, or a report that carries one."""

import re

from railjoule.core import ScenarioError

EMBEDDED = re.compile(
    r"""<script\b[^>]*\btype=["']application/toml["'][^>]*>(?P<toml>.*?)</script""", re.DOTALL | re.IGNORECASE
)
PAGE = re.compile(r"\s*(<!doctype html|<html)", re.IGNORECASE)


def scenario_text(text: str, name: str) -> str:
    """Return the TOML of a file: the file itself, or what a report embeds.

    Raises
    ------
    ScenarioError
        If the file is a page without a scenario.
    """
    text = text.removeprefix("\ufeff")
    if not PAGE.match(text):
        return text
    found = EMBEDDED.search(text)
    if found is None:
        raise ScenarioError(f"{name}: a page that carries no scenario; a report of railjoule does.")
    return found["toml"].replace("<\\/script", "</script").strip("\n")
