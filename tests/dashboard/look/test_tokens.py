import pytest

from railjoule.core.phases import NAMES
from railjoule.core.scenario import StrategyName
from railjoule.dashboard.look.tokens import DARK, LIGHT, THEMES, ThemeName

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
    for name in (*StrategyName.__args__, "pinned"):  # type: ignore[attr-defined]
        assert contrast(THEMES[theme][name], THEMES[theme]["surface"]) >= VISIBLE, name
