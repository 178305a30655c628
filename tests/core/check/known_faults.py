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


KNOWN_FAULTS: tuple[KnownFault, ...] = ()


def known_rules(strategy: str, seed: int) -> set[str]:
    """Return the rules that a run of a strategy over the scenario of a seed is known to break."""
    return {fault.rule for fault in KNOWN_FAULTS if fault.strategy == strategy and seed in fault.seeds}
