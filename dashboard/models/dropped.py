"""The scenario in a file that a user brings: a TOML file, or a report that carries one."""

import re

from railjoule.dashboard.report.embedded import scenario_in_report

PAGE = re.compile(r"\s*(<!doctype html|<html)", re.IGNORECASE)


def scenario_text(text: str, name: str) -> str:
    """Return the TOML of a file: the file itself, or what a report embeds.

    Raises
    ------
    ScenarioError
        If the file is a page without a scenario.
    """
    text = text.removeprefix("\ufeff")
    return scenario_in_report(text, name) if PAGE.match(text) else text
