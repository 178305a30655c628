"""Undo and redo over snapshots: the moves of one field within a moment are one step."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from railjoule.dashboard.keep.snapshot import VIEW, Snapshot, changed
from railjoule.dashboard.limits import MAX_STEPS

# longer than the time after which a change is noted (NOTE_MS): one drag is noted several times
ONE_MOVE_S = 1.5
"""Changes of the same fields that follow each other within this time are one step."""


@dataclass(frozen=True)
class Step:
    """One change: the snapshots on both sides of it, without what only the view is, and when it ended [s]."""

    before: Snapshot
    after: Snapshot
    place: Snapshot
    ended_s: float

    @property
    def keys(self) -> frozenset[str]:
        """The fields that it changes."""
        return frozenset(changed(self.after, self.before))


class History:
    """The steps behind and ahead of a snapshot.

    Parameters
    ----------
    snapshot : mapping
        Where it begins.
    clock : callable
        Returns a time that only grows [s].
    """

    def __init__(self, snapshot: Mapping[str, Any], clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._now = _without_view(snapshot)
        self._past: list[Step] = []
        self._future: list[Step] = []

    @property
    def can_undo(self) -> bool:
        """Whether there is a step behind."""
        return bool(self._past)

    @property
    def can_redo(self) -> bool:
        """Whether there is a step ahead."""
        return bool(self._future)

    def note(self, snapshot: Mapping[str, Any]) -> None:
        """Take note of a snapshot; one that differs from the last is a step, or the rest of one."""
        now = _without_view(snapshot)
        if now == self._now:
            return
        step = Step(self._now, now, _place(snapshot), self._clock())
        self._now = now
        # what follows an undo is a step of its own: joined to the one before, it could not be taken back alone
        last = self._past[-1] if self._past and not self._future else None
        if last is not None and last.keys == step.keys and step.ended_s - last.ended_s < ONE_MOVE_S:
            step = replace(step, before=last.before)
            self._past.pop()
        self._future.clear()
        # a slider that is dragged back to where it was leaves no step
        if step.before != step.after:
            self._past = [*self._past, step][-MAX_STEPS:]

    def undo(self) -> Snapshot | None:
        """Go back a step; return its snapshot with the page and tab on which it was made, None where there is none."""
        return self._go(self._past, self._future, "before")

    def redo(self) -> Snapshot | None:
        """Go forward a step, as `undo` goes back."""
        return self._go(self._future, self._past, "after")

    @staticmethod
    def _go(source: list[Step], target: list[Step], side: str) -> Snapshot | None:
        if not source:
            return None
        target.append(source.pop())
        return {**getattr(target[-1], side), **target[-1].place}

    def settle(self, snapshot: Mapping[str, Any]) -> None:
        """Take a snapshot for where the history stands now, without a step."""
        self._now = _without_view(snapshot)


def _without_view(snapshot: Mapping[str, Any]) -> Snapshot:
    return {key: value for key, value in snapshot.items() if not _is_view(key)}


def _place(snapshot: Mapping[str, Any]) -> Snapshot:
    """Return the page and the open tabs of a snapshot."""
    return {key: value for key, value in snapshot.items() if _is_view(key) and key != "colours"}


def _is_view(key: str) -> bool:
    return key.rpartition(".")[2] in VIEW
