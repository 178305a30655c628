"""The strategies as the dashboard shows them: name, line and explanation of each, in one table.

The command line, the pages, the charts, the glossary and the reports read it. A strategy of the core without an entry
is called by its key and drawn with a spare line, without an explanation.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from railjoule.core.scenario import STRATEGY_NAMES, StrategyName

Dash = str | list[int]


@dataclass(frozen=True)
class StrategyLook:
    """How one strategy is shown.

    Parameters
    ----------
    label : str
        Its name on pages and in the terminal.
    light, dark : str
        Colour of its line in the light and in the dark theme.
    dash : str or list of int
        Pattern of that line, as Bokeh has it.
    text : str
        Its entry in the glossary, at most 35 words; none where it is empty.
    labels : tuple of str
        Other labels on the pages that this entry explains.
    """

    label: str
    light: str
    dark: str
    dash: Dash
    text: str = ""
    labels: tuple[str, ...] = ()


# colours lie at least 20 apart in CIELAB to all three kinds of colour blindness, in the dark theme 16; their lightness
# differs by 3.8 at least, so that they can be told in grey print
STRATEGY_LOOKS: dict[str, StrategyLook] = {
    "optimal": StrategyLook(
        "Optimal",
        "#0B5BD3",
        "#7AA2FF",
        "solid",
        "The run that needs the least energy in the given time, found by an interior-point method. A lower "
        "bound, computed separately, shows how far it can be from the true optimum.",
        ("Optimum",),
    ),
    "bellman": StrategyLook(
        "Bellman",
        "#5B1A8B",
        "#A86BC8",
        [2, 2],
        "Dynamic programming: a search over a grid of positions and speeds, with a price on time. Slower than the "
        "optimal solver and independent of it, so it serves as a check.",
        ("Bellman's map",),
    ),
    "eoc": StrategyLook(
        "EOC",
        "#A62B0E",
        "#F26B2C",
        [8, 3],
        "Energy-optimal control of the Ftorek paper: the effort that the optimality conditions prescribe, a "
        "boundary value problem. It changes smoothly over the run. For level lines without limits.",
    ),
    "enoc": StrategyLook(
        "ENOC",
        "#C27C00",
        "#F5C542",
        [8, 3, 2, 3],
        "Energy near-optimal control of the same paper: accelerate evenly, cruise, brake evenly, with ramps of "
        "equal length. Its energy is a closed formula. For level lines without limits.",
        ("ENOC energy",),
    ),
    "phases": StrategyLook(
        "Four phases",
        "#00845C",
        "#36D39A",
        [4, 3],
        "The best run of four phases between two stops: full power, hold a speed, coast, brake. It is what "
        "a driver can remember.",
        ("Phases", "Phase"),
    ),
    "speed_limits": StrategyLook(
        "Set speeds",
        "#D6409F",
        "#EE92C6",
        [12, 4],
        "One set speed for each section of the line: below it the train drives, above it it coasts or brakes. "
        "The strategy searches the set speeds that need the least energy.",
        ("Speed limits",),
    ),
    "fastest": StrategyLook(
        "Fastest",
        "#1D242D",
        "#EBF2FF",
        [1, 3],
        "The shortest possible run: full power, then the limits, then full braking. It shows how much time "
        "there is to save energy with.",
    ),
}
"""The look of each strategy by its key in the core."""
SPARE_LINE: tuple[str, str, Dash] = ("#66707D", "#8F9AA8", [6, 2])
"""Colours, light and dark, and pattern of a strategy without an entry: the grey of secondary text."""


def look_of(name: StrategyName) -> StrategyLook:
    """Return the look of a strategy; of one without an entry that of its key."""
    return STRATEGY_LOOKS.get(name) or StrategyLook(name.replace("_", " ").capitalize(), *SPARE_LINE)


LOOKS: Mapping[StrategyName, StrategyLook] = {name: look_of(name) for name in STRATEGY_NAMES}
"""The look of every strategy, in the order in which they are shown."""
