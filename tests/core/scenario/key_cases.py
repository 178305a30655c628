"""The cases of `test_every_key`: which keys are varied by which computation, and the outputs that these document."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from railjoule.core import load_scenario, solve
from railjoule.core.energy import supply_current_a
from railjoule.core.scenario import Scenario
from railjoule.core.scenario.document import change_document
from railjoule.core.simulation.actual_run import actual_run
from railjoule.core.simulation.field_oriented import simulate_field_oriented
from railjoule.core.simulation.following import simulate_following
from railjoule.core.studies.montecarlo import monte_carlo
from railjoule.core.studies.whole_line import whole_line
from railjoule.core.trajectory import Trajectory
from tests.builders import INDUCTION, PLAIN
from tests.every_drive import DRIVES

Numbers = list[Any]


def of_run(run: Trajectory) -> Numbers:
    """Return what a run documents: its course over place and time, its energies, the supply current, its notes."""
    current = supply_current_a(run.supply_power_w, run.scenario.vehicle.line_voltage_v)
    supply = [] if current is None else [current]
    return [run.position_m, run.speed_ms, run.time_s, run.energy.net_j, run.energy.traction_j, *supply, *run.notes]


def plan(scenario: Scenario) -> Numbers:
    """Return the run of the scenario's own strategy; its bound is no part of it."""
    return of_run(solve(scenario, prove_seconds=0))


def followed(scenario: Scenario) -> Numbers:
    """Return a plan and the run that follows it."""
    run = simulate_following(scenario)
    return [*of_run(run.planned), *of_run(run.actual), run.delay_s, *run.stop_errors_m]


def disturbed(scenario: Scenario) -> Numbers:
    """Return the run with its events."""
    run = actual_run(scenario)
    return [*of_run(run.actual), run.delay_s, *run.notes]


def in_closed_loop(scenario: Scenario) -> Numbers:
    """Return the run of the machines."""
    run = simulate_field_oriented(scenario)
    return [run.time_s, run.speed_ms, run.phase_voltage_v, run.energy_by_parts_j, *of_run(run.actual), *run.notes]


def by_chance(scenario: Scenario) -> Numbers:
    """Return the draws of a Monte Carlo study and their runs."""
    return list(monte_carlo(scenario).columns.values())


