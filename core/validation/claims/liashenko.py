"""Claims of Liashenko 2025, examined.

Tables 4 to 7 are judged by two measures: overconsumption by (12), over the plan for half load, and above a plan for the
actual load. Effort, resistance and controller are not printed, so that single numbers of these tables decide nothing;
orders and signs do.
"""

from collections.abc import Iterable, Mapping, Sequence
from functools import cache, partial
from typing import Any

import numpy as np

from railjoule.core.arrays import FloatArray
from railjoule.core.energy import share_above
from railjoule.core.scenario import Scenario, load_scenario
from railjoule.core.simulation.following import follow, plan_for, plan_knowing_load
from railjoule.core.strategies import solve
from railjoule.core.trajectory import Trajectory
from railjoule.core.units import MS_PER_KMH, N_PER_KN, STANDARD_GRAVITY_MS2
from railjoule.core.validation.claim import Examinations, Finding, judge, undecided
from railjoule.core.validation.liashenko_runs import (
    LEAST_SHOWN,
    ComparedTable,
    both_directions,
    compared_table,
    compared_tables,
    example,
    paper_numbers,
)
from railjoule.core.validation.table import CLOSE_PERCENT

MEASURES = {"by_plan": "(12):", "by_load": "above a plan for the actual load:"}
"""Two measures of `ComparedTable`, in words."""
BY = {"by_plan": "by (12)", "by_load": "against a plan for the actual load", "printed": "as printed"}
NOT_PRINTED = "Sizes depend on effort, resistance and controller, which the paper does not print."
SMALL_SHARE = 0.01
"""A smaller share is little."""
WITHSTANDS_SHARE = 0.5
"""A stop that moves by less than this share of an error withstands it; the paper prints no bound."""
ON_TIME_S = 1e-3
"""A plan that is later than this is late."""
SPEED_ERRORS = (-0.05, -0.02, 0.02, 0.05)
SENSOR_ERRORS_M = (-5.0, -2.0, 2.0, 5.0)
DECELERATIONS_MS2 = (0.3, 0.4, 0.5, 0.6, 0.8)
MESHES_M = (10.0, 5.0, 1.0)
PASSENGER_KG = 75.0
"""Mass of a passenger below (4)."""


def traction_share() -> Finding:
    """Examine the share of traction in the energy of a rail system."""
    return undecided("no number", "Stations and depots are no part of the model, and the paper cites no source.")


def passenger_share() -> Finding:
    """Examine the share of passengers in the mass of the train."""
    vehicle = _profiles()[0].vehicle
    masses = [
        vehicle.tare_kg + load * vehicle.capacity_passengers * vehicle.passenger_mass_kg
        for load in (1.0, vehicle.crush_load_factor)
    ]
    shares = [1 - vehicle.tare_kg / mass for mass in masses]
    return judge(
        f"{100 * shares[0]:.1f} % at full load",
        100 * abs(shares[0] - 0.4) <= CLOSE_PERCENT,
        f"Tare and capacity are makers' figures, not the paper's. At crush load it is {100 * shares[1]:.1f} %.",
    )


def mass_changes_plan() -> Finding:
    """Examine how plans for other loads differ from those for half load."""
    changes, speeds = [], []
    for scenario, plan in zip(_base_scenarios(), _plans(), strict=True):
        for load in (0.0, 1.0):
            own = plan_knowing_load(scenario, load)
            assert own is not None
            changes.append(share_above(own.energy_kwh, plan.energy_kwh))
            other = np.interp(plan.position_m, own.position_m, own.speed_ms)
            speeds.append(np.max(np.abs(other - plan.speed_ms)) / MS_PER_KMH)
    wrong = max(abs(table.by_load[table.planned_error]).max() for table in compared_tables())
    return judge(
        f"energy {100 * min(changes):+.1f} to {100 * max(changes):+.1f} %, speed by up to {max(speeds):.1f} km/h",
        min(map(abs, changes)) > SMALL_SHARE,
        f"Plans for loads 0 and 1 beside those for 0.5. The wrong plan itself changes the energy by {wrong:.1f} % at "
        "most: most of the change is the mass, which no plan avoids.",
    )


