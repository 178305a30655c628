"""The whole state of a page as one flat mapping of plain values, and back; undo and redo over such snapshots.

Fields of the page and of the scenario stand under their own names, those of other models as `model.field`.
"""

import json
import time
from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.limits import MAX_STEPS
from railjoule.dashboard.state.kept import Kept
from railjoule.dashboard.state.scenario import FIRST_SCENARIO
from railjoule.dashboard.workbench import Workbench

Snapshot = dict[str, Any]
BASE = ("preset", "toml")
"""Name of the scenario below all edits."""
VIEW = ("page", "tab", "colours", "class_token", "class_student", "class_name", "class_key")
"""The fields of the view, of whichever model: their changes are no steps of undo and redo."""


MOST_ORIGINALS = 64
"""So many scenarios and their edits are remembered, for all pages: a whole page is made for each."""


def fields_of(state: Workbench) -> Iterator[tuple[str, Kept, str]]:
    """Yield the key of every kept field, the model that it belongs to, and its name there."""
    for model in (state, *state.models.values()):
        for field in model.kept:
            yield f"{model.address_prefix}{field}", model, field


def snapshot_of(state: Workbench) -> Snapshot:
    """Return all that is kept of a page."""
    snapshot = state.keep()
    for model in state.models.values():
        snapshot |= {f"{model.address_prefix}{field}": value for field, value in model.keep().items()}
    return snapshot


def originals_of(snapshot: Mapping[str, Any]) -> Snapshot:
    """Return the snapshot of a new page with the scenario and the edits of another.

    Raises
    ------
    RailjouleError
        If there is no such scenario.
    """
    edits = json.dumps(snapshot.get("edits", {}))
    # a copy, as models keep the lists that are laid on them
    return deepcopy(_originals(snapshot["preset"], snapshot.get("toml") or "", edits))


@lru_cache(maxsize=MOST_ORIGINALS)
def _originals(preset: str, toml: str, edits: str) -> Snapshot:
    fresh = Workbench()
    scenario = fresh.scenario
    if toml:
        scenario.open(toml, "the scenario")
    elif preset != scenario.preset:
        scenario.choose(preset)
    for model in fresh.models.values():
        # on a page its works tell the models of another scenario; this one has no works
        if hasattr(model, "take"):
            model.take(scenario.base)
    scenario.lay({"edits": json.loads(edits)})
    return snapshot_of(fresh)


def changed(snapshot: Mapping[str, Any], before: Mapping[str, Any]) -> Snapshot:
    """Return the part of a snapshot that differs from the one before."""
    return {key: value for key, value in snapshot.items() if key not in before or before[key] != value}


def lay(state: Workbench, snapshot: Mapping[str, Any]) -> tuple[str, ...]:
    """Bring a page to the state of a snapshot, and return sentences on what of it cannot be.

    Values that the snapshot does not name are those of a new page with its scenario. The page in sight turns last,
    so that it asks for its results once.
    """
    refusals: list[str] = []
    wanted = dict(snapshot)
    try:
        _lay_base(state, wanted)
    except RailjouleError as refusal:
        refusals.append(_bare(refusal))
        # all else in the snapshot belongs to the scenario that cannot be had
        wanted = {key: wanted[key] for key in state.kept if key in wanted}
    base = {"preset": state.scenario.preset, "toml": state.scenario.toml}
    try:
        originals = originals_of({**base, "edits": wanted.get("edits", {})})
    except RailjouleError as refusal:
        refusals.append(f"edits: {_bare(refusal)}")
        wanted.pop("edits", None)
        originals = originals_of(base)
    # the base last: it is the one that is there, whatever the snapshot asks for
    values = {**originals, **wanted, **base}
    for model in (*state.models.values(), state):
        prefix = model.address_prefix or ""
        kept = {field: values[prefix + field] for field in model.kept if prefix + field in values}
        last = {"page": kept.pop("page")} if model is state and "page" in kept else {}
        refusals += _lay_model(model, kept, prefix)
        if last:
            refusals += _lay_model(model, last, prefix)
    return tuple(refusals)


def _lay_base(state: Workbench, snapshot: Mapping[str, Any]) -> None:
    """Choose or open the scenario that a snapshot names, where it is another one."""
    scenario, toml = state.scenario, snapshot.get("toml")
    if toml:
        if toml != scenario.toml:
            scenario.open(toml, "the scenario of the link")
    elif scenario.opened is not None or snapshot.get("preset", FIRST_SCENARIO) != scenario.preset:
        scenario.choose(snapshot.get("preset", FIRST_SCENARIO))


def _lay_model(model: Kept, values: Mapping[str, Any], prefix: str) -> list[str]:
    """Lay values that the model takes as it stands, and return sentences on the others."""
    refusals, taken = [], {}
    for field, value in values.items():
        try:
            taken[field] = model.checked(field, value)
        except ValueError as refusal:
            refusals.append(f"{prefix}{field} {refusal}")
    try:
        model.lay(taken)
    except (RailjouleError, ValueError) as refusal:
        refusals.append(f"{prefix.rstrip('.') or 'the scenario'}: {_bare(refusal)}")
    return refusals


def _bare(refusal: Exception) -> str:
    return str(refusal).rstrip(".")


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
        Its base.
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
        # what follows an undo is a step of its own: joined to the one before, it could not be taken back separately
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
