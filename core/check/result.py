"""The result of a check of a run: largest deviation from each rule, its place, and its tolerance."""

from dataclasses import dataclass

import numpy as np

from railjoule.core.arrays import FloatArray


@dataclass(frozen=True)
class Check:
    """How well a run keeps one rule.

    Parameters
    ----------
    name : str
        Of the rule.
    largest : float
        Largest deviation, as a share of `share_of`; 0 where the rule is kept everywhere, infinite where it
        cannot be computed.
    allowed : float
        Deviation that rounding and the stated accuracy of the product explain.
    at_m : float or None
        Place of the largest deviation [m]; None for the run as a whole.
    share_of : str
        Scale of the deviation, in words.
    """

    name: str
    largest: float
    allowed: float
    at_m: float | None
    share_of: str

    @property
    def ok(self) -> bool:
        """Whether the run keeps the rule."""
        return self.largest <= self.allowed


@dataclass(frozen=True)
class Unchecked:
    """A rule that could not be checked.

    Parameters
    ----------
    name : str
        Of the rule.
    reason : str
        Reason, in words that follow 'not checked:'.
    """

    name: str
    reason: str


Finding = Check | Unchecked


@dataclass(frozen=True)
class CheckResult:
    """All rules that a run was held against.

    Parameters
    ----------
    checks : tuple of Check
        Checked rules.
    not_checked : tuple of Unchecked
        Rules that could not be checked.
    """

    checks: tuple[Check, ...]
    not_checked: tuple[Unchecked, ...]

    @property
    def ok(self) -> bool:
        """Whether the run keeps everything that was checked."""
        return all(check.ok for check in self.checks)

    @property
    def broken(self) -> tuple[Check, ...]:
        """The rules that the run breaks, the worst first, measured by what is allowed."""
        # by what is allowed, or exact rules with small shares would stand behind coarse ones; 1e-12 is for rules that
        # allow 0
        found = [check for check in self.checks if not check.ok]
        return tuple(sorted(found, key=lambda check: -check.largest / max(check.allowed, 1e-12)))

    @property
    def verdict(self) -> str:
        """The result in one sentence."""
        if self.ok:
            return f"The run keeps all {len(self.checks)} rules that were checked."
        worst, count = self.broken[0], len(self.broken)
        place = "" if worst.at_m is None else f" at {worst.at_m:,.1f} m"
        return (
            f"The run breaks {count} of {len(self.checks)} rules, worst of all '{worst.name}': by {worst.largest:.2g} "
            f"of {worst.share_of}{place}, where {worst.allowed:.2g} is permitted."
        )


def find_largest(
    name: str, share_of: str, allowed: float, deviation: FloatArray | float, position_m: FloatArray | None = None
) -> Check:
    """Return the check of a rule from its deviations.

    Parameters
    ----------
    name, share_of, allowed
        As in `Check`.
    deviation : array of shape (n,) or float
        Shares; below 0 where the rule is kept with room to spare.
    position_m : array of shape (n,), optional
        Their places [m].
    """
    # a NaN counts as the worst deviation: a rule that cannot be computed is not kept
    shares = np.nan_to_num(np.atleast_1d(np.asarray(deviation, dtype=float)), nan=np.inf)
    if not len(shares):
        return Check(name, 0.0, allowed, None, share_of)
    worst = int(np.argmax(shares))
    place = None if position_m is None or shares[worst] <= 0 else float(position_m[worst])
    return Check(name, max(0.0, float(shares[worst])), allowed, place, share_of)