def global_optimum() -> Finding:
    """Examine how far the recursion lies above the proven lower bound."""
    gaps = [solve(scenario, "bellman").gap for scenario in _base_scenarios()]
    worst = max(gap if gap is not None else np.inf for gap in gaps)
    return judge(
        f"at most {100 * worst:.2f} % above the lower bound",
        worst <= SMALL_SHARE,
        f"railjoule's recursion over {len(gaps)} runs at 35 km/h. Its grid adapts to the run, and steps end exactly; "
        "the grid of the paper is not printed.",
    )


def fine_segments() -> Finding:
    """Examine how the optimum changes with the length of the segments."""
    energies = np.array([[_energy(one, mesh) for mesh in MESHES_M] for one in _base_scenarios()])
    worst = np.max(np.abs(energies[:, :-1] / energies[:, -1:] - 1), axis=0)
    return judge(
        f"10 m: {100 * worst[0]:.2f} %, 5 m: {100 * worst[1]:.2f} % at most",
        max(worst) <= SMALL_SHARE,
        "Change of the optimum's energy against segments of 1 m, over both directions of the four profiles.",
    )


def scheduled_time() -> Finding:
    """Examine the times of the plans."""
    figures = [example(entry["place"]).following.planned for entry in paper_numbers()["figure"]]
    late = max(plan.travel_time_s - plan.scenario.travel_time_s for plan in (*figures, *_plans()))
    times = ", ".join(f"{plan.travel_time_s:.1f}" for plan in figures)
    base = ", ".join(f"{plan.travel_time_s:.1f}" for plan in _plans()[::2])
    return judge(
        f"{times} s in Figs. 3 to 6; {base} s at 35 km/h",
        late <= ON_TIME_S,
        f"No plan is later than {ON_TIME_S:g} s. Runs that follow them with errors can be late, see Tables 4 to 7.",
    )


def passenger_weight() -> Finding:
    """Examine the weight of a passenger."""
    weight = PASSENGER_KG * STANDARD_GRAVITY_MS2 / N_PER_KN
    off = weight / paper_numbers()["passenger_weight_kn"] - 1
    return judge(f"{weight:.4f} kN", abs(off) <= SMALL_SHARE, f"With g = 9.81 m/s2 as below (3): {100 * off:+.2f} %.")


def negligible_gradient() -> Finding:
    """Examine the energies of profile 0 there and back."""
    up, down = (plan.energy_kwh for plan in _plans()[:2])
    more = share_above(up, down)
    return judge(
        f"{up:.2f} kWh up, {down:.2f} kWh down",
        abs(more) <= SMALL_SHARE,
        f"Uphill needs {100 * more:.0f} % more in the same time.",
    )


def stop_under_errors() -> Finding:
    """Examine the stopping errors of Tables 4 to 7."""
    worst = max(float(np.max(np.abs(table.stop_error_m))) for table in compared_tables())
    errors = max(float(np.max(np.abs(table.errors_m))) for table in compared_tables())
    return judge(
        f"stopping error at most {worst:.2f} m",
        worst <= WITHSTANDS_SHARE * errors,
        f"All cells of Tables 4 to 7, position errors up to {errors:g} m, exact sensors.",
    )


def speed_sensor() -> Finding:
    """Examine the stops with errors of the measured speed, with and without precision braking."""
    changes = [{"simulation.speed_error": error} for error in SPEED_ERRORS]
    worst, without = (_worst_stop_m(changes, is_braking) for is_braking in (True, False))
    fast = {"simulation.speed_error": max(SPEED_ERRORS)}
    late = max(follow(plan, plan.scenario.replace(**fast)).delay_s for plan in _plans())
    return judge(
        f"stopping error at most {worst:.2f} m, without precision braking {without:.1f} m",
        worst <= WITHSTANDS_SHARE * without,
        f"Errors up to {100 * max(SPEED_ERRORS):g} %; D1 to D2 calibrate the speed. The trip before D1 is up to "
        f"{late:.1f} s late.",
    )


def first_sensors() -> Finding:
    """Examine the stops with deviations of D1 and D2."""
    return _sensors_withstand((0, 1), "A wrong L_c scales only the distance after D3.")


def last_sensor() -> Finding:
    """Examine the stops with deviations of D3."""
    return _sensors_withstand((2,), "No sensor follows D3, so that its deviation is the stopping error.")


