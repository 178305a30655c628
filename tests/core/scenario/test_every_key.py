"""A key that a scenario file accepts has an effect, or a sentence refuses it in that place.

Each case of `key_cases` varies all keys of some tables by the computation that they serve. The other values are chosen
so that limits bind; that a key changes an output is all that is asked here, not by how much.
"""

import json
from collections.abc import Iterator, Mapping
from copy import deepcopy
from functools import cache
from typing import Any, get_args

import numpy as np
import pytest
from pydantic import BaseModel

from railjoule.core import RailjouleError, ScenarioError
from railjoule.core.scenario import Scenario, scenario_from_document
from railjoule.core.scenario.document import change_document
from railjoule.core.simulation.field_oriented import simulate_field_oriented
from railjoule.dashboard.command.cli import main
from tests.builders import plain_scenario
from tests.core.scenario.key_cases import CASES, EVENTS, LOOP, Numbers, plan, shortened, timetable
from tests.every_drive import DRIVES

DESCRIPTIONS = {
    ("Scenario", "title"),
    ("Vehicle", "name"),
    ("Line", "name"),
    ("Station", "name"),
    ("PassingPoint", "name"),
    ("Assumed", "key"),
    ("Assumed", "value"),
    ("Assumed", "basis"),
}
"""Keys that describe and are shown, and change no number."""
READ_BEFORE = {("Vehicle", "preset"), ("Line", "preset"), ("SimulationOptions", "kind")}
"""Keys that name a file, which takes their place, or the simulation that is meant: tests of their own below."""
SENSITIVITY = 1e-11
"""The relative change of an output that counts as one; a key without an effect changes no bit."""


