from collections.abc import Mapping
from typing import Any

import pytest

from railjoule.core import ScenarioError, load_scenario
from railjoule.dashboard.state.draft import Edited, ScenarioDraft, shipped


def draft_of(edits: Mapping[str, Any], **sliders: float | None) -> ScenarioDraft:
    base = load_scenario("liashenko-i")
    own = {
        "travel_time_s": round(base.travel_time_s, 1),
        "load_percent": 100 * base.vehicle.load_factor,
        "load_t": base.vehicle.load_t,
        "recuperation_percent": 100 * base.vehicle.drive.recuperation_factor,
        "acceleration_time_s": base.enoc.acceleration_time_s,
    }
    return ScenarioDraft(Edited(base, edits), {**own, **sliders})


def test_what_follows_is_derived_once():
    draft = draft_of({"vehicle.auxiliary_power_kw": 30.0}, load_percent=40.0)
    assert draft.scenario is draft.scenario
    assert draft.changes is draft.changes
    assert draft.scenario == draft.base.replace(**{"vehicle.auxiliary_power_kw": 30.0, "vehicle.load_factor": 0.4})


def test_the_changes_cannot_be_changed_from_outside():
    with pytest.raises(TypeError):
        draft_of({}).changes["vehicle.load_factor"] = 1.0  # type: ignore[index]


def test_impossible_values_are_refused_each_time():
    draft = draft_of({}, load_percent=1e6)
    for _ in range(2):
        with pytest.raises(ScenarioError, match="load_factor"):
            _ = draft.scenario


def test_a_whole_table_replaces_what_was_changed_in_it():
    draft = draft_of({"vehicle.auxiliary_power_kw": 30.0, "solver.mesh_m": 5.0})
    assert draft.with_changes({"vehicle": {}}) == {"solver.mesh_m": 5.0, "vehicle": {}}
    assert draft.without("solver.mesh_m") == {"vehicle.auxiliary_power_kw": 30.0}


@pytest.mark.parametrize(
    ("key", "value"),
    # the file liashenko-i: 1000 m at 35 km/h on average, half full
    [
        ("timetable.travel_time_s", pytest.approx(1000 / (35 / 3.6))),
        ("vehicle.load_factor", 0.5),
        ("nothing.there", None),
    ],
)
def test_what_the_base_has_at_a_key(key: str, value: object):
    assert draft_of({}, load_percent=40.0).original(key) == value


def test_shipped_scenarios_are_read_once():
    assert shipped("liashenko-i") is shipped("liashenko-i")
    assert shipped("liashenko-i") == load_scenario("liashenko-i")