def _sensors_withstand(sensors: tuple[int, ...], why: str) -> Finding:
    errors = [[error if k == sensor else 0.0 for k in range(3)] for sensor in sensors for error in SENSOR_ERRORS_M]
    worst = _worst_stop_m([{"simulation.sensor_errors_m": one} for one in errors])
    share, options = worst / max(SENSOR_ERRORS_M), _base_scenarios()[0].simulation
    return judge(
        f"the stop moves by {share:.3f} m for each metre",
        share <= WITHSTANDS_SHARE,
        f"{why} L_c = {options.calibration_length_m:g} m and L_st = {options.stop_sensor_m:g} m are assumed.",
    )


def high_deceleration() -> Finding:
    """Examine the energy of plans over the deceleration of the target curve."""
    totals = [
        sum(
            plan_for(one.replace(**{"simulation.target_deceleration_ms2": deceleration})).energy_kwh
            for one in _base_scenarios()
        )
        for deceleration in DECELERATIONS_MS2
    ]
    numbers = ", ".join(f"{total:.1f}" for total in totals)
    steps = ", ".join(f"{deceleration:g}" for deceleration in DECELERATIONS_MS2)
    return judge(
        f"{numbers} kWh at {steps} m/s2",
        bool(np.all(np.diff(totals) < 0)),
        "Plans for 35 km/h, both directions of the four profiles together.",
    )


def braking_zone() -> Finding:
    """Examine the speeds at which optimal runs would enter the zone of precision braking."""
    free = _plans(is_braking=False)
    options, top = free[0].scenario.simulation, free[0].scenario.vehicle.traction.max_speed_kmh
    zone, deceleration = options.reset_sensor_m, options.target_deceleration_ms2
    assert zone is not None
    assert top is not None
    permitted = np.sqrt(2 * deceleration * zone) / MS_PER_KMH
    entering = [np.interp(run.position_m[-1] - zone, run.position_m, run.speed_ms) / MS_PER_KMH for run in free]
    slow = sum(speed <= permitted for speed in entering)
    return judge(
        f"(11) permits {permitted:.1f} km/h there; {slow} of {len(entering)} optimal runs are slower, the fastest has "
        f"{max(entering):.1f} km/h",
        slow == len(entering),
        f"Down profile III the zone costs energy. From the top speed of {top:g} km/h, which is assumed, it takes "
        f"{(top * MS_PER_KMH) ** 2 / (2 * deceleration):.0f} m.",
    )


def any_error_costs() -> Finding:
    """Examine the signs of both measures."""
    tables = compared_tables()
    printed, by_plan, by_load = (
        sum(int(np.sum(getattr(table, name) < -LEAST_SHOWN)) for table in tables)
        for name in ("printed", "by_plan", "by_load")
    )
    cells = sum(table.printed.size for table in tables)
    fourth = 100 * example("Fig. 4").following.overconsumption
    return judge(
        f"below zero: {by_plan} of {cells} cells by (12), {by_load} above a plan for the actual load; Fig. 4: "
        f"{fourth:+.1f} % by (12)",
        by_plan == 0 and fourth >= 0,
        f"The print has {printed} such cells, in Table 7. By (12) a lighter train needs less; against a plan for the "
        "actual load, only late runs do. A position error by itself saves nothing.",
    )


def largest(place: str) -> Finding:
    """Examine the largest cell of a table."""
    table = compared_table(place)
    found = "; ".join(f"{MEASURES[key]} {_most(table, key):.1f} % at {_cell(table, key)}" for key in MEASURES)
    same = np.argmax(table.by_plan) == np.argmax(table.printed)
    return judge(found, bool(same), f"Judged by the cell and by (12). {NOT_PRINTED}")


def _cell(table: ComparedTable, key: str) -> str:
    values: FloatArray = getattr(table, key)
    m, k = np.unravel_index(np.argmax(values), values.shape)
    return f"{table.errors_m[m]:+g} m, load {table.loads[k]:g}"


