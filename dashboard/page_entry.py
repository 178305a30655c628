"""What is known of a page before it is opened: the question that it answers, and its place in the app bar."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class PageEntry:
    """One page.

    Parameters
    ----------
    question : str
        What it answers, in one sentence: its heading.
    place : str
        Where it is found: behind the brand, in the bar, or at the bar's right end.
    group : str
        The entry of the bar whose list names it; empty where it is an entry itself.
    has_sidebar : bool
        Whether the scenario stands beside it.
    has_plan : bool
        Whether the sidebar has the sliders of the plan.
    strategies : str
        What the list of strategies is for beside it: "draw" them, only "choose" the one of all numbers, or nothing.
    """

    question: str
    place: Literal["brand", "bar", "right"] = "bar"
    group: str = ""
    has_sidebar: bool = True
    has_plan: bool = True
    strategies: Literal["draw", "choose", ""] = "choose"
