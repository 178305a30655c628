"""The tokens as style sheets and as a theme of panel-material-ui."""

import base64
from functools import cache
from importlib.resources import files
from typing import Any

from railjoule.dashboard.look.tokens import (
    DASHES,
    FONT,
    LIGHT,
    NARROW_PX,
    PIN_DASHES,
    THEMES,
    ThemeName,
    Tokens,
    line_width,
    variable,
)

ASSETS = files("railjoule.assets")
DURATIONS = ("shortest", "shorter", "short", "standard", "complex", "enteringScreen", "leavingScreen")
"""Of the movements of panel-material-ui."""


def _with_info(name: str) -> str:
    """Return a style sheet of the assets with that of the buttons which explain a term."""
    return "".join((ASSETS / "css" / sheet).read_text(encoding="utf-8") for sheet in ("info.css", f"{name}.css"))


@cache
def _samples() -> str:
    """Return the strokes and colours of the samples beside words, by class: they are sent once, not with each."""
    strokes = [".stroke { width: 22px; height: 8px; }"]
    for name, dash in (*DASHES.items(), *PIN_DASHES.items()):
        pattern = "none" if isinstance(dash, str) else " ".join(map(str, dash))
        line = f"stroke-width: {line_width(name):g}; stroke-dasharray: {pattern};"
        strokes.append(f".stroke.{variable(name)} {{ stroke: var(--rj-{variable(name)}); {line} }}")
    phases = [name.removeprefix("on_") for name in LIGHT if name.startswith("on_")]
    colours = map(variable, [*phases, *DASHES])
    return "\n".join([*strokes, *(f".patch.{name} {{ background: var(--rj-{name}); }}" for name in colours)])


@cache
def parts_css() -> str:
    """Return the style sheet of all pieces of text, numbers and tables."""
    return _with_info("parts") + _samples()


@cache
def strategies_css() -> str:
    """Return the style sheet of the sidebar's strategies."""
    return _with_info("strategies") + _samples()


@cache
def number_css() -> str:
    """Return the style sheet of the field of a number."""
    return _with_info("number_field")


def padded(usual: str, narrow: str) -> str:
    """Return the style sheet of a place with some room around what it holds, and with other room on narrow screens."""
    return f":host {{ padding: {usual}; }} @media (max-width: {NARROW_PX - 1}px) {{ :host {{ padding: {narrow}; }} }}"


@cache
def editor_css() -> str:
    """Return the style sheet of the scenario editor's forms, that of all pieces of text included."""
    return parts_css() + (ASSETS / "css" / "editor.css").read_text(encoding="utf-8")


@cache
def played_css() -> str:
    """Return the style sheet of the lessons that are played."""
    return (ASSETS / "css" / "played.css").read_text(encoding="utf-8")


@cache
def lesson_css() -> str:
    """Return the style sheet of what the lessons with live figures ask and tell."""
    return (ASSETS / "css" / "lesson.css").read_text(encoding="utf-8")


@cache
def explore_css() -> str:
    """Return the style sheet of the parts of the page Explore, used with that of all pieces of text."""
    return (ASSETS / "css" / "explore.css").read_text(encoding="utf-8")


@cache
def document_css() -> str:
    """Return the style sheet of the document: font, colours of both themes, focus."""
    light, dark = (_variables(THEMES[name]) for name in ("light", "dark"))
    colours = (
        f":root {{ {light} --rj-font: {FONT}; color-scheme: light }}\n:root.rj-dark {{ {dark} color-scheme: dark }}"
    )
    return "\n".join([_font_face(), colours, (ASSETS / "css" / "page.css").read_text(encoding="utf-8")])


@cache
def report_css() -> str:
    """Return the style sheet of a report: colours as the system asks for them, on paper always the light ones."""
    own = (ASSETS / "css" / "report.css").read_text(encoding="utf-8")
    # a report has no components with roots of their own: what holds within them holds for its body
    return "\n".join([_font_face(), bare_css(), parts_css().replace(":host", "body"), own])


@cache
def bare_css() -> str:
    """Return the style sheet of a page without a script: colours as the system asks for them, no font of its own."""
    light, dark = (_variables(THEMES[name]) for name in ("light", "dark"))
    colours = (
        f":root {{ {light} --rj-font: {FONT}; color-scheme: light }}\n"
        # only on the screen, as paper is white
        f"@media screen and (prefers-color-scheme: dark) {{ :root {{ {dark} color-scheme: dark }} }}"
    )
    return "\n".join([colours, (ASSETS / "css" / "page.css").read_text(encoding="utf-8")])


def _font_face() -> str:
    # in the sheet itself, as a report is one file and asks for no other
    font = base64.b64encode((ASSETS / "fonts" / "inter-latin-wght-normal.woff2").read_bytes()).decode()
    return f"@font-face {{ font-family: Inter; font-weight: 100 900; src: url(data:font/woff2;base64,{font}) }}"


def _variables(tokens: Tokens) -> str:
    return " ".join(f"--rj-{variable(name)}: {colour};" for name, colour in tokens.items())


def material_theme() -> dict[str, Any]:
    """Return the theme of panel-material-ui's components, light and dark."""
    return {name: _material(name, tokens) for name, tokens in THEMES.items()}


def _material(name: ThemeName, t: Tokens) -> dict[str, Any]:
    def root(**style: Any) -> dict[str, Any]:
        return {"styleOverrides": {"root": style}}

    return {
        "palette": {
            "mode": name,
            "primary": {"main": t["accent"], "contrastText": t["surface"]},
            "background": {"default": t["page"], "paper": t["surface"]},
            "text": {"primary": t["ink"], "secondary": t["ink3"]},
            "divider": t["line"],
            "error": {"main": t["bad"]},
            "success": {"main": t["good"]},
            "warning": {"main": t["warn"]},
        },
        "typography": {"fontFamily": FONT, "fontSize": 13, "button": {"textTransform": "none", "fontWeight": 500}},
        "shape": {"borderRadius": 6},
        # nothing moves but data; and colours that fade would be unreadable half way from light to dark
        "transitions": {"duration": dict.fromkeys(DURATIONS, 0)},
        "components": {
            # the library writes tabs and toggle buttons in capitals, which makes KM/H of km/h
            "MuiTab": root(
                textTransform="none", minHeight=48, minWidth=0, padding="0 10px", fontSize=13, color=t["ink2"]
            ),
            "MuiTabs": {"styleOverrides": {"root": {"minHeight": 48}, "indicator": {"height": 2}}},
            "MuiToggleButton": root(textTransform="none", padding="2px 10px", fontSize=12, lineHeight="20px"),
            # as high as the bar of pages; Material's own are 56 px, in wide windows 64 px
            "MuiToolbar": root(
                minHeight="48px !important",
                margin="0 !important",
                paddingLeft="16px !important",
                paddingRight="12px !important",
            ),
            "MuiButtonBase": {"defaultProps": {"disableRipple": True}},
            "MuiButton": {
                "defaultProps": {"disableElevation": True},
                "styleOverrides": {"root": {"fontSize": 13, "padding": "3px 10px", "minWidth": 0}},
            },
            "MuiFormLabel": root(fontSize=13, color=t["ink2"]),
            "MuiDrawer": {
                "styleOverrides": {
                    "paper": {
                        "backgroundColor": t["page"],
                        "backgroundImage": "none",
                        "borderRight": f"1px solid {t['line']}",
                    }
                }
            },
            # in the dark, the library lightens its papers by a gradient over their colour
            "MuiPaper": root(backgroundImage="none"),
        },
    }
