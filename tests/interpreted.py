"""Kernels as Python, for tests that ask one for a few numbers: compiled for Python it takes up to 20 s.

Solvers have compiled forms of their own, which they are tested with; tests/core/test_interpreted.py holds both to each
other.
"""

from collections.abc import Iterator
from contextlib import contextmanager

from railjoule.core import compiled


@contextmanager
def interpreted() -> Iterator[None]:
    """Interpret all kernels that are called within."""
    compiled._THREAD.is_interpreting = True
    try:
        yield
    finally:
        compiled._THREAD.is_interpreting = False
