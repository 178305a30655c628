import re
from pathlib import Path

import pytest
from bokeh.models import Span

from railjoule.core.phases import NAMES
from railjoule.core.strategies import STRATEGIES
from railjoule.dashboard.look.paint import Palette
from railjoule.dashboard.look.theme import padded, parts_css, strategies_css
from railjoule.dashboard.look.tokens import (
    DARK,
    DASHES,
    LIGHT,
    NARROW_PX,
    PIN_DASHES,
    THEMES,
    WIDE_PX,
    ThemeName,
    variable,
)

READABLE, VISIBLE = 4.5, 3.0
"""Least contrasts of text and of lines: WCAG 2.2, success criteria 1.4.3 and 1.4.11."""


def luminance(colour: str) -> float:
    """Relative luminance as WCAG 2.2 defines it."""
    channels = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    brighter, darker = sorted((luminance(one), luminance(other)), reverse=True)
    return (brighter + 0.05) / (darker + 0.05)


def test_both_themes_name_the_same_colours() -> None:
    assert LIGHT.keys() == DARK.keys()


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_text_can_be_read(theme: ThemeName) -> None:
    tokens = THEMES[theme]
    for ink in ("ink", "ink2", "ink3", "accent", "good", "warn", "bad", "limit"):
        assert contrast(tokens[ink], tokens["surface"]) >= READABLE, ink
    for phase in NAMES:
        assert contrast(tokens[f"on_{phase}"], tokens[phase]) >= READABLE, phase


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_lines_of_strategies_stand_out(theme: ThemeName) -> None:
    for name in (*STRATEGIES, "pinned"):
        assert contrast(THEMES[theme][name], THEMES[theme]["surface"]) >= VISIBLE, name


def test_painted_models_follow_the_theme() -> None:
    palette, line = Palette(dark=False), Span()
    palette.paint(line, line_color="accent")
    assert line.line_color == LIGHT["accent"]
    palette.switch(dark=True)
    assert line.line_color == DARK["accent"]
    assert palette.tokens == DARK


ROOT = Path(__file__).parents[3]


def test_all_style_sheets_have_the_same_borders() -> None:
    paths = [*(ROOT / "dashboard").rglob("*.py"), *(ROOT / "assets" / "css").glob("*.css")]
    texts = [*(path.read_text(encoding="utf-8") for path in paths), padded("1px", "2px")]
    ends = {int(end) for text in texts for end in re.findall(r"max-width: (\d+)px\)", text)}
    assert {end for end in ends if abs(end - NARROW_PX) < 50 or abs(end - WIDE_PX) < 50} == {
        NARROW_PX - 1,
        WIDE_PX - 1,
    }


def test_each_line_has_a_sample() -> None:
    for sheet in (parts_css(), strategies_css()):
        assert all(f".stroke.{variable(name)} {{ stroke: var(--rj-" in sheet for name in (*DASHES, *PIN_DASHES))
