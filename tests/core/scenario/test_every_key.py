"""A key that a scenario file accepts has an effect, or a sentence refuses it in that place.

Each case varies all keys of some tables by the computation that they serve. The other values are chosen so that limits
bind; that a key changes an output is all that is asked here, not by how much.
"""

from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, field
from functools import cache
from typing import Any, get_args

import numpy as np
import pytest
from pydantic import BaseModel

from railjoule.core import RailjouleError, ScenarioError, load_scenario, solve
from railjoule.core.line_current import line_current_a
from railjoule.core.scenario import Scenario, scenario_from_document
from railjoule.core.scenario.document import change_document
from railjoule.core.simulate.actual_run import actual_run
from railjoule.core.simulate.field_oriented import simulate_field_oriented
from railjoule.core.simulate.following import simulate_following
from railjoule.core.studies.montecarlo import monte_carlo
from railjoule.core.studies.whole_line import whole_line
from railjoule.core.trajectory import Trajectory
from tests.builders import INDUCTION, PLAIN, plain_scenario
from tests.every_drive import DRIVES

DESCRIPTIONS = {
    ("Scenario", "title"),
    ("Vehicle", "name"),
    ("Line", "name"),
    ("Station", "name"),
    ("PassingPoint", "name"),
}
"""Keys that describe and are shown, and change no number."""
READ_FROM_FILES = {("Vehicle", "preset"), ("Line", "preset")}
"""Keys that name another file, which takes their place: tests of their own below."""
SENSITIVITY = 1e-11
"""The relative change of an output that counts as one; a key without an effect changes no bit."""

Output = list[Any]


def of_run(run: Trajectory) -> Output:
    """Return what a run documents: its course over place and time, its energies, the supply current, its notes."""
    current = line_current_a(run.line_power_w, run.scenario.vehicle.line_voltage_v)
    supply = [] if current is None else [current]
    return [run.position_m, run.speed_ms, run.time_s, run.energy.net_j, run.energy.traction_j, *supply, *run.notes]


def plan(scenario: Scenario) -> Output:
    """Return the run of the scenario's own strategy."""
    return of_run(solve(scenario))


def followed(scenario: Scenario) -> Output:
    """Return a plan and the run that follows it."""
    run = simulate_following(scenario)
    return [*of_run(run.planned), *of_run(run.actual), run.delay_s, *run.stop_errors_m]


def disturbed(scenario: Scenario) -> Output:
    """Return the run with its events."""
    run = actual_run(scenario)
    return [*of_run(run.actual), run.delay_s, *run.notes]


def in_closed_loop(scenario: Scenario) -> Output:
    """Return the run of the machines."""
    run = simulate_field_oriented(scenario)
    return [run.time_s, run.speed_ms, run.phase_voltage_v, run.energy_by_parts_j, *of_run(run.actual), *run.notes]


def by_chance(scenario: Scenario) -> Output:
    """Return the draws of a Monte Carlo study and their runs."""
    table = monte_carlo(scenario)
    return [*table.drawn.values(), table.energy_kwh, table.delay_s, table.stop_error_m]


def timetable(scenario: Scenario) -> Output:
    """Return the run of the timetable that is given."""
    return of_run(whole_line(scenario, "given").run)


@dataclass(frozen=True)
class Case:
    """Tables of a document, each key of which must change what is computed.

    Parameters
    ----------
    compute : callable
        From a scenario to its output.
    document : mapping
        The scenario file.
    tables : tuple of str
        Beginnings of the paths of all keys that are varied.
    others : mapping
        The other value of a key by its path, or all that changes with it; without it a number shrinks by 7 %.
    idle : tuple of str
        Keys among them that another case varies.
    """

    compute: Callable[[Scenario], Output]
    document: Mapping[str, Any]
    tables: tuple[str, ...]
    others: Mapping[str, Any] = field(default_factory=dict)
    idle: tuple[str, ...] = ()


