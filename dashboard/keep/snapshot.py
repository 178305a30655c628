"""The whole state of a page as one flat mapping of plain values, and back.

Fields of the page and of the scenario stand under their own names, those of other models as `model.field`.
"""

import json
from collections.abc import Iterator, Mapping
from copy import deepcopy
from functools import lru_cache
from typing import Any

from railjoule.core import RailjouleError
from railjoule.dashboard.state.kept import Kept
from railjoule.dashboard.state.scenario import FIRST_SCENARIO
from railjoule.dashboard.state.workbench import Workbench

Snapshot = dict[str, Any]
BASE = ("preset", "toml")
"""What names the scenario under all edits."""
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
    """Return what of a snapshot is otherwise before."""
    return {key: value for key, value in snapshot.items() if key not in before or before[key] != value}


def lay(state: Workbench, snapshot: Mapping[str, Any]) -> tuple[str, ...]:
    """Bring a page to the state of a snapshot, and return sentences on what of it cannot be.

    What the snapshot does not name becomes as on a new page with its scenario. The page in sight turns last, so that
    it asks for its results once.
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