def keys_of(table: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield each key of a document with its value, by a path with dots that numbers the tables of a list."""
    for key, value in table.items():
        inner = f"{path}{key}"
        if isinstance(value, dict):
            yield from keys_of(value, f"{inner}.")
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for index, entry in enumerate(value):
                yield from keys_of(entry, f"{inner}.{index}.")
        else:
            yield inner, value


def other_value(value: Any) -> Any:
    """Return a value of the same kind, a little less."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    if isinstance(value, float):
        return 0.93 * value if value else 0.05
    # of rows the last column: of points of a curve or a map it is their value
    return [[*row[:-1], 0.93 * row[-1]] if isinstance(row, list) else 0.93 * row for row in value]


def put(document: Mapping[str, Any], path: str, value: Any) -> dict[str, Any]:
    """Return a copy of a document with another value at a path of `keys_of`."""
    changed = deepcopy(dict(document))
    *parents, key = path.split(".")
    table: Any = changed
    for parent in parents:
        table = table[int(parent)] if isinstance(table, list) else table[parent]
    table[key] = value
    return changed


def without_none(value: Any) -> Any:
    """Return a document without the keys that are not given."""
    if isinstance(value, dict):
        return {key: without_none(inner) for key, inner in value.items() if inner is not None}
    return [without_none(inner) for inner in value] if isinstance(value, list) else value


def differ(before: Numbers, after: Numbers) -> bool:
    """Return whether an output changes by more than rounding."""
    if len(before) != len(after):
        return True
    for old, new in zip(before, after, strict=True):
        if isinstance(old, str) or isinstance(new, str):
            if old != new:
                return True
        elif np.shape(old) != np.shape(new) or not np.allclose(old, new, rtol=SENSITIVITY, atol=1e-12, equal_nan=True):
            return True
    return False


@cache
def without_effect(name: str) -> tuple[tuple[tuple[str, str], ...], tuple[str, ...]]:
    """Return the keys of a case that have an effect, each with its model, and what is to be said of the others."""
    case = CASES[name]
    whole = scenario_from_document(case.document).model_dump(mode="json")
    before = case.compute(scenario_from_document(without_none(whole)))
    effective, wrong = [], []
    for path, value in keys_of(whole):
        if not path.startswith(case.tables) or path.startswith(case.idle):
            continue
        if value in (None, []) and path not in case.others:
            continue
        other = case.others[path] if path in case.others else other_value(value)
        document = whole
        for place, changed in other.items() if isinstance(other, dict) else [(path, other)]:
            document = put(document, place, changed)
        try:
            after = case.compute(scenario_from_document(without_none(document)))
        except RailjouleError as refusal:
            wrong.append(f"{path} = {value} -> {other} is refused, and needs another value here: {refusal}")
            continue
        if differ(before, after):
            effective.append(model_of(Scenario.model_validate(without_none(whole)), path))
        else:
            wrong.append(f"{path} = {value} -> {other} changes nothing")
    return tuple(effective), tuple(wrong)


def model_of(part: Any, path: str) -> tuple[str, str]:
    """Return the name of the table in which a path ends, and its last key."""
    *parents, key = path.split(".")
    for parent in parents:
        part = part[int(parent)] if isinstance(part, tuple) else getattr(part, parent)
    return type(part).__name__, key


@pytest.mark.parametrize("name", CASES)
def test_every_key_has_an_effect(name: str) -> None:
    _, wrong = without_effect(name)
    assert not wrong, "\n".join(wrong)


def fields_of(model: type[BaseModel]) -> Iterator[tuple[str, str]]:
    """Yield each key of a model and of the tables in it, but those that only contain tables."""
    for key, info in model.model_fields.items():
        inner = list(models_in(info.annotation))
        for one in inner:
            yield from fields_of(one)
        if not inner:
            yield model.__name__, key


def models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """Yield the models that an annotation names."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for inner in get_args(annotation):
        yield from models_in(inner)


def test_no_key_is_left_out() -> None:
    effective = {key for name in CASES for key in without_effect(name)[0]}
    assert set(fields_of(Scenario)) - effective == DESCRIPTIONS | READ_BEFORE


def test_files_and_presets_take_effect(tmp_path) -> None:
    (tmp_path / "line.csv").write_text("length_m,gradient_permille\n1000,5\n", encoding="utf-8")
    points = "\n".join(",".join(map(str, point)) for point in DRIVES["efficiency map"]["points"])
    (tmp_path / "map.csv").write_text(f"torque_nm,speed_rads,efficiency\n{points}\n", encoding="utf-8")
    document = shortened({})
    drive = {**{key: value for key, value in DRIVES["efficiency map"].items() if key != "points"}, "file": "map.csv"}
    before = plan(scenario_from_document(document))
    for change in (
        {"vehicle": {"preset": "tram-105n"}},
        {"line": {"preset": "liashenko-ii"}},
        {"line": {"file": "line.csv"}},
        {"vehicle": {**document["vehicle"], "drive": drive}},
    ):
        changed = {**document, "timetable": {"travel_time_s": 200.0}, **change}
        assert differ(before, plan(scenario_from_document(changed, folder=tmp_path)))


def test_the_kind_of_simulation_decides_what_the_command_shows(capsys: pytest.CaptureFixture[str]) -> None:
    shown = []
    for kind in ("following", "field_oriented"):
        main(["simulate", "ftorek-300s", "--set", f"simulation.kind={kind}", "solver.mesh_m=100", "--json"])
        shown.append(set(json.loads(capsys.readouterr().out)))
    assert "max_current_a" in shown[1] - shown[0]


NOT_HERE = {
    "the literal regulator's keys": (
        {"search.dead_zone_kmh": 2.0},
        "search.dead_zone_kmh = 2 has no effect with regulator = 'coast', only with 'literal'.",
    ),
    "its step of time": (
        {"search": {"regulator": "brake", "time_step_s": 0.1}},
        "search.time_step_s = 0.1 has no effect with regulator = 'brake', only with 'literal'.",
    ),
    "borders free without a search": (
        {"search": {"limits_kmh": [50.0], "free_boundaries": True}},
        "search.free_boundaries = true has no effect beside limits_kmh: with given limits there is no search.",
    ),
    "a target curve that is not followed": (
        {"simulation": {"target_braking": False, "target_deceleration_ms2": 0.5}},
        "simulation.target_deceleration_ms2 = 0.5 has no effect with target_braking = false.",
    ),
    "sensors that nothing reads": (
        {"simulation": {"target_braking": False, "sensor_errors_m": [1.0, 0.0, 0.0]}},
        "simulation.sensor_errors_m = (1.0, 0.0, 0.0) has no effect with target_braking = false.",
    ),
    "a step too long for noise": (
        {"simulation": {"speed_noise_rads": 0.1, "time_step_s": 0.002}},
        "simulation.time_step_s = 0.002 must be at most 0.0005 with speed_noise_rads above 0.",
    ),
    "a point of a train without a length": (
        {"vehicle.gradient_at": "middle"},
        "vehicle.gradient_at = 'middle' needs length_m: without it the train is a point.",
    ),
    "a load without a mass": (
        {"vehicle.load_factor": 0.5, "vehicle.capacity_passengers": 0},
        "vehicle.load_factor = 0.5 has no effect: it needs capacity_passengers and passenger_mass_kg above 0, or "
        "max_load_t; load_t is a load in tonnes.",
    ),
}


@pytest.mark.parametrize(("changes", "words"), NOT_HERE.values(), ids=list(NOT_HERE))
def test_a_key_without_an_effect_is_refused(changes: Mapping[str, Any], words: str) -> None:
    with pytest.raises(ScenarioError) as error:
        plain_scenario(changes)
    assert str(error.value) == f"scenario: {words}"


AT_THE_ENDS = [
    {"position_m": place, key: value}
    for place in (0.0, 900.0)
    for key, value in (("dwell_s", 30.0), ("earliest_arrival_s", 95.0), ("latest_arrival_s", 80.0), ("arrival_s", 85.0))
]


def test_keys_of_a_station_at_an_end_have_an_effect_or_are_refused() -> None:
    before, wrong = plan(scenario_from_document(shortened({}))), []
    for station in AT_THE_ENDS:
        _, key = station
        # a timetable that is given is all that reads an arrival
        compute = timetable if key == "arrival_s" else plan
        try:
            after = compute(scenario_from_document(shortened({"line.stations": [station]})))
        except RailjouleError as refusal:
            wrong += [] if key in str(refusal) else [f"{station}: {refusal}"]
            continue
        wrong += [] if differ(before, after) else [f"{station} changes nothing"]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize(
    "changes",
    [
        {"disturbance.stops": EVENTS["stops"]},
        {"disturbance.coordinate_error_m": 5.0},
        {"disturbance.departure_delay_s": 5.0},
        {"simulation.speed_error": 0.02},
        {"simulation.sensor_errors_m": [1.0, 0.0, 0.0]},
        {"timetable.entry_speed_kmh": 5.0},
    ],
)
def test_the_closed_loop_refuses_what_it_does_not_simulate(changes: Mapping[str, Any]) -> None:
    with pytest.raises(ScenarioError, match="field_oriented does not simulate"):
        simulate_field_oriented(scenario_from_document(change_document(LOOP, changes)))