def shortened(changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return a document of a light train on 900 m of coarse mesh."""
    short = {
        "line.sections": [
            {"length_m": 400.0, "gradient_permille": 5.0},
            {"length_m": 500.0, "gradient_permille": -15.0},
        ],
        "timetable.travel_time_s": 90.0,
        "solver.mesh_m": 25.0,
        "vehicle.tare_kg": 40e3,
        "vehicle.traction.max_speed_kmh": 60.0,
    }
    return change_document(PLAIN, {**short, **changes})


TRAIN = change_document(
    PLAIN,
    {
        "vehicle.load_factor": 0.5,
        "vehicle.auxiliary_power_kw": 20.0,
        "vehicle.line_voltage_v": 750.0,
        "vehicle.length_m": 60.0,
        "vehicle.car_count": 3,
        "vehicle.resistance": {
            "constant_n_per_kn": 1.5,
            "linear_n_per_kn_per_kmh": 0.01,
            "quadratic_n_per_kn_per_kmh2": 4e-4,
            "constant_n": 300.0,
            "linear_n_per_kmh": 5.0,
            "quadratic_n_per_kmh2": 0.1,
            "curve_constant_m_n_per_kn": 600.0,
            "car_kinds": [
                {
                    "cars": cars,
                    "constant_n_per_kn": 0.5,
                    "linear_n_per_kn_per_kmh": 0.01 * cars,
                    "quadratic_n_per_kn_per_kmh2": 1e-4,
                }
                for cars in (2, 1)
            ],
        },
        "vehicle.traction": {
            "max_effort_kn": 100.0,
            "max_power_kw": 700.0,
            "max_speed_kmh": 46.0,
            "max_acceleration_ms2": 0.55,
            "breakdown_speed_kmh": 42.0,
        },
        "vehicle.braking": {
            "max_effort_kn": 70.0,
            "max_power_kw": 400.0,
            "friction_effort_kn": 30.0,
            "max_deceleration_ms2": 0.6,
            "breakdown_speed_kmh": 40.0,
            "permitted_deceleration": [[0, 0.75], [35, 0.55]],
        },
        "line.sections": [
            {"length_m": 500.0, "gradient_permille": 3.0},
            {
                "length_m": 600.0,
                "gradient_permille": 12.0,
                "curve_radius_m": 400.0,
                "speed_limit_kmh": 35.0,
                "tunnel_factor": 1.5,
            },
            {"length_m": 900.0, "gradient_permille": -9.0},
        ],
        "line.speed_limits": [{"from_m": 1500.0, "to_m": 1600.0, "limit_kmh": 32.0}],
        "line.neutral_sections": [{"from_m": 300.0, "to_m": 360.0}],
        "line.passing_points": [{"name": "P", "position_m": 1300.0, "speed_kmh": 40.0}],
        "line.limits_hold_for": "whole_train",
        "line.head_wind_kmh": 5.0,
        "timetable": {"travel_time_s": 270.0, "entry_speed_kmh": 4.0, "exit_speed_kmh": 5.0},
        "solver.mesh_m": 25.0,
    },
)
"""A train of two kinds of cars on a line with all that a line can have; `fastest` meets its limits."""

EVENTS: dict[str, Any] = {
    "stops": [{"position_m": 500.0, "duration_s": 10.0, "noticed_at_m": 250.0}],
    "speed_limits": [{"from_m": 650.0, "to_m": 750.0, "limit_kmh": 30.0, "noticed_at_m": 550.0}],
    "voltage_changes": [{"line_voltage_factor": 0.4, "noticed_at_m": 150.0}],
    "recuperation_changes": [{"recuperation_factor": 0.0, "noticed_at_m": 400.0}],
}


def cases_of_events() -> Iterator[tuple[str, Case]]:
    """Yield one case for each kind of event and each way to notice it: several at once would hide one another."""
    for kind, (event,) in EVENTS.items():
        by_time = {key: value for key, value in event.items() if key != "noticed_at_m"} | {"noticed_at_s": 22.0}
        for name, one in (("place", event), ("time", by_time)):
            document = shortened({"disturbance": {kind: [one], "accepted_delay_s": 8.0}})
            reaction = {f"disturbance.{kind}.0.reaction": "driver"}
            yield f"{kind} noticed by {name}", Case(disturbed, document, (f"disturbance.{kind}",), reaction)


def cases_of_drives() -> Iterator[tuple[str, Case]]:
    """Yield one case for each kind of drive."""
    leakage = {
        f"vehicle.drive.{side}_inductance_mh": INDUCTION["mutual_inductance_mh"] + 0.5 for side in ("stator", "rotor")
    }
    efficiency = {"model": "constant_efficiency", "traction_efficiency": 0.8}
    for name, drive in DRIVES.items():
        others = {
            "vehicle.drive.model": {"vehicle.drive": efficiency if drive["model"] != efficiency["model"] else INDUCTION},
            "vehicle.drive.modulation": "space_vector",
            **leakage,
        }
        document = shortened({"vehicle.drive": {**drive, "recuperation_factor": 0.5}})
        yield f"drive, {name}", Case(plan, document, ("vehicle.drive",), others)


def kind_of_chance(**drawn: Mapping[str, Any]) -> dict[str, Any]:
    """Return a document of a study with few runs that draws as it is told."""
    return shortened({"montecarlo": {"runs": 3, "seed": 1, **drawn}})


NORMAL = {"distribution": "normal", "mean": 0.4, "standard_deviation": 0.1}
FIXED = {"distribution": "fixed", "value": 0.9}
QUANTITIES = ("load_factor", "coordinate_error_m", "resistance_factor", "line_voltage_factor", "departure_delay_s")
FTOREK = load_scenario("ftorek-300s").model_dump(mode="json", exclude_none=True)
LOOP = change_document(
    FTOREK,
    {
        "line": {"sections": [{"length_m": 800.0}]},
        "timetable.travel_time_s": 66.0,
        "solver.mesh_m": 50.0,
        "simulation": {"speed_noise_rads": 0.1, "time_step_s": 0.0005},
        "disturbance": {"actual_load_factor": 0.5, "resistance_factor": 1.1, "line_voltage_factor": 0.9},
    },
)
LOOP["vehicle"]["drive"]["machine"] |= {"max_current_a": 500.0, "max_phase_voltage_v": 900.0, "eddy_loss_w": 900.0}
OF_THE_LOOP = (
    "kind",
    "precompensator",
    "bandwidth_rads",
    "rotor_resistance_factor",
    "flux",
    "speed_noise_rads",
    "noise_seed",
    "time_step_s",
    "reference_window_s",
)
PHASES = {"strategy": "phases", "vehicle.drive": INDUCTION, "timetable.travel_time_s": 260.0, "solver.mesh_m": 100.0,
    "vehicle.resistance.constant_n_per_kn": 5.0, "line.sections": [{"length_m": 3000.0}], "phases.cycles": 3}
STATION = {"name": "M", "position_m": 1200.0, "dwell_s": 20.0}

CASES: dict[str, Case] = {
    "fastest": Case(
        plan,
        change_document(TRAIN, {"strategy": "fastest"}),
        ("vehicle", "line", "timetable.e", "solver", "strategy"),
        {
            "strategy": "optimal",
            "vehicle.crush_load_factor": {"vehicle.crush_load_factor": 1.2, "vehicle.load_factor": 1.1},
            "vehicle.car_count": {"vehicle.car_count": 4, "vehicle.resistance.car_kinds.0.cars": 3},
            "vehicle.resistance.car_kinds.0.cars": {
                "vehicle.resistance.car_kinds.0.cars": 1,
                "vehicle.resistance.car_kinds.1.cars": 2,
            },
            "vehicle.resistance.car_kinds.1.cars": {
                "vehicle.resistance.car_kinds.0.cars": 1,
                "vehicle.resistance.car_kinds.1.cars": 2,
            },
            "vehicle.rotating_mass_factor": 0.2,
            "vehicle.inertial_mass_kg": {"vehicle.rotating_mass_factor": None, "vehicle.inertial_mass_kg": 120e3},
            "vehicle.gradient_at": "front",
            "vehicle.traction.curve": [[0, 110], [20, 90], [46, 30]],
            "vehicle.braking.curve": [[0, 50], [20, 40], [46, 20]],
            "vehicle.drive.braking_efficiency": 0.7,
            "line.sections.0.speed_limit_kmh": 35.0,
            "line.sections.2.speed_limit_kmh": 43.0,
            "line.speed_limits.0.to_m": 1650.0,
            "line.sections.0.curve_radius_m": 500.0,
            "line.sections.2.curve_radius_m": 500.0,
            "line.limits_hold_for": "front",
        },
        idle=("vehicle.drive", "vehicle.name", "line.name", "line.passing_points.0.name"),
    ),
    "stations": Case(
        plan,
        change_document(PLAIN, {"line.stations": [STATION], "timetable.travel_time_s": 210.0}),
        ("line.stations", "timetable.travel_time_s", "timetable.average_speed_kmh"),
        {
            "line.stations.0.earliest_arrival_s": 115.0,
            "line.stations.0.latest_arrival_s": 90.0,
            "timetable.average_speed_kmh": {"timetable.travel_time_s": None, "timetable.average_speed_kmh": 33.0},
        },
        idle=("line.stations.0.name",),
    ),
    "given timetable": Case(
        timetable,
        change_document(
            PLAIN, {"line.stations": [{**STATION, "arrival_s": 100.0}], "timetable.travel_time_s": 210.0}
        ),
        ("line.stations.0.arrival_s",),
    ),
    **dict(cases_of_drives()),
    "eoc": Case(plan, {**FTOREK, "strategy": "eoc"}, ("eoc",), {"eoc.variant": "as_printed"}),
    "enoc": Case(plan, {**FTOREK, "strategy": "enoc", "enoc": {"acceleration_time_s": 60.0}}, ("enoc",)),
    "phases": Case(
        plan,
        shortened(PHASES),
        ("phases",),
        {"phases.starting_current_a": 150.0, "phases.free_starting_current": True},
        idle=("phases.cycles",),
    ),
    "phases in cycles": Case(
        plan,
        shortened({"phases.cruise": False, **PHASES}),
        ("phases.cycles",),
    ),
    "set speeds": Case(
        plan,
        shortened({"strategy": "speed_limits", "search.boundaries_m": [450.0]}),
        ("search",),
        {"search.regulator": "brake", "search.limits_kmh": [45.0, 50.0], "search.free_boundaries": True},
        idle=tuple(
            f"search.{key}"
            for key in ("dead_zone_kmh", "regulation_speed_kmh", "full_effort_time_s", "effort_rate_share", "time_step_s")
        ),
    ),
    "set speeds of the literal regulator": Case(
        plan,
        shortened(
            {
                "strategy": "speed_limits",
                "search": {"boundaries_m": [450.0], "regulator": "literal", "limits_kmh": [45.0, 40.0]},
            }
        ),
        ("search",),
        {"search.regulator": "brake"},
        idle=("search.free_boundaries", "search.time_window"),
    ),
    "followed": Case(
        followed,
        shortened(
            {
                "vehicle.load_factor": 0.3,
                "disturbance": {
                    "coordinate_error_m": 8.0,
                    "actual_load_factor": 0.6,
                    "resistance_factor": 1.1,
                    "line_voltage_factor": 0.9,
                    "departure_delay_s": 4.0,
                },
                "simulation": {
                    "speed_error": 0.02,
                    "sensor_errors_m": [2.0, 1.0, 0.5],
                    "reset_sensor_m": 200.0,
                    "calibration_length_m": 90.0,
                },
            }
        ),
        ("disturbance", "simulation"),
        {"simulation.target_braking": {"simulation": {"target_braking": False, "speed_error": 0.02}}},
        idle=("disturbance.accepted_delay_s", *(f"simulation.{key}" for key in OF_THE_LOOP)),
    ),
    "accepted delay": Case(
        disturbed,
        shortened({"disturbance": {"stops": EVENTS["stops"], "accepted_delay_s": 8.0}}),
        ("disturbance.accepted_delay_s",),
    ),
    **dict(cases_of_events()),
    "closed loop": Case(
        in_closed_loop,
        LOOP,
        ("simulation", "vehicle.drive", "disturbance"),
        {
            "simulation.flux": "least_loss",
        },
        idle=(
            "vehicle.drive.model",
            "disturbance.coordinate_error_m",
            "disturbance.departure_delay_s",
            "disturbance.accepted_delay_s",
            "simulation.kind",
            "simulation.response_length_m",
            "simulation.speed_error",
            "simulation.target_braking",
            "simulation.target_deceleration_ms2",
            "simulation.reset_sensor_m",
            "simulation.calibration_length_m",
            "simulation.stop_sensor_m",
            "simulation.sensor_errors_m",
        ),
    ),
    "chance": Case(
        by_chance,
        kind_of_chance(
            load_factor=NORMAL,
            coordinate_error_m={"distribution": "uniform", "low": -3.0, "high": 4.0},
            resistance_factor={"distribution": "log_normal", "median": 1.0, "log_standard_deviation": 0.1},
            line_voltage_factor={"distribution": "triangular", "low": 0.8, "mode": 0.9, "high": 1.0},
            departure_delay_s={"distribution": "exponential", "mean": 5.0},
        ),
        ("montecarlo",),
        {f"montecarlo.{name}.distribution": {f"montecarlo.{name}": FIXED} for name in QUANTITIES},
    ),
    "no chance": Case(
        by_chance,
        kind_of_chance(resistance_factor=FIXED),
        ("montecarlo.resistance_factor",),
        {"montecarlo.resistance_factor.distribution": {"montecarlo.resistance_factor": NORMAL}},
    ),
}


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


def differ(before: Output, after: Output) -> bool:
    """Return whether an output changes by more than rounding."""
    if len(before) != len(after):
        return True
    for old, new in zip(before, after, strict=True):
        if isinstance(old, str) or isinstance(new, str):
            if old != new:
                return True
        elif np.shape(old) != np.shape(new) or not np.allclose(
            old, new, rtol=SENSITIVITY, atol=1e-12, equal_nan=True
        ):
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
        if value is None or value == []:
            if path not in case.others:
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
    assert set(fields_of(Scenario)) - effective == DESCRIPTIONS | READ_FROM_FILES


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
        "vehicle.load_factor = 0.5 has no effect: it needs capacity_passengers and passenger_mass_kg above 0.",
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


@pytest.mark.xfail(strict=True, reason="branch windows: windows and dwells at the ends of the line")
def test_keys_of_a_station_at_an_end_have_an_effect_or_are_refused() -> None:
    before, idle = plan(scenario_from_document(shortened({}))), []
    for station in AT_THE_ENDS:
        try:
            after = plan(scenario_from_document(shortened({"line.stations": [station]})))
        except RailjouleError as refusal:
            assert any(key in str(refusal) for key in station if key != "position_m"), refusal
            continue
        if not differ(before, after):
            idle.append(station)
    assert not idle


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
