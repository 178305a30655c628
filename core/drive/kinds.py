"""The kinds of drives: the number of each in compiled code, and its capabilities."""

from typing import NamedTuple

CONSTANT_EFFICIENCY = 0
COPPER_LOSS = 1
INDUCTION = 2
LOSS_POLYNOMIAL = 3
LOSS_MAP = 4

PowerTerms = tuple[float, float, float, float, float, float]
"""A power p [W] and its derivatives by effort f [N] and speed v [m/s]: p, p_f, p_v, p_ff, p_fv, p_vv."""


class Capabilities(NamedTuple):
    """The properties of a kind of drive that the solver and its bounds depend on.

    Parameters
    ----------
    has_idle_losses : bool
        Whether the drive has idle losses: it takes power without effort while it is on, and none while it is off. The
        parameters of such a kind begin with those of `railjoule.core.drive.geared`.
    may_draw_while_braking : bool
        Whether braking may need supply power, near standstill.
    geared : bool
        Whether the losses of a motor with its inverter are a function of torque and speed that is never negative.
    concave : bool
        Whether the power may be concave in the effort, and the losses may fall with speed, as no formula excludes it:
        the relaxation then works on tabulated lower convex envelopes.
    """

    has_idle_losses: bool
    may_draw_while_braking: bool
    geared: bool
    concave: bool = False


CAPABILITIES = (
    Capabilities(has_idle_losses=False, may_draw_while_braking=False, geared=False),  # CONSTANT_EFFICIENCY
    Capabilities(has_idle_losses=False, may_draw_while_braking=True, geared=False),  # COPPER_LOSS
    Capabilities(has_idle_losses=True, may_draw_while_braking=True, geared=False),  # INDUCTION
    Capabilities(has_idle_losses=True, may_draw_while_braking=True, geared=True),  # LOSS_POLYNOMIAL
    Capabilities(has_idle_losses=True, may_draw_while_braking=True, geared=True, concave=True),  # LOSS_MAP
)
"""The capabilities of each kind, by its number. A number without a row is an error, in compiled code as well."""

IDLE_LOSSES, DRAWS, GEARED, CONCAVE = zip(*CAPABILITIES, strict=True)
"""The columns of the table, for compiled code."""
