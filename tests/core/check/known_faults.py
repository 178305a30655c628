"""What runs of this version are known to break of their scenarios of `tests.any_scenarios`, and why.

Strict: a run that is listed must break its rule, so that whoever cures a fault takes it off this list.
`python -m tests.core.check.any_runs` prints what is broken now.
"""

from typing import NamedTuple


class KnownFault(NamedTuple):
    """A rule that runs of a strategy break, why, and over the scenarios of which seeds."""

    strategy: str
    rule: str
    reason: str
    seeds: tuple[int, ...]


TABULATED = "limits of power that stand in a table with those of motors are rounded at its corners"

KNOWN_FAULTS = (
    KnownFault("bellman", "tractive power", TABULATED, (161, 203)),
    KnownFault("fastest", "tractive power", TABULATED, (125, 161, 203)),
    KnownFault("optimal", "tractive power", TABULATED, (161, 203)),
    KnownFault(
        "optimal",
        "early arrival",
        "of a drive that takes power without effort it takes a run that arrives early for the best, though time has a "
        "price",
        (3,),
    ),
    KnownFault("optimal", "late arrival", "the interior point stops a millionth of a second late", (6, 48)),
    KnownFault(
        "phases",
        "cells long enough for their places",
        "a phase of braking from next to no speed makes a cell of next to no length",
        (25, 80, 89, 190),
    ),
    KnownFault("phases", "motors while braking", "the same cell holds a force that is rounding", (190,)),
)


def known_rules(strategy: str, seed: int) -> set[str]:
    """Return the rules that a run of a strategy over the scenario of a seed is known to break."""
    return {fault.rule for fault in KNOWN_FAULTS if fault.strategy == strategy and seed in fault.seeds}
