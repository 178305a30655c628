"""Claims of a paper, each with our number and a verdict."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

Verdict = Literal["supports", "refutes", "cannot be decided"]
"""What our number says of a claim."""


@dataclass(frozen=True)
class Finding:
    """The result of the examination of a claim.

    Parameters
    ----------
    ours : str
        Our number or numbers, with units.
    verdict : {'supports', 'refutes', 'cannot be decided'}
    reason : str
        One or two sentences: by which measure, or what the paper leaves open.
    """

    ours: str
    verdict: Verdict
    reason: str


@dataclass(frozen=True)
class Claim:
    """A sentence of a paper that asserts a number or a comparison, beside our finding.

    Parameters
    ----------
    place : str
        Section, table, figure or formula of the paper.
    claim : str
        The assertion.
    ours, verdict, reason
        As in `Finding`.
    """

    place: str
    claim: str
    ours: str
    verdict: Verdict
    reason: str


Examinations = Mapping[str, Callable[[], Finding]]
"""The examination of each claim, by its name in `assets/papers/<paper>.toml`."""


def list_claims(paper: dict[str, Any], examinations: Examinations) -> tuple[Callable[[], Claim], ...]:
    """Return the examinations of a paper's claims in the order of its file, not computed yet.

    Parameters
    ----------
    paper : dict
        The content of `assets/papers/<paper>.toml`; each entry of `claim` has `name`, `place` and `text`.
    examinations : mapping

    Raises
    ------
    KeyError
        If a claim has no examination.
    """
    return tuple(partial(_examine, entry, examinations[entry["name"]]) for entry in paper["claim"])


def _examine(entry: dict[str, Any], examination: Callable[[], Finding]) -> Claim:
    finding = examination()
    return Claim(entry["place"], entry["text"], finding.ours, finding.verdict, finding.reason)


def judge(ours: str, is_supported: bool, reason: str) -> Finding:
    """Return the finding of a claim that our number can decide."""
    return Finding(ours, "supports" if is_supported else "refutes", reason)


def undecided(ours: str, reason: str) -> Finding:
    """Return the finding of a claim that cannot be decided from what the paper prints."""
    return Finding(ours, "cannot be decided", reason)
