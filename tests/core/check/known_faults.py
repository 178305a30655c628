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


LITERAL = "the printed regulator arrives at any speed, and its last step of time makes any force of it"
REGULATOR = "the ideal regulator passes a limit by some thousandths where one phase follows another within a cell"

KNOWN_FAULTS = (
    KnownFault("optimal", "late arrival", "the interior point stops a millionth of a second late", (6, 48)),
    KnownFault(
        "speed_limits",
        "cells long enough for their places",
        "borders of its phases fall all but on nodes of the mesh",
        (170, 216, 260, 292, 294),
    ),
    KnownFault("speed_limits", "acceleration", LITERAL, (48, 102, 180, 204)),
    KnownFault("speed_limits", "deceleration", LITERAL, (39, 82, 102, 109, 123, 180, 233, 235, 236, 259, 287, 290)),
    KnownFault(
        "speed_limits",
        "electric braking effort",
        LITERAL,
        (8, 12, 13, 37, 48, 58, 106, 109, 132, 172, 180, 204, 235, 236, 247, 250, 284),
    ),
    KnownFault("speed_limits", "electric braking power", LITERAL, (8, 12, 48, 58, 106, 132, 250)),
    KnownFault(
        "speed_limits",
        "friction braking effort",
        LITERAL,
        (0, 3, 19, 61, 67, 81, 135, 163, 189, 205, 210, 262, 274, 287),
    ),
    KnownFault("speed_limits", "motors while braking", LITERAL, (58, 106, 172, 250)),
    KnownFault("speed_limits", "motors while driving", LITERAL, (82,)),
    KnownFault("speed_limits", "speed limit", LITERAL, (0, 264)),
    KnownFault("speed_limits", "tractive effort", LITERAL, (12,)),
    KnownFault("speed_limits", "tractive power", LITERAL, (0, 12, 13, 37, 123, 150, 172, 233, 235, 250, 264, 290)),
    KnownFault(
        "speed_limits",
        "electric braking effort",
        REGULATOR,
        (
            *(
                14,
                24,
                28,
                32,
                42,
                53,
                56,
                59,
                68,
                71,
                72,
                84,
                92,
                101,
                116,
                117,
                118,
                122,
                128,
                146,
                147,
                155,
                157,
                164,
            ),
            *(164, 181, 184, 186, 188, 193, 208, 213, 223, 225, 228, 244, 255, 256, 257, 261, 270, 280, 286, 288),
            *(294, 297),
        ),
    ),
    KnownFault(
        "speed_limits",
        "friction braking effort",
        REGULATOR,
        (29, 30, 35, 36, 90, 96, 119, 136, 140, 161, 166, 217, 218, 227, 246, 248, 278),
    ),
    KnownFault("speed_limits", "motors while driving", REGULATOR, (94,)),
)


def known_rules(strategy: str, seed: int) -> set[str]:
    """Return the rules that a run of a strategy over the scenario of a seed is known to break."""
    return {fault.rule for fault in KNOWN_FAULTS if fault.strategy == strategy and seed in fault.seeds}