def timetable(scenario: Scenario) -> Numbers:
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

    compute: Callable[[Scenario], Numbers]
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
        "solver.mesh_m": 50.0,
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
        "line.rail_condition": "wet",
        "vehicle.adhesion": {"driven_mass_share": 0.45, "braked_mass_share": 0.5},
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
        if name == "induction":  # the one with a brake at standstill has all its keys
            continue
        others = {
            "vehicle.drive.model": {
                "vehicle.drive": efficiency if drive["model"] != efficiency["model"] else INDUCTION
            },
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
FIXED_ERROR = {"distribution": "fixed", "value": 0.05}
ERRORS = ("speed_error", "d1_error_m", "d2_error_m", "d3_error_m")
CONDITIONS = ("load_factor", "coordinate_error_m", "resistance_factor", "line_voltage_factor", "departure_delay_s")
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
PHASES = {
    "strategy": "phases",
    "vehicle.drive": INDUCTION,
    "timetable.travel_time_s": 260.0,
    "solver.mesh_m": 100.0,
    "vehicle.resistance.constant_n_per_kn": 5.0,
    "line.sections": [{"length_m": 3000.0}],
    "phases.cycles": 3,
}
RESISTANCE = {
    "constant_n_per_kn": 1.0,
    "linear_n_per_kn_per_kmh": 0.01,
    "quadratic_n_per_kn_per_kmh2": 1e-4,
    "constant_n": 100.0,
    "linear_n_per_kmh": 1.0,
    "quadratic_n_per_kmh2": 0.1,
    "starting_n_per_kn": 5.0,
    "starting_n": 500.0,
    "starting_ends_at_kmh": 8.0,
    "davis": {"a": 1.0, "b": 0.01, "c": 1e-4, "unit": "lb/ton", "speed_unit": "mph"},
    "formula": {"name": "davis-1926-freight", "axles": 8, "cars": 2, "frontal_area_m2": 8.0},
    "load": {"constant_n_per_kn": 0.8, "linear_n_per_kn_per_kmh": 0.02, "quadratic_n_per_kn_per_kmh2": 2e-4},
}
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
            "line.rail_condition": "dry",
            # below what adhesion leaves beside the electric brake
            "vehicle.braking.friction_effort_kn": 15.0,
        },
        idle=(
            "vehicle.drive",
            "vehicle.name",
            "vehicle.resistance.davis",
            "vehicle.resistance.starting",
            "line.name",
            "line.passing_points.0.name",
            "solver.tolerance",
        ),
    ),
    "freight, and resistance as data sheets have it": Case(
        plan,
        change_document(
            shortened({"strategy": "fastest"}),
            {"vehicle.max_load_t": 40.0, "vehicle.load_factor": 0.5, "vehicle.resistance": RESISTANCE},
        ),
        ("vehicle.resistance", "vehicle.load", "vehicle.max_load_t"),
        {
            "vehicle.load_t": {"vehicle.load_factor": 0.0, "vehicle.load_t": 12.0},
            "vehicle.resistance.davis.unit": "N/t",
            "vehicle.resistance.davis.speed_unit": "km/h",
            "vehicle.resistance.formula.name": "davis-1926-passenger",
        },
        idle=("vehicle.resistance.curve_constant_m_n_per_kn",),
    ),
    "limits by place": Case(
        plan,
        change_document(
            PLAIN,
            {
                "strategy": "fastest",
                "vehicle.line_voltage_v": 750.0,
                "vehicle.adhesion": {"driven_mass_share": 0.3},
                "line.traction_limits": [
                    {"from_m": 100.0, "to_m": 200.0, "max_effort_kn": 40.0},
                    {"from_m": 250.0, "to_m": 300.0, "effort_factor": 0.5},
                    {"from_m": 350.0, "to_m": 400.0, "max_power_kw": 300.0},
                    {"from_m": 450.0, "to_m": 500.0, "max_current_a": 400.0},
                    {"from_m": 1700.0, "to_m": 1950.0, "recuperation_factor": 0.3},
                ],
                "line.rail_conditions": [{"from_m": 550.0, "to_m": 800.0, "condition": "dry"}],
                "line.speed_limits": [{"from_m": 1000.0, "to_m": 1100.0, "limit_kmh": 60.0}],
                "line.limit_margin_m": 50.0,
            },
        ),
        ("line.traction_limits", "line.rail_conditions", "line.limit_margin_m", "vehicle.line_voltage_v"),
        {"line.rail_conditions.0.condition": "wet"},
        # of the other entries: a factor of 1 is none, and cannot be less without its limit
        idle=(
            *(f"line.traction_limits.{index}.effort_factor" for index in (0, 2, 3, 4)),
            *(f"line.traction_limits.{index}.recuperation_factor" for index in (0, 1, 2, 3)),
        ),
    ),
    "optimum over a refined mesh": Case(plan, shortened({}), ("solver.tolerance",), {"solver.tolerance": 1e-5}),
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
    "reserve": Case(
        plan,
        change_document(
            PLAIN,
            {
                "timetable": {
                    "reserve_percent": 12.0,
                    "reserve_parts": [{"from_m": 500.0, "to_m": 1500.0, "reserve_percent": 20.0}],
                }
            },
        ),
        ("timetable.reserve",),
    ),
    "reserve over distance": Case(
        plan,
        change_document(
            PLAIN,
            {
                "timetable": {
                    "reserve_min_per_100km": 15.0,
                    "reserve_parts": [{"from_m": 500.0, "to_m": 1500.0, "reserve_min_per_100km": 25.0}],
                }
            },
        ),
        ("timetable.reserve",),
    ),
    "jerk": Case(plan, change_document(PLAIN, {"vehicle.max_jerk_ms3": 0.6}), ("vehicle.max_jerk_ms3",)),
    "average speed without the train's length": Case(
        plan,
        change_document(PLAIN, {"timetable": {"average_speed_kmh": 33.0}, "vehicle.length_m": 80.0}),
        ("timetable.deduct_train_length",),
    ),
    "given timetable": Case(
        timetable,
        change_document(PLAIN, {"line.stations": [{**STATION, "arrival_s": 100.0}], "timetable.travel_time_s": 210.0}),
        ("line.stations.0.arrival_s",),
    ),
    **dict(cases_of_drives()),
    "eoc": Case(plan, {**FTOREK, "strategy": "eoc"}, ("eoc",), {"eoc.variant": "as_printed"}),
    "enoc": Case(plan, {**FTOREK, "strategy": "enoc", "enoc": {"acceleration_time_s": 60.0}}, ("enoc",)),
    "phases": Case(
        plan,
        shortened(PHASES),
        ("phases",),
        {
            "phases.starting_current_a": 150.0,
            "phases.free_starting_current": True,
            "phases.coast": {"phases.coast": False, "phases.cycles": 1},
        },
        idle=("phases.cycles",),
    ),
    "phases in cycles": Case(
        plan,
        shortened({"phases.cruise": False, **PHASES}),
        ("phases.cycles",),
    ),
    "set speeds": Case(
        plan,
        shortened({"strategy": "speed_limits", "search.boundaries_m": [450.0], "solver.mesh_m": 100.0}),
        ("search",),
        {"search.regulator": "brake", "search.limits_kmh": [45.0, 50.0], "search.free_boundaries": True},
        idle=tuple(
            f"search.{key}"
            for key in (
                "dead_zone_kmh",
                "regulation_speed_kmh",
                "full_effort_time_s",
                "effort_rate_share",
                "time_step_s",
                "inter_station_runs",
            )
        ),
    ),
    "set speeds of inter-station runs": Case(
        plan,
        shortened(
            {
                "strategy": "speed_limits",
                "search.boundaries_m": [400.0],
                "line.stations": [{"position_m": 400.0}],
                "timetable.travel_time_s": 120.0,
                "solver.mesh_m": 100.0,
            }
        ),
        ("search.inter_station_runs",),
        {"search.inter_station_runs": "separate"},
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
        idle=("search.free_boundaries", "search.inter_station_runs", "search.time_window"),
    ),
    "followed": Case(
        followed,
        shortened(
            {
                "vehicle.load_factor": 0.3,
                "vehicle.adhesion.driven_mass_share": 0.5,
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
        {
            "simulation.target_braking": {"simulation": {"target_braking": False, "speed_error": 0.02}},
            "disturbance.rail_condition": "wet",
            "disturbance.actual_load_t": {"disturbance.actual_load_factor": None, "disturbance.actual_load_t": 12.0},
        },
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
            "simulation.flux": "min_loss",
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
            **{name: {"distribution": "normal", "mean": 0.01, "standard_deviation": 0.02} for name in ERRORS},
        ),
        ("montecarlo",),
        {
            **{f"montecarlo.{name}.distribution": {f"montecarlo.{name}": FIXED} for name in CONDITIONS},
            **{f"montecarlo.{name}.distribution": {f"montecarlo.{name}": FIXED_ERROR} for name in ERRORS},
        },
        idle=("montecarlo.dwell_delay_s",),
    ),
    "dwells by chance": Case(
        by_chance,
        change_document(
            kind_of_chance(dwell_delay_s={"distribution": "normal", "mean": 4.0, "standard_deviation": 2.0}),
            {"line.stations": [{"position_m": 450.0, "dwell_s": 20.0}], "timetable": {"reserve_percent": 60.0}},
        ),
        ("montecarlo.dwell_delay_s",),
        {"montecarlo.dwell_delay_s.distribution": {"montecarlo.dwell_delay_s": FIXED}},
    ),
    "no chance": Case(
        by_chance,
        kind_of_chance(resistance_factor=FIXED),
        ("montecarlo.resistance_factor",),
        {"montecarlo.resistance_factor.distribution": {"montecarlo.resistance_factor": NORMAL}},
    ),
}
