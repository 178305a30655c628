"""Claims of a paper, each with a number of railjoule and a verdict."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

Verdict = Literal["supports", "refutes", "cannot be decided"]
"""The judgement of a claim."""


@dataclass(frozen=True)
class Finding:
    """The result of the examination of a claim.

    Parameters
    ----------
    found : str
        The number or numbers of railjoule, with units.
    verdict : {'supports', 'refutes', 'cannot be decided'}
    reason : str
        One or two sentences: by which measure, or what the paper leaves open.
    """

    found: str
    verdict: Verdict
    reason: str


@dataclass(frozen=True)
class Claim:
    """A sentence of a paper that asserts a number or a comparison, with the finding of railjoule.

    Parameters
    ----------
    place : str
        Section, table, figure or formula of the paper.
    claim : str
        The assertion.
    found, verdict, reason
        As in `Finding`.
    """

    place: str
    claim: str
    found: str
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
    return Claim(entry["place"], entry["text"], finding.found, finding.verdict, finding.reason)


def judge(found: str, is_supported: bool, reason: str) -> Finding:
    """Return the finding of a claim that a number decides."""
    return Finding(found, "supports" if is_supported else "refutes", reason)


def undecided(found: str, reason: str) -> Finding:
    """Return the finding of a claim that cannot be decided from what the paper prints."""
    return Finding(found, "cannot be decided", reason)
