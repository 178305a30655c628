"""The comparison with each paper, computed once in a process: several tests and commands ask for the same."""

from functools import cache

import pytest

from railjoule.core.validation import PAPERS, Validation

COMPUTE = dict(PAPERS)


@cache
def validated(paper: str) -> Validation:
    """Return the comparison with a paper by its name in `railjoule validate`."""
    return COMPUTE[paper]()


def validate_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let `railjoule validate` take what another test has computed already."""
    for name in COMPUTE:
        monkeypatch.setitem(PAPERS, name, lambda name=name: validated(name))