def grows_with_profile() -> Finding:
    """Examine the largest values of the tables in the order of the profiles."""
    largest = {key: [_most(table, key) for table in compared_tables()] for key in MEASURES}
    found = "; ".join(f"{MEASURES[key]} {', '.join(f'{one:.1f}' for one in each)} %" for key, each in largest.items())
    printed = ", ".join(f"{_most(table, 'printed'):.1f}" for table in compared_tables())
    grows = [bool(np.all(np.diff(each) > 0)) for each in largest.values()]
    return judge(found, any(grows), f"Largest values on profiles 0, I, II, III, in this order; printed {printed} %.")


def overconsumption_range() -> Finding:
    """Examine the largest values on the first and the last profile."""
    first, *_, last = compared_tables()
    found = "; ".join(f"{MEASURES[key]} {_most(first, key):.1f} and {_most(last, key):.1f} %" for key in MEASURES)
    printed = f"{_most(first, 'printed'):.1f} and {_most(last, 'printed'):.1f} %"
    return undecided(found, f"The tables print {printed}. {NOT_PRINTED}")


def _most(table: ComparedTable, key: str) -> float:
    return float(getattr(table, key).max())


def position_on_easy() -> Finding:
    """Examine the effects of position and load on profiles 0 and I."""
    return _larger_effect(compared_tables()[:2], is_position=True)


def load_on_heavy() -> Finding:
    """Examine the effects of position and load on profiles II and III."""
    return _larger_effect(compared_tables()[2:], is_position=False)


def _larger_effect(tables: Sequence[ComparedTable], is_position: bool) -> Finding:
    """Judge by (12) whether one of the errors has the larger effect in all tables."""
    texts, holds = {}, {}
    for key in (*MEASURES, "printed"):
        effects = [_effects(table, getattr(table, key)) for table in tables]
        texts[key] = " and ".join(f"{position:.1f} / {load:.1f}" for position, load in effects)
        holds[key] = [(position > load) == is_position for position, load in effects]
    found = "; ".join(f"{MEASURES[key]} {texts[key]} points" for key in MEASURES)
    counts = ", ".join(f"{sum(held)} of {len(held)} {BY[key]}" for key, held in holds.items())
    places = " and ".join(table.place for table in tables)
    return judge(
        found,
        all(holds["by_plan"]),
        f"Largest effect of position error / of load, each by itself, in {places}; printed {texts['printed']}. "
        f"Tables in which the claim holds: {counts}. Judged by (12).",
    )


def _effects(table: ComparedTable, values: FloatArray) -> tuple[float, float]:
    """Return the largest effect of the position error and of the load, each without the other [points]."""
    position, load = values[:, table.planned_load], values[table.planned_error]
    return float(np.max(np.abs(position))), float(np.max(np.abs(load)))


def _profiles() -> list[Scenario]:
    return [load_scenario(entry["scenario"]) for entry in paper_numbers()["table"]]


@cache
def _plans(is_braking: bool = True) -> tuple[Trajectory, ...]:
    """Return the plans for 35 km/h of the four profiles, there and back, with or without precision braking."""
    changes = {} if is_braking else {"simulation.target_braking": False}
    return tuple(plan_for(one) for profile in _profiles() for one in both_directions(profile, **changes))


def _base_scenarios() -> list[Scenario]:
    return [plan.scenario for plan in _plans()]


def _energy(scenario: Scenario, mesh_m: float) -> float:
    return solve(scenario.replace(**{"solver.mesh_m": mesh_m})).energy_kwh


def _worst_stop_m(changes: Iterable[Mapping[str, Any]], is_braking: bool = True) -> float:
    """Return the largest stopping error of runs that follow the plans under changes [m]."""
    return max(
        abs(follow(plan, plan.scenario.replace(**change)).stop_error_m)
        for change in changes
        for plan in _plans(is_braking)
    )


EXAMINATIONS: Examinations = {
    **{
        examine.__name__: examine
        for examine in (
            traction_share,
            passenger_share,
            mass_changes_plan,
            global_optimum,
            fine_segments,
            scheduled_time,
            passenger_weight,
            negligible_gradient,
            stop_under_errors,
            speed_sensor,
            first_sensors,
            last_sensor,
            high_deceleration,
            braking_zone,
            any_error_costs,
            grows_with_profile,
            overconsumption_range,
            position_on_easy,
            load_on_heavy,
        )
    },
    **{f"largest_table_{number}": partial(largest, f"Table {number}") for number in (4, 5, 6, 7)},
}
"""The examination of each claim, by its name in the paper's file."""
