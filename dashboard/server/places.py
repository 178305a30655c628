"""How many pages may be open, and how many are, in all processes of a server."""

from collections.abc import Callable, MutableSequence

NUMBERS = 2
"""What each process tells the others: pages that are open, and pages whose connection it awaits."""


class Places:
    """The places of a server.

    Parameters
    ----------
    most : int or None
        How many pages may be open at a time; None for any number.
    count : callable
        Returns how many pages this process has open, and how many more it has answered of late than opened: a page may
        be answered in one process and opened in another, so that the second may be negative.
    shared : mutable sequence of int, optional
        What all processes tell, NUMBERS each.
    own : int
        Which of them this one is.
    """

    def __init__(
        self,
        most: int | None,
        count: Callable[[], tuple[int, int]],
        shared: MutableSequence[int] | None = None,
        own: int = 0,
    ) -> None:
        self._most, self._count, self._own = most, count, NUMBERS * own
        self._shared = [0] * NUMBERS if shared is None else shared

    def tell(self) -> None:
        """Tell all processes how many pages this one has."""
        self._shared[self._own], self._shared[self._own + 1] = self._count()

    @property
    def taken(self) -> int:
        """How many places are taken by pages that are open or about to open."""
        is_open, awaited = self._told()
        return is_open + awaited

    @property
    def has_one(self) -> bool:
        """Whether a page may open whose connection has come: there is a place, or one was kept for it."""
        is_open, awaited = self._told()
        return self._most is None or awaited > 0 or is_open < self._most

    def _told(self) -> tuple[int, int]:
        self.tell()
        return sum(self._shared[::NUMBERS]), max(sum(self._shared[1::NUMBERS]), 0)
