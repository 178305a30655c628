"""The kinds of drives: the number by which compiled code knows each, and what it can do."""

from typing import NamedTuple

CONSTANT_EFFICIENCY = 0
COPPER_LOSS = 1
INDUCTION = 2
LOSS_POLYNOMIAL = 3
LOSS_MAP = 4


class Capabilities(NamedTuple):
    """What a kind of drive can do, and how the solver and its proof treat it.

    Parameters
    ----------
    jumps_at_no_effort : bool
        Whether it takes power without effort when it is on, and none when it is off: power jumps there. The kind then
        needs an `idle_power` and powers that fall to it with the effort.
    may_draw_while_braking : bool
        Whether it may need power of the line to brake, near standstill.
    geared : bool
        Whether its losses are those of each of several motors behind gears, by a `motor_loss`.
    concave : bool
        Whether its power may be concave in the effort, and its losses fall with speed, as no formula rules out: the
        relaxation then works on tabulated lower convex envelopes.
    """

    jumps_at_no_effort: bool
    may_draw_while_braking: bool
    geared: bool
    concave: bool = False


CAPABILITIES = (
    Capabilities(jumps_at_no_effort=False, may_draw_while_braking=False, geared=False),  # CONSTANT_EFFICIENCY
    Capabilities(jumps_at_no_effort=False, may_draw_while_braking=True, geared=False),  # COPPER_LOSS
    Capabilities(jumps_at_no_effort=True, may_draw_while_braking=True, geared=False),  # INDUCTION
    Capabilities(jumps_at_no_effort=True, may_draw_while_braking=True, geared=True),  # LOSS_POLYNOMIAL
    Capabilities(jumps_at_no_effort=True, may_draw_while_braking=True, geared=True, concave=True),  # LOSS_MAP
)
"""The row of each kind at its number; asking for a number without a row is an error, in compiled code as well."""

JUMPS = tuple(row.jumps_at_no_effort for row in CAPABILITIES)
DRAWS = tuple(row.may_draw_while_braking for row in CAPABILITIES)
GEARED = tuple(row.geared for row in CAPABILITIES)
CONCAVE = tuple(row.concave for row in CAPABILITIES)
"""The columns of the table, as compiled code takes them."""
