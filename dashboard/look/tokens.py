"""The colours of the workbench, light and dark; look and measure are described where they are used.

Strategy colours can be distinguished under the three kinds of colour blindness and in grey print, dashes
without any colour. Both stand in `railjoule.core.strategy`.
"""

from typing import Literal

from railjoule.core.strategy import STRATEGIES

ThemeName = Literal["light", "dark"]
Tokens = dict[str, str]

# on `surface` inks have a contrast of 4.5 and lines of 3 at least, as WCAG 2.2 asks in 1.4.3 and 1.4.11: a new colour
# has to keep that, see tests/dashboard/look/test_tokens.py
LIGHT: Tokens = {
    "page": "#F4F6F8",
    "surface": "#FFFFFF",
    "line": "#E1E5EA",
    "line2": "#CBD2DA",
    "grid": "#EDF0F3",
    "ink": "#161B22",
    "ink2": "#444D59",
    "ink3": "#66707D",
    "accent": "#0B5BD3",
    "tint": "#E8F0FC",
    "good": "#0A7A4B",
    "warn": "#9A5B00",
    "bad": "#B3261E",
    "limit": "#B3261E",
    "ground": "#E4E7EB",
    "groundline": "#9AA4AF",
    **{name: strategy.colour[0] for name, strategy in STRATEGIES.items()},
    "pinned": "#8B95A1",
    "pin_1": "#00798C",
    "pin_2": "#7A4B1E",
    "pin_3": "#5F6B00",
    "pin_4": "#8C2F6B",
    "pin_5": "#4A5A78",
    "pin_6": "#6A4FB0",
    "driven": "#A0330F",
    "actual": "#161B22",
    "over": "#F8E7D8",
    "overline": "#9A5B00",
    "costbar": "#CC6A37",
    "full_power": "#0B5BD3",
    "part_power": "#7FA9EA",
    "hold": "#BCD3F6",
    "coast": "#F4F6F8",
    "brake": "#E7B9A6",
    "stand": "#FFFFFF",
    "on_full_power": "#FFFFFF",
    "on_part_power": "#10243F",
    "on_hold": "#10243F",
    "on_coast": "#444D59",
    "on_brake": "#5A1B08",
    "on_stand": "#444D59",
}
DARK: Tokens = {
    "page": "#0E1217",
    "surface": "#14181E",
    "line": "#272E38",
    "line2": "#3A4350",
    "grid": "#1F252E",
    "ink": "#ECF0F5",
    "ink2": "#B9C2CE",
    "ink3": "#8F9AA8",
    "accent": "#7AA2FF",
    "tint": "#1B2740",
    "good": "#4CCB93",
    "warn": "#F2B84B",
    "bad": "#FF8A80",
    "limit": "#FF8A80",
    "ground": "#232A33",
    "groundline": "#5A6572",
    **{name: strategy.colour[1] for name, strategy in STRATEGIES.items()},
    "pinned": "#77828F",
    "pin_1": "#4CC4D8",
    "pin_2": "#C99A6B",
    "pin_3": "#B9C24A",
    "pin_4": "#E08BC0",
    "pin_5": "#9FB2D6",
    "pin_6": "#B09AF0",
    "driven": "#F0986A",
    "actual": "#ECF0F5",
    "over": "#33231B",
    "overline": "#F2B84B",
    "costbar": "#BA6A35",
    "full_power": "#7AA2FF",
    "part_power": "#4A6BB0",
    "hold": "#2C4478",
    "coast": "#1A1F27",
    "brake": "#6B3524",
    "stand": "#14181E",
    "on_full_power": "#0B1220",
    "on_part_power": "#F2F6FF",
    "on_hold": "#DCE7FF",
    "on_coast": "#B9C2CE",
    "on_brake": "#FFD9CB",
    "on_stand": "#B9C2CE",
}
THEMES: dict[ThemeName, Tokens] = {"light": LIGHT, "dark": DARK}
COST_SCALES: dict[ThemeName, tuple[str, ...]] = {
    "light": ("#FBF6F1", "#F8E7D8", "#F3CFB2", "#ECB188", "#E08F5E", "#CC6A37", "#AE4A1B", "#86330E"),
    "dark": ("#1D1A19", "#33231B", "#4E2E1C", "#6E3C1E", "#934F25", "#BA6A35", "#DD8F56", "#F6BE8E"),
}
"""Overconsumption, from none to most."""
SAVING_SCALES: dict[ThemeName, tuple[str, ...]] = {
    "light": ("#FBF6F1", "#E6EEF1", "#CBDFE7", "#A5C9D8", "#78AEC4", "#4A8FAB", "#27708E", "#0E516D"),
    "dark": ("#1D1A19", "#1B262B", "#1D3640", "#204A59", "#286276", "#3A7F96", "#63A2B7", "#9AC8D8"),
}
"""The opposite, from none to most; both scales begin with one colour."""

DASHES: dict[str, str | list[int]] = {
    **{name: s.dash if isinstance(s.dash, str) else list(s.dash) for name, s in STRATEGIES.items()},
    "pinned": "solid",
    "actual": [7, 3],
}
PIN_DASHES: dict[str, list[int]] = {
    "pin_1": [7, 2],
    "pin_2": [3, 2],
    "pin_3": [11, 3],
    "pin_4": [5, 2, 1, 2],
    "pin_5": [9, 2, 2, 2, 2, 2],
    "pin_6": [2, 3],
}
"""Strokes of the pinned runs where several are drawn; the numbers at the lines distinguish them too."""
WIDE_PX, NARROW_PX = 1600, 900
"""Windows from the one on, and up to the other, are laid out in other ways; the style sheets have 1599px and 899px."""
FONT = "Inter, 'Segoe UI', 'Helvetica Neue', Arial, sans-serif"


def variable(token: str) -> str:
    """Return the name of a token in style sheets."""
    return token.replace("_", "-")


def line_width(name: str) -> float:
    """Return how thick the line of a strategy is [px]: the optimum stands out."""
    return {"optimal": 2.8, "actual": 1.9}.get(name, 1.8)
