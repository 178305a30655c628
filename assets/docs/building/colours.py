"""The colours of the dashboard, as the pages and their pictures take them."""

from railjoule.dashboard.look.tokens import DARK, LIGHT, THEMES, ThemeName, variable

NAMES = ("optimal", "enoc", "phases", "speed_limits", "bellman", "eoc", "pin_1", "fastest")
"""Colours of the lines of a picture, in the order in which they are taken."""


def style_sheet() -> str:
    """Return the variables of both themes; that of the system is taken."""
    light, dark = (";".join(f"--rj-{variable(name)}:{value}" for name, value in one.items()) for one in (LIGHT, DARK))
    return f":root{{{light}}} @media (prefers-color-scheme: dark) {{:root{{{dark}}}}}"


def with_variables(svg: str) -> str:
    """Return a picture drawn in light colours that takes those of the page on which it stands."""
    return _replaced(svg, {name: f"var(--rj-{variable(name)})" for name in LIGHT})


def in_theme(svg: str, theme: ThemeName) -> str:
    """Return a picture drawn in light colours in those of a theme."""
    return _replaced(svg, THEMES[theme])


def _replaced(svg: str, values: dict[str, str]) -> str:
    # of names with one colour the first counts: matplotlib writes colours, and forgets what they were called
    for name, value in {LIGHT[name].lower(): value for name, value in reversed(values.items())}.items():
        svg = svg.replace(name, value)
    return svg
